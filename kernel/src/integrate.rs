//! Light paths: what a pixel sees by all effects that its pipeline holds. Runs on the GPU and on
//! the CPU.
//!
//! A path starts at the camera and is continued, vertex after vertex, by a random direction (J. T.
//! Kajiya, The rendering equation, SIGGRAPH 1986). At each vertex that is not a mirror, one light is
//! looked for as well, and the two ways of finding a light are weighed by the power heuristic. The
//! estimate is unbiased but for three things that a scene asks for: the limit on bounces, ambient
//! occlusion, and the headlamp. Lights without extent are not met by chance: they do not shine
//! through glass, and no mirror shows them. Beyond the third bounce dark paths end by Russian roulette, which
//! has no bias.
//!
//! A thread works through its samples in one loop: where a path has ended the next begins, so that
//! neighbours whose paths are longer do not wait.

use glam::{UVec2, Vec2, Vec3, Vec4};
// On the CPU, std has these functions.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use crate::effects::Effects;
use crate::film::{Accumulator, PathLaunch};
use crate::hit::Hit;
use crate::light::{self, Light};
use crate::material::{Material, material_of};
use crate::microfacet::{RoughMetal, SMOOTHEST, schlick};
use crate::nearest::MovingSpheres;
use crate::optics::{Incidence, reflect};
use crate::precision::intersect;
use crate::random::Sampler;
use crate::ray::Ray;
use crate::sampling::{
    cone, cone_density, cosine_density, cosine_hemisphere, disc, power_heuristic, tangents,
};
use crate::sphere::Sphere;
use crate::surface::{Surface, unit};
use crate::traversal::Traversal;

/// What stays the same for all paths of a launch: how the pipeline was compiled, what it was told,
/// and the world.
#[derive(Clone, Copy, Debug)]
pub struct Scenery<'a, T> {
    /// The effects that the pipeline holds.
    pub effects: Effects,
    /// The rung, a value of [`Rung::to_u32`](crate::Rung::to_u32).
    pub rung: u32,
    /// What the launch was told.
    pub launch: &'a PathLaunch,
    /// What finds hits among the spheres, on this rung.
    pub traversal: T,
    /// The spheres.
    pub spheres: &'a [Sphere],
    /// How each sphere moves, in scene units per unit of time.
    pub velocities: &'a [Vec4],
    /// For each sphere, the index of its material.
    pub material_ids: &'a [u32],
    /// The materials.
    pub materials: &'a [Material],
    /// The lights that are looked for.
    pub lights: &'a [Light],
    /// The table of [`RoughMetal`], and after it that of [`Sky`](crate::sky::Sky).
    pub tables: &'a [f32],
}

impl<T: Traversal> Scenery<'_, T> {
    /// The spheres where they are at `time`.
    #[inline]
    fn spheres_at(&self, time: f32) -> MovingSpheres<'_> {
        MovingSpheres {
            spheres: self.spheres,
            velocities: self.velocities,
            time,
            effects: self.effects,
        }
    }

    /// The sphere with this index where it is at `time`.
    #[inline]
    fn sphere(&self, index: usize, time: f32) -> Sphere {
        self.spheres_at(time).read(index)
    }

    #[inline]
    fn nearest_hit(&self, ray: &Ray, time: f32) -> Hit {
        self.traversal.nearest_hit(ray, &self.spheres_at(time))
    }

    #[inline]
    fn is_occluded(&self, ray: &Ray, time: f32) -> bool {
        self.traversal.is_occluded(ray, &self.spheres_at(time))
    }
}

/// Effects for which light paths are longer than their first vertex.
const BOUNCING: Effects = Effects::MIRROR
    .and(Effects::ROUGH_METAL)
    .and(Effects::GLASS)
    .and(Effects::INTERREFLECTION)
    .and(Effects::FOG);
/// Effects for which lights are looked for.
const SEEKING: Effects = Effects::HARD_SHADOWS
    .and(Effects::SOFT_SHADOWS)
    .and(Effects::ENVIRONMENT);

/// The dimensions of random numbers that the camera takes, and that each vertex takes.
const OF_CAMERA: u32 = 3;
const OF_VERTEX: u32 = 8;

/// A path on its way.
#[derive(Clone, Copy)]
struct Path {
    origin: Vec3,
    direction: Vec3,
    /// What light that arrives here still counts for.
    throughput: Vec3,
    /// What has arrived.
    radiance: Vec3,
    /// What the glass that the path is in absorbs per scene unit.
    absorption: Vec3,
    /// The density with which the direction was sampled, or zero if no light could be looked for.
    density: f32,
    time: f32,
    bounces: u32,
    /// Zero for a path that saw nothing but the background.
    alpha: f32,
    /// The distance to the first sphere, [`Hit::NONE_T`] if there was none.
    depth: f32,
}

/// How a vertex scatters.
const LAMBERT: u32 = 0;
const METAL: u32 = 1;
const PHASE: u32 = 2;

/// Adds the launch's samples of one pixel to what it holds. `pixel` counts from the upper left of
/// the tile.
#[inline(always)]
#[must_use]
pub fn trace_pixel<T: Traversal>(
    scenery: &Scenery<'_, T>,
    pixel: UVec2,
    previous: Accumulator,
) -> Accumulator {
    let launch = scenery.launch;
    let pixel = launch.tile_origin.wrapping_add(pixel);
    let mut accumulator = previous;
    let mut sample = launch.first_sample;
    let end = sample.wrapping_add(launch.sample_count);
    let mut sampler = Sampler::new(launch.seed, pixel, sample);
    let mut path = start(scenery, pixel, &sampler);
    while sample < end {
        if !step(scenery, &mut path, &sampler) {
            accumulator.add(path.radiance, path.alpha, path.depth);
            sample += 1;
            sampler = Sampler::new(launch.seed, pixel, sample);
            path = start(scenery, pixel, &sampler);
        }
    }
    accumulator
}

/// The path of a sample where it leaves the camera.
#[inline]
fn start<T: Traversal>(scenery: &Scenery<'_, T>, pixel: UVec2, sampler: &Sampler) -> Path {
    let (effects, launch) = (scenery.effects, scenery.launch);
    let camera = launch.camera;
    let size = launch.image_size;
    let (mut origin, mut direction);
    if effects.any(Effects::ANTIALIASING) {
        let inside = sampler.pair(0);
        let x = 2.0 * (pixel.x as f32 + inside.x) / size.x as f32 - 1.0;
        let y = 1.0 - 2.0 * (pixel.y as f32 + inside.y) / size.y as f32;
        let ray = camera.ray(Vec2::new(x, y));
        (origin, direction) = (ray.origin, ray.direction);
    } else {
        let ray = camera.pixel_ray(pixel, size);
        (origin, direction) = (ray.origin, ray.direction);
    }
    if effects.any(Effects::DEFOCUS) {
        let in_focus = origin + direction * launch.focus_distance;
        let on_lens = disc(sampler.pair(1)) * launch.lens_radius;
        origin += unit(camera.right) * on_lens.x + unit(camera.up) * on_lens.y;
        direction = in_focus - origin;
    }
    let mut time = 0.0;
    if effects.any(Effects::MOTION_BLUR) {
        let open = launch.shutter_open;
        time = open + (launch.shutter_close - open) * sampler.single(2);
    }
    Path {
        origin,
        direction: unit(direction),
        throughput: Vec3::ONE,
        radiance: Vec3::ZERO,
        absorption: Vec3::ZERO,
        density: 0.0,
        time,
        bounces: 0,
        alpha: 1.0,
        depth: Hit::NONE_T,
    }
}

/// Where a path is scattered, other than at a mirror or at glass.
struct Vertex {
    /// One of the constants.
    lobe: u32,
    /// The direction from which the path comes.
    incoming: Vec3,
    /// The surface's normal, on the side that the path comes from.
    facing: Vec3,
    x: Vec3,
    y: Vec3,
    color: Vec3,
    metal: RoughMetal,
}

impl Vertex {
    /// How much light is scattered from `to` into the path, times the cosine at a surface; and the
    /// density with which [`Vertex::sample`] chooses `to`.
    #[inline]
    fn evaluate<T: Traversal>(&self, scenery: &Scenery<'_, T>, to: Vec3) -> (Vec3, f32) {
        let effects = scenery.effects;
        if effects.any(Effects::FOG) && self.lobe == PHASE {
            let phase = scenery.launch.fog.phase(self.incoming.dot(to));
            (Vec3::splat(phase), phase)
        } else if effects.any(Effects::ROUGH_METAL) && self.lobe == METAL {
            let local = Vec3::new(self.x.dot(to), self.y.dot(to), self.facing.dot(to));
            self.metal.evaluate(local, scenery.tables)
        } else {
            let density = cosine_density(self.facing.dot(to));
            (self.color * density, density)
        }
    }

    /// A direction to continue in.
    #[inline]
    fn sample<T: Traversal>(&self, scenery: &Scenery<'_, T>, u: Vec2, choice: f32) -> Vec3 {
        let effects = scenery.effects;
        if effects.any(Effects::FOG) && self.lobe == PHASE {
            scenery.launch.fog.sample(self.incoming, u)
        } else if effects.any(Effects::ROUGH_METAL) && self.lobe == METAL {
            let to = self.metal.sample(u, choice);
            unit(self.x * to.x + self.y * to.y + self.facing * to.z)
        } else {
            cosine_hemisphere(self.facing, u)
        }
    }
}

/// Takes a path to its next vertex and away from it; false where it ends.
#[inline]
fn step<T: Traversal>(scenery: &Scenery<'_, T>, path: &mut Path, sampler: &Sampler) -> bool {
    let (effects, launch) = (scenery.effects, scenery.launch);
    let dimension = OF_CAMERA + OF_VERTEX * path.bounces;
    let ray = Ray::within(path.origin, path.direction, f32::MIN_POSITIVE, Hit::NONE_T);
    let hit = scenery.nearest_hit(&ray, path.time);
    let continues = effects.any(BOUNCING) & (path.bounces < launch.max_bounces);

    let mut surface = Surface {
        point: Vec3::ZERO,
        normal: Vec3::ZERO,
        error: 0.0,
    };
    let mut material = Material::diffuse(Vec3::ONE);
    let mut lobe = LAMBERT;
    if effects.any(Effects::FOG) {
        let (from, to) = launch.fog.span(path.origin, path.direction, hit.t);
        let at = from + launch.fog.sample_distance(sampler.single(dimension + 4));
        if (from < to) & (at < to) {
            lobe = PHASE;
            surface.point = ray.at(at);
            if effects.any(Effects::GLASS) {
                path.throughput *= absorb(path.absorption, at);
            }
            path.throughput *= launch.fog.albedo;
        }
    }
    if lobe != PHASE {
        if !hit.is_some() {
            arrive_at_sky(scenery, path);
            return false;
        }
        if effects.any(Effects::GLASS) {
            path.throughput *= absorb(path.absorption, hit.t);
        }
        let index = hit.sphere as usize;
        let sphere = scenery.sphere(index, path.time);
        surface = Surface::at(&ray, hit.t, sphere);
        material = material_of(index, scenery.material_ids, scenery.materials);
        if path.bounces == 0 {
            path.depth = hit.t;
        }
        if effects.any(Effects::EMISSION) && material.kind == Material::EMISSIVE {
            arrive_at_lamp(scenery, path, sphere, material.volume);
            return false;
        }
        if effects.any(Effects::GLASS)
            && (material.kind == Material::GLASS) | (material.kind == Material::BUBBLE)
        {
            if continues {
                cross_glass(path, &surface, &material, sampler.single(dimension + 3));
            }
            return continues && survives(path, sampler.single(dimension + 6));
        }
    }

    let facing = if surface.normal.dot(path.direction) > 0.0 {
        -surface.normal
    } else {
        surface.normal
    };
    if effects.any(Effects::MIRROR.and(Effects::ROUGH_METAL))
        && lobe != PHASE
        && material.kind == Material::METAL
    {
        let is_smooth = material.parameter < SMOOTHEST;
        if effects.any(Effects::MIRROR) && (is_smooth | !effects.any(Effects::ROUGH_METAL)) {
            if continues {
                let cosine = -facing.dot(path.direction);
                path.throughput *= schlick(material.color, cosine);
                let direction = unit(reflect(path.direction, facing));
                path.leave(&surface, direction, 0.0);
            }
            return continues && survives(path, sampler.single(dimension + 6));
        }
        lobe = METAL;
    }

    if effects.any(Effects::HEADLAMP) && lobe == LAMBERT {
        // Lambert with the lamp where the path comes from.
        path.radiance += path.throughput * material.color * facing.dot(path.direction).abs();
        return false;
    }
    let lobe_continues = continues & ((lobe != LAMBERT) | effects.any(Effects::INTERREFLECTION));

    let (x, y) = tangents(facing);
    let from = -Vec3::new(
        x.dot(path.direction),
        y.dot(path.direction),
        facing.dot(path.direction),
    );
    let vertex = Vertex {
        lobe,
        incoming: path.direction,
        facing,
        x,
        y,
        color: material.color,
        metal: RoughMetal::new(material.color, material.parameter, from, scenery.tables),
    };
    let seeks = effects.any(SEEKING) && !scenery.lights.is_empty();
    if seeks {
        let light = light_from_seeking(
            scenery,
            path,
            &surface,
            &vertex,
            lobe_continues,
            sampler,
            dimension,
        );
        path.radiance += path.throughput * light;
    }
    if effects.any(Effects::AMBIENT_OCCLUSION) && lobe == LAMBERT {
        let direction = cosine_hemisphere(facing, sampler.pair(dimension));
        let light = ambient_light(scenery, path.time, &surface, direction);
        path.radiance += path.throughput * material.color * light;
        return false;
    }
    if !lobe_continues {
        return false;
    }
    let choice = sampler.single(dimension + 3);
    let direction = vertex.sample(scenery, sampler.pair(dimension), choice);
    let (value, density) = vertex.evaluate(scenery, direction);
    // Asked this way, so that a NaN ends the path.
    let is_possible = density > 0.0;
    if !is_possible {
        return false;
    }
    path.throughput *= value / density;
    path.leave(&surface, direction, if seeks { density } else { 0.0 });
    survives(path, sampler.single(dimension + 6))
}

/// The light that a path brings home which meets nothing.
#[inline]
fn arrive_at_sky<T: Traversal>(scenery: &Scenery<'_, T>, path: &mut Path) {
    let (effects, sky) = (scenery.effects, &scenery.launch.sky);
    if effects.any(Effects::TRANSPARENT_BACKGROUND) && path.bounces == 0 {
        path.alpha = 0.0;
        return;
    }
    let mut weight = 1.0;
    if effects.any(Effects::ENVIRONMENT) && path.density > 0.0 {
        let other =
            sky.environment_probability * sky.environment_density(path.direction, scenery.tables);
        weight = power_heuristic(path.density, other);
    }
    let mut light = sky.radiance(effects, path.direction, scenery.tables) * weight;
    if effects.any(Effects::SUN) && sky.is_sun(path.direction) {
        let mut weight = 1.0;
        if effects.any(Effects::SOFT_SHADOWS) && path.density > 0.0 {
            let other = sky.sun_probability / light::solid_angle(sky.sun_height);
            weight = power_heuristic(path.density, other);
        }
        light += sky.sun_radiance * weight;
    }
    path.radiance += path.throughput * light;
}

/// The light that a path brings home which meets a sphere of light.
#[inline]
fn arrive_at_lamp<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &mut Path,
    sphere: Sphere,
    radiance: Vec3,
) {
    let mut weight = 1.0;
    if scenery.effects.any(Effects::SOFT_SHADOWS) && path.density > 0.0 {
        let power = luminance(radiance) * sphere.radius() * sphere.radius();
        let chosen = power * scenery.launch.sphere_light_probability;
        let other = chosen * light::sphere_density(sphere, path.origin);
        weight = power_heuristic(path.density, other);
    }
    path.radiance += path.throughput * radiance * weight;
}

/// Whether the ambient light along `direction` arrives at the surface.
#[inline]
fn ambient_light<T: Traversal>(
    scenery: &Scenery<'_, T>,
    time: f32,
    surface: &Surface,
    direction: Vec3,
) -> Vec3 {
    let (effects, launch) = (scenery.effects, scenery.launch);
    let mut ray = surface.leave(direction);
    ray.t_max = launch.ambient_distance;
    if scenery.is_occluded(&ray, time) {
        Vec3::ZERO
    } else if launch.has_ambient_sky == 1 {
        launch.sky.radiance(effects, direction, scenery.tables)
    } else {
        Vec3::ONE
    }
}

/// The light that one light, chosen at random, gives into the path by way of the vertex.
#[inline]
fn light_from_seeking<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &Path,
    surface: &Surface,
    vertex: &Vertex,
    continues: bool,
    sampler: &Sampler,
    dimension: u32,
) -> Vec3 {
    let lamp = light::choose(scenery.lights, sampler.single(dimension + 2));
    if scenery.effects.any(Effects::AMBIENT_OCCLUSION)
        && (vertex.lobe == LAMBERT) & (lamp.kind == Light::ENVIRONMENT)
    {
        // It is the ambient light already.
        return Vec3::ZERO;
    }
    let found = seek(
        scenery,
        &lamp,
        surface.point,
        path.time,
        sampler.pair(dimension + 1),
    );
    let (value, density) = vertex.evaluate(scenery, found.direction);
    let light = value * found.radiance;
    if !((found.density > 0.0) & (light.max_element() > 0.0)) {
        return Vec3::ZERO;
    }
    let mut shadow = surface.leave(found.direction);
    shadow.t_max = found.distance;
    if scenery.effects.any(Effects::SOFT_SHADOWS) && found.is_sphere {
        // Up to where the sphere itself begins: the interval is half-open.
        let lamp = scenery.sphere(lamp.sphere as usize, path.time);
        shadow.t_max = intersect(scenery.rung, lamp, &shadow);
        if shadow.t_max >= Hit::NONE_T {
            return Vec3::ZERO;
        }
    }
    if scenery.is_occluded(&shadow, path.time) {
        return Vec3::ZERO;
    }
    let mut weight = 1.0;
    if continues & !found.is_delta {
        weight = power_heuristic(found.density, density);
    }
    if scenery.effects.any(Effects::FOG) {
        let fog = &scenery.launch.fog;
        weight *= fog.transmittance(shadow.origin, shadow.direction, shadow.t_max);
    }
    let mut light = light * (weight / found.density);
    if scenery.effects.any(Effects::GLASS) && shadow.t_max < Hit::NONE_T {
        light *= absorb(path.absorption, shadow.t_max);
    }
    light
}

/// A light as it is looked for from a point.
struct Found {
    direction: Vec3,
    /// Radiance; of a light without extent, irradiance at the point.
    radiance: Vec3,
    /// Per solid angle; of a light without extent, the probability of choosing it.
    density: f32,
    distance: f32,
    is_delta: bool,
    is_sphere: bool,
}

/// A direction in which the light is.
#[inline]
fn seek<T: Traversal>(
    scenery: &Scenery<'_, T>,
    lamp: &Light,
    point: Vec3,
    time: f32,
    u: Vec2,
) -> Found {
    let (effects, launch) = (scenery.effects, scenery.launch);
    let mut found = Found {
        direction: lamp.position,
        radiance: lamp.color,
        density: lamp.probability,
        distance: Hit::NONE_T,
        is_delta: true,
        is_sphere: false,
    };
    if effects.any(Effects::SOFT_SHADOWS)
        && lamp.kind == Light::SPHERE
        && (lamp.sphere as usize) < scenery.spheres.len()
    {
        let sphere = scenery.sphere(lamp.sphere as usize, time);
        let (direction, density) = light::sample_sphere(sphere, point, u);
        found.direction = direction;
        found.density *= density;
        found.is_delta = false;
        found.is_sphere = true;
    } else if effects.any(Effects::SOFT_SHADOWS) && lamp.kind == Light::SUN && lamp.height > 0.0 {
        found.direction = cone(lamp.position, lamp.height, u);
        found.density *= cone_density(lamp.height);
        found.is_delta = false;
    } else if effects.any(Effects::ENVIRONMENT) && lamp.kind == Light::ENVIRONMENT {
        let (direction, density, radiance) = launch.sky.sample_environment(u, scenery.tables);
        found.direction = direction;
        found.radiance = radiance;
        found.density *= density;
        found.is_delta = false;
    } else if effects.any(Effects::HARD_SHADOWS) && lamp.kind == Light::POINT {
        let towards = lamp.position - point;
        let squared = towards.dot(towards);
        found.direction = unit(towards);
        found.distance = squared.sqrt();
        found.radiance = lamp.color / squared.max(f32::MIN_POSITIVE);
    } else if !(effects.any(Effects::HARD_SHADOWS) && lamp.kind == Light::SUN) {
        found.density = 0.0;
    }
    found
}

impl Path {
    /// Sends the path off in `direction`, a unit vector that was sampled with this density.
    #[inline]
    fn leave(&mut self, surface: &Surface, direction: Vec3, density: f32) {
        self.origin = surface.leave(direction).origin;
        self.direction = direction;
        self.density = density;
        self.bounces += 1;
    }
}

/// Reflects the path at glass or lets it through, by chance, as Fresnel's equations share it out.
#[inline]
fn cross_glass(path: &mut Path, surface: &Surface, material: &Material, u: f32) {
    let cosine = surface.normal.dot(path.direction);
    let enters = cosine < 0.0;
    let (normal, eta) = if enters {
        (surface.normal, 1.0 / material.parameter)
    } else {
        (-surface.normal, material.parameter)
    };
    let incidence = Incidence {
        cosine: cosine.abs().min(1.0),
        eta,
    };
    let fresnel = incidence.fresnel();
    let direction = if u < fresnel.reflectance {
        reflect(path.direction, normal)
    } else {
        // Which side of the surface is the one that absorbs.
        path.absorption = if enters == (material.kind == Material::GLASS) {
            material.volume
        } else {
            Vec3::ZERO
        };
        fresnel.refract(incidence, path.direction, normal)
    };
    path.leave(surface, unit(direction), 0.0);
}

/// Beer's law.
#[inline]
fn absorb(absorption: Vec3, distance: f32) -> Vec3 {
    Vec3::new(
        (-absorption.x * distance).exp(),
        (-absorption.y * distance).exp(),
        (-absorption.z * distance).exp(),
    )
}

/// Russian roulette: a dark path ends, and one that does not counts for more.
#[inline]
fn survives(path: &mut Path, u: f32) -> bool {
    let brightest = path.throughput.max_element();
    if brightest <= 0.0 {
        return false;
    }
    if path.bounces > 3 {
        let chance = brightest.clamp(0.05, 1.0);
        path.throughput *= 1.0 / chance;
        return u < chance;
    }
    true
}

/// Relative luminance of a linear Rec. 709 colour.
#[inline]
#[must_use]
pub fn luminance(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

//! Traces the light paths of a pixel, vertex after vertex. Runs on the GPU and on the CPU.
//!
//! A thread works through its samples in one loop: when a path ends, the next one begins, so that
//! no thread waits for the longer paths of its neighbours.

use core::f32::consts::PI;

use glam::{UVec2, Vec2, Vec3};

use super::arrive::{arrive_at_lamp, arrive_at_sky};
use super::caustic::chain::Chain;
use super::caustic::connect::light_by_sphere;
use super::glass::{absorb, cross_glass, passes_covered_glass};
use super::light_path::{Path, survives};
use super::media::{Media, Medium};
use super::place::Place;
use super::random::{Numbers, Sampler};
use super::sampling::{Pair, cosine_hemisphere, disc};
use super::scenery::Scenery;
use super::seek::{ambient_light, light_from_seeking};
use super::shadow::Shadow;
use super::vertex::{LAMBERT, METAL, PHASE, PLASTIC, Vertex};
use crate::accel::traversal::Traversal;
use crate::effects::Effects;
use crate::film::{Accumulator, PathLaunch};
use crate::hit::Hit;
use crate::material::Material;
use crate::material::microfacet::{SMOOTHEST, schlick};
use crate::material::optics::reflect;
use crate::ray::Ray;
use crate::surface::unit;

/// Effects for which lights are sampled.
const SEEKING: Effects = Effects::HARD_SHADOWS
    .and(Effects::SOFT_SHADOWS)
    .and(Effects::ENVIRONMENT);

/// Adds the samples of a launch to one pixel. `pixel` counts from the upper left of
/// the tile.
#[inline(always)]
#[must_use]
pub fn trace_pixel<T: Traversal>(
    scenery: &Scenery<'_, T>,
    pixel: UVec2,
    previous: Accumulator,
) -> Accumulator {
    let mut accumulator = previous;
    let Samples { pixel, first, end } = Samples::of(scenery.launch, pixel, &accumulator);
    let mut sample = first;
    let mut sampler = Sampler::of(scenery.launch, pixel, sample);
    let mut path = start(scenery, pixel, &sampler);
    while sample < end {
        let hit = path.or_exit(scenery.nearest_hit(&path.ray(), path.left, path.time));
        let numbers = sampler.at_vertex(path.bounces());
        if !shade(scenery, &mut path, &numbers, hit, receive_at_once) {
            path.end(scenery, sample, &mut accumulator);
            sample += 1;
            sampler = Sampler::of(scenery.launch, pixel, sample);
            path = start(scenery, pixel, &sampler);
        }
    }
    accumulator
}

/// The samples that a launch takes of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Samples {
    /// The pixel of the image.
    pub pixel: UVec2,
    /// The first sample.
    pub first: u32,
    /// The sample after the last.
    pub end: u32,
}

impl Samples {
    /// Those of the pixel at `slot`, counted from the upper left of the tile, which has these sums.
    #[inline]
    #[must_use]
    pub fn of(launch: &PathLaunch, slot: UVec2, sums: &Accumulator) -> Self {
        let mut pixel = launch.tile_origin.wrapping_add(slot);
        let mut first = launch.first_sample;
        let mut count = launch.sample_count;
        if launch.is_adaptive == 1 {
            pixel = sums.pixel_at(pixel, launch.image_size);
            first = sums.samples() as u32;
            if pixel.x >= launch.image_size.x || pixel.y >= launch.image_size.y {
                count = 0;
            }
        }
        let end = first.wrapping_add(count);
        Self { pixel, first, end }
    }
}

/// Starts the path of a sample at the camera.
#[inline]
#[must_use]
pub fn start<T: Traversal>(scenery: &Scenery<'_, T>, pixel: UVec2, sampler: &Sampler) -> Path {
    let (effects, launch) = (scenery.effects, scenery.launch);
    let camera = launch.camera;
    let size = launch.image_size;
    let (mut origin, mut direction);
    if effects.any(Effects::ANTIALIASING) {
        let mut inside = sampler.pair(0);
        if effects.any(Effects::FILTER) {
            inside = launch.filter.place(inside);
        }
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
        let on_lens = disc(Pair::of(sampler.pair(1))) * launch.lens_radius;
        origin += unit(camera.right) * on_lens.x + unit(camera.up) * on_lens.y;
        direction = in_focus - origin;
    }
    let mut time = 0.0;
    if effects.any(Effects::MOTION_BLUR) {
        let open = launch.shutter_open;
        time = open + (launch.shutter_close - open) * sampler.single(2);
    }
    let mut path = Path {
        origin,
        left: Hit::NONE_SPHERE,
        direction: unit(direction),
        exit: Hit::NONE_T,
        throughput: Vec3::ONE,
        radiance: Vec3::ZERO,
        indirect: Vec3::ZERO,
        medium: Medium {
            index: 1.0,
            absorption: Vec3::ZERO,
        },
        media: Media::NONE,
        is_in_glass: 0,
        density: 0.0,
        facing: Vec3::ZERO,
        chain: Chain::LOST,
        time,
        events: 0,
        alpha: 1.0,
        depth: Hit::NONE_T,
    };
    if effects.any(Effects::NESTED_GLASS) {
        path.media = Media(launch.glass_at_eye);
    }
    path
}

/// The event at a place is one of these two, or else the lobe that scatters the path.
const ENDS: u32 = u32::MAX;
/// The path has left for the next place.
const LEAVES: u32 = u32::MAX - 1;
/// The path goes on as if nothing were there.
const PASSES: u32 = u32::MAX - 2;

/// Traces a shadow ray and lets the path receive its light.
#[inline]
fn receive_at_once<T: Traversal>(scenery: &Scenery<'_, T>, path: &mut Path, shadow: Shadow) {
    // On a GPU it ends there already.
    let shadow = if cfg!(target_arch = "spirv") {
        shadow
    } else {
        shadow.up_to_lamp(scenery, path.time)
    };
    if shadow.is_some() && !scenery.is_blocked(&shadow.ray, shadow.left, shadow.target, path.time) {
        path.receive(scenery.effects, shadow.light, shadow.scatterings);
    }
}

/// Takes a path to its next place, where it has this hit, and away from it. Returns false if the
/// path ends there. `receive` is told of the light of lamps and then of ambient light that the path
/// finds there, and lets the path [receive](Path::receive) it, now or later, unless its ray is
/// occluded.
#[inline]
#[must_use]
pub fn shade<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &mut Path,
    numbers: &impl Numbers,
    hit: Hit,
    receive: impl Fn(&Scenery<'_, T>, &mut Path, Shadow) + Copy,
) -> bool {
    let effects = scenery.effects;
    let ray = path.ray();
    let continues = effects.any(Effects::BOUNCING) & (path.bounces() <= scenery.most_bounces());

    let mut place = Place::none();
    let is_in_fog =
        path.is_in_fog(effects) && meet_fog(scenery, path, &ray, hit, numbers, &mut place);
    let event = if !is_in_fog {
        meet_surface(scenery, path, &ray, hit, continues, numbers, &mut place)
    } else if continues {
        PHASE
    } else {
        ENDS
    };
    if event == ENDS {
        return false;
    }
    if event == PASSES {
        return true;
    }
    if event != LEAVES && !scatter(scenery, path, &place, event, continues, numbers, receive) {
        return false;
    }
    survives(path, numbers.roulette())
}

/// Stops a path in the fog, by chance. Returns whether it stops.
#[inline]
fn meet_fog<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &mut Path,
    ray: &Ray,
    hit: Hit,
    numbers: &impl Numbers,
    place: &mut Place,
) -> bool {
    let fog = &scenery.launch.fog;
    let (from, to) = fog.span(path.origin, path.direction, hit.t);
    let at = from + fog.sample_distance(numbers.others().way());
    let is_in_fog = (from < to) & (at < to);
    if is_in_fog {
        place.surface.point = ray.at(at);
        path.throughput *= fog.albedo;
    }
    is_in_fog
}

/// Takes a path to the sphere that its ray hits, and on through glass or away from a mirror. A path
/// that meets a light, or nothing, ends. Returns the event.
#[inline]
fn meet_surface<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &mut Path,
    ray: &Ray,
    hit: Hit,
    continues: bool,
    numbers: &impl Numbers,
    place: &mut Place,
) -> u32 {
    let effects = scenery.effects;
    if !hit.is_some() {
        arrive_at_sky(scenery, path);
        return ENDS;
    }
    if effects.any(Effects::GLASS) {
        path.throughput *= absorb(path.medium(scenery).absorption, hit.t);
    }
    *place = scenery.place(ray, hit, path.time);
    let Place {
        surface, material, ..
    } = *place;
    if path.bounces() == 0 {
        path.depth = hit.t;
    }
    if effects.any(Effects::EMISSION) && material.kind == Material::EMISSIVE {
        arrive_at_lamp(scenery, path, place, material.volume);
        return ENDS;
    }
    if effects.any(Effects::GLASS)
        && (material.kind == Material::GLASS) | (material.kind == Material::BUBBLE)
    {
        let mut beyond = path.media;
        if effects.any(Effects::NESTED_GLASS) {
            beyond = path.media_beyond(scenery, place);
            if passes_covered_glass(path, place, beyond) {
                return PASSES;
            }
        }
        if continues {
            cross_glass(scenery, path, place, beyond, numbers.others().choice());
            lose_at_shape(scenery, path, place);
            return LEAVES;
        }
        return ENDS;
    }
    if path.bounces() > scenery.most_bounces() {
        return ENDS;
    }
    if effects.any(Effects::MIRROR.and(Effects::ROUGH_METAL)) && material.kind == Material::METAL {
        let is_smooth = material.parameter < SMOOTHEST;
        if effects.any(Effects::MIRROR) && (is_smooth | !effects.any(Effects::ROUGH_METAL)) {
            if continues {
                let facing = surface.facing(path.direction);
                path.throughput *= schlick(material.color, -facing.dot(path.direction));
                let direction = unit(reflect(path.direction, facing));
                path.leave(place, direction, 0.0);
                if effects.any(Effects::CAUSTICS) {
                    path.chain.mirror(place.sphere);
                    lose_at_shape(scenery, path, place);
                }
                return LEAVES;
            }
            return ENDS;
        }
        return METAL;
    }
    if effects.any(Effects::PLASTIC) && material.kind == Material::PLASTIC {
        return PLASTIC;
    }
    LAMBERT
}

/// Light is connected by spheres alone: no connection finds a path by another shape.
#[inline]
fn lose_at_shape<T: Traversal>(scenery: &Scenery<'_, T>, path: &mut Path, place: &Place) {
    if scenery.effects.any(Effects::CAUSTICS) && scenery.shapes.have(place.sphere) {
        path.chain = Chain::LOST;
    }
}

/// Samples a light at a place that scatters by this lobe, and continues the path in a random
/// direction. Returns false if the path ends.
#[inline]
fn scatter<T: Traversal>(
    scenery: &Scenery<'_, T>,
    path: &mut Path,
    place: &Place,
    lobe: u32,
    continues: bool,
    numbers: &impl Numbers,
    receive: impl Fn(&Scenery<'_, T>, &mut Path, Shadow) + Copy,
) -> bool {
    let effects = scenery.effects;
    let Place {
        surface, material, ..
    } = place;
    let facing = surface.facing(path.direction);
    // Of light that is found here, this one included.
    let scatterings = path.bounces() + 1;
    if effects.any(Effects::HEADLAMP) && lobe == LAMBERT {
        // Lambert with the lamp at the eye.
        let light = path.throughput * material.color * facing.dot(path.direction).abs();
        path.receive(effects, light, scatterings);
        return false;
    }
    let continues = continues & ((lobe != LAMBERT) | effects.any(Effects::INTERREFLECTION));
    // After the last bounce a path can only arrive at a light, and lights that are sampled are not
    // looked for again.
    let is_last = path.bounces() == scenery.most_bounces();
    let seeks_all = effects.any(Effects::SOFT_SHADOWS) | !effects.any(Effects::EMISSION);
    let continues = continues & !(is_last & seeks_all & (scenery.launch.has_plain_sky == 0));
    let vertex = Vertex::new(scenery, lobe, path.direction, facing, material);
    if effects.any(Effects::HEADLAMP) && effects.any(Effects::PLASTIC) && lobe == PLASTIC {
        // The lamp has the same power as for Lambert. The coat also reflects the background.
        let (value, _) = vertex.evaluate(scenery, -path.direction);
        path.receive(effects, path.throughput * value * PI, scatterings);
    }
    let seeks = effects.any(SEEKING) && !scenery.lights.is_empty();
    if seeks {
        let light = light_from_seeking(scenery, path, place, &vertex, continues, numbers);
        receive(scenery, path, light.scattered(scatterings));
    }
    let is_connected =
        effects.any(Effects::CAUSTICS) && seeks & continues && !path.is_in_glass(effects);
    if is_connected {
        let light = light_by_sphere(scenery, path, place, &vertex, numbers);
        // Two surfaces of glass, or a mirror, scatter it before the vertex does.
        path.receive(effects, path.throughput * light, scatterings + 1);
    }
    if effects.any(Effects::AMBIENT_OCCLUSION) && lobe == LAMBERT {
        let direction = cosine_hemisphere(facing, numbers.direction());
        let weight = path.throughput * material.color;
        let light = ambient_light(scenery, place, direction, weight);
        receive(scenery, path, light.scattered(scatterings));
        return false;
    }
    if !continues {
        return false;
    }
    let direction = vertex.sample(scenery, numbers);
    let (value, density) = vertex.evaluate(scenery, direction);
    // Written so that a NaN ends the path.
    let is_possible = density > 0.0;
    if !is_possible {
        return false;
    }
    path.throughput *= value / density;
    path.leave(place, direction, if seeks { density } else { 0.0 });
    if effects.any(Effects::MANY_LIGHTS) {
        path.facing = facing;
    }
    if effects.any(Effects::CAUSTICS) {
        path.chain = if is_connected {
            Chain::fresh(surface.point, density)
        } else {
            Chain::LOST
        };
    }
    true
}

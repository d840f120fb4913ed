//! From a pixel to its light paths, vertex after vertex. Runs on the GPU and on the CPU.
//!
//! A thread works through its samples in one loop: where a path has ended the next begins, so that
//! neighbours whose paths are longer do not wait.

use glam::{UVec2, Vec2, Vec3};

use super::arrive::{arrive_at_lamp, arrive_at_sky};
use super::glass::{absorb, cross_glass};
use super::light_path::{Path, survives};
use super::random::Sampler;
use super::sampling::{cosine_hemisphere, disc, tangents};
use super::scenery::Scenery;
use super::seek::{ambient_light, light_from_seeking};
use super::vertex::{LAMBERT, METAL, PHASE, Vertex};
use crate::accel::traversal::Traversal;
use crate::effects::Effects;
use crate::film::Accumulator;
use crate::hit::Hit;
use crate::material::microfacet::{RoughMetal, SMOOTHEST, schlick};
use crate::material::optics::reflect;
use crate::material::{Material, material_of};
use crate::ray::Ray;
use crate::surface::{Surface, unit};

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

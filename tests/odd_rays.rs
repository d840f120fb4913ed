//! Rays of any bits: tracing them does not read out of bounds, panic or hang, and hits name spheres
//! that exist.

use glam::Vec3;
use spherule::accel::Acceleration;
use spherule::kernel::accel::brute::nearest_hit_in;
use spherule::kernel::{Hit, Ray, Rung, Sphere};
use spherule::random::Random;
use spherule::trace::CpuTracer;

/// Numbers at which arithmetic behaves oddly.
const ODD: [f32; 16] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    -1e24,
    1e30,
    f32::MIN_POSITIVE,
    -1e-42,
    0.0,
    -0.0,
    1e19,
    -1e10,
    1.0,
    -3.0,
    0.5,
];

fn number(random: &mut Random) -> f32 {
    match random.next_u32() % 4 {
        0 => f32::from_bits(random.next_u32()),
        1 => ODD[random.next_u32() as usize % ODD.len()],
        _ => random.within(-2.0, 2.0),
    }
}

fn vector(random: &mut Random) -> Vec3 {
    Vec3::new(number(random), number(random), number(random))
}

fn rays(random: &mut Random, count: usize) -> Vec<Ray> {
    let mut rays = vec![
        Ray::new(Vec3::NAN, Vec3::X),
        Ray::new(Vec3::splat(f32::INFINITY), Vec3::X),
        Ray::new(Vec3::new(-1e24, 0.0, 0.0), Vec3::X),
        Ray::new(Vec3::ZERO, Vec3::NAN),
        Ray::new(Vec3::ZERO, Vec3::ZERO),
        Ray::within(Vec3::ZERO, Vec3::X, f32::MIN, f32::MAX),
        Ray::within(Vec3::ZERO, Vec3::X, f32::NAN, f32::NAN),
    ];
    rays.extend((rays.len()..count).map(|_| {
        Ray::within(
            vector(random),
            vector(random),
            number(random),
            number(random),
        )
    }));
    rays
}

/// Whether the squares that the rungs compute neither overflow nor underflow.
fn is_within_domain(ray: &Ray) -> bool {
    let size = ray.direction.abs().max_element();
    (1e-10..1e10).contains(&size) && ray.origin.abs().max_element() < 1e10
}

/// Worlds of these sizes are traced in every way: one sphere after the other, in boxes of one and
/// of many levels, and in a tree.
#[test]
fn rays_of_any_bits_hit_spheres_that_exist_or_miss() {
    let mut random = Random::new(17);
    for count in [0, 1, 3, 20, 100, 900, 3000, 20_000] {
        let spheres: Vec<Sphere> = (0..count)
            .map(|_| Sphere::new(random.vec3(-2.0, 2.0), random.log_within(0.01, 0.3)))
            .collect();
        let rays = rays(&mut random, if count > 100 { 512 } else { 4096 });
        let tracer = CpuTracer::new(&spheres, Acceleration::Auto);
        let (mut hits, mut occluded) = (Vec::new(), Vec::new());
        for rung in Rung::ALL {
            tracer.nearest(rung, &rays, &mut hits);
            tracer.occluded(rung, &rays, &mut occluded);
            for ((ray, hit), occluded) in rays.iter().zip(&hits).zip(&occluded) {
                let name = format!("{count} spheres, {rung:?}, {ray:?}: {hit:?}");
                let is_none = hit.sphere == Hit::NONE_SPHERE && hit.t == Hit::NONE_T;
                assert!(is_none || (hit.sphere as usize) < count, "{name}");
                let is_number = ray.origin.is_finite() && ray.direction.is_finite();
                assert!(is_none || is_number, "{name}");
                // An interval whose end is NaN has no end.
                let is_beyond = hit.t < ray.t_min || hit.t >= ray.t_max;
                assert!(is_none || !is_beyond, "{name}");
                let is_checked = is_within_domain(ray);
                assert!(!is_checked || (*occluded == 1) == hit.is_some(), "{name}");
            }
            // A tree finds what testing every sphere finds.
            if count <= 900 {
                for (ray, hit) in rays.iter().zip(&hits) {
                    if !is_within_domain(ray) {
                        continue;
                    }
                    let all = nearest_hit_in(rung.to_u32(), ray, &spheres[..], 0, u32::MAX);
                    assert_eq!(*hit, all, "{count} spheres, {rung:?}, {ray:?}");
                }
            }
        }
    }
}

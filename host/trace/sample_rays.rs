//! Spheres and rays for the tests of this folder.

use glam::Vec3;
use spherule_kernel::{Ray, Sphere};

use crate::random::Random;

/// Spheres of many sizes, and one around all.
pub fn world(random: &mut Random, count: usize) -> Vec<Sphere> {
    let mut spheres: Vec<Sphere> = (0..count)
        .map(|_| Sphere::new(random.vec3(-1.0, 1.0), random.log_within(0.001, 0.1)))
        .collect();
    spheres.push(Sphere::new(Vec3::ZERO, 5.0));
    spheres
}

/// From anywhere to anywhere; some rays are short, and some start behind their origin.
pub fn rays(random: &mut Random) -> Vec<Ray> {
    (0..1600)
        .map(|index| {
            let (origin, direction) = (random.vec3(-1.5, 1.5), random.vec3(-1.0, 1.0));
            let (t_min, t_max) = match index % 4 {
                0 => (0.0, f32::MAX),
                1 => (1e-3, random.within(0.0, 2.0)),
                2 => (-3.0, 3.0),
                _ => (0.5, f32::MAX),
            };
            Ray::within(origin, direction, t_min, t_max)
        })
        .collect()
}

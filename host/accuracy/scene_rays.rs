//! The rays of a scene's camera as a family, each with a sphere.

use glam::UVec2;
use rayon::prelude::*;
use spherule_kernel::accel::brute::nearest_hit_in;
use spherule_kernel::{Ray, Rung, Sphere};

use crate::error::Result;
use crate::random::Random;
use crate::render::whole_image;
use crate::scene::Scene;

/// The most tests of rays with spheres that the pairing may take.
const MAX_TESTS: u64 = 1 << 31;

/// Up to `count` rays through random pixels of the scene, each with the sphere that it hits first,
/// or else the one whose silhouette it passes closest, in radii. Worlds with many spheres give
/// fewer rays, because every sphere is tested.
///
/// # Errors
///
/// [`Error::Scene`](crate::Error::Scene), as rendering the scene would return it.
pub fn sample(scene: &Scene, seed: u64, count: usize) -> Result<Vec<(Ray, Sphere)>> {
    let launch = whole_image(scene)?;
    let spheres = &scene.world.spheres;
    let most = MAX_TESTS / (spheres.len() as u64).max(1);
    let count = count.min(most.max(1000) as usize);
    let mut random = Random::new(seed);
    let size = launch.image_size;
    let rays: Vec<Ray> = (0..count)
        .map(|_| {
            let pixel = UVec2::new(random.next_u32() % size.x, random.next_u32() % size.y);
            launch.camera.pixel_ray(pixel, size)
        })
        .collect();
    Ok(rays
        .into_par_iter()
        .filter_map(|ray| {
            let hit = nearest_hit_in(Rung::Double.to_u32(), &ray, &spheres[..], 0, u32::MAX);
            let sphere = if hit.is_some() {
                spheres[hit.sphere as usize]
            } else {
                *spheres
                    .iter()
                    .min_by(|a, b| passing(&ray, a).total_cmp(&passing(&ray, b)))?
            };
            Some((ray, sphere))
        })
        .collect())
}

/// The distance of the line from the sphere's centre, in radii.
fn passing(ray: &Ray, sphere: &Sphere) -> f64 {
    let o = ray.origin.as_dvec3() - sphere.center().as_dvec3();
    let d = ray.direction.as_dvec3().normalize_or_zero();
    o.cross(d).length() / f64::from(sphere.radius())
}

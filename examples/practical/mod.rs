//! Shared by steps 1 to 3 of the practical: the camera, its rays and the colour of a miss.

#![allow(
    dead_code,
    reason = "each step compiles this module and uses a part of it"
)]

use glam::{UVec2, Vec3};
use spherule::kernel::{Camera, Hit, Pixel, Ray};

/// The size of the image, in pixels.
pub const SIZE: UVec2 = UVec2::new(640, 360);

/// A camera at the origin that looks along -z. At distance one, the image is one scene unit high.
pub fn camera() -> Camera {
    let aspect = SIZE.x as f32 / SIZE.y as f32;
    Camera::from_basis(
        Vec3::ZERO,
        Vec3::NEG_Z,
        Vec3::X * 0.5 * aspect,
        Vec3::Y * 0.5,
    )
}

/// The ray of each pixel, row by row.
pub fn rays() -> Vec<Ray> {
    let camera = camera();
    (0..SIZE.x * SIZE.y)
        .map(|index| camera.pixel_ray(UVec2::new(index % SIZE.x, index / SIZE.x), SIZE))
        .collect()
}

/// A grey pixel, for a ray that hits nothing.
pub fn miss() -> Pixel {
    Pixel::new(Vec3::splat(0.8), Hit::NONE_T)
}

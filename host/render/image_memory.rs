//! Memory for an image, before the work on it begins.

use crate::accel;
use crate::error::Result;
use crate::memory;
use crate::scene::Scene;

/// Memory for all that is small, in bytes.
const MARGIN: u64 = 4 << 20;

/// What a texel of the surroundings takes at most while tables are made of it: its probability, its
/// share of a vector that grows, and the table.
const BYTES_A_TEXEL: u64 = 64;

/// Whether there is memory for the image of `scene`, of which each pixel takes so many bytes on the
/// host, and for the tree: what is computed is not to be lost for want of it.
///
/// # Errors
///
/// [`OutOfHostMemory`](crate::Error::OutOfHostMemory) with the sum.
pub(super) fn memory_for(scene: &Scene, bytes_a_pixel: u64) -> Result<()> {
    let pixels = u64::from(scene.width) * u64::from(scene.height);
    let spheres = (scene.world.spheres.len() + scene.world.shapes.len()) as u64;
    let image = scene.sky.as_ref().and_then(|sky| sky.image.as_ref());
    let texels = image.map_or(0, |image| image.texels.len() as u64);
    memory::check(
        bytes_a_pixel
            .saturating_mul(pixels)
            .saturating_add(accel::BYTES_A_SPHERE * spheres + BYTES_A_TEXEL * texels + MARGIN),
        &format!(
            "an image of {} × {} pixels of {}",
            scene.width,
            scene.height,
            scene.world.contents(),
        ),
    )
}

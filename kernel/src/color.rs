//! Colours, which are linear Rec. 709. Runs on the GPU and on the CPU.

use glam::Vec3;

/// Relative luminance of a linear Rec. 709 colour.
#[inline]
#[must_use]
pub fn luminance(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

//! Boxes as a node stores them: quantised to sixteen bits a side, as distances from the node's
//! corner.

use glam::Vec3;
use spherule_kernel::accel::node::Node;

use super::aabb::Aabb;

/// The corner from which a node's sides are measured: a little below the smallest coordinates, so
/// that every distance is a normal positive number.
pub(super) fn corner_of(bounds: &Aabb) -> Vec3 {
    let (low, high) = (bounds.low.truncate(), bounds.high.truncate());
    let below = low - (high - low) * (1.0 / 512.0) - 1e-27;
    Vec3::from_array(below.to_array().map(f32::next_down))
}

/// The distances of a box's sides from the corner, rounded outwards to floats.
pub(super) fn sides(bounds: &Aabb, corner: Vec3) -> (Vec3, Vec3) {
    let corner = corner.as_dvec3();
    let low = (bounds.low.truncate().as_dvec3() - corner).as_vec3();
    let high = (bounds.high.truncate().as_dvec3() - corner).as_vec3();
    (
        Vec3::from_array(low.to_array().map(f32::next_down)),
        Vec3::from_array(high.to_array().map(f32::next_up)),
    )
}

/// Stores the sides of the eight boxes in a node, rounded outwards to sixteen bits.
pub(super) fn put_sides(boxes: &[(Vec3, Vec3); Node::WIDTH], node: &mut Node) {
    const LAST: usize = Node::WIDTH / 2;
    for axis in 0..3 {
        for word in 0..LAST {
            let (first, last) = (&boxes[word], &boxes[LAST + word]);
            // Positive floats are in the order of their bits.
            let low = first.0[axis].to_bits() >> 16;
            let high = first.1[axis].to_bits().div_ceil(1 << 16);
            // The whole word is the upper box's side: rounded down for a low side, up for a high
            // side.
            let low = (last.0[axis].to_bits().saturating_sub(low) >> 16) << 16 | low;
            let high = (last.1[axis].to_bits().saturating_sub(high)).div_ceil(1 << 16) << 16 | high;
            node.sides[axis][word] = low;
            node.sides[3 + axis][word] = high;
        }
    }
}

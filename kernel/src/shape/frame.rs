//! [`Frame`]: where an ellipsoid or a box is, and how it is turned. Runs on the GPU and on the CPU.

use glam::{Vec3, Vec4};

use super::span::splat3;
use crate::lane::{Lane, Lane3};

/// A centre and a rotation, as a quaternion of any length but zero: what it turns by is that of the
/// unit quaternion along it.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub(super) center: Vec3,
    /// The quaternion's vector, and its scalar.
    pub(super) rotation: Vec4,
}

impl Frame {
    /// The squared length of the quaternion.
    #[inline(always)]
    fn squared<L: Lane>(vector: Lane3<L>, scalar: L) -> L {
        vector.dot(vector) + scalar * scalar
    }

    /// A vector of the scene, in the frame, times the squared length of the quaternion:
    /// (w² − q·q) v + 2 (q·v) q − 2w q × v.
    // No closures: in lanes they would be compiled without the caller's instructions.
    #[inline(always)]
    fn into_frame<L: Lane>(vector: Lane3<L>, scalar: L, v: Lane3<L>) -> Lane3<L> {
        let two = scalar.splat(2.0);
        let along = vector.scaled(two * vector.dot(v));
        let turned = vector.cross(v).scaled(two * scalar);
        let rest = v.scaled(scalar * scalar - vector.dot(vector));
        rest.plus(along).minus(turned)
    }

    /// A line in the frame, from the point that is nearest to the centre: that point's parameter,
    /// the point, and the direction.
    #[inline(always)]
    pub(super) fn line<L: Lane>(&self, o: Lane3<L>, d: Lane3<L>) -> (L, Lane3<L>, Lane3<L>) {
        let like = o.x;
        let o = o.minus(splat3(like, self.center));
        let nearest = -(o.dot(d) / d.dot(d));
        let p = o.minus_scaled(d, -nearest);
        let (vector, scalar) = (
            splat3(like, self.rotation.truncate()),
            like.splat(self.rotation.w),
        );
        let inverse = like.splat(1.0) / Self::squared(vector, scalar);
        (
            nearest,
            Self::into_frame(vector, scalar, p).scaled(inverse),
            Self::into_frame(vector, scalar, d).scaled(inverse),
        )
    }

    /// A point, given from the centre, in the frame.
    #[inline]
    pub(super) fn local(&self, from_center: Vec3) -> Vec3 {
        let (vector, scalar) = (Lane3::of(self.rotation.truncate()), self.rotation.w);
        let turned = Self::into_frame(vector, scalar, Lane3::of(from_center));
        turned.to_vec3() / Self::squared(vector, scalar)
    }

    /// A vector of the frame, in the scene.
    #[inline]
    pub(super) fn global(&self, local: Vec3) -> Vec3 {
        // The other way round.
        let (vector, scalar) = (Lane3::of(-self.rotation.truncate()), self.rotation.w);
        let turned = Self::into_frame(vector, scalar, Lane3::of(local));
        turned.to_vec3() / Self::squared(vector, scalar)
    }

    /// How far a box with these halves of its sides reaches along each axis of the scene.
    #[cfg(not(target_arch = "spirv"))]
    pub(super) fn reach(&self, half: Vec3) -> Vec3 {
        let sides = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| self.global(axis));
        sides[0].abs() * half.x + sides[1].abs() * half.y + sides[2].abs() * half.z
    }

    /// How far an ellipsoid with these half-axes reaches along each axis of the scene.
    #[cfg(not(target_arch = "spirv"))]
    pub(super) fn reach_of_ellipsoid(&self, half: Vec3) -> Vec3 {
        let sides = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| self.global(axis));
        let squared = |side: Vec3, half: f32| (side * half) * (side * half);
        let sum = squared(sides[0], half.x) + squared(sides[1], half.y) + squared(sides[2], half.z);
        Vec3::from_array(sum.to_array().map(f32::sqrt))
    }

    /// Whether all numbers are finite, and the quaternion is none of zeros.
    #[cfg(not(target_arch = "spirv"))]
    pub(super) fn is_valid(&self) -> bool {
        let squared = self.rotation.dot(self.rotation);
        self.center.is_finite() && (1e-30..1e30).contains(&squared)
    }

    /// The rotation for [`Quat`](glam::Quat).
    #[cfg(not(target_arch = "spirv"))]
    pub(super) fn of_quat(rotation: glam::Quat) -> Vec4 {
        Vec4::from(rotation)
    }
}

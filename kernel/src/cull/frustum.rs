//! [`Frustum`]: four planes around the rays of a rectangle of the film. Runs on the GPU and on the
//! CPU.
//!
//! A camera's rays go along F + x R + y U. Take the plane through the eye along F + x₀ R and U. The
//! rays with x ≥ x₀ are on one side of it, whatever y is: its normal is n = (F + x₀ R) × U, and the
//! product of n and a ray's direction is (x − x₀) n·R. Three more such planes bound a rectangle of
//! the film.
//!
//! Let o = C − O and s = o·n, with n of unit length and pointing inward. A sphere is beyond a
//! plane, and none of the rays meets it, where its centre is beyond the plane by more than its
//! radius: where s < −r.
//!
//! In 32-bit floats, with u = 2⁻²⁴:
//!
//! - s is off by 4u|o| for its terms.
//! - A plane is used only if F + x₀ R is at least half as long as its terms would be at a right
//!   angle, F + x₀ R is at least 30° away from U, and n is at least 30° away from the plane across
//!   R.
//! - Then n is off by 29u, of which 12u are a device's quotient and root, and the terms of every
//!   direction inside are at most 17 times as long as the direction itself, so that rays leave the
//!   plane by 51u|o|.
//! - Together s is off by 90u|o|.
//! - From robust up, a rung's hit is on a line that the centre is at most r + 19u(|o| + r) away
//!   from: what puts the foot of the perpendicular off by 17u|o|.
//!
//! So 128u(|o| + r) is added to r, and none of these rungs' hits is lost. |o| is taken for the sum
//! of its components' magnitudes, which is larger.
//!
//! [`textbook`](crate::precision::textbook) may find a hit that exact arithmetic misses by
//! 24u (o·o + r²), so that a sphere far away is much larger for it than for the others. For it,
//! 256u (o·o + r²) is added to r², of which 168u are those 90u|o| of s.

use glam::{Vec2, Vec3, Vec4};

use crate::camera::Camera;
use crate::lane::{Lane, Lane3};
use crate::precision::Rung;
use crate::sphere::Sphere;

/// 128u.
const SLACK: f32 = 1.0 / (1 << 17) as f32;
/// 256u.
const SLACK_OF_SQUARES: f32 = 1.0 / (1 << 16) as f32;

/// Four planes around the rays through a rectangle of the film.
#[derive(Clone, Copy, Debug)]
pub struct Frustum {
    eye: Vec3,
    left: Plane,
    right: Plane,
    below: Plane,
    above: Plane,
}

/// A plane through the eye, as its inward normal of unit length. The normal is zero, and culls
/// nothing, where rounding might decide which way it points.
#[derive(Clone, Copy, Debug)]
pub struct Plane(Vec3);

impl Plane {
    /// One of the four planes around the rays through the film from `low` to `high`: `which` is 0
    /// for left, 1 for right, 2 for below, 3 for above.
    #[inline]
    #[must_use]
    pub fn around(camera: &Camera, low: Vec2, high: Vec2, which: u32) -> Self {
        let is_across = which < 2;
        let is_high = which & 1 == 1;
        let (across, axis) = if is_across {
            (camera.right, camera.up)
        } else {
            (camera.up, camera.right)
        };
        let end = if is_high { high } else { low };
        let offset = across * if is_across { end.x } else { end.y };
        let towards = if is_high { -across } else { across };
        Self(
            inward_normal(
                Lane3::of(camera.forward),
                Lane3::of(offset),
                Lane3::of(axis),
                Lane3::of(towards),
            )
            .to_vec3(),
        )
    }

    /// The plane as one vector, for a single 16-byte store.
    #[inline]
    #[must_use]
    pub fn to_vec4(self) -> Vec4 {
        self.0.extend(0.0)
    }

    /// The plane from the vector that [`Plane::to_vec4`] gave.
    #[inline]
    #[must_use]
    pub fn from_vec4(vector: Vec4) -> Self {
        Self(vector.truncate())
    }
}

/// The inward normal, of unit length, of the plane along the ray `forward + offset` and an axis of
/// the film; its inside is on the side of `towards`. It is zero where rounding in 32-bit floats
/// might decide which way it points. In lanes.
#[inline(always)]
#[must_use]
pub fn inward_normal<L: Lane>(
    forward: Lane3<L>,
    offset: Lane3<L>,
    axis: Lane3<L>,
    towards: Lane3<L>,
) -> Lane3<L> {
    let ray = forward.plus(offset);
    let normal = ray.cross(axis);
    let (squared, inward) = (normal.dot(normal), normal.dot(towards));
    let (quarter, zero) = (squared.splat(0.25), squared.splat(0.0));
    let is_long = ray
        .dot(ray)
        .simd_gt(quarter * (forward.dot(forward) + offset.dot(offset)));
    let is_wide = squared.simd_gt(quarter * (ray.dot(ray) * axis.dot(axis)));
    let is_sure = (inward * inward).simd_gt(quarter * (squared * towards.dot(towards)));
    let root = squared.sqrt();
    let length = L::select(inward.simd_lt(zero), -root, root);
    let is_usable = is_long & is_wide & is_sure;
    let scale = squared.splat(1.0) / length;
    let of = |component: L| L::select(is_usable, component * scale, zero);
    Lane3 {
        x: of(normal.x),
        y: of(normal.y),
        z: of(normal.z),
    }
}

impl Frustum {
    /// The frustum around the rays through the film from `low` to `high`, in coordinates of
    /// [`Camera::film`].
    #[inline]
    #[must_use]
    pub fn around(camera: &Camera, low: Vec2, high: Vec2) -> Self {
        let of = |which| Plane::around(camera, low, high, which);
        Self::within(camera.eye, [of(0), of(1), of(2), of(3)])
    }

    /// The frustum within these four planes through an eye.
    #[inline]
    #[must_use]
    pub fn within(eye: Vec3, [left, right, below, above]: [Plane; 4]) -> Self {
        Self {
            eye,
            left,
            right,
            below,
            above,
        }
    }

    /// Whether it is certain that none of the rays meets the sphere on this rung, a value of
    /// [`Rung::to_u32`].
    #[inline]
    #[must_use]
    pub fn misses(&self, rung: u32, sphere: Sphere) -> bool {
        let o = sphere.center() - self.eye;
        let across = least(o.dot(self.left.0), o.dot(self.right.0));
        let upwards = least(o.dot(self.below.0), o.dot(self.above.0));
        let farthest = least(across, upwards);
        if rung == Rung::Textbook.to_u32() {
            let (oo, rr) = (o.dot(o), sphere.radius() * sphere.radius());
            (farthest < 0.0) & (farthest * farthest > rr + SLACK_OF_SQUARES * (oo + rr))
        } else {
            let (size, r) = (o.abs().element_sum(), sphere.radius().abs());
            farthest < -(r + SLACK * (size + r))
        }
    }
}

/// The smaller of two numbers; NaN if `a` is NaN.
#[inline]
fn least(a: f32, b: f32) -> f32 {
    if b < a { b } else { a }
}

//! The first step of [`Certified`](super::Certified): which rays miss for certain, in f32. Runs on
//! the GPU and on the CPU.
//!
//! The errors, with u = 2⁻²⁴, from o = O − C through b/a to the foot f = o − (b/a)d:
//!
//! - f is off by at most 15u|o| + u|f|, because |(b/a)d| ≤ |o|, with a quotient off by 2.5 units in
//!   the last place. So f·f is off by 30u|f||o| + 5u f·f + 226u²o·o ≤ 21u (f·f + o·o), and r² by
//!   u r².
//! - A line misses for certain where f·f − r² > 32u (f·f + o·o + r²).
//! - Where c is certainly positive, a ray with b > 0 and `t_min` ≥ 0 leaves and misses: if b were
//!   truly negative, it would be so by 8u|o||d| at most, and a hit needs b² ≥ ac.
//! - Where the ray enters, t is at least (|b| − √(a(r² − f·f + E)))/a, minus 32u of its terms, with
//!   E = 32u (f·f + o·o + r²). Beyond the end of the ray's interval the hit does not matter.
//!
//! Operations may be fused or not, and division and root off by a few units in the last place: the
//! factor 32 covers all of these errors twice over.

// On the CPU, std has `f32::sqrt`.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use crate::ray::Ray;
use crate::sphere::Sphere;

/// 32u.
const FILTER: f32 = 1.0 / (1 << 19) as f32;

/// What is added to the filter's sum of squares, so that a subnormal square decides nothing.
const SMALLEST: f32 = 1e-30;

/// Whether the ray misses for certain. False for NaN, and for a direction whose square is
/// not between [`SMALLEST`] and the largest float.
#[inline]
#[must_use]
pub fn misses_for_certain(sphere: Sphere, ray: &Ray) -> bool {
    let o = ray.origin - sphere.center();
    let d = ray.direction;
    let a = d.dot(d);
    let b = o.dot(d);
    // This is the same for every sphere that the ray is tested against.
    let inverse = 1.0 / a;
    let foot = o - d * (b * inverse);
    let (ff, oo) = (foot.dot(foot), o.dot(o));
    let rr = sphere.radius() * sphere.radius();
    let squares = oo + rr + SMALLEST;
    let has_length = (SMALLEST..f32::MAX).contains(&a);
    let passes_by = ff - rr > FILTER * (ff + squares);
    let is_outside = has_length & (oo - rr > FILTER * squares);
    if (has_length & passes_by) | (is_outside & (b > 0.0) & (ray.t_min >= 0.0)) {
        return true;
    }
    if is_outside {
        let discriminant = (rr - ff).max(0.0) + FILTER * (ff + squares);
        let root = (a * discriminant).sqrt();
        let size = (a * oo).sqrt() + root;
        let nearest = (-b - root - FILTER * size) / a;
        return nearest > ray.t_max + ray.t_max.abs() * FILTER;
    }
    false
}

//! [`Primitives`]: what a walk through a tree asks about, spheres or other shapes, by their
//! indices. Runs on the GPU and on the CPU.

use super::node::Extent;
use super::slabs::Slabs;
use crate::cull::bounds::{Bounds, Line};
use crate::ray::Ray;

/// What a ray may hit, by index: all of one type, whose code a walk is compiled with.
pub trait Primitives {
    /// One of them.
    type One: Copy;

    /// Whether there are [bounds](Primitives::bounds), so that slow rungs are asked about the
    /// nearest alone.
    const HAVE_BOUNDS: bool;

    /// How many there are.
    fn total(&self) -> u32;

    /// The one with this index.
    ///
    /// # Safety
    ///
    /// `index` is below [`Primitives::total`].
    unsafe fn one(&self, index: u32) -> Self::One;

    /// Whether a ray passes over the one with this index: a ray that asks for any hit, or one that
    /// asks for the nearest.
    #[inline]
    fn is_passed_over<const ANY: bool>(&self, index: u32) -> bool {
        let _ = index;
        false
    }

    /// The parameter where a ray hits one on a rung, or the first launch of two defers it.
    fn ask(rung: u32, one: Self::One, ray: &Ray) -> f32;

    /// The same on a rung that is not [lazy](crate::precision::is_lazy), or if there are no bounds.
    #[inline]
    fn ask_at_once(rung: u32, one: Self::One, ray: &Ray) -> f32 {
        Self::ask(rung, one, ray)
    }

    /// The same where bounds say that the ray enters it between two parameters of the line.
    #[inline]
    fn ask_entry(rung: u32, one: Self::One, ray: &Ray, line: &Line, low: f32, high: f32) -> f32 {
        let _ = (line, low, high);
        Self::ask(rung, one, ray)
    }

    /// What is certain about a line and one of them.
    #[inline]
    fn bounds(line: &Line, one: Self::One) -> Bounds {
        let _ = (line, one);
        Bounds {
            misses: false,
            hits: false,
            low: 0.0,
            high: 0.0,
        }
    }

    /// Whether the line may hit one of them.
    #[inline]
    fn may_hit(line: &Line, one: Self::One) -> bool {
        let _ = (line, one);
        true
    }

    /// A ray, prepared for the boxes around them.
    fn slabs(rung: u32, ray: &Ray, world: &Extent) -> Slabs;
}

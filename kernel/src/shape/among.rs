//! [`Shapes`]: the shapes of a world beside its spheres, and how rays find them. Runs on the GPU
//! and on the CPU.
//!
//! Shapes stand in a tree of their own: a ray first finds its nearest sphere, and then asks for a
//! shape up to there. So what finds spheres is the same as in a world of spheres alone, and a leaf
//! never holds both.

use glam::{Vec3, Vec4};

use super::{Kinds, Shape};
use crate::accel::node::{Extent, Tree};
use crate::accel::primitives::Primitives;
use crate::accel::slabs::Slabs;
use crate::accel::walk::{any_hit_in_tree, nearest_hit_in_tree};
use crate::arithmetic::U;
use crate::arithmetic::elements::read;
use crate::effects::Effects;
use crate::hit::Hit;
use crate::precision::Rung;
use crate::ray::Ray;
use crate::surface::Surface;

/// The shapes of a world beside its spheres, in the order of the tree that holds them.
#[derive(Clone, Copy, Debug)]
pub struct Shapes<'a> {
    /// The kinds that there are; with none, nothing is asked.
    pub kinds: Kinds,
    /// The shapes.
    pub shapes: &'a [Shape],
    /// The tree over all of them.
    pub tree: Tree<'a>,
    /// The index of the first in hits: indices below are those of spheres.
    pub first: u32,
}

#[cfg(not(target_arch = "spirv"))]
impl Shapes<'_> {
    /// No shapes.
    pub const NONE: Self = Self {
        kinds: Kinds::NONE,
        shapes: &[],
        tree: Tree::NONE,
        first: 0,
    };
}

impl Shapes<'_> {
    /// Whether a hit with this index is one of a shape.
    #[inline]
    #[must_use]
    pub fn have(&self, index: u32) -> bool {
        !self.kinds.is_empty() && index >= self.first
    }

    /// The hit, or that of a shape if it is nearer; of two as near, that of the sphere. A ray that
    /// leaves the shape with the index `left` meets it where it comes out, if it goes in.
    #[inline]
    #[must_use]
    pub fn nearest_hit(
        &self,
        rung: u32,
        ray: &Ray,
        hit: Hit,
        left: u32,
        motion: impl Motion,
    ) -> Hit {
        if self.kinds.is_empty() {
            return hit;
        }
        let up_to = Ray {
            t_max: ray.t_max.min(hit.t),
            ..*ray
        };
        let found = nearest_hit_in_tree(rung, &up_to, self.tree, &self.moving(left, motion));
        self.counted(found, hit)
    }

    /// Whether the ray hits a shape.
    #[inline]
    #[must_use]
    pub fn are_hit(&self, rung: u32, ray: &Ray, left: u32, motion: impl Motion) -> bool {
        !self.kinds.is_empty()
            && any_hit_in_tree(rung, ray, self.tree, &self.moving(left, motion)).is_some()
    }

    /// The surface of the shape with this index in hits, where a ray has the parameter `t`.
    #[inline]
    #[must_use]
    pub fn surface(&self, ray: &Ray, t: f32, index: u32, motion: impl Motion) -> Surface {
        self.shape(index, motion).surface(self.kinds, ray, t)
    }

    /// Half of the thickness of the shape with this index in hits, in scene units.
    #[inline]
    #[must_use]
    pub fn size(&self, index: u32) -> f32 {
        read(self.shapes, index.wrapping_sub(self.first) as usize).thickness(self.kinds)
    }

    /// The shape with this index in hits, where it is at the time; zeros for an index beyond them.
    #[inline]
    #[must_use]
    pub fn shape(&self, index: u32, motion: impl Motion) -> Shape {
        let at = index.wrapping_sub(self.first);
        motion.moved(self.kinds, read(self.shapes, at as usize), index)
    }

    #[inline]
    fn moving<M: Motion>(&self, left: u32, motion: M) -> MovingShapes<'_, M> {
        MovingShapes {
            shapes: *self,
            left: left.wrapping_sub(self.first),
            motion,
        }
    }

    /// A hit with its index among all of the world, or otherwise another.
    #[inline]
    fn counted(&self, found: Hit, otherwise: Hit) -> Hit {
        if found.is_some() {
            Hit {
                t: found.t,
                sphere: found.sphere.wrapping_add(self.first),
            }
        } else {
            otherwise
        }
    }
}

/// Where shapes are.
pub trait Motion: Copy {
    /// A shape of these kinds, with this index in hits, where it is.
    fn moved(self, kinds: Kinds, shape: Shape, index: u32) -> Shape;
}

/// All shapes are where they are given.
#[derive(Clone, Copy, Debug)]
pub struct Resting;

impl Motion for Resting {
    #[inline]
    fn moved(self, _: Kinds, shape: Shape, _: u32) -> Shape {
        shape
    }
}

/// Shapes that move are where they are at one time.
#[derive(Clone, Copy, Debug)]
pub struct AtTime<'a> {
    /// The effects of the pipeline: without [`Effects::MOTION_BLUR`] all are at rest.
    pub effects: Effects,
    /// The time.
    pub time: f32,
    /// How each moves, by its index in hits, in scene units per unit of time; those beyond the end
    /// are at rest.
    pub velocities: &'a [Vec4],
}

impl Motion for AtTime<'_> {
    #[inline]
    fn moved(self, kinds: Kinds, shape: Shape, index: u32) -> Shape {
        let index = index as usize;
        if self.effects.any(Effects::MOTION_BLUR) && index < self.velocities.len() {
            shape.moved(kinds, self.velocities[index].truncate() * self.time)
        } else {
            shape
        }
    }
}

/// Shapes where they are at one time, for a ray that leaves one of them.
struct MovingShapes<'a, M> {
    shapes: Shapes<'a>,
    /// The place of the shape that the ray leaves.
    left: u32,
    motion: M,
}

/// A shape, and whether the ray leaves it.
#[derive(Clone, Copy)]
struct Asked {
    shape: Shape,
    kinds: Kinds,
    is_left: bool,
}

impl<M: Motion> Primitives for MovingShapes<'_, M> {
    type One = Asked;

    const HAVE_BOUNDS: bool = false;

    #[inline]
    fn total(&self) -> u32 {
        self.shapes.shapes.len().min(u32::MAX as usize) as u32
    }

    #[inline]
    unsafe fn one(&self, index: u32) -> Asked {
        let shape = read(self.shapes.shapes, index as usize);
        Asked {
            shape: self.motion.moved(
                self.shapes.kinds,
                shape,
                index.wrapping_add(self.shapes.first),
            ),
            kinds: self.shapes.kinds,
            is_left: index == self.left,
        }
    }

    #[inline]
    fn ask(rung: u32, one: Asked, ray: &Ray) -> f32 {
        let span = one.shape.span(rung, one.kinds, ray);
        if one.is_left {
            span.exit(ray)
        } else {
            span.first(ray)
        }
    }

    // Boxes are widened by what a rung may be off: 128u D, where D is the distance to the farthest
    // corner of the extent, and on `textbook` √(r² + 128u D²) − r, where r is the radius of the
    // thinnest. Where a line is nearly along an axis, nothing bounds what `textbook` is off by:
    // hits that it puts outside of the widened box may be found or not.
    #[inline]
    fn slabs(rung: u32, ray: &Ray, world: &Extent) -> Slabs {
        let far = (world.low - ray.origin)
            .abs()
            .max((world.high - ray.origin).abs());
        let widening = if rung == Rung::Textbook.to_u32() {
            let (r, squared) = (world.smallest_radius, far.dot(far) * (128.0 * U));
            squared / (root(r * r + squared) + r).max(f32::MIN_POSITIVE)
        } else {
            far.dot(Vec3::ONE) * (128.0 * U)
        };
        Slabs::widened(ray, world, widening)
    }
}

#[inline]
fn root(number: f32) -> f32 {
    crate::lane::Lane::sqrt(number)
}

//! [`Single`]: rays on the CPU, without an image.
//!
//! Spheres are culled four at a time by the [discriminant](spherule_kernel::cull::discriminant),
//! whose slack covers every rung. The rung is evaluated only for possible hits; slow rungs only for
//! the nearest sphere at the end, and for those that [`bounds`](spherule_kernel::cull::bounds)
//! leave open. With AVX2, which is detected at run time, the eight boxes of a node are tested at
//! once, too; without it the kernel's walk is used. With AVX-512, rays in worlds that are not too
//! large go through [`Levels`] instead, sixteen at a time. Many rays among few spheres are tested
//! side by side.

use fearless_simd::Level;
use spherule_kernel::accel::brute::MovingSpheres;
use spherule_kernel::accel::node::Tree;
use spherule_kernel::accel::traversal::Traversal;
use spherule_kernel::accel::walk::{is_occluded_in_tree, nearest_hit_in_tree};
use spherule_kernel::{Effects, Hit, Ray, Rung, Sphere};

#[cfg(target_arch = "x86_64")]
use super::avx512::Avx512;
use super::few;
use super::levels::Levels;
use super::search::{Query, Resting, left};
#[cfg(target_arch = "x86_64")]
use super::stream;
#[cfg(target_arch = "x86_64")]
use super::walk::{self, Features};
use crate::cpu::InstructionSet;

/// Finds the hits of rays on one rung, in a tree or without one.
#[derive(Clone, Copy, Debug)]
pub struct Single<'a> {
    query: Query<'a>,
    level: Level,
    /// The proof that the machine has them.
    #[cfg(target_arch = "x86_64")]
    features: Option<Features>,
    /// The tree's boxes in levels, and the proof of the instructions for them.
    #[cfg(target_arch = "x86_64")]
    levels: Option<(Avx512, &'a Levels)>,
}

impl<'a> Single<'a> {
    /// A tracer for one rung. With a tree, the spheres must be in the order of its leaves, and
    /// `levels` those of the tree.
    #[must_use]
    pub fn new(rung: Rung, tree: Tree<'a>, levels: Option<&'a Levels>) -> Self {
        #[cfg(target_arch = "x86_64")]
        let features = Features::of(InstructionSet::chosen());
        #[cfg(target_arch = "x86_64")]
        let levels = Avx512::of(InstructionSet::chosen()).zip(levels);
        #[cfg(not(target_arch = "x86_64"))]
        let _ = levels;
        Self {
            query: Query::new(rung, tree),
            level: InstructionSet::chosen()
                .level()
                .unwrap_or(Level::baseline()),
            #[cfg(target_arch = "x86_64")]
            features,
            #[cfg(target_arch = "x86_64")]
            levels,
        }
    }

    /// Finds what each ray hits: the nearest, or with `ANY` the first that is found. `lefts` has
    /// the index of the sphere over which each ray passes; beyond its end there is none. `put`
    /// receives each ray's index and hit, in any order.
    pub fn trace<const ANY: bool>(
        &self,
        rays: &[Ray],
        lefts: &[u32],
        spheres: &[Sphere],
        mut put: impl FnMut(usize, Hit),
    ) {
        if self.query.rung.is_bounded() && spheres.len() <= few::FEW {
            few::trace::<ANY>(self.level, &self.query, rays, lefts, spheres, put);
            return;
        }
        #[cfg(target_arch = "x86_64")]
        if let Some((wide, levels)) = self.levels
            && levels.sphere_count <= spheres.len()
        {
            // SAFETY: the machine has AVX-512, as the proof says.
            unsafe { stream::trace::<ANY>(wide, levels, &self.query, rays, lefts, spheres, put) };
            return;
        }
        #[cfg(target_arch = "x86_64")]
        if let (Some(features), true) = (self.features, self.has_tree()) {
            walk::trace::<ANY, _>(features, &self.query, rays, lefts, spheres, put);
            return;
        }
        for (index, ray) in rays.iter().enumerate() {
            let resting = MovingSpheres {
                spheres,
                velocities: &[],
                time: 0.0,
                effects: Effects::NONE,
                left: left(lefts, index),
                target: Hit::NONE_SPHERE,
            };
            put(index, self.trace_one::<ANY, _>(ray, &resting));
        }
    }

    /// The instructions of this machine that rays side by side use.
    #[must_use]
    pub(crate) fn level(&self) -> Level {
        self.level
    }

    /// Finds where each ray hits a sphere of its own, of which there are as many as rays. `put`
    /// receives, in order, the ray's index and the parameter, [`Hit::NONE_T`] for no hit.
    pub(crate) fn meet(&self, rays: &[Ray], spheres: &[Sphere], mut put: impl FnMut(usize, f32)) {
        if self.query.rung.is_bounded() {
            few::meet(self.level, &self.query, rays, spheres, put);
            return;
        }
        for (index, (ray, sphere)) in rays.iter().zip(spheres).enumerate() {
            put(index, self.query.intersect(*sphere, ray));
        }
    }

    fn has_tree(&self) -> bool {
        !self.query.tree.is_none()
    }

    /// Finds what one ray hits, as [`Single::trace`] does for many.
    pub fn trace_one<const ANY: bool, S: Resting + ?Sized>(&self, ray: &Ray, spheres: &S) -> Hit {
        if !self.has_tree() {
            let mut search = self.query.search(ray, spheres.left());
            search.test::<ANY, S>(spheres, 0, spheres.count());
            return search.finish::<ANY>();
        }
        #[cfg(target_arch = "x86_64")]
        if let (Some((wide, levels)), Some(at_rest)) = (self.levels, spheres.at_rest())
            && levels.groups.len() <= 2
            && levels.sphere_count <= at_rest.len()
        {
            let query = &self.query;
            // SAFETY: the machine has AVX-512, as the proof says.
            return unsafe {
                stream::trace_one::<ANY, S>(wide, levels, query, ray, spheres, at_rest)
            };
        }
        #[cfg(target_arch = "x86_64")]
        if let Some(features) = self.features {
            return walk::trace_one::<ANY, S>(features, &self.query, ray, spheres);
        }
        let rung = self.query.rung.to_u32();
        if ANY {
            if is_occluded_in_tree(rung, ray, self.query.tree, spheres) {
                Hit { t: 0.0, sphere: 0 }
            } else {
                Hit::NONE
            }
        } else {
            nearest_hit_in_tree(rung, ray, self.query.tree, spheres)
        }
    }
}

impl Traversal for Single<'_> {
    #[inline]
    fn nearest_hit(&self, ray: &Ray, spheres: &MovingSpheres<'_>) -> Hit {
        self.trace_one::<false, _>(ray, spheres)
    }

    #[inline]
    fn is_occluded(&self, ray: &Ray, spheres: &MovingSpheres<'_>) -> bool {
        self.trace_one::<true, _>(ray, spheres).is_some()
    }
}

//! [`Search`]: one ray's search among spheres; [`Query`]: what all rays have in common.
//!
//! Four spheres at a time are culled by the [discriminant](spherule_kernel::cull::discriminant),
//! whose slack covers every rung. The rung is evaluated only for possible hits. Slow rungs are
//! evaluated only for the nearest sphere at the end, and for those that
//! [`bounds`](spherule_kernel::cull::bounds) leave open.

use glam::{Mat4, Vec4};
#[cfg(target_arch = "x86_64")]
use spherule_kernel::Effects;
use spherule_kernel::accel::brute::{MovingSpheres, Spheres};
use spherule_kernel::accel::node::Tree;
#[cfg(target_arch = "x86_64")]
use spherule_kernel::accel::node::{Extent, Node};
use spherule_kernel::cull::bounds::Line;
use spherule_kernel::cull::discriminant::Target;
use spherule_kernel::lane::Lane3;
use spherule_kernel::precision::{self, OnRung, Precision, Robust, certified};
use spherule_kernel::{Hit, Ray, Rung, Sphere};

#[cfg(target_arch = "x86_64")]
use super::avx512::{self, Avx512};
use crate::lanes::Four;

/// Spheres that are culled at a time.
const WIDTH: usize = 4;

/// What all rays have in common: the rung's formula, and the tree if there is one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Query<'a> {
    /// The rung.
    pub(super) rung: Rung,
    /// The rung's formula.
    intersect: fn(Sphere, &Ray) -> f32,
    /// The tree; without nodes if every sphere is to be tested.
    pub(super) tree: Tree<'a>,
    /// The extent in the tree's first node.
    #[cfg(target_arch = "x86_64")]
    pub(super) extent: Extent,
}

impl<'a> Query<'a> {
    pub(super) fn new(rung: Rung, tree: Tree<'a>) -> Self {
        /// The rung's formula, compiled for it.
        struct Formula;
        impl OnRung for Formula {
            type Output = fn(Sphere, &Ray) -> f32;

            fn run<const RUNG: u32>(self) -> Self::Output {
                intersect::<RUNG>
            }
        }
        fn intersect<const RUNG: u32>(sphere: Sphere, ray: &Ray) -> f32 {
            precision::intersect(RUNG, sphere, ray)
        }
        Self {
            rung,
            intersect: rung.with(Formula),
            tree,
            #[cfg(target_arch = "x86_64")]
            extent: Extent::of_node(tree.nodes().first().unwrap_or(&Node::default())),
        }
    }

    /// The parameter at which a ray hits a sphere, by the rung's formula.
    #[inline]
    pub(super) fn intersect(&self, sphere: Sphere, ray: &Ray) -> f32 {
        (self.intersect)(sphere, ray)
    }

    /// Starts the search of a ray that leaves the sphere with the index `left`: see
    /// [`Resting::left`].
    #[inline(always)]
    pub(super) fn search(&self, ray: &Ray, left: u32) -> Search {
        Search::of(self.rung, self.intersect, ray, left)
    }
}

/// The sphere over which the ray with this index passes; beyond the end of `lefts` there is none.
#[inline(always)]
pub(super) fn left(lefts: &[u32], ray: usize) -> u32 {
    lefts.get(ray).copied().unwrap_or(Hit::NONE_SPHERE)
}

/// Spheres that may be contiguous in memory.
pub trait Resting: Spheres {
    /// All spheres as [`Spheres::sphere`] returns them; `None` if they move.
    #[cfg(target_arch = "x86_64")]
    fn at_rest(&self) -> Option<&[Sphere]>;

    /// The index of the sphere over which rays pass, [`Hit::NONE_SPHERE`] for none.
    fn left(&self) -> u32;
}

impl Resting for [Sphere] {
    #[cfg(target_arch = "x86_64")]
    #[inline]
    fn at_rest(&self) -> Option<&[Sphere]> {
        Some(self)
    }

    #[inline]
    fn left(&self) -> u32 {
        Hit::NONE_SPHERE
    }
}

impl Resting for MovingSpheres<'_> {
    #[cfg(target_arch = "x86_64")]
    #[inline]
    fn at_rest(&self) -> Option<&[Sphere]> {
        let moves = self.effects.any(Effects::MOTION_BLUR) & !self.velocities.is_empty();
        (!moves).then_some(self.spheres)
    }

    #[inline]
    fn left(&self) -> u32 {
        self.left
    }
}

/// A ray's search among spheres.
#[derive(Clone, Copy)]
pub(super) struct Search {
    intersect: fn(Sphere, &Ray) -> f32,
    /// Whether the rung is slow and is evaluated at the end, as in the kernel's walk.
    is_lazy: bool,
    is_robust: bool,
    is_certified: bool,
    /// Whether the rung's hits lie within [`bounds`](spherule_kernel::cull::bounds).
    #[cfg(target_arch = "x86_64")]
    is_bounded: bool,
    /// The index of the sphere that is passed over.
    left: u32,
    /// The ray. Its end is lowered to where a sphere could still be nearer.
    pub(super) ray: Ray,
    /// The ray's own end.
    end: f32,
    line: Line,
    /// The nearest hit so far. While there is a `deferred` sphere, `t` is an upper bound.
    pub(super) hit: Hit,
    /// The nearest sphere, if the rung was not evaluated for it yet.
    deferred: Option<Sphere>,
    /// A sphere that is certainly hit before this is nearer than what was found; in the line's
    /// units.
    low: f32,
}

impl Search {
    #[inline(always)]
    fn of(rung: Rung, intersect: fn(Sphere, &Ray) -> f32, ray: &Ray, left: u32) -> Self {
        let line = Line::of(ray);
        Self {
            intersect,
            is_lazy: precision::is_lazy(rung.to_u32()),
            is_robust: rung == Rung::Robust,
            is_certified: rung == Rung::Certified,
            #[cfg(target_arch = "x86_64")]
            is_bounded: rung.is_bounded(),
            left,
            ray: Ray {
                t_max: ray.end(),
                ..*ray
            },
            end: ray.end(),
            line,
            hit: Hit::NONE,
            deferred: None,
            low: ray.end() * line.unit,
        }
    }

    /// The nearest hit; with `ANY`, only whether there is one.
    #[inline(always)]
    pub(super) fn finish<const ANY: bool>(&mut self) -> Hit {
        if !ANY {
            self.evaluate_deferred();
        }
        self.hit
    }

    /// Evaluates the rung for the deferred sphere.
    #[inline(always)]
    fn evaluate_deferred(&mut self) {
        if let Some(sphere) = self.deferred.take() {
            self.ray.t_max = self.end;
            let t = self.entry(sphere);
            if t < self.end {
                self.found_at(t, self.hit.sphere);
            } else {
                // It can only be a miss if numbers exceed the range that the bounds are made for.
                self.hit = Hit::NONE;
                self.low = self.end * self.line.unit;
            }
        }
    }

    /// Where the ray enters a sphere, which its bounds say it certainly does.
    #[inline(always)]
    fn entry(&self, sphere: Sphere) -> f32 {
        if self.is_certified {
            let (low, high) = (self.low / self.line.unit, self.hit.t);
            let t = certified::entry_or_defer(sphere, &self.ray, low + 0.5 * (high - low));
            if t != Hit::DEFERRED_T {
                return t;
            }
        }
        (self.intersect)(sphere, &self.ray)
    }

    /// Records a hit of the rung as the nearest.
    #[inline(always)]
    fn found_at(&mut self, t: f32, sphere: u32) {
        self.hit = Hit { t, sphere };
        self.low = t * self.line.unit;
        // One at the same distance still counts, if its index is lower.
        self.ray.t_max = t.next_up();
    }

    /// Whether the bounds decide about a sphere. If it is certainly the nearest, it is recorded.
    #[inline(always)]
    fn is_certain(&mut self, sphere: Sphere, index: u32) -> bool {
        let bounds = self.line.bounds(sphere);
        if bounds.hits & (bounds.high < self.low) {
            self.low = bounds.low;
            self.deferred = Some(sphere);
            // Exact: the unit is a power of two.
            self.ray.t_max = bounds.high / self.line.unit;
            self.hit = Hit {
                t: self.ray.t_max,
                sphere: index,
            };
            return true;
        }
        !bounds.is_open(self.ray.t_max * self.line.unit)
    }

    /// Tests `count` spheres from `first` on; indices beyond the last sphere are ignored.
    #[inline(always)]
    pub(super) fn test<const ANY: bool, S: Spheres + ?Sized>(
        &mut self,
        spheres: &S,
        first: u32,
        count: u32,
    ) {
        let end = first.saturating_add(count).min(spheres.count());
        let mut at = first;
        while at < end {
            // The last sphere fills the lanes beyond the end.
            let last = spheres.count() - 1;
            let four = if last - at >= WIDTH as u32 - 1 {
                // SAFETY: each is at most the last.
                [0, 1, 2, 3].map(|lane| unsafe { spheres.sphere(at + lane) })
            } else {
                // SAFETY: each is at most the last.
                [0, 1, 2, 3].map(|lane| unsafe { spheres.sphere(at + lane.min(last - at)) })
            };
            let mut found = self.cull(four);
            found &= (1 << (end - at).min(WIDTH as u32)) - 1;
            self.evaluate::<ANY, S>(spheres, at, found);
            if ANY & self.hit.is_some() {
                return;
            }
            at += WIDTH as u32;
        }
    }

    /// [`test`](Search::test), sixteen spheres at a time.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) fn test_wide<const ANY: bool>(
        &mut self,
        _: Avx512,
        spheres: &[Sphere],
        first: u32,
        count: u32,
    ) {
        let all = spheres.len() as u32;
        let first = first.min(all);
        let end = first + count.min(all - first);
        let mut at = first;
        while at < end {
            let end_here = self.ray.t_max * self.line.unit;
            // SAFETY: the machine has AVX-512, as the proof says.
            let found = unsafe {
                let some = spheres.get_unchecked(at as usize..end as usize);
                let bounded = self.is_bounded.then_some((&self.line, end_here));
                let Line {
                    origin,
                    direction,
                    a,
                    ..
                } = self.line;
                avx512::cull(origin, direction, a, bounded, some)
            };
            self.evaluate::<ANY, [Sphere]>(spheres, at, found);
            if ANY & self.hit.is_some() {
                return;
            }
            at += avx512::LANES as u32;
        }
    }

    /// Evaluates the rung for the spheres from `first` on whose bit is set in `found`; all must
    /// exist.
    #[inline(always)]
    pub(super) fn evaluate<const ANY: bool, S: Spheres + ?Sized>(
        &mut self,
        spheres: &S,
        first: u32,
        mut found: u32,
    ) {
        while found != 0 {
            let index = first + found.trailing_zeros();
            found &= found - 1;
            if index == self.left {
                continue;
            }
            // SAFETY: bits are set only for spheres that exist.
            let sphere = unsafe { spheres.sphere(index) };
            if self.is_lazy {
                if self.is_certain(sphere, index) {
                    if ANY & self.hit.is_some() {
                        return;
                    }
                    continue;
                }
                self.evaluate_deferred();
            }
            let t = if self.is_robust {
                // Most rays use this rung: no call, and the instructions that the walk is compiled
                // for.
                Robust::intersect(sphere, &self.ray)
            } else {
                (self.intersect)(sphere, &self.ray)
            };
            if t < self.ray.t_max {
                if (t < self.hit.t) | (index < self.hit.sphere) {
                    self.found_at(t, index);
                }
                if ANY {
                    return;
                }
            }
        }
    }

    /// Which of four spheres may be hit, a bit each.
    #[inline(always)]
    fn cull(&self, spheres: [Sphere; WIDTH]) -> u32 {
        let [first, second, third, fourth] = spheres.map(Sphere::to_vec4);
        let rows = Mat4::from_cols(first, second, third, fourth).transpose();
        let splat = |value| Four(Vec4::splat(value));
        let (origin, direction) = (self.line.origin, self.line.direction);
        let o = Lane3 {
            x: Four(rows.x_axis) - splat(origin.x),
            y: Four(rows.y_axis) - splat(origin.y),
            z: Four(rows.z_axis) - splat(origin.z),
        };
        let d = Lane3 {
            x: splat(direction.x),
            y: splat(direction.y),
            z: splat(direction.z),
        };
        let found = Target::of(o, Four(rows.w_axis)).may_hit(d, splat(self.line.a));
        found.bits()
    }
}

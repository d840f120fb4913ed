//! [`Search`]: a ray on its way among spheres, and [`Query`]: what is asked of every ray.
//!
//! Four spheres at a time are culled by the [discriminant](spherule_kernel::cull::discriminant), whose slack covers every rung,
//! and only what may be a hit is asked about on its rung; of the rungs that take long, only the nearest at the end, and what
//! [`bounds`](spherule_kernel::cull::bounds) leave open.

use glam::{Mat4, Vec4};
use spherule_kernel::accel::brute::{MovingSpheres, Spheres};
use spherule_kernel::accel::node::{Extent, Node, Tree};
use spherule_kernel::cull::bounds::Line;
use spherule_kernel::cull::discriminant::Target;
use spherule_kernel::lane::Lane3;
use spherule_kernel::precision::{self, OnRung, Precision, Robust};
use spherule_kernel::{Effects, Hit, Ray, Rung, Sphere};

#[cfg(target_arch = "x86_64")]
use super::avx512::{self, Avx512};
use crate::lanes::Four;

/// Spheres side by side.
const LANES: usize = 4;

/// What is asked of every ray: the rung's question, of the spheres of a tree or of all.
#[derive(Clone, Copy, Debug)]
pub(super) struct Query<'a> {
    /// The rung.
    pub(super) rung: Rung,
    /// The rung's question.
    intersect: fn(Sphere, &Ray) -> f32,
    /// The tree; none if every sphere is to be tested.
    pub(super) tree: Tree<'a>,
    /// What its first node says.
    pub(super) extent: Extent,
}

impl<'a> Query<'a> {
    pub(super) fn new(rung: Rung, tree: Tree<'a>) -> Self {
        /// The rung's question, compiled for it.
        struct Question;
        impl OnRung for Question {
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
            intersect: rung.with(Question),
            tree,
            extent: Extent::of_node(tree.nodes().first().unwrap_or(&Node::default())),
        }
    }

    /// A ray that has not met anything yet.
    #[inline(always)]
    pub(super) fn search(&self, ray: &Ray) -> Search {
        Search::of(self.rung, self.intersect, ray)
    }
}

/// Spheres that may lie side by side in memory.
pub trait Resting: Spheres {
    /// All of them, where [`Spheres::sphere`] has them; none if they move.
    fn at_rest(&self) -> Option<&[Sphere]>;
}

impl Resting for [Sphere] {
    #[inline]
    fn at_rest(&self) -> Option<&[Sphere]> {
        Some(self)
    }
}

impl Resting for MovingSpheres<'_> {
    #[inline]
    fn at_rest(&self) -> Option<&[Sphere]> {
        let moves = self.effects.any(Effects::MOTION_BLUR) & !self.velocities.is_empty();
        (!moves).then_some(self.spheres)
    }
}

/// A ray on its way among spheres.
#[derive(Clone, Copy)]
pub(super) struct Search {
    intersect: fn(Sphere, &Ray) -> f32,
    /// Whether the rung takes so long that it is asked at the end, as in the kernel's walk.
    is_lazy: bool,
    is_robust: bool,
    /// Whether hits of the rung are where [`bounds`](spherule_kernel::cull::bounds) have them.
    is_bounded: bool,
    /// Ends where a sphere could still be of interest.
    pub(super) ray: Ray,
    /// Where the ray ends by itself.
    end: f32,
    line: Line,
    /// What was found. While there is an `unasked` sphere, `t` is where it is hit at most.
    pub(super) hit: Hit,
    /// The sphere that was found, if the rung was not asked about it.
    unasked: Option<Sphere>,
    /// Where a sphere must certainly be hit before to be nearer, as the line counts it.
    low: f32,
}

impl Search {
    #[inline(always)]
    fn of(rung: Rung, intersect: fn(Sphere, &Ray) -> f32, ray: &Ray) -> Self {
        let line = Line::of(ray);
        Self {
            intersect,
            is_lazy: precision::is_lazy(rung.to_u32()),
            is_robust: rung == Rung::Robust,
            is_bounded: rung.is_bounded(),
            ray: Ray {
                t_max: ray.end(),
                ..*ray
            },
            end: ray.end(),
            line,
            hit: Hit::NONE,
            unasked: None,
            low: ray.end() * line.unit,
        }
    }

    /// What was found; with `ANY` only whether anything was.
    #[inline(always)]
    pub(super) fn finish<const ANY: bool>(&mut self) -> Hit {
        if !ANY {
            self.ask_at_last();
        }
        self.hit
    }

    /// Asks about the sphere that was found without.
    #[inline(always)]
    fn ask_at_last(&mut self) {
        if let Some(sphere) = self.unasked.take() {
            self.ray.t_max = self.end;
            let t = (self.intersect)(sphere, &self.ray);
            if t < self.end {
                self.found_at(t, self.hit.sphere);
            } else {
                // No hit after all only where numbers are beyond what bounds are made for.
                self.hit = Hit::NONE;
                self.low = self.end * self.line.unit;
            }
        }
    }

    /// Takes the rung's answer about the sphere that is nearest.
    #[inline(always)]
    fn found_at(&mut self, t: f32, sphere: u32) {
        self.hit = Hit { t, sphere };
        self.low = t * self.line.unit;
        // One as near is still of interest, if its index is lower.
        self.ray.t_max = t.next_up();
    }

    /// Whether it is certain what a sphere is to the ray; it is taken if it is the nearest.
    #[inline(always)]
    fn is_certain(&mut self, sphere: Sphere, index: u32) -> bool {
        let bounds = self.line.bounds(sphere);
        if bounds.hits & (bounds.high < self.low) {
            self.low = bounds.low;
            self.unasked = Some(sphere);
            // A quotient by a power of two.
            self.ray.t_max = bounds.high / self.line.unit;
            self.hit = Hit {
                t: self.ray.t_max,
                sphere: index,
            };
            return true;
        }
        !bounds.is_open(self.ray.t_max * self.line.unit)
    }

    /// Tests `count` spheres from `first` on; those that there are not are left out.
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
            // Behind the last of all, the last again.
            let last = spheres.count() - 1;
            let four = if last - at >= LANES as u32 - 1 {
                // SAFETY: each is at most the last.
                [0, 1, 2, 3].map(|lane| unsafe { spheres.sphere(at + lane) })
            } else {
                // SAFETY: each is at most the last.
                [0, 1, 2, 3].map(|lane| unsafe { spheres.sphere(at + lane.min(last - at)) })
            };
            let mut found = self.sift(four);
            found &= (1 << (end - at).min(LANES as u32)) - 1;
            self.ask::<ANY, S>(spheres, at, found);
            if ANY & self.hit.is_some() {
                return;
            }
            at += LANES as u32;
        }
    }

    /// [`test`](Search::test) of sixteen at a time.
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
                avx512::sift(origin, direction, a, bounded, some)
            };
            self.ask::<ANY, [Sphere]>(spheres, at, found);
            if ANY & self.hit.is_some() {
                return;
            }
            at += avx512::LANES as u32;
        }
    }

    /// Asks about those spheres from `first` on whose bit is set, which are there.
    #[inline(always)]
    pub(super) fn ask<const ANY: bool, S: Spheres + ?Sized>(
        &mut self,
        spheres: &S,
        first: u32,
        mut found: u32,
    ) {
        while found != 0 {
            let index = first + found.trailing_zeros();
            found &= found - 1;
            // SAFETY: the sphere is there.
            let sphere = unsafe { spheres.sphere(index) };
            if self.is_lazy {
                if self.is_certain(sphere, index) {
                    if ANY & self.hit.is_some() {
                        return;
                    }
                    continue;
                }
                self.ask_at_last();
            }
            let t = if self.is_robust {
                // Most rays are on it: without a call, and with the instructions that the walk is compiled for.
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
    fn sift(&self, spheres: [Sphere; LANES]) -> u32 {
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

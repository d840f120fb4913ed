//! [`Single`]: rays one by one on the CPU.
//!
//! Four spheres at a time are sifted by the discriminant of
//! [`candidates`](spherule_kernel::candidates), whose slack covers every rung, and only what may be a hit is
//! asked about on its rung. With AVX2, which is looked for when the program runs, the eight boxes of a node
//! are tested side by side, too; without it the kernel's walk does that.

use glam::{Mat4, Vec4};
use spherule_kernel::bounds::Line;
use spherule_kernel::candidates::SLACK;
use spherule_kernel::nearest::{MovingSpheres, Spheres};
use spherule_kernel::precision::intersect;
use spherule_kernel::traversal::Traversal;
use spherule_kernel::tree::{Node, is_occluded_in_tree, nearest_hit_in_tree};
use spherule_kernel::{Hit, Ray, Rung, Sphere};

#[cfg(target_arch = "x86_64")]
use super::avx2::{self, Avx2};

/// Spheres side by side.
const LANES: usize = 4;

/// What finds the hits of rays on one rung, in a tree or without one.
#[derive(Clone, Copy, Debug)]
pub struct Single<'a> {
    /// The rung.
    pub(super) rung: Rung,
    /// The rung's question.
    intersect: fn(Sphere, &Ray) -> f32,
    /// The tree's; none if every sphere is to be tested.
    pub(super) nodes: &'a [Node],
    /// That the machine has it.
    #[cfg(target_arch = "x86_64")]
    avx2: Option<Avx2>,
}

impl<'a> Single<'a> {
    /// For rays on this rung. With nodes, spheres are in the order of their leaves.
    #[must_use]
    pub fn new(rung: Rung, nodes: &'a [Node]) -> Self {
        fn on<const RUNG: u32>(sphere: Sphere, ray: &Ray) -> f32 {
            intersect(RUNG, sphere, ray)
        }
        Self {
            rung,
            intersect: match rung {
                Rung::Textbook => on::<{ Rung::Textbook.to_u32() }>,
                Rung::Robust => on::<{ Rung::Robust.to_u32() }>,
                Rung::Compensated => on::<{ Rung::Compensated.to_u32() }>,
                Rung::Double => on::<{ Rung::Double.to_u32() }>,
                Rung::Certified => on::<{ Rung::Certified.to_u32() }>,
            },
            nodes,
            #[cfg(target_arch = "x86_64")]
            avx2: Avx2::detect(),
        }
    }

    /// What each ray hits: the nearest, or with `ANY` the first that is found. `put` is told the ray's
    /// index, not in order.
    pub fn trace<const ANY: bool, S: Spheres + ?Sized>(
        &self,
        rays: &[Ray],
        spheres: &S,
        mut put: impl FnMut(usize, Hit),
    ) {
        #[cfg(target_arch = "x86_64")]
        if let (Some(avx2), true) = (self.avx2, self.has_tree()) {
            avx2::trace::<ANY, S>(avx2, self, rays, spheres, put);
            return;
        }
        for (index, ray) in rays.iter().enumerate() {
            put(index, self.trace_one::<ANY, S>(ray, spheres));
        }
    }

    fn has_tree(&self) -> bool {
        self.nodes.len() > Node::ROOT as usize
    }

    fn trace_one<const ANY: bool, S: Spheres + ?Sized>(&self, ray: &Ray, spheres: &S) -> Hit {
        if !self.has_tree() {
            let mut search = Search::of(self.intersect, ray);
            search.test::<ANY, S>(spheres, 0, spheres.count());
            return search.hit;
        }
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = self.avx2 {
            return avx2::trace_one::<ANY, S>(avx2, self, ray, spheres);
        }
        let rung = self.rung.to_u32();
        if ANY {
            if is_occluded_in_tree(rung, ray, self.nodes, spheres) {
                Hit { t: 0.0, sphere: 0 }
            } else {
                Hit::NONE
            }
        } else {
            nearest_hit_in_tree(rung, ray, self.nodes, spheres)
        }
    }

    /// A ray that has not met anything yet.
    #[inline(always)]
    pub(super) fn search(&self, ray: &Ray) -> Search {
        Search::of(self.intersect, ray)
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

/// A ray on its way among spheres.
#[derive(Clone, Copy)]
pub(super) struct Search {
    intersect: fn(Sphere, &Ray) -> f32,
    /// Ends where a sphere could still be of interest.
    pub(super) ray: Ray,
    line: Line,
    /// What was found.
    pub(super) hit: Hit,
}

impl Search {
    #[inline(always)]
    fn of(intersect: fn(Sphere, &Ray) -> f32, ray: &Ray) -> Self {
        Self {
            intersect,
            ray: Ray {
                t_max: ray.end(),
                ..*ray
            },
            line: Line::of(ray),
            hit: Hit::NONE,
        }
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
            while found != 0 {
                let lane = found.trailing_zeros();
                found &= found - 1;
                let t = (self.intersect)(four[lane as usize], &self.ray);
                if t < self.ray.t_max {
                    let sphere = at + lane;
                    if ANY {
                        self.hit = Hit { t, sphere };
                        return;
                    }
                    if (t < self.hit.t) | (sphere < self.hit.sphere) {
                        self.hit = Hit { t, sphere };
                    }
                    // One as near is still of interest, if its index is lower.
                    self.ray.t_max = t.next_up();
                }
            }
            at += LANES as u32;
        }
    }

    /// Which of four spheres may be hit, a bit each.
    #[inline(always)]
    fn sift(&self, spheres: [Sphere; LANES]) -> u32 {
        let [first, second, third, fourth] = spheres.map(Sphere::to_vec4);
        let rows = Mat4::from_cols(first, second, third, fourth).transpose();
        let (origin, direction) = (self.line.origin, self.line.direction);
        let x = rows.x_axis - Vec4::splat(origin.x);
        let y = rows.y_axis - Vec4::splat(origin.y);
        let z = rows.z_axis - Vec4::splat(origin.z);
        let rr = rows.w_axis * rows.w_axis;
        let oo = x * x + y * y + z * z;
        let b = x * Vec4::splat(direction.x)
            + y * Vec4::splat(direction.y)
            + z * Vec4::splat(direction.z);
        let c = (oo - rr) - Vec4::splat(SLACK) * (oo + rr);
        let discriminant = b * b - Vec4::splat(self.line.a) * c;
        // A number that is none is asked about, too.
        !discriminant.cmplt(Vec4::splat(Line::SMALLEST)).bitmask() & 0xf
    }
}

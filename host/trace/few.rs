//! Rays among few spheres: sixteen rays side by side, and every sphere for all sixteen.
//!
//! Where there are few spheres this saves more than culling would: the rung's formula is a few
//! dozen vector instructions for sixteen rays, without a branch. The formulas are the kernel's,
//! over [`Single16`] and [`Double16`].

use fearless_simd::{Level, Select, Simd, SimdBase, SimdMask, dispatch, mask32x16, u32x16};
use spherule_kernel::lane::{Lane, Lane3};
use spherule_kernel::precision::root::root_within;
use spherule_kernel::precision::{double, robust};
use spherule_kernel::{Hit, Ray, Rung, Sphere};

use crate::lanes::{Double16, LANES, Single16};

/// The most spheres for which this is faster than a tree.
pub(super) const FEW: usize = 64;

/// Whether the rung's formula is there in lanes.
pub(super) fn has_lanes(rung: Rung) -> bool {
    matches!(rung, Rung::Robust | Rung::Double)
}

/// Finds what each ray hits: the nearest, or with `ANY` some hit. `lefts` has the index of the
/// sphere over which each ray passes; beyond its end there is none. `put` receives the ray's index.
///
/// The rung must be one that [`has_lanes`] accepts.
pub(super) fn trace<const ANY: bool>(
    level: Level,
    rung: Rung,
    rays: &[Ray],
    lefts: &[u32],
    spheres: &[Sphere],
    mut put: impl FnMut(usize, Hit),
) {
    for (some, rays) in rays.chunks(LANES).enumerate() {
        let first = some * LANES;
        let lefts = lefts.get(first..).unwrap_or_default();
        let group = Group::of(rays, lefts);
        let found = dispatch!(level, simd => group.test::<_, ANY>(simd, rung, spheres));
        for (lane, _) in rays.iter().enumerate() {
            let (t, sphere) = (found.t[lane], found.sphere[lane]);
            let is_hit = sphere != Hit::NONE_SPHERE;
            put(
                first + lane,
                if is_hit { Hit { t, sphere } } else { Hit::NONE },
            );
        }
    }
}

/// Up to sixteen rays, a value of each side by side. Lanes beyond the last ray end before they
/// start.
struct Group {
    origin: [[f32; LANES]; 3],
    direction: [[f32; LANES]; 3],
    t_min: [f32; LANES],
    end: [f32; LANES],
    left: [u32; LANES],
    /// A bit for each ray.
    there: u64,
}

/// The hits of a group; [`Hit::NONE_SPHERE`] where there is none.
struct Found {
    t: [f32; LANES],
    sphere: [u32; LANES],
}

/// What was found so far.
struct Nearest<S: Simd> {
    t: Single16<S>,
    sphere: u32x16<S>,
    /// The rays that need no more spheres.
    done: mask32x16<S>,
}

impl Group {
    #[inline(always)]
    fn of(rays: &[Ray], lefts: &[u32]) -> Self {
        let mut group = Self {
            origin: [[0.0; LANES]; 3],
            direction: [[1.0; LANES]; 3],
            t_min: [1.0; LANES],
            end: [0.0; LANES],
            left: [Hit::NONE_SPHERE; LANES],
            there: (1 << rays.len().min(LANES)) - 1,
        };
        for (lane, ray) in rays.iter().take(LANES).enumerate() {
            for axis in 0..3 {
                group.origin[axis][lane] = ray.origin[axis];
                group.direction[axis][lane] = ray.direction[axis];
            }
            group.t_min[lane] = ray.t_min;
            group.end[lane] = ray.end();
        }
        for (to, left) in group.left.iter_mut().zip(lefts) {
            *to = *left;
        }
        group
    }

    /// Tests every sphere on this rung.
    #[inline(always)]
    fn test<S: Simd, const ANY: bool>(&self, simd: S, rung: Rung, spheres: &[Sphere]) -> Found {
        if rung == Rung::Robust {
            self.search::<S, ANY>(simd, spheres, &RobustLines::of(simd, self))
        } else {
            self.search::<S, ANY>(simd, spheres, &DoubleLines::of(simd, self))
        }
    }

    #[inline(always)]
    fn search<S: Simd, const ANY: bool>(
        &self,
        simd: S,
        spheres: &[Sphere],
        lines: &impl Lines<S>,
    ) -> Found {
        let (t_min, end) = (
            Single16::load(simd, &self.t_min),
            Single16::load(simd, &self.end),
        );
        let left = u32x16::load_array_ref(simd, &self.left);
        let mut nearest = Nearest {
            t: end,
            sphere: u32x16::splat(simd, Hit::NONE_SPHERE),
            done: mask32x16::from_bitmask(simd, !self.there & 0xffff),
        };
        for (index, sphere) in spheres.iter().enumerate() {
            let index = u32x16::splat(simd, index as u32);
            let (meets, near, far) = lines.roots(simd, *sphere);
            let (t, is_within) = root_within(near, far, t_min, end);
            // Of equally near ones the first stays.
            let is_new = meets & is_within & t.simd_lt(nearest.t) & !index.simd_eq(left);
            nearest.t = Single16::select(is_new, t, nearest.t);
            nearest.sphere = is_new.select(index, nearest.sphere);
            if ANY {
                nearest.done |= is_new;
                if nearest.done.all_true() {
                    break;
                }
            }
        }
        let mut found = Found {
            t: [0.0; LANES],
            sphere: [0; LANES],
        };
        nearest.t.store(&mut found.t);
        nearest.sphere.store_array(&mut found.sphere);
        found
    }
}

/// Sixteen lines, as a rung's formula takes them.
trait Lines<S: Simd> {
    /// Whether each line meets a sphere, and the roots, the smaller first.
    fn roots(&self, simd: S, sphere: Sphere) -> (mask32x16<S>, Single16<S>, Single16<S>);
}

struct RobustLines<S: Simd> {
    origin: Lane3<Single16<S>>,
    direction: Lane3<Single16<S>>,
    squared: Single16<S>,
    inverse: Single16<S>,
}

impl<S: Simd> RobustLines<S> {
    #[inline(always)]
    fn of(simd: S, group: &Group) -> Self {
        let load = |of: &[[f32; LANES]; 3]| Lane3 {
            x: Single16::load(simd, &of[0]),
            y: Single16::load(simd, &of[1]),
            z: Single16::load(simd, &of[2]),
        };
        let direction = load(&group.direction);
        let squared = direction.dot(direction);
        Self {
            origin: load(&group.origin),
            direction,
            squared,
            inverse: Single16::splat(simd, 1.0) / squared,
        }
    }
}

impl<S: Simd> Lines<S> for RobustLines<S> {
    #[inline(always)]
    fn roots(&self, simd: S, sphere: Sphere) -> (mask32x16<S>, Single16<S>, Single16<S>) {
        let (origin, center) = (self.origin, Single16::splat3(simd, sphere.center()));
        let o = Lane3 {
            x: origin.x - center.x,
            y: origin.y - center.y,
            z: origin.z - center.z,
        };
        let radius = Single16::splat(simd, sphere.radius());
        let (d, a) = (self.direction, self.squared);
        let quadratic = robust::Quadratic::of(o, radius, d, a, self.inverse);
        let (near, far) = quadratic.roots();
        (quadratic.meets(), near, far)
    }
}

struct DoubleLines<S: Simd> {
    origin: Lane3<Double16<S>>,
    direction: Lane3<Double16<S>>,
}

impl<S: Simd> DoubleLines<S> {
    #[inline(always)]
    fn of(simd: S, group: &Group) -> Self {
        let load = |of: &[[f32; LANES]; 3]| Lane3 {
            x: Double16::widened(Single16::load(simd, &of[0])),
            y: Double16::widened(Single16::load(simd, &of[1])),
            z: Double16::widened(Single16::load(simd, &of[2])),
        };
        Self {
            origin: load(&group.origin),
            direction: load(&group.direction),
        }
    }
}

impl<S: Simd> Lines<S> for DoubleLines<S> {
    #[inline(always)]
    fn roots(&self, simd: S, sphere: Sphere) -> (mask32x16<S>, Single16<S>, Single16<S>) {
        let (origin, center) = (self.origin, sphere.center().as_dvec3());
        let o = Lane3 {
            x: origin.x - Double16::splat(simd, center.x),
            y: origin.y - Double16::splat(simd, center.y),
            z: origin.z - Double16::splat(simd, center.z),
        };
        let radius = Double16::splat(simd, sphere.radius().into());
        let quadratic = double::Quadratic::of(o, radius, self.direction);
        let meets = quadratic.meets().narrowed(simd);
        if !meets.any_true() {
            let none = Single16::splat(simd, f32::NAN);
            return (meets, none, none);
        }
        let (near, far) = quadratic.roots();
        (meets, near.rounded(), far.rounded())
    }
}

#[cfg(test)]
mod tests {
    use spherule_kernel::Effects;
    use spherule_kernel::accel::brute::{MovingSpheres, nearest_hit_in};

    use super::super::sample_rays::{rays, world};
    use super::*;
    use crate::cpu::InstructionSet;
    use crate::random::Random;

    /// Each ray finds what testing the spheres one by one finds, with each instruction set.
    #[test]
    fn rays_side_by_side_find_what_each_finds_alone() {
        let mut random = Random::new(21);
        for count in [0, 1, 5, FEW] {
            let mut spheres = world(&mut random, count);
            // As near as another, with a higher index.
            spheres.extend(spheres.first().copied());
            let rays = rays(&mut random);
            let rays = &rays[..rays.len() - 3];
            let lefts: Vec<u32> = (0..rays.len() as u32)
                .map(|index| {
                    if index % 3 == 0 {
                        index % 7
                    } else {
                        Hit::NONE_SPHERE
                    }
                })
                .collect();
            for level in InstructionSet::ALL
                .into_iter()
                .filter_map(InstructionSet::level)
            {
                for rung in Rung::ALL.into_iter().filter(|rung| has_lanes(*rung)) {
                    let expected = |index: usize| {
                        let resting = MovingSpheres {
                            spheres: &spheres,
                            velocities: &[],
                            time: 0.0,
                            effects: Effects::NONE,
                            left: lefts[index],
                        };
                        nearest_hit_in(rung.to_u32(), &rays[index], &resting, 0, u32::MAX)
                    };
                    let (mut puts, mut hits) = (0, 0);
                    trace::<false>(level, rung, rays, &lefts, &spheres, |index, hit| {
                        assert_eq!(hit, expected(index), "{level:?} {rung:?} {index}");
                        puts += 1;
                        hits += usize::from(hit.is_some());
                    });
                    assert_eq!(puts, rays.len());
                    assert!(hits > rays.len() / 4, "{hits}");
                    trace::<true>(level, rung, rays, &lefts, &spheres, |index, hit| {
                        assert_eq!(hit.is_some(), expected(index).is_some(), "{index}");
                    });
                }
            }
        }
    }
}

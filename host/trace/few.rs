//! Rays among few spheres: sixteen rays side by side, and every sphere for all sixteen.
//!
//! Where there are few spheres this saves more than a tree would: there is no branch from sphere to
//! sphere. Robust is evaluated for each sphere. The slower rungs are evaluated for those alone that
//! [`bounds`](spherule_kernel::cull::bounds) leave open, mostly the nearest, a sphere for each ray.
//! The formulas are the kernel's, over [`Single16`] and [`Double16`].

use fearless_simd::{Level, Select, Simd, SimdBase, SimdMask, dispatch, mask32x16, u32x16};
use glam::Vec3;
use spherule_kernel::cull::bounds::{Aim, Line};
use spherule_kernel::cull::discriminant::Target;
use spherule_kernel::lane::{Lane, Lane3};
use spherule_kernel::precision::certified::wide::WideRay;
use spherule_kernel::precision::root::root_within;
use spherule_kernel::precision::{double, robust};
use spherule_kernel::{Hit, Ray, Rung, Sphere};

use super::search::Query;
use crate::lanes::{Double16, LANES, Single16};

/// The most spheres for which this is faster than a tree; a bit each in a `u64`.
pub(super) const FEW: usize = 64;

/// Finds what each ray hits: the nearest, or with `ANY` some hit. `lefts` has the index of the
/// sphere over which each ray passes; beyond its end there is none. `put` receives the ray's index.
///
/// The query's rung must be [bounded](Rung::is_bounded), and there must not be more than [`FEW`]
/// spheres.
pub(super) fn trace<const ANY: bool>(
    level: Level,
    query: &Query<'_>,
    rays: &[Ray],
    lefts: &[u32],
    spheres: &[Sphere],
    mut put: impl FnMut(usize, Hit),
) {
    let mut lows = [[0.0; LANES]; FEW];
    let spheres = &spheres[..spheres.len().min(FEW)];
    for (some, rays) in rays.chunks(LANES).enumerate() {
        let first = some * LANES;
        let lefts = lefts.get(first..).unwrap_or_default();
        let group = Group::of(rays, lefts);
        let found = dispatch!(level, simd => if query.rung == Rung::Robust {
            group.test_all::<_, ANY>(simd, spheres)
        } else {
            group.test_open::<_, ANY>(simd, query, spheres, &mut lows)
        });
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

/// Finds where each ray hits a sphere of its own, whatever other spheres there are. There are as
/// many as rays. `put` receives, in order, the ray's index and the parameter, [`Hit::NONE_T`] for
/// no hit.
///
/// The query's rung must be [bounded](Rung::is_bounded).
pub(super) fn meet(
    level: Level,
    query: &Query<'_>,
    rays: &[Ray],
    spheres: &[Sphere],
    mut put: impl FnMut(usize, f32),
) {
    let some = rays.chunks(LANES).zip(spheres.chunks(LANES));
    for (some, (rays, spheres)) in some.enumerate() {
        let group = Group::of(rays, &[]);
        let mut open: [u64; LANES] =
            std::array::from_fn(|lane| u64::from(lane < spheres.len()) << lane);
        let next = Next::of(&mut open, spheres);
        let found = dispatch!(level, simd => group.meet(simd, query, &next));
        for (lane, t) in found.iter().enumerate().take(spheres.len()) {
            let is_hit = *t < group.end[lane];
            put(some * LANES + lane, if is_hit { *t } else { Hit::NONE_T });
        }
    }
}

/// Numbers side by side, and vectors.
type Lanes = [f32; LANES];
type Lanes3 = [Lanes; 3];

/// Up to sixteen rays, a value of each side by side. Lanes beyond the last ray end before they
/// start.
struct Group {
    origin: Lanes3,
    direction: Lanes3,
    t_min: Lanes,
    end: Lanes,
    left: [u32; LANES],
    /// A bit for each ray.
    there: u64,
}

/// The hits of a group; [`Hit::NONE_SPHERE`] where there is none.
struct Found {
    t: Lanes,
    sphere: [u32; LANES],
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

    fn ray(&self, lane: usize) -> Ray {
        Ray::within(
            vector(&self.origin, lane),
            vector(&self.direction, lane),
            self.t_min[lane],
            self.end[lane],
        )
    }

    /// Evaluates robust for every sphere.
    #[inline(always)]
    fn test_all<S: Simd, const ANY: bool>(&self, simd: S, spheres: &[Sphere]) -> Found {
        let lines = RobustLines::of(simd, self);
        let (t_min, end) = (
            Single16::load(simd, &self.t_min),
            Single16::load(simd, &self.end),
        );
        let left = u32x16::load_array_ref(simd, &self.left);
        let mut nearest = end;
        let mut of_nearest = u32x16::splat(simd, Hit::NONE_SPHERE);
        // The rays that need no more spheres.
        let mut done = mask32x16::from_bitmask(simd, !self.there & 0xffff);
        for (index, sphere) in spheres.iter().enumerate() {
            let index = u32x16::splat(simd, index as u32);
            let center = Single16::splat3(simd, sphere.center());
            let (meets, near, far) = lines.roots(center, Single16::splat(simd, sphere.radius()));
            let (t, is_within) = root_within(near, far, t_min, end);
            // Of equally near ones the first stays.
            let is_new = meets & is_within & t.simd_lt(nearest) & !index.simd_eq(left);
            nearest = Single16::select(is_new, t, nearest);
            of_nearest = is_new.select(index, of_nearest);
            if ANY {
                done |= is_new;
                if done.all_true() {
                    break;
                }
            }
        }
        let mut found = Found::NONE;
        nearest.store(&mut found.t);
        of_nearest.store_array(&mut found.sphere);
        found
    }

    /// Evaluates the rung for the spheres that bounds leave open. `lows` is room for what each
    /// sphere's bounds say.
    #[inline(always)]
    fn test_open<S: Simd, const ANY: bool>(
        &self,
        simd: S,
        query: &Query<'_>,
        spheres: &[Sphere],
        lows: &mut [Lanes; FEW],
    ) -> Found {
        let (mut open, mut found) = self.bound::<S, ANY>(simd, spheres, lows);
        while open.iter().any(|spheres| *spheres != 0) {
            let next = Next::of(&mut open, spheres);
            let t = self.meet(simd, query, &next);
            for lane in 0..LANES {
                // Each ray's spheres come in their order: of equally near ones the first stays.
                if t[lane] < found.t[lane] {
                    found.t[lane] = t[lane];
                    found.sphere[lane] = next.index[lane];
                    if ANY {
                        open[lane] = 0;
                    }
                }
            }
        }
        found
    }

    /// The parameter of each ray at its sphere; NaN, or the ray's end or more, if there is none.
    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, query: &Query<'_>, next: &Next) -> Lanes {
        let (meets, near, far) = match query.rung {
            Rung::Robust => {
                let center = vectors(simd, &next.center);
                RobustLines::of(simd, self).roots(center, Single16::load(simd, &next.radius))
            }
            Rung::Double => self.double_roots(simd, next),
            Rung::Certified => return self.meet_for_certain(simd, query, next),
            _ => return std::array::from_fn(|lane| next.intersect(lane, query, self)),
        };
        let (t_min, end) = (
            Single16::load(simd, &self.t_min),
            Single16::load(simd, &self.end),
        );
        let (t, is_within) = root_within(near, far, t_min, end);
        let t = Single16::select(meets & is_within, t, Single16::splat(simd, f32::NAN));
        let mut found = [0.0; LANES];
        t.store(&mut found);
        found
    }

    /// [`Group::meet`] on [`Rung::Certified`]: in 64-bit floats, and one by one what those leave
    /// open.
    #[inline(always)]
    fn meet_for_certain<S: Simd>(&self, simd: S, query: &Query<'_>, next: &Next) -> Lanes {
        let (center, radius) = next.widened(simd);
        let answer = self.wide_rays(simd).intersect(center, radius);
        let mut found = [0.0; LANES];
        answer.t.rounded().store(&mut found);
        let mut open = (!answer.is_certain).narrowed(simd).to_bitmask();
        while open != 0 {
            let lane = open.trailing_zeros() as usize % LANES;
            open &= open - 1;
            found[lane] = next.intersect(lane, query, self);
        }
        found
    }

    /// Whether each line meets its sphere, and the roots, the smaller first, on [`Rung::Double`].
    #[inline(always)]
    fn double_roots<S: Simd>(
        &self,
        simd: S,
        next: &Next,
    ) -> (mask32x16<S>, Single16<S>, Single16<S>) {
        let line = self.wide_rays(simd);
        let (center, radius) = next.widened(simd);
        let quadratic = double::Quadratic::of(line.origin, line.direction, center, radius);
        let roots = quadratic.roots();
        let meets = quadratic.meets().narrowed(simd);
        (meets, roots.near.rounded(), roots.far.rounded())
    }

    /// The rays in 64-bit floats.
    #[inline(always)]
    fn wide_rays<S: Simd>(&self, simd: S) -> WideRay<Double16<S>> {
        WideRay {
            origin: widened(simd, &self.origin),
            direction: widened(simd, &self.direction),
            t_min: Double16::widened(Single16::load(simd, &self.t_min)),
            t_max: Double16::widened(Single16::load(simd, &self.end)),
        }
    }

    /// For each ray the spheres, a bit each, for which bounds decide nothing, or not which is
    /// nearest. With `ANY`, the hits of rays for which they do.
    #[inline(always)]
    fn bound<S: Simd, const ANY: bool>(
        &self,
        simd: S,
        spheres: &[Sphere],
        lows: &mut [Lanes; FEW],
    ) -> ([u64; LANES], Found) {
        let lines = Lines::of(self);
        let (aim, end) = (lines.aim(simd), Single16::load(simd, &lines.end));
        let squared = aim.direction.dot(aim.direction);
        let origin = vectors(simd, &self.origin);
        let left = u32x16::load_array_ref(simd, &self.left);
        let (none, before) = (
            Single16::splat(simd, f32::NAN),
            Single16::splat(simd, f32::NEG_INFINITY),
        );
        let mut nearest = end;
        let mut hit = u32x16::splat(simd, Hit::NONE_SPHERE);
        let mut done = mask32x16::from_bitmask(simd, !self.there & 0xffff);
        for ((index, sphere), low_of) in spheres.iter().enumerate().zip(&mut *lows) {
            let center = Single16::splat3(simd, sphere.center());
            let o = Lane3 {
                x: center.x - origin.x,
                y: center.y - origin.y,
                z: center.z - origin.z,
            };
            let radius = Single16::splat(simd, sphere.radius());
            let target = Target::of(o, radius);
            let is_near = !aim.is_out_of_reach(&target, radius, nearest);
            if !(target.may_hit(aim.direction, squared) & is_near & !done).any_true() {
                none.store(low_of);
                continue;
            }
            let (misses, hits, low, high) = aim.bounds(o, radius);
            let index = u32x16::splat(simd, index as u32);
            let counts = !(misses | index.simd_eq(left));
            let low = Single16::select(hits, low, before);
            Single16::select(counts, low, none).store(low_of);
            let is_certain = hits & counts & high.simd_lt(nearest);
            if ANY {
                hit = is_certain.select(index, hit);
                done |= is_certain;
                if done.all_true() {
                    break;
                }
            } else {
                nearest = Single16::select(is_certain, high, nearest);
            }
        }
        let mut open = [0; LANES];
        let mut found = Found::NONE;
        found.t = self.end;
        hit.store_array(&mut found.sphere);
        if ANY && done.all_true() {
            return (open, found);
        }
        for (index, low) in lows[..spheres.len()].iter().enumerate() {
            let is_open = Single16::load(simd, low).simd_le(nearest) & !done;
            let mut lanes = is_open.to_bitmask();
            while lanes != 0 {
                open[lanes.trailing_zeros() as usize] |= 1 << index;
                lanes &= lanes - 1;
            }
        }
        (open, found)
    }
}

impl Found {
    const NONE: Self = Self {
        t: [0.0; LANES],
        sphere: [Hit::NONE_SPHERE; LANES],
    };
}

/// One of these vectors.
#[inline(always)]
fn vector(vectors: &Lanes3, lane: usize) -> Vec3 {
    Vec3::from_array([0, 1, 2].map(|axis| vectors[axis][lane]))
}

/// All of them in registers.
#[inline(always)]
fn vectors<S: Simd>(simd: S, vectors: &Lanes3) -> Lane3<Single16<S>> {
    Lane3 {
        x: Single16::load(simd, &vectors[0]),
        y: Single16::load(simd, &vectors[1]),
        z: Single16::load(simd, &vectors[2]),
    }
}

/// [`Line::of`] each ray of a group.
struct Lines {
    direction: Lanes3,
    inverse: Lanes,
    start: Lanes,
    /// The end of the ray's interval, in parameters of the scaled direction.
    end: Lanes,
    behind: Lanes,
}

impl Lines {
    #[inline(always)]
    fn of(group: &Group) -> Self {
        let mut lines = Self {
            direction: [[0.0; LANES]; 3],
            inverse: [0.0; LANES],
            start: [0.0; LANES],
            end: [0.0; LANES],
            behind: [0.0; LANES],
        };
        for lane in 0..LANES {
            let line = Line::of(&group.ray(lane));
            for axis in 0..3 {
                lines.direction[axis][lane] = line.direction[axis];
            }
            lines.inverse[lane] = line.inverse;
            lines.start[lane] = line.start;
            lines.end[lane] = group.end[lane] * line.unit;
            lines.behind[lane] = line.behind;
        }
        lines
    }

    #[inline(always)]
    fn aim<S: Simd>(&self, simd: S) -> Aim<Single16<S>> {
        Aim {
            direction: vectors(simd, &self.direction),
            inverse: Single16::load(simd, &self.inverse),
            start: Single16::load(simd, &self.start),
            behind: Single16::load(simd, &self.behind),
        }
    }
}

/// The next sphere for each ray that has one.
struct Next {
    center: Lanes3,
    radius: Lanes,
    /// [`Hit::NONE_SPHERE`] where there is none.
    index: [u32; LANES],
}

impl Next {
    /// Takes the first from those that are open for each ray.
    #[inline(always)]
    fn of(open: &mut [u64; LANES], spheres: &[Sphere]) -> Self {
        let mut next = Self {
            center: [[0.0; LANES]; 3],
            radius: [f32::NAN; LANES],
            index: [Hit::NONE_SPHERE; LANES],
        };
        for (lane, open) in open.iter_mut().enumerate() {
            let index = open.trailing_zeros();
            if let Some(sphere) = spheres.get(index as usize) {
                for axis in 0..3 {
                    next.center[axis][lane] = sphere.center()[axis];
                }
                next.radius[lane] = sphere.radius();
                next.index[lane] = index;
                *open &= *open - 1;
            }
        }
        next
    }

    /// Centres and radii in 64-bit floats.
    #[inline(always)]
    fn widened<S: Simd>(&self, simd: S) -> (Lane3<Double16<S>>, Double16<S>) {
        let radius = Double16::widened(Single16::load(simd, &self.radius));
        (widened(simd, &self.center), radius)
    }

    /// The parameter of a ray at its sphere; NaN or the end of the ray or more if there is none.
    fn intersect(&self, lane: usize, query: &Query<'_>, group: &Group) -> f32 {
        if self.index[lane] == Hit::NONE_SPHERE {
            return f32::NAN;
        }
        let sphere = Sphere::new(vector(&self.center, lane), self.radius[lane]);
        query.intersect(sphere, &group.ray(lane))
    }
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
        let direction = vectors(simd, &group.direction);
        let squared = direction.dot(direction);
        Self {
            origin: vectors(simd, &group.origin),
            direction,
            squared,
            inverse: Single16::splat(simd, 1.0) / squared,
        }
    }

    /// Whether each line meets its sphere, and the roots, the smaller first.
    #[inline(always)]
    fn roots(
        &self,
        center: Lane3<Single16<S>>,
        radius: Single16<S>,
    ) -> (mask32x16<S>, Single16<S>, Single16<S>) {
        let origin = self.origin;
        let o = Lane3 {
            x: origin.x - center.x,
            y: origin.y - center.y,
            z: origin.z - center.z,
        };
        let (d, a) = (self.direction, self.squared);
        let quadratic = robust::Quadratic::of(o, radius, d, a, self.inverse);
        let (near, far) = quadratic.roots();
        (quadratic.meets(), near, far)
    }
}

/// The vectors in registers, each number in 64 bits.
#[inline(always)]
fn widened<S: Simd>(simd: S, of: &Lanes3) -> Lane3<Double16<S>> {
    let all = vectors(simd, of);
    Lane3 {
        x: Double16::widened(all.x),
        y: Double16::widened(all.y),
        z: Double16::widened(all.z),
    }
}

#[cfg(test)]
mod tests {
    use spherule_kernel::Effects;
    use spherule_kernel::accel::brute::{MovingSpheres, nearest_hit_in};
    use spherule_kernel::accel::node::Tree;

    use super::super::sample_rays::{rays, world};
    use super::*;
    use crate::cpu::InstructionSet;
    use crate::random::Random;

    /// Each ray finds what testing the spheres one by one finds, with each instruction set.
    #[test]
    fn rays_side_by_side_find_what_each_finds_alone() {
        let mut random = Random::new(21);
        for count in [0, 1, 5, FEW - 2] {
            let mut spheres = world(&mut random, count);
            if count > 1 {
                // Large, so that its bounds are wide, and small ones stand on it.
                spheres[0] = Sphere::new(Vec3::new(0.0, -1e4, 0.0), 1e4);
            }
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
                for rung in Rung::ALL.into_iter().filter(|rung| rung.is_bounded()) {
                    let query = Query::new(rung, Tree::NONE);
                    let expected = |index: usize| {
                        let resting = MovingSpheres {
                            spheres: &spheres,
                            velocities: &[],
                            time: 0.0,
                            effects: Effects::NONE,
                            left: lefts[index],
                            target: Hit::NONE_SPHERE,
                        };
                        nearest_hit_in(rung.to_u32(), &rays[index], &resting, 0, u32::MAX)
                    };
                    let (mut puts, mut hits) = (0, 0);
                    trace::<false>(level, &query, rays, &lefts, &spheres, |index, hit| {
                        assert_eq!(hit, expected(index), "{level:?} {rung:?} {index}");
                        puts += 1;
                        hits += usize::from(hit.is_some());
                    });
                    assert_eq!(puts, rays.len());
                    assert!(hits > rays.len() / 4, "{hits}");
                    let own: Vec<Sphere> = (0..rays.len())
                        .filter_map(|index| spheres.get(index % spheres.len().max(1)).copied())
                        .collect();
                    meet(level, &query, rays, &own, |index, t| {
                        assert_eq!(t, query.intersect(own[index], &rays[index]), "{index}");
                    });
                    trace::<true>(level, &query, rays, &lefts, &spheres, |index, hit| {
                        assert_eq!(hit.is_some(), expected(index).is_some(), "{index}");
                    });
                }
            }
        }
    }
}

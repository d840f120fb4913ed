//! The ways of light by a sphere against 64-bit floats: the formulas as they are written in books,
//! scanned densely, and rays that are refracted step by step.

extern crate std;

use core::f64::consts::PI;
use std::vec::Vec;

use glam::{DVec3, Vec3};

use super::ball::{HOLLOW, MIRROR, SOLID};
use super::ways::{Caster, Ways};

/// Random numbers from 0 to 1, the same each time.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// Uniform in the logarithm.
    fn scale(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }
}

/// A sphere of radius one and two points, in 64-bit floats.
#[derive(Clone, Copy, Debug)]
struct Case {
    kind: u32,
    hollow: f64,
    index: f64,
    near: f64,
    /// Infinite for a sun.
    far: f64,
    angle: f64,
}

impl Case {
    fn random(numbers: &mut Numbers, kind: u32) -> Self {
        let distance = |numbers: &mut Numbers| {
            let beyond = numbers.scale(1e-4, 1e4);
            if numbers.next() < 0.5 {
                1.0 + beyond
            } else {
                numbers.between(1.001, 6.0)
            }
        };
        let far = distance(numbers);
        // As floats, so that what is solved is the same.
        let mut case = Self {
            kind,
            hollow: if kind == HOLLOW {
                f64::from(numbers.between(0.05, 0.99) as f32)
            } else {
                0.0
            },
            index: f64::from(numbers.between(1.05, 2.5) as f32),
            near: f64::from(distance(numbers) as f32),
            far: if numbers.next() < 0.2 {
                f64::INFINITY
            } else {
                f64::from(far as f32)
            },
            angle: numbers.between(0.0, PI),
        };
        if numbers.next() < 0.3 {
            // Next to the axis.
            case.angle = PI - numbers.scale(1e-6, 0.3);
        } else if numbers.next() < 0.3 {
            // Where light grazes.
            let grazing = if kind == HOLLOW { case.hollow } else { 1.0 };
            let b = grazing * (1.0 - numbers.scale(1e-6, 1e-2));
            case.angle = case.turn(kind, b).min(PI - 3e-6);
        } else if kind == SOLID {
            // Next to a fold, on its bright side.
            let turn = |step: u32| case.turn(SOLID, f64::from(step) / 1000.0);
            let lowest = (0..1000).map(turn).fold(PI, f64::min);
            case.angle = (lowest + numbers.scale(1e-5, 1e-2)).min(PI - 3e-6);
        }
        case
    }

    /// x − C and y − C; the unit vector of a sun.
    fn points(&self) -> (Vec3, Vec3) {
        let far = if self.far.is_finite() { self.far } else { 1.0 };
        let near = DVec3::new(0.36, 0.48, 0.8);
        let across = DVec3::new(0.8, -0.6, 0.0);
        let towards = near * self.angle.cos() + across * self.angle.sin();
        ((near * self.near).as_vec3(), (towards * far).as_vec3())
    }

    /// The case that the points of [`Case::points`] are after they were rounded.
    fn rounded(&self) -> Self {
        let (near, far) = self.points();
        let (near, far) = (near.as_dvec3(), far.as_dvec3());
        Self {
            near: near.length(),
            far: if self.far.is_finite() {
                far.length()
            } else {
                self.far
            },
            angle: near.cross(far).length().atan2(near.dot(far)),
            ..*self
        }
    }

    fn caster(&self) -> Caster {
        Caster {
            kind: if self.kind == MIRROR { MIRROR } else { SOLID },
            radius: 1.0,
            hollow: self.hollow as f32,
            index: self.index as f32,
        }
    }

    /// F, by its definition.
    fn turn(&self, kind: u32, b: f64) -> f64 {
        let ends = (b / self.near).asin() + (b / self.far).asin();
        let n = self.index;
        match kind {
            MIRROR => 2.0 * b.asin() - ends,
            SOLID => PI + 2.0 * b.asin() - 2.0 * (b / n).asin() - ends,
            _ => {
                let q = self.hollow;
                let glass = b.asin() - (b / n).asin() + (b / (n * q)).asin();
                PI + 2.0 * (glass - (b / q).asin()) - ends
            }
        }
    }

    /// All (kind, b, dF/db) with F(b) = ±φ + 2πk, by a dense scan; and whether a fold is so near
    /// that floats may see two roots, or none.
    fn scan(&self) -> (Vec<(u32, f64, f64)>, bool) {
        const CELLS: u32 = 400;
        const FINER: u32 = 32;
        let mut found = Vec::new();
        let mut is_near_fold = false;
        let ranges = match self.kind {
            HOLLOW => std::vec![
                (HOLLOW, 0.0, self.hollow),
                (SOLID, (self.index * self.hollow).min(1.0), 1.0)
            ],
            kind => std::vec![(kind, 0.0, 1.0)],
        };
        for (kind, low, high) in ranges {
            let (from, to) = ((low / high).asin(), 0.5 * PI);
            let b = |t: f64| high * t.sin();
            for target in [self.angle, 2.0 * PI - self.angle] {
                let off = |t: f64| self.turn(kind, b(t)) - target;
                let at = |cell: f64| from + (to - from) * cell / f64::from(CELLS);
                let mut scan = |start: f64, end: f64| {
                    let (first, last) = (off(start), off(end));
                    is_near_fold |= first.abs() < 2e-6 || last.abs() < 2e-6;
                    if (first < 0.0) != (last < 0.0) {
                        let t = bisect(&off, start, end);
                        let h = 1e-6;
                        let slope = (off(t + h) - off(t - h)) / (2.0 * h) / (high * t.cos());
                        found.push((kind, b(t), slope));
                    }
                };
                for cell in 0..CELLS {
                    let cell = f64::from(cell);
                    // Next to where F turns there may be two in a cell.
                    let [first, second, third, fourth] = [-1.0, 0.0, 1.0, 2.0]
                        .map(|step| off(at((cell + step).clamp(0.0, CELLS.into()))));
                    let is_even = (second - first) * (fourth - third) > 0.0;
                    let parts = if is_even { 1 } else { FINER };
                    for part in 0..parts {
                        let part_at = |part: u32| at(cell + f64::from(part) / f64::from(parts));
                        scan(part_at(part), part_at(part + 1));
                    }
                }
            }
        }
        (found, is_near_fold)
    }

    /// What the kernel finds.
    fn ways(&self) -> Vec<(u32, f64, f64)> {
        let (near, far) = self.points();
        let mut ways = Ways::new(self.caster(), near, far, self.far.is_infinite());
        let mut found = Vec::new();
        for number in 0..Ways::MOST {
            let way = ways.way(number);
            if way.w >= 0.0 {
                let w = f64::from(way.w);
                let unit = if way.kind == HOLLOW { self.hollow } else { 1.0 };
                let b = unit * 2.0 * w / (1.0 + w * w);
                let aside = f64::from(near.cross(way.direction).length());
                assert!(
                    (aside - b).abs() < 2e-7 * (1.0 + self.near),
                    "{self:?} {way:?}"
                );
                found.push((way.kind, b, f64::from(way.spread)));
            }
        }
        found
    }
}

/// On the axis there is the path along it, and light has spread as behind a thin lens or before a
/// curved mirror: by (dx dy F′(0))².
#[test]
fn the_axis_is_a_way() {
    let mut numbers = Numbers(5);
    for number in 0..300 {
        let kind = [MIRROR, SOLID, HOLLOW][number % 3];
        let mut case = Case::random(&mut numbers, kind);
        case.angle = if kind == MIRROR { 0.0 } else { PI };
        let (n, q) = (case.index, case.hollow);
        let mut slope = match kind {
            MIRROR => 2.0,
            SOLID => 2.0 - 2.0 / n,
            _ => (2.0 - 2.0 / n) * (1.0 - 1.0 / q),
        };
        slope -= 1.0 / case.near + 1.0 / case.far;
        let far = if case.far.is_finite() { case.far } else { 1.0 };
        let expected = 1.0 / (case.near * far * slope).powi(2);
        let found = case.ways();
        assert_eq!(found.len(), 1, "{case:?} {found:?}");
        let (found_kind, b, spread) = found[0];
        assert_eq!((found_kind, b), (kind, 0.0));
        let off = (spread / expected - 1.0).abs();
        assert!(off < 1e-5 / slope.abs(), "{case:?} {spread} {expected}");
    }
}

/// What a point sends into the sphere arrives on a shell around it, but for what the hollow
/// reflects: the spread is the same seen from either end of a path.
#[test]
fn all_light_arrives() {
    const STEPS: u32 = 20_000;
    let case = |kind, hollow, index, near, far| Case {
        kind,
        hollow,
        index,
        near,
        far,
        angle: 0.0,
    };
    let cases = [
        case(MIRROR, 0.0, 1.0, 5.0, 3.0),
        case(MIRROR, 0.0, 1.0, 1.5, 1.1),
        case(SOLID, 0.0, 1.5, 5.0, 3.0),
        case(SOLID, 0.0, 1.5, 2.0, 8.0),
        case(SOLID, 0.0, 2.4, 1.1, 1.2),
        case(SOLID, 0.0, 1.0, 3.0, 4.0),
        case(HOLLOW, 0.5, 1.0, 3.0, 4.0),
        case(HOLLOW, 0.8, 1.5, 3.0, 4.0),
        case(HOLLOW, 0.3, 1.5, 3.0, 4.0),
    ];
    for case in cases {
        let mut arrives = 0.0;
        for step in 0..STEPS {
            let width = PI / f64::from(STEPS);
            let angle = (f64::from(step) + 0.5) * width;
            for (_, b, spread) in (Case { angle, ..case }).ways() {
                let cosine = (1.0 - (b / case.near).powi(2)).sqrt();
                let area = 2.0 * PI * case.near.powi(2) * angle.sin() * width;
                arrives += spread * cosine * area;
            }
        }
        let sent = |b: f64| 2.0 * PI * (1.0 - (1.0 - (b / case.far).powi(2)).sqrt());
        let reflected = if case.kind == HOLLOW {
            sent((case.index * case.hollow).min(1.0)) - sent(case.hollow)
        } else {
            0.0
        };
        let expected = sent(1.0) - reflected;
        std::println!("{case:?} {arrives} {expected}");
        // At a fold light has no bound, and the sum is off by the root of a step.
        assert!(
            (arrives / expected - 1.0).abs() < 0.02,
            "{case:?} {arrives}"
        );
    }
}

/// Where `off` changes its sign.
fn bisect(off: &dyn Fn(f64) -> f64, mut start: f64, mut end: f64) -> f64 {
    let is_below = off(start) < 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (start + end);
        if (off(middle) < 0.0) == is_below {
            start = middle;
        } else {
            end = middle;
        }
    }
    0.5 * (start + end)
}

/// Refracts a direction where the index before over that behind is `eta`, by Snell's law.
fn refract(direction: DVec3, normal: DVec3, eta: f64) -> DVec3 {
    let cosine = -normal.dot(direction);
    let kappa = 1.0 - eta * eta * (1.0 - cosine * cosine);
    direction * eta + normal * (eta * cosine - kappa.sqrt())
}

/// Where a ray from outside of the unit sphere leaves it, and along which direction, if it goes the
/// way of the kind.
fn travel(case: &Case, kind: u32, from: DVec3, direction: DVec3) -> (DVec3, DVec3) {
    // The nearer point on a sphere of this radius, or the farther.
    let meet = |from: DVec3, direction: DVec3, radius: f64, sign: f64| {
        let b = from.dot(direction);
        let squared = b * b - from.length_squared() + radius * radius;
        from + direction * (-b + sign * squared.sqrt())
    };
    let n = case.index;
    let at = meet(from, direction, 1.0, -1.0);
    if kind == MIRROR {
        return (at, direction - at * (2.0 * at.dot(direction)));
    }
    let (mut at, mut direction) = (at, refract(direction, at, 1.0 / n));
    if kind == HOLLOW {
        let q = case.hollow;
        at = meet(at, direction, q, -1.0);
        direction = refract(direction, at / q, n);
        at = meet(at, direction, q, 1.0);
        direction = refract(direction, -at / q, 1.0 / n);
    }
    at = meet(at, direction, 1.0, 1.0);
    (at, refract(direction, -at, n))
}

/// Rays that are refracted step by step arrive where they should, and spread as they should: by
/// central differences of where four neighbours of a ray arrive.
#[test]
fn rays_arrive_and_spread() {
    let mut numbers = Numbers(11);
    let (mut ways, mut strict, mut good) = (0, 0, 0);
    for number in 0..10_000 {
        let kind = [MIRROR, SOLID, HOLLOW][number % 3];
        let mut case = Case::random(&mut numbers, kind);
        case.near = case.near.min(50.0);
        let case = case.rounded();
        let (near, far) = case.points();
        let (x, y) = (near.as_dvec3(), far.as_dvec3());
        for (kind, b, spread) in case.ways() {
            let towards = |b: f64, sign: f64| {
                let axis = -x.normalize();
                let across = axis.cross(y).cross(axis).normalize();
                let sine = b / case.near;
                axis * (1.0 - sine * sine).sqrt() + across * (sign * sine)
            };
            // How far from y, or from the sun's direction, a ray passes.
            let miss = |direction: DVec3| {
                let (at, direction) = travel(&case, kind, x, direction);
                if case.far.is_infinite() {
                    return direction - y;
                }
                (y - at).reject_from(direction)
            };
            let sides = [towards(b, 1.0), towards(b, -1.0)];
            let aside = sides.map(|side| miss(side).length());
            let direction = sides[usize::from(aside[1] < aside[0])];
            let (u, v) = direction.any_orthonormal_pair();
            let h = 1e-6 * (case.near - 1.0).min(1.0) / case.near * (1.0 - b / case.near).sqrt();
            let change = |step: DVec3| {
                let to = |sign: f64| miss((direction + step * (sign * h)).normalize());
                (to(1.0) - to(-1.0)) / (2.0 * h)
            };
            let area = change(u).cross(change(v)).length();
            let (_, end) = travel(&case, kind, x, direction);
            assert!(end.is_finite(), "{case:?}");
            let product = area * spread;
            // The angle is known to a few 10⁻⁷, which next to the axis is a share of it. Light that
            // grazes spreads differently already to both sides of the ray.
            let off = (product - 1.0).abs();
            let allowed = 1e-3 + 1e-6 / (PI - case.angle);
            let most = if kind == HOLLOW { case.hollow } else { 1.0 };
            let nearest = case.near.min(case.far) - 1.0;
            if (b < 0.995 * most) & (nearest > 0.01) {
                assert!(off < allowed, "{kind} {b} {product} {case:?}");
                let distance = if case.far.is_finite() { case.far } else { 1.0 };
                let miss = aside[0].min(aside[1]) / distance;
                assert!(miss < 1e-5, "{kind} {b} {miss} {case:?}");
                strict += 1;
            }
            good += usize::from(off < allowed);
            ways += 1;
        }
    }
    std::println!("{ways} ways, {strict} of them plain, {good} good");
    assert!(
        strict > 4000 && good > ways * 95 / 100,
        "{ways} {strict} {good}"
    );
}

#[test]
fn every_way_is_found_and_no_other() {
    let mut numbers = Numbers(7);
    let (mut roots, mut several, mut largest) = (0, 0, 0.0_f64);
    for number in 0..10_000 {
        let kind = [MIRROR, SOLID, SOLID, HOLLOW][number % 4];
        let case = Case::random(&mut numbers, kind).rounded();
        let (expected, is_near_fold) = case.scan();
        let found = case.ways();
        if is_near_fold && expected.len() != found.len() {
            continue;
        }
        assert_eq!(
            expected.len(),
            found.len(),
            "{case:?}\n{expected:?}\n{found:?}"
        );
        roots += expected.len();
        several += usize::from(expected.len() > 1);
        for (kind, b, slope) in &expected {
            let off = |found: &&(u32, f64, f64)| {
                let off = if found.0 == *kind {
                    (found.1 - b).abs()
                } else {
                    9.0
                };
                (off * 1e9) as u64
            };
            let nearest = found.iter().min_by_key(off).expect("one");
            // How far off the angle of this path is.
            let angle = (nearest.1 - b).abs() * slope.abs();
            largest = largest.max(angle.min(1.0));
            assert!(angle < 1e-2, "{case:?}\n{expected:?}\n{found:?}");
        }
    }
    std::println!("{roots} roots, {several} cases with several, off by {largest:e} at most");
    assert!(roots > 7000 && several > 1500, "{roots} {several}");
}

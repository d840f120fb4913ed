//! The oracle: exact arithmetic that decides every intersection.
//!
//! A finite float is an integer times a power of two. All lengths (origin, centre, radius) are
//! brought to one power of two and the direction to another. Then o = O − C, a = d·d, b = o·d, c =
//! o·o − r² and Δ = b² − a c are integers, and the sign of Δ says whether the line meets the
//! sphere. The roots (−b ± √Δ) / a are irrational in general. An integer square root encloses them
//! between two fractions, with more and more digits until both ends round to the same float. A root
//! that is a float, or half-way between two, would never be decided that way: such a root is
//! rational, so Δ is a square, and the root is computed exactly.
//!
//! The integers are num-bigint's: pure Rust, with an integer square root, and fast enough for the
//! few hundred bits that occur here.

use num_bigint::{BigInt, BigUint, Sign};
use spherule_kernel::{Ray, Sphere};

/// The exact intersection of a line and a sphere.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Intersection {
    a: BigInt,
    b: BigInt,
    c: BigInt,
    discriminant: BigInt,
    radius_squared: BigInt,
    /// t in units of the scene is t in these integers times two to this power.
    exponent: i64,
}

/// A numerator and a positive denominator.
pub(super) struct Fraction(BigInt, BigInt);

impl Fraction {
    /// Whether this is less than another.
    pub(super) fn is_below(&self, other: &Self) -> bool {
        &self.0 * &other.1 < &other.0 * &self.1
    }
}

/// One of the two roots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Root {
    /// The smaller root, where the line enters.
    Near,
    /// The larger root, where the line leaves.
    Far,
}

impl Intersection {
    /// The intersection of the line through `ray` with `sphere`; `None` if a number is not finite
    /// or the direction is zero.
    #[must_use]
    pub fn of(ray: &Ray, sphere: &Sphere) -> Option<Self> {
        let origin = ray.origin.to_array();
        let center = sphere.center().to_array();
        let direction = ray.direction.to_array();
        let lengths = [
            origin[0],
            origin[1],
            origin[2],
            center[0],
            center[1],
            center[2],
            sphere.radius(),
        ];
        if !lengths.iter().chain(&direction).all(|x| x.is_finite()) {
            return None;
        }
        let (lengths, length_exponent) = to_integers(&lengths);
        let (d, direction_exponent) = to_integers(&direction);
        let o: Vec<BigInt> = (0..3).map(|i| &lengths[i] - &lengths[3 + i]).collect();
        let dot =
            |x: &[BigInt], y: &[BigInt]| -> BigInt { x.iter().zip(y).map(|(x, y)| x * y).sum() };
        let a = dot(&d, &d);
        if a.sign() == Sign::NoSign {
            return None;
        }
        let b = dot(&o, &d);
        let radius_squared = &lengths[6] * &lengths[6];
        let c = dot(&o, &o) - &radius_squared;
        let discriminant = &b * &b - &a * &c;
        Some(Self {
            a,
            b,
            c,
            discriminant,
            radius_squared,
            exponent: length_exponent - direction_exponent,
        })
    }

    /// The roots of a t² + 2b t + c, in units of two to a power; `a` is not negative.
    pub(super) fn of_coefficients(a: BigInt, b: BigInt, c: BigInt, exponent: i64) -> Self {
        let discriminant = &b * &b - &a * &c;
        Self {
            a,
            b,
            c,
            discriminant,
            radius_squared: BigInt::ZERO,
            exponent,
        }
    }

    /// Whether the quadratic is a constant: then it has no roots, or every number is one.
    pub(super) fn is_constant(&self) -> bool {
        self.a.sign() == Sign::NoSign
    }

    /// Two fractions between which a root is, with so many binary digits after the point of √Δ.
    pub(super) fn enclose(&self, root: Root, bits: u64) -> [Fraction; 2] {
        let low = (self.discriminant.magnitude() << (2 * bits)).sqrt();
        let high = &low + 1_u32;
        let end = |root_of: BigUint| {
            let signed = match root {
                Root::Near => -BigInt::from(root_of),
                Root::Far => BigInt::from(root_of),
            };
            let numerator = signed - (&self.b << bits);
            let shift = self.exponent - bits as i64;
            if shift >= 0 {
                Fraction(numerator << shift as u64, self.a.clone())
            } else {
                Fraction(numerator, &self.a << (-shift) as u64)
            }
        };
        match root {
            Root::Near => [end(high), end(low)],
            Root::Far => [end(low), end(high)],
        }
    }

    /// The sign of `constant` + `slope` · t, in these integers, at an exact root t.
    pub(super) fn sign_of_linear(&self, root: Root, constant: &BigInt, slope: &BigInt) -> i32 {
        // constant a − slope b ± slope √Δ.
        let left = constant * &self.a - slope * &self.b;
        let times = match root {
            Root::Near => -slope,
            Root::Far => slope.clone(),
        };
        let squared = &times * &times * &self.discriminant;
        let of_root = match sign(&squared) {
            0 => 0,
            _ => sign(&times),
        };
        match (sign(&left), of_root) {
            (one, 0) => one,
            (0, other) => other,
            (one, other) if one == other => one,
            // Of opposite signs: the larger decides.
            (one, _) => one * order(&(&left * &left), &squared),
        }
    }

    /// Whether the line meets the sphere, possibly in a single point.
    #[must_use]
    pub fn meets(&self) -> bool {
        self.discriminant.sign() != Sign::Minus
    }

    /// Whether the ray's origin is outside the sphere (1), on it (0) or inside it (−1).
    #[must_use]
    pub fn side_of_origin(&self) -> i32 {
        sign(&self.c)
    }

    /// |Δ| / (a r²), how far the line is from touching the sphere; to about 15 digits.
    #[must_use]
    pub fn margin(&self) -> f64 {
        ratio(&self.discriminant, &(&self.a * &self.radius_squared)).abs()
    }

    /// The root, rounded to the nearest float (ties to even); infinite if it is beyond the largest
    /// float. `None` if the line misses.
    #[must_use]
    pub fn root(&self, root: Root) -> Option<f32> {
        if !self.meets() {
            return None;
        }
        let sign = match root {
            Root::Near => -1,
            Root::Far => 1,
        };
        let magnitude = self.discriminant.magnitude();
        let exact = magnitude.sqrt();
        if &exact * &exact == *magnitude {
            let numerator = -&self.b + BigInt::from(sign) * BigInt::from(exact);
            return Some(round(&numerator, &self.a, self.exponent));
        }
        let mut bits = 64_u64;
        loop {
            // floor(√Δ · 2^bits), less than one below the true value.
            let low = (magnitude << (2 * bits)).sqrt();
            let high = &low + 1_u32;
            let end = |root: BigUint| {
                let numerator = -(&self.b << bits) + BigInt::from(sign) * BigInt::from(root);
                round(&numerator, &self.a, self.exponent - bits as i64)
            };
            let (one, other) = (end(low), end(high));
            if one.to_bits() == other.to_bits() {
                return Some(one);
            }
            bits *= 2;
        }
    }

    /// The smaller root that is in the ray's interval once it is rounded; `None` if there is none,
    /// or if an end of the interval is NaN. The largest float stands for infinity, which no root
    /// reaches.
    #[must_use]
    pub fn nearest(&self, ray: &Ray) -> Option<f32> {
        self.nearest_root(ray).map(|(_, t)| t)
    }

    /// As [`Intersection::nearest`], with which root it is.
    #[must_use]
    pub fn nearest_root(&self, ray: &Ray) -> Option<(Root, f32)> {
        let end = ray.end();
        let in_time = |t: &f32| *t >= ray.t_min && *t < ray.t_max && *t < end;
        [Root::Near, Root::Far]
            .into_iter()
            .find_map(|root| Some((root, self.root(root).filter(in_time)?)))
    }

    /// The largest 64-bit float that is not above the root, and the smallest that is not below it.
    /// `None` if the line misses.
    #[must_use]
    pub fn bracket(&self, root: Root) -> Option<[f64; 2]> {
        if !self.meets() {
            return None;
        }
        let magnitude = self.discriminant.magnitude();
        let sign = match root {
            Root::Near => Sign::Minus,
            Root::Far => Sign::Plus,
        };
        let mut bits = 128_u64;
        loop {
            // Between these is √Δ · 2^bits; they are the same if it is an integer.
            let scaled = magnitude << (2 * bits);
            let low = scaled.sqrt();
            let high = if &low * &low == scaled {
                low.clone()
            } else {
                &low + 1_u32
            };
            let [near, far] = [low, high].map(|root| {
                let numerator = -(&self.b << bits) + BigInt::from_biguint(sign, root);
                [false, true]
                    .map(|up| directed(&numerator, &self.a, self.exponent - bits as i64, up))
            });
            if near == far {
                return Some(near);
            }
            bits *= 2;
        }
    }

    /// The sign of the exact root minus `t`, a finite float; `None` if the line misses.
    #[must_use]
    pub fn compare(&self, root: Root, t: f32) -> Option<i32> {
        if !self.meets() {
            return None;
        }
        // (−b ± √Δ) / a · 2^e ≷ m · 2^f  ⇔  ±√Δ ≷ b + a m 2^(f − e), scaled to integers.
        let (m, f) = decompose(t);
        let shift = f - self.exponent;
        let (b, am, scale) = if shift >= 0 {
            (self.b.clone(), (&self.a * m) << shift as u64, 0)
        } else {
            (&self.b << (-shift) as u64, &self.a * m, (-shift) as u64)
        };
        let right = b + am;
        let left_squared = &self.discriminant << (2 * scale);
        let right_squared = &right * &right;
        Some(match root {
            // Compares √Δ with the right side.
            Root::Far if right.sign() == Sign::Minus => 1,
            Root::Far => order(&left_squared, &right_squared),
            // Compares −√Δ with the right side.
            Root::Near if right.sign() == Sign::Plus => -1,
            Root::Near => order(&right_squared, &left_squared),
        })
    }
}

/// Whether light is transmitted that meets a boundary at this cosine, if the refractive index on
/// its side is `eta` times that on the other: whether η²(1 − cos²) ≤ 1, exactly. False if a number
/// is not finite.
#[must_use]
pub fn is_transmitted(cosine: f32, eta: f32) -> bool {
    if !(cosine.is_finite() && eta.is_finite()) {
        return false;
    }
    let (c, c_exponent) = decompose(cosine);
    let (e, e_exponent) = decompose(eta);
    // Everything in units of two to the smaller exponent; both exponents are at most 104.
    let unit = 2 * c_exponent.min(0);
    let one = BigInt::from(1) << (-unit) as u64;
    let squared_sine = &one - ((&c * &c) << (2 * c_exponent - unit) as u64);
    let e_unit = 2 * e_exponent.min(0);
    let squared_eta = (&e * &e) << (2 * e_exponent - e_unit) as u64;
    squared_eta * squared_sine <= one << (-e_unit) as u64
}

fn sign(value: &BigInt) -> i32 {
    match value.sign() {
        Sign::Minus => -1,
        Sign::NoSign => 0,
        Sign::Plus => 1,
    }
}

fn order(a: &BigInt, b: &BigInt) -> i32 {
    sign(&(a - b))
}

/// The float as an integer times a power of two.
fn decompose(x: f32) -> (BigInt, i64) {
    let bits = x.to_bits();
    let exponent = i64::from((bits >> 23) & 0xff);
    let fraction = bits & 0x007f_ffff;
    let (mantissa, exponent) = if exponent == 0 {
        (fraction, -149)
    } else {
        (fraction | 0x0080_0000, exponent - 150)
    };
    let mantissa = BigInt::from(mantissa);
    (
        if x.is_sign_negative() {
            -mantissa
        } else {
            mantissa
        },
        exponent,
    )
}

/// The floats as integers times one common power of two.
pub(super) fn to_integers(values: &[f32]) -> (Vec<BigInt>, i64) {
    let parts: Vec<(BigInt, i64)> = values.iter().map(|value| decompose(*value)).collect();
    let common = parts
        .iter()
        .filter(|(mantissa, _)| mantissa.sign() != Sign::NoSign)
        .map(|(_, exponent)| *exponent)
        .min()
        .unwrap_or(0);
    let integers = parts
        .into_iter()
        .map(|(mantissa, exponent)| {
            if mantissa.sign() == Sign::NoSign {
                mantissa
            } else {
                mantissa << (exponent - common) as u64
            }
        })
        .collect();
    (integers, common)
}

/// The largest 64-bit float that is not above `numerator / denominator · 2^exponent`, or with `up`
/// the smallest that is not below it. The denominator is positive, and the quotient, if it is not
/// zero, neither subnormal nor too large.
fn directed(numerator: &BigInt, denominator: &BigInt, exponent: i64, up: bool) -> f64 {
    let is_negative = numerator.sign() == Sign::Minus;
    let (n, d) = (numerator.magnitude(), denominator.magnitude());
    if n.bits() == 0 {
        return 0.0;
    }
    // The quotient with 53 or 54 bits.
    let mut shift = 53 - (n.bits() as i64 - d.bits() as i64);
    let (n, d) = if shift >= 0 {
        (n << shift as u64, d.clone())
    } else {
        (n.clone(), d << (-shift) as u64)
    };
    let (mut quotient, mut is_exact) = (&n / &d, (&n % &d).bits() == 0);
    if quotient.bits() > 53 {
        is_exact &= !quotient.bit(0);
        quotient >>= 1;
        shift -= 1;
    }
    if !is_exact && up != is_negative {
        quotient += 1_u32;
    }
    let integer = quotient.iter_u64_digits().next().unwrap_or(0) as f64;
    let magnitude = integer * 2.0_f64.powi((exponent - shift) as i32);
    if is_negative { -magnitude } else { magnitude }
}

/// `numerator / denominator · 2^exponent` as the nearest float, ties to even, with subnormals and
/// infinity as in IEEE 754.
fn round(numerator: &BigInt, denominator: &BigInt, exponent: i64) -> f32 {
    let negative = (numerator.sign() == Sign::Minus) != (denominator.sign() == Sign::Minus);
    let (n, d) = (numerator.magnitude(), denominator.magnitude());
    if n.bits() == 0 {
        return 0.0;
    }
    // The quotient with 26 or 27 bits: 24 for the float and two for rounding; the rest makes the
    // sticky bit.
    let mut shift = 26 - (n.bits() as i64 - d.bits() as i64);
    // No finer than a quarter of the smallest subnormal.
    shift = shift.min(exponent + 151);
    let (n, d) = if shift >= 0 {
        (n << shift as u64, d.clone())
    } else {
        (n.clone(), d << (-shift) as u64)
    };
    let quotient = &n / &d;
    let sticky = u64::from(&quotient * &d != n);
    let quotient = quotient.iter_u64_digits().next().unwrap_or(0) << 1 | sticky;
    // quotient · 2^scale, as an integer of at most 28 bits. f64 holds it exactly, so the conversion
    // to f32 is the only rounding. Powers of two are multiplied in two steps, as one might
    // overflow.
    let scale = exponent - shift - 1;
    if scale > 200 {
        return if negative {
            f32::NEG_INFINITY
        } else {
            f32::INFINITY
        };
    }
    let half = scale / 2;
    let value = quotient as f64 * 2.0_f64.powi(half as i32) * 2.0_f64.powi((scale - half) as i32);
    let rounded = value as f32;
    if negative { -rounded } else { rounded }
}

/// The quotient of two large integers, to about 15 digits.
fn ratio(numerator: &BigInt, denominator: &BigInt) -> f64 {
    let shift: i64 = 60 - (numerator.bits() as i64 - denominator.bits() as i64);
    let (n, d) = if shift >= 0 {
        (numerator << shift as u64, denominator.clone())
    } else {
        (numerator.clone(), denominator << (-shift) as u64)
    };
    if d.sign() == Sign::NoSign {
        return f64::INFINITY;
    }
    let quotient = n / d;
    let digits = quotient.iter_u64_digits().next().unwrap_or(0) as f64;
    let scaled = digits * 2.0_f64.powi((-shift).clamp(-2000, 1000) as i32);
    if quotient.sign() == Sign::Minus {
        -scaled
    } else {
        scaled
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    fn line(origin: [f32; 3], direction: [f32; 3], center: [f32; 3], radius: f32) -> Intersection {
        Intersection::of(
            &Ray::new(origin.into(), direction.into()),
            &Sphere::new(center.into(), radius),
        )
        .expect("finite numbers")
    }

    #[test]
    fn simple_roots_are_exact() {
        let hit = line([0.0; 3], [0.0, 0.0, -1.0], [0.0, 0.0, -3.0], 0.5);
        assert_eq!(hit.root(Root::Near), Some(2.5));
        assert_eq!(hit.root(Root::Far), Some(3.5));
        assert_eq!(hit.side_of_origin(), 1);
        // A line through the centre has the largest margin.
        assert_eq!(hit.margin(), 1.0);
        assert_eq!(hit.bracket(Root::Near), Some([2.5, 2.5]));
        let miss = line([0.0; 3], [1.0, 0.0, 0.0], [0.0, 3.0, 0.0], 0.5);
        assert_eq!(miss.bracket(Root::Near), None);
    }

    /// 3 − √¾ = 2.13397459621556135324 and −3 − √¾ = −3.86602540378443864676, by a program that
    /// computes with sixty decimal digits.
    #[test]
    fn brackets_are_the_next_floats() {
        let known = [
            (-3.0, [2.133974596215561, 2.1339745962155616]),
            (3.0, [-3.866025403784439, -3.8660254037844384]),
        ];
        for (start, bracket) in known {
            let hit = line([start, 0.5, 0.0], [1.0, 0.0, 0.0], [0.0; 3], 1.0);
            assert_eq!(hit.bracket(Root::Near), Some(bracket));
        }
    }

    /// Light is transmitted up to the critical angle.
    #[test]
    fn light_passes_up_to_the_critical_angle() {
        // Without a boundary everything is transmitted, and so is light into a denser medium.
        assert!(is_transmitted(0.0, 1.0) && is_transmitted(1e-30, 0.5));
        // Critical angles, up to the rounding of the floats.
        for (cosine, eta) in [(0.6_f32, 1.25_f32), (0.8, 5.0 / 3.0)] {
            let kappa = 1.0 - f64::from(eta).powi(2) * (1.0 - f64::from(cosine).powi(2));
            assert!(
                kappa.abs() > 1e-10,
                "{kappa} is too close to call in 64 bits"
            );
            assert_eq!(is_transmitted(cosine, eta), kappa > 0.0);
        }
        assert!(!is_transmitted(0.5, 2.0) && is_transmitted(0.9, 2.0));
        assert!(!is_transmitted(f32::NAN, 1.5));
    }

    /// Lines that touch a sphere in rational coordinates, by Pythagoras: 3² + 4² = 5².
    #[test]
    fn pythagorean_tangents_touch_and_their_neighbours_do_not() {
        for (p, q, r) in [
            (3.0_f32, 4.0, 5.0_f32),
            (5.0, 12.0, 13.0),
            (8.0, 15.0, 17.0),
        ] {
            // The point of contact is (p, q, 0), and the direction there is (q, −p, 0).
            let origin = [p - 2.0 * q, q + 2.0 * p, 0.0];
            let touch = line(origin, [q, -p, 0.0], [0.0; 3], r);
            assert!(touch.meets());
            assert_eq!(touch.margin(), 0.0);
            assert_eq!(touch.root(Root::Near), Some(2.0));
            assert_eq!(touch.root(Root::Far), Some(2.0));
            assert!(line(origin, [q, -p, 0.0], [0.0; 3], r.next_up()).meets());
            assert!(!line(origin, [q, -p, 0.0], [0.0; 3], r.next_down()).meets());
        }
    }

    #[test]
    fn what_is_no_line_has_no_answer() {
        let sphere = Sphere::new(Vec3::ZERO, 1.0);
        for ray in [
            Ray::new(Vec3::ZERO, Vec3::ZERO),
            Ray::new(Vec3::NAN, Vec3::X),
            Ray::new(Vec3::ZERO, Vec3::INFINITY),
        ] {
            assert_eq!(Intersection::of(&ray, &sphere), None);
        }
    }

    #[test]
    fn rounding_is_to_nearest_even_down_to_subnormals_and_up_to_infinity() {
        let big = |n: i64| BigInt::from(n);
        assert_eq!(round(&big(1), &big(3), 0), 1.0 / 3.0);
        assert_eq!(round(&big(-2), &big(3), 0), -2.0 / 3.0);
        assert_eq!(round(&big((1 << 24) + 1), &big(1), 0), 16_777_216.0);
        assert_eq!(round(&big((1 << 24) + 3), &big(1), 0), 16_777_220.0);
        assert_eq!(round(&big(1), &big(1), -149), f32::from_bits(1));
        assert_eq!(round(&big(1), &big(1), -150), 0.0);
        assert_eq!(round(&big(3), &big(1), -151), f32::from_bits(1));
        assert_eq!(round(&big(1), &big(1), 128), f32::INFINITY);
        assert_eq!(round(&big(1), &big(1), 5000), f32::INFINITY);
        assert_eq!(round(&big(1), &big(1), -5000), 0.0);
    }

    /// Any finite float that is not extremely large or small.
    fn float() -> impl Strategy<Value = f32> {
        (-1.0_f32..1.0, -20_i32..20).prop_map(|(m, e)| m * 2.0_f32.powi(e))
    }

    proptest! {
        /// The rounding agrees with that of the hardware, which divides integers of 24 bits
        /// correctly.
        #[test]
        fn rounding_agrees_with_the_hardware(n in -(1_i32 << 24)..(1 << 24), d in 1_i32..(1 << 24), e in -60_i32..60) {
            let expected = (n as f32 / d as f32) * 2.0_f32.powi(e);
            prop_assert_eq!(round(&BigInt::from(n), &BigInt::from(d), i64::from(e)), expected);
        }

        /// An independent check: integer points on a sphere (x² + y² + z² = r²), seen along integer
        /// directions from an integer number of steps away, are roots by construction.
        #[test]
        fn integer_points_on_spheres_are_roots(
            quadruple in prop::sample::select(vec![
                [1, 2, 2, 3], [2, 3, 6, 7], [1, 4, 8, 9], [4, 4, 7, 9], [2, 6, 9, 11], [6, 6, 7, 11],
                [3, 4, 12, 13], [2, 5, 14, 15], [2, 10, 11, 15], [1, 12, 12, 17], [8, 9, 12, 17],
            ]),
            turn in 0_usize..3, signs in 0_u32..8, d in [-50_i32..50, -50_i32..50, -50_i32..50],
            steps in -300_i32..300, center in [-5000_i32..5000, -5000_i32..5000, -5000_i32..5000],
        ) {
            prop_assume!(d != [0, 0, 0]);
            let [x, y, z, r] = quadruple;
            let mut point = [x, y, z];
            point.rotate_left(turn);
            let sign = |axis: usize| if signs & (1 << axis) == 0 { 1 } else { -1 };
            let origin: [f32; 3] = std::array::from_fn(|i| (center[i] + sign(i) * point[i] - steps * d[i]) as f32);
            let hit = line(origin, d.map(|x| x as f32), center.map(|x| x as f32), r as f32);
            prop_assert!(hit.meets());
            let roots = [hit.root(Root::Near), hit.root(Root::Far)];
            prop_assert!(roots.contains(&Some(steps as f32)), "{:?} {}", roots, steps);
        }

        /// The quadratic has the sign that the position of the root demands, at the floats around
        /// the root, in exact arithmetic.
        #[test]
        fn roots_lie_between_the_floats_around_them(
            o in [float(), float(), float()], d in [float(), float(), float()],
            c in [float(), float(), float()], r in (0.001_f32..100.0),
        ) {
            let ray = Ray::new(o.into(), d.into());
            let Some(hit) = Intersection::of(&ray, &Sphere::new(c.into(), r)) else { return Ok(()) };
            if !hit.meets() {
                prop_assert_eq!(hit.root(Root::Near), None);
                return Ok(());
            }
            for root in [Root::Near, Root::Far] {
                let t = hit.root(root).expect("a root");
                prop_assume!(t.is_finite());
                // The exact root is between the half-way points to the neighbours.
                prop_assert!(hit.compare(root, t.next_down()).expect("a root") >= 0);
                prop_assert!(hit.compare(root, t.next_up()).expect("a root") <= 0);
                // The quadratic a t² + 2bt + c changes its sign at a root.
                let value = |t: f32| {
                    let (m, e) = decompose(t);
                    let e = e - hit.exponent;
                    let up = e.max(0) as u64;
                    let down = (-e).max(0) as u64;
                    let m: BigInt = m << up;
                    sign(&(&hit.a * &m * &m + ((BigInt::from(2) * &hit.b * &m) << down) + (&hit.c << (2 * down))))
                };
                let inside = value(t) <= 0 || value(t.next_up()) <= 0 || value(t.next_down()) <= 0;
                // Unless both roots are between the same two floats.
                prop_assert!(inside || hit.root(Root::Near) == hit.root(Root::Far));
            }
        }

        /// A power of two on the direction divides t by it, exactly.
        #[test]
        fn powers_of_two_scale_t(o in [float(), float(), float()], d in [float(), float(), float()], e in -10_i32..10) {
            let sphere = Sphere::new(Vec3::new(0.5, -0.25, 3.0), 2.0);
            let ray = Ray::new(o.into(), d.into());
            let scaled = Ray::new(o.into(), Vec3::from(d) * 2.0_f32.powi(e));
            let Some(hit) = Intersection::of(&ray, &sphere) else { return Ok(()) };
            let other = Intersection::of(&scaled, &sphere).expect("a line");
            prop_assert_eq!(hit.meets(), other.meets());
            if let Some(t) = hit.root(Root::Near).filter(|t| t.abs() > 1e-30 && t.abs() < 1e30) {
                prop_assert_eq!(other.root(Root::Near), Some(t / 2.0_f32.powi(e)));
            }
        }
    }
}

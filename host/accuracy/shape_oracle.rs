//! The oracle for shapes beside spheres: exact integers decide where a line enters and leaves one.
//!
//! Each surface is that of a quadratic in the line's parameter, with integers as coefficients, or a
//! plane, which is a quadratic with both roots the same. Which surface is met first is decided by
//! comparing exact roots: what is between two roots is found by ever more digits, and roots that
//! are the same to 2,048 bits are taken for equal. Heights of exact roots say which part of a
//! capsule is met.
//!
//! A rotation is that of the unit quaternion along the one that is given: with n = q·q, n R is a
//! matrix of integers.

use std::cmp::Ordering;

use glam::Vec3;
use num_bigint::{BigInt, Sign};
use spherule_kernel::Ray;
use spherule_kernel::shape::{Capsule, Cone, Cuboid, Cylinder, Disc, Ellipsoid};

use super::oracle::{Intersection, Root, to_integers};

/// Digits to which roots are compared.
const MOST_BITS: u64 = 2048;

/// An exact root: that of a quadratic.
pub type Boundary = (Intersection, Root);

/// Where a line enters and leaves a convex shape; `None` if it misses, or if a number is not finite
/// or the direction is zero.
pub type ExactSpan = Option<(Boundary, Boundary)>;

/// A shape that the oracle knows.
pub trait Exact {
    /// The exact part of a ray's line in the shape.
    fn exact_span(&self, ray: &Ray) -> ExactSpan;

    /// The parameter where the ray first meets the surface within its interval, once it is rounded;
    /// `None` if it does not.
    fn exact_hit(&self, ray: &Ray) -> Option<f32> {
        let (near, far) = self.exact_span(ray)?;
        let end = ray.end();
        [near, far].into_iter().find_map(|(quadratic, root)| {
            let t = quadratic.root(root)?;
            (t >= ray.t_min && t < ray.t_max && t < end).then_some(t)
        })
    }
}

/// Three integers.
type Integers = [BigInt; 3];

/// A line and lengths as integers.
struct Scaled {
    origin: Integers,
    direction: Integers,
    /// The lengths that were given.
    lengths: Vec<BigInt>,
    /// A parameter in units of the scene is that of these integers times two to this power.
    exponent: i64,
}

impl Scaled {
    fn of(ray: &Ray, lengths: &[f32]) -> Option<Self> {
        let mut all = ray.origin.to_array().to_vec();
        all.extend_from_slice(lengths);
        let direction = ray.direction.to_array();
        if !all.iter().chain(&direction).all(|x| x.is_finite()) || ray.direction == Vec3::ZERO {
            return None;
        }
        let (mut all, of_lengths) = to_integers(&all);
        let (direction, of_direction) = to_integers(&direction);
        let lengths = all.split_off(3);
        Some(Self {
            origin: three(&all),
            direction: three(&direction),
            lengths,
            exponent: of_lengths - of_direction,
        })
    }

    fn quadratic(&self, a: BigInt, b: BigInt, c: BigInt) -> Intersection {
        Intersection::of_coefficients(a, b, c, self.exponent)
    }

    /// Where a coordinate that is p at the parameter zero and grows by d is `at`; d is not zero.
    fn plane(&self, p: &BigInt, d: &BigInt, at: &BigInt) -> Boundary {
        let numerator = at - p;
        let quadratic = self.quadratic(d * d, -(&numerator * d), &numerator * &numerator);
        (quadratic, Root::Near)
    }

    /// The part where a coordinate is from −half to half; `Some(None)` for the whole line.
    fn slab(&self, p: &BigInt, d: &BigInt, half: &BigInt) -> Option<Option<(Boundary, Boundary)>> {
        let (low, high) = (-half, half.clone());
        match d.sign() {
            Sign::NoSign => (low <= *p && *p <= high).then_some(None),
            Sign::Plus => Some(Some((self.plane(p, d, &low), self.plane(p, d, &high)))),
            Sign::Minus => Some(Some((self.plane(p, d, &high), self.plane(p, d, &low)))),
        }
    }
}

fn three(integers: &[BigInt]) -> Integers {
    [0, 1, 2].map(|index| integers[index].clone())
}

fn dot(a: &Integers, b: &Integers) -> BigInt {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn minus(a: &Integers, b: &Integers) -> Integers {
    [0, 1, 2].map(|index| &a[index] - &b[index])
}

/// Which of two roots comes first.
fn compare(a: &Boundary, b: &Boundary) -> Ordering {
    let mut bits = 128;
    loop {
        let ([low_a, high_a], [low_b, high_b]) = (a.0.enclose(a.1, bits), b.0.enclose(b.1, bits));
        if high_a.is_below(&low_b) {
            return Ordering::Less;
        }
        if high_b.is_below(&low_a) {
            return Ordering::Greater;
        }
        if bits >= MOST_BITS {
            return Ordering::Equal;
        }
        bits *= 2;
    }
}

/// What is in each of several parts of a line; `None` if nothing is.
fn in_all(parts: Vec<(Boundary, Boundary)>) -> ExactSpan {
    let mut parts = parts.into_iter();
    let (mut near, mut far) = parts.next()?;
    for (other_near, other_far) in parts {
        if compare(&other_near, &near) == Ordering::Greater {
            near = other_near;
        }
        if compare(&other_far, &far) == Ordering::Less {
            far = other_far;
        }
    }
    (compare(&near, &far) != Ordering::Greater).then_some((near, far))
}

/// A line by a segment: from its start w, and the quadratic of its infinite cylinder.
struct ByAxis {
    scaled: Scaled,
    axis: Integers,
    from_start: Integers,
    /// v·v, v·w and v·d for the segment v.
    vv: BigInt,
    vw: BigInt,
    vd: BigInt,
    body: Intersection,
}

impl ByAxis {
    fn of(ray: &Ray, start: Vec3, end: Vec3, radius: f32) -> Option<Self> {
        let mut lengths = start.to_array().to_vec();
        lengths.extend(end.to_array());
        lengths.push(radius);
        let scaled = Scaled::of(ray, &lengths)?;
        let (start, end) = (three(&scaled.lengths), three(&scaled.lengths[3..]));
        let (d, radius) = (&scaled.direction, &scaled.lengths[6]);
        let (axis, w) = (minus(&end, &start), minus(&scaled.origin, &start));
        let (vv, vw, vd) = (dot(&axis, &axis), dot(&axis, &w), dot(&axis, d));
        let a = &vv * dot(d, d) - &vd * &vd;
        let b = &vv * dot(&w, d) - &vw * &vd;
        let c = &vv * (dot(&w, &w) - radius * radius) - &vw * &vw;
        let body = scaled.quadratic(a, b, c);
        Some(Self {
            axis,
            from_start: w,
            vv,
            vw,
            vd,
            body,
            scaled,
        })
    }

    /// The height of a root of the body, 0 at the start and v·v at the end, less `at`: its sign.
    fn height_sign(&self, root: Root, at: &BigInt) -> i32 {
        self.body.sign_of_linear(root, &(&self.vw - at), &self.vd)
    }

    /// The ball around the start, or around the end.
    fn ball(&self, is_end: bool) -> Intersection {
        let from = if is_end {
            minus(&self.from_start, &self.axis)
        } else {
            self.from_start.clone()
        };
        let (d, radius) = (&self.scaled.direction, &self.scaled.lengths[6]);
        let c = dot(&from, &from) - radius * radius;
        self.scaled.quadratic(dot(d, d), dot(&from, d), c)
    }
}

impl Exact for Capsule {
    fn exact_span(&self, ray: &Ray) -> ExactSpan {
        let line = ByAxis::of(ray, self.start, self.end, self.radius)?;
        if line.body.is_constant() {
            // Along the axis, or there is none.
            if line.vv.sign() != Sign::NoSign && line.body.side_of_origin() > 0 {
                return None;
            }
            let is_backwards = line.vd.sign() == Sign::Minus;
            let (first, last) = (line.ball(is_backwards), line.ball(!is_backwards));
            return (first.meets() && last.meets())
                .then_some(((first, Root::Near), (last, Root::Far)));
        }
        if !line.body.meets() {
            return None;
        }
        let end = |root: Root| {
            if line.height_sign(root, &BigInt::ZERO) < 0 {
                (line.ball(false), root)
            } else if line.height_sign(root, &line.vv) > 0 {
                (line.ball(true), root)
            } else {
                (line.body.clone(), root)
            }
        };
        let (near, far) = (end(Root::Near), end(Root::Far));
        (near.0.meets() && far.0.meets()).then_some((near, far))
    }
}

impl Exact for Cylinder {
    fn exact_span(&self, ray: &Ray) -> ExactSpan {
        let line = ByAxis::of(ray, self.start, self.end, self.radius)?;
        let mut parts = Vec::new();
        if line.body.is_constant() {
            if line.body.side_of_origin() > 0 {
                return None;
            }
        } else if line.body.meets() {
            parts.push((
                (line.body.clone(), Root::Near),
                (line.body.clone(), Root::Far),
            ));
        } else {
            return None;
        }
        // From the middle, twice: 2 v·w − v·v from −v·v to v·v.
        let (p, d) = (&line.vw * 2 - &line.vv, &line.vd * 2);
        parts.extend(line.scaled.slab(&p, &d, &line.vv)?);
        in_all(parts)
    }
}

impl Exact for Cone {
    fn exact_span(&self, ray: &Ray) -> ExactSpan {
        let start_radius = self.start_radius;
        let mut lengths = self.start.to_array().to_vec();
        lengths.extend(self.end.to_array());
        lengths.extend([start_radius, self.end_radius]);
        let scaled = Scaled::of(ray, &lengths)?;
        let (start, end) = (three(&scaled.lengths), three(&scaled.lengths[3..]));
        let (d, r) = (&scaled.direction, &scaled.lengths[6]);
        let grows = &scaled.lengths[7] - r;
        let (v, w) = (minus(&end, &start), minus(&scaled.origin, &start));
        let (vv, vw, vd) = (dot(&v, &v), dot(&v, &w), dot(&v, d));
        if vv.sign() == Sign::NoSign {
            return None;
        }
        // v·v² w·w − v·v (v·w)² = (r v·v + Δr v·w)², and the same with w + t d.
        let (radius, slope) = (r * &vv + &grows * &vw, &grows * &vd);
        let a = &vv * (&vv * dot(d, d) - &vd * &vd) - &slope * &slope;
        let b = &vv * (&vv * dot(&w, d) - &vw * &vd) - &radius * &slope;
        let c = &vv * (&vv * dot(&w, &w) - &vw * &vw) - &radius * &radius;
        let (p, by) = (&vw * 2 - &vv, &vd * 2);
        let between = scaled.slab(&p, &by, &vv)?;
        match a.sign() {
            Sign::Plus => {
                let quadratic = scaled.quadratic(a, b, c);
                if !quadratic.meets() {
                    return None;
                }
                let mut parts = vec![((quadratic.clone(), Root::Near), (quadratic, Root::Far))];
                parts.extend(between);
                in_all(parts)
            }
            Sign::Minus => {
                // In both cones, the one with a radius above zero being the one that grows.
                let quadratic = scaled.quadratic(-a, -b, -c);
                let (near, far) = between?;
                if slope.sign() == Sign::Plus {
                    in_all(vec![((quadratic, Root::Far), far.clone()), (near, far)])
                } else {
                    in_all(vec![(near.clone(), (quadratic, Root::Near)), (near, far)])
                }
            }
            // 2b t + c ≤ 0.
            Sign::NoSign => match b.sign() {
                Sign::NoSign if c.sign() == Sign::Plus => None,
                Sign::NoSign => between,
                Sign::Minus => {
                    let (near, far) = between?;
                    let from = scaled.plane(&c, &(&b * 2), &BigInt::ZERO);
                    in_all(vec![(from, far.clone()), (near, far)])
                }
                Sign::Plus => {
                    let (near, far) = between?;
                    let to = scaled.plane(&c, &(&b * 2), &BigInt::ZERO);
                    in_all(vec![(near.clone(), to), (near, far)])
                }
            },
        }
    }
}

impl Exact for Disc {
    fn exact_span(&self, ray: &Ray) -> ExactSpan {
        let mut lengths = self.center.to_array().to_vec();
        lengths.push(self.radius);
        let scaled = Scaled::of(ray, &lengths)?;
        if !self.normal.is_finite() {
            return None;
        }
        let (n, _) = to_integers(&self.normal.to_array());
        let (n, d) = (three(&n), &scaled.direction);
        let o = minus(&scaled.origin, &three(&scaled.lengths));
        let (height, slope) = (dot(&o, &n), dot(d, &n));
        if slope.sign() == Sign::NoSign {
            return None;
        }
        // The point, times the slope.
        let point = [0, 1, 2].map(|i| &o[i] * &slope - &d[i] * &height);
        let radius = &scaled.lengths[3] * &slope;
        if dot(&point, &point) > &radius * &radius {
            return None;
        }
        let met = scaled.plane(&height, &slope, &BigInt::ZERO);
        Some((met.clone(), met))
    }
}

/// A line in a turned frame: (q·q) Rᵀ(O − C), (q·q) Rᵀ d, and q·q.
struct InFrame {
    scaled: Scaled,
    p: Integers,
    d: Integers,
    n: BigInt,
    half: Integers,
}

impl InFrame {
    fn of(ray: &Ray, center: Vec3, half_axes: Vec3, rotation: glam::Vec4) -> Option<Self> {
        let mut lengths = center.to_array().to_vec();
        lengths.extend(half_axes.to_array());
        let scaled = Scaled::of(ray, &lengths)?;
        if !rotation.is_finite() {
            return None;
        }
        let (q, _) = to_integers(&rotation.to_array());
        let (vector, w) = (three(&q), &q[3]);
        let qq = dot(&vector, &vector);
        let turn = |v: &Integers| -> Integers {
            let along = dot(&vector, v) * 2;
            let cross = [0, 1, 2].map(|i| {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                &vector[j] * &v[k] - &vector[k] * &v[j]
            });
            [0, 1, 2].map(|i| (w * w - &qq) * &v[i] + &along * &vector[i] - w * 2 * &cross[i])
        };
        let from_center = minus(&scaled.origin, &three(&scaled.lengths));
        let half = three(&scaled.lengths[3..]);
        Some(Self {
            p: turn(&from_center),
            d: turn(&scaled.direction),
            n: w * w + qq,
            half,
            scaled,
        })
    }
}

impl Exact for Ellipsoid {
    fn exact_span(&self, ray: &Ray) -> ExactSpan {
        let line = InFrame::of(ray, self.center, self.half_axes, self.rotation)?;
        let [x, y, z] = &line.half;
        let others = [y * z, x * z, x * y];
        let scale = |v: &Integers| [0, 1, 2].map(|i| &v[i] * &others[i]);
        let (p, d) = (scale(&line.p), scale(&line.d));
        let radius = &line.n * x * y * z;
        let c = dot(&p, &p) - &radius * &radius;
        let quadratic = line.scaled.quadratic(dot(&d, &d), dot(&p, &d), c);
        quadratic
            .meets()
            .then(|| ((quadratic.clone(), Root::Near), (quadratic, Root::Far)))
    }
}

impl Exact for Cuboid {
    fn exact_span(&self, ray: &Ray) -> ExactSpan {
        let line = InFrame::of(ray, self.center, self.half_axes, self.rotation)?;
        let mut parts = Vec::new();
        for axis in 0..3 {
            let half = &line.half[axis] * &line.n;
            parts.extend(line.scaled.slab(&line.p[axis], &line.d[axis], &half)?);
        }
        in_all(parts)
    }
}

//! The screen: 64-bit arithmetic with a bound on its error. It decides nearly every intersection,
//! so that the oracle is rarely needed.
//!
//! With v = 2⁻⁵³ and N = |o||d|, forwards through the formulas: each component of o is off by at
//! most v|o|, of k by 8vN with room to spare, k·k by 32v|k|N + 4v k·k + 300v²N², a r² by 4v a r², b
//! by 8vN, c by 8v(o·o + r²). The root of Δ is off by the error of Δ over √Δ as long as that error
//! is less than a quarter of Δ. An answer counts only if both ends of its interval round to the
//! same float.

use spherule_kernel::{Ray, Sphere};

use super::oracle::Intersection;

/// The unit roundoff of 64-bit floats.
const V: f64 = 1.0 / (1_u64 << 53) as f64;

/// The nearest root in the ray's interval, correctly rounded, or `None` for a miss. The screen
/// decides if it can, else the oracle.
#[must_use]
pub fn nearest(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    match screen(ray, sphere) {
        Some(answer) => answer,
        None => Intersection::of(ray, sphere).and_then(|exact| exact.nearest(ray)),
    }
}

/// The screen's answer: a hit, a miss, or undecided (the outer `None`).
#[must_use]
pub fn screen(ray: &Ray, sphere: &Sphere) -> Option<Option<f32>> {
    let o = ray.origin.as_dvec3() - sphere.center().as_dvec3();
    let d = ray.direction.as_dvec3();
    let r = f64::from(sphere.radius());
    let (a, oo, rr) = (d.dot(d), o.dot(o), r * r);
    let n = (oo * a).sqrt();
    // Far from the ends of the range, where products would lose their relative accuracy.
    let sane = |x: f64| x > 1e-200 && x < 1e200;
    if !(sane(a) && sane(rr) && (oo == 0.0 || sane(oo))) {
        return None;
    }
    let k = o.cross(d);
    let kk = k.dot(k);
    let discriminant = a * rr - kk;
    let error = 4.0 * V * a * rr + 32.0 * V * kk.sqrt() * n + 4.0 * V * kk + 300.0 * V * V * n * n;
    if discriminant < -error {
        return Some(None);
    }
    if discriminant < 4.0 * error {
        return None;
    }
    let root = discriminant.sqrt();
    let b = o.dot(d);
    let size = b.abs() + root;
    let size_error = 8.0 * V * n + error / root + 4.0 * V * size;
    let c = oo - rr;
    let c_error = 8.0 * V * (oo + rr);
    let outer = size / a;
    let outer_error = outer * (size_error / size + 8.0 * V);
    let inner = c / size;
    let inner_error = c_error / size + inner.abs() * (size_error / size + 4.0 * V);
    // If the sign of b is not certain, the two formulas for the roots may be swapped.
    if b.abs() <= 8.0 * V * n && b != 0.0 {
        return None;
    }
    let roots = if b < 0.0 {
        [(inner, inner_error), (outer, outer_error)]
    } else {
        [(-outer, outer_error), (-inner, inner_error)]
    };
    for (t, error) in roots {
        let (low, high) = ((t - 2.0 * error) as f32, (t + 2.0 * error) as f32);
        if high < ray.t_min || low >= ray.t_max {
            continue;
        }
        return (low.to_bits() == high.to_bits()).then_some(Some(low));
    }
    Some(None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::families::Family;

    /// Whatever the screen decides, the oracle confirms; and the screen decides nearly always.
    #[test]
    fn the_screen_agrees_with_the_oracle() {
        for family in Family::ALL {
            let samples = family.sample(11, 4000);
            let mut spoke = 0;
            for (ray, sphere) in &samples {
                let exact = Intersection::of(ray, sphere).expect("a line").nearest(ray);
                if let Some(answer) = screen(ray, sphere) {
                    spoke += 1;
                    assert_eq!(answer, exact, "{}: {ray:?} {sphere:?}", family.name());
                }
            }
            // Least often on the surface, where c has lost nearly all of its digits.
            assert!(spoke * 10 > samples.len() * 7, "{}: {spoke}", family.name());
        }
    }
}

//! [`Ball`]: the ways of light between two points by one sphere: through it, or mirrored by it.
//! Runs on the GPU and on the CPU.
//!
//! Let x and y be two points outside of a sphere of radius r about C. A ray in a plane through C
//! keeps its distance b from C where it is reflected, and n b where it is refracted (Bouguer). So
//! all of the path lies in the plane of x, C and y, and b is the same for its first and its last
//! piece. Seen from C, the path turns from x to y by
//!
//! ```text
//! mirror   F = 2 asin(b/r) − asin(b/dx) − asin(b/dy)
//! ball     F = π + 2 asin(b/r) − 2 asin(b/nr) − asin(b/dx) − asin(b/dy)
//! hollow   F = that of a ball + 2 asin(b/nq) − 2 asin(b/q)
//! ```
//!
//! where n is the refractive index, q the radius of the hollow, dx = |x − C|, dy = |y − C|. The
//! turn must be φ, the angle between x − C and y − C, or 2π − φ on the other side of C. For a
//! mirror this is the problem of Alhazen.
//!
//! **How many there are.** (c² − b²)^(−½) is a strictly totally positive kernel (S. Karlin, Total
//! Positivity, 1968), so that a combination of such terms, as F′ is, has no more zeros in b than
//! its coefficients, ordered by c, have changes of sign. For a mirror and for a ball, n ≥ 1, they
//! are one positive and then negative ones: F′ has at most one zero, F falls before it and rises
//! after it. A mirror's F rises all along, because 1/√(r² − b²) exceeds the other terms. A
//! hollow's falls all along: with h(c) = (c² − b²)^(−½), h(q) − h(r) > h(nq) − h(nr) for n > 1,
//! which is the integral over c from q to r of c (c² − b²)^(−3/2) > n² c (n² c² − b²)^(−3/2).
//! Each piece on which F is monotone has one root or none, and its ends tell.
//!
//! **In floats.** With s = b/R, R the smallest radius, and w = tan(½ asin s) from 0 to 1, all
//! angles are arctangents of s / √(a + 1 − s²) with a ≥ 0, and differences of two of them are one
//! arctangent without cancellation. What is solved is G = F − π, or G = F for a mirror, against
//! the supplement of φ, or φ itself, so that both keep their digits about the axis.

use glam::Vec3;
// On the CPU, std has these functions.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use crate::arithmetic::arctangent::arctangent;

/// What light does at a sphere.
pub const MIRROR: u32 = 0;
/// It goes through glass.
pub const SOLID: u32 = 1;
/// It goes through glass, the hollow in it, and glass.
pub const HOLLOW: u32 = 2;

/// What stands for w where there is no path.
pub const NONE: f32 = -1.0;

/// What stands for the distance to a sun.
const ENDLESS: f32 = 1e15;
/// Steps of the solver at most. Bisection alone would leave 2⁻²⁴ of the bracket.
const STEPS: u32 = 24;
/// A root is found if a step moves it by less than this share of it: two units in the last place.
const CLOSE: f32 = 2.4e-7;

/// A sphere, two points beside it, and one of the ways between them. Lengths are in units of R, the
/// radius of the sphere, or of the hollow for the way through that.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    /// What light does, one of the constants.
    pub kind: u32,
    /// R, in scene units.
    pub unit: f32,
    /// dx² − 1.
    near: f32,
    /// dy² − 1; the square of [`ENDLESS`] for a sun.
    far: f32,
    /// r² − 1.
    outer: f32,
    /// n² r² − 1.
    glass: f32,
    /// n² − 1.
    inner: f32,
}

/// A path by a [`Ball`].
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// G.
    pub angle: f32,
    /// dG/d(asin s).
    pub slope: f32,
    /// s.
    pub sine: f32,
    /// √(1 − s²).
    pub cosine: f32,
}

/// c² − 1 for a distance of `distance`, `unit` being one.
#[inline]
fn beyond(distance: f32, unit: f32) -> f32 {
    let distance = distance.min(ENDLESS * unit);
    // A product of quotients, so that nothing overflows and nothing cancels near one.
    ((distance - unit) / unit * ((distance + unit) / unit)).max(0.0)
}

/// asin(s/√(a+1)) − asin(s/√(b+1)) for a ≤ b, where `root_a` is √(a + 1 − s²), and `root_b`.
#[inline]
fn apart(sine: f32, difference: f32, root_a: f32, root_b: f32) -> f32 {
    // Where the index is one, both roots are zero for the ray that grazes.
    let tangent = sine * difference / (root_a + root_b).max(f32::MIN_POSITIVE);
    arctangent(tangent, root_a * root_b + sine * sine)
}

impl Ball {
    /// The ways by a sphere of this radius, with a hollow of radius `hollow` if the kind is
    /// [`HOLLOW`], of glass of this refractive index, between points at these distances from its
    /// centre, both larger than the radius. The distance of a sun is [`f32::MAX`].
    #[inline]
    #[must_use]
    pub fn new(kind: u32, radius: f32, hollow: f32, index: f32, near: f32, far: f32) -> Self {
        let unit = if kind == HOLLOW { hollow } else { radius };
        let outer = beyond(radius, unit);
        let inner = ((index - 1.0) * (index + 1.0)).max(0.0);
        Self {
            kind,
            unit,
            near: beyond(near, unit),
            far: beyond(far, unit),
            outer,
            glass: inner + outer * index * index,
            inner,
        }
    }

    /// The path with w = `w`, from 0 to 1.
    #[inline]
    #[must_use]
    pub fn turn(&self, w: f32) -> Turn {
        let scale = 1.0 / (1.0 + w * w);
        let sine = 2.0 * w * scale;
        let cosine = (1.0 - w) * (1.0 + w) * scale;
        let squared = cosine * cosine;
        let near = (self.near + squared).sqrt();
        let far = (self.far + squared).sqrt();
        let ends = arctangent(sine * (near + far), near * far - sine * sine);
        let (mut angle, mut slope);
        if self.kind == MIRROR {
            angle = 2.0 * arctangent(sine, cosine);
            // 1 − cos/√(a + cos²), without cancellation.
            slope = self.near / (near * (near + cosine)) + self.far / (far * (far + cosine));
        } else {
            let outer = (self.outer + squared).sqrt();
            let glass = (self.glass + squared).sqrt();
            let step = self.glass - self.outer;
            angle = 2.0 * apart(sine, step, outer, glass);
            slope = -cosine * (1.0 / near + 1.0 / far);
            if self.kind == HOLLOW {
                let inner = (self.inner + squared).sqrt();
                angle -= 2.0 * apart(sine, self.inner, cosine, inner);
                slope += 2.0 * cosine * step / (outer * glass * (outer + glass))
                    - 2.0 * self.inner / (inner * (inner + cosine)).max(f32::MIN_POSITIVE);
            } else {
                slope += 2.0 * step / (glass * (outer + glass)).max(f32::MIN_POSITIVE);
            }
        }
        angle -= ends;
        Turn {
            angle,
            slope,
            sine,
            cosine,
        }
    }

    /// Where G turns from falling to rising between `low` and `high`; one of these if it only
    /// rises, or falls.
    #[inline]
    #[must_use]
    pub fn fold(&self, low: f32, high: f32) -> f32 {
        let (mut low, mut high) = (low, high);
        let (mut below, mut above) = (self.turn(low).slope, self.turn(high).slope);
        if below >= 0.0 {
            return low;
        }
        if above <= 0.0 {
            return high;
        }
        // Regula falsi, with the Illinois rule. At the fold G is flat, so that w need not be exact.
        let mut step = 0;
        while (step < STEPS) & (high - low > 1e-5) {
            let w = (low * above - high * below) / (above - below);
            let slope = self.turn(w).slope;
            if slope < 0.0 {
                (low, below) = (w, slope);
                above *= 0.5;
            } else {
                (high, above) = (w, slope);
                below *= 0.5;
            }
            step += 1;
        }
        if -below < above { low } else { high }
    }

    /// The root of G = `target` between `low` and `high`, where G is monotone; [`NONE`] if there is
    /// none.
    #[inline]
    #[must_use]
    pub fn root(&self, low: f32, high: f32, target: f32) -> f32 {
        let (mut low, mut high) = (low, high);
        let (start, end) = (self.turn(low).angle, self.turn(high).angle);
        let rises = start < end;
        // Half open at the fold, which ends one piece and begins the other.
        let is_between = if rises {
            (start < target) & (target <= end)
        } else {
            (end < target) & (target <= start)
        };
        if !is_between {
            return NONE;
        }
        let mut before = high - low;
        let share = (target - start) / (end - start);
        let share = if (share > 0.0) & (share < 1.0) {
            share
        } else {
            0.5
        };
        let mut w = low + before * share;
        let mut step = 0;
        while step < STEPS {
            let turn = self.turn(w);
            let off = turn.angle - target;
            if (off < 0.0) == rises {
                low = w;
            } else {
                high = w;
            }
            // asin s = 2 atan w.
            let newton = 0.5 * off * (1.0 + w * w) / turn.slope;
            let mut next = w - newton;
            let is_good = (next > low) & (next < high) & (newton.abs() < 0.5 * before);
            if !is_good {
                next = 0.5 * (low + high);
            }
            before = (next - w).abs();
            w = next;
            if before <= CLOSE * w {
                break;
            }
            step += 1;
        }
        w
    }

    /// The solid angle at x per area across the ray at y, of the path with w = `w`; for a sun, the
    /// solid angle at x per solid angle of the sun. `near` is x − C and `far` is y − C, in scene
    /// units, or the unit vector towards the sun.
    ///
    /// About the axis from x to C, dω = sin α dα dψ with b = dx sin α, and what arrives at y is
    /// dA = dy² sin φ cos β |dF/db| db dψ. So dω/dA = b / (dx² dy² cos α cos β sin φ |F′|).
    #[inline]
    #[must_use]
    pub fn spread(&self, w: f32, near: Vec3, far: Vec3, is_sun: bool) -> f32 {
        // On the axis both b and sin φ are zero; their quotient is that next to it.
        let turn = self.turn(w.max(1e-9));
        let near_length = near.length();
        let far_length = far.length();
        let lengths = near_length / self.unit * far_length;
        let squared = turn.angle * turn.angle;
        let sine = if squared < 0.09 {
            let series = 1.0 - squared / 20.0 * (1.0 - squared / 42.0);
            lengths * turn.angle.abs() * (1.0 - squared / 6.0 * series)
        } else {
            (near / self.unit).cross(far).length()
        };
        let cosines = turn.cosine * turn.cosine;
        let mut area = sine * (self.near + cosines).sqrt() * turn.slope.abs();
        if !is_sun {
            area *= self.unit * (self.far + cosines).sqrt();
        }
        turn.sine * turn.cosine / area.max(f32::MIN_POSITIVE)
    }
}

//! [`Ways`]: all ways of light between two points by one sphere. Runs on the GPU and on the CPU.

use glam::Vec3;
// On the CPU, std has these functions.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use super::ball::{Ball, HOLLOW, MIRROR, NONE, SOLID};
use crate::arithmetic::arctangent::arctangent;
use crate::surface::unit;

/// What a sphere is made of, as far as light that goes by it is concerned.
#[derive(Clone, Copy, Debug)]
pub struct Caster {
    /// [`MIRROR`] or [`SOLID`].
    pub kind: u32,
    /// The radius, in scene units.
    pub radius: f32,
    /// The radius of the hollow in it, zero for none.
    pub hollow: f32,
    /// The refractive index of glass, at least one.
    pub index: f32,
}

impl Caster {
    /// What light may do at the sphere, of one of the kinds in [`ball`](super::ball), between
    /// points at these distances from its centre.
    #[inline]
    #[must_use]
    pub fn ball(&self, kind: u32, near: f32, far: f32) -> Ball {
        Ball::new(kind, self.radius, self.hollow, self.index, near, far)
    }
}

/// A path between two points: where it starts out, and which of [`Ball`]'s it is.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// What light does at the sphere.
    pub kind: u32,
    /// Which path of the [`Ball`]; [`NONE`] if there is none.
    pub w: f32,
    /// The unit vector from x into the path.
    pub direction: Vec3,
    /// [`Ball::spread`].
    pub spread: f32,
}

/// All ways from a point x to a point y, or to a sun.
#[derive(Clone, Copy, Debug)]
pub struct Ways {
    caster: Caster,
    near: Vec3,
    far: Vec3,
    is_sun: bool,
    ball: Ball,
    /// The angle that a path must turn by, and its supplement.
    turn: f32,
    supplement: f32,
    /// Where the paths through solid glass begin, and where they turn.
    low: f32,
    fold: f32,
}

/// Up to this angle two points are on one axis: the plane of a path that is not along it would be
/// a matter of rounding. What is lost there of all light is a share as small.
const ON_AXIS: f32 = 1e-6;

impl Ways {
    /// So many there are at most.
    pub const MOST: u32 = 5;

    /// From x to y, where `near` is x − C and `far` is y − C for the sphere's centre C; for a sun,
    /// `far` is the unit vector towards it. Both points are outside of the sphere.
    #[inline]
    #[must_use]
    pub fn new(caster: Caster, near: Vec3, far: Vec3, is_sun: bool) -> Self {
        let (across, along) = (
            unit(near).cross(unit(far)).length(),
            unit(near).dot(unit(far)),
        );
        let far_length = if is_sun { f32::MAX } else { far.length() };
        let ball = caster.ball(caster.kind, near.length(), far_length);
        let mut ways = Self {
            caster,
            near,
            far,
            is_sun,
            ball,
            turn: arctangent(across, along),
            supplement: arctangent(across, -along),
            low: 0.0,
            fold: 1.0,
        };
        if caster.kind == SOLID {
            // Rays through glass miss the hollow if b > nq, and are reflected by it if b > q.
            let sine = (caster.index * caster.hollow / caster.radius).min(1.0);
            ways.low = sine / (1.0 + (1.0 - sine * sine).sqrt());
            ways.fold = ball.fold(ways.low, 1.0);
        }
        ways
    }

    /// The path with this number, below [`Ways::MOST`]. They are asked for in order.
    #[inline]
    #[must_use]
    pub fn way(&mut self, number: u32) -> Way {
        let is_mirror = self.caster.kind == MIRROR;
        let (mut low, mut high) = (self.low, 1.0);
        let (mut target, mut side) = (-self.supplement, 1.0);
        let mut is_one = number == 0;
        if is_mirror {
            target = self.turn;
        } else if number < 4 {
            // Before the fold and after it; on the side of y and on the other.
            is_one = true;
            if number & 1 == 0 {
                high = self.fold;
            } else {
                low = self.fold;
            }
            if number > 1 {
                (target, side) = (self.supplement, -1.0);
            }
        } else {
            is_one = self.caster.hollow > 0.0;
            low = 0.0;
            if is_one {
                let far = if self.is_sun {
                    f32::MAX
                } else {
                    self.far.length()
                };
                self.ball = self.caster.ball(HOLLOW, self.near.length(), far);
            }
        }
        let mut way = Way {
            kind: self.ball.kind,
            w: NONE,
            direction: Vec3::ZERO,
            spread: 0.0,
        };
        let is_axial = if is_mirror {
            self.turn
        } else {
            self.supplement
        } <= ON_AXIS;
        if is_one & !is_axial {
            way.w = self.ball.root(low, high, target);
        } else if is_one & (low <= 0.0) & ((number == 0) | (number == Self::MOST - 1)) {
            // Along the axis.
            way.w = 0.0;
        }
        if way.w >= 0.0 {
            way.direction = self.direction(way.w, side);
            way.spread = self.ball.spread(way.w, self.near, self.far, self.is_sun);
        }
        way
    }

    /// The direction from x into the path with w = `w`, on the side of y or on the other.
    #[inline]
    fn direction(&self, w: f32, side: f32) -> Vec3 {
        let axis = unit(self.near);
        // Perpendicular to the axis also where y is next to it, and the plane has few digits.
        let across = unit(axis.cross(unit(self.far)).cross(axis));
        // b/dx.
        let turn = self.ball.turn(w);
        let sine = turn.sine * self.ball.unit / self.near.length();
        let cosine = (1.0 - sine * sine).max(0.0).sqrt();
        unit(across * (side * sine) - axis * cosine)
    }
}

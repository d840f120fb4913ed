//! What a rung's errors move in the image of one sphere. The head of [`choose`](super) derives it.

use glam::DVec3;
use spherule_kernel::{Rung, Sphere};

/// Where a sphere is seen from, while it moves.
pub(super) struct Sight {
    pub(super) radius: f64,
    /// The largest distance of the eye from the sphere's centre.
    farthest: f64,
    /// The smallest distance.
    nearest: f64,
    /// The smallest |o·o − r²|.
    c: f64,
    /// The largest coordinate that the centre has while it moves; zero if it rests.
    moved: f64,
}

impl Sight {
    /// Of a sphere that moves by `from` and by `to` from where it is, and in a line between.
    pub(super) fn of(eye: DVec3, sphere: &Sphere, [from, to]: [DVec3; 2]) -> Self {
        let center = sphere.center().as_dvec3();
        let (nearest, farthest) = distances(eye - center - from, from - to);
        let radius = f64::from(sphere.radius()).abs();
        let c = if (nearest..=farthest).contains(&radius) && from != to {
            0.0
        } else {
            let of = |o: f64| (o * o - radius * radius).abs();
            of(nearest).min(of(farthest))
        };
        let moved = if from == DVec3::ZERO && to == DVec3::ZERO {
            0.0
        } else {
            (center.abs() + from.abs().max(to.abs())).max_element()
        };
        Self {
            radius,
            farthest,
            nearest,
            c,
            moved,
        }
    }

    /// Whether the eye is inside of the sphere at some time.
    pub(super) fn is_around_the_eye(&self) -> bool {
        self.nearest < self.radius
    }

    /// The range of distances from the eye at which the sphere's surface is seen.
    pub(super) fn range(&self) -> (f64, f64) {
        let nearest = if self.farthest < self.radius {
            self.radius - self.farthest
        } else {
            (self.nearest - self.radius).max(0.0)
        };
        (nearest, self.farthest + self.radius)
    }

    /// The largest shift, as an angle, that the rung's error can cause on this sphere.
    pub(super) fn shift(&self, rung: Rung) -> f64 {
        let single = f64::from(f32::EPSILON) / 2.0;
        let &Self {
            radius: r,
            farthest: o,
            c,
            ..
        } = self;
        let (oo, rr) = (o * o, r * r);
        let of_t = |u: f64| u * ((5.0 * oo + rr) / c + 1.0 + (29.0 * o + 5.0 * r) / c.sqrt());
        let of_foot = |u: f64| 17.0 * u;
        // |o| − r is c/(|o| + r).
        let of_motion = if self.moved > 0.0 {
            4.0 * single * self.moved * (o + r) / c
        } else {
            0.0
        };
        let of_rung = match rung {
            Rung::Textbook => {
                let of_t = 8.0 * single * (oo + rr) * (o + r) / (c * c.sqrt());
                of_t + of_foot(single) + 8.0 * single * o / r
            }
            Rung::Robust => of_t(single) + of_foot(single),
            Rung::Double => of_t(f64::EPSILON / 2.0) + single,
            Rung::Compensated => of_t(single * single) + single,
            Rung::Certified => single,
        };
        of_rung + of_motion
    }
}

/// The smallest and the largest length of `first` + s `way`, for s from 0 to 1.
pub(super) fn distances(first: DVec3, way: DVec3) -> (f64, f64) {
    let along = -first.dot(way) / way.length_squared();
    // NaN without a way.
    let along = if along.is_nan() {
        0.0
    } else {
        along.clamp(0.0, 1.0)
    };
    let ends = (first.length(), (first + way).length());
    ((first + way * along).length(), ends.0.max(ends.1))
}

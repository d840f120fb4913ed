//! Which point becomes the origin of a scene that is far from its own.
//!
//! A coordinate of 10⁶ is 0.06 off in 32-bit floats; one of the same thing near the origin is not.

use glam::DVec3;

use super::View;

/// A scene is far if what it shows is this many times as far from the origin as from the eye.
const FAR: f64 = 64.0;

/// The point that becomes the origin if an eye at this distance sees `target` in the middle of the
/// image; `None` if it is near the origin already.
///
/// It has few bits, so that differences have no more bits than the coordinates have.
pub(crate) fn near(target: DVec3, distance: f64) -> Option<DVec3> {
    let is_far = target.abs().max_element() > FAR * distance;
    if !(is_far && distance > 0.0) {
        return None;
    }
    let unit = distance.log2().ceil().exp2();
    Some((target / unit).round() * unit)
}

/// [`near`] what the view shows.
pub(crate) fn of(view: &View) -> Option<DVec3> {
    let (eye, target) = (view.eye.as_dvec3(), view.target.as_dvec3());
    near(target, eye.distance(target))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_origin_is_near_and_has_few_bits() {
        let target = DVec3::new(1e6 + 0.123, -2e6, 3.0);
        let origin = near(target, 7.0).expect("far");
        assert!((target - origin).abs().max_element() <= 4.0, "{origin}");
        assert_eq!(origin % 8.0, DVec3::ZERO);
        for (target, distance) in [(100.0, 2.0), (1.0, 0.0), (f64::NAN, 1.0)] {
            assert_eq!(near(DVec3::splat(target), distance), None);
        }
    }
}

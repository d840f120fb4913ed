//! Distances between floats, in units in the last place.

/// The distance of `a` and `b` in floats: 0 if they are equal, 1 if they are neighbours. Both zeros
/// are the same number.
///
/// ```
/// use spherule::ulp::distance;
///
/// assert_eq!(distance(1.0, 1.0 + f32::EPSILON), 1);
/// assert_eq!(distance(-0.0, 0.0), 0);
/// assert_eq!(distance(-f32::from_bits(1), f32::from_bits(1)), 2);
/// ```
#[must_use]
pub fn distance(a: f32, b: f32) -> u32 {
    // The bits of floats of one sign are in order. Negative ones are folded below zero.
    let position = |x: f32| {
        let bits = i64::from(x.to_bits());
        if bits < 1 << 31 {
            bits
        } else {
            (1 << 31) - bits
        }
    };
    // At most 2³² − 2 apart.
    position(a).abs_diff(position(b)) as u32
}

/// Two floats this far apart have no digit in common: one is at least four times the other.
const NO_DIGIT: u32 = 1 << 24;

/// A [`distance`] as text: "no digit" if no digit is right, as the number would then mean nothing;
/// a dash for `None`.
///
/// ```
/// use spherule::ulp::{distance, shown};
///
/// assert_eq!(shown(Some(3)), "3");
/// assert_eq!(shown(Some(distance(0.0, 19.6))), "no digit");
/// assert_eq!(shown(None), "–");
/// ```
#[must_use]
pub fn shown(distance: Option<u32>) -> String {
    match distance {
        None => "–".into(),
        Some(distance) if distance > NO_DIGIT => "no digit".into(),
        Some(distance) => distance.to_string(),
    }
}

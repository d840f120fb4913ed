//! Chooses the rung, and says why.

use spherule_kernel::Rung;

use super::args::Precision;
use crate::choose::choose;
use crate::device::Device;
use crate::scene::Scene;

/// The chosen rung and the messages about it.
pub(super) struct Chosen {
    pub(super) rung: Rung,
    /// The reason for the choice, in a few words.
    pub(super) why: String,
    /// A warning if the image does not meet the tolerance.
    pub(super) warning: Option<String>,
}

/// The requested rung, or else the one that the scene calls for.
pub(super) fn choose_rung(
    requested: Precision,
    scene: &Scene,
    tolerance: f64,
    device: &Device,
) -> Chosen {
    if let Some(rung) = requested.0 {
        return Chosen {
            rung,
            why: "requested".into(),
            warning: None,
        };
    }
    let choice = choose(scene, tolerance, device.has_f64());
    let rung = choice.rung;
    let mut why = format!(
        "within {} pixels, {} are allowed",
        pixels(choice.bound),
        pixels(tolerance)
    );
    if let Some((cheaper, bound)) = choice.cheaper {
        why += &format!("; {} might be off by {}", cheaper.name(), pixels(bound));
    }
    let warning = (!choice.is_within).then(|| {
        format!(
            "warning: no precision keeps this image within {} pixels; {}, the most exact one, may be off by {}. \
             Use a larger --tolerance, a smaller image, or a camera with a wider field of view closer to the scene.",
            pixels(tolerance),
            rung.name(),
            pixels(choice.bound),
        )
    });
    Chosen { rung, why, warning }
}

/// Two digits of a bound; "any number" for infinity and NaN.
fn pixels(bound: f64) -> String {
    let digits = format!("{bound:.1e}");
    match digits.parse::<f64>() {
        Ok(rounded) if (0.001..1e6).contains(&rounded) => rounded.to_string(),
        _ if !bound.is_finite() => "any number".into(),
        _ => digits,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_have_two_digits_or_none() {
        assert_eq!(pixels(0.123), "0.12");
        assert_eq!(pixels(1.23e-9), "1.2e-9");
        assert_eq!(pixels(f64::INFINITY), "any number");
        assert_eq!(pixels(f64::NAN), "any number");
    }
}

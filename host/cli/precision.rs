//! Which rung is taken, and what is said about it.

use spherule_kernel::Rung;

use super::args::Precision;
use crate::choose::choose;
use crate::device::Device;
use crate::scene::Scene;

/// A rung, and what is said about it.
pub(super) struct Chosen {
    pub(super) rung: Rung,
    /// Why this one, in a few words.
    pub(super) why: String,
    /// What the user must know of the image, where that is not what was asked for.
    pub(super) warning: Option<String>,
}

/// The rung that was asked for, or else the one that the scene calls for.
pub(super) fn choose_rung(
    asked_for: Precision,
    scene: &Scene,
    tolerance: f64,
    device: &Device,
) -> Chosen {
    if let Some(rung) = asked_for.0 {
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
             What helps: a larger --tolerance, a smaller image, or a camera with a wider field of view from nearer.",
            pixels(tolerance),
            rung.name(),
            pixels(choice.bound),
        )
    });
    Chosen { rung, why, warning }
}

/// Two digits of a bound; one that is not finite bounds nothing.
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

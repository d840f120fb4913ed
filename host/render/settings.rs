//! [`Settings`]: what is fixed before the work on an image begins.

use std::ops::ControlFlow;
use std::time::Duration;

use spherule_kernel::{Effects, Rung, Shading};

use crate::accel::Acceleration;

/// What is fixed before the kernel is compiled, on the GPU and on the CPU.
///
/// ```
/// use spherule::kernel::{Rung, Shading};
/// use spherule::render::Settings;
///
/// let settings = Settings::default().shading(Shading::Depth).rung(Rung::Double);
/// assert_eq!(settings.rung, Rung::Double);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// What the image shows of a hit.
    pub shading: Shading,
    /// How rays are intersected with spheres.
    pub rung: Rung,
    /// Whether spheres stand in a tree.
    pub acceleration: Acceleration,
    /// Which effects the pipeline holds; only [`Shading::Lit`] shows any.
    pub effects: EffectChoice,
    /// Stops after this time of tracing, give or take a launch on a GPU.
    pub time_limit: Option<Duration>,
    /// Stops taking samples of a tile of the image when its noise is as low as this: see
    /// [`Reached::noise`](super::paths::Reached::noise). Samples are then other ones than without:
    /// they belong to two groups, so that it can be told from them how far off they are.
    pub noise: Option<f64>,
}

impl Settings {
    /// With this mode of shading.
    #[must_use]
    pub fn shading(self, shading: Shading) -> Self {
        Self { shading, ..self }
    }

    /// With this rung.
    #[must_use]
    pub fn rung(self, rung: Rung) -> Self {
        Self { rung, ..self }
    }

    /// With or without a tree.
    #[must_use]
    pub fn acceleration(self, acceleration: Acceleration) -> Self {
        Self {
            acceleration,
            ..self
        }
    }

    /// With these effects in the pipeline.
    #[must_use]
    pub fn effects(self, effects: EffectChoice) -> Self {
        Self { effects, ..self }
    }

    /// With this limit on the time of tracing.
    #[must_use]
    pub fn time_limit(self, limit: Duration) -> Self {
        Self {
            time_limit: Some(limit),
            ..self
        }
    }

    /// With this target for the noise.
    #[must_use]
    pub fn noise(self, target: f64) -> Self {
        Self {
            noise: Some(target),
            ..self
        }
    }
}

impl From<Shading> for Settings {
    fn from(shading: Shading) -> Self {
        Self {
            shading,
            ..Self::default()
        }
    }
}

impl From<(Shading, Rung)> for Settings {
    fn from((shading, rung): (Shading, Rung)) -> Self {
        Self {
            shading,
            rung,
            ..Self::default()
        }
    }
}

/// Which effects the pipeline is compiled for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EffectChoice {
    /// Those that the scene calls for.
    #[default]
    Auto,
    /// Every effect there is; those that the scene does not call for stay idle.
    All,
    /// Those of this set that the scene calls for; the others are left out of the image.
    Only(Effects),
}

impl EffectChoice {
    /// Of the effects that a scene calls for, those that its image shows.
    #[must_use]
    pub fn shown(self, called: Effects) -> Effects {
        match self {
            Self::Auto | Self::All => called,
            Self::Only(effects) => called.within(effects),
        }
    }

    /// The effects that the pipeline is compiled for.
    #[must_use]
    pub fn compiled(self, called: Effects) -> Effects {
        match self {
            Self::All => Effects::ALL,
            Self::Auto | Self::Only(_) => self.shown(called),
        }
    }
}

/// Told how far a render is, a number from 0 to 1, and asked whether it goes on.
///
/// It is called from any thread, every few milliseconds of each on a CPU and after each launch on a
/// GPU, and so must be quick. Where it breaks off, the render ends with what it has: see
/// [`is_complete`](super::Rendered::is_complete).
pub type Progress<'a> = &'a (dyn Fn(f64) -> ControlFlow<()> + Sync);

/// Ignores progress, and always goes on.
pub const QUIET: Progress<'static> = &|_| ControlFlow::Continue(());

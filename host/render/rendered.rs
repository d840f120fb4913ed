//! [`Rendered`]: an image, and what it took.

use std::time::Duration;

use super::paths::budget::{Reached, StoppedBy};
use crate::film::Image;

/// An image, and what it took.
#[derive(Debug)]
pub struct Rendered {
    /// The image. Pixels that no ray was traced for are transparent, and black where nothing shows
    /// that; where a time limit left them out of an image of samples, they show a coarse preview
    /// instead.
    pub image: Image,
    /// How many pixels a ray was traced for: all, unless the render was stopped early.
    pub traced: u64,
    /// How many camera rays were traced for the image: one for each sample of each pixel, and none
    /// for a preview. Light paths go on from there.
    pub rays: u64,
    /// What it took.
    pub timings: Timings,
    /// How far it came, where there is more than one ray a pixel.
    pub reached: Option<Reached>,
}

impl Rendered {
    /// Whether each pixel was traced, and nothing broke off its samples: a time limit or a noise
    /// target that was reached did not.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        let pixels = u64::from(self.image.width()) * u64::from(self.image.height());
        let is_broken_off = |reached: Reached| reached.stopped_by == StoppedBy::Interrupted;
        self.traced == pixels && !self.reached.is_some_and(is_broken_off)
    }
}

/// Where the time of a render went.
#[derive(Clone, Copy, Debug, Default)]
pub struct Timings {
    /// Growing the tree; on a GPU, compiling the kernel and uploading the world, too.
    pub setup: Duration,
    /// Of that, compiling the kernel for these effects and this rung.
    pub compile: Duration,
    /// Tracing: the device's own time where it can be measured, else the host's.
    pub trace: Duration,
    /// Copying the image back; zero on the CPU.
    pub readback: Duration,
}

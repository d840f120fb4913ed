//! What a scene has besides spheres: light, a sky, a medium, a lens, and how it is sampled.

use std::f32::consts::PI;
use std::f64::consts::FRAC_PI_2;

use glam::Vec3;
use spherule_kernel::fog::Fog;

/// A point of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Where it is, in scene units.
    pub position: Vec3,
    /// Its radiant intensity, per steradian, linear Rec. 709: at a distance of one scene unit a
    /// surface that faces it has this irradiance.
    pub intensity: Vec3,
}

/// The light of the surroundings.
#[derive(Clone, Debug, PartialEq)]
pub struct Surroundings {
    /// The radiance at the horizon and below.
    pub horizon: Vec3,
    /// The radiance at the zenith, which is at +y.
    pub zenith: Vec3,
    /// The sun.
    pub sun: Option<Sun>,
    /// An image that is seen instead of horizon and zenith.
    pub image: Option<EnvironmentImage>,
}

/// The sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// The unit vector towards it.
    pub direction: Vec3,
    /// The angle across it, in degrees; zero for shadows without a soft edge.
    pub size: f32,
    /// The irradiance of a surface that faces it.
    pub irradiance: Vec3,
}

impl Sun {
    /// The angle between its middle and its edge, in radians.
    fn half_angle(&self) -> f64 {
        0.5 * f64::from(self.size).to_radians()
    }

    /// One minus the cosine of the angle between its middle and its edge.
    #[must_use]
    pub fn height(&self) -> f32 {
        (2.0 * (0.5 * self.half_angle()).sin().powi(2)) as f32
    }

    /// The radiance of its disc; `None` if it has no extent.
    #[must_use]
    pub fn radiance(&self) -> Option<Vec3> {
        // E = L π sin² of the half angle, while the disc is above the horizon.
        let squared_sine = self.half_angle().min(FRAC_PI_2).sin().powi(2) as f32;
        (self.height() > 0.0).then(|| self.irradiance / (PI * squared_sine))
    }
}

/// An equirectangular image of the surroundings.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentImage {
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// Radiance, row by row from the zenith; −z is in the middle of a row, +x right of it.
    pub texels: Vec<Vec3>,
}

/// A homogeneous medium in a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FogBall {
    /// The kernel's own words for the medium. With a radius of zero it fills the ball around
    /// the box of all spheres, where they are at time 0, and of the camera.
    pub medium: Fog,
}

/// The camera's lens and shutter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lens {
    /// The diameter of the lens, in scene units; zero for a pinhole.
    pub aperture: f32,
    /// How far from the eye the plane in focus is, in scene units; `None` for the distance to the
    /// target.
    pub focus_distance: Option<f32>,
    /// When the shutter opens and closes, in the unit of time of the velocities.
    pub shutter: (f32, f32),
}

/// How a scene is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Samples a pixel; `None` for 1 where nothing is random, else [`Sampling::DEFAULT_SAMPLES`].
    pub samples: Option<u32>,
    /// How often light is reflected or scattered on its way, at most.
    pub max_bounces: u32,
    /// How near something must be to keep ambient light away, in scene units; `None` for no ambient
    /// occlusion.
    pub ambient_occlusion: Option<f32>,
    /// Another image of the same expectation for each seed.
    pub seed: u32,
}

impl Sampling {
    /// Samples a pixel where something is random and nothing is said.
    pub const DEFAULT_SAMPLES: u32 = 64;
    /// Bounces where nothing is said.
    pub const DEFAULT_BOUNCES: u32 = 8;
}

impl Default for Sampling {
    fn default() -> Self {
        Self {
            samples: None,
            max_bounces: Self::DEFAULT_BOUNCES,
            ambient_occlusion: None,
            seed: 0,
        }
    }
}

/// From light to the colours of an 8-bit image; linear images are left as they are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Develop {
    /// Stops of exposure: light is multiplied by two to this power.
    pub exposure: f32,
    /// The curve.
    pub tonemap: Tonemap,
}

/// How light beyond the screen's white is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tonemap {
    /// Cut off at white.
    #[default]
    Clamp,
    /// L / (1 + L) of the luminance (E. Reinhard et al., Photographic tone reproduction for digital
    /// images, SIGGRAPH 2002).
    Reinhard,
    /// A film's curve (K. Narkowicz' fit of the Academy's, 2016).
    Aces,
}

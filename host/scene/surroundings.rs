//! Everything in a scene besides spheres: light, a sky, a medium, a lens, and how it is sampled.

use std::f32::consts::PI;
use std::f64::consts::FRAC_PI_2;

use glam::Vec3;
use spherule_kernel::filter::Filter;
use spherule_kernel::fog::Fog;

/// A point light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// The light's position, in scene units.
    pub position: Vec3,
    /// The radiant intensity, per steradian, linear Rec. 709. A surface that faces the light at a
    /// distance of one scene unit has this irradiance.
    pub intensity: Vec3,
}

/// The light of the surroundings.
#[derive(Clone, Debug, PartialEq)]
pub struct Surroundings {
    /// The radiance at the horizon and below.
    pub horizon: Vec3,
    /// The radiance at the zenith, which is at +y.
    pub zenith: Vec3,
    /// The sun; `None` for none.
    pub sun: Option<Sun>,
    /// An image that replaces horizon and zenith.
    pub image: Option<EnvironmentImage>,
    /// By how many degrees the image is turned to the right, seen from the scene.
    pub rotation: f32,
}

impl Surroundings {
    /// Whether light comes from the horizon or the zenith.
    pub(crate) fn is_plain_light(&self) -> bool {
        self.image.is_none() && (self.horizon != Vec3::ZERO || self.zenith != Vec3::ZERO)
    }
}

/// The sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// The unit vector towards the sun.
    pub direction: Vec3,
    /// The sun's angular diameter, in degrees; zero for shadows with hard edges.
    pub size: f32,
    /// The irradiance of a surface that faces the sun.
    pub irradiance: Vec3,
}

impl Sun {
    /// The angle between the sun's centre and its edge, in radians.
    fn half_angle(&self) -> f64 {
        0.5 * f64::from(self.size).to_radians()
    }

    /// One minus the cosine of the angle between the sun's centre and its edge.
    #[must_use]
    pub fn height(&self) -> f32 {
        (2.0 * (0.5 * self.half_angle()).sin().powi(2)) as f32
    }

    /// The radiance of the sun's disc; `None` if its diameter is zero.
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
    /// Radiance, row by row from the zenith. −z is in the middle of a row, with +x to the right of
    /// it.
    pub texels: Vec<Vec3>,
}

/// A homogeneous medium in a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FogBall {
    /// The medium in the kernel's terms. With a radius of zero it fills the ball around the box
    /// that encloses the camera and all spheres at time 0.
    pub medium: Fog,
}

/// The camera's lens and shutter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lens {
    /// The diameter of the lens, in scene units; zero for a pinhole.
    pub aperture: f32,
    /// The distance of the plane in focus from the eye, in scene units; `None` for the distance of
    /// the target.
    pub focus_distance: Option<f32>,
    /// The times at which the shutter opens and closes, in the unit of time of the velocities.
    pub shutter: (f32, f32),
}

/// How a scene is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Samples a pixel; `None` for 1 if nothing is random, else [`Sampling::DEFAULT_SAMPLES`].
    pub samples: Option<u32>,
    /// How often light bounces on its way from one surface to the next before it reaches the one
    /// that is seen, at most. With 0 that surface, be it a mirror, is lit directly and by nothing
    /// else. Lights, sun and sky count alike.
    pub max_bounces: u32,
    /// The distance within which surfaces block ambient light, in scene units; `None` for no
    /// ambient occlusion.
    pub ambient_occlusion: Option<f32>,
    /// What glass does to light without extent.
    pub glass_shadows: GlassShadows,
    /// The largest radiance, in any channel, that the indirect light of one sample adds: the light
    /// that is scattered more often than once between its source and the camera. That is biased;
    /// `None` for no limit.
    pub clamp: Option<f32>,
    /// How samples are spread around the middle of a pixel. With a single sample it is there.
    pub filter: Filter,
    /// Whether the light that a mirror or a ball of glass throws onto surfaces is computed exactly.
    pub caustics: bool,
    /// The seed of the random numbers. Each seed gives another image with the same expectation.
    pub seed: u32,
}

impl Sampling {
    /// The default number of samples a pixel, if anything is random.
    pub const DEFAULT_SAMPLES: u32 = 64;
    /// The default number of bounces.
    pub const DEFAULT_BOUNCES: u32 = 32;
}

impl Default for Sampling {
    fn default() -> Self {
        Self {
            samples: None,
            max_bounces: Self::DEFAULT_BOUNCES,
            ambient_occlusion: None,
            glass_shadows: GlassShadows::default(),
            clamp: None,
            filter: Filter::default(),
            caustics: false,
            seed: 0,
        }
    }
}

/// What glass does to the light of points and of a sun without extent, which no path meets by
/// chance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GlassShadows {
    /// It blocks that light.
    #[default]
    Dark,
    /// It lets that light through as if it did not bend, less what it absorbs and reflects. That is
    /// biased.
    Clear,
}

/// How light becomes the colours of an 8-bit image. Linear images are not changed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Develop {
    /// Stops of exposure: light is multiplied by two to this power.
    pub exposure: f32,
    /// The curve for bright light.
    pub tonemap: Tonemap,
}

/// How light brighter than the screen's white is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tonemap {
    /// Clamped to white.
    #[default]
    Clamp,
    /// L / (1 + L) of the luminance (E. Reinhard et al., Photographic tone reproduction for digital
    /// images, SIGGRAPH 2002).
    Reinhard,
    /// A film curve (K. Narkowicz' fit of the Academy's, 2016).
    Aces,
}

//! What the numbers of a scene may be: each range once, with its reason.

use std::fmt;

use glam::{DVec3, Vec3};
use spherule_kernel::Sphere;
use spherule_kernel::accel::node::Node;

/// The largest width or height of an image, in pixels.
pub const MAX_IMAGE_SIDE: u32 = 65_536;

/// The most samples a pixel: they are added up in 32-bit floats, whose roundings stay below a
/// thousandth of each sample up to here.
pub const MAX_SAMPLES: u32 = 1 << 16;

/// The most reflections and scatterings of one path: beyond, an image is never done.
pub const MAX_BOUNCES: u32 = 10_000;

/// The most spheres: a tree names no more, and 32 bits name each sphere and its material.
pub const MAX_SPHERES: usize = Node::MAX_SPHERES as usize;

/// The most texels of an image of the surroundings: twice those of 16,384 × 8,192. As the kernel
/// takes them, with their probabilities, they are 4 GiB.
pub const MAX_TEXELS: u64 = 1 << 28;

/// The largest coordinate or radius, in scene units: the sum of three squares of twice this is
/// still a 32-bit float, and a tree takes it.
pub const MAX_LENGTH: f32 = 1e18;
const _: () = assert!(MAX_LENGTH < Node::MAX_COORDINATE);

/// The largest radiance, in any unit: squares of luminances are added up for [`MAX_SAMPLES`], and
/// stay floats with a factor of a thousand to spare for the weights of samples.
pub const MAX_RADIANCE: f32 = 1e15;

/// Numbers from `low` to `high`, both among them.
///
/// A `low` of the smallest normal float stands for all above zero: smaller ones are zero to some
/// GPUs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The smallest.
    pub low: f32,
    /// The largest.
    pub high: f32,
}

impl Range {
    const fn new(low: f32, high: f32) -> Self {
        Self { low, high }
    }

    const fn above_zero(high: f32) -> Self {
        Self::new(f32::MIN_POSITIVE, high)
    }

    /// Whether the number is one of them; NaN never is.
    #[must_use]
    pub fn holds(self, number: f32) -> bool {
        (self.low..=self.high).contains(&number)
    }

    /// Whether all three numbers are among them.
    #[must_use]
    pub fn holds_all(self, numbers: Vec3) -> bool {
        numbers.to_array().iter().all(|number| self.holds(*number))
    }
}

/// As the end of "give a number …".
impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plain = |number: f32| {
            if number != 0.0 && !(1e-3..1e6).contains(&number.abs()) {
                format!("{number:e}")
            } else {
                number.to_string()
            }
        };
        if self.low == f32::MIN_POSITIVE {
            write!(f, "above zero, up to {}", plain(self.high))
        } else {
            write!(f, "from {} to {}", plain(self.low), plain(self.high))
        }
    }
}

/// A coordinate of a centre, the eye, the target or a light, in scene units; a component of `up`,
/// of the direction towards the sun, and of a velocity.
pub const COORDINATE: Range = Range::new(-MAX_LENGTH, MAX_LENGTH);
/// The radius of a sphere or of a ball of fog.
pub const RADIUS: Range = Range::above_zero(MAX_LENGTH);
/// The radius of a light, zero for a point.
pub const LIGHT_RADIUS: Range = Range::new(0.0, MAX_LENGTH);
/// How thick the shell of a hollow sphere is; see also [`hollow`].
pub const THICKNESS: Range = Range::above_zero(MAX_LENGTH);
/// How near something must be to keep ambient light away.
pub const AMBIENT_OCCLUSION: Range = Range::above_zero(MAX_LENGTH);
/// What the indirect light of a sample adds at most.
pub const CLAMP: Range = Range::above_zero(MAX_RADIANCE);
/// How wide the filter is, in pixels: with a wider one an image shows nothing but its blur.
pub const FILTER_WIDTH: Range = Range::above_zero(64.0);
/// The diameter of the lens.
pub const APERTURE: Range = Range::new(0.0, MAX_LENGTH);
/// How far away what is in focus is.
pub const FOCUS_DISTANCE: Range = Range::above_zero(MAX_LENGTH);
/// When the shutter opens or closes; it does not close before it opens. See also [`is_within`].
pub const TIME: Range = Range::new(-MAX_LENGTH, MAX_LENGTH);
/// Stops of exposure: two to this power is a float.
pub const EXPOSURE: Range = Range::new(-64.0, 64.0);
/// A channel of what a surface or a medium gives back of light: no more than it receives.
pub const REFLECTANCE: Range = Range::new(0.0, 1.0);
/// A channel of radiance: of the background, the sky, the sun's disc, and what glows.
pub const RADIANCE: Range = Range::new(0.0, MAX_RADIANCE);
/// A channel of a light's radiant intensity: that of [`MAX_RADIANCE`] by a sphere of radius 18; a
/// lamp for a planet has it. The sphere's radiance is a [`RADIANCE`].
pub const INTENSITY: Range = Range::new(0.0, 1e18);
/// A channel of the sun's irradiance. The disc's radiance is a [`RADIANCE`].
pub const IRRADIANCE: Range = Range::new(0.0, MAX_RADIANCE);
/// What a radiance is multiplied by. The product is a [`RADIANCE`].
pub const STRENGTH: Range = Range::new(0.0, 1e12);
/// By how many degrees the image of the sky is turned.
pub const ROTATION: Range = Range::new(-360.0, 360.0);
/// The roughness of metal and plastic.
pub const ROUGHNESS: Range = Range::new(0.0, 1.0);
/// The refractive index of glass over that of what surrounds it.
pub const INDEX: Range = Range::new(0.1, 10.0);
/// The refractive index of plastic's coat. Schlick's curve is far from Fresnel's equations below.
pub const COAT_INDEX: Range = Range::new(1.1, 4.0);
/// A channel of what glass absorbs, per scene unit.
pub const ABSORPTION: Range = Range::new(0.0, 1e18);
/// The angle across the sun, in degrees.
pub const SUN_SIZE: Range = Range::new(0.0, 180.0);
/// The chance of meeting a medium, per scene unit.
pub const EXTINCTION: Range = Range::new(1e-30, 1e12);
/// The mean cosine between light before and after a medium scattered it: at one, densities end.
pub const ANISOTROPY: Range = Range::new(-0.99, 0.99);

/// Whether a camera can see this many degrees from the lower to the upper edge of its image:
/// above 0, below 180.
#[must_use]
pub fn is_vertical_fov(degrees: f64) -> bool {
    degrees > 0.0 && degrees < 180.0
}

/// The radius of the hollow in a sphere with a shell so thick; `None` where nothing of it is left,
/// or where it rounds to the sphere's own, which is no shell.
#[must_use]
pub fn hollow(radius: f32, thickness: f32) -> Option<f32> {
    let hollow = radius - thickness;
    (RADIUS.holds(hollow) && hollow < radius).then_some(hollow)
}

/// Whether no point of a sphere is beyond [`MAX_LENGTH`] along any axis, at any time while the
/// shutter is open and at time 0.
#[must_use]
pub fn is_within(sphere: &Sphere, velocity: Vec3, (open, close): (f32, f32)) -> bool {
    let reach = |time: f32| {
        // Products of two floats are exact in 64 bits; a NaN is beyond, too.
        let center: DVec3 = sphere.center().as_dvec3() + velocity.as_dvec3() * f64::from(time);
        let far = center.abs() + f64::from(sphere.radius());
        far.cmple(DVec3::splat(MAX_LENGTH.into())).all()
    };
    reach(0.0) && (velocity == Vec3::ZERO || reach(open) && reach(close))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_hold_their_ends_and_say_so() {
        assert!(RADIUS.holds(MAX_LENGTH) && RADIUS.holds(f32::MIN_POSITIVE));
        assert!(!RADIUS.holds(0.0) && !RADIUS.holds(1e-40) && !RADIUS.holds(f32::NAN));
        assert!(!REFLECTANCE.holds_all(Vec3::new(0.0, 1.0, 1.0_f32.next_up())));
        assert_eq!(RADIUS.to_string(), "above zero, up to 1e18");
        assert_eq!(EXPOSURE.to_string(), "from -64 to 64");
        assert_eq!(EXTINCTION.to_string(), "from 1e-30 to 1e12");
    }

    #[test]
    fn a_hollow_is_smaller_than_its_sphere() {
        assert_eq!(hollow(1.0, 0.25), Some(0.75));
        assert_eq!(hollow(1.0, 1.0), None);
        assert_eq!(
            hollow(1.0, 1e-9),
            None,
            "it rounds to the sphere's own radius"
        );
        assert_eq!(
            hollow(1e10, 100.0),
            None,
            "it rounds to the sphere's own radius"
        );
        assert_eq!(hollow(1.0, f32::NAN), None);
    }

    #[test]
    fn a_sphere_is_within_with_all_that_it_has_and_wherever_it_goes() {
        let half = 0.5 * MAX_LENGTH;
        let sphere = Sphere::new(Vec3::new(0.0, half, 0.0), half);
        assert!(is_within(&sphere, Vec3::ZERO, (0.0, 1.0)));
        assert!(!is_within(&sphere, Vec3::Y * half, (0.0, 1.0)));
        assert!(is_within(&sphere, Vec3::Y * half, (0.0, 0.0)));
        assert!(!is_within(&sphere, Vec3::Y * -half, (-1.0, 0.0)));
        let sphere = Sphere::new(Vec3::new(0.0, MAX_LENGTH, 0.0), half);
        assert!(!is_within(&sphere, Vec3::ZERO, (0.0, 0.0)));
        assert!(!is_within(
            &Sphere::new(Vec3::NAN, 1.0),
            Vec3::ZERO,
            (0.0, 0.0)
        ));
    }
}

//! What one launch of a kernel is told, and what it writes: [`Launch`] and [`Pixel`] for `render`,
//! [`PathLaunch`] and [`Accumulator`] for `trace_paths`. Runs on the GPU and on the CPU.

use bytemuck::{Pod, Zeroable};
use glam::{UVec2, UVec4, Vec3, Vec4};

use crate::camera::Camera;
use crate::color::luminance;
use crate::fog::Fog;
use crate::hit::Hit;
use crate::light::sky::Sky;

/// One launch: a tile of the image against a run of the spheres.
///
/// A large image is rendered tile by tile, and a tile whose spheres do not fit one launch is
/// rendered run after run: the first launch of a tile writes every pixel, each later one
/// overwrites those in which it found something nearer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Launch {
    /// The camera.
    pub camera: Camera,
    /// The colour of a ray that hits nothing, linear Rec. 709.
    pub background: Vec3,
    /// 1 for the first launch of a tile, 0 for one that continues it.
    pub first_of_tile: u32,
    /// Width and height of the whole image, in pixels.
    pub image_size: UVec2,
    /// The tile's upper left pixel.
    pub tile_origin: UVec2,
    /// Width and height of the tile, in pixels.
    pub tile_size: UVec2,
    /// Index of the first sphere to test, in the buffer that is bound.
    pub first_sphere: u32,
    /// How many spheres to test.
    pub sphere_count: u32,
}

/// Pixels along each side of what a workgroup of `render_by_tiles` has.
pub const TILE: u32 = 32;

/// One pixel: a linear colour, and the depth that decides between launches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Pixel {
    color_depth: Vec4,
}

impl Pixel {
    /// A pixel with this colour and this depth.
    #[inline]
    #[must_use]
    pub fn new(color: Vec3, depth: f32) -> Self {
        Self {
            color_depth: color.extend(depth),
        }
    }

    /// Linear colour, or the measurement that the shading mode makes.
    #[inline]
    #[must_use]
    pub fn color(&self) -> Vec3 {
        self.color_depth.truncate()
    }

    /// Depth along the camera's forward axis in scene units, or [`Hit::NONE_T`] where the ray
    /// hit nothing. It is above zero in every pixel that a kernel wrote.
    #[inline]
    #[must_use]
    pub fn depth(&self) -> f32 {
        self.color_depth.w
    }

    /// Whether the pixel shows a sphere.
    #[inline]
    #[must_use]
    pub fn is_hit(&self) -> bool {
        self.depth() < Hit::NONE_T
    }

    /// Whether a kernel has written the pixel. Buffers start as zeros, and no kernel writes a
    /// depth of zero, so an invocation that ended early leaves this false behind.
    #[inline]
    #[must_use]
    pub fn is_written(&self) -> bool {
        self.depth() > 0.0
    }
}

/// One launch of `trace_paths`: a tile of the image and a run of its samples, against all spheres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PathLaunch {
    /// The camera.
    pub camera: Camera,
    /// Width and height of the whole image, in pixels.
    pub image_size: UVec2,
    /// The tile's upper left pixel.
    pub tile_origin: UVec2,
    /// Width and height of the tile, in pixels.
    pub tile_size: UVec2,
    /// Index of the first sample of each pixel.
    pub first_sample: u32,
    /// How many samples each pixel takes.
    pub sample_count: u32,
    /// Another image of the same expectation for each seed.
    pub seed: u32,
    /// How many times light bounces, at most: it is reflected, refracted or scattered once, and so
    /// many times more.
    pub max_bounces: u32,
    /// The radius of the lens, in scene units.
    pub lens_radius: f32,
    /// How far away, along the camera's forward axis, what is in focus is.
    pub focus_distance: f32,
    /// When the shutter opens and closes, in units of time.
    pub shutter_open: f32,
    /// See `shutter_open`.
    pub shutter_close: f32,
    /// How near, in scene units, something must be to keep ambient light away.
    pub ambient_distance: f32,
    /// The probability of choosing a sphere as the light is this times the luminance of its
    /// radiance and the square of its radius.
    pub sphere_light_probability: f32,
    /// The bits of the effects that the scene calls for: what else the pipeline holds stays idle.
    pub called_effects: u32,
    /// 1 if ambient light comes from the sky, 0 if it is white.
    pub has_ambient_sky: u32,
    /// 1 if light comes from a sky that is not an image, so that paths meet it only by chance.
    pub has_plain_sky: u32,
    /// Nothing; it keeps what follows where the GPU's layout has it.
    pub padding: u32,
    /// The glass spheres that hold the eye, the smallest first, and
    /// [`Hit::NONE_SPHERE`](crate::Hit::NONE_SPHERE) after the last.
    pub glass_at_eye: UVec4,
    /// What surrounds the scene.
    pub sky: Sky,
    /// The medium, if there is one.
    pub fog: Fog,
}

/// The samples of one pixel so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Accumulator {
    /// The sums of radiance and of alpha.
    pub(crate) color_alpha: Vec4,
    /// Of the luminance, the sum of squared differences from its mean; the number of samples; the
    /// depth of the first; the mean luminance.
    pub(crate) statistics: Vec4,
}

impl Accumulator {
    /// The largest channel of a sample's radiance: of 2¹⁶ squares of it the sum is still a float.
    pub const BRIGHTEST: f32 = (1_u64 << 55) as f32;

    /// Adds a sample: its radiance, its opacity, and the distance to the first sphere.
    ///
    /// The variance is kept as B. P. Welford does, Note on a method for calculating corrected sums
    /// of squares and products, Technometrics 4 (1962): without differences of large sums, which
    /// in 32-bit floats are all rounding if light is bright and steady.
    ///
    /// A channel above [`Accumulator::BRIGHTEST`] counts as that, and a NaN as zero: one sample
    /// does not destroy a pixel.
    #[inline]
    pub fn add(&mut self, radiance: Vec3, alpha: f32, depth: f32) {
        let radiance = Vec3::new(
            bounded(radiance.x),
            bounded(radiance.y),
            bounded(radiance.z),
        );
        let luminance = luminance(radiance);
        let count = self.statistics.y;
        let away = luminance - self.statistics.w;
        let mean = self.statistics.w + away / (count + 1.0);
        // The depth of a pixel is that of its first sample.
        let depth = if count == 0.0 {
            depth
        } else {
            self.statistics.z
        };
        self.color_alpha += radiance.extend(alpha);
        self.statistics = Vec4::new(
            self.statistics.x + away * (luminance - mean),
            count + 1.0,
            depth,
            mean,
        );
    }

    /// How many samples there are.
    #[inline]
    #[must_use]
    pub fn samples(&self) -> f32 {
        self.statistics.y
    }

    /// The mean radiance, times alpha.
    #[inline]
    #[must_use]
    pub fn color(&self) -> Vec3 {
        self.color_alpha.truncate() / self.samples().max(1.0)
    }

    /// The share of the samples that saw anything but the background.
    #[inline]
    #[must_use]
    pub fn alpha(&self) -> f32 {
        self.color_alpha.w / self.samples().max(1.0)
    }

    /// The distance that the first sample went before it met a sphere, [`Hit::NONE_T`] if it met
    /// none.
    #[inline]
    #[must_use]
    pub fn depth(&self) -> f32 {
        self.statistics.z
    }

    /// The estimated variance of the mean's luminance, as if the samples were independent: they are
    /// stratified, so that the true one is lower. Zero for fewer than two samples.
    #[inline]
    #[must_use]
    pub fn variance_of_mean(&self) -> f32 {
        let count = self.samples();
        if count < 2.0 {
            return 0.0;
        }
        self.statistics.x.max(0.0) / (count - 1.0) / count
    }
}

/// A channel of a sample's radiance, as it counts; there is none below zero.
#[inline]
fn bounded(channel: f32) -> f32 {
    if channel >= Accumulator::BRIGHTEST {
        Accumulator::BRIGHTEST
    } else if channel > 0.0 {
        channel
    } else {
        0.0
    }
}

const _: () = {
    assert!(size_of::<Launch>() == 112);
    assert!(core::mem::offset_of!(Launch, camera) == 0);
    assert!(core::mem::offset_of!(Launch, background) == 64);
    assert!(core::mem::offset_of!(Launch, first_of_tile) == 76);
    assert!(core::mem::offset_of!(Launch, image_size) == 80);
    assert!(core::mem::offset_of!(Launch, tile_origin) == 88);
    assert!(core::mem::offset_of!(Launch, tile_size) == 96);
    assert!(core::mem::offset_of!(Launch, first_sphere) == 104);
    assert!(core::mem::offset_of!(Launch, sphere_count) == 108);
    assert!(size_of::<Pixel>() == 16);
    assert!(core::mem::offset_of!(Pixel, color_depth) == 0);
    assert!(size_of::<PathLaunch>() == 288);
    assert!(core::mem::offset_of!(PathLaunch, sky) == 160);
    assert!(core::mem::offset_of!(PathLaunch, fog) == 240);
    assert!(size_of::<Accumulator>() == 32);
};

#[cfg(test)]
mod tests {
    use super::*;

    /// Bright light that hardly varies: what a difference of sums of squares makes of it is all
    /// rounding.
    #[test]
    fn the_variance_of_bright_and_steady_light_keeps_its_digits() {
        let mut pixel = Accumulator::default();
        for sample in 0..4096 {
            let light = 1000.0 + if sample % 2 == 0 { 0.25 } else { -0.25 };
            pixel.add(Vec3::splat(light), 1.0, 1.0);
        }
        let expected = 0.25 * 0.25 / 4096.0;
        let found = pixel.variance_of_mean();
        assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
    }

    #[test]
    fn one_sample_that_is_no_number_leaves_the_others() {
        let mut pixel = Accumulator::default();
        pixel.add(Vec3::splat(2.0), 1.0, 1.0);
        pixel.add(Vec3::new(f32::NAN, 2.0, f32::NEG_INFINITY), 1.0, 1.0);
        assert_eq!(pixel.color(), Vec3::new(1.0, 2.0, 1.0));
        for _ in 0..1 << 16 {
            pixel.add(Vec3::splat(f32::INFINITY), 1.0, 1.0);
        }
        assert!(pixel.color().is_finite() && pixel.variance_of_mean().is_finite());
    }
}

//! What one launch of a kernel is told, and what it writes: [`Launch`] and [`Pixel`] for `render`,
//! [`PathLaunch`] and [`Accumulator`] for `trace_paths`. Runs on the GPU and on the CPU.

use bytemuck::{Pod, Zeroable};
use glam::{UVec2, UVec4, Vec3, Vec4};

use crate::camera::Camera;
use crate::color::luminance;
use crate::filter::Filter;
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

/// The sign of a float.
const SIGN: u32 = 1 << 31;

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
        f32::from_bits(self.color_depth.w.to_bits() & !SIGN)
    }

    /// This pixel as one that a second launch is to write: see
    /// [`DEFERRING`](crate::precision::DEFERRING). Colour and depth are kept.
    #[inline]
    #[must_use]
    pub fn deferred(&self) -> Self {
        Self::new(
            self.color(),
            f32::from_bits(self.color_depth.w.to_bits() | SIGN),
        )
    }

    /// Whether a second launch is to write the pixel.
    #[inline]
    #[must_use]
    pub fn is_deferred(&self) -> bool {
        self.color_depth.w.to_bits() & SIGN != 0
    }

    /// Whether the pixel shows a sphere.
    #[inline]
    #[must_use]
    pub fn is_hit(&self) -> bool {
        self.depth() < Hit::NONE_T
    }

    /// Whether a kernel has written the pixel, and deferred nothing. Buffers start as zeros, and no
    /// kernel writes a depth of zero, so an invocation that ended early leaves this false behind.
    #[inline]
    #[must_use]
    pub fn is_written(&self) -> bool {
        self.color_depth.w > 0.0
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
    /// 1 where each tile of the image takes as many samples as it needs, 0 where all pixels take
    /// the same samples. Then `tile_size` is [`ADAPTIVE_TILE`] wide, the tiles stand below each
    /// other, each accumulator knows its tile ([`Accumulator::of_tile`]) and goes on from the
    /// samples that it has, and the samples belong to two groups in turn: see
    /// [`Accumulator::variance_by_groups`].
    pub is_adaptive: u32,
    /// The glass spheres that hold the eye, the smallest first, and
    /// [`Hit::NONE_SPHERE`](crate::Hit::NONE_SPHERE) after the last.
    pub glass_at_eye: UVec4,
    /// What surrounds the scene.
    pub sky: Sky,
    /// The medium, if there is one.
    pub fog: Fog,
    /// How samples are spread around the middle of a pixel.
    pub filter: Filter,
    /// The largest radiance, in any channel, that the indirect light of one sample adds.
    pub indirect_limit: f32,
    /// Where the table of the spheres that cast caustics begins, in the kernel's tables: see
    /// [`Entry`](crate::path::caustic::casters::Entry).
    pub first_caster: u32,
    /// The index in hits of the first shape beside the spheres, of which there are as many.
    pub first_shape: u32,
    /// Padding for the layout on a GPU.
    pub padding: u32,
}

/// Pixels along each side of a tile that takes as many samples as it needs.
pub const ADAPTIVE_TILE: u32 = 16;

/// The samples of one pixel so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Accumulator {
    /// The sums of radiance and of alpha.
    pub(crate) color_alpha: Vec4,
    /// Of the luminance, the sum of squared differences from its mean; the number of samples; the
    /// depth of the first; the mean luminance. Where samples belong to two groups, the first is
    /// the sum of the one group's luminance less that of the other, and the last is the number of
    /// the pixel's tile.
    pub(crate) statistics: Vec4,
}

impl Accumulator {
    /// The largest channel of a sample's radiance: of 2¹⁶ squares of it the sum is still a float.
    pub const BRIGHTEST: f32 = (1_u64 << 55) as f32;

    /// No samples yet of a pixel of the tile with this number. Tiles are counted row by row from
    /// the upper left of the image, up to 2²⁴ of them.
    #[inline]
    #[must_use]
    pub fn of_tile(tile: u32) -> Self {
        Self {
            color_alpha: Vec4::ZERO,
            statistics: Vec4::new(0.0, 0.0, 0.0, tile as f32),
        }
    }

    /// The pixel of the image whose samples these are, if they stand at `slot` of a launch of
    /// tiles: see [`PathLaunch::is_adaptive`]. Tiles at the right and lower edges have pixels that
    /// are beyond the image.
    #[inline]
    #[must_use]
    pub fn pixel_at(&self, slot: UVec2, image_size: UVec2) -> UVec2 {
        let tile = self.statistics.w as u32;
        let columns = (image_size.x.wrapping_add(ADAPTIVE_TILE - 1) / ADAPTIVE_TILE).max(1);
        UVec2::new(
            (tile % columns).wrapping_mul(ADAPTIVE_TILE) + slot.x % ADAPTIVE_TILE,
            (tile / columns).wrapping_mul(ADAPTIVE_TILE) + slot.y % ADAPTIVE_TILE,
        )
    }

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
        let radiance = bounded(radiance);
        let luminance = luminance(radiance);
        let away = luminance - self.statistics.w;
        let mean = self.statistics.w + away / (self.samples() + 1.0);
        let squares = self.statistics.x + away * (luminance - mean);
        self.count(radiance.extend(alpha), depth, squares, mean);
    }

    /// Adds a sample, as [`Accumulator::add`] does, where samples belong to two groups: this one to
    /// the first if `group` is even, else to the second.
    #[inline]
    pub fn add_to_group(&mut self, radiance: Vec3, alpha: f32, depth: f32, group: u32) {
        let radiance = bounded(radiance);
        let luminance = luminance(radiance);
        let signed = if group & 1 == 0 {
            luminance
        } else {
            -luminance
        };
        let difference = self.statistics.x + signed;
        self.count(radiance.extend(alpha), depth, difference, self.statistics.w);
    }

    /// Adds a sample whose radiance is bounded; `spread` and `last` are what is kept of the
    /// luminance.
    #[inline]
    fn count(&mut self, color_alpha: Vec4, depth: f32, spread: f32, last: f32) {
        let count = self.samples();
        // The depth of a pixel is that of its first sample.
        let depth = if count == 0.0 {
            depth
        } else {
            self.statistics.z
        };
        self.color_alpha += color_alpha;
        self.statistics = Vec4::new(spread, count + 1.0, depth, last);
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

    /// The estimated variance of the mean's luminance, where samples belong to two groups. Zero for
    /// fewer than two samples.
    ///
    /// Let A and B be the sums of the groups' luminance, of n / 2 samples each. The groups are
    /// independent and equally distributed, so that A and B have one expectation and one variance
    /// V. The mean is (A + B) / n and has the variance 2 V / n². The expectation of (A − B)² is
    /// 2 V, too. So (A − B)² / n² estimates the variance without bias, however much the samples of
    /// a group depend on each other. Of one pixel it says little; it is meant to be averaged over
    /// many.
    ///
    /// Where n is odd, the first group has one sample more. The mean stands in for that:
    /// A − B less the mean is (n² − 1) / 2n times the difference of the groups' means, and the bias
    /// is of the order of 1 / n².
    #[inline]
    #[must_use]
    pub fn variance_by_groups(&self) -> f32 {
        let count = self.samples();
        if count < 2.0 {
            return 0.0;
        }
        let is_odd = count as u32 & 1 == 1;
        let surplus = if is_odd { luminance(self.color()) } else { 0.0 };
        let error = (self.statistics.x - surplus) / count;
        error * error
    }
}

/// A sample's radiance, as it counts.
#[inline]
fn bounded(radiance: Vec3) -> Vec3 {
    Vec3::new(
        bounded_channel(radiance.x),
        bounded_channel(radiance.y),
        bounded_channel(radiance.z),
    )
}

/// A channel of it; there is none below zero.
#[inline]
fn bounded_channel(channel: f32) -> f32 {
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
    assert!(size_of::<PathLaunch>() == 320);
    assert!(core::mem::offset_of!(PathLaunch, is_adaptive) == 140);
    assert!(core::mem::offset_of!(PathLaunch, sky) == 160);
    assert!(core::mem::offset_of!(PathLaunch, fog) == 240);
    assert!(core::mem::offset_of!(PathLaunch, filter) == 288);
    assert!(core::mem::offset_of!(PathLaunch, indirect_limit) == 304);
    assert!(size_of::<Accumulator>() == 32);
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::random::Sampler;

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

    /// The difference of the groups' sums keeps its digits, too, and says what is known of it:
    /// here one group is 0.25 brighter.
    #[test]
    fn the_difference_of_bright_and_steady_groups_keeps_its_digits() {
        let mut pixel = Accumulator::of_tile(7);
        for sample in 0..4096 {
            let light = 1000.0 + if sample % 2 == 0 { 0.25 } else { 0.0 };
            pixel.add_to_group(Vec3::splat(light), 1.0, 1.0, sample);
        }
        let expected = (0.25 * 2048.0 / 4096.0_f32).powi(2);
        let found = pixel.variance_by_groups();
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
        // One sample more hardly changes it.
        pixel.add_to_group(Vec3::splat(1000.25), 1.0, 1.0, 4096);
        let odd = pixel.variance_by_groups();
        assert!((odd / expected - 1.0).abs() < 0.01, "{odd} {expected}");
    }

    /// For two groups of independent numbers the estimate is right in the mean, for even and odd
    /// numbers of samples.
    #[test]
    fn the_variance_by_groups_is_unbiased() {
        // Miri is a thousand times slower.
        const PIXELS: u32 = if cfg!(miri) { 50 } else { 20_000 };
        for samples in [2, 8, 9] {
            let mut sum = 0.0;
            for pixel in 0..PIXELS {
                let mut sums = Accumulator::of_tile(0);
                for sample in 0..samples {
                    let u = Sampler::new(sample, UVec2::new(pixel, 0), 0).single(0);
                    sums.add_to_group(Vec3::splat(u), 1.0, 1.0, sample);
                }
                sum += f64::from(sums.variance_by_groups());
            }
            let found = sum / f64::from(PIXELS);
            let expected = 1.0 / 12.0 / f64::from(samples);
            // Four standard errors, of squares of normal numbers, and the bias of odd ones.
            let tolerance = 4.0 * (2.0 / f64::from(PIXELS)).sqrt()
                + f64::from(samples % 2) * 3.0 / f64::from(samples * samples);
            assert!(
                (found / expected - 1.0).abs() < tolerance,
                "{samples}: {found} {expected}"
            );
        }
    }

    #[test]
    fn pixels_find_their_place_by_their_tile() {
        let size = UVec2::new(40, 20);
        // Three tiles in a row; the fifth is the second of the second row.
        let pixel = Accumulator::of_tile(4);
        assert_eq!(pixel.pixel_at(UVec2::new(3, 18), size), UVec2::new(19, 18));
        let last = Accumulator::of_tile((1 << 24) - 1);
        let size = UVec2::splat(1 << 16);
        assert_eq!(last.pixel_at(UVec2::splat(15), size), size - 1);
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

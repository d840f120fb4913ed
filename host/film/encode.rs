//! From linear colours and measurements to 8-bit colours.

use std::sync::LazyLock;

use glam::Vec3;
use rayon::prelude::*;
use spherule_kernel::Pixel;
use spherule_kernel::color::luminance;
use spherule_kernel::shading::{Quantity, index_of};

use super::Image;
use crate::scene::surroundings::Tonemap;

impl Image {
    /// The image as 8-bit red, green, blue, row by row.
    ///
    /// Light goes through the sRGB transfer curve (IEC 61966-2-1). Measurements do not: a normal n
    /// is n · 0.5 + 0.5, depth is a grey that falls linearly from white at the nearest distance to
    /// black at the farthest (see [`Image::depth_range`]), each sphere's index has a colour of its
    /// own, and flat red is as it is. Where nothing is hit, light and flat red have the background,
    /// through the curve; the others are black.
    #[must_use]
    pub fn to_rgb8(&self) -> Vec<u8> {
        let mut bytes = vec![0; self.pixels.len() * 3];
        Encoder::of(self).encode_rgb8(self, 0, &mut bytes);
        bytes
    }

    /// The image as 8-bit red, green, blue and opacity, row by row, colours not premultiplied, as
    /// PNG has it.
    #[must_use]
    pub fn to_rgba8(&self) -> Vec<u8> {
        let mut bytes = vec![0; self.pixels.len() * 4];
        Encoder::of(self).encode_rgba8(self, 0, &mut bytes);
        bytes
    }

    /// The nearest and the farthest distance that the image shows, in scene units; `None`
    /// unless it is a depth image that shows anything.
    #[must_use]
    pub fn depth_range(&self) -> Option<(f32, f32)> {
        if self.shading.quantity() != Quantity::Distance {
            return None;
        }
        self.pixels
            .iter()
            .filter(|pixel| pixel.is_hit())
            .map(|pixel| pixel.color().x)
            .fold(None, |range, distance| match range {
                None => Some((distance, distance)),
                Some((near, far)) => Some((distance.min(near), distance.max(far))),
            })
    }
}

/// Encodes the pixels of one image, or of several with a common depth range.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Encoder {
    quantity: Quantity,
    /// What light is multiplied by.
    exposure: f32,
    tonemap: Tonemap,
    near: f32,
    far: f32,
}

impl Encoder {
    pub(crate) fn of(image: &Image) -> Self {
        let (near, far) = image.depth_range().unwrap_or((0.0, 0.0));
        Self {
            quantity: image.shading.quantity(),
            exposure: image.develop.exposure.exp2(),
            tonemap: image.develop.tonemap,
            near,
            far,
        }
    }

    /// With a depth range that holds both images.
    pub(super) fn of_both(first: &Image, second: &Image) -> Self {
        let (first, second) = (Self::of(first), Self::of(second));
        Self {
            near: first.near.min(second.near),
            far: first.far.max(second.far),
            ..first
        }
    }

    /// As [`Image::to_rgb8`], of the pixels from the one with the index `first` on.
    pub(crate) fn encode_rgb8(&self, image: &Image, first: usize, bytes: &mut [u8]) {
        self.encode_pixels::<3>(&image.pixels[first..], bytes, |_, pixel| *pixel, |_| 0);
    }

    /// As [`Image::to_rgba8`], of the pixels from the one with the index `first` on.
    pub(crate) fn encode_rgba8(&self, image: &Image, first: usize, bytes: &mut [u8]) {
        let straight = |index, pixel: &Pixel| match image.opacity(first + index) {
            alpha if alpha > 0.0 => Pixel::new(pixel.color() / alpha, pixel.depth()),
            _ => Pixel::new(Vec3::ZERO, pixel.depth()),
        };
        let alpha = |index| (image.opacity(first + index).clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        self.encode_pixels::<4>(&image.pixels[first..], bytes, straight, alpha);
    }

    /// Fills `bytes` with `N` channels of as many pixels as there is room for: the colours of what
    /// `straight` makes of each, and then, if there is one channel more, `alpha`.
    fn encode_pixels<const N: usize>(
        &self,
        pixels: &[Pixel],
        bytes: &mut [u8],
        straight: impl Fn(usize, &Pixel) -> Pixel + Sync,
        alpha: impl Fn(usize) -> u8 + Sync,
    ) {
        const AT_ONCE: usize = 1 << 12;
        bytes
            .par_chunks_mut(N * AT_ONCE)
            .zip(pixels.par_chunks(AT_ONCE))
            .enumerate()
            .for_each(|(chunk, (bytes, pixels))| {
                let curve = Curve::get();
                // Neighbours often have one colour.
                let mut last = Pixel::default();
                let mut encoded = self.encode_bytes(curve, &last);
                for (at, (bytes, pixel)) in bytes.chunks_exact_mut(N).zip(pixels).enumerate() {
                    let index = chunk * AT_ONCE + at;
                    let pixel = straight(index, pixel);
                    if pixel != last {
                        (last, encoded) = (pixel, self.encode_bytes(curve, &pixel));
                    }
                    bytes[..3].copy_from_slice(&encoded);
                    if N > 3 {
                        bytes[3] = alpha(index);
                    }
                }
            });
    }

    /// The pixel's channels as bytes, rounded to nearest; a NaN becomes 0.
    #[inline]
    fn encode_bytes(&self, curve: &Curve, pixel: &Pixel) -> [u8; 3] {
        let byte = |channel| curve.byte(channel);
        match self.quantity {
            Quantity::Light => self.develop(pixel.color()).to_array().map(byte),
            Quantity::Color if !pixel.is_hit() => pixel.color().to_array().map(byte),
            Quantity::Color | Quantity::Vector | Quantity::Distance | Quantity::Index => {
                self.encode(pixel).map(|value| (value * 255.0 + 0.5) as u8)
            }
        }
    }

    /// Exposes light, and bends what is beyond the screen's white as the curve says.
    #[inline]
    fn develop(&self, light: Vec3) -> Vec3 {
        let light = light * self.exposure;
        match self.tonemap {
            Tonemap::Clamp => light,
            Tonemap::Reinhard => light / (1.0 + luminance(light)),
            Tonemap::Aces => {
                let curve = |x: f32| (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14);
                // The fit is of a curve with its own exposure.
                (light * 0.6).map(curve)
            }
        }
    }

    /// The pixel's channels, each between 0 and 1.
    pub(super) fn encode(&self, pixel: &Pixel) -> [f32; 3] {
        let color = pixel.color();
        match self.quantity {
            Quantity::Light => self.develop(color).to_array().map(srgb),
            Quantity::Color if pixel.is_hit() => color.to_array().map(|it| it.clamp(0.0, 1.0)),
            Quantity::Color => color.to_array().map(srgb),
            Quantity::Vector | Quantity::Distance | Quantity::Index if !pixel.is_hit() => [0.0; 3],
            Quantity::Vector => color.to_array().map(|it| (it * 0.5 + 0.5).clamp(0.0, 1.0)),
            Quantity::Distance => {
                let span = self.far - self.near;
                let grey = if span > 0.0 {
                    (self.far - color.x) / span
                } else {
                    1.0
                };
                [grey.clamp(0.0, 1.0); 3]
            }
            Quantity::Index => distinct(index_of(color)),
        }
    }
}

/// A colour for an index, unlike those of the indices near it: each channel from 0.2 to 1.
fn distinct(index: u32) -> [f32; 3] {
    // The finaliser of MurmurHash3 (A. Appleby, 2008): each bit of the index changes half of the
    // bits.
    let mut hash = index.wrapping_add(1);
    hash = (hash ^ hash >> 16).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
    hash ^= hash >> 16;
    [0, 8, 16].map(|shift| 0.2 + 0.8 * ((hash >> shift) & 0xff) as f32 / 255.0)
}

/// The sRGB transfer curve, from linear to encoded, clamped to 0 … 1.
#[must_use]
pub fn srgb(linear: f32) -> f32 {
    let linear = linear.clamp(0.0, 1.0);
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// From sRGB to linear Rec. 709 (IEC 61966-2-1), the inverse of [`srgb`].
#[must_use]
pub fn from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

/// [`srgb`] as a byte, rounded to nearest, by a table: the power is what takes longest about a
/// small scene's image.
///
/// For each byte the smallest number that has it, and for numbers of the same leading bits the byte
/// of the smallest among them.
struct Curve {
    smallest: [f32; 257],
    first: Vec<u8>,
}

impl Curve {
    /// Bits that are not looked at: the table takes 8 KiB.
    const DROPPED: u32 = 17;

    fn get() -> &'static Self {
        static CURVE: LazyLock<Curve> = LazyLock::new(Curve::new);
        &CURVE
    }

    fn new() -> Self {
        let of = |linear: f32| (srgb(linear) * 255.0 + 0.5) as u8;
        let mut smallest = [f32::INFINITY; 257];
        smallest[0] = 0.0;
        for byte in 1..=255 {
            // Positive floats are in the order of their bits.
            let (mut below, mut at) = (0, 1_f32.to_bits());
            while at - below > 1 {
                let middle = below + (at - below) / 2;
                if of(f32::from_bits(middle)) >= byte {
                    at = middle;
                } else {
                    below = middle;
                }
            }
            smallest[usize::from(byte)] = f32::from_bits(at);
        }
        let first = (0..=1_f32.to_bits() >> Self::DROPPED)
            .map(|bits| of(f32::from_bits(bits << Self::DROPPED)))
            .collect();
        Self { smallest, first }
    }

    #[inline]
    fn byte(&self, linear: f32) -> u8 {
        // A NaN is not above zero.
        let linear = if linear > 0.0 { linear.min(1.0) } else { 0.0 };
        let mut byte = self.first[(linear.to_bits() >> Self::DROPPED) as usize];
        while linear >= self.smallest[usize::from(byte) + 1] {
            byte += 1;
        }
        byte
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use spherule_kernel::{Hit, Shading};

    fn one_pixel(shading: Shading, color: Vec3, depth: f32) -> Vec<u8> {
        Image::new(1, 1, shading, vec![Pixel::new(color, depth)])
            .expect("an image")
            .to_rgb8()
    }

    #[test]
    fn light_is_curved_and_measurements_are_not() {
        let half = Vec3::splat(0.5);
        assert_eq!(one_pixel(Shading::Lit, half, 1.0), [188, 188, 188]);
        assert_eq!(one_pixel(Shading::Flat, half, Hit::NONE_T), [188, 188, 188]);
        let normal = Vec3::new(0.0, -1.0, 1.0);
        assert_eq!(one_pixel(Shading::Normals, normal, 1.0), [128, 0, 255]);
        assert_eq!(one_pixel(Shading::Flat, Vec3::X, 1.0), [255, 0, 0]);
    }

    #[test]
    fn the_table_is_the_curve() {
        let mut linear = 0.0_f32;
        while linear < 1.1 {
            assert_eq!(
                Curve::get().byte(linear),
                (srgb(linear) * 255.0 + 0.5) as u8,
                "{linear}"
            );
            linear = (linear * 1.000_01).max(linear + 1e-6);
        }
        for odd in [f32::NAN, -1.0, f32::INFINITY, f32::MIN_POSITIVE, -0.0] {
            assert_eq!(
                Curve::get().byte(odd),
                (srgb(odd) * 255.0 + 0.5) as u8,
                "{odd}"
            );
        }
    }

    #[test]
    fn depth_runs_from_white_to_black_between_its_ends() {
        let pixels = [2.0, 3.0, 4.0]
            .map(|distance| Pixel::new(Vec3::splat(distance), distance))
            .to_vec();
        let image = Image::new(3, 1, Shading::Depth, pixels).expect("an image");
        assert_eq!(image.depth_range(), Some((2.0, 4.0)));
        assert_eq!(image.to_rgb8(), [255, 255, 255, 128, 128, 128, 0, 0, 0]);
    }

    #[test]
    fn measurements_are_transparent_where_nothing_is_hit() {
        for shading in Shading::ALL {
            let pixels = [1.0, Hit::NONE_T].map(|depth| Pixel::new(Vec3::ONE, depth));
            let image = Image::new(2, 1, shading, pixels.to_vec()).expect("an image");
            let has_background = matches!(shading, Shading::Lit | Shading::Flat);
            assert_eq!(image.has_alpha(), !has_background, "{shading:?}");
            let alpha = if has_background { 255 } else { 0 };
            assert_eq!(image.to_rgba8()[3], 255, "{shading:?}");
            assert_eq!(image.to_rgba8()[7], alpha, "{shading:?}");
        }
    }

    /// Neighbours in a row of spheres have colours that a person tells apart.
    #[test]
    fn indices_have_colours_of_their_own() {
        let colors: Vec<[u8; 3]> = (0..1000)
            .map(|index| distinct(index).map(|channel| (channel * 255.0) as u8))
            .collect();
        let away = |a: &[u8; 3], b: &[u8; 3]| -> u32 {
            let channels = a.iter().zip(b);
            channels.map(|(a, b)| u32::from(a.abs_diff(*b))).sum()
        };
        let close = colors
            .windows(2)
            .filter(|pair| away(&pair[0], &pair[1]) < 24);
        assert!(close.count() < 10);
        let mut all = colors.clone();
        all.sort_unstable();
        all.dedup();
        assert!(all.len() > 995, "{}", all.len());
    }

    #[test]
    fn opacities_are_rounded_and_colours_divided_by_them() {
        let opacities = [0.25, 0.498, 1.0, 0.0, 2.0, -1.0];
        let pixels = opacities.map(|alpha: f32| Pixel::new(Vec3::splat(alpha.max(0.0)), 1.0));
        let mut image = Image::new(6, 1, Shading::Lit, pixels.to_vec()).expect("an image");
        image.set_alpha(opacities.to_vec()).expect("opacities");
        let bytes = image.to_rgba8();
        let alphas: Vec<u8> = bytes.iter().skip(3).step_by(4).copied().collect();
        assert_eq!(alphas, [64, 127, 255, 0, 255, 0]);
        let reds: Vec<u8> = bytes.iter().step_by(4).copied().collect();
        assert_eq!(reds, [255, 255, 255, 0, 255, 0]);
    }

    #[test]
    fn out_of_range_and_nan_are_clamped() {
        assert_eq!(
            one_pixel(Shading::Lit, Vec3::new(-1.0, 2.0, f32::NAN), 1.0),
            [0, 255, 0]
        );
    }
}

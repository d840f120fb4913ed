//! [`Sky`]: the light that comes from where there is nothing. Runs on the GPU and on the CPU.

use core::f32::consts::{PI, TAU};

use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec2, Vec3};
// On the CPU, std has these functions.
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

use crate::arithmetic::arctangent::arctangent;
use crate::arithmetic::elements::{Bisection, read};
use crate::arithmetic::turn::turn;
use crate::effects::Effects;
use crate::material::microfacet::ALBEDO_LEN;

/// The sky: a colour, or a gradient from the horizon to the zenith (+y), or an image of the
/// surroundings; and a sun.
///
/// An image is an equirectangular map of `environment_size` texels: its columns go once around,
/// with −z in the middle and +x right of it, its rows from the zenith to the nadir. Radiance is
/// linear between the middles of texels. In the kernel's tables lie, after [`ALBEDO_LEN`] floats,
/// the cumulative probability of each row, and that of each texel in its row; the texels' three
/// channels are in a buffer of their own, because no device binds as much as an image of 16,384 ×
/// 8,192 takes with all of these.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Sky {
    /// The radiance at the horizon and below, or of the whole sky if it has no gradient. From there
    /// to the zenith it changes with the sine of the elevation.
    pub horizon: Vec3,
    /// The probability that the environment is the light that is sampled.
    pub environment_probability: f32,
    /// The radiance at the zenith.
    pub zenith: Vec3,
    /// The probability that the sun is the light that is sampled.
    pub sun_probability: f32,
    /// The unit vector towards the sun.
    pub sun_direction: Vec3,
    /// One minus the cosine of the angle between the sun's middle and its edge.
    pub sun_height: f32,
    /// The sun's radiance.
    pub sun_radiance: Vec3,
    /// By how much of a whole turn the image is turned to the right, seen from the middle.
    pub environment_turn: f32,
    /// Width and height of the image of the surroundings, in texels.
    pub environment_size: UVec2,
    /// Padding for the layout on a GPU.
    pub padding_end: UVec2,
}

impl Sky {
    /// The radiance from `direction`, a unit vector, without the sun; `texels` are the image's
    /// channels.
    #[inline]
    #[must_use]
    pub fn radiance(&self, effects: Effects, direction: Vec3, texels: &[f32]) -> Vec3 {
        if effects.any(Effects::ENVIRONMENT) {
            self.interpolated(direction, texels)
        } else if effects.any(Effects::SKY_GRADIENT) {
            self.horizon + (self.zenith - self.horizon) * direction.y.clamp(0.0, 1.0)
        } else {
            self.horizon
        }
    }

    /// Whether `direction`, a unit vector, points into the disc of the sun.
    #[inline]
    #[must_use]
    pub fn is_sun(&self, direction: Vec3) -> bool {
        // 1 − cos without cancellation: half of the squared distance of unit vectors.
        let apart = direction - self.sun_direction;
        0.5 * apart.dot(apart) < self.sun_height
    }

    /// Where the image shows a direction: across from 0 up to 1, and from the zenith at 0 to the
    /// nadir at 1. Near both, the cosine of the angle from the axis would lose its digits.
    #[inline]
    fn place_of(&self, direction: Vec3) -> Vec2 {
        let level = (direction.x * direction.x + direction.z * direction.z).sqrt();
        let mut around = 0.5 - self.environment_turn;
        if level > 0.0 {
            let turned = arctangent(direction.x.abs(), -direction.z) / TAU;
            around += if direction.x < 0.0 { -turned } else { turned };
        }
        around -= around as i32 as f32;
        if around < 0.0 {
            around += 1.0;
        }
        Vec2::new(around, arctangent(level, direction.y) / PI)
    }

    fn texel_at(&self, direction: Vec3) -> UVec2 {
        let (size, place) = (self.environment_size, self.place_of(direction));
        UVec2::new(
            ((place.x * size.x as f32) as u32).min(size.x.max(1) - 1),
            ((place.y * size.y as f32) as u32).min(size.y.max(1) - 1),
        )
    }

    /// The radiance that the image shows in a direction: linear between the middles of texels,
    /// around without an end, and constant above the first row's middle and below the last's.
    fn interpolated(&self, direction: Vec3, texels: &[f32]) -> Vec3 {
        let (size, place) = (self.environment_size, self.place_of(direction));
        let (width, height) = (size.x.max(1), size.y.max(1));
        // The middle of the texel before is at this whole number, or left of the first.
        let x = (place.x * width as f32 + 0.5).max(0.5);
        let y = (place.y * height as f32 - 0.5).clamp(0.0, (height - 1) as f32);
        let (left, above) = ((x as u32).min(width), (y as u32).min(height - 1));
        let (across, down) = (x - left as f32, y - above as f32);
        let before = if left == 0 { width - 1 } else { left - 1 };
        let after = if left < width { left } else { 0 };
        let below = (above + 1).min(height - 1);
        let texel = |x: u32, y: u32| self.texel(UVec2::new(x, y), texels);
        let upper = texel(before, above) * (1.0 - across) + texel(after, above) * across;
        let lower = texel(before, below) * (1.0 - across) + texel(after, below) * across;
        upper * (1.0 - down) + lower * down
    }

    #[inline]
    fn row_table(&self) -> usize {
        ALBEDO_LEN
    }

    #[inline]
    fn column_table(&self) -> usize {
        ALBEDO_LEN + self.environment_size.y as usize
    }

    /// The index of a row's first column. Here and below, impossible sizes wrap, and nothing beyond
    /// the tables is read.
    #[inline]
    fn columns_of(&self, row: u32) -> usize {
        let before = (row as usize).wrapping_mul(self.environment_size.x as usize);
        self.column_table().wrapping_add(before)
    }

    #[inline]
    fn texel(&self, texel: UVec2, texels: &[f32]) -> Vec3 {
        let row = (texel.y as usize).wrapping_mul(self.environment_size.x as usize);
        let at = row.wrapping_add(texel.x as usize).wrapping_mul(3);
        if texels.len() > 2 && at < texels.len() - 2 {
            Vec3::new(texels[at], texels[at + 1], texels[at + 2])
        } else {
            Vec3::ZERO
        }
    }

    /// The density with which [`Sky::sample_environment`] chooses a direction in the texel.
    #[inline]
    fn density_in(&self, texel: UVec2, tables: &[f32]) -> f32 {
        let size = self.environment_size;
        let row = share(tables, self.row_table(), texel.y);
        let column = share(tables, self.columns_of(texel.y), texel.x);
        // The solid angle of the texel, without the difference of two cosines. Rows below the
        // middle are as those above, where the sine keeps its digits.
        let half = 0.25 / size.y as f32;
        let from_end = texel.y.min(size.y.wrapping_sub(1).wrapping_sub(texel.y));
        let middle = half * (2.0 * from_end as f32 + 1.0);
        let solid = 2.0 * turn(middle).y * turn(half).y * TAU / size.x as f32;
        row * column / solid
    }

    /// The density with which [`Sky::sample_environment`] chooses `direction`.
    #[inline]
    #[must_use]
    pub fn environment_density(&self, direction: Vec3, tables: &[f32]) -> f32 {
        self.density_in(self.texel_at(direction), tables)
    }

    /// A direction, the brighter the likelier, with its density and its radiance.
    #[inline]
    #[must_use]
    pub fn sample_environment(&self, u: Vec2, tables: &[f32], texels: &[f32]) -> (Vec3, f32, Vec3) {
        let size = self.environment_size;
        let (row, v) = find(tables, self.row_table(), size.y, u.y);
        let (column, h) = find(tables, self.columns_of(row), size.x, u.x);
        let texel = UVec2::new(column, row);
        // Uniform in the solid angle of the texel: the squares of sine and cosine of half the angle
        // from the zenith keep their digits near both ends.
        let half = 0.25 / size.y as f32;
        let (above, below) = (turn(half * row as f32), turn(half * (row as f32 + 1.0)));
        let squares = (above * above).lerp(below * below, v);
        let (cosine, sine) = (squares.x, squares.y);
        let (y, r) = (cosine - sine, 2.0 * (sine * cosine).max(0.0).sqrt());
        let around = turn((column as f32 + h) / size.x as f32 - 0.5 + self.environment_turn);
        let direction = Vec3::new(r * around.y, y, -r * around.x);
        (
            direction,
            self.density_in(texel, tables),
            self.interpolated(direction, texels),
        )
    }
}

/// The probability of entry `index` of a table of cumulative probabilities.
#[inline]
fn share(tables: &[f32], first: usize, index: u32) -> f32 {
    let at = first.wrapping_add(index as usize);
    if at >= tables.len() {
        return 0.0;
    }
    let below = if (index > 0) & (at > 0) {
        tables[at - 1]
    } else {
        0.0
    };
    tables[at] - below
}

/// The first of `count` entries whose cumulative probability exceeds `u`, and where in it `u` is.
#[inline]
fn find(tables: &[f32], first: usize, count: u32, u: f32) -> (u32, f32) {
    let len = tables.len();
    if (count == 0) | (first > len) || (count as usize > len - first) {
        return (0, 0.0);
    }
    let mut search = Bisection::below(count as usize - 1);
    while search.is_open() {
        search.narrow(u < read(tables, first + search.middle()));
    }
    let found = search.low;
    let below = if found > 0 {
        tables[first + found - 1]
    } else {
        0.0
    };
    let width = tables[first + found] - below;
    let within = if width > 0.0 {
        (u - below) / width
    } else {
        0.5
    };
    (found as u32, within.clamp(0.0, 1.0))
}

const _: () = assert!(size_of::<Sky>() == 80);

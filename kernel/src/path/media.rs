//! [`Media`]: the glass that a path is in. Runs on the GPU and on the CPU.
//!
//! Glass spheres may lie in each other and overlap. Of those that hold a point, the smallest is the
//! medium there, and of equally large ones the one of lower index. So the surface of a sphere is a
//! boundary only where no smaller one covers it (C. M. Schmidt and B. Budge, Simple nested
//! dielectrics in ray traced images, J. Graphics Tools 7 (2002), with the radius as the priority).
//!
//! Where glass is nested, the refractive index in a sphere's material is that of its medium, not
//! relative to what surrounds it: the host makes it so.

use glam::{UVec4, Vec3};

use super::scenery::Scenery;
use crate::accel::traversal::Traversal;
use crate::hit::Hit;
use crate::material::{Material, material_of};

/// The glass spheres that hold a point, the smallest first; [`Hit::NONE_SPHERE`] after the last.
#[derive(Clone, Copy, Debug)]
pub(super) struct Media(pub(super) UVec4);

/// What light travels through.
#[derive(Clone, Copy, Debug)]
pub(super) struct Medium {
    /// The refractive index.
    pub(super) index: f32,
    /// The absorption per scene unit.
    pub(super) absorption: Vec3,
}

impl Media {
    /// Outside of all glass.
    pub(super) const NONE: Self = Self(UVec4::splat(Hit::NONE_SPHERE));

    /// Whether this is outside of all glass.
    #[inline]
    pub(super) fn is_none(self) -> bool {
        self.0.x == Hit::NONE_SPHERE
    }

    /// With a sphere that was entered. Of more than four, the largest is forgotten.
    #[inline]
    pub(super) fn with<T: Traversal>(
        self,
        scenery: &Scenery<'_, T>,
        sphere: u32,
        time: f32,
    ) -> Self {
        let all = self.0;
        if (all.x == sphere) | (all.y == sphere) | (all.z == sphere) | (all.w == sphere) {
            return self;
        }
        let (x, next) = in_order(scenery, all.x, sphere, time);
        let (y, next) = in_order(scenery, all.y, next, time);
        let (z, next) = in_order(scenery, all.z, next, time);
        let (w, _) = in_order(scenery, all.w, next, time);
        Self(UVec4::new(x, y, z, w))
    }

    /// Without a sphere that was left.
    #[inline]
    pub(super) fn without(self, sphere: u32) -> Self {
        let all = self.0;
        let is_x = all.x == sphere;
        let is_y = is_x | (all.y == sphere);
        let is_z = is_y | (all.z == sphere);
        let is_w = is_z | (all.w == sphere);
        let choose = |is_after: bool, next: u32, here: u32| if is_after { next } else { here };
        Self(UVec4::new(
            choose(is_x, all.y, all.x),
            choose(is_y, all.z, all.y),
            choose(is_z, all.w, all.z),
            choose(is_w, Hit::NONE_SPHERE, all.w),
        ))
    }

    /// The medium in these spheres.
    #[inline]
    pub(super) fn medium<T: Traversal>(self, scenery: &Scenery<'_, T>) -> Medium {
        let mut medium = Medium {
            index: 1.0,
            absorption: Vec3::ZERO,
        };
        if !self.is_none() {
            let sphere = self.0.x as usize;
            let material = material_of(sphere, scenery.material_ids, scenery.materials);
            medium.index = material.parameter;
            // A hollow holds no glass.
            if material.kind == Material::GLASS {
                medium.absorption = material.volume;
            }
        }
        medium
    }
}

/// The smaller of two spheres, and the other.
#[inline]
fn in_order<T: Traversal>(scenery: &Scenery<'_, T>, a: u32, b: u32, time: f32) -> (u32, u32) {
    let size = |index: u32| scenery.size(index, time);
    let is_first = (b == Hit::NONE_SPHERE)
        || (a != Hit::NONE_SPHERE) && ((size(a) < size(b)) | ((size(a) == size(b)) & (a < b)));
    if is_first { (a, b) } else { (b, a) }
}

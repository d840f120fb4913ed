//! From a pixel to its colour, with one ray a pixel. Runs on the GPU and on the CPU.
//!
//! A thread of a GPU, a workgroup or a packet on the CPU finds the hit. All of them take the ray
//! from [`Launch::ray`] and the pixel from [`Launch::pixel`].

use glam::UVec2;

use crate::accel::brute::{nearest_hit_by_bounds, nearest_hit_in};
use crate::accel::node::Tree;
use crate::accel::walk::nearest_hit_in_tree;
use crate::arithmetic::elements::read;
use crate::film::{Launch, Pixel};
use crate::hit::Hit;
use crate::material::{Material, material_of};
use crate::precision::{DEFERRING, Rung, is_lazy};
use crate::ray::Ray;
use crate::shading::{Seen, shade};
use crate::shape::Shapes;
use crate::shape::among::Resting;
use crate::sphere::Sphere;
use crate::surface::Surface;

/// Renders one pixel of a launch: `pixel` counts from the upper left of the tile, `previous` is
/// what the pixel holds so far, `shading` and `rung` are values of
/// [`Shading::to_u32`](crate::Shading::to_u32) and
/// [`Rung::to_u32`](crate::precision::Rung::to_u32), or [`DEFERRING`]. Returns the pixel.
///
/// With `has_tree` 1 the spheres are those of `tree`, whatever run of them the launch names.
/// `spheres` and `material_ids` run in parallel; an index beyond `materials`
/// selects its last entry.
#[expect(
    clippy::too_many_arguments,
    reason = "these are the kernel's bindings, one each"
)]
#[inline]
#[must_use]
pub fn render_pixel(
    shading: u32,
    rung: u32,
    has_tree: u32,
    launch: &Launch,
    tree: Tree<'_>,
    spheres: &[Sphere],
    material_ids: &[u32],
    materials: &[Material],
    pixel: UVec2,
    previous: &Pixel,
) -> Pixel {
    let ray = launch.ray(pixel, previous);
    let hit = if has_tree == 1 {
        nearest_hit_in_tree(rung, &ray, tree, spheres)
    } else if is_lazy(rung) & (rung != Rung::Certified.to_u32()) {
        // The whole of certified is for the few rays that are deferred: one copy of its code,
        // below, is worth more than to evaluate it once a ray.
        nearest_hit_by_bounds(
            rung,
            &ray,
            spheres,
            launch.first_sphere,
            launch.sphere_count,
        )
    } else {
        let (first, count) = (launch.first_sphere, launch.sphere_count);
        nearest_hit_in(rung, &ray, spheres, first, count)
    };
    if (rung == DEFERRING) & hit.is_deferred() {
        return launch.unless_hit(previous).deferred();
    }
    launch.pixel(
        shading,
        &ray,
        hit,
        spheres,
        material_ids,
        materials,
        launch.unless_hit(previous),
    )
}

/// What a pixel must hold where its ray has found this hit on this surface.
#[inline]
fn show(
    shading: u32,
    ray: &Ray,
    hit: Hit,
    surface: Surface,
    material_ids: &[u32],
    materials: &[Material],
) -> Pixel {
    let index = hit.sphere as usize;
    let seen = Seen {
        ray: *ray,
        hit,
        surface,
        material: material_of(index, material_ids, materials),
        tag: read(material_ids, index),
    };
    Pixel::new(shade(shading, seen), hit.t)
}

/// Renders one pixel of a launch among shapes beside spheres, after [`render_pixel`]: a shape
/// counts up to the depth of `previous`. `material_ids` are those of the shapes.
#[expect(
    clippy::too_many_arguments,
    reason = "these are the kernel's bindings, one each"
)]
#[inline]
#[must_use]
pub fn render_pixel_of_shapes(
    shading: u32,
    rung: u32,
    launch: &Launch,
    shapes: &Shapes<'_>,
    material_ids: &[u32],
    materials: &[Material],
    pixel: UVec2,
    previous: &Pixel,
) -> Pixel {
    let later = Launch {
        first_of_tile: 0,
        ..*launch
    };
    let ray = later.ray(pixel, previous);
    let none = Hit::NONE_SPHERE;
    let hit = shapes.nearest_hit(rung, &ray, Hit::NONE, none, Resting);
    if hit.is_some() {
        let surface = shapes.surface(&ray, hit.t, hit.sphere, Resting);
        show(shading, &ray, hit, surface, material_ids, materials)
    } else {
        *previous
    }
}

impl Launch {
    /// The ray through a pixel, which counts from the upper left of the tile. It ends at the depth
    /// of
    /// `previous`, which the first launch of a tile does not read.
    #[inline]
    #[must_use]
    pub fn ray(&self, pixel: UVec2, previous: &Pixel) -> Ray {
        let at = self.tile_origin.wrapping_add(pixel);
        let mut ray = self.camera.pixel_ray(at, self.image_size);
        if self.first_of_tile == 0 {
            ray.t_max = previous.depth();
        }
        ray
    }

    /// The pixel for a ray that hits nothing: `previous`, or in the first launch of a tile, which
    /// does not read that, a blank one.
    #[inline]
    #[must_use]
    pub fn unless_hit(&self, previous: &Pixel) -> Pixel {
        if self.first_of_tile == 0 {
            Pixel::new(previous.color(), previous.depth())
        } else {
            self.blank()
        }
    }

    /// A pixel without a sphere.
    #[inline]
    #[must_use]
    pub fn blank(&self) -> Pixel {
        Pixel::new(self.background, Hit::NONE_T)
    }

    /// What a pixel must hold after its ray has found `hit`, and `otherwise` if it found none. In
    /// [`Shading::Id`](crate::Shading::Id)
    /// `material_ids` are those of the spheres themselves.
    #[expect(
        clippy::too_many_arguments,
        reason = "these are the kernel's bindings, one each"
    )]
    #[inline]
    #[must_use]
    pub fn pixel(
        &self,
        shading: u32,
        ray: &Ray,
        hit: Hit,
        spheres: &[Sphere],
        material_ids: &[u32],
        materials: &[Material],
        otherwise: Pixel,
    ) -> Pixel {
        let mut result = otherwise;
        if hit.is_some() {
            let surface = Surface::at(ray, hit.t, read(spheres, hit.sphere as usize));
            result = show(shading, ray, hit, surface, material_ids, materials);
        }
        result
    }
}

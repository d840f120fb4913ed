//! [`Launch`] and [`Pixel`]: what one launch of the `render` kernel is told, and what it
//! writes. Runs on the GPU and on the CPU.

use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec3, Vec4};
use spirv_std::arch::IndexUnchecked;

use crate::camera::Camera;
use crate::hit::Hit;
use crate::material::Material;
use crate::nearest::nearest_hit_in;
use crate::shading::shade;
use crate::sphere::Sphere;
use crate::surface::Surface;

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

/// Renders one pixel of a launch: `pixel` counts from the upper left of the tile, `previous` is
/// what the pixel holds so far, `shading` and `rung` are values of
/// [`Shading::to_u32`](crate::Shading::to_u32) and
/// [`Rung::to_u32`](crate::precision::Rung::to_u32). Returns what the pixel must hold now.
///
/// `spheres` and `material_ids` run in parallel; an index into `materials` that leaves the
/// table takes its last entry.
#[expect(
    clippy::too_many_arguments,
    reason = "these are the kernel's bindings, one each"
)]
#[inline]
#[must_use]
pub fn render_pixel(
    shading: u32,
    rung: u32,
    launch: &Launch,
    spheres: &[Sphere],
    material_ids: &[u32],
    materials: &[Material],
    pixel: UVec2,
    previous: Pixel,
) -> Pixel {
    let mut ray = launch
        .camera
        .pixel_ray(launch.tile_origin + pixel, launch.image_size);
    let mut result = Pixel::new(launch.background, Hit::NONE_T);
    if launch.first_of_tile == 0 {
        result = previous;
        ray.t_max = previous.depth();
    }
    let hit = nearest_hit_in(
        rung,
        &ray,
        spheres,
        launch.first_sphere,
        launch.sphere_count,
    );
    if hit.is_some() {
        let index = hit.sphere as usize;
        // SAFETY: a hit names a sphere of the slice.
        let sphere = unsafe { *spheres.index_unchecked(index) };
        let material = material_of(index, material_ids, materials);
        let surface = Surface::at(&ray, hit.t, sphere);
        result = Pixel::new(shade(shading, &ray, hit.t, &surface, &material), hit.t);
    }
    result
}

#[inline]
fn material_of(sphere: usize, material_ids: &[u32], materials: &[Material]) -> Material {
    if sphere < material_ids.len() && !materials.is_empty() {
        let id = material_ids[sphere].min(materials.len() as u32 - 1);
        materials[id as usize]
    } else {
        Material::diffuse(Vec3::ONE)
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
};

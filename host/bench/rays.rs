//! The rays of a scene, kind by kind, as a renderer would trace them.

use glam::{UVec2, Vec3};
use rayon::prelude::*;
use serde::Serialize;
use spherule_kernel::{Hit, Pixel, Ray, Rung, Sphere, Surface};

use crate::error::Result;
use crate::memory;
use crate::random::Random;
use crate::render::whole_image;
use crate::scene::Scene;
use crate::trace::CpuTracer;

/// The purpose of rays, which decides whether any hit will do and how similar neighbours are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// From the eye through the middle of each pixel: the nearest hit.
    Primary,
    /// From each hit to one light: whether there is any hit.
    Shadow,
    /// From each hit, four rays within a short reach, with a cosine distribution: whether there is
    /// any hit.
    Ambient,
    /// From each hit in a direction of diffuse scattering, in random order: the nearest hit.
    Incoherent,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Self; 4] = [Self::Primary, Self::Shadow, Self::Ambient, Self::Incoherent];

    /// The kind's name in tables and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Ambient => "ambient",
            Self::Incoherent => "incoherent",
        }
    }

    /// Whether any hit will do.
    #[must_use]
    pub const fn is_any(self) -> bool {
        matches!(self, Self::Shadow | Self::Ambient)
    }
}

/// Side, in pixels, of the squares in which rays are ordered.
const TILE: u32 = 8;
/// Ambient rays for each hit.
const AMBIENT: usize = 4;

/// The most bytes that the rays of a pixel and their hits take, before and during the timing.
const BYTES_PER_PIXEL: u64 = ((3 + AMBIENT) * size_of::<Ray>()
    + 2 * size_of::<Hit>()
    + size_of::<Surface>()
    + AMBIENT * size_of::<u32>()
    + size_of::<Pixel>()) as u64;

/// The rays of a scene.
#[derive(Clone, Debug)]
pub struct RaySets {
    /// Camera rays, row by row.
    pub primary: Vec<Ray>,
    /// One ray for each hit, square by square of the image.
    pub shadow: Vec<Ray>,
    /// Four rays for each hit, square by square of the image.
    pub ambient: Vec<Ray>,
    /// One ray for each hit, shuffled.
    pub incoherent: Vec<Ray>,
}

impl RaySets {
    /// Fails if the rays of an image would not fit into memory, with a hit in each pixel.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfHostMemory`](crate::Error::OutOfHostMemory) if they do not fit.
    pub fn check_room(width: u32, height: u32) -> Result<()> {
        let pixels = u64::from(width) * u64::from(height);
        memory::require(
            pixels.saturating_mul(BYTES_PER_PIXEL),
            &format!("making the rays of {width} × {height} pixels"),
        )
    }

    /// Makes the rays from the hits of the camera rays. `reach` is the length of ambient rays in
    /// scene units.
    ///
    /// # Errors
    ///
    /// As [`Self::check_room`] and [`whole_image`].
    pub fn of(scene: &Scene, tracer: &CpuTracer, reach: f32) -> Result<Self> {
        let launch = whole_image(scene)?;
        let size = launch.image_size;
        Self::check_room(size.x, size.y)?;
        let primary: Vec<Ray> = (0..size.y)
            .into_par_iter()
            .flat_map_iter(|y| (0..size.x).map(move |x| UVec2::new(x, y)))
            .map(|pixel| launch.camera.pixel_ray(pixel, size))
            .collect();
        let mut hits = Vec::new();
        tracer.nearest(Rung::Robust, &primary, &mut hits);
        let surfaces: Vec<Surface> = squares(size)
            .map(|index| (&primary[index], hits[index]))
            .filter(|(_, hit)| hit.is_some())
            .filter_map(|(ray, hit): (&Ray, Hit)| {
                // The tracer may be that of another world.
                let sphere: Sphere = *scene.world.spheres.get(hit.sphere as usize)?;
                let mut surface = Surface::at(ray, hit.t, sphere);
                if surface.normal.dot(ray.direction) > 0.0 {
                    surface.normal = -surface.normal;
                }
                Some(surface)
            })
            .collect();
        // Above and to the left of what is seen, on the eye's side.
        let view = scene.view_or_framed();
        let light = view.eye + (view.eye.distance(view.target)) * Vec3::new(-0.5, 0.8, 0.0);
        let shadow = surfaces.par_iter().map(|surface| {
            let to_light = light - surface.point;
            let ray = surface.leave(to_light);
            Ray { t_max: 1.0, ..ray }
        });
        let around = |index: usize, salt: u64, surface: &Surface| {
            let mut random = Random::new(salt + index as u64);
            (surface.normal + random.unit_vec3()).normalize_or(surface.normal)
        };
        let indexed = || surfaces.par_iter().enumerate();
        let ambient = indexed().flat_map_iter(|(index, surface)| {
            (0..AMBIENT).map(move |sample| {
                let direction = around(AMBIENT * index + sample, 1 << 40, surface);
                let ray = surface.leave(direction);
                Ray {
                    t_max: reach,
                    ..ray
                }
            })
        });
        let mut incoherent: Vec<Ray> = indexed()
            .map(|(index, surface)| surface.leave(around(index, 1 << 41, surface)))
            .collect();
        let mut random = Random::new(3);
        for last in (1..incoherent.len()).rev() {
            let other = (u64::from(random.next_u32()) * (last as u64 + 1)) >> 32;
            incoherent.swap(last, other as usize);
        }
        Ok(Self {
            shadow: shadow.collect(),
            ambient: ambient.collect(),
            incoherent,
            primary,
        })
    }

    /// The rays of one kind.
    #[must_use]
    pub fn kind(&self, kind: Kind) -> &[Ray] {
        match kind {
            Kind::Primary => &self.primary,
            Kind::Shadow => &self.shadow,
            Kind::Ambient => &self.ambient,
            Kind::Incoherent => &self.incoherent,
        }
    }
}

/// The indices of pixels, square by square, row by row in each square.
fn squares(size: UVec2) -> impl Iterator<Item = usize> {
    let rows = (0..size.y).step_by(TILE as usize);
    rows.flat_map(move |y| {
        (0..size.x).step_by(TILE as usize).flat_map(move |x| {
            (y..(y + TILE).min(size.y)).flat_map(move |row| {
                (x..(x + TILE).min(size.x))
                    .map(move |column| row as usize * size.x as usize + column as usize)
            })
        })
    })
}

//! The CPU path: squares of camera rays, over bands of rows, and the kernel's functions for what
//! they hit.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use std::borrow::Cow;

use glam::UVec2;
use rayon::prelude::*;
use spherule_kernel::pixel::render_pixel_of_shapes;
use spherule_kernel::precision::OnRung;
use spherule_kernel::shading::OnShading;
use spherule_kernel::shape::Shapes;
use spherule_kernel::{Launch, Material, Pixel};

use super::launch::{check_launch, check_pixels};
use super::packet::{self, Frusta, Packet, SIDE};
use super::{Progress, Settings};
use crate::accel::{self, Acceleration, Nodes, ShapeTree};
use crate::cpu::InstructionSet;
use crate::error::Result;
use crate::film;
use crate::scene::World;

/// From how many spheres on a tree pays for squares of camera rays: 8 with AVX-512.
const MIN_SPHERES: usize = 12;

/// After so many squares at most it is asked whether the render goes on; after fewer where they
/// take longer than this.
const SQUARES: usize = 16;
const PATIENCE: Duration = Duration::from_millis(5);

/// A world, and the tree over it if one pays.
#[derive(Clone, Debug)]
pub struct Prepared<'a> {
    world: Cow<'a, World>,
    nodes: Nodes,
    shapes: ShapeTree,
}

impl<'a> Prepared<'a> {
    /// Grows the tree.
    #[must_use]
    pub fn new(world: &'a World, acceleration: Acceleration) -> Self {
        let shapes = ShapeTree::of(world, (0.0, 0.0));
        match accel::build_still(&world.spheres, acceleration.min_spheres(MIN_SPHERES)) {
            Some(tree) => Self {
                world: Cow::Owned(tree.sort_world(world)),
                nodes: tree.nodes,
                shapes,
            },
            None => Self {
                world: Cow::Borrowed(world),
                nodes: Nodes::default(),
                shapes,
            },
        }
    }
}

/// Renders `launch`, which covers a whole image, on every thread of the pool. Where `progress`
/// breaks off, the pixels that were not reached are [not written](Pixel::is_written).
///
/// # Errors
///
/// [`OutOfHostMemory`](crate::Error::OutOfHostMemory) if the host has no room for the image, and as
/// [`render_to`].
pub fn render(
    launch: &Launch,
    world: &Prepared<'_>,
    settings: Settings,
    progress: Progress<'_>,
) -> Result<Vec<Pixel>> {
    let size = launch.tile_size;
    let mut pixels = film::allocate(size.x, size.y)?;
    render_to(&mut pixels, launch, world, settings, progress)?;
    Ok(pixels)
}

/// [`render`] to where an image was before: `pixels`, row by row, of which there are as many as the
/// launch has. Where `progress` breaks off, pixels that were not reached stay as they are.
///
/// # Errors
///
/// [`Error::Scene`](crate::Error::Scene) if the launch covers no part of an image, or has not as
/// many pixels.
pub fn render_to(
    pixels: &mut [Pixel],
    launch: &Launch,
    world: &Prepared<'_>,
    settings: Settings,
    progress: Progress<'_>,
) -> Result<()> {
    check_launch(launch)?;
    check_pixels(launch, pixels.len())?;
    settings.rung.with(Render {
        launch,
        world,
        shading: settings.shading.to_u32(),
        shade: settings.shading.with(Shade),
        progress,
        pixels,
    });
    Ok(())
}

/// Writes what a square has hit to the rows of an image.
type ShadeSquare = fn(&mut [Pixel], (usize, usize), &Packet, &Launch, &World);

/// [`shade`], compiled for each shading mode, as the GPU's pipeline is.
struct Shade;

impl OnShading for Shade {
    type Output = ShadeSquare;

    fn run<const SHADING: u32>(self) -> ShadeSquare {
        shade::<SHADING>
    }
}

/// [`bands`], compiled for each rung, as the GPU's pipeline is.
struct Render<'a> {
    launch: &'a Launch,
    world: &'a Prepared<'a>,
    shading: u32,
    shade: ShadeSquare,
    progress: Progress<'a>,
    pixels: &'a mut [Pixel],
}

impl OnRung for Render<'_> {
    type Output = ();

    fn run<const RUNG: u32>(self) {
        bands::<RUNG>(self);
    }
}

/// Renders bands of rows, square by square.
fn bands<const RUNG: u32>(render: Render<'_>) {
    let Render {
        launch,
        world,
        shading,
        shade,
        progress,
        pixels,
    } = render;
    let width = launch.tile_size.x as usize;
    let all = pixels.len();
    let Prepared {
        world,
        nodes,
        shapes,
    } = world;
    let of_shapes = OfShapes {
        shading,
        rung: RUNG,
        launch,
        shapes: shapes.shapes(0),
        material_ids: &shapes.material_ids,
        materials: &world.materials,
    };
    let done = AtomicUsize::new(0);
    let goes_on = |more: usize| {
        let done = done.fetch_add(more, Ordering::Relaxed) + more;
        progress(done as f64 / all as f64).is_continue()
    };
    let frusta = Frusta::of(launch);
    pixels
        .par_chunks_mut(width * SIDE)
        .enumerate()
        .for_each(|(band, pixels)| {
            let mut packet = Packet::new(InstructionSet::chosen());
            let rows = pixels.len() / width;
            // One that takes long may be the first.
            let (mut asked_at, mut next, mut squares) = (Instant::now(), 0, 1);
            let mut since = 0;
            for left in (0..width).step_by(SIDE) {
                if left >= next {
                    if !goes_on((left - since) * rows) {
                        return;
                    }
                    let now = Instant::now();
                    squares = if now - asked_at > PATIENCE {
                        1
                    } else {
                        (2 * squares).min(SQUARES)
                    };
                    (asked_at, since, next) = (now, left, left + squares * SIDE);
                }
                let corner = UVec2::new(left as u32, (band * SIDE) as u32);
                packet::trace::<RUNG>(
                    &mut packet,
                    launch,
                    &frusta,
                    corner,
                    nodes.tree(),
                    &world.spheres,
                );
                shade(pixels, (width, left), &packet, launch, world);
                if !shapes.kinds.is_empty() {
                    of_shapes.render(pixels, width, corner);
                }
            }
            goes_on((width - since) * rows);
        });
}

/// Writes what a square has hit to the rows of an image, `width` pixels wide, from its pixel `left`
/// on. A function of its own, because what is asked between squares takes registers.
#[inline(never)]
fn shade<const SHADING: u32>(
    pixels: &mut [Pixel],
    (width, left): (usize, usize),
    packet: &Packet,
    launch: &Launch,
    world: &World,
) {
    for (y, row) in pixels.chunks_mut(width).enumerate() {
        for (x, pixel) in row[left..].iter_mut().take(SIDE).enumerate() {
            let (ray, hit) = packet.hit(SIDE * y + x);
            *pixel = launch.pixel(
                SHADING,
                &ray,
                hit,
                &world.spheres,
                &world.material_ids,
                &world.materials,
                launch.unless_hit(pixel),
            );
        }
    }
}

/// What renders the shapes beside the spheres.
struct OfShapes<'a> {
    shading: u32,
    rung: u32,
    launch: &'a Launch,
    shapes: Shapes<'a>,
    material_ids: &'a [u32],
    materials: &'a [Material],
}

impl OfShapes<'_> {
    /// Renders them into a square of pixels at `corner`, over the spheres there. `pixels` are rows
    /// of an image, `width` pixels wide, of which the first is that of the corner.
    #[inline(never)]
    fn render(&self, pixels: &mut [Pixel], width: usize, corner: UVec2) {
        let left = corner.x as usize;
        for (y, row) in pixels.chunks_mut(width).enumerate() {
            for (x, pixel) in row[left..].iter_mut().take(SIDE).enumerate() {
                *pixel = render_pixel_of_shapes(
                    self.shading,
                    self.rung,
                    self.launch,
                    &self.shapes,
                    self.material_ids,
                    self.materials,
                    corner + UVec2::new(x as u32, y as u32),
                    pixel,
                );
            }
        }
    }
}

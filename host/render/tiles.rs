//! [`Tiles`]: how an image is cut into the pieces that one launch writes and one readback moves,
//! within a device's limits.

use glam::UVec2;

use super::pace::Pace;
use crate::device::Gpu;

/// Pixels of one tile at most: what one readback moves.
const MAX_PIXELS: u64 = 1 << 23;
/// Threads of a workgroup along a side, at least, in the kernels that write images.
const WORKGROUP_SIDE: u64 = 8;

/// The limits on the tiles of one image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tiles {
    size: UVec2,
    threads: u64,
    max_pixels: u64,
}

impl Tiles {
    /// The limits of `gpu` for an image of `size` pixels, each a `T` in the buffer that is written.
    pub(super) fn new<T>(gpu: &Gpu, size: UVec2) -> Self {
        Self {
            size,
            threads: Self::threads(gpu),
            max_pixels: Self::most::<T>(gpu)
                .min(u64::from(size.x) * u64::from(size.y))
                .max(1),
        }
    }

    /// The most pixels, each a `T`, that a buffer of `gpu` holds and one readback moves.
    pub(super) fn most<T>(gpu: &Gpu) -> u64 {
        let limits = gpu.limits();
        let binding = limits
            .max_storage_buffer_binding_size
            .min(limits.max_buffer_size);
        (binding / size_of::<T>() as u64).min(MAX_PIXELS)
    }

    /// The most rows of a launch on `gpu`.
    pub(super) fn most_rows(gpu: &Gpu) -> u32 {
        Self::threads(gpu).min(u32::MAX.into()) as u32
    }

    /// The most threads along a side of a launch on `gpu`. A device that has none refuses it.
    fn threads(gpu: &Gpu) -> u64 {
        let groups = gpu.limits().max_compute_workgroups_per_dimension.max(1);
        u64::from(groups) * WORKGROUP_SIDE
    }

    /// The pixels that the buffer must hold.
    pub(super) fn max_pixels(&self) -> usize {
        self.max_pixels as usize
    }

    /// The size of the tile at `origin`, at this pace, where each pixel takes `work` intersections:
    /// whole rows, or a part of one, so that it is one piece of the image.
    pub(super) fn at(&self, origin: UVec2, pace: &Pace, work: u64) -> UVec2 {
        let tile = pace.tile(self.size.x, self.size - origin, self.max_pixels, work);
        let within = |side: u32| u64::from(side).min(self.threads) as u32;
        let width = within(tile.x);
        let height = if width == self.size.x {
            within(tile.y)
        } else {
            1
        };
        UVec2::new(width, height)
    }

    /// Where in the image, row by row, the tile at `origin` begins.
    pub(super) fn start(&self, origin: UVec2) -> usize {
        origin.y as usize * self.size.x as usize + origin.x as usize
    }

    /// The origin of the tile after this one; below the image after the last.
    pub(super) fn next(&self, origin: UVec2, tile: UVec2) -> UVec2 {
        let right = origin.x + tile.x;
        if right == self.size.x {
            UVec2::new(0, origin.y + tile.y)
        } else {
            UVec2::new(right, origin.y)
        }
    }
}

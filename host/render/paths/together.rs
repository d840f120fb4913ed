//! The light paths of some pixels, one of each at a time, in step: the rays of all are traced
//! together, then the kernel's functions take each path on.
//!
//! Rays side by side are traced faster than one by one. Each path takes the same decisions as in
//! [`trace_pixel`](spherule_kernel::path::trace_pixel), and a pixel's samples are added in the same
//! order, so that the image is the same, bit for bit.

use std::cell::Cell;

use glam::UVec2;
use spherule_kernel::accel::traversal::Traversal;
use spherule_kernel::path::random::Sampler;
use spherule_kernel::path::{Path, Samples, Scenery, Shadow, shade, start};
use spherule_kernel::{Accumulator, Effects, Hit, Ray};

use crate::trace::single::Single;

/// A path under way.
struct UnderWay {
    /// The index of its pixel among those that are traced.
    slot: usize,
    /// Its pixel of the image.
    pixel: UVec2,
    sample: u32,
    /// The sample after the pixel's last.
    end: u32,
    sampler: Sampler,
    path: Path,
    goes_on: bool,
}

impl UnderWay {
    /// Starts the path of a sample.
    #[inline(always)]
    fn of(scenery: &Scenery<'_, Single<'_>>, slot: usize, samples: Samples) -> Self {
        let sampler = Sampler::of(scenery.launch, samples.pixel, samples.first);
        Self {
            slot,
            pixel: samples.pixel,
            sample: samples.first,
            end: samples.end,
            sampler,
            path: start(scenery, samples.pixel, &sampler),
            goes_on: true,
        }
    }
}

/// Adds the samples of a launch to pixels of a tile that is so wide, from the one with index
/// `first` on.
#[inline(always)]
pub(super) fn trace_pixels(
    scenery: &Scenery<'_, Single<'_>>,
    width: usize,
    first: usize,
    pixels: &mut [Accumulator],
) {
    let mut paths: Vec<UnderWay> = Vec::with_capacity(pixels.len());
    for (slot, sums) in pixels.iter().enumerate() {
        let index = first + slot;
        let at = UVec2::new((index % width) as u32, (index / width) as u32);
        let samples = Samples::of(scenery.launch, at, sums);
        if samples.first < samples.end {
            paths.push(UnderWay::of(scenery, slot, samples));
        }
    }
    let mut rays = Rays::default();
    while !paths.is_empty() {
        rays.trace_paths(scenery, &paths);
        rays.shadows.clear();
        for (index, (of, hit)) in paths.iter_mut().zip(&rays.hits).enumerate() {
            let hit = of.path.or_exit(*hit);
            // Of lamps, and ambient light.
            let found = [Cell::new(None), Cell::new(None)];
            let receive = |_: &Scenery<'_, _>, _: &mut Path, shadow: Shadow| {
                let [first, second] = &found;
                let to = if first.get().is_none() { first } else { second };
                to.set(shadow.is_some().then_some(shadow));
            };
            of.goes_on = shade(scenery, &mut of.path, &of.sampler, hit, receive);
            let found = found.into_iter().filter_map(Cell::into_inner);
            rays.shadows.extend(found.map(|shadow| (index, shadow)));
        }
        rays.trace_shadows(scenery, &mut paths);
        let mut index = 0;
        while let Some(of) = paths.get_mut(index) {
            if of.goes_on {
                index += 1;
                continue;
            }
            of.path.end(scenery, of.sample, &mut pixels[of.slot]);
            let samples = Samples {
                pixel: of.pixel,
                first: of.sample + 1,
                end: of.end,
            };
            if samples.first < samples.end {
                *of = UnderWay::of(scenery, of.slot, samples);
                index += 1;
            } else {
                paths.swap_remove(index);
            }
        }
    }
}

/// Lists that are reused from step to step.
#[derive(Default)]
struct Rays {
    rays: Vec<Ray>,
    lefts: Vec<u32>,
    hits: Vec<Hit>,
    /// Shadow rays with the index of their path, those of a path in the order in which it receives
    /// their light.
    shadows: Vec<(usize, Shadow)>,
}

impl Rays {
    /// Finds the hit of each path.
    #[inline(always)]
    fn trace_paths(&mut self, scenery: &Scenery<'_, Single<'_>>, paths: &[UnderWay]) {
        self.hits.clear();
        self.hits.resize(paths.len(), Hit::NONE);
        if are_in_motion(scenery) {
            for (hit, of) in self.hits.iter_mut().zip(paths) {
                let spheres = scenery.spheres_at(of.path.time(), of.path.left());
                *hit = scenery.traversal.nearest_hit(&of.path.ray(), &spheres);
            }
            return;
        }
        self.rays.clear();
        self.rays.extend(paths.iter().map(|of| of.path.ray()));
        self.lefts.clear();
        self.lefts.extend(paths.iter().map(|of| of.path.left()));
        let hits = &mut self.hits;
        let (rays, lefts) = (&self.rays, &self.lefts);
        let put = |index: usize, hit| hits[index] = hit;
        scenery
            .traversal
            .trace::<false>(rays, lefts, scenery.spheres, put);
    }

    /// Lets paths receive the light of shadow rays that meet nothing.
    #[inline(always)]
    fn trace_shadows(&mut self, scenery: &Scenery<'_, Single<'_>>, paths: &mut [UnderWay]) {
        let shadows = &self.shadows;
        if are_in_motion(scenery) {
            for (index, shadow) in shadows {
                let path = &mut paths[*index].path;
                let spheres = scenery.spheres_at(path.time(), shadow.left);
                if !scenery.traversal.is_occluded(&shadow.ray, &spheres) {
                    path.receive(scenery.effects, shadow.light, shadow.scatterings);
                }
            }
            return;
        }
        self.rays.clear();
        self.rays
            .extend(shadows.iter().map(|(_, shadow)| shadow.ray));
        self.lefts.clear();
        self.lefts
            .extend(shadows.iter().map(|(_, shadow)| shadow.left));
        self.hits.clear();
        self.hits.resize(shadows.len(), Hit::NONE);
        let hits = &mut self.hits;
        let (rays, lefts) = (&self.rays, &self.lefts);
        let put = |index: usize, hit| hits[index] = hit;
        scenery
            .traversal
            .trace::<true>(rays, lefts, scenery.spheres, put);
        for ((index, shadow), hit) in shadows.iter().zip(&self.hits) {
            if !hit.is_some() {
                let path = &mut paths[*index].path;
                path.receive(scenery.effects, shadow.light, shadow.scatterings);
            }
        }
    }
}

/// Whether rays meet spheres at times of their own.
#[inline(always)]
fn are_in_motion(scenery: &Scenery<'_, Single<'_>>) -> bool {
    scenery.effects.any(Effects::MOTION_BLUR) && !scenery.velocities.is_empty()
}

//! The light paths of some pixels, one of each at a time, in step: the rays of all are traced
//! together, then the kernel's functions take each path on.
//!
//! Rays side by side are traced faster than one by one. Each path takes the same decisions as in
//! [`trace_pixel`](spherule_kernel::path::trace_pixel), and a pixel's samples are added in the same
//! order, so that the image is the same, bit for bit.

use std::cell::Cell;

use glam::UVec2;
use spherule_kernel::path::random::{Sampler, VertexNumbers};
use spherule_kernel::path::{Path, Samples, Scenery, Shadow, shade, start};
use spherule_kernel::{Accumulator, Effects, Hit, Ray, Sphere};

use super::numbers::Drawn;
use crate::lanes::LANES;
use crate::trace::single::Single;

/// A path under way.
struct UnderWay {
    /// The index of its pixel among those that are traced.
    slot: usize,
    /// Its sample, and those of its pixel that are to follow.
    samples: Samples,
    sampler: Sampler,
    path: Path,
    goes_on: bool,
}

impl UnderWay {
    /// Starts the path of the first of these samples.
    #[inline(always)]
    fn of(scenery: &Scenery<'_, Single<'_>>, slot: usize, samples: Samples) -> Self {
        let sampler = Sampler::of(scenery.launch, samples.pixel, samples.first);
        Self {
            slot,
            samples,
            sampler,
            path: start(scenery, samples.pixel, &sampler),
            goes_on: true,
        }
    }

    /// The random numbers of the vertex that comes next.
    #[inline(always)]
    fn numbers(&self) -> VertexNumbers {
        self.sampler.at_vertex(self.path.bounces())
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
    let level = scenery.traversal.level();
    let mut rays = Rays::default();
    // Shadow rays with the index of their path, those of a path in the order in which it receives
    // their light.
    let mut shadows: Vec<(usize, Shadow)> = Vec::new();
    while !paths.is_empty() {
        let asked = paths.iter().map(|of| &of.path);
        let asked = asked.map(|path| (path.ray(), path.left(), path.time()));
        let hits = rays.trace::<false>(scenery, asked);
        shadows.clear();
        for (some, (paths, hits)) in paths.chunks_mut(LANES).zip(hits.chunks(LANES)).enumerate() {
            // Lanes beyond the last path repeat the first.
            let mut vertices = [paths[0].numbers(); LANES];
            for (vertex, of) in vertices.iter_mut().zip(&*paths) {
                *vertex = of.numbers();
            }
            let drawn = Drawn::of(level, &vertices);
            for (lane, (of, hit)) in paths.iter_mut().zip(hits).enumerate() {
                let hit = of.path.or_exit(*hit);
                // Of lamps, and ambient light.
                let found = [Cell::new(None), Cell::new(None)];
                let receive = |_: &Scenery<'_, _>, _: &mut Path, shadow: Shadow| {
                    let [first, second] = &found;
                    let to = if first.get().is_none() { first } else { second };
                    to.set(shadow.is_some().then_some(shadow));
                };
                of.goes_on = shade(scenery, &mut of.path, &drawn.at(lane), hit, receive);
                let found = found.into_iter().filter_map(Cell::into_inner);
                shadows.extend(found.map(|shadow| (some * LANES + lane, shadow)));
            }
        }
        rays.end_at_lamps(scenery, &paths, &mut shadows);
        let asked = shadows.iter().map(|(index, shadow)| {
            let time = paths[*index].path.time();
            (shadow.ray, shadow.left, time)
        });
        let hits = rays.trace::<true>(scenery, asked);
        for ((index, shadow), _) in shadows.iter().zip(hits).filter(|(_, hit)| !hit.is_some()) {
            let path = &mut paths[*index].path;
            path.receive(scenery.effects, shadow.light, shadow.scatterings);
        }
        let mut index = 0;
        while let Some(of) = paths.get_mut(index) {
            if of.goes_on {
                index += 1;
                continue;
            }
            of.path.end(scenery, of.samples.first, &mut pixels[of.slot]);
            of.samples.first += 1;
            if of.samples.first < of.samples.end {
                *of = UnderWay::of(scenery, of.slot, of.samples);
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
    lamps: Vec<Sphere>,
}

impl Rays {
    /// Ends shadow rays to lamps where these begin; those that do not get there go.
    #[inline(always)]
    fn end_at_lamps(
        &mut self,
        scenery: &Scenery<'_, Single<'_>>,
        paths: &[UnderWay],
        shadows: &mut Vec<(usize, Shadow)>,
    ) {
        if !scenery.effects.any(Effects::SOFT_SHADOWS) {
            return;
        }
        let Self { rays, lamps, .. } = self;
        rays.clear();
        lamps.clear();
        let waiting = |shadow: &Shadow| shadow.lamp != Hit::NONE_SPHERE;
        for (index, shadow) in shadows.iter().filter(|(_, shadow)| waiting(shadow)) {
            rays.push(shadow.whole_ray());
            lamps.push(scenery.sphere(shadow.lamp as usize, paths[*index].path.time()));
        }
        let mut of_lamps = shadows.iter_mut().filter(|(_, shadow)| waiting(shadow));
        scenery.traversal.meet(rays, lamps, |index, t| {
            if let Some((_, shadow)) = of_lamps.next() {
                *shadow = shadow.up_to(shadow.distance(lamps[index], t));
            }
        });
        drop(of_lamps);
        shadows.retain(|(_, shadow)| shadow.is_some());
    }

    /// Finds what each ray hits: the nearest, or with `ANY` the first that is found. A ray comes
    /// with the index of the sphere over which it passes, and with its time.
    #[inline(always)]
    fn trace<const ANY: bool>(
        &mut self,
        scenery: &Scenery<'_, Single<'_>>,
        asked: impl Iterator<Item = (Ray, u32, f32)> + Clone,
    ) -> &[Hit] {
        let Self {
            rays, lefts, hits, ..
        } = self;
        let single = &scenery.traversal;
        hits.clear();
        if scenery.effects.any(Effects::MOTION_BLUR) && !scenery.velocities.is_empty() {
            // Each ray meets spheres where they are at its own time.
            hits.extend(asked.map(|(ray, left, time)| {
                let hit = single.trace_one::<ANY, _>(&ray, &scenery.spheres_at(time, left));
                or_shape::<ANY>(scenery, hit, (ray, left, time))
            }));
            return hits;
        }
        rays.clear();
        lefts.clear();
        rays.extend(asked.clone().map(|(ray, ..)| ray));
        lefts.extend(asked.clone().map(|(_, left, _)| left));
        hits.resize(rays.len(), Hit::NONE);
        single.trace::<ANY>(rays, lefts, scenery.spheres, |index, hit| hits[index] = hit);
        if !scenery.shapes.kinds.is_empty() {
            for (hit, asked) in hits.iter_mut().zip(asked) {
                *hit = or_shape::<ANY>(scenery, *hit, asked);
            }
        }
        hits
    }
}

/// A hit among the spheres, or the hit of a shape if that is nearer; with `ANY` some hit at all. A
/// ray comes as it is asked for in [`Rays::trace`].
#[inline]
fn or_shape<const ANY: bool>(
    scenery: &Scenery<'_, Single<'_>>,
    hit: Hit,
    (ray, left, time): (Ray, u32, f32),
) -> Hit {
    if !ANY {
        return scenery.or_shape(&ray, hit, left, time);
    }
    if !hit.is_some() && scenery.is_blocked_by_shape(&ray, left, time) {
        return Hit {
            t: ray.t_min,
            sphere: scenery.shapes.first,
        };
    }
    hit
}

//! Splits a part of the spheres in two where a ray's expected cost is lowest: the surface area
//! heuristic over bins (I. Wald, On fast Construction of SAH-based Bounding Volume Hierarchies, RT
//! 2007).

use std::array;

use glam::Vec3;
use rayon::prelude::*;
use spherule_kernel::accel::node::Node;

use super::aabb::{Aabb, Item};
use crate::scene::world::GRAIN;

/// Bins along an axis, for [`FEW`] spheres or more.
const BINS: usize = 16;

const FEW_BINS: usize = 8;

const FEW: usize = 256;

/// From this many spheres on, threads share the work on one node.
pub(super) const SHARED: usize = 1 << 16;

/// Beyond this depth nodes are halved, whatever that costs a ray: 8¹² exceeds the possible number
/// of spheres.
const HALVING_DEPTH: usize = Node::MAX_DEPTH - 12;

/// A child of a node: its items and their box.
pub(super) struct Part<'a> {
    pub(super) items: &'a mut [Item],
    /// Room for as many items, if threads share the work on them.
    pub(super) scratch: &'a mut [Item],
    pub(super) bounds: Aabb,
    /// The box around twice the middles, for a part that may be split.
    pub(super) middles: Aabb,
    /// The weight of each axis when the next split's axis is chosen. It is lowered once the node is
    /// split along the axis.
    pub(super) weights: Vec3,
}

pub(super) fn widest_axis(items: &[Item], weights: Vec3) -> usize {
    let middles = Aabb::of_middles(items);
    ((middles.high - middles.low).truncate() * weights).max_position()
}

/// Splits a part into two non-empty parts where a ray's expected cost is lowest.
pub(super) fn split(part: Part<'_>, depth: usize) -> (Part<'_>, Part<'_>) {
    let Part {
        items,
        scratch,
        middles,
        weights,
        ..
    } = part;
    if depth < HALVING_DEPTH {
        let best = if items.len() < FEW {
            best_split::<FEW_BINS>(items, middles, weights)
        } else {
            best_split::<BINS>(items, middles, weights)
        };
        if let Some(best) = best {
            let (items, scratch) = best.partition(items, scratch);
            let sides = [&best.left, &best.right].map(|bin| (bin.bounds, bin.middles));
            let weights = split_along(weights, best.places.axis);
            return halves(items, scratch, best.left.count, sides, weights);
        }
    }
    // All middles are in one place, or the tree is at its depth limit.
    let middle = items.len() / 2;
    let axis = widest_axis(items, weights);
    items.select_nth_unstable_by(middle, |a, b| {
        let order = a.middle()[axis].total_cmp(&b.middle()[axis]);
        // Among spheres around one middle, the smaller ones go together.
        let order = order.then(a.high[axis].total_cmp(&b.high[axis]));
        order.then(a.index().cmp(&b.index()))
    });
    let (left, right) = items.split_at(middle);
    let sides = [left, right].map(|side| (Aabb::of_all(side), Aabb::of_middles(side)));
    halves(items, scratch, middle, sides, weights)
}

/// The two parts of items that are already sorted, with the boxes around them and around twice
/// their middles.
fn halves<'a>(
    items: &'a mut [Item],
    scratch: &'a mut [Item],
    middle: usize,
    [of_left, of_right]: [(Aabb, Aabb); 2],
    weights: Vec3,
) -> (Part<'a>, Part<'a>) {
    let (left, right) = items.split_at_mut(middle);
    let (room_left, room_right) = scratch.split_at_mut(middle.min(scratch.len()));
    let half = |items, scratch, (bounds, middles)| Part {
        items,
        scratch,
        bounds,
        middles,
        weights,
    };
    (
        half(left, room_left, of_left),
        half(right, room_right, of_right),
    )
}

/// Lowers the weight of an axis that a node was split along. Octants give the order of two children
/// along an axis, not of four in a row; so an axis is split again only if the middles are much
/// farther apart along it.
pub(super) fn split_along(mut weights: Vec3, axis: usize) -> Vec3 {
    weights[axis] *= 0.4;
    weights
}

/// Maps the middles of items to bins, with the same arithmetic for every caller.
#[derive(Clone, Copy)]
struct Places {
    axis: usize,
    low: f32,
    scale: f32,
}

impl Places {
    #[inline]
    fn bin(&self, item: &Item) -> f32 {
        (item.low[self.axis] + item.high[self.axis] - self.low) * self.scale
    }
}

/// A split and its two sides.
struct Split {
    places: Places,
    bin: usize,
    left: Bin,
    right: Bin,
    /// If threads share the work: of each [`GRAIN`] items, how many go to the left.
    of_chunks: Vec<usize>,
}

impl Split {
    /// Puts the items of the left side first, in `items`, or in `scratch` if threads share the
    /// work. Returns the sorted slice, then the other one.
    fn partition<'a>(
        &self,
        items: &'a mut [Item],
        scratch: &'a mut [Item],
    ) -> (&'a mut [Item], &'a mut [Item]) {
        let end = self.bin as f32;
        let is_left = |item: &Item| self.places.bin(item) < end;
        if items.len() >= SHARED {
            partition_shared(items, scratch, &self.of_chunks, is_left);
            return (scratch, items);
        }
        partition(items, is_left);
        (items, scratch)
    }
}

/// Puts the items of the left side first, without branches, which no processor could predict.
fn partition(items: &mut [Item], is_left: impl Fn(&Item) -> bool) {
    let mut count = 0;
    for at in 0..items.len() {
        let is_left = is_left(&items[at]);
        items.swap(at, count);
        count += usize::from(is_left);
    }
}

/// Sorts `items` into `sorted` on many threads, the left side first. `of_chunks` says how many of
/// each [`GRAIN`] items go to the left.
fn partition_shared(
    items: &[Item],
    sorted: &mut [Item],
    of_chunks: &[usize],
    is_left: impl Fn(&Item) -> bool + Sync,
) {
    let (mut left, mut right) = sorted.split_at_mut(of_chunks.iter().sum());
    let mut places = Vec::with_capacity(of_chunks.len());
    for (chunk, count) in items.chunks(GRAIN).zip(of_chunks) {
        let (of_left, rest) = left.split_at_mut(*count);
        left = rest;
        let (of_right, rest) = right.split_at_mut(chunk.len() - count);
        right = rest;
        places.push((chunk, of_left, of_right));
    }
    let copy = || vec![Item::NONE; GRAIN];
    places
        .into_par_iter()
        .for_each_init(copy, |copy, (chunk, left, right)| {
            let copy = &mut copy[..chunk.len()];
            copy.copy_from_slice(chunk);
            partition(copy, &is_left);
            left.copy_from_slice(&copy[..left.len()]);
            right.copy_from_slice(&copy[left.len()..]);
        });
}

/// The items of a bin.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Aabb,
    /// The box around twice the middles.
    middles: Aabb,
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self {
        bounds: Aabb::EMPTY,
        middles: Aabb::EMPTY,
        count: 0,
    };

    fn with(self, other: Self) -> Self {
        Self {
            bounds: self.bounds.with(other.bounds),
            middles: self.middles.with(other.middles),
            count: self.count + other.count,
        }
    }

    fn cost(self) -> f32 {
        self.bounds.area() * self.count as f32
    }
}

fn bins_of<const N: usize>(items: &[Item], places: &Places) -> [Bin; N] {
    let mut bins = [Bin::EMPTY; N];
    for item in items {
        let bin = &mut bins[(places.bin(item) as usize).min(N - 1)];
        bin.bounds = bin.bounds.with(item.bounds());
        bin.middles = bin.middles.with_point(item.middle());
        bin.count += 1;
    }
    bins
}

/// The cheapest split between bins along the axis on which the weighted extent of the middles is
/// largest; `None` if all middles are in one place.
fn best_split<const N: usize>(items: &[Item], middles: Aabb, weights: Vec3) -> Option<Split> {
    let width = (middles.high - middles.low).truncate();
    let axis = (width * weights).max_position();
    let scale = N as f32 * (1.0 - 1e-6) / width[axis];
    if !scale.is_finite() {
        return None;
    }
    let places = Places {
        axis,
        low: middles.low[axis],
        scale,
    };
    let chunks: Vec<[Bin; N]> = if items.len() >= SHARED {
        let bins = items.par_chunks(GRAIN).map(|chunk| bins_of(chunk, &places));
        bins.collect()
    } else {
        Vec::new()
    };
    let bins: [Bin; N] = if chunks.is_empty() {
        bins_of(items, &places)
    } else {
        array::from_fn(|at| {
            chunks
                .iter()
                .fold(Bin::EMPTY, |sum, bins| sum.with(bins[at]))
        })
    };

    let mut right = [Bin::EMPTY; N];
    let mut sum = Bin::EMPTY;
    for at in (1..N).rev() {
        sum = sum.with(bins[at]);
        right[at] = sum;
    }
    let mut best = None;
    let mut cheapest = f32::MAX;
    let mut left = Bin::EMPTY;
    for at in 1..N {
        left = left.with(bins[at - 1]);
        let cost = left.cost() + right[at].cost();
        if left.count > 0 && right[at].count > 0 && cost < cheapest {
            cheapest = cost;
            best = Some((at, left, right[at]));
        }
    }
    best.map(|(bin, left, right)| Split {
        places,
        bin,
        left,
        right,
        of_chunks: chunks
            .iter()
            .map(|bins| bins[..bin].iter().map(|bin| bin.count).sum())
            .collect(),
    })
}

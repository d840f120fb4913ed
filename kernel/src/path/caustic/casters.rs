//! [`Entry`]: a sphere that casts caustics, in the table that the host makes of them. Runs on the
//! GPU and on the CPU.
//!
//! The table lies in the kernel's tables: the number of entries, and the entries in the order of
//! the spheres' indices, so that they are found by them.

use crate::arithmetic::elements::{Bisection, read};
use crate::hit::Hit;

/// A sphere that casts caustics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// The index of the sphere.
    pub sphere: u32,
    /// The index of the hollow in it, [`Hit::NONE_SPHERE`] if there is none.
    pub hollow: u32,
    /// The probability that it is chosen.
    pub probability: f32,
}

/// Floats of an entry.
const LEN: usize = 6;
/// An index is kept as two floats, of so many numbers the lower: as bits it might be one that a
/// GPU takes for zero.
const LOWER: u32 = 1 << 16;

impl Entry {
    /// No sphere.
    const NONE: Self = Self {
        sphere: Hit::NONE_SPHERE,
        hollow: Hit::NONE_SPHERE,
        probability: 0.0,
    };

    /// The sphere with this index, and the index of the hollow in it.
    #[cfg(not(target_arch = "spirv"))]
    #[must_use]
    pub fn new(sphere: u32, hollow: Option<u32>, probability: f32) -> Self {
        Self {
            sphere,
            hollow: hollow.unwrap_or(Hit::NONE_SPHERE),
            probability,
        }
    }

    /// The table of these entries, which are sorted by `sphere`.
    #[cfg(not(target_arch = "spirv"))]
    #[must_use]
    pub fn table(entries: &[Self]) -> alloc::vec::Vec<f32> {
        let mut table = alloc::vec![entries.len() as f32];
        let mut cumulative = 0.0;
        for entry in entries {
            cumulative += f64::from(entry.probability);
            for index in [entry.sphere, entry.hollow] {
                table.extend([(index / LOWER) as f32, (index % LOWER) as f32]);
            }
            table.extend([entry.probability, cumulative as f32]);
        }
        if entries.is_empty() {
            // What is chosen then.
            table.extend([0.0; LEN]);
        }
        table
    }

    /// The entry with this number of the table at `first`.
    #[inline]
    fn read(tables: &[f32], first: u32, number: usize) -> Self {
        let at = first as usize + 1 + LEN * number;
        let index = |at: usize| {
            let (upper, lower) = (read(tables, at) as u32, read(tables, at + 1) as u32);
            upper.wrapping_mul(LOWER).wrapping_add(lower)
        };
        Self {
            sphere: index(at),
            hollow: index(at + 2),
            probability: read(tables, at + 4),
        }
    }

    /// The entry that `u` chooses: the first whose cumulative probability exceeds it.
    #[inline]
    #[must_use]
    pub fn choose(tables: &[f32], first: u32, u: f32) -> Self {
        let count = read(tables, first as usize) as u32 as usize;
        let mut search = Bisection::below(count.max(1) - 1);
        while search.is_open() {
            let at = first as usize + LEN * (search.middle() + 1);
            search.narrow(u < read(tables, at));
        }
        Self::read(tables, first, search.low)
    }

    /// The entry of the sphere with this index; one of probability zero if there is none.
    #[inline]
    #[must_use]
    pub fn find(tables: &[f32], first: u32, sphere: u32) -> Self {
        let count = read(tables, first as usize) as u32 as usize;
        let mut search = Bisection::below(count);
        while search.is_open() {
            let entry = Self::read(tables, first, search.middle());
            search.narrow(entry.sphere >= sphere);
        }
        if search.low < count {
            let entry = Self::read(tables, first, search.low);
            if entry.sphere == sphere {
                return entry;
            }
        }
        Self::NONE
    }

    /// Whether there is a hollow in it.
    #[inline]
    #[must_use]
    pub fn is_hollow(self) -> bool {
        self.hollow != Hit::NONE_SPHERE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_found_and_chosen() {
        let entries = [
            Entry::new(3, None, 0.25),
            Entry::new(70_000, Some(2), 0.5),
            Entry::new(0xfffe_fffd, None, 0.25),
        ];
        let mut tables = alloc::vec![9.0, 9.0];
        tables.extend(Entry::table(&entries));
        for entry in entries {
            assert_eq!(Entry::find(&tables, 2, entry.sphere), entry);
        }
        for sphere in [0, 4, 69_999, 70_001, Hit::NONE_SPHERE] {
            assert_eq!(Entry::find(&tables, 2, sphere), Entry::NONE);
        }
        for (u, chosen) in [
            (0.0, 0),
            (0.2, 0),
            (0.25, 1),
            (0.7, 1),
            (0.75, 2),
            (0.99, 2),
        ] {
            assert_eq!(Entry::choose(&tables, 2, u), entries[chosen], "{u}");
        }
        assert_eq!(Entry::choose(&Entry::table(&[]), 0, 0.5).probability, 0.0);
        assert!(entries[1].is_hollow() && !entries[0].is_hollow());
    }
}

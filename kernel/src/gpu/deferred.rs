//! The list of what the first of two launches defers: see
//! [`DEFERRING`](crate::precision::DEFERRING). Runs on the GPU.
//!
//! The first element counts, the others are the entries, in no order. The second launch has few
//! workgroups, which take turns: next to nothing is deferred, and it is over soon.

use spirv_std::arch::{IndexUnchecked, atomic_i_add};
use spirv_std::memory::{Scope, Semantics};

/// Atomic operations are on the list, and order no other operation.
const DEVICE: u32 = Scope::Device as u32;
const RELAXED: u32 = Semantics::NONE.bits();

/// Adds an entry. Without room for it, it is lost.
#[inline]
pub fn defer(list: &mut [u32], entry: u32) {
    if list.len() > 1 {
        // SAFETY: there is a first element, and all threads count by atomic additions.
        let count = unsafe { atomic_i_add::<u32, DEVICE, RELAXED>(list.index_unchecked_mut(0), 1) };
        let place = count as usize + 1;
        if place < list.len() {
            // SAFETY: as just asked.
            unsafe { *list.index_unchecked_mut(place) = entry };
        }
    }
}

/// How many entries there are.
#[inline]
#[must_use]
pub fn count(list: &[u32]) -> u32 {
    if list.len() > 1 {
        list[0].min(list.len() as u32 - 1)
    } else {
        0
    }
}

/// The entry at a place below [`count`].
#[inline]
#[must_use]
pub fn entry(list: &[u32], place: u32) -> u32 {
    // SAFETY: the caller asked how many there are.
    unsafe { *list.index_unchecked(place as usize + 1) }
}

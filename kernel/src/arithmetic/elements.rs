//! Elements of arrays and slices by index, without a panic. Runs on the GPU and on the CPU.
//!
//! A possible panic costs time in the whole kernel: it ends the thread there, and every loop around
//! it checks whether that has happened.

use bytemuck::Zeroable;
use spirv_std::arch::IndexUnchecked;

/// The element at `index`; the last element for an index beyond it.
///
/// ```compile_fail
/// // An array without elements has no last one.
/// spherule_kernel::arithmetic::elements::get(&[0_u32; 0], 3);
/// ```
#[inline]
#[must_use]
pub fn get<T: Copy, const N: usize>(array: &[T; N], index: usize) -> T {
    const { assert!(N > 0, "an array without elements has none to read") };
    // SAFETY: the index is below N.
    unsafe { *array.index_unchecked(index.min(N - 1)) }
}

/// Writes the element that [`get`] reads.
#[inline]
pub fn set<T, const N: usize>(array: &mut [T; N], index: usize, value: T) {
    const { assert!(N > 0, "an array without elements has none to write") };
    // SAFETY: the index is below N.
    unsafe { *array.index_unchecked_mut(index.min(N - 1)) = value };
}

/// Searches the first of some indices of which something holds that holds of all that follow. The
/// caller asks about the [middle](Bisection::middle) and [narrows](Bisection::narrow) the search;
/// rust-gpu takes no closure here that borrows a buffer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bisection {
    /// The first index that it may hold of; at the end, the one that is searched.
    pub(crate) low: usize,
    high: usize,
}

impl Bisection {
    /// Among the indices below `count`, which is found if it holds of none.
    #[inline]
    pub(crate) fn below(count: usize) -> Self {
        Self {
            low: 0,
            high: count,
        }
    }

    /// Whether there is more to ask.
    #[inline]
    pub(crate) fn is_open(self) -> bool {
        self.low < self.high
    }

    /// The index to ask about.
    #[inline]
    pub(crate) fn middle(self) -> usize {
        self.low + (self.high - self.low) / 2
    }

    /// Goes on with the half that is left if it holds of the middle, or if it does not.
    #[inline]
    pub(crate) fn narrow(&mut self, holds: bool) {
        if holds {
            self.high = self.middle();
        } else {
            self.low = self.middle() + 1;
        }
    }
}

/// The element at `index` of a slice; zeros for an index beyond it. On a GPU the slice is a buffer
/// that the launch binds, and the driver ensures this (`robustBufferAccess`).
#[inline]
#[must_use]
pub fn read<T: Zeroable + Copy>(slice: &[T], index: usize) -> T {
    #[cfg(target_arch = "spirv")]
    // SAFETY: the driver does not read beyond a buffer.
    return unsafe { *slice.index_unchecked(index) };
    #[cfg(not(target_arch = "spirv"))]
    slice.get(index).copied().unwrap_or(T::zeroed())
}

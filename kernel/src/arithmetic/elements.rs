//! Elements of arrays and slices, by indices that no compiler sees through, without a panic. Runs on the GPU and on the CPU.
//!
//! What might panic leaves its mark on all of a kernel: the thread gives up there, and every loop around it asks whether it has.

use bytemuck::Zeroable;
use spirv_std::arch::IndexUnchecked;

/// An element; the last for an index beyond it.
///
/// ```compile_fail
/// // An array without elements has no last one.
/// spherule_kernel::arithmetic::elements::get(&[0_u32; 0], 3);
/// ```
#[inline]
#[must_use]
pub fn get<T: Copy, const N: usize>(array: &[T; N], index: usize) -> T {
    const { assert!(N > 0, "an array without elements has none to read") };
    // SAFETY: below N.
    unsafe { *array.index_unchecked(index.min(N - 1)) }
}

/// Writes what [`get`] reads.
#[inline]
pub fn set<T, const N: usize>(array: &mut [T; N], index: usize, value: T) {
    const { assert!(N > 0, "an array without elements has none to write") };
    // SAFETY: below N.
    unsafe { *array.index_unchecked_mut(index.min(N - 1)) = value };
}

/// An element of a slice, which a launch binds; for an index beyond it, zeros: a GPU's driver sees to that (`robustBufferAccess`).
#[inline]
#[must_use]
pub fn read<T: Zeroable + Copy>(slice: &[T], index: usize) -> T {
    #[cfg(target_arch = "spirv")]
    // SAFETY: what is beyond a buffer the driver does not read.
    return unsafe { *slice.index_unchecked(index) };
    #[cfg(not(target_arch = "spirv"))]
    slice.get(index).copied().unwrap_or(T::zeroed())
}

//! [`Buffer`]: device memory that holds elements of one type.

use std::marker::PhantomData;
use std::num::NonZero;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use bytemuck::Pod;

/// Device memory for `len` elements of `T`.
#[derive(Debug)]
pub struct Buffer<T> {
    pub(super) raw: wgpu::Buffer,
    pub(super) label: String,
    pub(super) owner: Owner,
    len: usize,
    of: PhantomData<T>,
}

impl<T: Pod> Buffer<T> {
    pub(super) fn from_raw(raw: wgpu::Buffer, label: &str, owner: Owner, len: usize) -> Self {
        Self {
            raw,
            label: label.into(),
            owner,
            len,
            of: PhantomData,
        }
    }

    /// The number of elements.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether it has no elements.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The whole buffer as a binding.
    #[must_use]
    pub fn binding(&self) -> Binding<'_> {
        Binding {
            resource: self.raw.as_entire_binding(),
            label: &self.label,
            owner: self.owner,
        }
    }

    /// Some of the buffer's elements as a binding. The offset of the first, in bytes, must be a
    /// multiple of the device's `min_storage_buffer_offset_alignment`. Panics if the range is empty
    /// or leaves the buffer.
    #[must_use]
    pub(crate) fn binding_of(&self, range: Range<usize>) -> Binding<'_> {
        assert!(range.start < range.end && range.end <= self.len);
        let bytes = |count: usize| (count * size_of::<T>()) as u64;
        Binding {
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &self.raw,
                offset: bytes(range.start),
                size: NonZero::new(bytes(range.len())),
            }),
            label: &self.label,
            owner: self.owner,
        }
    }
}

/// A buffer, or a part of one, as a kernel's argument.
#[derive(Clone, Debug)]
pub struct Binding<'a> {
    pub(super) resource: wgpu::BindingResource<'a>,
    pub(super) label: &'a str,
    pub(super) owner: Owner,
}

/// The device that made something. wgpu can tell apart devices of one instance, but not devices of
/// different instances.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Owner(u64);

impl Owner {
    /// A new owner, different from all others.
    pub(super) fn new() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}

/// How a kernel uses a binding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Access {
    /// A small constant in uniform memory.
    Uniform,
    /// Storage that the kernel only reads.
    Read,
    /// Storage that the kernel reads and writes.
    ReadWrite,
}

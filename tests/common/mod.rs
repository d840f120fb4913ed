//! What the GPU tests share: every adapter of this machine, opened once.
//!
//! A machine without any adapter skips these tests, each with a line that says so; with
//! `SPHERULE_REQUIRE_GPU=1` it fails them instead.

#![allow(
    dead_code,
    reason = "each test binary compiles this module and uses a part of it"
)]

use std::sync::OnceLock;

use spherule::device::adapter::{adapters, instance};
use spherule::device::{Gpu, GpuOptions};
use spherule::wgpu;

/// Every adapter of this machine.
pub fn all_adapters() -> &'static [wgpu::Adapter] {
    static ADAPTERS: OnceLock<Vec<wgpu::Adapter>> = OnceLock::new();
    ADAPTERS.get_or_init(|| {
        if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
            // SAFETY: tests of this process read no environment variable while this runs.
            unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
        }
        adapters(&instance())
    })
}

/// Every adapter of this machine, opened with SPIR-V going straight to the driver.
pub fn gpus() -> &'static [Gpu] {
    static GPUS: OnceLock<Vec<Gpu>> = OnceLock::new();
    GPUS.get_or_init(|| {
        all_adapters()
            .iter()
            .map(|adapter| open(adapter, GpuOptions::default()))
            .collect()
    })
}

pub fn open(adapter: &wgpu::Adapter, options: GpuOptions) -> Gpu {
    Gpu::from_adapter(adapter, options).unwrap_or_else(|error| panic!("{error}"))
}

/// Whether there is no adapter, after saying that `test` is skipped.
pub fn skips(test: &str) -> bool {
    let none = all_adapters().is_empty();
    if none {
        assert!(
            std::env::var_os("SPHERULE_REQUIRE_GPU").is_none_or(|value| value == "0"),
            "{test}: SPHERULE_REQUIRE_GPU is set and there is no adapter"
        );
        eprintln!(
            "SKIPPED {test}: there is no GPU adapter; Debian's mesa-vulkan-drivers brings a software one"
        );
    }
    none
}

/// An adapter that runs nothing but checks every call.
pub fn noop_adapter(features: wgpu::Features) -> wgpu::Adapter {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::NOOP,
        backend_options: wgpu::BackendOptions {
            noop: wgpu::NoopBackendOptions {
                enable: true,
                features: Some(features),
                limits: Some(wgpu::Limits {
                    max_buffer_size: u64::MAX,
                    max_storage_buffer_binding_size: u64::MAX,
                    ..wgpu::Limits::default()
                }),
                ..Default::default()
            },
            ..Default::default()
        },
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    adapters(&instance).swap_remove(0)
}

/// A repeatable stream of numbers: PCG-XSH-RR 64/32 (O'Neill 2014).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn next_u32(&mut self) -> u32 {
        let old = self.0;
        self.0 = old
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let xorshifted = (((old >> 18) ^ old) >> 27) as u32;
        xorshifted.rotate_right((old >> 59) as u32)
    }

    /// Uniform between `low` and `high`.
    pub fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.next_u32() >> 8) as f32 / (1 << 24) as f32
    }

    pub fn vec3(&mut self, low: f32, high: f32) -> glam::Vec3 {
        glam::Vec3::new(
            self.within(low, high),
            self.within(low, high),
            self.within(low, high),
        )
    }
}

//! Shared by the GPU tests: every adapter of this machine, opened once.
//!
//! On a machine without an adapter these tests are skipped, each with a line that says so. With
//! `SPHERULE_REQUIRE_GPU=1` they fail instead.

#![allow(
    dead_code,
    reason = "each test binary compiles this module and uses a part of it"
)]

use std::sync::OnceLock;

use glam::Vec3;
use spherule::device::adapter::{adapters, instance};
use spherule::device::{Device, Gpu, GpuOptions};
use spherule::scene::surroundings::Surroundings;
use spherule::scene::{View, World};
use spherule::{Scene, wgpu};

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

/// Every adapter of this machine, opened so that SPIR-V goes straight to the driver.
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

/// The adapter as a device of its own, with the default options.
pub fn device(adapter: &wgpu::Adapter) -> Device {
    Device::Gpu(Box::new(open(adapter, GpuOptions::default())))
}

/// The CPU, and every adapter.
pub fn devices() -> &'static [(String, Device)] {
    static DEVICES: OnceLock<Vec<(String, Device)>> = OnceLock::new();
    DEVICES.get_or_init(|| {
        let adapters = all_adapters().iter();
        let gpus = adapters.map(|adapter| (adapter.get_info().name, device(adapter)));
        std::iter::once(("CPU".to_owned(), Device::Cpu))
            .chain(gpus)
            .collect()
    })
}

pub fn open_with_limits(adapter: &wgpu::Adapter, limits: wgpu::Limits) -> Gpu {
    let options = GpuOptions::default().limits(limits);
    open(adapter, options)
}

/// The adapter, opened so that modules go through naga.
pub fn open_through_naga(adapter: &wgpu::Adapter) -> Gpu {
    let options = GpuOptions::default().through_naga(true);
    open(adapter, options)
}

/// The adapter, opened so that rungs do without 64-bit floats.
pub fn open_without_f64(adapter: &wgpu::Adapter) -> Gpu {
    open(adapter, GpuOptions::default().without_f64(true))
}

/// Whether there is no adapter. If so, says that `test` is skipped.
pub fn skips(test: &str) -> bool {
    let none = all_adapters().is_empty();
    if none {
        assert!(
            std::env::var_os("SPHERULE_REQUIRE_GPU").is_none_or(|value| value == "0"),
            "{test}: SPHERULE_REQUIRE_GPU is set and there is no adapter"
        );
        eprintln!(
            "SKIPPED {test}: there is no GPU adapter; Debian's package mesa-vulkan-drivers has a software one"
        );
    }
    none
}

/// An adapter that checks every call and runs nothing.
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

/// How opaque each pixel of an image is, row by row.
pub fn opacities(image: &spherule::Image) -> Vec<f32> {
    (0..image.pixels().len())
        .map(|index| image.opacity(index))
        .collect()
}

/// A world around the origin, seen from five units away in surroundings of radiance one: what
/// reflects or transmits all light is invisible there.
pub fn in_furnace(world: World) -> Scene {
    let mut scene = Scene::new(world);
    scene.view = Some(View {
        eye: Vec3::new(0.0, 0.0, 5.0),
        target: Vec3::ZERO,
        up: Vec3::Y,
        vertical_fov: 22.0,
    });
    scene.sky = Some(Surroundings {
        horizon: Vec3::ONE,
        zenith: Vec3::ONE,
        sun: None,
        rotation: 0.0,
        image: None,
    });
    scene
}

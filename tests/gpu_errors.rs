//! Every GPU error, provoked for real: forced limits, corrupt modules, a destroyed device, a
//! deadline that cannot be met, and wgpu's noop backend, which checks calls and runs nothing.

mod common;

use std::time::Duration;

use common::{all_adapters, gpus, noop_adapter, open, skips};
use spherule::device::{Access, Device, DeviceChoice, Gpu, GpuOptions, Module};
use spherule::kernel::{Hit, Ray, Shading, Sphere, spirv};
use spherule::render::{QUIET, render};
use spherule::{Error, Scene, kernel_module, wgpu};

fn noop() -> Gpu {
    open(
        &noop_adapter(wgpu::Features::empty()),
        GpuOptions::default(),
    )
}

/// The message must name what and where, and the help must not be empty.
#[track_caller]
fn assert_says(error: &Error, words: &[&str]) {
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "{word:?} is not in: {message}");
    }
    assert!(!message.contains('\n'), "{message}");
    assert!(error.help().len() > 20, "{error:?}");
}

#[test]
fn no_adapter() {
    let choice = DeviceChoice::Named("no such adapter".into());
    let error = Device::open(&choice).expect_err("there is none of that name");
    // It is the name that is wrong, where there are adapters of other names.
    let there_are_others = !all_adapters().is_empty();
    assert_eq!(
        matches!(error, Error::NoSuchAdapter { .. }),
        there_are_others,
        "{error:?}"
    );
    assert_eq!(
        matches!(error, Error::NoAdapter { .. }),
        !there_are_others,
        "{error:?}"
    );
    assert_eq!(error.is_input(), there_are_others);
    assert_says(&error, &["no such adapter"]);
}

#[test]
fn device_refused() {
    if skips("device_refused") {
        return;
    }
    let limits = wgpu::Limits {
        max_compute_invocations_per_workgroup: u32::MAX,
        ..wgpu::Limits::default()
    };
    let options = GpuOptions {
        limits: Some(limits),
        ..GpuOptions::default()
    };
    for adapter in all_adapters() {
        let error =
            Gpu::from_adapter(adapter, options.clone()).expect_err("too much was asked for");
        assert!(matches!(error, Error::DeviceRefused { .. }), "{error:?}");
        assert_says(&error, &["max_compute_invocations_per_workgroup"]);
    }
}

#[test]
fn kernel_invalid_by_structure() {
    let good = spirv::F32;
    let mut bad_magic = good.to_vec();
    bad_magic[0] ^= 0xff;
    let mut bad_length = good.to_vec();
    bad_length[22] = 0;
    bad_length[23] = 0;
    let header_only = &good[..20];
    let cases: [(&[u8], &str); 7] = [
        (&[], "whole number"),
        (&good[..good.len() - 3], "whole number"),
        (&good[..good.len() - 4], "middle of a function"),
        (&good[..104], "does not fit"),
        (&bad_magic, "starts with"),
        (&bad_length, "word 5"),
        (header_only, "no compute entry point"),
    ];
    for (bytes, word) in cases {
        let error = Module::from_bytes("corrupt", bytes).expect_err(word);
        assert!(matches!(error, Error::KernelInvalid { .. }), "{error:?}");
        assert_says(&error, &["corrupt", word]);
    }
    let error = kernel_module::f32()
        .and_then(|module| module.specialise(99, 1))
        .expect_err("there is no constant 99");
    assert_says(&error, &["constant 99"]);
}

#[test]
fn modules_of_the_other_byte_order_are_read() {
    let swapped: Vec<u8> = spirv::F32
        .chunks_exact(4)
        .flat_map(|word| [word[3], word[2], word[1], word[0]])
        .collect();
    let module = Module::from_bytes("swapped", &swapped).expect("a module");
    assert_eq!(
        module.words(),
        kernel_module::f32().expect("the kernel").words()
    );
}

#[test]
fn kernel_invalid_by_content() {
    // Structurally sound, and nonsense: every access chain points at a result that is not there.
    let mut words = kernel_module::f32().expect("the kernel").words().to_vec();
    const ACCESS_CHAIN: u32 = 65;
    let mut at = 5;
    while at < words.len() {
        if words[at] & 0xffff == ACCESS_CHAIN {
            words[at + 3] = 0x00ff_ffff;
        }
        at += (words[at] >> 16) as usize;
    }
    let module = Module::from_bytes("nonsense", bytemuck::cast_slice(&words))
        .expect("the structure is sound");
    let error = noop()
        .kernel(
            &module,
            "trace_rays",
            &[Access::Read, Access::Read, Access::ReadWrite],
        )
        .expect_err("it is nonsense");
    assert!(matches!(error, Error::KernelInvalid { .. }), "{error:?}");
    assert_says(&error, &["nonsense/trace_rays"]);
}

#[test]
fn kernel_invalid_by_name_or_need() {
    let module = kernel_module::f32().expect("the kernel");
    let error = noop()
        .kernel(&module, "no_such_entry", &[])
        .expect_err("there is none");
    assert_says(&error, &["no_such_entry", "trace_rays"]);

    // The capability Float64, declared after the first instruction, on a device without it.
    let mut words = module.words().to_vec();
    let second = 5 + (words[5] >> 16) as usize;
    words.splice(second..second, [(2 << 16) | 17, 10]);
    let module = Module::from_bytes("doubles", bytemuck::cast_slice(&words)).expect("a module");
    assert!(module.needs_f64());
    let error = noop()
        .kernel(&module, "trace_rays", &[])
        .expect_err("the device has no f64");
    assert!(matches!(error, Error::KernelInvalid { .. }), "{error:?}");
    assert_says(&error, &["64-bit floats"]);
}

#[test]
fn buffer_too_large() {
    if skips("buffer_too_large") {
        return;
    }
    for adapter in all_adapters() {
        let limits = wgpu::Limits {
            max_storage_buffer_binding_size: 1 << 16,
            ..adapter.limits()
        };
        let gpu = open(
            adapter,
            GpuOptions {
                limits: Some(limits),
                ..GpuOptions::default()
            },
        );
        let spheres = vec![Sphere::default(); (1 << 12) + 1];
        let error = gpu
            .upload("spheres", &spheres)
            .expect_err("one sphere too many");
        assert!(
            matches!(
                error,
                Error::BufferTooLarge {
                    needed: 65_552,
                    limit: 65_536,
                    ..
                }
            ),
            "{error:?}"
        );
        assert_says(&error, &["spheres", "65552", "65536"]);
        assert!(gpu.upload("spheres", &spheres[1..]).is_ok());
    }
}

#[test]
fn out_of_memory() {
    let gpu = noop();
    let error = gpu
        .zeroed::<u8>("the universe", 1 << 60)
        .expect_err("no machine has that much");
    assert!(matches!(error, Error::OutOfMemory { .. }), "{error:?}");
    assert_says(&error, &["the universe", "1152921504606846976 bytes"]);
    // The device lives on.
    assert!(gpu.zeroed::<u32>("a little", 4).is_ok());
}

/// The practical's "too many resources requested for launch".
#[test]
fn launch_limits() {
    if skips("launch_limits") {
        return;
    }
    let module = kernel_module::f32().expect("the kernel");
    let bindings = [Access::Read, Access::Read, Access::ReadWrite];
    for adapter in all_adapters() {
        let limits = wgpu::Limits {
            max_compute_invocations_per_workgroup: 32,
            max_compute_workgroups_per_dimension: 1000,
            ..adapter.limits()
        };
        let gpu = open(
            adapter,
            GpuOptions {
                limits: Some(limits),
                ..GpuOptions::default()
            },
        );
        let error = gpu
            .kernel(&module, "trace_rays", &bindings)
            .expect_err("64 threads do not fit 32");
        assert!(
            matches!(
                error,
                Error::LaunchLimits {
                    asked: 64,
                    limit: 32,
                    ..
                }
            ),
            "{error:?}"
        );
        assert_says(&error, &["trace_rays", "threads in a workgroup"]);
    }
    for gpu in gpus() {
        let kernel = gpu
            .kernel(&module, "trace_rays", &bindings)
            .expect("a kernel");
        let error = gpu
            .launch(&kernel, &[], [u32::MAX, 1, 1])
            .expect_err("no device counts that far");
        assert!(matches!(error, Error::LaunchLimits { .. }), "{error:?}");
        assert_says(&error, &["workgroups", "4294967295"]);
    }
}

#[test]
fn validation() {
    if skips("validation") {
        return;
    }
    let module = kernel_module::f32().expect("the kernel");
    for gpu in gpus() {
        let kernel = gpu
            .kernel(
                &module,
                "trace_rays",
                &[Access::Read, Access::Read, Access::ReadWrite],
            )
            .expect("a kernel");
        let rays = gpu.upload("rays", &[Ray::default()]).expect("rays");
        let error = gpu
            .launch(&kernel, &[rays.binding()], [1, 1, 1])
            .expect_err("two buffers are missing");
        assert!(matches!(error, Error::Validation { .. }), "{error:?}");
        assert_says(&error, &["trace_rays"]);
        // The device lives on, and takes the launch once it is right.
        let spheres = gpu
            .upload("spheres", &[Sphere::default()])
            .expect("spheres");
        let hits = gpu.zeroed::<Hit>("hits", 1).expect("hits");
        let bindings = [rays.binding(), spheres.binding(), hits.binding()];
        gpu.launch(&kernel, &bindings, [1, 1, 1])
            .expect("all is there");
        assert_eq!(gpu.read(&hits).expect("hits"), [Hit::NONE]);
    }
}

#[test]
fn device_lost() {
    if skips("device_lost") {
        return;
    }
    let scene = Scene::load("scenes/two-spheres.toml").expect("the scene");
    for adapter in all_adapters() {
        let gpu = open(adapter, GpuOptions::default());
        let rays = gpu.upload("rays", &[Ray::default()]).expect("rays");
        gpu.destroy();
        for error in [
            gpu.read(&rays).expect_err("it is gone"),
            gpu.upload("more", &[1_u32]).expect_err("it is gone"),
        ] {
            assert!(matches!(error, Error::DeviceLost { .. }), "{error:?}");
            assert_says(&error, &[gpu.name(), "destroyed"]);
        }
        let error = render(&scene, Shading::Flat, &Device::Gpu(Box::new(gpu)), QUIET)
            .expect_err("it is gone");
        assert!(matches!(error, Error::DeviceLost { .. }), "{error:?}");
    }
}

#[test]
fn timeout() {
    if skips("timeout") {
        return;
    }
    let module = kernel_module::f32().expect("the kernel");
    for adapter in all_adapters() {
        let gpu = open(
            adapter,
            GpuOptions {
                timeout: Duration::from_nanos(1),
                ..GpuOptions::default()
            },
        );
        let kernel = gpu
            .kernel(
                &module,
                "trace_rays",
                &[Access::Read, Access::Read, Access::ReadWrite],
            )
            .expect("a kernel");
        // Milliseconds of work on a fast GPU, and not a minute of it on a software one.
        let is_software = adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        let count = if is_software { 1 << 10 } else { 1 << 16 };
        let ray = Ray::new(glam::Vec3::ZERO, glam::Vec3::X);
        let rays = gpu.upload("rays", &vec![ray; 1 << 16]).expect("rays");
        let spheres = gpu
            .upload("spheres", &vec![Sphere::new(glam::Vec3::X, 0.1); count])
            .expect("spheres");
        let hits = gpu.zeroed::<Hit>("hits", 1 << 16).expect("hits");
        let error = gpu
            .launch(
                &kernel,
                &[rays.binding(), spheres.binding(), hits.binding()],
                [1 << 10, 1, 1],
            )
            .expect_err("no device is done in a nanosecond");
        assert!(matches!(error, Error::Timeout { .. }), "{error:?}");
        assert_says(&error, &["trace_rays", gpu.name()]);
    }
}

/// A kernel whose threads write nothing, as after a panic on the device: noop runs none.
#[test]
fn readback() {
    let mut scene = Scene::load("scenes/two-spheres.toml").expect("the scene");
    (scene.width, scene.height) = (16, 9);
    let error = render(&scene, Shading::Flat, &Device::Gpu(Box::new(noop())), QUIET)
        .expect_err("nothing was written");
    assert!(matches!(error, Error::Readback { .. }), "{error:?}");
    assert_says(&error, &["144 of 144 pixels"]);
}

//! Provokes every GPU error: by forced limits, corrupt modules, a destroyed device, a deadline that
//! cannot be met, and wgpu's noop backend, which checks calls and runs nothing.

mod common;

use std::time::Duration;

use common::{all_adapters, gpus, noop_adapter, open, open_with_limits, skips};
use spherule::accel::Acceleration;
use spherule::device::{Access, Device, DeviceChoice, Gpu, GpuOptions, Kernel, Module};
use spherule::kernel::{Hit, Material, Ray, Rung, Shading, Sphere, spirv};
use spherule::render::{QUIET, Settings, paths, render};
use spherule::scene::World;
use spherule::scene::surroundings::{EnvironmentImage, Surroundings};
use spherule::trace::GpuTracer;
use spherule::{Error, Scene, kernel_module, wgpu};

fn noop() -> Gpu {
    open(
        &noop_adapter(wgpu::Features::empty()),
        GpuOptions::default(),
    )
}

/// The kernel's module without 64-bit floats.
fn kernel_f32() -> Module {
    kernel_module::f32().expect("the kernel")
}

/// The accesses of the entry point `trace_rays`.
const TRACE_RAYS: [Access; 3] = [Access::Read, Access::Read, Access::ReadWrite];

fn trace_rays(gpu: &Gpu) -> Kernel {
    gpu.kernel(&kernel_f32(), "trace_rays", &TRACE_RAYS)
        .expect("a kernel")
}

fn with_timeout(adapter: &wgpu::Adapter, timeout: Duration) -> Gpu {
    let options = GpuOptions::default().timeout(timeout);
    open(adapter, options)
}

/// Checks the variant of an error.
macro_rules! assert_is {
    ($error:ident, $variant:pat) => {
        assert!(matches!($error, $variant), "{:?}", $error)
    };
}

/// Checks that the message is one line with all of these words, and that there is a help text.
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
    let error = Device::open(&choice).expect_err("no adapter has this name");
    // If there are other adapters, the name is wrong.
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
    let options = GpuOptions::default().limits(limits);
    for adapter in all_adapters() {
        let error =
            Gpu::from_adapter(adapter, options.clone()).expect_err("the limits are too high");
        assert_is!(error, Error::DeviceRefused { .. });
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
        assert_is!(error, Error::KernelInvalid { .. });
        assert_says(&error, &["corrupt", word]);
    }
    let error = kernel_module::f32()
        .and_then(|module| module.specialise(99, 1))
        .expect_err("there is no constant 99");
    assert_says(&error, &["constant 99"]);
}

#[test]
fn modules_in_the_other_byte_order_are_read() {
    let swapped: Vec<u8> = spirv::F32
        .chunks_exact(4)
        .flat_map(|word| [word[3], word[2], word[1], word[0]])
        .collect();
    let module = Module::from_bytes("swapped", &swapped).expect("a module");
    assert_eq!(module.words(), kernel_f32().words());
}

#[test]
fn kernel_invalid_by_content() {
    // The structure is sound and the content is not: every access chain refers to an id that does
    // not exist.
    let mut words = kernel_f32().words().to_vec();
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
        .kernel(&module, "trace_rays", &TRACE_RAYS)
        .expect_err("the module is invalid");
    assert_is!(error, Error::KernelInvalid { .. });
    assert_says(&error, &["nonsense/trace_rays"]);
}

#[test]
fn kernel_invalid_by_name_or_need() {
    let module = kernel_f32();
    let error = noop()
        .kernel(&module, "no_such_entry", &[])
        .expect_err("there is no such entry point");
    assert_says(&error, &["no_such_entry", "trace_rays"]);

    // The module declares the capability Float64, after its first instruction, and the device does
    // not have it.
    let mut words = module.words().to_vec();
    let second = 5 + (words[5] >> 16) as usize;
    words.splice(second..second, [(2 << 16) | 17, 10]);
    let module = Module::from_bytes("doubles", bytemuck::cast_slice(&words)).expect("a module");
    assert!(module.needs_f64());
    let error = noop()
        .kernel(&module, "trace_rays", &[])
        .expect_err("the device has no f64");
    assert_is!(error, Error::KernelInvalid { .. });
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
        let gpu = open_with_limits(adapter, limits);
        let spheres = vec![Sphere::default(); (1 << 12) + 1];
        let error = gpu
            .upload("spheres", &spheres)
            .expect_err("one sphere too many");
        assert_is!(
            error,
            Error::BufferTooLarge {
                needed: 65_552,
                limit: 65_536,
                ..
            }
        );
        assert_says(&error, &["spheres", "65552", "65536"]);
        assert!(gpu.upload("spheres", &spheres[1..]).is_ok());
    }
}

/// An image of the sky that the device does not take is refused, and one of the size that the
/// message names is not.
#[test]
fn sky_too_large() {
    if skips("sky_too_large") {
        return;
    }
    for adapter in all_adapters() {
        let limits = wgpu::Limits {
            max_storage_buffer_binding_size: 1 << 16,
            ..adapter.limits()
        };
        let device = Device::Gpu(Box::new(open_with_limits(adapter, limits)));
        let rendered = |width: u32, height: u32| {
            let mut world = World::default();
            let white = world.add_material(Material::diffuse(glam::Vec3::ONE));
            world.add(Sphere::new(glam::Vec3::ZERO, 1.0), white);
            let mut scene = Scene::new(world);
            (scene.width, scene.height) = (8, 8);
            scene.sampling.samples = Some(4);
            scene.sky = Some(Surroundings {
                horizon: glam::Vec3::ZERO,
                zenith: glam::Vec3::ZERO,
                sun: None,
                rotation: 0.0,
                image: Some(EnvironmentImage {
                    width,
                    height,
                    texels: vec![glam::Vec3::ONE; (width * height) as usize],
                }),
            });
            render(&scene, Settings::default(), &device, QUIET)
        };
        let error = rendered(128, 64).expect_err("98,304 bytes");
        assert_is!(
            error,
            Error::SkyTooLarge {
                needed: 98_304,
                limit: 65_536,
                ..
            }
        );
        assert_says(&error, &["128 × 64", "98304", "65536"]);
        assert!(error.help().contains("104 × 52"), "{}", error.help());
        let image = rendered(104, 52).expect("it fits").image;
        let corner = image.pixels()[0].color();
        assert!(
            (corner - glam::Vec3::ONE).abs().max_element() < 1e-4,
            "{corner}"
        );
    }
}

#[test]
fn out_of_memory() {
    let gpu = noop();
    let error = gpu
        .zeroed::<u8>("the universe", 1 << 60)
        .expect_err("no machine has that much memory");
    assert_is!(error, Error::OutOfMemory { .. });
    assert_says(&error, &["the universe", "1152921504606846976 bytes"]);
    // The device still works.
    assert!(gpu.zeroed::<u32>("a little", 4).is_ok());
}

/// The practical's "too many resources requested for launch".
#[test]
fn launch_limits() {
    if skips("launch_limits") {
        return;
    }
    for adapter in all_adapters() {
        let limits = wgpu::Limits {
            max_compute_invocations_per_workgroup: 32,
            max_compute_workgroups_per_dimension: 1000,
            ..adapter.limits()
        };
        let gpu = open_with_limits(adapter, limits);
        let error = gpu
            .kernel(&kernel_f32(), "trace_rays", &TRACE_RAYS)
            .expect_err("64 threads do not fit 32");
        assert_is!(
            error,
            Error::LaunchLimits {
                asked: 64,
                limit: 32,
                ..
            }
        );
        assert_says(&error, &["trace_rays", "threads in a workgroup"]);
    }
    for gpu in gpus() {
        let kernel = trace_rays(gpu);
        let error = gpu
            .launch(&kernel, &[], [u32::MAX, 1, 1])
            .expect_err("no device allows that many");
        assert_is!(error, Error::LaunchLimits { .. });
        assert_says(&error, &["workgroups", "4294967295"]);
    }
}

#[test]
fn validation() {
    if skips("validation") {
        return;
    }
    for gpu in gpus() {
        let kernel = trace_rays(gpu);
        let rays = gpu.upload("rays", &[Ray::default()]).expect("rays");
        let error = gpu
            .launch(&kernel, &[rays.binding()], [1, 1, 1])
            .expect_err("two buffers are missing");
        assert_is!(error, Error::Validation { .. });
        assert_says(&error, &["trace_rays"]);
        // The device still works, and accepts the launch when all buffers are bound.
        let spheres = gpu
            .upload("spheres", &[Sphere::default()])
            .expect("spheres");
        let hits = gpu.zeroed::<Hit>("hits", 1).expect("hits");
        let bindings = [rays.binding(), spheres.binding(), hits.binding()];
        gpu.launch(&kernel, &bindings, [1, 1, 1])
            .expect("all buffers are bound");
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
            gpu.read(&rays).expect_err("the device is lost"),
            gpu.upload("more", &[1_u32])
                .expect_err("the device is lost"),
        ] {
            assert_is!(error, Error::DeviceLost { .. });
            assert_says(&error, &[gpu.name(), "destroyed"]);
        }
        let error = render(&scene, Shading::Flat, &Device::Gpu(Box::new(gpu)), QUIET)
            .expect_err("the device is lost");
        assert_is!(error, Error::DeviceLost { .. });
    }
}

#[test]
fn timeout() {
    if skips("timeout") {
        return;
    }
    for adapter in all_adapters() {
        let gpu = with_timeout(adapter, Duration::from_nanos(1));
        let kernel = trace_rays(&gpu);
        // Milliseconds of work on a fast GPU, and less than a minute on a software one.
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
            .expect_err("no device finishes in a nanosecond");
        assert_is!(error, Error::Timeout { .. });
        assert_says(&error, &["trace_rays", gpu.name()]);
    }
}

/// Pixels that no thread wrote, as after a panic on the device: noop runs no threads.
#[test]
fn readback() {
    let mut scene = Scene::load("scenes/two-spheres.toml").expect("the scene");
    (scene.width, scene.height) = (16, 9);
    let error = render(&scene, Shading::Flat, &Device::Gpu(Box::new(noop())), QUIET)
        .expect_err("nothing was written");
    assert_is!(error, Error::Readback { .. });
    assert_says(&error, &["144 of 144 pixels"]);
}

/// A device refuses the buffers and kernels of another, although wgpu numbers the buffers of two
/// instances alike.
#[test]
fn objects_of_another_device_are_refused() {
    if skips("objects_of_another_device_are_refused") {
        return;
    }
    let open = || Gpu::open(&DeviceChoice::Gpu).expect("a device");
    let (one, other) = (open(), open());
    let of_one = one.upload("numbers of one", &[1_u32; 4]).expect("room");
    let of_other = other.upload("numbers", &[2_u32; 4]).expect("room");
    let uniform = one.upload_uniform("uniform of one", &1_u32).expect("room");
    let module = kernel_f32();
    let access = [Access::Read, Access::ReadWrite];
    let kernel = one
        .kernel(&module, "measure_copying", &access)
        .expect("a kernel");
    let again = other
        .kernel(&module, "measure_copying", &access)
        .expect("a kernel");
    let bindings = [of_other.binding(), of_other.binding()];
    for error in [
        other.read(&of_one).expect_err("of another"),
        other.clear(&of_one).expect_err("of another"),
        other.update(&uniform, &3).expect_err("of another"),
        other
            .launch(&kernel, &bindings, [1, 1, 1])
            .expect_err("of another"),
        other
            .launch(&again, &[of_one.binding(), of_other.binding()], [1, 1, 1])
            .expect_err("of another"),
    ] {
        assert_is!(error, Error::Validation { .. });
        assert_says(&error, &["another device"]);
    }
    assert_eq!(other.read(&of_other).expect("numbers"), [2; 4]);
}

/// The accesses that a caller declares are compared with those in the module, because the driver
/// does not check them.
#[test]
fn accesses_are_those_of_the_module() {
    let module = kernel_f32();
    let gpu = noop();
    let (read, write) = (Access::Read, Access::ReadWrite);
    for (entry, said) in [
        ("trace_rays", &[][..]),
        ("trace_rays", &[read, read]),
        ("trace_rays", &[Access::Uniform; 3]),
        ("trace_rays", &[read, read, read]),
        ("trace_rays", &[read, write, write]),
    ] {
        let error = gpu
            .kernel(&module, entry, said)
            .expect_err("the accesses differ");
        assert_is!(error, Error::KernelInvalid { .. });
        assert_says(&error, &[entry, "binding"]);
    }
    for gpu in gpus() {
        let kernel = gpu
            .kernel(&module, "measure_copying", &[read, write])
            .expect("a kernel");
        let both = gpu.upload("both", &[[1.0_f32; 4]; 64]).expect("room");
        let error = gpu
            .launch(&kernel, &[both.binding(), both.binding()], [1, 1, 1])
            .expect_err("one buffer is read and written");
        assert_is!(error, Error::Validation { .. });
    }
}

/// The words of a SPIR-V instruction.
fn instruction(opcode: u32, operands: &[u32]) -> Vec<u32> {
    let mut words = vec![(operands.len() as u32 + 1) << 16 | opcode];
    words.extend(operands);
    words
}

fn module_of(name: &str, words: &[u32]) -> Module {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    Module::from_bytes(name, &bytes).expect("the structure is sound")
}

/// No kernel sees what another left in workgroup memory.
#[test]
fn workgroup_memory_is_zeroed() {
    let [peek, fill] = [b"peek", b"fill"].map(|name| u32::from_le_bytes(*name));
    let words = [
        vec![0x0723_0203, 0x0001_0300, 0, 100, 0],
        instruction(17, &[1]),
        instruction(14, &[0, 1]),
        instruction(15, &[5, 14, peek, 0]),
        instruction(15, &[5, 15, fill, 0]),
        instruction(16, &[14, 17, 1, 1, 1]),
        instruction(16, &[15, 17, 1, 1, 1]),
        // The buffer's decorations: stride, block, offset, set and binding.
        instruction(71, &[6, 6, 4]),
        instruction(71, &[7, 2]),
        instruction(72, &[7, 0, 35, 0]),
        instruction(71, &[9, 34, 0]),
        instruction(71, &[9, 33, 0]),
        instruction(19, &[2]),
        instruction(21, &[3, 32, 0]),
        // The word in workgroup memory.
        instruction(32, &[4, 4, 3]),
        instruction(59, &[4, 5, 4]),
        instruction(29, &[6, 3]),
        instruction(30, &[7, 6]),
        instruction(32, &[8, 12, 7]),
        instruction(59, &[8, 9, 12]),
        instruction(32, &[10, 12, 3]),
        instruction(43, &[3, 11, 0]),
        instruction(43, &[3, 12, 0xdead_beef]),
        instruction(33, &[13, 2]),
        // `peek` copies the word to the buffer.
        instruction(54, &[2, 14, 0, 13]),
        instruction(248, &[20]),
        instruction(61, &[3, 21, 5]),
        instruction(65, &[10, 22, 9, 11, 11]),
        instruction(62, &[22, 21]),
        instruction(253, &[]),
        instruction(56, &[]),
        // `fill` writes the constant to both.
        instruction(54, &[2, 15, 0, 13]),
        instruction(248, &[30]),
        instruction(62, &[5, 12]),
        instruction(65, &[10, 31, 9, 11, 11]),
        instruction(62, &[31, 12]),
        instruction(253, &[]),
        instruction(56, &[]),
    ]
    .concat();
    let module = module_of("memory", &words);
    for gpu in gpus() {
        let [peek, fill] = ["peek", "fill"].map(|entry| {
            gpu.kernel(&module, entry, &[Access::ReadWrite])
                .expect("a kernel")
        });
        let word = gpu.zeroed::<u32>("word", 1).expect("room");
        for round in 0..8 {
            gpu.launch(&fill, &[word.binding()], [64, 1, 1])
                .expect("a launch");
            assert_eq!(gpu.read(&word).expect("a word"), [0xdead_beef]);
            gpu.launch(&peek, &[word.binding()], [64, 1, 1])
                .expect("a launch");
            assert_eq!(
                gpu.read(&word).expect("a word"),
                [0],
                "{} {round}",
                gpu.name()
            );
        }
    }
}

/// naga panics on a switch over a boolean.
#[test]
fn a_module_that_naga_panics_on_is_invalid() {
    let main = u32::from_le_bytes(*b"main");
    let words = [
        vec![0x0723_0203, 0x0001_0300, 0, 100, 0],
        instruction(17, &[1]),
        instruction(14, &[0, 1]),
        instruction(15, &[5, 7, main, 0]),
        instruction(16, &[7, 17, 1, 1, 1]),
        instruction(19, &[2]),
        instruction(20, &[4]),
        instruction(33, &[3, 2]),
        instruction(41, &[4, 5]),
        instruction(54, &[2, 7, 0, 3]),
        instruction(248, &[8]),
        instruction(247, &[9, 0]),
        instruction(251, &[5, 9]),
        instruction(248, &[9]),
        instruction(253, &[]),
        instruction(56, &[]),
    ]
    .concat();
    let module = module_of("switch", &words);
    for gpu in gpus() {
        let error = gpu.kernel(&module, "main", &[]).expect_err("naga panics");
        assert_is!(error, Error::KernelInvalid { .. });
        assert_says(&error, &["switch/main"]);
        assert_eq!(
            gpu.read(&gpu.upload("after", &[1_u32]).expect("room"))
                .expect("it works"),
            [1]
        );
    }
}

#[test]
fn more_elements_than_can_be_counted_are_too_large() {
    for len in [usize::MAX, usize::MAX / 4 + 1, 1 << 62] {
        let error = noop().zeroed::<u32>("many", len).expect_err("too many");
        assert_is!(error, Error::BufferTooLarge { .. });
    }
}

/// After a launch that does not end in time, the device still works: the next launch runs when that
/// one has ended.
#[test]
fn launches_go_on_after_a_timeout() {
    if skips("launches_go_on_after_a_timeout") {
        return;
    }
    for adapter in all_adapters() {
        let gpu = with_timeout(adapter, Duration::from_millis(20));
        let kernel = trace_rays(&gpu);
        let ray = Ray::new(glam::Vec3::ZERO, glam::Vec3::X);
        let rays = gpu.upload("rays", &vec![ray; 1 << 16]).expect("rays");
        let hits = gpu.zeroed::<Hit>("hits", 1 << 16).expect("hits");
        let mut count = 1 << 10;
        let is_late = (0..8).any(|_| {
            let sphere = Sphere::new(glam::Vec3::X, 0.1);
            let spheres = gpu
                .upload("spheres", &vec![sphere; count])
                .expect("spheres");
            count *= 4;
            let bindings = [rays.binding(), spheres.binding(), hits.binding()];
            gpu.launch(&kernel, &bindings, [1 << 10, 1, 1]).is_err()
        });
        assert!(is_late, "{}", gpu.name());
        let sphere = Sphere::new(glam::Vec3::X, 0.1);
        let spheres = gpu.upload("spheres", &[sphere]).expect("spheres");
        let bindings = [rays.binding(), spheres.binding(), hits.binding()];
        let mut last = None;
        for _ in 0..1000 {
            match gpu.launch(&kernel, &bindings, [1, 1, 1]) {
                Ok(_) => {
                    last = None;
                    break;
                }
                // The device is still busy.
                Err(error @ Error::Timeout { .. }) => last = Some(error),
                Err(error) => panic!("{error:?}"),
            }
        }
        assert!(last.is_none(), "{last:?}");
    }
}

/// A batch of another tracer may name spheres that this tracer does not have. Those are not
/// reported as hits.
#[test]
fn hits_of_another_tracers_batch_are_dropped() {
    for gpu in gpus() {
        let row = |count: u32| -> Vec<Sphere> {
            (0..count)
                .map(|x| Sphere::new(glam::Vec3::new(x as f32, 0.0, -5.0), 0.4))
                .collect()
        };
        let tracer =
            |count| GpuTracer::new(gpu, &row(count), Acceleration::Tree).expect("a tracer");
        let (large, small) = (tracer(1000), tracer(20));
        let ray = Ray::new(glam::Vec3::new(900.0, 0.0, 0.0), glam::Vec3::NEG_Z);
        let batch = large.upload(&[ray]).expect("rays");
        large.nearest(Rung::Robust, &batch).expect("hits");
        assert_eq!(large.hits(&batch).expect("hits")[0].sphere, 900);
        assert!(!small.hits(&batch).expect("hits")[0].is_some());
    }
}

/// The sizes of a launch, which a program may change, are checked before any light path is traced.
#[test]
fn launches_outside_the_image_are_refused() {
    let mut scene = Scene::load("scenes/soft-light.toml").expect("a scene");
    (scene.width, scene.height) = (16, 9);
    let effects = spherule::render::EffectChoice::Auto;
    let plain = paths::Prepared::new(&scene, effects, Acceleration::Auto).expect("a scene");
    let settings = Settings::default().time_limit(Duration::from_secs(1));
    let (size, none) = (plain.launch.image_size, glam::UVec2::ZERO);
    for (image, tile, origin) in [
        (size, none, none),
        (size, glam::UVec2::new(0, 9), none),
        (none, none, none),
        (glam::UVec2::new(0, 9), glam::UVec2::new(0, 9), none),
        (size, glam::UVec2::new(16, 4), none),
        (size, size, glam::UVec2::new(0, 1)),
        (glam::UVec2::MAX, glam::UVec2::MAX, none),
    ] {
        let mut prepared = plain.clone();
        prepared.launch.image_size = image;
        prepared.launch.tile_size = tile;
        prepared.launch.tile_origin = origin;
        let on_cpu = paths::cpu::render(&prepared, &settings, QUIET);
        let on_gpus = gpus()
            .iter()
            .map(|gpu| paths::gpu::render(gpu, &prepared, &settings, QUIET));
        for rendered in std::iter::once(on_cpu).chain(on_gpus) {
            let error = rendered.err().expect("the sizes are wrong");
            assert_is!(error, Error::Scene(_));
        }
    }
}

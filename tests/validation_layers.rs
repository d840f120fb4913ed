//! Renders under the Vulkan validation layers, which must report nothing.
//!
//! This test has its own process, because the layers report to the global logger.

mod common;

use std::sync::{Mutex, PoisonError};

use common::{all_adapters, device, open, skips};
use spherule::device::GpuOptions;
use spherule::kernel::{Ray, Shading};
use spherule::render::{QUIET, render};
use spherule::{Scene, wgpu};

static MESSAGES: Mutex<Vec<String>> = Mutex::new(Vec::new());
static LAYER_MISSING: Mutex<bool> = Mutex::new(false);

struct Recorder;

impl log::Log for Recorder {
    fn enabled(&self, _: &log::Metadata<'_>) -> bool {
        true
    }

    fn log(&self, record: &log::Record<'_>) {
        if record.target() != "wgpu_hal::vulkan::instance" {
            return;
        }
        let text = record.args().to_string();
        if text.contains("unable to find layer") {
            *LAYER_MISSING.lock().unwrap_or_else(PoisonError::into_inner) = true;
        }
        if record.level() <= log::Level::Warn {
            MESSAGES
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .push(text);
        }
    }

    fn flush(&self) {}
}

fn take_messages() -> Vec<String> {
    std::mem::take(&mut *MESSAGES.lock().unwrap_or_else(PoisonError::into_inner))
}

#[test]
fn the_validation_layers_report_nothing() {
    // wgpu reads the log level when the instance is created, and enables the layers by these
    // variables. SAFETY: this process has one test, and no other thread reads the environment yet.
    unsafe {
        std::env::set_var("WGPU_VALIDATION", "1");
        std::env::set_var("WGPU_DEBUG", "1");
    }
    log::set_logger(&Recorder).expect("no other logger");
    log::set_max_level(log::LevelFilter::Debug);
    if skips("the_validation_layers_report_nothing") {
        return;
    }
    if *LAYER_MISSING.lock().unwrap_or_else(PoisonError::into_inner) {
        assert!(
            std::env::var_os("SPHERULE_REQUIRE_GPU").is_none_or(|value| value == "0"),
            "SPHERULE_REQUIRE_GPU is set and there are no validation layers"
        );
        eprintln!(
            "SKIPPED: there are no validation layers; Debian's package vulkan-validationlayers has them"
        );
        return;
    }

    for adapter in all_adapters() {
        let device = device(adapter);
        for name in ["two-spheres", "still-life"] {
            let mut scene = Scene::load(format!("scenes/{name}.toml")).expect("the scene");
            (scene.width, scene.height) = (64, 36);
            scene.sampling.samples = scene.sampling.samples.map(|_| 1);
            for shading in [Shading::Lit, Shading::Depth] {
                render(&scene, shading, &device, QUIET).expect("it renders");
            }
        }
        let said = take_messages();
        assert!(said.is_empty(), "{}: {said:#?}", adapter.get_info().name);
    }

    // The twin: the layers must report a module whose SPIR-V is wrong. Its `Offset` of
    // `Ray::direction` is moved off the 16-byte boundary.
    for adapter in all_adapters() {
        if !adapter
            .features()
            .contains(wgpu::Features::PASSTHROUGH_SHADERS)
        {
            continue;
        }
        let gpu = open(adapter, GpuOptions::default());
        let mut words = spherule::kernel_module::f32()
            .expect("the kernel")
            .words()
            .to_vec();
        let direction = std::mem::offset_of!(Ray, direction) as u32;
        const MEMBER_DECORATE: u32 = 72;
        const OFFSET: u32 = 35;
        let mut at = 5;
        while at < words.len() {
            if words[at] & 0xffff == MEMBER_DECORATE
                && words[at + 3] == OFFSET
                && words[at + 4] == direction
            {
                words[at + 4] = direction + 1;
            }
            at += (words[at] >> 16) as usize;
        }
        let module =
            spherule::device::Module::from_bytes("misaligned", bytemuck::cast_slice(&words))
                .expect("the structure is sound");
        // SAFETY: only a member's alignment is wrong, and the layers check the module before the
        // driver.
        let module = unsafe { module.trusted() };
        use spherule::device::Access::{Read, ReadWrite};
        let _ = gpu.kernel(&module, "trace_rays", &[Read, Read, ReadWrite]);
        assert!(
            !take_messages().is_empty(),
            "the layers did not report a misaligned member"
        );
    }
}

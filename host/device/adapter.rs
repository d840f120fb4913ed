//! Lists adapters and chooses one.

use serde::Serialize;

use super::choice::DeviceChoice;
use crate::error::{Error, Result};
use crate::memory;
use crate::shown::shown;

/// The properties of an adapter.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct AdapterReport {
    /// The adapter's name, as its driver gives it.
    pub name: String,
    /// `discrete`, `integrated`, `virtual`, `software` or `other`.
    pub kind: &'static str,
    /// The graphics interface: `vulkan`, `metal` or `dx12`.
    pub api: String,
    /// The driver's name and version.
    pub driver: String,
    /// Whether SPIR-V is passed to the driver unchanged, rather than through naga.
    pub passthrough: bool,
    /// Whether kernels may use 64-bit floats.
    pub f64: bool,
    /// Whether GPU time can be measured.
    pub timestamps: bool,
    /// The largest buffer, in bytes.
    pub max_buffer: u64,
    /// The largest part of a buffer that a kernel can bind, in bytes.
    pub max_binding: u64,
    /// The most threads in a workgroup.
    pub max_workgroup: u32,
    /// Whether `auto` may choose it.
    pub real_gpu: bool,
}

impl AdapterReport {
    fn of(adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        let limits = adapter.limits();
        let features = adapter.features();
        Self {
            kind: match info.device_type {
                wgpu::DeviceType::DiscreteGpu => "discrete",
                wgpu::DeviceType::IntegratedGpu => "integrated",
                wgpu::DeviceType::VirtualGpu => "virtual",
                wgpu::DeviceType::Cpu => "software",
                wgpu::DeviceType::Other => "other",
            },
            api: info.backend.to_string().to_lowercase(),
            driver: driver(&info),
            passthrough: takes_spirv(adapter),
            f64: features.contains(wgpu::Features::SHADER_F64),
            timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
            max_buffer: limits.max_buffer_size,
            max_binding: limits.max_storage_buffer_binding_size,
            max_workgroup: limits.max_compute_invocations_per_workgroup,
            real_gpu: rank(&info) < SOFTWARE_RANK,
            name: shown(&info.name).into_owned(),
        }
    }
}

/// The name and version of the adapter's driver.
pub(super) fn driver(info: &wgpu::AdapterInfo) -> String {
    format!("{} {}", info.driver, info.driver_info)
        .trim()
        .into()
}

/// Whether the adapter's driver takes SPIR-V unchanged.
pub(super) fn takes_spirv(adapter: &wgpu::Adapter) -> bool {
    adapter.get_info().backend == wgpu::Backend::Vulkan
        && adapter
            .features()
            .contains(wgpu::Features::PASSTHROUGH_SHADERS)
}

const SOFTWARE_RANK: u32 = 3;

/// The order of preference, the best first.
fn rank(info: &wgpu::AdapterInfo) -> u32 {
    match info.device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Cpu | wgpu::DeviceType::Other => SOFTWARE_RANK,
    }
}

/// The memory, in bytes, that loading drivers takes if memory is limited. With less, lavapipe (Mesa
/// 22.3) may read through invalid pointers.
const FOR_DRIVERS: u64 = 480 << 20;

/// An instance with the graphics interfaces of this system; with none if memory is limited (`ulimit
/// -v`, `ulimit -d`) to less than drivers take.
#[must_use]
pub fn instance() -> wgpu::Instance {
    // No VALIDATION_INDIRECT_CALL: spherule dispatches nothing indirectly, and the check would
    // cap buffers at 4 GiB. `with_env` lets WGPU_VALIDATION and WGPU_DEBUG turn checks on.
    let flags = wgpu::InstanceFlags::empty().with_env();
    let has_room = memory::limit().is_none() || memory::check(FOR_DRIVERS, "drivers").is_ok();
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: if has_room {
            wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12
        } else {
            wgpu::Backends::empty()
        },
        flags,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    })
}

/// Every adapter of this system, the preferred ones first.
#[must_use]
pub fn adapters(instance: &wgpu::Instance) -> Vec<wgpu::Adapter> {
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    adapters.sort_by_key(|adapter| rank(&adapter.get_info()));
    for adapter in &adapters {
        let info = adapter.get_info();
        tracing::debug!(
            "found {} ({:?}, {}), driver {} {}",
            info.name,
            info.device_type,
            info.backend,
            info.driver,
            info.driver_info
        );
    }
    adapters
}

/// The properties of every adapter of this system, the preferred ones first.
#[must_use]
pub fn list_adapters() -> Vec<AdapterReport> {
    adapters(&instance())
        .iter()
        .map(AdapterReport::of)
        .collect()
}

/// If memory is limited, a clause for the end of a message: a driver may fail to load or work
/// because of it. Software adapters take half a gigabyte of addresses and more.
pub(super) fn memory_limit() -> String {
    memory::limit().map_or(String::new(), |bytes| {
        format!(
            "; this process may use {} MiB of memory (ulimit -v, ulimit -d), and a driver may need more",
            bytes >> 20
        )
    })
}

/// If the process can start no more threads, a clause for the end of a message: drivers start
/// threads of their own.
pub(super) fn threads_limit() -> &'static str {
    match std::thread::Builder::new().spawn(|| ()) {
        Ok(thread) => {
            // The thread does nothing that could panic.
            let _ = thread.join();
            ""
        }
        Err(_) => "; the system starts no more threads (ulimit -u), and a driver may need threads",
    }
}

/// The adapter that `choice` selects, or `None` for the CPU; with the reason in a few words.
///
/// # Errors
///
/// [`Error::NoAdapter`] if a GPU was requested and there is no adapter, [`Error::NoSuchAdapter`] if
/// none has that name.
pub(super) fn choose(choice: &DeviceChoice) -> Result<(Option<wgpu::Adapter>, String)> {
    if *choice == DeviceChoice::Cpu {
        return Ok((None, "requested".into()));
    }
    let mut adapters = adapters(&instance());
    let position = match choice {
        DeviceChoice::Named(part) => {
            let part = part.to_lowercase();
            adapters
                .iter()
                .position(|adapter| adapter.get_info().name.to_lowercase().contains(&part))
        }
        DeviceChoice::Auto => adapters
            .iter()
            .position(|adapter| rank(&adapter.get_info()) < SOFTWARE_RANK),
        DeviceChoice::Gpu | DeviceChoice::Cpu => (!adapters.is_empty()).then_some(0),
    };
    match position {
        Some(position) => {
            let reason = match choice {
                DeviceChoice::Auto => "the first real GPU",
                DeviceChoice::Gpu if rank(&adapters[position].get_info()) >= SOFTWARE_RANK => {
                    "requested; a software adapter, as there is no real GPU"
                }
                _ => "requested",
            };
            Ok((Some(adapters.swap_remove(position)), reason.into()))
        }
        None if *choice == DeviceChoice::Auto => Ok((None, "there is no real GPU".into())),
        None => {
            let found: Vec<String> = adapters
                .iter()
                .map(|adapter| shown(&adapter.get_info().name).into_owned())
                .collect();
            let wanted = match choice {
                DeviceChoice::Named(name) if !found.is_empty() => {
                    let name = shown(name).into_owned();
                    return Err(Error::NoSuchAdapter { name, found });
                }
                // The name may be right, and only the driver is missing.
                DeviceChoice::Named(name) => {
                    format!("has a name that contains \"{}\"", shown(name))
                }
                DeviceChoice::Auto | DeviceChoice::Gpu | DeviceChoice::Cpu => "was found".into(),
            };
            Err(Error::NoAdapter {
                wanted,
                found: format!(
                    "this system has no graphics driver that wgpu can use{}",
                    memory_limit()
                ),
            })
        }
    }
}

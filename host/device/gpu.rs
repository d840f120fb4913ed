//! [`Gpu`]: a device that runs kernels, with every failure an [`Error`].
//!
//! ```no_run
//! use spherule::device::{Access, DeviceChoice, Gpu, Module};
//! # fn main() -> spherule::Result<()> {
//! # let spirv: &[u8] = &[];
//! let gpu = Gpu::open(&DeviceChoice::Gpu)?;
//! let module = Module::from_bytes("doubler", spirv)?;
//! let kernel = gpu.kernel(&module, "double_all", &[Access::ReadWrite])?;
//! let numbers = gpu.upload("numbers", &[1.0_f32, 2.0, 3.0])?;
//! gpu.launch(&kernel, &[numbers.binding()], [1, 1, 1])?;
//! assert_eq!(gpu.read(&numbers)?, [2.0, 4.0, 6.0]);
//! # Ok(()) }
//! ```

use std::borrow::Cow;
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use bytemuck::Pod;

use super::adapter;
use super::buffer::{Access, Binding, Buffer, Owner};
use super::choice::DeviceChoice;
use super::errors::{Watch, caught, one_line};
use super::kernel::{Kernel, LaunchTime};
use super::mapping::{LATE, map};
use super::spirv::Module;
use super::timer::Timer;
use crate::error::{Error, Result};
use crate::memory;
use crate::shown::shown;

/// How a device is opened; for tests and for odd drivers.
#[derive(Clone, Debug)]
pub struct GpuOptions {
    /// The limits to ask for; `None` asks for all that the adapter has.
    pub limits: Option<wgpu::Limits>,
    /// Hand kernels to naga even where the driver would take SPIR-V as it is.
    pub through_naga: bool,
    /// How long a single launch may take before it counts as hung.
    pub timeout: Duration,
}

impl Default for GpuOptions {
    fn default() -> Self {
        Self {
            limits: None,
            through_naga: false,
            timeout: Duration::from_secs(120),
        }
    }
}

/// What one readback moves at most: it takes as much of the host's memory once more.
const READBACK_BYTES: usize = 1 << 26;

/// A GPU, or a software stand-in for one, ready to run kernels.
#[derive(Debug)]
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    name: String,
    is_software: bool,
    passthrough: bool,
    timeout: Duration,
    /// Locked while a launch uses it: there is one pair of timestamps.
    timer: Option<Mutex<Timer>>,
    watch: Watch,
    /// What was compiled so far; drivers keep it on disk, for the next process.
    kernels: Mutex<HashMap<KernelKey, Kernel>>,
    /// What is made here bears it.
    owner: Owner,
}

/// What a compiled kernel depends on: a digest of the module's words, as they were specialised, whether
/// the driver takes them unseen, the entry point, and its bindings.
type KernelKey = (u64, bool, String, Vec<Access>);

impl Gpu {
    /// Opens the adapter that `choice` means.
    ///
    /// # Errors
    ///
    /// [`Error::NoAdapter`] if there is none ([`DeviceChoice::Auto`] takes no software adapter,
    /// [`DeviceChoice::Cpu`] no adapter at all), [`Error::NoSuchAdapter`] if none has that name, [`Error::DeviceRefused`] if it does not open.
    pub fn open(choice: &DeviceChoice) -> Result<Self> {
        let (adapter, _) = adapter::choose(choice)?;
        let adapter = adapter.ok_or_else(|| Error::NoAdapter {
            wanted: format!("follows from the choice \"{choice}\""),
            found: "it means the CPU here".into(),
        })?;
        Self::from_adapter(&adapter, GpuOptions::default())
    }

    /// Opens this adapter.
    ///
    /// # Errors
    ///
    /// [`Error::DeviceRefused`] with the driver's reason.
    pub fn from_adapter(adapter: &wgpu::Adapter, options: GpuOptions) -> Result<Self> {
        let info = adapter.get_info();
        let is_software = info.device_type == wgpu::DeviceType::Cpu;
        let name = shown(&info.name).into_owned();
        let passthrough = adapter::takes_spirv(adapter) && !options.through_naga;
        let mut wanted = wgpu::Features::SHADER_F64 | wgpu::Features::TIMESTAMP_QUERY;
        if passthrough {
            wanted |= wgpu::Features::PASSTHROUGH_SHADERS;
        }
        let features = wanted & adapter.features();
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("spherule"),
            required_features: features,
            required_limits: options.limits.unwrap_or_else(|| adapter.limits()),
            ..Default::default()
        }))
        .map_err(|error| Error::DeviceRefused {
            adapter: name.clone(),
            reason: one_line(&error) + &adapter::memory_limit() + adapter::threads_limit(),
        })?;
        let watch = Watch::over(&device, &name);
        let timer = if features.contains(wgpu::Features::TIMESTAMP_QUERY) {
            Some(Mutex::new(watch.checked(
                &device,
                "making timestamp queries",
                || Timer::new(&device, &queue),
            )?))
        } else {
            None
        };
        Ok(Self {
            device,
            queue,
            name,
            is_software,
            passthrough,
            timeout: options.timeout,
            timer,
            watch,
            kernels: Mutex::default(),
            owner: Owner::new(),
        })
    }

    /// The adapter's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether the adapter is a program on the CPU.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.is_software
    }

    /// Whether SPIR-V reaches the driver as it is, rather than through naga.
    #[must_use]
    pub fn passes_spirv_through(&self) -> bool {
        self.passthrough
    }

    /// Whether kernels may use 64-bit floats.
    #[must_use]
    pub fn has_f64(&self) -> bool {
        self.device.features().contains(wgpu::Features::SHADER_F64)
    }

    /// What the device can do, as it was opened.
    #[must_use]
    pub fn limits(&self) -> wgpu::Limits {
        self.device.limits()
    }

    /// Row upon row of workgroups, where they are more than fit one.
    #[must_use]
    pub fn rows_of(&self, workgroups: u32) -> [u32; 3] {
        let row = self.limits().max_compute_workgroups_per_dimension.max(1);
        [workgroups.min(row), workgroups.div_ceil(row), 1]
    }

    /// Gives the device up: every later call fails with [`Error::DeviceLost`].
    pub fn destroy(&self) {
        self.device.destroy();
        // The callback that records the loss runs inside a poll.
        let _ = self.device.poll(wgpu::PollType::Poll);
    }

    /// Compiles an entry point of `module`, unless this device has done so before; `bindings` says how it uses descriptor set 0, from
    /// binding 0 upwards.
    ///
    /// # Errors
    ///
    /// [`Error::KernelInvalid`] if there is no such entry point, the device lacks what the
    /// module needs, or the driver does not take it; [`Error::LaunchLimits`] if a workgroup has
    /// more threads than the device can run.
    pub fn kernel(
        &self,
        module: &Module,
        entry_point: &str,
        bindings: &[Access],
    ) -> Result<Kernel> {
        let invalid = |reason: String| Error::KernelInvalid {
            kernel: format!("{}/{entry_point}", module.name()),
            reason,
        };
        let entry = module
            .entry_points()
            .iter()
            .find(|entry| entry.name == entry_point)
            .ok_or_else(|| {
                let names: Vec<&str> = module
                    .entry_points()
                    .iter()
                    .map(|entry| entry.name.as_str())
                    .collect();
                invalid(format!(
                    "the module has no such entry point, it has {}",
                    names.join(", ")
                ))
            })?;
        if module.needs_f64() && !self.has_f64() {
            return Err(invalid(format!(
                "it needs 64-bit floats, which {} lacks",
                self.name
            )));
        }
        self.check_workgroup(entry_point, entry.workgroup_size)?;
        let mut hasher = DefaultHasher::new();
        module.words().hash(&mut hasher);
        let key = (
            hasher.finish(),
            module.is_trusted(),
            entry_point.to_owned(),
            bindings.to_vec(),
        );
        let kernels = || self.kernels.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kernel) = kernels().get(&key) {
            return Ok(kernel.clone());
        }

        let module = &if module.is_trusted() {
            let only = module.only(entry_point);
            check_bindings(&only, bindings).map_err(invalid)?;
            only
        } else {
            module.clone()
        };
        let during = format!("compiling the kernel {entry_point}");
        let started = Instant::now();
        // naga panics on some modules.
        let of_module = |error| match error {
            Error::Validation { reason, .. } => invalid(reason),
            other => other,
        };
        let shader = self
            .watch
            .checked(&self.device, &during, || {
                caught(|| self.shader_module(module))
            })
            .map_err(of_module)?
            .map_err(|reason| invalid(one_line(&reason)))?;
        let made = self.watch.checked(&self.device, &during, || {
            let layout = self.bind_group_layout(entry_point, bindings);
            let pipeline_layout =
                self.device
                    .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                        label: Some(entry_point),
                        bind_group_layouts: &[Some(&layout)],
                        immediate_size: 0,
                    });
            let pipeline = self
                .device
                .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(entry_point),
                    layout: Some(&pipeline_layout),
                    module: &shader,
                    entry_point: Some(entry_point),
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: &[],
                        // What another kernel left there is not for everybody's.
                        zero_initialize_workgroup_memory: !module.is_trusted(),
                    },
                    cache: None,
                });
            (pipeline, layout)
        });
        let (pipeline, layout) = made.map_err(of_module)?;
        tracing::debug!(
            "compiled {entry_point} of {}, {} KiB of SPIR-V: {:.1?}",
            module.name(),
            module.words().len() * 4 / 1024,
            started.elapsed()
        );
        let kernel = Kernel {
            name: entry_point.into(),
            pipeline,
            layout,
            workgroup_size: entry.workgroup_size,
            owner: self.owner,
        };
        kernels().insert(key, kernel.clone());
        Ok(kernel)
    }

    fn shader_module(&self, module: &Module) -> wgpu::ShaderModule {
        if !(self.passthrough && module.is_trusted()) {
            return self
                .device
                .create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(module.name()),
                    source: wgpu::ShaderSource::SpirV(Cow::Borrowed(module.words())),
                });
        }
        let entry_points = module
            .entry_points()
            .iter()
            .map(|entry| wgpu::PassthroughShaderEntryPoint {
                name: Cow::Borrowed(entry.name.as_str()),
                workgroup_size: entry.workgroup_size.into(),
            })
            .collect();
        // SAFETY: the words reach the driver unseen by wgpu; whoever called `Module::trusted`
        // promised that they are valid Vulkan SPIR-V.
        unsafe {
            self.device
                .create_shader_module_passthrough(wgpu::ShaderModuleDescriptorPassthrough {
                    label: Some(module.name()),
                    entry_points,
                    spirv: Some(Cow::Borrowed(module.words())),
                    ..Default::default()
                })
        }
    }

    fn bind_group_layout(&self, label: &str, bindings: &[Access]) -> wgpu::BindGroupLayout {
        let entries: Vec<wgpu::BindGroupLayoutEntry> = bindings
            .iter()
            .zip(0..)
            .map(|(access, binding)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer {
                    ty: match access {
                        Access::Uniform => wgpu::BufferBindingType::Uniform,
                        Access::Read => wgpu::BufferBindingType::Storage { read_only: true },
                        Access::ReadWrite => wgpu::BufferBindingType::Storage { read_only: false },
                    },
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            })
            .collect();
        self.device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(label),
                entries: &entries,
            })
    }

    /// Uploads `data` into storage. An empty slice becomes one element all of whose bits are set,
    /// because there are no empty buffers: a float in it is a NaN, and a sphere in it is missed.
    ///
    /// # Errors
    ///
    /// [`Error::BufferTooLarge`], [`Error::OutOfMemory`], [`Error::DeviceLost`].
    pub fn upload<T: Pod>(&self, label: &str, data: &[T]) -> Result<Buffer<T>> {
        self.filled(label, data, wgpu::BufferUsages::STORAGE)
    }

    /// Uploads one value into uniform memory; [`Gpu::update`] changes it.
    ///
    /// # Errors
    ///
    /// As [`Gpu::upload`].
    pub fn upload_uniform<T: Pod>(&self, label: &str, value: &T) -> Result<Buffer<T>> {
        self.filled(
            label,
            std::slice::from_ref(value),
            wgpu::BufferUsages::UNIFORM,
        )
    }

    /// Overwrites a uniform.
    ///
    /// # Errors
    ///
    /// [`Error::Validation`], [`Error::DeviceLost`].
    pub fn update<T: Pod>(&self, buffer: &Buffer<T>, value: &T) -> Result<()> {
        let during = format!("updating {}", buffer.label);
        self.check_owner(buffer.owner, &buffer.label, &during)?;
        self.watch.checked(&self.device, &during, || {
            self.queue
                .write_buffer(&buffer.raw, 0, bytemuck::bytes_of(value));
        })
    }

    /// Storage for `len` elements, all zeros.
    ///
    /// # Errors
    ///
    /// As [`Gpu::upload`].
    pub fn zeroed<T: Pod>(&self, label: &str, len: usize) -> Result<Buffer<T>> {
        let usage = wgpu::BufferUsages::STORAGE;
        let size = self.storage_size::<T>(label, len, usage)?;
        let during = format!("making room for {label}, {size} bytes");
        let raw = self.watch.checked(&self.device, &during, || {
            self.create_buffer(label, size, usage, false)
        })?;
        Ok(Buffer::from_raw(raw, label, self.owner, len))
    }

    /// Makes every byte of `buffer` zero again.
    ///
    /// # Errors
    ///
    /// [`Error::DeviceLost`].
    pub fn clear<T: Pod>(&self, buffer: &Buffer<T>) -> Result<()> {
        let during = format!("clearing {}", buffer.label);
        self.check_owner(buffer.owner, &buffer.label, &during)?;
        self.watch.checked(&self.device, &during, || {
            let mut encoder = self.encoder("clear");
            encoder.clear_buffer(&buffer.raw, 0, None);
            self.queue.submit([encoder.finish()]);
        })
    }

    fn filled<T: Pod>(
        &self,
        label: &str,
        data: &[T],
        usage: wgpu::BufferUsages,
    ) -> Result<Buffer<T>> {
        let size = self.storage_size::<T>(label, data.len(), usage)?;
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let nothing = vec![0xff; if data.is_empty() { size as usize } else { 0 }];
        let bytes = if data.is_empty() { &nothing } else { bytes };
        let during = format!("uploading {label}, {size} bytes");
        tracing::trace!("{during}");
        let (raw, filled) = self.watch.checked(&self.device, &during, || {
            let raw = self.create_buffer(label, size, usage, true);
            // Where the allocation failed there is nothing to map, and the scope says why.
            let filled = raw.get_mapped_range_mut(..).map(|mut mapped| {
                mapped.slice(..bytes.len()).copy_from_slice(bytes);
            });
            if filled.is_ok() {
                raw.unmap();
            }
            (raw, filled)
        })?;
        filled.map_err(|error| Error::Validation {
            during,
            reason: one_line(&error),
        })?;
        Ok(Buffer::from_raw(raw, label, self.owner, data.len()))
    }

    fn create_buffer(
        &self,
        label: &str,
        size: u64,
        usage: wgpu::BufferUsages,
        mapped_at_creation: bool,
    ) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage: usage | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation,
        })
    }

    /// The bytes that `len` elements take, or an error where that is more than the device has.
    fn storage_size<T>(&self, label: &str, len: usize, usage: wgpu::BufferUsages) -> Result<u64> {
        let limits = self.device.limits();
        let needed = (size_of::<T>() as u64)
            .saturating_mul(len.max(1) as u64)
            .checked_next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT)
            .unwrap_or(u64::MAX);
        let binding = if usage.contains(wgpu::BufferUsages::UNIFORM) {
            limits.max_uniform_buffer_binding_size
        } else {
            limits.max_storage_buffer_binding_size
        };
        // What wgpu adds to a size must not leave 64 bits.
        let limit = limits.max_buffer_size.min(binding).min(1 << 62);
        if needed > limit {
            return Err(Error::BufferTooLarge {
                label: label.into(),
                needed,
                limit,
                device: self.name.clone(),
            });
        }
        Ok(needed)
    }

    /// Runs `kernel` with these buffers, in the order of its bindings, and waits for it.
    ///
    /// # Errors
    ///
    /// [`Error::LaunchLimits`] if there are more workgroups than the device can count;
    /// [`Error::Validation`] if the buffers do not fit the kernel; [`Error::Timeout`] and
    /// [`Error::DeviceLost`] as the launch goes.
    pub fn launch(
        &self,
        kernel: &Kernel,
        bindings: &[Binding<'_>],
        workgroups: [u32; 3],
    ) -> Result<LaunchTime> {
        let limit = self.device.limits().max_compute_workgroups_per_dimension;
        if let Some(asked) = workgroups.iter().find(|count| **count > limit) {
            return Err(self.over_limit(&kernel.name, "the number of workgroups", *asked, limit));
        }
        let during = format!("running the kernel {}", kernel.name);
        self.check_owner(kernel.owner, &kernel.name, &during)?;
        for binding in bindings {
            self.check_owner(binding.owner, binding.label, &during)?;
        }
        let timer = self
            .timer
            .as_ref()
            .map(|timer| timer.lock().unwrap_or_else(PoisonError::into_inner));
        let timer = timer.as_deref();
        let started = Instant::now();
        let submission = self.watch.checked(&self.device, &during, || {
            let group = self.bind_group(kernel, bindings);
            let mut encoder = self.encoder(&kernel.name);
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                    label: Some(&kernel.name),
                    timestamp_writes: timer.map(Timer::writes),
                });
                pass.set_pipeline(&kernel.pipeline);
                pass.set_bind_group(0, &group, &[]);
                let [x, y, z] = workgroups;
                pass.dispatch_workgroups(x, y, z);
            }
            if let Some(timer) = timer {
                timer.resolve(&mut encoder);
            }
            self.queue.submit([encoder.finish()])
        })?;
        // Only after a submission that was taken: a mapped buffer must not be written to.
        let mapped = timer.map(Timer::map);
        let waited = self
            .watch
            .wait(&self.device, submission, self.timeout, &during);
        let host = started.elapsed();
        let device = match (timer, mapped) {
            (Some(timer), Some(mapped)) => timer.elapsed(&mapped),
            _ => None,
        };
        waited?;
        tracing::trace!(
            "ran {} in {workgroups:?} workgroups of {:?} threads: {host:.1?}",
            kernel.name,
            kernel.workgroup_size
        );
        Ok(LaunchTime { device, host })
    }

    /// Refuses what another device made.
    fn check_owner(&self, owner: Owner, label: &str, during: &str) -> Result<()> {
        if owner == self.owner {
            return Ok(());
        }
        Err(Error::Validation {
            during: during.into(),
            reason: format!("{label} was made on another device than this {}", self.name),
        })
    }

    fn bind_group(&self, kernel: &Kernel, bindings: &[Binding<'_>]) -> wgpu::BindGroup {
        let entries: Vec<wgpu::BindGroupEntry<'_>> = bindings
            .iter()
            .zip(0..)
            .map(|(binding, index)| wgpu::BindGroupEntry {
                binding: index,
                resource: binding.resource.clone(),
            })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(&kernel.name),
            layout: &kernel.layout,
            entries: &entries,
        })
    }

    /// Copies all of `buffer` back to the host.
    ///
    /// # Errors
    ///
    /// [`Error::Readback`] if it cannot be mapped, and the errors of [`Gpu::launch`].
    pub fn read<T: Pod>(&self, buffer: &Buffer<T>) -> Result<Vec<T>> {
        self.read_first(buffer, buffer.len())
    }

    /// Copies the first `len` elements of `buffer` back to the host; all of them if it holds
    /// fewer.
    ///
    /// # Errors
    ///
    /// As [`Gpu::read`].
    pub fn read_first<T: Pod>(&self, buffer: &Buffer<T>, len: usize) -> Result<Vec<T>> {
        let len = len.min(buffer.len());
        let mut elements = memory::zeroed(len as u64, &buffer.label)?;
        self.read_into(buffer, &mut elements)?;
        Ok(elements)
    }

    /// Copies the first elements of `buffer` back to where the host wants them, and no more than it holds.
    ///
    /// # Errors
    ///
    /// As [`Gpu::read`].
    pub fn read_into<T: Pod>(&self, buffer: &Buffer<T>, elements: &mut [T]) -> Result<()> {
        let len = elements.len().min(buffer.len());
        self.read_through(&self.staging(buffer, len)?, buffer, elements)
    }

    /// Memory to read so many elements of `buffer` through: asked for before the work, so that what took long is not
    /// lost for want of it.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfMemory`], [`Error::DeviceLost`].
    pub(crate) fn staging<T: Pod>(&self, buffer: &Buffer<T>, len: usize) -> Result<Staging> {
        let bytes = (len.min(buffer.len()) * size_of::<T>()).min(READBACK_BYTES) as u64;
        let during = format!("making room to read {} back", buffer.label);
        let raw = self.watch.checked(&self.device, &during, || {
            self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("readback"),
                size: bytes.next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT),
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            })
        })?;
        Ok(Staging(raw))
    }

    /// [`Gpu::read_into`], through memory that is there already.
    ///
    /// # Errors
    ///
    /// As [`Gpu::read`].
    pub(crate) fn read_through<T: Pod>(
        &self,
        staging: &Staging,
        buffer: &Buffer<T>,
        elements: &mut [T],
    ) -> Result<()> {
        let len = elements.len().min(buffer.len());
        let bytes = bytemuck::cast_slice_mut::<T, u8>(&mut elements[..len]);
        let piece = staging.0.size() as usize;
        for (index, bytes) in bytes.chunks_mut(piece.max(1)).enumerate() {
            self.read_bytes(&staging.0, buffer, (index * piece) as u64, bytes)?;
        }
        Ok(())
    }

    /// Copies bytes of `buffer` from `offset` on through `staging`.
    fn read_bytes<T: Pod>(
        &self,
        staging: &wgpu::Buffer,
        buffer: &Buffer<T>,
        offset: u64,
        bytes: &mut [u8],
    ) -> Result<()> {
        let failed = |reason: String| Error::Readback {
            what: buffer.label.clone(),
            device: self.name.clone(),
            reason,
        };
        let padded = (bytes.len() as u64).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT);
        let during = format!("reading {} back", buffer.label);
        self.check_owner(buffer.owner, &buffer.label, &during)?;
        let (submission, mapped) = self.watch.checked(&self.device, &during, || {
            let mut encoder = self.encoder("readback");
            encoder.copy_buffer_to_buffer(&buffer.raw, offset, staging, 0, padded);
            let submission = self.queue.submit([encoder.finish()]);
            (submission, map(staging))
        })?;
        let waited = self
            .watch
            .wait(&self.device, submission, self.timeout, &during);
        let read = waited.and_then(|()| {
            // Another thread's poll may be about to say so.
            match mapped.recv_timeout(self.timeout.min(LATE)) {
                Ok(Ok(())) => {}
                Ok(Err(error)) => return Err(failed(error.to_string())),
                Err(_) => return Err(failed("the mapping did not finish with the copy".into())),
            }
            let view = staging
                .get_mapped_range(..)
                .map_err(|error| failed(error.to_string()))?;
            bytes.copy_from_slice(&view[..bytes.len()]);
            Ok(())
        });
        // Also where the mapping did not come in time: the next copy writes to it.
        staging.unmap();
        read
    }

    fn encoder(&self, label: &str) -> wgpu::CommandEncoder {
        self.device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
    }

    fn check_workgroup(&self, kernel: &str, size: [u32; 3]) -> Result<()> {
        let limits = self.device.limits();
        let threads = size
            .iter()
            .fold(1_u32, |product, side| product.saturating_mul(*side));
        let checks = [
            (
                "the workgroup's size along x",
                size[0],
                limits.max_compute_workgroup_size_x,
            ),
            (
                "the workgroup's size along y",
                size[1],
                limits.max_compute_workgroup_size_y,
            ),
            (
                "the workgroup's size along z",
                size[2],
                limits.max_compute_workgroup_size_z,
            ),
            (
                "the number of threads in a workgroup",
                threads,
                limits.max_compute_invocations_per_workgroup,
            ),
        ];
        match checks.iter().find(|(_, asked, limit)| asked > limit) {
            Some((what, asked, limit)) => Err(self.over_limit(kernel, what, *asked, *limit)),
            None => Ok(()),
        }
    }

    fn over_limit(&self, kernel: &str, what: &'static str, asked: u32, limit: u32) -> Error {
        Error::LaunchLimits {
            kernel: kernel.into(),
            device: self.name.clone(),
            what,
            asked: asked.into(),
            limit: limit.into(),
        }
    }
}

/// Holds what is said of a trusted module's bindings against the module, which no one else does.
fn check_bindings(module: &Module, said: &[Access]) -> Result<(), String> {
    for (binding, access) in module.bindings() {
        match said.get(binding as usize) {
            Some(said) if *said == access => {}
            Some(said) => {
                return Err(format!(
                    "its binding {binding} is {access:?}, and {said:?} was said"
                ));
            }
            None => {
                return Err(format!(
                    "it has a binding {binding}, and {} were said",
                    said.len()
                ));
            }
        }
    }
    Ok(())
}

/// Memory of the host that a device's buffers are read through.
#[derive(Debug)]
pub(crate) struct Staging(wgpu::Buffer);

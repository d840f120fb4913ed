//! [`Gpu`]: a device that runs kernels; every failure is an [`Error`].
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
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use bytemuck::Pod;

use super::adapter;
use super::buffer::{Access, Binding, Buffer, Owner};
use super::choice::DeviceChoice;
use super::errors::{Watch, caught, one_line};
use super::kernel::{Kernel, LaunchTime};
use super::mapping::{LATE, map};
use super::spirv::{EntryPoint, Module};
use super::timer::Timer;
use crate::error::{Error, Result};
use crate::memory;
use crate::shown::shown;

/// How a device is opened; for tests and unusual drivers.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct GpuOptions {
    /// The limits to request; `None` requests all that the adapter has.
    pub limits: Option<wgpu::Limits>,
    /// Passes kernels through naga even if the driver takes SPIR-V unchanged.
    pub through_naga: bool,
    /// Leaves 64-bit floats unused even if the adapter has them.
    pub without_f64: bool,
    /// How long a single launch may take before it counts as hung.
    pub timeout: Duration,
}

impl Default for GpuOptions {
    fn default() -> Self {
        Self {
            limits: None,
            through_naga: false,
            without_f64: false,
            timeout: Duration::from_secs(120),
        }
    }
}

impl GpuOptions {
    /// Requests these limits.
    #[must_use]
    pub fn limits(self, limits: wgpu::Limits) -> Self {
        Self {
            limits: Some(limits),
            ..self
        }
    }

    /// Passes kernels through naga, or not.
    #[must_use]
    pub fn through_naga(self, through_naga: bool) -> Self {
        Self {
            through_naga,
            ..self
        }
    }

    /// Leaves 64-bit floats unused, or not.
    #[must_use]
    pub fn without_f64(self, without_f64: bool) -> Self {
        Self {
            without_f64,
            ..self
        }
    }

    /// Counts a launch as hung after this time.
    #[must_use]
    pub fn timeout(self, timeout: Duration) -> Self {
        Self { timeout, ..self }
    }
}

/// The most bytes that one readback moves. It needs as much memory on the host, in addition.
const READBACK_BYTES: usize = 1 << 26;

/// A GPU or a software adapter, ready to run kernels.
#[derive(Debug)]
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    name: String,
    driver: String,
    is_software: bool,
    passthrough: bool,
    timeout: Duration,
    /// Locked while a launch uses it: there is only one pair of timestamps.
    timer: Option<Mutex<Timer>>,
    watch: Watch,
    /// The kernels compiled so far. Drivers cache them on disk, for the next process.
    kernels: Mutex<HashMap<KernelKey, Kernel>>,
    /// The mark of everything that this device makes.
    owner: Owner,
    /// The rate of 64-bit floats, once it is known.
    f64_rate: OnceLock<f64>,
}

/// What a compiled kernel depends on: a digest of the module's specialised words, whether they are
/// passed to the driver unchanged, the entry point, and its bindings.
type KernelKey = (u64, bool, String, Vec<Access>);

impl Gpu {
    /// Opens the adapter that `choice` selects.
    ///
    /// # Errors
    ///
    /// [`Error::NoAdapter`] if there is none ([`DeviceChoice::Auto`] takes no software adapter,
    /// [`DeviceChoice::Cpu`] no adapter at all), [`Error::NoSuchAdapter`] if none has that name,
    /// [`Error::DeviceRefused`] if it does not open.
    pub fn open(choice: &DeviceChoice) -> Result<Self> {
        let (adapter, _) = adapter::choose(choice)?;
        let adapter = adapter.ok_or_else(|| Error::NoAdapter {
            wanted: format!("follows from the choice \"{choice}\""),
            found: "it selects the CPU here".into(),
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
        if options.without_f64 {
            wanted.remove(wgpu::Features::SHADER_F64);
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
            driver: adapter::driver(&info),
            is_software,
            passthrough,
            timeout: options.timeout,
            timer,
            watch,
            kernels: Mutex::default(),
            owner: Owner::new(),
            f64_rate: OnceLock::new(),
        })
    }

    /// The adapter's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The driver's name and version.
    #[must_use]
    pub fn driver(&self) -> &str {
        &self.driver
    }

    /// Whether the adapter is software that runs on the CPU.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.is_software
    }

    /// Whether SPIR-V is passed to the driver unchanged, rather than through naga.
    #[must_use]
    pub fn passes_spirv_through(&self) -> bool {
        self.passthrough
    }

    /// Whether kernels may use 64-bit floats.
    #[must_use]
    pub fn has_f64(&self) -> bool {
        self.device.features().contains(wgpu::Features::SHADER_F64)
    }

    /// The rate of 64-bit floats, as `measure` finds it the first time.
    pub(super) fn remember_f64_rate(&self, measure: impl FnOnce() -> Result<f64>) -> Result<f64> {
        match self.f64_rate.get() {
            Some(rate) => Ok(*rate),
            None => measure().map(|rate| *self.f64_rate.get_or_init(|| rate)),
        }
    }

    /// The limits that the device was opened with.
    #[must_use]
    pub fn limits(&self) -> wgpu::Limits {
        self.device.limits()
    }

    /// The most bytes of a storage buffer that a kernel can bind.
    pub(crate) fn largest_storage(&self) -> u64 {
        let limits = self.device.limits();
        limits
            .max_buffer_size
            .min(limits.max_storage_buffer_binding_size)
    }

    /// Arranges this many workgroups in rows, if they exceed the device's limit along x.
    #[must_use]
    pub fn rows_of(&self, workgroups: u32) -> [u32; 3] {
        let row = self.limits().max_compute_workgroups_per_dimension.max(1);
        [workgroups.min(row), workgroups.div_ceil(row), 1]
    }

    /// Destroys the device: every later call fails with [`Error::DeviceLost`].
    pub fn destroy(&self) {
        self.device.destroy();
        // The callback that records the loss runs inside a poll.
        let _ = self.device.poll(wgpu::PollType::Poll);
    }

    /// Compiles an entry point of `module`, or returns it from the cache. `bindings` says how it
    /// uses descriptor set 0, from binding 0 upwards.
    ///
    /// # Errors
    ///
    /// [`Error::KernelInvalid`] if there is no such entry point, the device lacks a feature that
    /// the module needs, or the driver rejects it; [`Error::LaunchLimits`] if a workgroup has more
    /// threads than the device can run.
    pub fn kernel(
        &self,
        module: &Module,
        entry_point: &str,
        bindings: &[Access],
    ) -> Result<Kernel> {
        let entry = entry_of(module, entry_point)?;
        if module.needs_f64() && !self.has_f64() {
            return Err(invalid(
                module,
                entry_point,
                format!("it needs 64-bit floats, which {} lacks", self.name),
            ));
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
        let (pipeline, layout) = if module.is_trusted() {
            let only = module.only(entry_point);
            check_bindings(&only, bindings)
                .map_err(|reason| invalid(module, entry_point, reason))?;
            self.compile(&only.folded(), entry_point, bindings)?
        } else {
            self.compile(module, entry_point, bindings)?
        };
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

    /// Compiles an entry point, whether or not that was done before.
    fn compile(
        &self,
        module: &Module,
        entry_point: &str,
        bindings: &[Access],
    ) -> Result<(wgpu::ComputePipeline, wgpu::BindGroupLayout)> {
        let during = format!("compiling the kernel {entry_point}");
        let started = Instant::now();
        // naga panics on some modules.
        let of_module = |error| match error {
            Error::Validation { reason, .. } => invalid(module, entry_point, reason),
            other => other,
        };
        let shader = self
            .watch
            .checked(&self.device, &during, || {
                caught(|| self.shader_module(module))
            })
            .map_err(of_module)?
            .map_err(|reason| invalid(module, entry_point, one_line(&reason)))?;
        let made = self.watch.checked(&self.device, &during, || {
            let layout = self.bind_group_layout(entry_point, bindings);
            // Modules of unknown origin must not see what another kernel left there.
            let zeroes_memory = !module.is_trusted();
            (
                self.pipeline(&shader, entry_point, &layout, zeroes_memory),
                layout,
            )
        });
        let made = made.map_err(of_module)?;
        tracing::debug!(
            "compiled {entry_point} of {}, {} KiB of SPIR-V: {:.1?}",
            module.name(),
            module.words().len() * 4 / 1024,
            started.elapsed()
        );
        Ok(made)
    }

    /// The pipeline of an entry point whose descriptor set 0 has this layout.
    fn pipeline(
        &self,
        shader: &wgpu::ShaderModule,
        entry_point: &str,
        layout: &wgpu::BindGroupLayout,
        zeroes_memory: bool,
    ) -> wgpu::ComputePipeline {
        let layout = self
            .device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(entry_point),
                bind_group_layouts: &[Some(layout)],
                immediate_size: 0,
            });
        self.device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: Some(&layout),
                module: shader,
                entry_point: Some(entry_point),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &[],
                    zero_initialize_workgroup_memory: zeroes_memory,
                },
                cache: None,
            })
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
        // SAFETY: the words reach the driver unchecked by wgpu; the caller of `Module::trusted`
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

    /// Uploads `data` into storage. There are no empty buffers, so an empty slice becomes one
    /// element with all bits set: a float in it is NaN, and every ray misses a sphere in it.
    ///
    /// # Errors
    ///
    /// [`Error::BufferTooLarge`], [`Error::OutOfMemory`], [`Error::DeviceLost`].
    pub fn upload<T: Pod>(&self, label: &str, data: &[T]) -> Result<Buffer<T>> {
        self.filled(label, data, wgpu::BufferUsages::STORAGE)
    }

    /// Uploads one value into uniform memory. [`Gpu::update`] changes it.
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

    /// Overwrites the first elements of a buffer with `elements`, in pieces, so that no more than
    /// one of them is held in memory on the way.
    ///
    /// # Errors
    ///
    /// [`Error::Validation`], [`Error::OutOfMemory`], [`Error::DeviceLost`].
    pub(crate) fn write_first<T: Pod>(&self, buffer: &Buffer<T>, elements: &[T]) -> Result<()> {
        let during = format!("writing {}", buffer.label);
        self.check_owner(buffer.owner, &buffer.label, &during)?;
        let bytes: &[u8] = bytemuck::cast_slice(&elements[..elements.len().min(buffer.len())]);
        for (index, piece) in bytes.chunks(READBACK_BYTES).enumerate() {
            let offset = (index * READBACK_BYTES) as u64;
            self.watch.checked(&self.device, &during, || {
                self.queue.write_buffer(&buffer.raw, offset, piece);
                self.queue.submit([]);
            })?;
        }
        Ok(())
    }

    /// Storage for `len` elements, all zero.
    ///
    /// # Errors
    ///
    /// As [`Gpu::upload`].
    pub fn zeroed<T: Pod>(&self, label: &str, len: usize) -> Result<Buffer<T>> {
        let usage = wgpu::BufferUsages::STORAGE;
        let size = self.storage_size::<T>(label, len, usage)?;
        let during = format!("allocating {label}, {size} bytes");
        let raw = self.watch.checked(&self.device, &during, || {
            self.create_buffer(label, size, usage, false)
        })?;
        Ok(Buffer::from_raw(raw, label, self.owner, len))
    }

    /// Sets every byte of `buffer` to zero.
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
            // If the allocation failed, there is nothing to map, and the scope reports why.
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

    /// The bytes that `len` elements take; an error if that exceeds the device's limits.
    fn storage_size<T>(&self, label: &str, len: usize, usage: wgpu::BufferUsages) -> Result<u64> {
        let needed = (size_of::<T>() as u64)
            .saturating_mul(len.max(1) as u64)
            .checked_next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT)
            .unwrap_or(u64::MAX);
        let limit = if usage.contains(wgpu::BufferUsages::UNIFORM) {
            let limits = self.device.limits();
            limits
                .max_buffer_size
                .min(limits.max_uniform_buffer_binding_size)
        } else {
            self.largest_storage()
        };
        // Leaves room for what wgpu adds to a size in 64 bits.
        let limit = limit.min(1 << 62);
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

    /// Runs `kernel` with these bindings, in order, and waits for it.
    ///
    /// # Errors
    ///
    /// [`Error::LaunchLimits`] if there are more workgroups than the device allows;
    /// [`Error::Validation`] if the bindings do not fit the kernel; [`Error::Timeout`] and
    /// [`Error::DeviceLost`] if the launch fails.
    pub fn launch(
        &self,
        kernel: &Kernel,
        bindings: &[Binding<'_>],
        workgroups: [u32; 3],
    ) -> Result<LaunchTime> {
        self.launch_in_turn(&[(kernel, workgroups)], bindings)
    }

    /// Runs kernels one after the other, each in so many workgroups and with the same bindings, and
    /// waits for them. Each sees what those before it wrote.
    ///
    /// # Errors
    ///
    /// As [`Gpu::launch`].
    pub(crate) fn launch_in_turn(
        &self,
        kernels: &[(&Kernel, [u32; 3])],
        bindings: &[Binding<'_>],
    ) -> Result<LaunchTime> {
        let name = kernels.first().map_or("none", |(kernel, _)| &kernel.name);
        let during = format!("running the kernel {name}");
        let limit = self.device.limits().max_compute_workgroups_per_dimension;
        for (kernel, workgroups) in kernels {
            if let Some(asked) = workgroups.iter().find(|count| **count > limit) {
                let what = "the number of workgroups";
                return Err(self.over_limit(&kernel.name, what, *asked, limit));
            }
            self.check_owner(kernel.owner, &kernel.name, &during)?;
        }
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
            let mut encoder = self.encoder(name);
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                    label: Some(name),
                    timestamp_writes: timer.map(Timer::writes),
                });
                for (kernel, [x, y, z]) in kernels {
                    pass.set_pipeline(&kernel.pipeline);
                    pass.set_bind_group(0, &self.bind_group(kernel, bindings), &[]);
                    pass.dispatch_workgroups(*x, *y, *z);
                }
            }
            if let Some(timer) = timer {
                timer.resolve(&mut encoder);
            }
            self.queue.submit([encoder.finish()])
        })?;
        // Only after a successful submission: a mapped buffer must not be written to.
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
        let workgroups: Vec<[u32; 3]> = kernels.iter().map(|(_, count)| *count).collect();
        tracing::trace!("ran {name} in {workgroups:?} workgroups: {host:.1?}");
        Ok(LaunchTime { device, host })
    }

    /// Fails for anything that another device made.
    fn check_owner(&self, owner: Owner, label: &str, during: &str) -> Result<()> {
        if owner == self.owner {
            return Ok(());
        }
        Err(Error::Validation {
            during: during.into(),
            reason: format!("{label} was made on another device, not on {}", self.name),
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

    /// Copies all of `buffer` to the host.
    ///
    /// # Errors
    ///
    /// [`Error::Readback`] if it cannot be mapped, and the errors of [`Gpu::launch`].
    pub fn read<T: Pod>(&self, buffer: &Buffer<T>) -> Result<Vec<T>> {
        self.read_first(buffer, buffer.len())
    }

    /// Copies the first `len` elements of `buffer` to the host, or all of them if it has fewer.
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

    /// Copies the first elements of `buffer` into `elements`, at most as many as it has.
    ///
    /// # Errors
    ///
    /// As [`Gpu::read`].
    pub fn read_into<T: Pod>(&self, buffer: &Buffer<T>, elements: &mut [T]) -> Result<()> {
        let len = elements.len().min(buffer.len());
        self.read_through(&self.staging(buffer, len)?, buffer, elements)
    }

    /// Allocates the memory through which up to `len` elements of `buffer` are read. It is
    /// allocated before the work, so that results are not lost if there is no memory for it.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfMemory`], [`Error::DeviceLost`].
    pub(crate) fn staging<T: Pod>(&self, buffer: &Buffer<T>, len: usize) -> Result<Staging> {
        let bytes = (len.min(buffer.len()) * size_of::<T>()).min(READBACK_BYTES) as u64;
        let during = format!("allocating memory to read {} back", buffer.label);
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

    /// [`Gpu::read_into`] through memory that is already allocated.
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

    /// Copies bytes of `buffer`, from `offset` on, through `staging`.
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
            // Another thread's poll may be about to send the result.
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
        // Also if the mapping did not come in time: the next copy writes to it.
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

/// The error for a kernel that cannot be made.
fn invalid(module: &Module, entry_point: &str, reason: String) -> Error {
    Error::KernelInvalid {
        kernel: format!("{}/{entry_point}", module.name()),
        reason,
    }
}

/// The entry point of `module` with this name.
fn entry_of<'a>(module: &'a Module, entry_point: &str) -> Result<&'a EntryPoint> {
    let entries = module.entry_points();
    let found = entries.iter().find(|entry| entry.name == entry_point);
    found.ok_or_else(|| {
        let names: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
        let reason = format!(
            "the module has no such entry point, it has {}",
            names.join(", ")
        );
        invalid(module, entry_point, reason)
    })
}

/// Compares the declared bindings of a trusted module with the module. Nothing else checks them.
fn check_bindings(module: &Module, declared: &[Access]) -> Result<(), String> {
    for (binding, access) in module.bindings() {
        match declared.get(binding as usize) {
            Some(declared) if *declared == access => {}
            Some(declared) => {
                return Err(format!(
                    "its binding {binding} is {access:?}, but it was declared {declared:?}"
                ));
            }
            None => {
                return Err(format!(
                    "it has a binding {binding}, but only {} were declared",
                    declared.len()
                ));
            }
        }
    }
    Ok(())
}

/// Host memory through which a device's buffers are read.
#[derive(Debug)]
pub(crate) struct Staging(wgpu::Buffer);

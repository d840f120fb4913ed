//! [`Kernel`]: an entry point, compiled by the driver; [`LaunchTime`]: how long a launch took.

use std::time::Duration;

use super::buffer::Owner;

/// An entry point, compiled by the driver. Clones share the compiled code.
#[derive(Clone, Debug)]
pub struct Kernel {
    pub(super) name: String,
    pub(super) pipeline: wgpu::ComputePipeline,
    pub(super) layout: wgpu::BindGroupLayout,
    pub(super) workgroup_size: [u32; 3],
    pub(super) owner: Owner,
}

impl Kernel {
    /// Threads in a workgroup along x, y and z.
    #[must_use]
    pub fn workgroup_size(&self) -> [u32; 3] {
        self.workgroup_size
    }

    /// The number of workgroups that cover `threads` threads along x, y and z.
    #[must_use]
    pub fn workgroups_for(&self, threads: [u32; 3]) -> [u32; 3] {
        [0, 1, 2].map(|axis| threads[axis].div_ceil(self.workgroup_size[axis]))
    }
}

/// How long a launch took.
#[derive(Clone, Copy, Debug)]
pub struct LaunchTime {
    /// Time on the device, between timestamps; `None` if the device has none.
    pub device: Option<Duration>,
    /// Time on the host, from the submission until it is known to be done.
    pub host: Duration,
}

impl LaunchTime {
    /// The time on the device if it is known, else the time on the host.
    #[must_use]
    pub fn best(&self) -> Duration {
        self.device.unwrap_or(self.host)
    }
}

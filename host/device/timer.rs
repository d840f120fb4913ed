//! [`Timer`]: measures a pass on the device with timestamp queries.

use std::sync::mpsc::Receiver;
use std::time::Duration;

use super::mapping::map;

/// Two timestamps around a compute pass.
#[derive(Debug)]
pub(super) struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
    nanoseconds_per_tick: f32,
}

const BYTES: u64 = 16;

pub(super) type Mapped = Receiver<Result<(), wgpu::BufferAsyncError>>;

impl Timer {
    pub(super) fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let buffer = |label, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: BYTES,
                usage,
                mapped_at_creation: false,
            })
        };
        Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("launch time"),
                ty: wgpu::QueryType::Timestamp,
                count: 2,
            }),
            resolved: buffer(
                "launch time, resolved",
                wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            ),
            readable: buffer(
                "launch time, readable",
                wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            ),
            nanoseconds_per_tick: queue.get_timestamp_period(),
        }
    }

    /// The timestamp writes to pass to a compute pass.
    pub(super) fn writes(&self) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// Copies the timestamps to where the host can read them. To be called after the pass.
    pub(super) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..2, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, BYTES);
    }

    /// Starts reading. To be called after the pass was submitted.
    pub(super) fn map(&self) -> Mapped {
        map(&self.readable)
    }

    /// The time between the timestamps, once the submission is done; `None` if the device did not
    /// write them.
    pub(super) fn elapsed(&self, mapped: &Mapped) -> Option<Duration> {
        let is_mapped = matches!(mapped.try_recv(), Ok(Ok(())));
        let view = is_mapped
            .then(|| self.readable.get_mapped_range(..).ok())
            .flatten();
        let ticks = view.and_then(|view| {
            let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(&view[..]);
            ticks[1].checked_sub(ticks[0])
        });
        // Also if the mapping did not come in time: the next launch writes to the buffer.
        self.readable.unmap();
        // A driver may write timestamps that make no valid duration.
        let seconds =
            ticks.filter(|ticks| *ticks > 0)? as f64 * f64::from(self.nanoseconds_per_tick) * 1e-9;
        Duration::try_from_secs_f64(seconds).ok()
    }
}

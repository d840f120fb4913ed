//! Device memory that is mapped for the host to read.

use std::sync::mpsc;
use std::time::Duration;

/// How long a mapping may be late behind what it waits for.
pub(super) const LATE: Duration = Duration::from_secs(5);

/// Starts mapping a whole buffer for reading; the channel tells when it is mapped.
pub(super) fn map(
    buffer: &wgpu::Buffer,
) -> mpsc::Receiver<std::result::Result<(), wgpu::BufferAsyncError>> {
    let (sender, receiver) = mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver is gone only where waiting failed, and then nobody wants to know.
        let _ = sender.send(result);
    });
    receiver
}

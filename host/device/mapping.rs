//! Maps device memory for the host to read.

use std::sync::mpsc;
use std::time::Duration;

/// How long a mapping may take after the submission it follows is done.
pub(super) const LATE: Duration = Duration::from_secs(5);

/// Starts mapping a whole buffer for reading. The channel receives the result.
pub(super) fn map(
    buffer: &wgpu::Buffer,
) -> mpsc::Receiver<std::result::Result<(), wgpu::BufferAsyncError>> {
    let (sender, receiver) = mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver is dropped only if waiting failed; then nobody needs the result.
        let _ = sender.send(result);
    });
    receiver
}

//! Outputs: checked before the work, written whole or not at all.
//!
//! | module | holds |
//! | --- | --- |
//! | [`output`] | [`Output`]: one output: its destination, the checks in advance, and the writing |
//! | [`same`] | which names are the same file: outputs that clash, and outputs that are inputs |
//! | `format`, [`image`] | the image formats; [`Image::save`](crate::Image::save), and the memory for it |
//! | `identity` | which file a path refers to |
//! | `failure` | failures of writing an output |
//! | `png`, `exr` | the encoders, which hold a few rows at a time |
//! | `sink` | the file that encoders write to |
//! | `stream` | pipes, devices and sockets, which cannot be replaced |
//! | `temporary` | files under a temporary name |
//! | `waiting` | calls that may block because of another process |

mod exr;
mod failure;
mod format;
#[cfg(feature = "lab")]
mod identity;
pub mod image;
pub mod output;
mod png;
#[cfg(feature = "lab")]
pub mod same;
mod sink;
mod stream;
mod temporary;
mod waiting;

use std::path::Path;

#[cfg(feature = "cli")]
pub use format::Format;
#[cfg(feature = "cli")]
pub use image::ReservedMemory;
#[cfg(feature = "lab")]
pub use output::{Output, create_folder};
#[cfg(feature = "cli")]
pub(crate) use temporary::remove_all as remove_unfinished;
#[cfg(feature = "cli")]
pub(crate) use waiting::{Waiting, longest as longest_wait};

/// The directory of a file with this name.
fn directory_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

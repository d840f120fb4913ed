//! Outputs: checked before the work, written whole or not at all.
//!
//! | module | holds |
//! | --- | --- |
//! | [`output`] | [`Output`]: where something goes, what is checked about it, and how it gets there |
//! | [`same`] | which names are one file: outputs that clash, and outputs that are inputs |
//! | `format`, [`image`] | the kinds of image files; [`Image::save`](crate::Image::save), and the memory that writing one takes |
//! | `identity` | which file a path leads to |
//! | `failure` | what can go wrong while an output is written |
//! | `png`, `exr` | their encoders, which hold a few rows at once |
//! | `sink` | what encoders write into |
//! | `stream` | what is written into as it is |
//! | `temporary` | files under a temporary name |
//! | `waiting` | what waits for somebody else |

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
pub use image::Room;
#[cfg(feature = "lab")]
pub use output::Output;
#[cfg(feature = "cli")]
pub(crate) use temporary::remove_all as remove_unfinished;
#[cfg(feature = "cli")]
pub(crate) use waiting::{Waiting, longest as longest_wait};

/// The directory that a file of this name is in.
fn directory_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

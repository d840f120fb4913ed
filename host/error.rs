//! [`Error`]: everything that can go wrong, with what to do about it.

use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

use spherule_kernel::Rung;

use crate::shown::shown_path;

/// A result whose error is spherule's.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What went wrong.
///
/// The message says what and where; [`Error::help`] says how to fix it. The first group of variants
/// are the GPU's, in the order in which a program meets them; `docs/gpu-errors.md` sets each beside
/// its CUDA counterpart.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No adapter fits the choice.
    #[error("no GPU adapter {wanted}; {found}")]
    NoAdapter {
        /// The choice, as the end of "no GPU adapter …".
        wanted: String,
        /// What was found instead.
        found: String,
    },

    /// There are adapters, but none has the given name.
    #[error("no GPU adapter has a name that contains \"{name}\"; there is {}", found.join(", "))]
    NoSuchAdapter {
        /// The requested part of a name.
        name: String,
        /// The names of the adapters that were found.
        found: Vec<String>,
    },

    /// The adapter did not give a device.
    #[error("the adapter {adapter} refused a device: {reason}")]
    DeviceRefused {
        /// The adapter's name.
        adapter: String,
        /// What the driver or wgpu said.
        reason: String,
    },

    /// A kernel module is not SPIR-V, or the driver does not take it.
    #[error("the kernel {kernel} is invalid: {reason}")]
    KernelInvalid {
        /// The module's or the entry point's name.
        kernel: String,
        /// What is wrong with it.
        reason: String,
    },

    /// A buffer is larger than the device can allocate or bind.
    #[error("the buffer of {label} needs {needed} bytes, and {device} takes at most {limit}")]
    BufferTooLarge {
        /// What the buffer holds.
        label: String,
        /// The size of the buffer, in bytes.
        needed: u64,
        /// The device's limit, in bytes.
        limit: u64,
        /// The device's name.
        device: String,
    },

    /// The image of the sky is larger than the device can allocate or bind.
    #[error(
        "the image of the sky has {width} × {height} texels: a buffer of {needed} bytes, and {device} takes at most {limit}"
    )]
    SkyTooLarge {
        /// Width of the image, in texels.
        width: u32,
        /// Height of the image, in texels.
        height: u32,
        /// The size of its largest buffer, in bytes.
        needed: u64,
        /// The device's limit, in bytes.
        limit: u64,
        /// The device's name.
        device: String,
        /// Width and height, in texels, of the largest image of this shape that the device takes.
        fits: (u32, u32),
    },

    /// The device has no memory left.
    #[error("out of memory on {device} while {during}")]
    OutOfMemory {
        /// The device's name.
        device: String,
        /// What was being done.
        during: String,
    },

    /// The host has no memory left, or the process may not use more.
    #[error("out of memory: {purpose} needs {}, {}", bytes(*needed), more_than(*available))]
    OutOfHostMemory {
        /// The bytes that were requested, in all.
        needed: u64,
        /// The available bytes, if they were looked up before the allocation.
        available: Option<u64>,
        /// What the memory is for.
        purpose: String,
    },

    /// The library that removes noise is not there, or does not work.
    #[error("Open Image Denoise cannot be used: {reason}")]
    Denoiser {
        /// What is missing, or what the library said.
        reason: String,
    },

    /// The thread pool cannot be started.
    #[error("the thread pool cannot be started: {reason}")]
    Threads {
        /// What rayon or the system said.
        reason: String,
    },

    /// A launch needs more threads, workgroups or workgroup memory than the device has.
    #[error(
        "the launch of {kernel} does not fit {device}: {what} is {asked}, and the limit is {limit}"
    )]
    LaunchLimits {
        /// The entry point.
        kernel: String,
        /// The device's name.
        device: String,
        /// What exceeds the limit.
        what: &'static str,
        /// What the launch needs.
        asked: u64,
        /// The device's limit.
        limit: u64,
    },

    /// wgpu or the driver rejected a call.
    #[error("the GPU rejected a call while {during}: {reason}")]
    Validation {
        /// What was being done.
        during: String,
        /// The message of wgpu or of the driver.
        reason: String,
    },

    /// The device is gone: unplugged, reset by its watchdog, or destroyed.
    #[error("the device {device} was lost while {during}: {reason}")]
    DeviceLost {
        /// The device's name.
        device: String,
        /// What was being done.
        during: String,
        /// What the driver said.
        reason: String,
    },

    /// A launch did not end in time.
    #[error("{device} did not finish within {} s while {during}", limit.as_secs_f64())]
    Timeout {
        /// The device's name.
        device: String,
        /// What the host was waiting for.
        during: String,
        /// How long it waited.
        limit: Duration,
    },

    /// The device's arithmetic does not meet the needs of a rung.
    #[error("the precision {} is refused on {device}: {reason}", rung.name())]
    RungRefused {
        /// The rung.
        rung: Rung,
        /// The device's name.
        device: String,
        /// What the canary found.
        reason: String,
    },

    /// What a kernel wrote cannot be read back, or is incomplete.
    #[error("{what} could not be read back from {device}: {reason}")]
    Readback {
        /// What the buffer holds.
        what: String,
        /// The device's name.
        device: String,
        /// What went wrong.
        reason: String,
    },

    /// A scene, or a file that it names, is wrong.
    #[error(transparent)]
    Scene(#[from] Box<SceneError>),

    /// An image cannot be made or read.
    #[error("{path}: {reason}", path = shown_path(path))]
    Image {
        /// The image file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
        /// How to fix it.
        help: String,
    },

    /// An output cannot be written.
    #[error("{path}: {reason}", path = shown_path(path))]
    Output {
        /// The output file, as the user named it.
        path: PathBuf,
        /// What is wrong.
        reason: String,
        /// How to fix it.
        help: String,
    },

    /// An output must not be written there: the file is an input, another output, or of an unknown
    /// format.
    #[error("{path}: {reason}", path = shown_path(path))]
    OutputRefused {
        /// The output file, as the user named it.
        path: PathBuf,
        /// What is wrong.
        reason: String,
        /// How to fix it.
        help: String,
    },
}

impl Error {
    /// What is wrong with a scene that a program made, and how to mend it.
    pub(crate) fn of_scene(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::Scene(SceneError::without_place("", message, help))
    }

    /// How to fix it, as a sentence for the user.
    #[must_use]
    pub fn help(&self) -> String {
        match self {
            Self::NoAdapter { .. } => {
                "run `spherule devices` for the list; install a Vulkan driver (lavapipe, Debian's mesa-vulkan-drivers, \
                 needs no GPU), or use `--device cpu`, which needs none"
                    .into()
            }
            Self::NoSuchAdapter { .. } => {
                "give auto, gpu, cpu, or a part of one of these names; `spherule devices` says more of each".into()
            }
            Self::DeviceRefused { .. } => {
                "update the graphics driver, or use another device: `--device cpu` always works".into()
            }
            Self::KernelInvalid { .. } => {
                "update the graphics driver; if you changed the kernel, check it with spirv-val".into()
            }
            // Another device needs as much of the host's memory.
            Self::OutOfHostMemory { .. } => {
                "render a smaller image or fewer spheres, or give the process more memory (`ulimit -v` and `ulimit -d` show its limits)"
                    .into()
            }
            Self::SkyTooLarge { fits: (width, height), .. } => format!(
                "scale the image to {width} × {height} texels, or use `--device cpu`, which uses the host's memory"
            ),
            Self::BufferTooLarge { .. } | Self::OutOfMemory { .. } => {
                "render fewer spheres or a smaller image, or use `--device cpu`, which uses the host's memory".into()
            }
            Self::Denoiser { .. } => {
                "install version 2 of it (https://www.openimagedenoise.org) where the system looks for libraries, or name \
                 its library in SPHERULE_OIDN; without `--denoise` the image keeps its noise"
                    .into()
            }
            Self::Threads { .. } => "start the pool once, before any work, or use rayon's default pool".into(),
            Self::LaunchLimits { .. } => {
                "launch fewer or smaller workgroups, or use a device with higher limits (`spherule devices` lists them)"
                    .into()
            }
            Self::Validation { .. } => {
                "this is a mistake in the calling program rather than in its input; VK_LOADER_LAYERS_ENABLE=*validation \
                 names the call"
                    .into()
            }
            Self::DeviceLost { .. } => {
                "open the device again; if it keeps happening, the driver's watchdog may be ending long launches: use \
                 `--device cpu`"
                    .into()
            }
            Self::Timeout { .. } => "use a faster device or a smaller image; the device may also be hung".into(),
            Self::RungRefused { .. } => {
                "use a lower `--precision`, or `--device cpu`, where every rung holds; `spherule check` shows what this \
                 device does"
                    .into()
            }
            Self::Readback { .. } => {
                "the kernel may have panicked on the device, or the driver miscompiled it: compare with `--device cpu`"
                    .into()
            }
            Self::Scene(error) => error.help.clone(),
            Self::Image { help, .. } | Self::Output { help, .. } | Self::OutputRefused { help, .. } => help.clone(),
        }
    }

    /// Whether the input is at fault (exit code 2) rather than the machine (exit code 1).
    #[must_use]
    pub fn is_input(&self) -> bool {
        matches!(
            self,
            Self::Scene(_) | Self::NoSuchAdapter { .. } | Self::OutputRefused { .. }
        )
    }
}

/// The one of `names` that `text` is most likely meant to be; `None` if none is similar.
#[cfg(feature = "lab")]
pub(crate) fn nearest<'a>(text: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let text = text.to_lowercase();
    let likeness = |name: &str| strsim::jaro_winkler(&text, &name.to_lowercase());
    names
        .into_iter()
        .map(|name| (likeness(name), name))
        .filter(|(likeness, _)| *likeness > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

/// How the available memory compares with what is needed.
fn more_than(available: Option<u64>) -> String {
    match available {
        Some(available) => format!("but only {} are available", bytes(available)),
        None => "more than this process can get".into(),
    }
}

/// A number of bytes in binary units, followed by the exact number.
pub(crate) fn bytes(count: u64) -> String {
    let mut value = count as f64;
    let mut unit = "";
    for larger in ["KiB", "MiB", "GiB", "TiB", "PiB", "EiB"] {
        if value < 1024.0 {
            break;
        }
        (value, unit) = (value / 1024.0, larger);
    }
    if unit.is_empty() {
        format!("{count} bytes")
    } else {
        format!("{value:.1} {unit} ({count} bytes)")
    }
}

/// An error in a scene: what is wrong and where.
///
/// The message starts with the file, and with line and column if the error has a place.
#[derive(Debug, thiserror::Error)]
#[error("{}{message}", self.whereabouts())]
pub struct SceneError {
    /// The file that is wrong.
    pub path: PathBuf,
    /// What is wrong.
    pub message: String,
    /// How to fix it.
    pub help: String,
    /// The file's text and the bytes that are wrong, if the error has a place.
    pub place: Option<Place>,
}

/// A place in a text.
#[derive(Debug)]
pub struct Place {
    /// The whole text.
    pub text: String,
    /// The bytes in question.
    pub span: Range<usize>,
    /// What is wrong with them, in a few words.
    pub label: String,
}

impl Place {
    /// Line and column of the first byte, both counted from one. The column counts characters.
    #[must_use]
    pub fn line_column(&self) -> (usize, usize) {
        let mut start = self.span.start.min(self.text.len());
        while !self.text.is_char_boundary(start) {
            start -= 1;
        }
        let before = &self.text[..start];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        (
            before.matches('\n').count() + 1,
            before[line_start..].chars().count() + 1,
        )
    }
}

impl SceneError {
    /// `file:line:column: `, as far as they are known.
    fn whereabouts(&self) -> String {
        let path = shown_path(&self.path);
        match &self.place {
            Some(place) => {
                let (line, column) = place.line_column();
                format!("{path}:{line}:{column}: ")
            }
            None if self.path.as_os_str().is_empty() => String::new(),
            None => format!("{path}: "),
        }
    }

    pub(crate) fn without_place(
        path: impl Into<PathBuf>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<Self> {
        Box::new(Self {
            path: path.into(),
            message: message.into(),
            help: help.into(),
            place: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Place;

    #[test]
    fn place_counts_lines_and_characters_from_one() {
        let place = |start| Place {
            text: "a\nδέ x\n".into(),
            span: start..start,
            label: String::new(),
        };
        assert_eq!(place(0).line_column(), (1, 1));
        assert_eq!(place(2).line_column(), (2, 1));
        assert_eq!(place(7).line_column(), (2, 4));
        assert_eq!(place(1000).line_column(), (3, 1));
    }
}

//! [`DeviceChoice`]: the device that the user wants.

use std::fmt;
use std::str::FromStr;

/// The device that the user wants.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum DeviceChoice {
    /// A real GPU if there is one, else the CPU. Never a software adapter.
    #[default]
    Auto,
    /// The best GPU adapter; a software adapter if there is no other.
    Gpu,
    /// The CPU. No graphics driver is loaded.
    Cpu,
    /// The adapter whose name contains this text; case is ignored.
    Named(String),
}

impl FromStr for DeviceChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim().to_lowercase().as_str() {
            "" => Err("give auto, gpu, cpu, or a part of an adapter's name".into()),
            "auto" => Ok(Self::Auto),
            "gpu" => Ok(Self::Gpu),
            "cpu" => Ok(Self::Cpu),
            _ => Ok(Self::Named(text.trim().into())),
        }
    }
}

impl fmt::Display for DeviceChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Gpu => f.write_str("gpu"),
            Self::Cpu => f.write_str("cpu"),
            Self::Named(name) => f.write_str(name),
        }
    }
}

//! [`InstructionSet`]: the vector instructions with which rays are traced on the CPU.

use std::fmt;
use std::sync::OnceLock;

use fearless_simd::Level;

use crate::error::{Error, Result, SceneError};
use crate::shown::shown;

/// The environment variable that selects the instructions by [`InstructionSet::name`]. Without it,
/// the widest of this machine are used.
pub const VARIABLE: &str = "SPHERULE_CPU";

/// An instruction set, narrow ones first. Images and hits are the same with each, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum InstructionSet {
    /// The baseline of the architecture: SSE2 on x86-64, NEON on Arm.
    Plain,
    /// AVX2 and FMA, with bit manipulation: x86-64-v3.
    Avx2,
    /// AVX-512 as on Ice Lake and Zen 4.
    Avx512,
}

impl InstructionSet {
    /// Every instruction set, narrow ones first.
    pub const ALL: [Self; 3] = [Self::Plain, Self::Avx2, Self::Avx512];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Plain if cfg!(target_arch = "aarch64") => "neon",
            Self::Plain => "plain",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// The widest instruction set of this machine.
    #[must_use]
    pub fn widest() -> Self {
        let is_there = |set: &Self| set.level().is_some();
        Self::ALL.into_iter().rfind(is_there).unwrap_or(Self::Plain)
    }

    /// Whether this machine has it.
    #[must_use]
    pub fn is_there(self) -> bool {
        self.level().is_some()
    }

    /// The instruction set that [`VARIABLE`] selects, or the widest of this machine.
    ///
    /// # Errors
    ///
    /// [`Error::Scene`] if it names no instruction set, or one that this machine does not have.
    pub fn wanted() -> Result<Self> {
        let Some(text) = std::env::var_os(VARIABLE).filter(|text| !text.is_empty()) else {
            return Ok(Self::widest());
        };
        let text = text.to_string_lossy();
        let refused = |what: &str| {
            let there: Vec<&str> = Self::ALL
                .into_iter()
                .filter(|set| set.is_there())
                .map(Self::name)
                .collect();
            Error::from(SceneError::without_place(
                "",
                format!("{VARIABLE} is `{}`, {what}", shown(&text)),
                format!("give one of {}, or unset it", there.join(", ")),
            ))
        };
        let named = Self::ALL.into_iter().find(|set| set.name() == text);
        let set = named.ok_or_else(|| refused("which names no instruction set"))?;
        if set.is_there() {
            Ok(set)
        } else {
            Err(refused("which this machine does not have"))
        }
    }

    /// The result of the first call of [`InstructionSet::wanted`]; the widest if that failed.
    #[must_use]
    pub fn chosen() -> Self {
        static CHOSEN: OnceLock<InstructionSet> = OnceLock::new();
        *CHOSEN.get_or_init(|| Self::wanted().unwrap_or_else(|_| Self::widest()))
    }

    /// The set as `fearless_simd` names it, if this machine has it.
    pub(crate) fn level(self) -> Option<Level> {
        let widest = Level::new();
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Plain => widest.as_sse2().map(Level::Sse2),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => widest.as_avx2().map(Level::Avx2),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => widest.as_avx512().map(Level::Avx512),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Plain => Some(widest),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => None,
        }
    }
}

impl fmt::Display for InstructionSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

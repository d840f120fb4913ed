//! The proof that this machine has AVX2.

use fearless_simd::x86;

use crate::cpu::InstructionSet;

/// The proof that this machine has AVX2 and the extensions that come with it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx2(pub(super) x86::Avx2);

impl Avx2 {
    pub(super) fn of(instructions: InstructionSet) -> Option<Self> {
        instructions.level()?.as_avx2().map(Self)
    }
}

//! [`Written`]: an instruction of a module that is made anew.

use super::op;

/// An instruction of the folded module.
pub(super) struct Written {
    pub(super) opcode: u32,
    pub(super) operands: Vec<u32>,
}

impl Written {
    pub(super) fn new(opcode: u32, operands: &[u32]) -> Self {
        Self {
            opcode,
            operands: operands.to_vec(),
        }
    }

    pub(super) fn result(&self) -> Option<u32> {
        result_of(self.opcode, &self.operands)
    }
}

/// The id that an instruction defines, if it is known to define one.
pub(super) fn result_of(opcode: u32, operands: &[u32]) -> Option<u32> {
    match opcode {
        op::LABEL => operands.first().copied(),
        op::FUNCTION | op::FUNCTION_PARAMETER | op::FUNCTION_CALL | op::EXT_INST => {
            operands.get(1).copied()
        }
        _ if is_pure(opcode, operands) => operands.get(1).copied(),
        _ => None,
    }
}

/// Whether an instruction does nothing but define its result.
pub(super) fn is_pure(opcode: u32, operands: &[u32]) -> bool {
    match opcode {
        // modf and frexp of GLSL.std.450 store through a pointer.
        op::EXT_INST => !matches!(operands.get(3), Some(35 | 51)),
        op::UNDEF
        | op::VARIABLE
        | op::LOAD
        | op::ACCESS_CHAIN
        | op::IN_BOUNDS_ACCESS_CHAIN
        | op::ARRAY_LENGTH
        | op::PHI => true,
        // Composites, conversions, arithmetic, logic, comparisons, bits.
        77..=83 | 109..=115 | 124 | 126..=152 | 154..=191 | 194..=205 => true,
        _ => false,
    }
}

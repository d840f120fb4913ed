//! Functions that are a single instruction on a GPU. Rust's own functions become more than one
//! there: a comparison and a selection, or a special case for zero. Runs on the GPU and on the CPU.

#[cfg(target_arch = "spirv")]
use core::arch::asm;

/// The instruction of `GLSL.std.450` with this number. It touches no memory, and its operands and
/// result are of one type.
#[cfg(target_arch = "spirv")]
macro_rules! glsl {
    ($number:literal, $type:literal, $($operand:ident),+) => {{
        let result;
        // SAFETY: the instruction touches no memory.
        unsafe {
            asm!(
                "%glsl = OpExtInstImport \"GLSL.std.450\"",
                concat!("%type = ", $type),
                concat!("{result} = OpExtInst %type %glsl ", $number, $(" {", stringify!($operand), "}"),+),
                $($operand = in(reg) $operand,)+
                result = out(reg) result,
            );
        }
        result
    }};
}

/// The larger of two integers.
#[inline]
#[must_use]
pub fn larger(a: i32, b: i32) -> i32 {
    #[cfg(target_arch = "spirv")]
    {
        // SMax
        glsl!("42", "OpTypeInt 32 1", a, b)
    }
    #[cfg(not(target_arch = "spirv"))]
    a.max(b)
}

/// The smaller of two integers.
#[inline]
#[must_use]
pub fn smaller(a: i32, b: i32) -> i32 {
    #[cfg(target_arch = "spirv")]
    {
        // SMin
        glsl!("39", "OpTypeInt 32 1", a, b)
    }
    #[cfg(not(target_arch = "spirv"))]
    a.min(b)
}

/// The number of the highest bit that is set. At least one bit must be set.
#[inline]
#[must_use]
pub fn highest_bit(bits: u32) -> u32 {
    #[cfg(target_arch = "spirv")]
    {
        // FindUMsb
        glsl!("75", "OpTypeInt 32 0", bits)
    }
    #[cfg(not(target_arch = "spirv"))]
    {
        31_u32.wrapping_sub(bits.leading_zeros())
    }
}

/// The number of the lowest bit that is set. At least one bit must be set.
#[inline]
#[must_use]
pub fn lowest_bit(bits: u32) -> u32 {
    #[cfg(target_arch = "spirv")]
    {
        // FindILsb
        glsl!("73", "OpTypeInt 32 0", bits)
    }
    #[cfg(not(target_arch = "spirv"))]
    {
        bits.trailing_zeros()
    }
}

/// 1/√x for x above zero. On a GPU it is off by at most 2 units in the last place.
#[inline]
#[must_use]
pub fn inverse_root(x: f32) -> f32 {
    #[cfg(target_arch = "spirv")]
    {
        // InverseSqrt
        glsl!("32", "OpTypeFloat 32", x)
    }
    #[cfg(not(target_arch = "spirv"))]
    {
        1.0 / x.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_do_what_their_names_say() {
        assert_eq!((larger(-1, 2), smaller(-1, 2)), (2, -1));
        assert_eq!((inverse_root(4.0), inverse_root(0.25)), (0.5, 2.0));
        for bit in 0..32 {
            assert_eq!(highest_bit((1 << bit) | ((1 << bit) / 3)), bit);
            assert_eq!(lowest_bit(!0 << bit), bit);
        }
    }
}

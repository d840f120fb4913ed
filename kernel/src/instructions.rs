//! Single instructions of a GPU that Rust's own functions do not become: those mind what happens to a
//! NaN or to zero. Runs on the GPU and on the CPU.

#[cfg(target_arch = "spirv")]
use core::arch::asm;

/// The larger of two numbers, neither of them a NaN.
#[inline]
#[must_use]
pub fn max(a: f32, b: f32) -> f32 {
    #[cfg(target_arch = "spirv")]
    {
        let result: f32;
        // SAFETY: FMax of GLSL.std.450, which touches no memory.
        unsafe {
            asm!(
                "%glsl = OpExtInstImport \"GLSL.std.450\"",
                "%float = OpTypeFloat 32",
                "{result} = OpExtInst %float %glsl 40 {a} {b}",
                a = in(reg) a,
                b = in(reg) b,
                result = out(reg) result,
            );
        }
        result
    }
    #[cfg(not(target_arch = "spirv"))]
    a.max(b)
}

/// The smaller of two numbers, neither of them a NaN.
#[inline]
#[must_use]
pub fn min(a: f32, b: f32) -> f32 {
    #[cfg(target_arch = "spirv")]
    {
        let result: f32;
        // SAFETY: FMin of GLSL.std.450, which touches no memory.
        unsafe {
            asm!(
                "%glsl = OpExtInstImport \"GLSL.std.450\"",
                "%float = OpTypeFloat 32",
                "{result} = OpExtInst %float %glsl 37 {a} {b}",
                a = in(reg) a,
                b = in(reg) b,
                result = out(reg) result,
            );
        }
        result
    }
    #[cfg(not(target_arch = "spirv"))]
    a.min(b)
}

/// Which is the highest bit that is set; at least one is.
#[inline]
#[must_use]
pub fn highest_bit(bits: u32) -> u32 {
    #[cfg(target_arch = "spirv")]
    {
        let result: u32;
        // SAFETY: FindUMsb of GLSL.std.450, which touches no memory.
        unsafe {
            asm!(
                "%glsl = OpExtInstImport \"GLSL.std.450\"",
                "%uint = OpTypeInt 32 0",
                "{result} = OpExtInst %uint %glsl 75 {bits}",
                bits = in(reg) bits,
                result = out(reg) result,
            );
        }
        result
    }
    #[cfg(not(target_arch = "spirv"))]
    {
        31 - bits.leading_zeros()
    }
}

/// Which is the lowest bit that is set; at least one is.
#[inline]
#[must_use]
pub fn lowest_bit(bits: u32) -> u32 {
    #[cfg(target_arch = "spirv")]
    {
        let result: u32;
        // SAFETY: FindILsb of GLSL.std.450, which touches no memory.
        unsafe {
            asm!(
                "%glsl = OpExtInstImport \"GLSL.std.450\"",
                "%uint = OpTypeInt 32 0",
                "{result} = OpExtInst %uint %glsl 73 {bits}",
                bits = in(reg) bits,
                result = out(reg) result,
            );
        }
        result
    }
    #[cfg(not(target_arch = "spirv"))]
    {
        bits.trailing_zeros()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_do_what_their_names_say() {
        assert_eq!((max(-1.0, 2.0), min(-1.0, 2.0)), (2.0, -1.0));
        for bit in 0..32 {
            assert_eq!(highest_bit((1 << bit) | ((1 << bit) / 3)), bit);
            assert_eq!(lowest_bit(!0 << bit), bit);
        }
    }
}

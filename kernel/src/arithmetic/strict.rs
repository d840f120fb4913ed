//! Sum, difference and product of floats, each rounded once and by itself. Runs on the GPU and
//! on the CPU.
//!
//! A shader compiler may fuse a product with a sum, cancel `(a + b) - a`, or reorder, and drivers
//! do: without a word to the contrary they delete the error terms that compensated arithmetic
//! lives on. The word is the decoration `NoContraction` on each operation, and a difference must
//! be an `OpFSub`: written as the sum of a negation it is simplified all the same. rustc never
//! contracts or reorders, so that the CPU's versions are the plain operators.

macro_rules! strict {
    ($(#[$docs:meta])* $name:ident, $float:ident, $bits:literal, $opcode:literal, $operator:tt) => {
        $(#[$docs])*
        #[inline]
        #[must_use]
        pub fn $name(a: $float, b: $float) -> $float {
            #[cfg(target_arch = "spirv")]
            {
                let mut result = 0.0;
                // SAFETY: the instructions load two floats, combine them, and store one.
                unsafe {
                    core::arch::asm!(
                        concat!("%float = OpTypeFloat ", $bits),
                        "OpDecorate %result NoContraction",
                        "%a = OpLoad _ {a}",
                        "%b = OpLoad _ {b}",
                        concat!("%result = ", $opcode, " %float %a %b"),
                        "OpStore {result} %result",
                        a = in(reg) &a,
                        b = in(reg) &b,
                        result = in(reg) &mut result,
                    );
                }
                result
            }
            #[cfg(not(target_arch = "spirv"))]
            {
                a $operator b
            }
        }
    };
}

strict!(
    /// The sum, rounded to nearest.
    add, f32, "32", "OpFAdd", +
);
strict!(
    /// The difference, rounded to nearest.
    sub, f32, "32", "OpFSub", -
);
strict!(
    /// The product, rounded to nearest.
    mul, f32, "32", "OpFMul", *
);

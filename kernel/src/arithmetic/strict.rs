//! Sum, difference and product of floats, each rounded once and on its own. Runs on the GPU and on
//! the CPU.
//!
//! A shader compiler may fuse a product with a sum, cancel `(a + b) - a`, or reorder, and drivers
//! do: if nothing forbids it, they delete the error terms that compensated arithmetic depends on.
//! The decoration `NoContraction` on each operation forbids it. A difference must be an `OpFSub`: a
//! sum with a negated operand is simplified despite the decoration. rustc never contracts or
//! reorders, so the CPU's versions are the plain operators.

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

#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
strict!(
    /// The sum in 64 bits, rounded to nearest.
    add_wide, f64, "64", "OpFAdd", +
);
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
strict!(
    /// The difference in 64 bits, rounded to nearest.
    sub_wide, f64, "64", "OpFSub", -
);
#[cfg(any(not(target_arch = "spirv"), feature = "f64"))]
strict!(
    /// The product in 64 bits, rounded to nearest.
    mul_wide, f64, "64", "OpFMul", *
);

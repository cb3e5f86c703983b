//! The numbers that coefficients are: plain ones, or of twice the digits.

use twofloat::TwoFloat;

use crate::real::Real;

/// A number that series are made of.
pub trait Base: Real {
    /// The highest order of a series with code of its own.
    const HIGHEST_UNROLLED: usize;

    /// `a b + c`, fused where the target has an instruction for it.
    fn fma(a: Self, b: Self, c: Self) -> Self;
}

impl Base for f64 {
    // Beyond it the code of all orders does not fit into the first cache of instructions, and to fetch
    // it takes longer than to loop. Where the compiler is not asked for speed, it is spared that code; the
    // bits are the same.
    const HIGHEST_UNROLLED: usize = if cfg!(debug_assertions) { 0 } else { 8 };

    #[inline(always)]
    fn fma(a: Self, b: Self, c: Self) -> Self {
        if cfg!(target_feature = "fma") { a.mul_add(b, c) } else { a * b + c }
    }
}

impl Base for TwoFloat {
    // An operation is twenty: loops cost little.
    const HIGHEST_UNROLLED: usize = 0;

    #[inline]
    fn fma(a: Self, b: Self, c: Self) -> Self {
        a * b + c
    }
}

//! Binary logarithm and power of two to three digits, which is enough for step sizes. They are fast because every
//! step has to wait for both.
//!
//! ```text
//! log₂ x = k + t + t (1 − t) (a₀ + a₁ t + a₂ t²)    x = 2ᵏ (1 + t),  0 ≤ t < 1
//! 2ˣ = 2ᵏ (1 + f (b₀ + b₁ f + b₂ f²))               x = k + f,       |f| ≤ ½
//! ```
//!
//! The coefficients are those of interpolation at Chebyshev nodes. The logarithm is continuous, and exact at powers
//! of two.

use std::f64::consts::LN_2;

const LOG: [f64; 3] = [0.440_781, -0.242_669, 0.081_616];
const POWER: [f64; 3] = [LN_2, 0.242_035, 0.055_755];

/// Mask of the bits of the significand, and the bits of the number one.
const SIGNIFICAND: u64 = (1 << 52) - 1;
const ONE: u64 = f64::to_bits(1.0);
/// Added to a number, this constant leaves the nearest integer in the lowest bits of the sum.
const TO_WHOLE: f64 = 1.5 * (1_u64 << 52) as f64;
/// `|x|` below which `2ˣ` is a normal number.
const MOST: f64 = 1022.0;

/// `log₂ x`, with an error of at most 3.1e-4.
#[inline]
pub(crate) fn log2(x: f64) -> f64 {
    if !(x > 0.0 && x.is_normal()) {
        return libm::log2(x);
    }
    let bits = x.to_bits();
    let k = (bits >> 52) as f64 - (ONE >> 52) as f64;
    let t = f64::from_bits(bits & SIGNIFICAND | ONE) - 1.0;
    k + t + t * (1.0 - t) * (LOG[0] + t * (LOG[1] + t * LOG[2]))
}

/// `2ˣ`, with a relative error of at most 2e-4.
#[inline]
pub(crate) fn exp2(x: f64) -> f64 {
    if x.is_nan() || x.abs() >= MOST {
        return libm::exp2(x);
    }
    let whole = x + TO_WHOLE;
    let f = x - (whole - TO_WHOLE);
    // The lowest bits of `whole` are k; the shift moves them into the exponent and drops the bits above them.
    let scale = f64::from_bits(whole.to_bits().wrapping_shl(52).wrapping_add(ONE));
    scale * (1.0 + f * (POWER[0] + f * (POWER[1] + f * POWER[2])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms_have_the_digits_that_a_step_size_needs() {
        for exponent in [-1000, -300, -20, -1, 0, 1, 20, 300, 1000] {
            for k in 0..1000 {
                let x = (1.0 + 1e-3 * f64::from(k)) * libm::ldexp(1.0, exponent);
                let apart = (log2(x) - libm::log2(x)).abs();
                // Measured: 3.1e-4.
                assert!(apart < 3.2e-4, "{x:e}: {apart:e}");
            }
            assert_eq!(log2(libm::ldexp(1.0, exponent)), f64::from(exponent));
        }
        assert_eq!([0.0, f64::INFINITY].map(log2), [f64::NEG_INFINITY, f64::INFINITY]);
        assert!(log2(-1.0).is_nan() && log2(f64::NAN).is_nan());
        assert_eq!(log2(1e-310), libm::log2(1e-310));
    }

    #[test]
    fn powers_have_the_digits_that_a_step_size_needs() {
        for k in -1_021_999..=1_021_999 {
            let x = 1e-3 * f64::from(k);
            let apart = (exp2(x) / libm::exp2(x) - 1.0).abs();
            // Measured: 2.0e-4.
            assert!(apart < 2.1e-4, "{x}: {apart:e}");
        }
        assert_eq!([-3.0, 0.0, 10.0].map(exp2), [0.125, 1.0, 1024.0]);
        let far = [f64::NEG_INFINITY, -2000.0, 2000.0, f64::INFINITY];
        assert_eq!(far.map(exp2), [0.0, 0.0, f64::INFINITY, f64::INFINITY]);
        assert!(exp2(f64::NAN).is_nan());
    }
}

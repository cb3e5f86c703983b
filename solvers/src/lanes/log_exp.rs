//! Logarithm and exponential of several numbers in single precision, as step controllers take them, by the
//! operations of `libm` in their order: the same bits.
//!
//! ```text
//! ln x = k ln 2 + ln(1 + f),   x = 2ᵏ (1 + f),   √½ < 1 + f < √2
//! exp x = 2ᵏ exp r,            x = k ln 2 + r,   |r| < 0.35
//! ```
//!
//! `e_logf.c` and `e_expf.c` of FreeBSD's msun, © 1993 Sun Microsystems: "Permission to use, copy, modify, and
//! distribute this software is freely granted, provided that this notice is preserved."

use std::f32::consts::LOG2_E;

use wide::{f32x8, i32x8};

use super::scalar::LANES;

const LG1: f32 = 0.666_666_6;
const LG2: f32 = 0.400_009_72;
const LG3: f32 = 0.284_987_87;
const LG4: f32 = 0.242_790_79;
/// High bits of ln 2, and the rest of it.
const LOG_LN2: [f32; 2] = [0.693_138_1, 9.058_001e-6];
const EXP_LN2: [f32; 2] = [0.693_145_75, 1.428_606_8e-6];
const P1: f32 = 0.166_666_25;
const P2: f32 = -0.002_766_733_3;

/// Bits of √½, and what they lack to those of 1.
const ROOT_HALF: i32 = 0x3f35_04f3;
const TO_ONE: i32 = 0x3f80_0000 - ROOT_HALF;
/// `|x|` from which [`exp`] is left to `libm`: far from where the result is no normal number.
const LARGE: f32 = 80.0;

/// Natural logarithm of each, in single precision.
pub(super) fn log(x: [f64; LANES]) -> [f64; LANES] {
    let x = f32x8::new(x.map(|x| x as f32));
    let is_normal = x.simd_ge(f32x8::splat(f32::MIN_POSITIVE)) & x.simd_le(f32x8::splat(f32::MAX));
    let log = if is_normal.all() { normal_log(x).to_array() } else { x.to_array().map(libm::logf) };
    log.map(f64::from)
}

#[inline(always)]
fn normal_log(x: f32x8) -> f32x8 {
    let bits = x.to_bits().cast_signed() + i32x8::splat(TO_ONE);
    let k = (bits >> 23_u32) - i32x8::splat(0x7f);
    let x = of_bits((bits & i32x8::splat(0x007f_ffff)) + i32x8::splat(ROOT_HALF));
    let f = x - 1.0;
    let s = f / (f + 2.0);
    let z = s * s;
    let w = z * z;
    let r = z * (w * LG3 + LG1) + w * (w * LG4 + LG2);
    let half_f_sq = f * 0.5 * f;
    let k = f32x8::from_i32x8(k);
    s * (half_f_sq + r) + k * LOG_LN2[1] - half_f_sq + f + k * LOG_LN2[0]
}

/// Exponential of each, in single precision.
pub(super) fn exp(x: [f64; LANES]) -> [f64; LANES] {
    let x = f32x8::new(x.map(|x| x as f32));
    let exp = if x.abs().simd_lt(f32x8::splat(LARGE)).all() {
        small_exp(x).to_array()
    } else {
        x.to_array().map(libm::expf)
    };
    exp.map(f64::from)
}

#[inline(always)]
fn small_exp(x: f32x8) -> f32x8 {
    let above = |bits: u32| x.abs().simd_ge(f32x8::splat(f32::from_bits(bits + 1)));
    // |x| above 2⁻¹⁴, ln 2/2, 3/2 ln 2.
    let (is_reduced, is_far) = (above(0x3eb1_7218), above(0x3f85_1592));
    let one = f32x8::splat(1.0).copysign(x);
    let nearest = is_far.select(x * LOG2_E + one * 0.5, one);
    let n = is_reduced.select(nearest, f32x8::ZERO).fast_trunc_int();
    let k = f32x8::from_i32x8(n);
    let (high, low) = (x - k * EXP_LN2[0], k * EXP_LN2[1]);
    let r = high - low;
    let r_sq = r * r;
    let c = r - r_sq * (r_sq * P2 + P1);
    let y = r * c / (f32x8::splat(2.0) - c) - low + high + 1.0;
    let y = above(0x3900_0000).select(y, x + 1.0);
    y * of_bits((n + i32x8::splat(0x7f)) << 23_u32)
}

#[inline(always)]
fn of_bits(bits: i32x8) -> f32x8 {
    f32x8::from_bits(bits.cast_unsigned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_same(each: [f64; LANES]) {
        for ((x, log), exp) in each.into_iter().zip(log(each)).zip(exp(each)) {
            let expected = [libm::logf(x as f32), libm::expf(x as f32)].map(f64::from);
            for (found, expected) in [log, exp].into_iter().zip(expected) {
                let same = found.to_bits() == expected.to_bits();
                assert!(same || (found.is_nan() && expected.is_nan()), "{x:e}");
            }
        }
    }

    #[test]
    fn logarithms_and_exponentials_are_those_of_libm_to_the_bit() {
        let mut random = fastrand::Rng::with_seed(1);
        for _ in 0..50_000 {
            assert_same(std::array::from_fn(|_| 2.0 * random.f64() - 0.5));
            assert_same(std::array::from_fn(|_| 200.0 * random.f64() - 100.0));
            assert_same(std::array::from_fn(|_| libm::exp2(240.0 * random.f64() - 120.0)));
            assert_same(std::array::from_fn(|_| -libm::exp2(-30.0 * random.f64())));
        }
    }

    #[test]
    fn logarithms_and_exponentials_at_the_edges_are_those_of_libm() {
        let bits = |bits: u32| f64::from(f32::from_bits(bits));
        let largest = f64::from(f32::MAX);
        for x in [
            [1.0, 0.0, -0.0, 0.999_999_94, 1.000_000_1, largest, bits(0x0080_0000), bits(1)],
            [0.5, 2.0, 1.0, bits(ROOT_HALF as u32), bits(ROOT_HALF as u32 - 1), 79.9, -79.9, 1e-9],
            [0x3eb1_7218, 0x3eb1_7219, 0x3f85_1592, 0x3f85_1593, 0x3900_0000, 0x3900_0001, 1, 2]
                .map(bits),
            [80.0, -80.0, 88.8, -104.0, 1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN],
        ] {
            assert_same(x);
            assert_same(x.map(|x| -x));
        }
    }
}

//! Sine and cosine of several angles at once, by the operations of `libm` in their order: the same bits.
//!
//! ```text
//! sin x = x + x³ (S₁ + S₂ x² + … + S₆ x¹⁰),   cos x = 1 − x²/2 + x⁴ (C₁ + C₂ x² + … + C₆ x¹⁰),   |x| ≤ π/4
//! ```
//!
//! `k_sin.c` and `k_cos.c` of FreeBSD's msun, © 1993 Sun Microsystems: "Permission to use, copy, modify, and
//! distribute this software is freely granted, provided that this notice is preserved."

use super::{LANES, Simd};

const S1: f64 = -0.16666666666666632;
const S2: f64 = 0.00833333333332249;
const S3: f64 = -0.0001984126982985795;
const S4: f64 = 2.7557313707070068e-06;
const S5: f64 = -2.5050760253406863e-08;
const S6: f64 = 1.58969099521155e-10;
const C1: f64 = 0.0416666666666666;
const C2: f64 = -0.001388888888887411;
const C3: f64 = 2.480158728947673e-05;
const C4: f64 = -2.7557314351390663e-07;
const C5: f64 = 2.087572321298175e-09;
const C6: f64 = -1.1359647557788195e-11;

/// The first number above those that `libm` takes as they are, some π/4.
const REDUCED: f64 = f64::from_bits(0x3fe9_21fc_0000_0000);

/// Sine and cosine of each.
#[inline(always)]
pub(super) fn sin_cos<V: Simd>(x: V) -> (V, V) {
    let all = (1 << V::N) - 1;
    if V::splat(REDUCED).is_above(x.abs()) == all { (sin(x), cos(x)) } else { one_by_one(x) }
}

#[inline(always)]
fn sin<V: Simd>(x: V) -> V {
    let of = V::splat;
    let z = x * x;
    let w = z * z;
    let r = (z * of(S4) + of(S3)) * z + of(S2) + z * w * (z * of(S6) + of(S5));
    let sin = x + z * x * (z * r + of(S1));
    // Of −0 the sum is +0.
    sin.or_sign_of(x)
}

#[inline(always)]
fn cos<V: Simd>(x: V) -> V {
    let of = V::splat;
    let z = x * x;
    let w = z * z;
    let r = z * ((z * of(C3) + of(C2)) * z + of(C1)) + w * w * ((z * of(C6) + of(C5)) * z + of(C4));
    let half_z = z * of(0.5);
    let w = of(1.0) - half_z;
    w + (((of(1.0) - w) - half_z) + z * r)
}

#[cold]
#[inline(never)]
fn one_by_one<V: Simd>(x: V) -> (V, V) {
    let mut cos = [0.0; LANES];
    let sin = V::from_fn(|i| {
        let each = libm::sincos(x.lane(i));
        cos[i] = each.1;
        each.0
    });
    (sin, V::from_fn(|i| cos[i]))
}

#[cfg(test)]
mod tests {
    use wide::{f64x2, f64x8};

    use super::*;

    fn assert_same(each: [f64; LANES]) {
        assert_same_by::<f64x8>(&each);
        each.chunks_exact(2).for_each(assert_same_by::<f64x2>);
    }

    fn assert_same_by<V: Simd>(each: &[f64]) {
        let (sin, cos) = sin_cos(V::from_fn(|i| each[i]));
        for (i, x) in each.iter().enumerate() {
            let (sin, cos, expected) = (sin.lane(i), cos.lane(i), libm::sincos(*x));
            assert_eq!(
                [sin, cos].map(f64::to_bits),
                [expected.0, expected.1].map(f64::to_bits),
                "{x}"
            );
        }
    }

    #[test]
    fn sines_and_cosines_are_those_of_libm_to_the_bit() {
        let mut random = fastrand::Rng::with_seed(1);
        for _ in 0..100_000 {
            // Up to π/4, each size as often as another, then some beyond.
            assert_same(std::array::from_fn(|_| 1.57 * random.f64() - 0.785));
            let tiny = |random: &mut fastrand::Rng| libm::exp2(-60.0 * random.f64()) * 0.785;
            assert_same(std::array::from_fn(|i| tiny(&mut random) * [1.0, -1.0][i % 2]));
        }
        for _ in 0..1000 {
            assert_same(std::array::from_fn(|_| 200.0 * random.f64() - 100.0));
        }
    }

    #[test]
    fn sines_and_cosines_at_the_edges_are_those_of_libm() {
        let edges = [
            [0.0, -0.0, 5e-324, -1e-310, 2.2e-308, -1e-8, 1.05e-8, -1.1e-8],
            [REDUCED.next_down(), -REDUCED.next_down(), 0.785, -0.785, 0.1, -0.2, 0.3, 0.0],
            [REDUCED, -REDUCED, -0.0, 1.6, 1e5, -1e22, 1e-300, 3.0],
            [1e300, -1e-300, -0.0, 0.5, 2.0, 4.0, 8.0, 16.0],
        ];
        for mut each in edges {
            assert_same(each);
            each.reverse();
            assert_same(each);
        }
        let (sin, cos) = sin_cos(f64x8::splat(f64::INFINITY));
        assert!((0..LANES).all(|i| sin.lane(i).is_nan() && cos.lane(i).is_nan()));
    }
}

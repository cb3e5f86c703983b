//! The numbers that coefficients are: plain ones, or of twice the digits.

use twofloat::TwoFloat;
use wide::f64x4;

use super::rows::{MAX_ORDER, Row};
use crate::real::Real;

/// A number that series are made of.
pub trait Base: Real {
    /// The highest order of a series with code of its own.
    const HIGHEST_UNROLLED: usize;

    /// `a b + c`, fused where the target has an instruction for it.
    fn fma(a: Self, b: Self, c: Self) -> Self;

    /// `Σ a_j b_(k−j)` over `j = 1 … k − 1`, of more than four terms.
    fn long_inner(k: usize, a: &Row<Self>, b: &Row<Self>) -> Self {
        (1..k).fold(Self::cst(0.0), |sum, j| Self::fma(a.at(j), b.at(k - j), sum))
    }
}

impl Base for f64 {
    // Where the compiler is not asked for speed, it is spared the code of each order; the bits are the same.
    const HIGHEST_UNROLLED: usize = if cfg!(debug_assertions) { 0 } else { MAX_ORDER };

    #[inline(always)]
    fn fma(a: Self, b: Self, c: Self) -> Self {
        if cfg!(target_feature = "fma") { a.mul_add(b, c) } else { a * b + c }
    }

    /// Four terms at a time: first the one to four after which as many are left as fours hold.
    #[inline(always)]
    fn long_inner(k: usize, a: &Row<Self>, b: &Row<Self>) -> Self {
        let first = f64x4::new(FIRST[(k - 2) % 4].map(f64::from_bits));
        let mut sums = (four(a, 1) * four_down(b, k - 1)) & first;
        for fours_left in (1..(k + 2) / 4).rev() {
            let (a, b) = (four(a, k - 4 * fours_left), four_down(b, 4 * fours_left));
            // The vectors' own `mul_add` is fused on some targets where the one above is not.
            sums = if cfg!(target_feature = "fma") { a.mul_add(b, sums) } else { a * b + sums };
        }
        let [first, second, third, fourth] = sums.to_array();
        (first + third) + (second + fourth)
    }
}

/// Masks of the first one, two, three and four of four numbers.
const FIRST: [[u64; 4]; 4] = [[!0, 0, 0, 0], [!0, !0, 0, 0], [!0, !0, !0, 0], [!0; 4]];

/// Coefficients from the one of order `k` upwards.
#[inline(always)]
fn four(row: &Row<f64>, k: usize) -> f64x4 {
    f64x4::new([row.at(k), row.at(k + 1), row.at(k + 2), row.at(k + 3)])
}

/// Those from the one of order `k` downwards. Read upwards and turned, they are one load and one permutation.
#[inline(always)]
fn four_down(row: &Row<f64>, k: usize) -> f64x4 {
    let [fourth, third, second, first] = four(row, k - 3).to_array();
    f64x4::new([first, second, third, fourth])
}

impl Base for TwoFloat {
    // An operation is twenty: loops cost little.
    const HIGHEST_UNROLLED: usize = 0;

    #[inline]
    fn fma(a: Self, b: Self, c: Self) -> Self {
        a * b + c
    }
}

#[cfg(test)]
mod tests {
    use super::super::rows::Rows;
    use super::*;

    #[test]
    fn long_sums_take_each_term_once_and_no_other() {
        for k in 6..=MAX_ORDER {
            let rows = Rows::new();
            let n = std::cell::Cell::new(0);
            let table = rows.table(&n, k);
            let (a, b) = (table.next(), table.next());
            for j in 0..=MAX_ORDER {
                // Orders that no such sum takes are poison.
                let is_term = (1..k).contains(&j);
                let of = |x: usize| if is_term { (x % 97) as f64 } else { f64::NAN };
                a.set(j, of(j * j + 3));
                b.set(j, of(7 * j + 5));
            }
            // Whole numbers: the order of summation is no matter.
            let sum: f64 = (1..k).map(|j| a.at(j) * b.at(k - j)).sum();
            assert_eq!(f64::long_inner(k, a, b), sum, "order {k}");
        }
    }
}

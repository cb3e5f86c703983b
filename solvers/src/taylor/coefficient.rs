//! The types of Taylor coefficients: `f64`, double-double numbers, and the numbers of two runs at once.

use std::ops::{Add, BitAnd, Mul};

use wide::{f64x2, f64x4, f64x8};

use super::rows::{MAX_ORDER, Row, Tail};
use crate::lanes::{FUSED, Lanes, Simd};
use crate::real::{Ordered, Real};

/// The highest order whose sums run from the middle outwards, which is the fastest form for straight-line code.
pub(super) const SHORT: usize = 5;

/// A number that can be the coefficient of a series.
pub trait Coefficient: Real {
    /// The highest order for which specialised code is compiled.
    const HIGHEST_UNROLLED: usize;

    /// The highest order that has code of its own, from five to thirteen. Above it, four orders share their code.
    const HIGHEST_APIECE: usize = SHORT;

    /// Whether right-hand sides of any system are [traced](super::trace) with it.
    const IS_TRACED: bool = false;

    /// The type on which decisions are taken.
    type Rounded: Ordered;

    /// The nearest number of that type.
    fn rounded(self) -> Self::Rounded;

    /// `a b + c`, fused where the target has an instruction for it.
    #[inline]
    fn fma(a: Self, b: Self, c: Self) -> Self {
        a * b + c
    }

    /// `Σ a_j b_(k−j)` over `j = 1 … k − 1`, a sum of more than four terms.
    fn long_inner(k: usize, a: &Row<Self>, b: Tail<'_, Self>) -> Self {
        (1..k).fold(Self::cst(0.0), |sum, j| Self::fma(a.at(j), b.at(k - j), sum))
    }
}

/// Without optimisation, no code is specialised to orders, which saves compile time. The bits are the same.
const UNROLLED: usize = if cfg!(debug_assertions) { 0 } else { MAX_ORDER };

impl Coefficient for f64 {
    const HIGHEST_UNROLLED: usize = UNROLLED;

    type Rounded = Self;

    #[inline(always)]
    fn rounded(self) -> Self {
        self
    }

    #[inline(always)]
    fn fma(a: Self, b: Self, c: Self) -> Self {
        if FUSED { a.mul_add(b, c) } else { a * b + c }
    }

    #[inline(always)]
    fn long_inner(k: usize, a: &Row<Self>, b: Tail<'_, Self>) -> Self {
        sum_by_fours::<Self, f64x4>(k, a, b)
    }
}

/// Two runs at once, with the bits that each has alone.
impl Coefficient for Lanes<f64x2> {
    const HIGHEST_UNROLLED: usize = UNROLLED;

    // The largest value for which there is code. It makes these runs 5 % faster; single runs do not gain by it.
    const HIGHEST_APIECE: usize = 13;

    type Rounded = Self;

    #[inline(always)]
    fn rounded(self) -> Self {
        self
    }

    #[inline(always)]
    fn fma(a: Self, b: Self, c: Self) -> Self {
        a.mul_add(b, c)
    }

    #[inline(always)]
    fn long_inner(k: usize, a: &Row<Self>, b: Tail<'_, Self>) -> Self {
        sum_by_fours::<Self, f64x8>(k, a, b)
    }
}

/// Four numbers from number k on.
#[inline(always)]
fn upwards<B: Coefficient, F: Four<B>>(row: &Row<B>, k: usize) -> F {
    F::of([row.at(k), row.at(k + 1), row.at(k + 2), row.at(k + 3)])
}

/// Four numbers from number k down. Loaded in ascending order and reversed, they need one load and one permutation.
#[inline(always)]
fn downwards<B: Coefficient, F: Four<B>>(row: Tail<'_, B>, k: usize) -> F {
    F::turned([row.at(k - 3), row.at(k - 2), row.at(k - 1), row.at(k)])
}

/// [`long_inner`](Coefficient::long_inner), four terms at a time. The first vector takes the one to four terms after
/// which the number of remaining terms is a multiple of four.
#[inline(always)]
fn sum_by_fours<B: Coefficient, F: Four<B>>(k: usize, a: &Row<B>, b: Tail<'_, B>) -> B {
    let mut sums = (upwards::<B, F>(a, 1) * downwards(b, k - 1)) & F::first(FIRST[(k - 2) % 4]);
    for fours_left in (1..(k + 2) / 4).rev() {
        let (a, b): (F, F) = (upwards(a, k - 4 * fours_left), downwards(b, 4 * fours_left));
        sums = a.mul_add(b, sums);
    }
    sums.sum()
}

/// Masks that select the first one, two, three and four of four numbers.
const FIRST: [[u64; 4]; 4] = [[!0, 0, 0, 0], [!0, !0, 0, 0], [!0, !0, !0, 0], [!0; 4]];

/// A vector of four numbers.
trait Four<B>: Copy + Mul<Output = Self> + Add<Output = Self> + BitAnd<Output = Self> {
    /// The vector of these four numbers.
    fn of(each: [B; 4]) -> Self;

    /// The vector of these four numbers in reverse order.
    fn turned(each: [B; 4]) -> Self;

    /// The vector of these four masks.
    fn first(each: [u64; 4]) -> Self;

    /// `self · by + plus`, fused where the target has an instruction for it.
    fn mul_add(self, by: Self, plus: Self) -> Self;

    /// `(first + third) + (second + fourth)`.
    fn sum(self) -> B;
}

impl Four<f64> for f64x4 {
    #[inline(always)]
    fn of(each: [f64; 4]) -> Self {
        Self::new(each)
    }

    #[inline(always)]
    fn turned([a, b, c, d]: [f64; 4]) -> Self {
        Self::new([d, c, b, a])
    }

    #[inline(always)]
    fn first(each: [u64; 4]) -> Self {
        Self::new(each.map(f64::from_bits))
    }

    #[inline(always)]
    fn mul_add(self, by: Self, plus: Self) -> Self {
        if FUSED { self.mul_add(by, plus) } else { self * by + plus }
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        let [a, b, c, d] = self.to_array();
        (a + c) + (b + d)
    }
}

impl Four<Lanes<f64x2>> for f64x8 {
    #[inline(always)]
    fn of([a, b, c, d]: [Lanes<f64x2>; 4]) -> Self {
        let [(a, a_2), (b, b_2), (c, c_2), (d, d_2)] = [a, b, c, d].map(|x| (x.lane(0), x.lane(1)));
        Self::new([a, a_2, b, b_2, c, c_2, d, d_2])
    }

    #[inline(always)]
    fn turned([a, b, c, d]: [Lanes<f64x2>; 4]) -> Self {
        Self::of([d, c, b, a])
    }

    #[inline(always)]
    fn first([a, b, c, d]: [u64; 4]) -> Self {
        Self::new([a, a, b, b, c, c, d, d].map(f64::from_bits))
    }

    #[inline(always)]
    fn mul_add(self, by: Self, plus: Self) -> Self {
        Simd::mul_add(self, by, plus)
    }

    #[inline(always)]
    fn sum(self) -> Lanes<f64x2> {
        let [a, a_2, b, b_2, c, c_2, d, d_2] = self.to_array();
        let [a, a_2, b, b_2] =
            (f64x4::new([a, a_2, b, b_2]) + f64x4::new([c, c_2, d, d_2])).to_array();
        Lanes::from_fn(|run| [a, a_2][run]) + Lanes::from_fn(|run| [b, b_2][run])
    }
}

#[cfg(test)]
mod tests {
    use super::super::rows::Rows;
    use super::*;

    #[test]
    fn long_sums_take_each_term_once_and_no_other() {
        for k in 6..=MAX_ORDER {
            let (rows, both) = (Rows::new(), Rows::new());
            let n = std::cell::Cell::new(0);
            let [[a, b], [a_2, b_2]] = [(); 2].map(|()| [(); 2].map(|()| rows.table(&n, k).next()));
            n.set(0);
            let [a_both, b_both] = [(); 2].map(|()| both.table(&n, k).next());
            for j in 0..=MAX_ORDER {
                // Orders that do not belong to the sum are NaN, so that reading one shows.
                let is_term = (1..k).contains(&j);
                let of = |x: usize| if is_term { (x % 97) as f64 } else { f64::NAN };
                let each = [of(j * j + 3), of(7 * j + 5), of(11 * j + 2), of(j * j + 5 * j)];
                a.set(j, each[0]);
                b.set(j, each[1]);
                a_2.set(j, each[2]);
                b_2.set(j, each[3]);
                a_both.set(j, Lanes::from_fn(|run| [each[0], each[2]][run]));
                b_both.set(j, Lanes::from_fn(|run| [each[1], each[3]][run]));
            }
            // The terms are integers, so the order of summation does not matter.
            let sum =
                |a: &Row<f64>, b: &Row<f64>| -> f64 { (1..k).map(|j| a.at(j) * b.at(k - j)).sum() };
            assert_eq!(f64::long_inner(k, a, b.tail(0)), sum(a, b), "order {k}");
            b.set(k, 3.0);
            let ahead: f64 = (1..k).map(|j| a.at(j) * b.at(k + 1 - j)).sum();
            assert_eq!(f64::long_inner(k, a, b.tail(1)), ahead, "order {k} + 1");
            let of_both = Lanes::<f64x2>::long_inner(k, a_both, b_both.tail(0));
            assert_eq!([0, 1].map(|run| of_both.lane(run)), [sum(a, b), sum(a_2, b_2)], "{k}");
        }
    }
}

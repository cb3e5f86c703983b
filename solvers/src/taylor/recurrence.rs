//! The recurrences of Taylor coefficients, one function each.
//!
//! With `a(s) = Σ a_k sᵏ` and so on, each function gives the coefficient `k ≥ 1` of a result from the coefficients of
//! its arguments up to order `k` and its own lower ones; `product_ahead` gives the next order. The coefficient of
//! order `k` of an argument is passed by value, because it was computed last; short sums run from the middle
//! outwards, so that the newest terms are added last. Pass the operand on the critical path as the second factor of a
//! product or the dividend of a quotient: only one fused operation follows it.
//!
//! A. Griewank, A. Walther, *Evaluating Derivatives*, 2nd ed., SIAM (2008), table 13.1 and 13.2;
//! E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I*, I.8.

use super::coefficient::{Coefficient, SHORT};
use super::rows::Row;

/// The largest integer exponent for which a power is computed by products.
pub(super) const LARGEST_PRODUCT: f64 = 64.0;

/// `1/k`, which the compiler evaluates where the order is a constant.
#[inline(always)]
pub(super) fn reciprocal<B: Coefficient>(k: usize) -> B {
    B::cst(1.0) / k as f64
}

/// `Σ a_j b_(k−j)` over `j = 1 … k − 1`, for `k ≥ 1`; `None` where the sum is empty.
#[inline(always)]
pub(super) fn inner<B: Coefficient>(k: usize, a: &Row<B>, b: &Row<B>) -> Option<B> {
    if k > SHORT { Some(B::long_inner(k, a, b.tail(0))) } else { short_inner(k, a, b) }
}

/// The same sum, from the middle outwards.
#[inline(always)]
fn short_inner<B: Coefficient>(k: usize, a: &Row<B>, b: &Row<B>) -> Option<B> {
    let mut sum = if k.is_multiple_of(2) { Some(a.at(k / 2) * b.at(k / 2)) } else { None };
    for j in (1..k.div_ceil(2)).rev() {
        let of_j = match sum {
            None => a.at(j) * b.at(k - j),
            Some(sum) => B::fma(a.at(j), b.at(k - j), sum),
        };
        sum = Some(B::fma(a.at(k - j), b.at(j), of_j));
    }
    sum
}

/// The same sum for `b = a`.
#[inline(always)]
fn inner_square<B: Coefficient>(k: usize, a: &Row<B>) -> Option<B> {
    if k > SHORT {
        return Some(B::long_inner(k, a, a.tail(0)));
    }
    let mut pairs = None;
    for j in (1..k.div_ceil(2)).rev() {
        pairs = Some(match pairs {
            None => a.at(j) * a.at(k - j),
            Some(sum) => B::fma(a.at(j), a.at(k - j), sum),
        });
    }
    let middle = if k.is_multiple_of(2) { Some(a.at(k / 2)) } else { None };
    match (middle, pairs) {
        (None, None) => None,
        (Some(middle), None) => Some(middle * middle),
        (None, Some(pairs)) => Some(pairs * 2.0),
        (Some(middle), Some(pairs)) => Some(B::fma(middle, middle, pairs * 2.0)),
    }
}

/// `a b + sum`, where an empty sum is `None`.
#[inline(always)]
fn onto<B: Coefficient>(sum: Option<B>, a: B, b: B) -> B {
    match sum {
        None => a * b,
        Some(sum) => B::fma(a, b, sum),
    }
}

/// `a − sum`, where an empty sum is `None`.
#[inline(always)]
fn less<B: Coefficient>(a: B, sum: Option<B>) -> B {
    match sum {
        None => a,
        Some(sum) => a - sum,
    }
}

/// `c = a b`: `c_k = Σ a_j b_(k−j)`.
#[inline(always)]
pub(super) fn product<B: Coefficient>(
    k: usize,
    (a, a_k): (&Row<B>, B),
    (b, b_k): (&Row<B>, B),
) -> B {
    B::fma(b_k, a.at(0), onto(inner(k, a, b), a_k, b.at(0)))
}

/// `c_(k+1) = Σ a_j b_(k+1−j)` of `c = a b`, for `k ≥ 0`, in a run of order `k` in which the factors are known to
/// order `k + 1`.
#[inline(always)]
pub(super) fn product_ahead<B: Coefficient>(
    k: usize,
    (a, a_next): (&Row<B>, B),
    (b, b_next): (&Row<B>, B),
) -> B {
    B::fma(b_next, a.at(0), onto(inner_ahead(k, a, b), a_next, b.at(0)))
}

/// `Σ a_j b_(k+1−j)` over `j = 1 … k`; `None` where the sum is empty.
#[inline(always)]
pub(super) fn inner_ahead<B: Coefficient>(k: usize, a: &Row<B>, b: &Row<B>) -> Option<B> {
    if k > SHORT {
        // The long sum has as many terms as a sum of order k; the last term is added separately.
        Some(B::fma(a.at(k), b.at(1), B::long_inner(k, a, b.tail(1))))
    } else {
        short_inner(k + 1, a, b)
    }
}

/// `c = a²`.
#[inline(always)]
pub(super) fn square<B: Coefficient>(k: usize, (a, a_k): (&Row<B>, B)) -> B {
    onto(inner_square(k, a), a.at(0) * 2.0, a_k)
}

/// `c = a/b`: `b_0 c_k = a_k − Σ c_j b_(k−j)` over `j < k`, computed as `a_k/b_0 − (Σ …)/b_0`, so that only one
/// operation follows `a_k`. The row `c` keeps `1/b_0`.
#[inline(always)]
pub(super) fn quotient<B: Coefficient>(k: usize, a_k: B, (b, b_k): (&Row<B>, B), c: &Row<B>) -> B {
    let rest = onto(inner(k, c, b), b_k, c.at(0));
    B::fma(a_k, c.kept.get(), -(rest * c.kept.get()))
}

/// `c = √a`: `2 c_0 c_k = a_k − Σ c_j c_(k−j)` over `0 < j < k`. The row `c` keeps `1/(2 c_0)`.
#[inline(always)]
pub(super) fn sqrt<B: Coefficient>(k: usize, a_k: B, c: &Row<B>) -> B {
    less(a_k, inner_square(k, c)) * c.kept.get()
}

/// `Σ j a_j b_(k−j)/k` over `j = 1 … k`, from the row `d_j = j a_j`: the coefficient of the integral of `b da/ds`.
#[inline(always)]
pub(super) fn integral<B: Coefficient>(k: usize, (d, a_k): (&Row<B>, B), b: &Row<B>) -> B {
    onto(inner(k, d, b).map(|sum| sum * reciprocal::<B>(k)), a_k, b.at(0))
}

/// `c = ln a`: `a_0 c_k = a_k − Σ j c_j a_(k−j)/k` over `0 < j < k`, from the row `d_j = j c_j`, which keeps `1/a_0`.
#[inline(always)]
pub(super) fn ln<B: Coefficient>(k: usize, (a, a_k): (&Row<B>, B), d: &Row<B>) -> B {
    less(a_k, inner(k, d, a).map(|sum| sum * reciprocal::<B>(k))) * d.kept.get()
}

/// `c = aᵖ`: `k a_0 c_k = Σ (p (k − j) − j) c_j a_(k−j)` over `j < k`. The row `c` keeps `1/a_0`.
#[inline(always)]
pub(super) fn power<B: Coefficient>(k: usize, (a, a_k): (&Row<B>, B), p: f64, c: &Row<B>) -> B {
    let sum = inner_of_power(k, p, c, a);
    B::fma(a_k * p, c.at(0), sum * reciprocal::<B>(k)) * c.kept.get()
}

/// `Σ (p (k − j) − j) c_j a_(k−j)` over `j = 1 … k − 1`.
#[inline(always)]
pub(super) fn inner_of_power<B: Coefficient>(k: usize, p: f64, c: &Row<B>, a: &Row<B>) -> B {
    let mut sum = B::cst(0.0);
    for j in 1..k {
        let weight = p * (k - j) as f64 - j as f64;
        sum = B::fma(c.at(j) * weight, a.at(k - j), sum);
    }
    sum
}

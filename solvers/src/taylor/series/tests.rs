//! Tests of series against the functions that they expand.

use std::cell::Cell;

use super::super::rows::{MAX_ORDER, N_ROWS, Rows};
use super::*;

/// Every operation of a [`Real`], for an argument near 0.7 whose rate is one.
pub(crate) fn operations<S: Real>(x: S) -> [S; 11] {
    let (sin, cos) = x.sin_cos();
    let length = S::length([x * x, sin], [x * 2.0, cos]);
    let beside = S::length([x, S::cst(0.4)], [S::cst(1.0), S::cst(0.0)]);
    [
        length.rho.value * length.rate + x.over(&length.rho) + beside.rho.value * beside.rate,
        x * x / (x + 1.0) - S::cst(2.0) / x,
        (x * x + 1.0).sqrt() * -x,
        sin * cos * 2.0 - cos,
        (x * -0.5).exp() * x,
        (x / 3.0 + 1.0).ln() + sin,
        (x + 0.5).powf(1.5) + x.powf(-0.7),
        (x - 0.7).powf(3.0) + (x - 0.7).powf(2.0),
        S::cst(1.5) - x.powf(1.0) * S::cst(2.0).sqrt(),
        S::cst(2.0).over(&(x + 1.0).divisor()) + (x - 0.2).over(&S::cst(3.0).divisor()),
        curves(x),
    ]
}

/// Second derivatives of curves whose angle is sin x, x², and 2x.
fn curves<S: Real>(x: S) -> S {
    let (sin, cos) = x.sin_cos();
    let arms = [S::cst(0.3), S::cst(-1.2)];
    let by_sine = S::turning(arms, [sin, cos]);
    let of_curve = by_sine.sin * by_sine.along[0] + by_sine.cos * by_sine.along[1];
    let of_rates = by_sine.rates[0] * by_sine.rates[1];
    let [a, b] = S::less_turning([x, cos], by_sine, -sin);
    let by_square = S::turning(arms, [x * x, x * 2.0]);
    let [c, d] = S::less_turning([S::cst(0.0), S::cst(0.5)], by_square, S::cst(2.0));
    let evenly = S::turning(arms, [x * 2.0, S::cst(2.0)]);
    let [e, f] = S::less_turning([x, S::cst(0.5)], evenly, S::cst(0.0));
    of_curve + of_rates + a * b + c * d + e * f
}

/// Coefficients of order `k` of [`operations`] about `x`, where the lower ones are in `rows`.
fn coefficients(rows: &Rows<f64>, x: f64, k: usize) -> [f64; 11] {
    let n = Cell::new(0);
    let x = Series::new(rows.table(&n, k), [x, 1.0, 0.0][k.min(2)]);
    let all = operations(x).map(|series| series.coefficient(k));
    assert!(n.get() <= 2 * N_ROWS, "{} rows", n.get());
    all
}

/// A table with more rows than [`operations`] needs.
pub(crate) fn enough_rows<B: Coefficient>() -> Rows<B> {
    let mut rows = Rows::new();
    rows.grow(2 * N_ROWS);
    rows
}

/// A table filled with NaN, so that a coefficient that is read before it is written shows.
fn poisoned() -> Rows<f64> {
    let (rows, n) = (enough_rows(), Cell::new(0));
    for _ in 0..2 * N_ROWS {
        let row = rows.table(&n, 0).next();
        (0..=MAX_ORDER + 1).for_each(|k| row.set(k, f64::NAN));
    }
    rows
}

#[test]
fn series_sum_to_what_they_expand() {
    let (x, s) = (0.7, 0.07);
    let rows = poisoned();
    let mut sums = [0.0; 11];
    for k in 0..18 {
        let terms = coefficients(&rows, x, k);
        if k == 0 {
            assert_eq!(terms, operations(x), "values are those of f64 to the bit");
        }
        for (sum, term) in sums.iter_mut().zip(terms) {
            *sum += term * f64::powi(s, k as i32);
        }
    }
    for (sum, exact) in sums.iter().zip(operations(x + s)) {
        // Measured: 8.9e-16.
        assert!((sum - exact).abs() < 5e-15, "{sum} for {exact}");
    }
}

#[test]
fn curves_one_order_ahead_are_those_of_their_definition() {
    let rows = poisoned();
    for k in 0..=MAX_ORDER {
        let n = Cell::new(0);
        let x = Series::new(rows.table(&n, k), [0.7, 1.0, 0.0][k.min(2)]);
        let (a, arms) = ([x, x.sin_cos().1], [0.3, -1.2].map(Series::cst));
        let omega = x * 2.0;
        let of_values = turning_of_values(arms, [x * x, omega]);
        let Turning { along, rates, .. } = of_values;
        let [x_1, y_1] = less_turning_of_values(a, [along, rates, arms], omega, Series::cst(2.0));
        let [x_2, y_2] =
            Series::less_turning(a, Series::turning(arms, [x * x, omega]), Series::cst(2.0));
        for (own, other) in [(x_1, x_2), (y_1, y_2)] {
            let (own, other) = (own.coefficient(k), other.coefficient(k));
            assert!((own / other - 1.0).abs() < 1e-12, "order {k}: {own:e} for {other:e}");
        }
    }
}

#[test]
#[should_panic(expected = "was not ended at the order before 2")]
#[cfg(debug_assertions)]
fn a_curve_that_is_not_ended_is_refused() {
    let rows = enough_rows::<f64>();
    for k in 0..3 {
        let n = Cell::new(0);
        let x = Series::new(rows.table(&n, k), [0.7, 1.0, 0.0][k]);
        let curve = Series::turning([0.3, -1.2].map(Series::cst), [x * x, x * 2.0]);
        if k == 0 {
            let _ = Series::less_turning([x, x], curve, Series::cst(2.0));
        }
    }
}

/// Functions of two numbers, of which one may be constant.
struct Both;

impl Functions<2, 3> for Both {
    fn of<S: Real>(&self, [x, c]: [S; 2]) -> [S; 3] {
        let curve = S::turning([S::cst(1.0), S::cst(1.0)], [x * x, x * 2.0]);
        let [a, _] = S::less_turning([c, c], curve, S::cst(2.0));
        [x.sin_cos().0 * c + a, x, c]
    }
}

#[test]
fn functions_of_several_numbers_are_the_same_outlined() {
    let rows = poisoned();
    for k in 0..12 {
        let run = |is_outlined: bool| {
            let n = Cell::new(if is_outlined { 0 } else { N_ROWS / 2 });
            let x = Series::new(rows.table(&n, k), [0.7, 1.0, 0.0][k.min(2)]);
            // A linear result, which is not written to its row yet.
            let given = [x * 0.5 + 0.35, Series::constant(1.5)];
            let [y, again, c] =
                if is_outlined { Series::all_outlined(given, &Both) } else { Both.of(given) };
            // Later operations take further rows.
            [y * x, again * again, c * x, y / x].map(|series| series.coefficient(k))
        };
        assert_eq!(run(true), run(false), "order {k}");
    }
}

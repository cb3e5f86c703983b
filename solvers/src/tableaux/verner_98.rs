//! Verner's "most efficient" 9(8): sixteen stages, dense output of order eight.
//!
//! Order 9, embedded order 8 (the local estimate is O(h⁹)). Four more stages give the dense output; they are
//! evaluated only in steps that are interpolated. The tableau is too large to draw. Stages 2 to 7 have no weight in
//! the result.
//!
//! It is best at the tightest tolerances, 1e-9 and below: its weights are small (at most 0.57, and 36 in the stages),
//! so errors fall until the rounding of `f64` limits them. Verner's 8(7) was measured to be cheaper on contact runs
//! down to errors of 1e-11; near these, rounding with its larger weights (up to 32, and 123 in the stages) limits it.
//! At loose tolerances sixteen stages per step are too many, and a restart wastes more work than with a method of low
//! order.
//!
//! J. H. Verner, "Numerically optimal Runge–Kutta pairs with interpolants", Numer. Algorithms 53, 383–396 (2010); the
//! coefficients are those of his `RKV98.IIa.Efficient.000000349.081209`, rounded to f64 from forty digits. There the
//! dense output is in powers of θ with coefficients of up to 1.3e4, whose rounding left gaps of 4e-13 at the ends of
//! steps in tests. Here it is the same polynomial in nested form, converted with sixty digits, and the gaps are
//! 1.6e-15.

mod coefficients;

use crate::tableau::{Dense, Tableau};
use coefficients::{A, B, B_HAT, C, D, EXTRA};

/// The pair described above.
pub const VERNER_98: Tableau<16> = Tableau {
    order: 9,
    embedded_order: 8,
    c: C,
    a: A,
    b: B,
    b_hat: Some(B_HAT),
    b_hat_low: None,
    dense: Dense::Nested { extra: &EXTRA, d: &D },
};

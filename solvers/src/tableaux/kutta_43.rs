//! Kutta's 3/8 rule with an error estimate from the first stage of the next step (FSAL).
//!
//! ```text
//!   0  |
//!  1/3 |  1/3
//!  2/3 | −1/3    1
//!   1  |   1    −1     1
//!   1  |  1/8   3/8   3/8   1/8
//! -----+-------------------------------
//!   b  |  1/8   3/8   3/8   1/8    0
//!   b̂  |  3/20  3/10  9/20  1/5  −1/10
//! ```
//!
//! Order 4, embedded order 3, cubic Hermite dense output; four evaluations per step. Its stability interval on the
//! imaginary axis ends at `ω h = 2√2`, nearly three times as far as that of
//! [`DORMAND_PRINCE_5`](super::DORMAND_PRINCE_5), at two thirds of its evaluations. So it suits loose tolerances on
//! stiff springs.
//!
//! The conditions of order three leave b̂ one free parameter, which only scales the error estimate:
//!
//! ```text
//! error = h (−k₁ + 3 k₂ − 3 k₃ − 3 k₄ + 4 f(t₁, y₁))/40
//! ```
//!
//! This is a third difference for `ẏ = f(t)`, and `(hλ)⁴/120` for `ẏ = λ y`. (In the classical method, whose two
//! middle stages have the same node, the estimate would be a multiple of `k₄ − f(t₁, y₁)`, which is zero for `ẏ =
//! f(t)`.)
//!
//! W. Kutta, "Beitrag zur näherungsweisen Integration totaler Differentialgleichungen", Z. Math. Phys. 46, 435–453
//! (1901). The estimate follows from the order conditions by the FSAL idea for embedded formulas of E. Hairer, S. P.
//! Nørsett, G. Wanner, *Solving Ordinary Differential Equations I*, II.4.

use crate::tableau::{Dense, Tableau};

/// The pair drawn above.
pub const KUTTA_43: Tableau<5> = Tableau {
    order: 4,
    embedded_order: 3,
    c: [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0, 1.0],
    a: [
        &[],
        &[1.0 / 3.0],
        &[-1.0 / 3.0, 1.0],
        &[1.0, -1.0, 1.0],
        &[1.0 / 8.0, 3.0 / 8.0, 3.0 / 8.0, 1.0 / 8.0],
    ],
    b: [1.0 / 8.0, 3.0 / 8.0, 3.0 / 8.0, 1.0 / 8.0, 0.0],
    b_hat: Some([3.0 / 20.0, 3.0 / 10.0, 9.0 / 20.0, 1.0 / 5.0, -1.0 / 10.0]),
    b_hat_low: None,
    dense: Dense::Hermite,
};

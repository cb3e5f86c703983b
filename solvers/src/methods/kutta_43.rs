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
//! Order 4, embedded order 3, cubic Hermite dense output; four evaluations a step. Stable on the imaginary axis up to
//! `ω h = 2√2`, nearly three times as far as [`DORMAND_PRINCE_5`](super::DORMAND_PRINCE_5), at two thirds of its
//! evaluations: loose tolerances on stiff springs.
//!
//! The conditions of order three leave one direction of b̂ free, and with it the size of the estimate alone:
//!
//! ```text
//! error = h (−k₁ + 3 k₂ − 3 k₃ − 3 k₄ + 4 f(t₁, y₁))/40
//! ```
//!
//! a third difference on `ẏ = f(t)`, `(hλ)⁴/120` on `ẏ = λ y`. (In the classical method, whose middle stages share a
//! node, that direction is `k₄ − f(t₁, y₁)`, which sees nothing of `ẏ = f(t)`.)
//!
//! W. Kutta, "Beitrag zur näherungsweisen Integration totaler Differentialgleichungen", Z. Math. Phys. 46,
//! 435–453 (1901). The estimate follows from the conditions as E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary
//! Differential Equations I*, II.4, build embedded formulas with the FSAL idea.

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

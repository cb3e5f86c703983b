//! The classical Runge–Kutta method: four stages, fourth order, no error estimate.
//!
//! ```text
//!   0  |
//!  1/2 | 1/2
//!  1/2 |  0   1/2
//!   1  |  0    0    1
//! -----+--------------------
//!   b  | 1/6  1/3  1/3  1/6
//! ```
//!
//! Order 4, cubic Hermite dense output. It is the method of the paper and the baseline. The user chooses its step;
//! its stability interval on the imaginary axis ends at `ω h = 2√2`.
//!
//! W. Kutta, "Beitrag zur näherungsweisen Integration totaler Differentialgleichungen", Z. Math.
//! Phys. 46, 435–453 (1901).

use crate::tableau::{Dense, Tableau};

/// The method drawn above.
pub const CLASSICAL_4: Tableau<4> = Tableau {
    order: 4,
    embedded_order: 0,
    c: [0.0, 1.0 / 2.0, 1.0 / 2.0, 1.0],
    a: [&[], &[1.0 / 2.0], &[0.0, 1.0 / 2.0], &[0.0, 0.0, 1.0]],
    b: [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
    b_hat: None,
    b_hat_low: None,
    dense: Dense::Hermite,
};

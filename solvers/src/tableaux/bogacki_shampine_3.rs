//! Bogacki–Shampine 3(2): four stages, the last one reused as the first of the next step (FSAL).
//!
//! ```text
//!   0  |
//!  1/2 | 1/2
//!  3/4 |  0    3/4
//!   1  | 2/9   1/3   4/9
//! -----+------------------------
//!   b  | 2/9   1/3   4/9    0
//!   b̂  | 7/24  1/4   1/3   1/8
//! ```
//!
//! Order 3, embedded order 2 (the local estimate is O(h³)), cubic Hermite dense output. A restart is cheap, so the
//! method suits frequent events at loose tolerances. At tight tolerances a fifth-order pair needs less work.
//!
//! P. Bogacki, L. F. Shampine, "A 3(2) pair of Runge–Kutta formulas", Appl. Math. Lett. 2(4),
//! 321–325 (1989).

use crate::tableau::{Dense, Tableau};

/// The pair drawn above.
pub const BOGACKI_SHAMPINE_3: Tableau<4> = Tableau {
    order: 3,
    embedded_order: 2,
    c: [0.0, 1.0 / 2.0, 3.0 / 4.0, 1.0],
    a: [&[], &[1.0 / 2.0], &[0.0, 3.0 / 4.0], &[2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0]],
    b: [2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0, 0.0],
    b_hat: Some([7.0 / 24.0, 1.0 / 4.0, 1.0 / 3.0, 1.0 / 8.0]),
    b_hat_low: None,
    dense: Dense::Hermite,
};

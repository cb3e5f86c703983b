//! Radau IIA of order 5: three stages, fully implicit.
//!
//! ```text
//!  (4 − √6)/10 |   (88 − 7√6)/360    (296 − 169√6)/1800   (−2 + 3√6)/225
//!  (4 + √6)/10 | (296 + 169√6)/1800    (88 + 7√6)/360     (−2 − 3√6)/225
//!       1      |     (16 − √6)/36        (16 + √6)/36           1/9
//! -------------+--------------------------------------------------------
//!       b      |     (16 − √6)/36        (16 + √6)/36           1/9
//! ```
//!
//! Order 5, stage order 3, embedded order 3, dense output of order 4 (its local error falls as h⁵); L-stable and
//! stiffly accurate. A step solves its equations by Newton's iteration, with one Jacobian and two factorisations, one
//! real and one complex; where that diverges, with a Jacobian of each stage (see [`Radau`]).
//!
//! It is good at strong damping and tight tolerances, because the stages keep their order on stiff systems. On a
//! contact of 10⁹ N/m with damping ratios of 1 and 20 it takes 7 and 3 times fewer steps than
//! [Rodas5P](super::RODAS_5P) to an error of 10⁻⁶ of the clearance, and 17 and 11 times fewer to 10⁻⁹. Each step
//! costs up to twice as much; in time the gain at 10⁻⁶ is 7 and 4 times. It is good too at motions that a stiff force
//! holds near a curve: at a tolerance of 10⁻⁸ a pendulum on a rod of stiffness 10⁶ takes 780 steps, on one of 10¹² 457.
//! It is less good at loose tolerances with many events: after a restart the iteration has no starting guess, and each
//! step retaken on an event is iterated to rounding. Where accuracy limits the step, an explicit pair needs less work.
//!
//! Its error at a tolerance is larger than that of a code that holds the same estimate to rtol itself, because the estimate is of third
//! order, and is held to `0.1 rtol^(2/3)`, as in RADAU5: 215 times more at 10⁻¹⁰. On van der Pol's equation with μ = 1000 the errors
//! there are 1.1·10⁻⁸ and, of scipy's `Radau`, 3.4·10⁻¹¹. So errors follow rtol as those of a method of fifth order should; what
//! counts is the time at equal error.
//!
//! A fixed step iterates to rounding or fails. Where the slope jumps inside it, as in an [event-blind
//! run](crate::blind), its equations may have no solution, and the run ends in
//! [`NoConvergence`](crate::Error::NoConvergence). Under a tolerance the step is halved instead.
//!
//! The correction of the dense output beyond the collocation polynomial helps on stiff systems too. At 1000 samples
//! the median error is smaller than that of the cubic by 30 to 300 times for Robertson's reaction, and by 2 to 6
//! times for the van der Pol oscillator with μ = 1000, at tolerances of 10⁻⁵ to 10⁻¹¹. On the contact above, samples
//! of both are as exact as the steps.
//!
//! E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed., Springer (1996), IV.5
//! and IV.8; the digits of T are those of their code RADAU5.

use crate::radau::Radau;

const SQRT_6: f64 = 2.449489742783178;
/// Cube roots of 3 and of 9.
const CBRT_3: f64 = 1.4422495703074083;
const CBRT_9: f64 = 2.080083823051904;
/// 3 to the power of 5/6 and of 7/6.
const POW_5_6: f64 = 2.498049532966813;
const POW_7_6: f64 = 3.602810865528008;

/// The method described above.
pub static RADAU_IIA_5: Radau = Radau {
    order: 5,
    embedded_order: 3,
    dense_order: 4,
    stage_order: 3,
    c: [(4.0 - SQRT_6) / 10.0, (4.0 + SQRT_6) / 10.0, 1.0],
    a: [
        [
            (88.0 - 7.0 * SQRT_6) / 360.0,
            (296.0 - 169.0 * SQRT_6) / 1800.0,
            (-2.0 + 3.0 * SQRT_6) / 225.0,
        ],
        [
            (296.0 + 169.0 * SQRT_6) / 1800.0,
            (88.0 + 7.0 * SQRT_6) / 360.0,
            (-2.0 - 3.0 * SQRT_6) / 225.0,
        ],
        [(16.0 - SQRT_6) / 36.0, (16.0 + SQRT_6) / 36.0, 1.0 / 9.0],
    ],
    real: 3.0 + CBRT_9 - CBRT_3,
    complex: [3.0 + (CBRT_3 - CBRT_9) / 2.0, (POW_5_6 + POW_7_6) / 2.0],
    t: [
        [0.09123239487089294, -0.1412552950209542, -0.03002919410514742],
        [0.241717932707107, 0.2041293522937999, 0.3829421127572619],
        [0.966048182615093, 1.0, 0.0],
    ],
    t_inverse: [
        [4.325579890063155, 0.3391992518158099, 0.5417705399358749],
        [-4.178718591551905, -0.3276828207610624, 0.4766235545005504],
        [-0.5028726349457869, 2.571926949855605, -0.5960392048282249],
    ],
    bubble_root: 2.0 / 5.0,
};

//! Problems with closed forms, one a file: for tests, examples and users.

mod bouncing_ball;
mod compliant_ball;
mod friction_oscillator;

pub use bouncing_ball::{BouncingBall, BouncingMode};
pub use compliant_ball::{BallMode, CompliantBall, Exit, Wall};
pub use friction_oscillator::{FrictionMode, FrictionOscillator};

/// Rounding bound of a guard that is a sum of a few terms, as a multiple of their size.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

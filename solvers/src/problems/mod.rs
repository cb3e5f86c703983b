//! Problems with closed forms, one a file: for tests, examples and users.

mod bouncing_ball;
mod compliant_ball;
mod friction_oscillator;
mod hertz_ball;
mod spring_stop;
mod two_balls;

pub use bouncing_ball::{BouncingBall, BouncingMode};
pub use compliant_ball::{BallMode, CompliantBall, Exit, Wall};
pub use friction_oscillator::{FrictionMode, FrictionOscillator};
pub use hertz_ball::HertzBall;
pub use spring_stop::SpringStop;
pub use two_balls::TwoBalls;

/// Rounding bound of a guard that is a sum of a few terms, as a multiple of their size.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Whether a mass touches the one stop that it can reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopMode {
    /// Moves free of it.
    Free,
    /// Dents it.
    Contact,
}

//! The problems with closed forms of [`deltazero_solvers::problems`], as a study sees them.
//!
//! Functions that integrate are `inline`: they are compiled where they are called, and the program calls none of them.

mod belt_oscillator;
mod bouncing_ball;
mod compliant_ball;
mod friction_oscillator;
mod hertz_ball;
mod sliding_stops;
mod spring_stop;
mod thermostat;
mod two_balls;

use crate::problem::Quantity;

/// A position and its velocity.
fn position_and_velocity(length: f64, speed: f64) -> Vec<Quantity> {
    vec![Quantity::new("x", "m", length), Quantity::new("v", "m/s", speed)]
}

/// What the tests of several modules run.
#[cfg(test)]
pub(crate) mod balls {
    use deltazero_solvers::problems::{CompliantBall, Exit};

    /// A mass that flies slowly between two lightly damped walls.
    pub(crate) const HEAVY_BALL: CompliantBall = CompliantBall {
        mass: 6.0,
        stiffness: 1e7,
        damping: 20.0,
        exit: Exit::Penetration,
        gap: 2e-4,
        start: [1e-4, -1e-2],
    };

    /// One that flies fast between two soft walls.
    pub(crate) const LIGHT_BALL: CompliantBall = CompliantBall {
        mass: 0.1,
        stiffness: 1e4,
        damping: 1.0,
        exit: Exit::Penetration,
        gap: 0.05,
        start: [0.02, 1.0],
    };
}

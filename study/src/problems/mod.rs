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

use deltazero_solvers::problems::StopMode;

use crate::problem::{Energy, Quantity, Role};

/// A position and its velocity.
fn position_and_velocity(length: f64, speed: f64) -> Vec<Quantity> {
    vec![Quantity::new("x", "m", length), Quantity::new("v", "m/s", speed)]
}

/// The energy of a mass on a spring [J]. That of the spring is told as kinetic: the elastic one is that of contacts.
fn on_a_spring(mass: f64, stiffness: f64, [x, v]: [f64; 2]) -> Energy {
    Energy { kinetic: 0.5 * (mass * v * v + stiffness * x * x), elastic: 0.0 }
}

/// What a mode is to a contact with a stop.
fn role_of(mode: &StopMode) -> Role {
    match mode {
        StopMode::Free => Role::Free,
        StopMode::Contact => Role::Contact,
    }
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

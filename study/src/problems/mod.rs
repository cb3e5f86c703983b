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

#[cfg(test)]
mod tests {
    use deltazero_solvers::problems::{
        BeltMode, BeltOscillator, FrictionMode, FrictionOscillator, SlidingStops,
    };

    use crate::Problem;

    fn scales<P: Problem>(problem: &P) -> Vec<f64> {
        problem.states().iter().map(|state| state.scale).collect()
    }

    const BELT: BeltOscillator = BeltOscillator {
        mass: 2.0,
        stiffness: 50.0,
        belt_speed: 0.3,
        static_friction: 5.0,
        kinetic_friction: 3.0,
        start: [0.0, 0.0],
    };

    const RUBS: FrictionOscillator =
        FrictionOscillator { mass: 2.0, stiffness: 50.0, friction: 5.0, release: -0.05 };

    #[test]
    fn states_have_the_sizes_of_their_motion() {
        // Friction stretches the spring by 0.1 m; ω = 5 rad/s.
        assert_eq!(scales(&BELT), [0.1, 0.5]);
        assert_eq!(scales(&BeltOscillator { belt_speed: 0.8, ..BELT }), [0.1, 0.8]);
        assert_eq!(scales(&RUBS), [0.1, 0.5]);
        assert_eq!(scales(&FrictionOscillator { release: 0.4, ..RUBS }), [0.4, 2.0]);
        let slides = SlidingStops {
            mass: 2.0,
            gap: 0.25,
            drive: 4.0,
            half_period: 1.0,
            friction: 1.0,
            start: [0.0, 0.0],
        };
        assert_eq!(scales(&slides), [0.25, 1.0]);
    }

    #[test]
    fn files_tell_the_side_that_it_slips_to() {
        let belt = [BeltMode::SlipMinus, BeltMode::SlipPlus, BeltMode::Stick];
        assert_eq!(belt.map(|mode| BELT.code(&mode, 0)), [-1, 1, 2]);
        let rubs = [FrictionMode::SlipMinus, FrictionMode::SlipPlus, FrictionMode::Stick];
        assert_eq!(rubs.map(|mode| RUBS.code(&mode, 0)), [-1, 1, 2]);
    }
}

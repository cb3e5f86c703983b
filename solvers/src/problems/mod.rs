//! Problems with closed forms, one a file: for tests, examples and users.

mod belt_oscillator;
mod bouncing_ball;
mod compliant_ball;
mod friction_oscillator;
mod hertz_ball;
mod sliding_stops;
mod spring_stop;
mod thermostat;
mod two_balls;

pub use belt_oscillator::{BeltMode, BeltOscillator};
pub use bouncing_ball::{BouncingBall, BouncingMode};
pub use compliant_ball::{BallMode, CompliantBall, Exit, Wall};
pub use friction_oscillator::{FrictionMode, FrictionOscillator};
pub use hertz_ball::HertzBall;
pub use sliding_stops::{Block, SlidingStops, StopsMode};
pub use spring_stop::SpringStop;
pub use thermostat::{Heater, Thermostat};
pub use two_balls::TwoBalls;

use crate::rounding::ROUNDING;

/// Whether a mass touches the one stop that it can reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopMode {
    /// Moves free of it.
    Free,
    /// Dents it.
    Contact,
}

impl StopMode {
    /// The mode after an event.
    fn other(self) -> Self {
        match self {
            Self::Free => Self::Contact,
            Self::Contact => Self::Free,
        }
    }

    /// The mode at this depth in the stop and its rate. On the surface it touches if it goes in.
    fn at(depth: f64, rate: f64) -> Self {
        let touches = depth > 0.0 || (depth == 0.0 && rate > 0.0);
        if touches { Self::Contact } else { Self::Free }
    }
}

/// A smooth piece of a closed form, from one event to the next.
///
/// ```
/// use deltazero_solvers::Run;
/// use deltazero_solvers::problems::{Heater, Thermostat};
///
/// let room = Thermostat {
///     heat_capacity: 2e6,
///     conductance: 200.0,
///     power: 6e3,
///     outside: 275.0,
///     low: 292.0,
///     high: 294.0,
///     start: 292.0,
///     heater: Heater::On,
/// };
/// let [_, off, on] = room.pieces(4e3)[..] else { panic!("a cycle and a half") };
/// assert_eq!((off.mode, off.y, on.mode, on.y), (Heater::Off, [294.0], Heater::On, [292.0]));
/// let run = Run::of(&room, [room.start]).method("dop853").tolerance(1e-12, 1e-9).to(4e3)?;
/// assert!((run.trajectory.events[1].t - on.t).abs() < 1e-5);
/// # Ok::<(), deltazero_solvers::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece<M, Y> {
    /// When it begins [s].
    pub t: f64,
    /// Its mode.
    pub mode: M,
    /// State where it begins.
    pub y: Y,
}

/// The pieces that begin by `t_end`: `start`, and those that `next` makes of the one before.
fn pieces<M: Copy, Y: Copy>(
    start: Piece<M, Y>,
    t_end: f64,
    next: impl Fn(Piece<M, Y>) -> Piece<M, Y>,
) -> Vec<Piece<M, Y>> {
    std::iter::successors(Some(start), |&piece| Some(next(piece)))
        .take_while(|piece| piece.t <= t_end)
        .collect()
}

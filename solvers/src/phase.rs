//! The contract of a method: it integrates one smooth phase, from a point to the first event.

pub use crate::point::Point;

use crate::error::Error;
use crate::record::Record;
use crate::system::System;
use crate::work::Stats;

/// How a phase ended.
///
/// ```
/// use deltazero_solvers::phase::PhaseEnd;
/// use deltazero_solvers::problems::{BouncingBall, BouncingMode};
/// use deltazero_solvers::{Control, Method, Point, Stats, Tolerance};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let control = Control::Adaptive(Tolerance { rtol: 1e-9, atol: vec![1e-9; 2] });
/// let mut solver = Method::named("dop853").ok_or("no such method")?.solver(&ball, control)?;
/// let mut point = Point { t: 0.0, y: ball.start(), mode: BouncingMode::Flight };
/// let mut stats = Stats::default();
/// let end = solver.solve_phase(&ball, &mut point, 1.0, &mut stats, &mut ())?;
/// assert_eq!(end, PhaseEnd::Guard(0));
/// // The phase ends before the transition: the ball still falls.
/// assert!((point.t - ball.bounce_time(0)).abs() < 1e-9 && point.y[1] < -4.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhaseEnd {
    /// At the end of the run's time.
    EndOfTime,
    /// Just past the surface of this guard.
    Guard(usize),
    /// Where the recorder asked for the end of the run.
    Interrupted {
        /// The guard whose surface this is just past, if it is.
        landed_on: Option<usize>,
    },
}

/// A method applied to one system.
///
/// ```
/// use deltazero_solvers::phase::{PhaseEnd, PhaseSolver};
/// use deltazero_solvers::problems::BouncingBall;
/// use deltazero_solvers::{Error, Integration, Point, Record, Stats};
///
/// /// The flight of a ball by its formula, in one step that no recorder is shown.
/// struct Parabola;
///
/// impl PhaseSolver<BouncingBall> for Parabola {
///     fn solve_phase(
///         &mut self,
///         ball: &BouncingBall,
///         point: &mut Point<BouncingBall>,
///         t_end: f64,
///         _: &mut Stats,
///         _: &mut dyn Record<BouncingBall>,
///     ) -> Result<PhaseEnd, Error> {
///         let ([y, v], g) = (point.y, ball.gravity);
///         let lands = point.t + (v + (v * v + 2.0 * g * y).sqrt()) / g;
///         let s = lands.min(t_end) - point.t;
///         (point.t, point.y) = (lands.min(t_end), [y + s * (v - 0.5 * g * s), v - g * s]);
///         Ok(if lands < t_end { PhaseEnd::Guard(0) } else { PhaseEnd::EndOfTime })
///     }
/// }
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let mut run = Integration::new(&ball, 0.0, ball.start());
/// run.run(1.3, &mut Parabola, &mut ())?;
/// assert_eq!(run.stats.n_events, 5);
/// assert!((run.point.y[0] - ball.state(1.3)[0]).abs() < 1e-14);
/// # Ok::<(), Error>(())
/// ```
pub trait PhaseSolver<P: System> {
    /// Advances `point` in its mode to `t_end`, or to just past the first violated guard, and
    /// shows `record` the accepted steps that it needs.
    ///
    /// # Errors
    /// Any [`Error`] of a step; `point` is then at the end of the last accepted step.
    fn solve_phase(
        &mut self,
        problem: &P,
        point: &mut Point<P>,
        t_end: f64,
        stats: &mut Stats,
        record: &mut dyn Record<P>,
    ) -> Result<PhaseEnd, Error>;
}

/// [`Error::NonFinite`] if a state of `y` is infinite or not a number.
pub(crate) fn check_finite<P: System>(point: &Point<P>, y: &P::State<f64>) -> Result<(), Error> {
    match y.as_ref().iter().position(|y| !y.is_finite()) {
        None => Ok(()),
        Some(component) => {
            Err(Error::NonFinite { t: point.t, mode: format!("{:?}", point.mode), component })
        }
    }
}

//! A run from a system to its trajectory: all of its options in one place.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use crate::control::{Control, Steps};
use crate::error::{Error, Outcome};
use crate::integrate::Integration;
use crate::methods::{METHODS, Method};
use crate::point::Point;
use crate::record::{Record, Watch};
use crate::system::System;
use crate::tolerance::Tolerance;
use crate::trajectory::{Grid, Trajectory};
use crate::work::Stats;

/// What is called at each step.
type Progress<'a> = Box<dyn FnMut(f64, &Stats) -> ControlFlow<()> + 'a>;

/// The options of a run. Accuracy is asked for by a tolerance or a step; all else has a default:
///
/// | option | default |
/// |---|---|
/// | [`tolerance`](Self::tolerance), [`tolerances`](Self::tolerances), [`step`](Self::step) | none: absolute tolerances have the units of the states |
/// | [`method`](Self::method) | `auto`, which takes a tolerance |
/// | [`from`](Self::from) | time 0 |
/// | [`in_mode`](Self::in_mode) | the mode that the [system gives](System::initial_mode) at the start |
/// | [`first_step`](Self::first_step), [`longest_step`](Self::longest_step) | by the tolerance, no limit |
/// | [`keep`](Self::keep) | samples at the ends of the steps, and events |
/// | [`record`](Self::record) | no other recorder |
/// | [`most_work`](Self::most_work), [`most_time`](Self::most_time) | no limit |
/// | [`progress`](Self::progress) | nothing is called |
///
/// ```
/// use deltazero_solvers::problems::BouncingBall;
/// use deltazero_solvers::{Error, Run};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let run = Run::of(&ball, ball.start()).method("dop853").tolerance(1e-9, 1e-9).to(1.3)?;
/// assert_eq!(run.trajectory.events.len(), 5);
/// assert!((run.end.y[0] - ball.state(1.3)[0]).abs() < 1e-7);
/// println!("{} right-hand sides", run.stats.work.n_rhs);
/// # Ok::<(), Error>(())
/// ```
///
/// An [`Integration`] may go on after its end, and keeps what was reached before an error.
#[must_use = "a run is made by `to`"]
pub struct Run<'a, P: System> {
    problem: &'a P,
    y: P::State<f64>,
    t: f64,
    mode: Option<P::Mode>,
    method: &'a str,
    control: Option<Control>,
    first: Option<f64>,
    longest: f64,
    trajectory: Trajectory<P::State<f64>, P::Mode>,
    most_work: u64,
    most_time: Option<Duration>,
    progress: Progress<'a>,
    recorder: Option<Box<dyn Record<P> + 'a>>,
}

/// What a [`Run`] came to.
///
/// ```
/// use deltazero_solvers::problems::{BouncingBall, BouncingMode};
/// use deltazero_solvers::{Outcome, Run};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let t_end = ball.accumulation_time() + 1.0;
/// let run = Run::of(&ball, ball.start()).method("dop853").tolerance(1e-9, 1e-9).to(t_end)?;
/// assert_eq!((run.outcome, run.end.t), (Outcome::Finished, t_end));
/// assert_eq!((run.end.mode, run.end.y), (BouncingMode::Rest, [0.0, 0.0]));
/// assert_eq!(run.stats.n_events, run.trajectory.events.len() as u64);
/// # Ok::<(), deltazero_solvers::Error>(())
/// ```
#[derive(Debug)]
pub struct Solution<P: System> {
    /// How it ended; [`Interrupted`](Outcome::Interrupted) where a limit, the function of progress or a recorder ended it.
    pub outcome: Outcome,
    /// Time, state and mode at its end.
    pub end: Point<P>,
    /// Samples, events and grazing guards.
    pub trajectory: Trajectory<P::State<f64>, P::Mode>,
    /// Its work.
    pub stats: Stats,
}

impl<'a, P: System> Run<'a, P> {
    /// A run of `problem` that starts with the state `y`.
    pub fn of(problem: &'a P, y: P::State<f64>) -> Self {
        Self {
            problem,
            y,
            t: 0.0,
            mode: None,
            method: "auto",
            control: None,
            first: None,
            longest: f64::INFINITY,
            trajectory: Trajectory::on(Grid::Steps),
            most_work: u64::MAX,
            most_time: None,
            progress: Box::new(|_, _| ControlFlow::Continue(())),
            recorder: None,
        }
    }

    /// Starts at time `t`.
    pub fn from(self, t: f64) -> Self {
        Self { t, ..self }
    }

    /// Starts in `mode`, whatever the state is.
    pub fn in_mode(self, mode: P::Mode) -> Self {
        Self { mode: Some(mode), ..self }
    }

    /// Integrates by the method of this [name](METHODS).
    pub fn method(self, name: &'a str) -> Self {
        Self { method: name, ..self }
    }

    /// Chooses steps by a relative tolerance, and an absolute one of every state in its unit.
    pub fn tolerance(self, rtol: f64, atol: f64) -> Self {
        let atol = vec![atol; self.problem.dim()];
        self.tolerances(Tolerance { rtol, atol })
    }

    /// Chooses steps by a relative tolerance, and an absolute one for each state.
    pub fn tolerances(self, tolerance: Tolerance) -> Self {
        Self { control: Some(Control::Adaptive(tolerance)), ..self }
    }

    /// Takes steps of this size [unit of time], whatever their error.
    pub fn step(self, h: f64) -> Self {
        Self { control: Some(Control::Fixed(h)), ..self }
    }

    /// Takes a first step of this size [unit of time]; see [`Steps::first`].
    pub fn first_step(self, h: f64) -> Self {
        Self { first: Some(h), ..self }
    }

    /// Takes no step longer than this [unit of time]; see [`Steps::longest`].
    pub fn longest_step(self, h: f64) -> Self {
        Self { longest: h, ..self }
    }

    /// Keeps what this trajectory keeps: samples at [given times](Trajectory::on), [events alone](Trajectory::of_events), or a
    /// [dense solution](Trajectory::dense).
    pub fn keep(self, trajectory: Trajectory<P::State<f64>, P::Mode>) -> Self {
        Self { trajectory, ..self }
    }

    /// Beside the trajectory, records by `recorder`: [`Observations`](crate::observe::Observations),
    /// [`Checked`](crate::contracts::Checked), [`WorkByKind`](crate::WorkByKind), one of your own, or a pair of them. It may end the
    /// run. A second call replaces the first.
    ///
    /// ```
    /// use deltazero_solvers::Run;
    /// use deltazero_solvers::observe::Observations;
    /// use deltazero_solvers::problems::{BouncingBall, BouncingMode};
    ///
    /// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
    /// let mut seen = Observations::default().of(1e-15, |_: &BouncingMode, _t, y: &[f64; 2]| y[1]);
    /// let run = Run::of(&ball, ball.start()).tolerance(1e-9, 1e-9).record(&mut seen).to(1.0)?;
    /// // It bounces twice, and is highest between.
    /// assert_eq!((run.trajectory.events.len(), seen.zeros.len()), (2, 1));
    /// # Ok::<(), deltazero_solvers::Error>(())
    /// ```
    pub fn record(self, recorder: impl Record<P> + 'a) -> Self {
        Self { recorder: Some(Box::new(recorder)), ..self }
    }

    /// Ends the run at the first step after so many evaluations of the right-hand side.
    pub fn most_work(self, n_rhs: u64) -> Self {
        Self { most_work: n_rhs, ..self }
    }

    /// Ends the run at the first step after this time by the clock. Where it ends is then not the same each time.
    pub fn most_time(self, time: Duration) -> Self {
        Self { most_time: Some(time), ..self }
    }

    /// Calls `look` with the time and the work so far, as [`Watch`] does; it may end the run.
    pub fn progress(self, look: impl FnMut(f64, &Stats) -> ControlFlow<()> + 'a) -> Self {
        Self { progress: Box::new(look), ..self }
    }

    /// Integrates to `t_end`, backward where that is before the start.
    ///
    /// # Errors
    /// [`Error::UnknownMethod`], [`Error::BadControl`] where neither tolerances nor a step are given, and those of
    /// [`Method::solver`] and of [`Integration::run`].
    pub fn to(self, t_end: f64) -> Result<Solution<P>, Error> {
        let Self { problem, y, t, mode, mut trajectory, mut progress, mut recorder, .. } = self;
        let unknown = || Error::UnknownMethod {
            name: self.method.to_owned(),
            known: METHODS.iter().map(|method| method.name).collect::<Vec<_>>().join(", "),
        };
        let method = Method::named(self.method).ok_or_else(unknown)?;
        let silent = || Error::BadControl { method: method.name, needs: "a tolerance or a step" };
        let control = self.control.ok_or_else(silent)?;
        let steps = Steps { control, first: self.first, longest: self.longest };
        let mut solver = method.solver(problem, steps)?;

        let most_work = self.most_work;
        let clock = self.most_time.map(|most| (Instant::now(), most));
        let watch = Watch::new(|t, stats: &Stats| {
            let is_late = clock.is_some_and(|(begun, most)| begun.elapsed() >= most);
            if is_late || stats.work.n_rhs >= most_work {
                ControlFlow::Break(())
            } else {
                progress(t, stats)
            }
        });
        let mut integration = match mode {
            Some(mode) => Integration::at(problem, Point { t, y, mode }),
            None => Integration::new(problem, t, y),
        };
        let mut record = ((&mut trajectory, recorder.as_deref_mut()), watch);
        let outcome = integration.run(t_end, &mut *solver, &mut record)?;
        Ok(Solution { outcome, end: integration.point, trajectory, stats: integration.stats })
    }
}

//! One run of one problem at one setting, timed.

mod at_once;
mod limits;
mod stopwatch;

use deltazero_solvers::taylor::ExtendedIntegration;
use deltazero_solvers::{
    Blind, Control, Error, Integration, ModeOfState, Outcome, Point, Real as _, Record, Stats,
    System, Tolerance, Unblind,
};
use serde::{Deserialize, Serialize};

use crate::problem::{Problem, scales};
use crate::setting::Atol;
pub use crate::setting::{Accuracy, Events, Setting};

pub use at_once::{Begun, at_once, integrate_all};
pub(crate) use at_once::{is_at_once, one_by_one};
pub use limits::{Brake, Braked, Clock, Limit, Limits, Price, Watch};
pub use stopwatch::{Stopwatch, Took};

/// A change of the mode of a site, as tables write it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModeChange {
    /// Time [s].
    pub t: f64,
    /// Code of the mode before.
    pub before: i8,
    /// Code of the mode after.
    pub after: i8,
    /// [Numbers](Problem::mode_number) of both.
    #[serde(default)]
    pub numbers: [u16; 2],
}

impl ModeChange {
    /// Between modes that their codes tell.
    pub fn new(t: f64, before: i8, after: i8) -> Self {
        Self { t, before, after, numbers: [0; 2] }
    }

    /// Whether another is the same but for its time.
    pub fn is_like(&self, other: &Self) -> bool {
        let what = |own: &Self| (own.before, own.after, own.numbers);
        what(self) == what(other)
    }
}

/// What became of a run, with states `Y` and modes `M`.
#[derive(Clone, Debug)]
pub struct Ran<Y, M> {
    /// How it ended.
    pub outcome: Result<Outcome, Error>,
    /// Time of the last accepted step [s].
    pub t: f64,
    /// State there.
    pub y: Y,
    /// Mode there.
    pub mode: M,
    /// Work; an evaluation of the right-hand side is one of all sites of the problem.
    pub stats: Stats,
    /// Time that the integration took.
    pub took: Took,
    /// Runs that were computed at once, this one counted; its time is an even share of theirs.
    pub batch: usize,
}

/// What became of a run of `P`, in its own states and modes.
pub type OwnRun<P> = Ran<<P as System>::State<f64>, <P as System>::Mode>;

/// What became of a run of any problem: its state as a list, its mode as a message says it.
pub type PartRun = Ran<Vec<f64>, String>;

impl<Y, M> Ran<Y, M> {
    /// When a terminal event ended it [s], if one did.
    pub fn stopped_at(&self) -> Option<f64> {
        (self.outcome == Ok(Outcome::Stopped)).then_some(self.t)
    }
}

impl<Y: PartialEq, M> Ran<Y, M> {
    /// Whether it ended as another one, to the bit. One from a start moved by its last bit then tells nothing: the bit was rounded
    /// away, as it is of a motion that grows.
    pub(crate) fn ends_like(&self, other: &Self) -> bool {
        self.t == other.t && self.y == other.y
    }
}

impl<Y: AsRef<[f64]>, M: std::fmt::Debug> Ran<Y, M> {
    /// The run without the types of its problem.
    pub fn plain(&self) -> PartRun {
        Ran {
            outcome: self.outcome.clone(),
            t: self.t,
            y: self.y.as_ref().to_vec(),
            mode: format!("{:?}", self.mode),
            stats: self.stats,
            took: self.took,
            batch: self.batch,
        }
    }
}

impl Setting {
    /// The control of steps by which a solver of `problem` keeps this setting.
    pub fn control<P: Problem>(&self, problem: &P) -> Control {
        match &self.accuracy {
            Accuracy::Step(step) => Control::Fixed(*step),
            Accuracy::Rtol(rtol, atol) => {
                let mut all: Vec<f64> =
                    scales(problem).into_iter().map(|scale| scale * rtol).collect();
                match atol {
                    None => {}
                    Some(Atol::Same(atol)) => all.fill(*atol),
                    Some(Atol::Each(each)) => problem.spread(each, &mut all),
                }
                Control::Adaptive(Tolerance { rtol: *rtol, atol: all })
            }
        }
    }
}

/// Integrates `problem` from `y0` at t = 0 to `t_end`, shown to `record`.
///
/// The one stopwatch is here: [`Ran::took`] is the time of the integration with its recorder.
pub fn integrate<P: Problem>(
    problem: &P,
    setting: &Setting,
    y0: P::State<f64>,
    t_end: f64,
    record: &mut dyn Record<P>,
) -> OwnRun<P> {
    if setting.events == Events::Blind {
        return problem.integrate_blind(setting, y0, t_end, record);
    }
    let watch = Stopwatch::start();
    let mut run = Integration::new(problem, 0.0, y0);
    let outcome = problem.check().and_then(|()| {
        let mut solver = setting.method.solver(problem, setting.control(problem))?;
        run.run(t_end, &mut *solver, record)
    });
    ended(problem, run, outcome, watch.took())
}

/// A run that reads its mode off the state; what [`Problem::integrate_blind`] calls where there is one.
pub fn blind<P: Problem + ModeOfState>(
    problem: &P,
    setting: &Setting,
    y0: P::State<f64>,
    t_end: f64,
    record: &mut dyn Record<P>,
) -> OwnRun<P> {
    let watch = Stopwatch::start();
    let blind = Blind(problem);
    let mut record = Unblind::new(problem, 0.0, &y0, record);
    let mut run = Integration::new(&blind, 0.0, y0);
    let outcome = problem.check().and_then(|()| {
        let mut solver = setting.method.solver(&blind, setting.control(problem))?;
        run.run(t_end, &mut *solver, &mut record)
    });
    let mode = problem.mode_of_state(run.point.t, &run.point.y);
    let end = Point { t: run.point.t, y: run.point.y, mode };
    finished(problem, end, run.stats, outcome, watch.took())
}

/// A run by Taylor series over pairs of f64, events located, the absolute tolerances `rtol` times the scale of each
/// state; what [`Problem::integrate_extended`] calls where it is offered.
pub fn extended<P: Problem>(
    problem: &P,
    rtol: f64,
    y0: P::State<f64>,
    t_end: f64,
    record: &mut dyn Record<P>,
) -> OwnRun<P> {
    let watch = Stopwatch::start();
    let atol = scales(problem).into_iter().map(|scale| rtol * scale).collect();
    let mut run = ExtendedIntegration::new(problem, 0.0, &y0, Tolerance { rtol, atol });
    let outcome = problem.check().and_then(|()| run.run(t_end, record));
    let end = Point { t: run.t().value(), y: run.rounded(), mode: run.mode };
    finished(problem, end, run.stats, outcome, watch.took())
}

/// A failed run of `problem` from `y0`, of a kind that the problem does not offer, for this reason.
pub fn no_such_run<P: Problem>(problem: &P, y0: P::State<f64>, reason: &str) -> OwnRun<P> {
    let mode = problem.initial_mode(0.0, &y0);
    let error = Error::Refused { reason: reason.to_owned() };
    let end = Point { t: 0.0, y: y0, mode };
    finished(problem, end, Stats::default(), Err(error), Took::default())
}

/// What became of an integration alone that took so long.
pub fn ended<P: Problem>(
    problem: &P,
    run: Integration<'_, P>,
    outcome: Result<Outcome, Error>,
    took: Took,
) -> OwnRun<P> {
    finished(problem, run.point, run.stats, outcome, took)
}

/// What became of a run that ended at a point, as its problem [judges](Problem::judged) it.
fn finished<P: Problem>(
    problem: &P,
    end: Point<P>,
    stats: Stats,
    outcome: Result<Outcome, Error>,
    took: Took,
) -> OwnRun<P> {
    let Point { t, y, mode } = end;
    let outcome = problem.judged(outcome, t, &mode, &y);
    Ran { outcome, t, y, mode, stats, took, batch: 1 }
}

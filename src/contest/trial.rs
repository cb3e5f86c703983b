//! One run of a contest, measured and judged.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use deltazero_solvers::{
    Accepted, Error, Event, Grid, Method, Needs, Outcome, Record, Stats, System, Trajectory, Work,
};

use super::arena::Arena;
use crate::metrics::worse;
use crate::model::{Jointed, Part};
use crate::reference::JointReference;
use crate::run::{Clock, Integrable, Price, SERIES, Setting, Took, integrate, trajectories};

/// A linear system of one block costs about this many right-hand sides: rodas5p, radau5, bdf and
/// esdirk34 take 4.2 to 7.5 times the time of an explicit method's for each of theirs (Table 1). Of a chain it is
/// taken for as much, which is not measured.
const LIN_SOLVE: f64 = 5.0;

/// The work of a run in right-hand sides: a measure of cost that is the same on every machine, and
/// right within a factor of about two.
///
/// ```text
/// n_rhs + 5 n_lin_solves        a Taylor series of order p counts 2 p
/// ```
pub fn work(method: &Method, rtol: Option<f64>, counts: &Work) -> f64 {
    let rhs = method.series_order(rtol).map_or(1.0, |order| SERIES * order as f64);
    rhs * counts.n_rhs as f64 + LIN_SOLVE * counts.n_lin_solves as f64
}

/// Where a run starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// At the paper's start.
    Exact,
    /// Each of its numbers moved up by its last bit.
    Up,
    /// Each moved down.
    Down,
}

impl Start {
    fn of<P: Jointed>(self, part: &P) -> P::State<f64> {
        match self {
            Self::Exact => part.start(),
            Self::Up => part.start_nudged(f64::next_up),
            Self::Down => part.start_nudged(f64::next_down),
        }
    }
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum TrialEnd {
    /// At the end of its time.
    Reached,
    /// At the limit of work.
    Cut,
    /// At the limit of time.
    OutOfTime,
    /// It could not go on.
    Failed(Error),
    /// Interrupted from outside.
    Interrupted,
}

/// A run, judged by the reference.
#[derive(Clone, Debug)]
pub struct Trial {
    /// How it ended.
    pub end: TrialEnd,
    /// Error `e`; infinite where it has not reached its end.
    pub e: f64,
    /// Events of the reference that it lacks.
    pub missed: usize,
    /// Events that the reference lacks.
    pub spurious: usize,
    /// Counts.
    pub stats: Stats,
    /// Work; see [`work`].
    pub work: f64,
    /// Time that the parts came far, added [s].
    pub covered: f64,
    /// Time that it took.
    pub took: Took,
}

impl Trial {
    /// Runs `setting` in `arena` from `start`, and cuts it at `limit` of [`work`], or where it is on
    /// course for twice that.
    pub fn new(
        arena: &Arena,
        setting: &Setting,
        start: Start,
        limit: f64,
        stop: &AtomicBool,
    ) -> Self {
        let mut trial = Self {
            end: TrialEnd::Reached,
            e: 0.0,
            missed: 0,
            spurious: 0,
            stats: Stats::default(),
            work: 0.0,
            covered: 0.0,
            took: Took::default(),
        };
        for (part, joints) in arena.reference.of_parts(&arena.mechanism) {
            match part {
                Part::Block(block) => {
                    trial.add(block, joints, (arena, setting, start), limit, stop)
                }
                Part::Chain(chain) => {
                    trial.add(chain, joints, (arena, setting, start), limit, stop)
                }
            }
            if trial.end != TrialEnd::Reached {
                break;
            }
        }
        trial
    }

    /// Runs one part, whose joints have these references.
    fn add<P: Integrable>(
        &mut self,
        part: &P,
        joints: &[JointReference],
        (arena, setting, start): (&Arena, &Setting, Start),
        limit: f64,
        stop: &AtomicBool,
    ) {
        let (work_before, t_before, whole) = (self.work, self.covered, arena.whole());
        let clock = Clock::of(arena.max_seconds - self.took.wall.as_secs_f64());
        let cut = None;
        let watch = WorkLimit {
            setting,
            work_before,
            t_before,
            whole,
            limit,
            stop,
            clock,
            reached: 0.0,
            cut,
        };
        let mut record = (Trajectory::on(Grid::Times(arena.times.clone())), watch);
        let run = integrate(part, setting, start.of(part), arena.t_end, &mut record);
        self.stats += run.stats;
        self.work += work(setting.method, setting.rtol(), &run.stats.work);
        self.covered += run.t;
        self.took = self.took + run.took;
        self.end = match run.outcome {
            Err(error) => TrialEnd::Failed(error),
            Ok(Outcome::Interrupted) => record.1.cut.unwrap_or(TrialEnd::Interrupted),
            Ok(_) => TrialEnd::Reached,
        };
        if self.end != TrialEnd::Reached {
            self.e = f64::INFINITY;
            return;
        }
        for (reference, trajectory) in joints.iter().zip(trajectories(part, &record.0)) {
            self.e = worse(self.e, reference.error(&trajectory));
            let events = reference.matched(part.block(), &trajectory);
            self.missed += events.missed;
            self.spurious += events.spurious;
        }
    }

    /// Whether its sequence of events is that of the reference.
    pub fn events_are_right(&self) -> bool {
        self.missed + self.spurious == 0
    }
}

/// Breaks a run off at a limit of work, or once a tenth of that shows that it is on course for twice the
/// limit; at the limit of time; or from outside.
struct WorkLimit<'a> {
    setting: &'a Setting,
    /// Work and time of the parts before.
    work_before: f64,
    t_before: f64,
    /// Time of all parts.
    whole: f64,
    limit: f64,
    stop: &'a AtomicBool,
    clock: Clock,
    /// Time of the last accepted step.
    reached: f64,
    /// The end that it made.
    cut: Option<TrialEnd>,
}

impl WorkLimit<'_> {
    /// What follows from the work of this part, rejected attempts beyond what is counted `besides`.
    fn judge(&mut self, stats: &Stats, besides: f64, is_late: bool) -> ControlFlow<()> {
        let own = work(self.setting.method, self.setting.rtol(), &stats.work);
        let done = self.work_before + own + besides;
        let part = (self.t_before + self.reached) / self.whole;
        let is_hopeless = done > EARLY * self.limit && done > ON_COURSE * self.limit * part;
        if done > self.limit || is_hopeless {
            self.cut = Some(TrialEnd::Cut);
        } else if is_late {
            self.cut = Some(TrialEnd::OutOfTime);
        } else if !self.stop.load(Ordering::Relaxed) {
            return ControlFlow::Continue(());
        }
        ControlFlow::Break(())
    }
}

/// See [`WorkLimit`].
const EARLY: f64 = 0.1;
pub(super) const ON_COURSE: f64 = 2.0;

impl<P: System> Record<P> for WorkLimit<'_> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        self.reached = accepted.step.t1();
        self.judge(accepted.stats, 0.0, self.clock.is_over_after(accepted.stats))
    }

    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()> {
        let besides = Price::of_setting(self.setting).rejected(stats);
        self.judge(stats, besides, self.clock.is_over())
    }

    fn event(&mut self, _: &Event<'_, P>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Ends
    }
}

//! One run of a contest, measured and judged.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use deltazero_solvers::{Error, Grid, Method, Outcome, Stats, Work};

use super::CUT;
use super::benchmark::Benchmark;
use crate::errors::worse;
use crate::reference::Judged;
use crate::run::{Brake, Clock, Price, Setting, Took};

pub use crate::part::Start;

/// A linear system of six states costs about this many right-hand sides: rodas5p, radau5, bdf and
/// esdirk34 take 4.2 to 7.5 times the time of an explicit method's for each of theirs (Table 1). Of more states it is
/// taken for as much, which is not measured.
const LIN_SOLVE: f64 = 5.0;

/// The work of a run in right-hand sides: a measure of cost that is the same on every machine, and
/// right within a factor of about two.
///
/// ```text
/// n_rhs + 5 n_lin_solves        a Taylor series of order p counts 2 p
/// ```
pub fn work(method: &Method, rtol: Option<f64>, counts: &Work) -> f64 {
    Price::of_series_at(method, rtol).of_counted(counts) + LIN_SOLVE * counts.n_lin_solves as f64
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum TrialEnd {
    /// At the end of its time.
    Reached,
    /// At the limit of work.
    Cut,
    /// With far more events than the reference: more than four times as many, and ten.
    Chatters,
    /// At the limit of time.
    OutOfTime,
    /// It could not go on.
    Failed(Error),
    /// Interrupted from outside.
    Interrupted,
}

/// Where a run is broken off.
#[derive(Clone, Copy, Debug)]
pub struct TrialLimit {
    /// [`work`] beyond which it is cut.
    pub work: f64,
    /// Work beyond which it is cut where it is on course for far more than [`work`](Self::work).
    pub early: f64,
    /// Whether one that [chatters](TrialEnd::Chatters) is broken off: where events must be right, it has lost.
    pub chatter: bool,
}

impl TrialLimit {
    /// A run that is broken off nowhere.
    pub const NONE: Self = Self::work(f64::INFINITY);

    /// A run that is broken off at so much work alone.
    pub const fn work(work: f64) -> Self {
        Self { work, early: EARLY * work, chatter: false }
    }
}

/// The events beyond which a run chatters, where the reference has `n_events`: four times as many, and ten.
pub(super) fn chatter_bound(n_events: f64) -> f64 {
    4.0 * n_events + 10.0
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
    /// Events that it had, those that are not compared, too.
    pub n_events: u64,
    /// Counts.
    pub stats: Stats,
    /// Work; see [`work`].
    pub work: f64,
    /// Time that the parts came far, added [s].
    pub covered: f64,
    /// [How far](Benchmark::course) it is of its work.
    pub(super) course: f64,
    /// Time that it took.
    pub took: Took,
}

impl Trial {
    /// Runs `setting` on `benchmark` from `start` up to `limit`.
    pub fn new(
        benchmark: &Benchmark,
        setting: &Setting,
        start: Start,
        limit: TrialLimit,
        stop: &AtomicBool,
    ) -> Self {
        let mut trial = Self::begun();
        for at in 0..benchmark.subject.parts.len() {
            trial.add(at, (benchmark, setting, start), limit, stop);
            if trial.end != TrialEnd::Reached {
                break;
            }
        }
        trial
    }

    /// A trial of which nothing is run yet.
    pub(super) fn begun() -> Self {
        Self {
            end: TrialEnd::Reached,
            e: 0.0,
            missed: 0,
            spurious: 0,
            n_events: 0,
            stats: Stats::default(),
            work: 0.0,
            covered: 0.0,
            course: 0.0,
            took: Took::default(),
        }
    }

    /// Runs the part at this place.
    fn add(
        &mut self,
        at: usize,
        (benchmark, setting, start): (&Benchmark, &Setting, Start),
        limit: TrialLimit,
        stop: &AtomicBool,
    ) {
        let (part, reference) = (&benchmark.subject.parts[at], &benchmark.reference.parts[at]);
        let most_events = chatter_bound(reference.n_all_events as f64);
        let mut brake = WorkLimit {
            setting,
            benchmark,
            at,
            work_before: self.work,
            limit,
            most_events: limit.chatter.then_some(most_events),
            stop,
            clock: Clock::of(benchmark.max_seconds - self.took.wall.as_secs_f64()),
            reached: 0.0,
            n_events: 0,
            cut: None,
        };
        let grid = Grid::Times(benchmark.times.clone());
        let (run, trace) = part.run(setting, start, benchmark.t_end, &grid, &mut brake);
        self.n_events += brake.n_events;
        self.stats += run.stats;
        self.work += work(setting.method, setting.rtol(), &run.stats.work);
        self.covered += run.t;
        self.course = benchmark.course(at, run.t);
        self.took = self.took + run.took;
        self.end = match run.outcome {
            Err(error) => TrialEnd::Failed(error),
            Ok(Outcome::Interrupted) => brake.cut.unwrap_or(TrialEnd::Interrupted),
            Ok(_) => TrialEnd::Reached,
        };
        if self.end != TrialEnd::Reached {
            self.e = f64::INFINITY;
            return;
        }
        let Judged { e, missed, spurious, .. } = reference.judge(&trace);
        self.e = worse(self.e, e);
        self.missed += missed;
        self.spurious += spurious;
    }

    /// The work to its end, by what it needed so far.
    pub(super) fn needs(&self) -> f64 {
        self.work / self.course
    }

    /// Whether its sequence of events is that of the reference.
    pub fn events_are_right(&self) -> bool {
        self.missed + self.spurious == 0
    }
}

/// Breaks a run off at a limit of work, or once an [early part](EARLY) of that shows that it is on course for far more;
/// with too many events; at the limit of time; or from outside.
struct WorkLimit<'a> {
    benchmark: &'a Benchmark,
    setting: &'a Setting,
    /// Place of the part that it runs.
    at: usize,
    /// Work of the parts before.
    work_before: f64,
    limit: TrialLimit,
    /// Events of this part beyond which it chatters.
    most_events: Option<f64>,
    stop: &'a AtomicBool,
    clock: Clock,
    /// Time of the last accepted step.
    reached: f64,
    /// Events so far.
    n_events: u64,
    /// The end that it made.
    cut: Option<TrialEnd>,
}

impl WorkLimit<'_> {
    /// What follows from the work of this part, rejected attempts beyond what is counted `besides`.
    fn judge(&mut self, stats: &Stats, besides: f64, is_late: bool) -> ControlFlow<()> {
        let own = work(self.setting.method, self.setting.rtol(), &stats.work);
        let done = self.work_before + own + besides;
        let on_course = || self.benchmark.course(self.at, self.reached) * ON_COURSE;
        let is_hopeless = || done > self.limit.early && done > self.limit.work * on_course();
        if done > self.limit.work || is_hopeless() {
            self.cut = Some(TrialEnd::Cut);
        } else if is_late {
            self.cut = Some(TrialEnd::OutOfTime);
        } else if !self.stop.load(Ordering::Relaxed) {
            return ControlFlow::Continue(());
        }
        ControlFlow::Break(())
    }
}

/// From this part of its limit on, and from the least work of those that arrived on, a run is broken off where it is on course
/// for [so many times](ON_COURSE) the limit. A run that needs less than the least is at its end by then: it is not given up
/// for what its first impacts need.
pub(super) const EARLY: f64 = 1.0 / CUT;
/// See [`EARLY`]. Its margin is for methods whose work is not spread as that of the reference is; see [`Benchmark::course`].
pub(super) const ON_COURSE: f64 = 2.0;

impl Brake for WorkLimit<'_> {
    fn step(&mut self, t: f64, stats: &Stats) -> ControlFlow<()> {
        self.reached = t;
        self.judge(stats, 0.0, self.clock.is_over_after(stats))
    }

    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()> {
        let besides = Price::of_setting(self.setting).rejected(stats);
        self.judge(stats, besides, self.clock.is_over())
    }

    fn event(&mut self) -> ControlFlow<()> {
        self.n_events += 1;
        if self.most_events.is_none_or(|most| self.n_events as f64 <= most) {
            return ControlFlow::Continue(());
        }
        self.cut = Some(TrialEnd::Chatters);
        ControlFlow::Break(())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use deltazero_solvers::problems::{CompliantBall, Exit};

    use super::super::{Candidate, Contest, FINAL, Rules};
    use super::*;
    use crate::part::Subject;
    use crate::plan::sample_times;
    use crate::run::{Events, Limits};

    /// A ball that hits a stiff damped wall after 1 ms, for 0.1 ms, and flies on for the rest of 50 ms.
    const STRUCK_BALL: CompliantBall = CompliantBall {
        mass: 0.1,
        stiffness: 1e8,
        damping: 1e3,
        exit: Exit::Penetration,
        gap: 0.1,
        start: [1e-3, -1.0],
    };

    /// The work of each of `methods` that reaches 1e-6 in a contest on [`STRUCK_BALL`], in this order.
    fn works(methods: &[&'static str]) -> BTreeMap<String, f64> {
        let (t_end, stop) = (0.05, AtomicBool::new(false));
        let (subject, times) = (Subject::of(STRUCK_BALL), sample_times(None, t_end));
        let benchmark = Benchmark::new(subject, t_end, times, Limits::none(&stop)).unwrap();
        let candidate = |name: &&str| Candidate {
            method: Method::named(name).unwrap(),
            events: Events::Located,
        };
        let candidates = methods.iter().map(candidate).collect();
        let rules = Rules { candidates, repeats: 0, ..Rules::default() };
        let contest = Contest { benchmark: &benchmark, accuracy: 1e-6, rules: &rules, stop: &stop };
        let standings = contest.run(&|_| ());
        standings.entries.into_iter().map(|entry| (entry.method, entry.work)).collect()
    }

    #[test]
    fn a_short_contact_early_in_a_flight_cuts_no_method_in_any_order() {
        let mut methods = ["rk43", "rk45", "dop853", "radau5"];
        let alone: BTreeMap<_, _> = methods.iter().flat_map(|method| works(&[method])).collect();
        let least = alone.values().copied().fold(f64::INFINITY, f64::min);
        for (method, work) in &alone {
            let most = if method == "radau5" { CUT } else { FINAL };
            assert!(*work < most * least, "{alone:?}");
        }
        assert_eq!(alone.len(), methods.len());
        let forward = works(&methods);
        methods.reverse();
        let backward = works(&methods);
        let names = |works: &BTreeMap<String, f64>| works.keys().cloned().collect::<Vec<_>>();
        assert_eq!(names(&forward), names(&alone));
        assert_eq!(names(&backward), names(&alone));
    }

    #[test]
    fn a_run_chatters_beyond_four_times_the_events_of_the_reference_and_ten() {
        assert_eq!([0.0, 7.0].map(chatter_bound), [10.0, 38.0]);
    }
}

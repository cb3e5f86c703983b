//! What two tight runs tell of a run: how far its motion is predictable, and whether it has the events of a tight one.
//!
//! The two runs differ in the last bit of their start alone. From when on they part, the motion is not predictable; that
//! is the motion's and no method's, whatever the run asked about was made by. Two loose runs would part by their
//! tolerance, where a step is accepted in the one and rejected in the other, without any chaos.
//!
//! As long as both have the same sequence of events, a run with another sequence has lost or made up a contact, or has
//! one that grazes: no tolerance of its own tells it that. Where they do not come to their end at a few times the work, and
//! have not parted, one somewhat finer judges beyond them.

mod finer;
mod judge;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use deltazero_solvers::{Grid, Outcome, Stats};

use crate::errors::{Largest, worse};
use crate::parallel::in_parallel;
use crate::part::{Part, Start, Subject};
use crate::reference::{parted_at, settings};
use crate::run::{Brake, Events, ModeChange, PartRun, Setting};
use crate::selection::work;
use crate::trace::Trace;
use crate::warning::Warning;
use judge::{Judge, TightEvents};

pub use judge::parting;

/// Times at which runs are compared.
const TIMES: usize = 1000;
/// Fewest times at which runs of a problem of very many states are compared.
const LEAST_TIMES: usize = 50;
/// Numbers that a run keeps.
const MOST_NUMBERS: usize = 600_000;

/// Each of the two runs takes at most this many times the work of the run asked about, all methods that are tried
/// together.
const SHARE: f64 = 8.0;
/// Right-hand sides, times sites, that it may take in any case: a tenth of a second.
const LEAST_WORK: f64 = 4e6;

/// How far a motion is predictable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Horizon {
    /// To the end of the run.
    WholeRun,
    /// At this time a last-bit change of the start exceeds [`HORIZON_ERROR`](crate::reference::HORIZON_ERROR) [s].
    LostAt(f64),
    /// Nobody knows: no method came to the end within the work that it may take.
    NotMeasured,
}

/// The time span of one part over which its run is judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The end that was asked for [s].
    pub t_end: f64,
    /// How far the run came [s].
    pub reached: f64,
    /// Whether an event ended it there.
    pub is_stopped: bool,
    /// The [work] of the run that it is about, in right-hand sides.
    pub work: f64,
}

impl Span {
    /// The end of runs that this one is compared with [s]: that asked for where an event ended this one, as they may lack that event.
    fn end(&self) -> f64 {
        if self.is_stopped { self.t_end } else { self.reached }
    }

    /// At most `n` times, and at least half as many, the same ones wherever the run ended: of two that reach 90° each at
    /// a time of its own the horizon is one.
    fn times(&self, n: usize) -> Vec<f64> {
        let mut all = n as f64;
        while self.reached * all < 0.5 * self.t_end * n as f64 {
            all *= 2.0;
        }
        let time = |k: usize| self.t_end * k as f64 / all;
        (1..).map(time).take_while(|t| *t <= self.reached).collect()
    }
}

/// What tight runs tell of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct TightRuns {
    /// How far it is predictable.
    pub horizon: Horizon,
    /// The events that each part is compared with, one after the other.
    events: Vec<Vec<TightEvents>>,
}

impl TightRuns {
    /// The first site of part number `i` of `subject` that has another sequence of events in a run than in the tight runs.
    /// `run` holds the events of each site that [runs are compared by](crate::problem::changes), `end` the time that the run
    /// reached [s] and whether an event ended it there.
    pub fn warning(
        &self,
        subject: &Subject,
        i: usize,
        run: &[Vec<ModeChange>],
        end: (f64, bool),
    ) -> Option<Warning> {
        let (part, judges) = (subject.parts.get(i)?, self.events.get(i)?);
        judges.iter().find_map(|judge| judge.warning(part, run, end))
    }
}

/// Makes two tight runs of each part of `subject` over its span, both at the same time, to be compared with a run at
/// `setting`; and one somewhat finer than that, where they neither come to the end nor part.
pub fn tight_runs(
    subject: &Subject,
    setting: &Setting,
    spans: &[Span],
    stop: &AtomicBool,
) -> TightRuns {
    Pairs::new(subject, spans, 2, stop).told_with_finer(subject, setting, spans, stop)
}

/// What a run looks like beside two tight ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// How far the motion is predictable.
    pub horizon: Horizon,
    /// Its error `e` up to there; none where the tight runs of a part were broken off before, or parted at once.
    pub e: Option<f64>,
    /// Whether it has their events for as long as these are certain; none where the tight runs of a part were broken off
    /// before the horizon, and of a run that locates no events.
    pub has_events: Option<bool>,
}

/// Runs `subject` once more at `setting` and twice tightly, on one thread, over the spans of a run that came to its end.
pub fn estimate(
    subject: &Subject,
    setting: &Setting,
    spans: &[Span],
    stop: &AtomicBool,
) -> Estimate {
    Pairs::new(subject, spans, 1, stop).judged(subject, setting, spans, stop)
}

/// The tight runs of each part; none of one that was not run.
struct Pairs<'a>(Vec<Option<Pair<'a>>>);

impl<'a> Pairs<'a> {
    /// Makes both runs of each part, at the same time where `threads` is two.
    fn new(subject: &'a Subject, spans: &[Span], threads: usize, stop: &AtomicBool) -> Self {
        let parts = subject.parts.iter().zip(spans);
        Self(parts.map(|(part, span)| pair(part, *span, threads, stop)).collect())
    }

    fn largest(&self) -> Largest {
        let mut largest = Largest::default();
        self.0.iter().flatten().for_each(|pair| pair.measure(&mut largest));
        largest
    }

    fn told(&self) -> TightRuns {
        let largest = self.largest();
        let lost = self.0.iter().flatten().filter_map(|pair| pair.lost_at(&largest));
        let is_whole = self.0.iter().all(|pair| pair.as_ref().is_some_and(Pair::is_whole));
        let horizon = match lost.reduce(f64::min) {
            Some(t) => Horizon::LostAt(t),
            None if is_whole => Horizon::WholeRun,
            None => Horizon::NotMeasured,
        };
        TightRuns {
            horizon,
            events: self.0.iter().map(|pair| pair.iter().map(Pair::events).collect()).collect(),
        }
    }

    /// As [`told`](Self::told), with a finer run of each part whose pair tells nothing of its end.
    fn told_with_finer(
        &self,
        subject: &Subject,
        setting: &Setting,
        spans: &[Span],
        stop: &AtomicBool,
    ) -> TightRuns {
        let mut told = self.told();
        let each = self.0.iter().zip(&subject.parts).zip(spans).zip(&mut told.events);
        for (((pair, part), span), events) in each {
            if !pair.as_ref().is_some_and(Pair::is_settled) {
                events.extend(finer::events(part, setting, *span, stop));
            }
        }
        told
    }

    /// The estimate of a run of `subject` at `setting` over `spans`, which is made once more.
    fn judged(
        &self,
        subject: &Subject,
        setting: &Setting,
        spans: &[Span],
        stop: &AtomicBool,
    ) -> Estimate {
        let (tight, largest) = (self.told(), self.largest());
        let unknown = Estimate { horizon: tight.horizon, e: None, has_events: None };
        let until = match tight.horizon {
            Horizon::WholeRun => f64::INFINITY,
            Horizon::LostAt(t) => t,
            Horizon::NotMeasured => return unknown,
        };
        let (mut e, mut has_events) = (0.0, true);
        for (i, (pair, span)) in self.0.iter().zip(spans).enumerate() {
            let Some(pair) = pair.as_ref().filter(|pair| pair.reaches(until)) else {
                return unknown;
            };
            let mut bound = Bound { setting, most: f64::INFINITY, stop };
            let (run, trace) =
                pair.part.run(setting, Start::Exact, span.end(), &pair.grid, &mut bound);
            let Some(own) = pair.error(&trace, until, &largest) else { return unknown };
            e = worse(e, own);
            has_events &= tight.warning(subject, i, &trace.changes, end_of(&run)).is_none();
        }
        let is_located = setting.events == Events::Located;
        Estimate { e: Some(e), has_events: is_located.then_some(has_events), ..unknown }
    }
}

/// A run of a part, and one from a start changed in its last bit.
struct Pair<'a> {
    part: &'a Part,
    /// How far the run came that they are compared with [s].
    reached: f64,
    grid: Grid,
    own: (PartRun, Trace),
    nudged: (PartRun, Trace),
}

impl Pair<'_> {
    fn measure(&self, largest: &mut Largest) {
        self.part.measure(&self.own.1.states, largest);
    }

    /// The first time at which they differ [s].
    fn lost_at(&self, largest: &Largest) -> Option<f64> {
        parted_at(&self.own.1, &self.nudged.1, &self.part.error_scale(largest))
    }

    /// The error `e` of another run at samples before `until` [s]; infinite where it has less of them, none where there is
    /// no sample.
    fn error(&self, run: &Trace, until: f64, largest: &Largest) -> Option<f64> {
        let (tight, scale) = (&self.own.1, self.part.error_scale(largest));
        let n = tight.times.iter().take_while(|t| **t < until).count();
        if run.states.len() < n {
            return Some(f64::INFINITY);
        }
        let pairs = tight.samples().pairs(run.samples(), scale.event_window);
        pairs
            .filter(|(t, ..)| *t < until)
            .map(|(_, tight, own)| scale.error(own, tight))
            .reduce(worse)
    }

    /// As [`lost_at`](Self::lost_at), where the largest lengths are those of this part alone.
    fn lost_by_itself(&self) -> Option<f64> {
        let mut largest = Largest::default();
        self.measure(&mut largest);
        self.lost_at(&largest)
    }

    /// The events, certain for as long as both runs have the same ones.
    fn events(&self) -> TightEvents {
        let [own, nudged] = [&self.own, &self.nudged];
        let reached = own.0.t.min(nudged.0.t);
        let (changes, other) = (own.1.changes.clone(), &nudged.1.changes);
        let until = |(a, b): (&Vec<_>, &Vec<_>)| parting(a, b).map_or(reached, |t| t.min(reached));
        let until: Vec<f64> = changes.iter().zip(other).map(until).collect();
        let stops = own.0.stopped_at().zip(nudged.0.stopped_at());
        let is_certain = |(a, b): &(f64, f64)| {
            let near = (a - b).abs() <= judge::AT_END * self.part.unit_of_time;
            near && until.iter().all(|t| *t == reached) && self.lost_by_itself().is_none()
        };
        let stopped_at = stops.filter(is_certain).map(|(own, _)| own);
        TightEvents { changes, until, stopped_at, by: Judge::Tight }
    }

    /// Whether they tell how far the motion is predictable.
    fn is_settled(&self) -> bool {
        self.is_whole() || self.lost_by_itself().is_some()
    }

    /// Whether both came to their end, or as far as the run.
    fn is_whole(&self) -> bool {
        let is_whole = |run: &PartRun| {
            run.t >= self.reached || matches!(run.outcome, Ok(Outcome::Finished | Outcome::Stopped))
        };
        is_whole(&self.own.0) && is_whole(&self.nudged.0)
    }

    /// Whether both came to their end, or as far as the run, or at least to the time `t` [s].
    fn reaches(&self, t: f64) -> bool {
        self.is_whole() || self.own.0.t.min(self.nudged.0.t) >= t
    }
}

/// The pair of the first method of a reference that comes to the end, or to where the runs part; else the last one.
fn pair<'a>(part: &'a Part, span: Span, threads: usize, stop: &AtomicBool) -> Option<Pair<'a>> {
    if span.reached <= 0.0 {
        return None;
    }
    let n_times = (MOST_NUMBERS / part.states.len().max(1)).clamp(LEAST_TIMES, TIMES);
    let grid = Grid::Times(span.times(n_times));
    let mut left = (SHARE * span.work).max(LEAST_WORK / part.sites.len().max(1) as f64);
    let mut last = None;
    for setting in settings() {
        let bound = Bound { setting: &setting, most: 0.5 * left, stop };
        let run = |start: &Start| part.run(&setting, *start, span.end(), &grid, &mut bound.clone());
        let mut runs = in_parallel(&[Start::Exact, Start::Up], threads, run).into_iter();
        let (grid, own, nudged) = (grid.clone(), runs.next()?, runs.next()?);
        let nudged = if own.0.ends_like(&nudged.0) { run(&Start::Far) } else { nudged };
        let pair = Pair { part, reached: span.reached, grid, own, nudged };
        let is_settled = pair.is_settled();
        left -= bound.work(&pair.own.0.stats);
        last = Some(pair);
        if is_settled || stop.load(Ordering::Relaxed) {
            break;
        }
    }
    last
}

/// How far a run came [s], and whether an event ended it there.
fn end_of(run: &PartRun) -> (f64, bool) {
    (run.t, run.stopped_at().is_some())
}

/// Breaks a run off at a limit of work, or from outside.
#[derive(Clone, Copy)]
struct Bound<'a> {
    setting: &'a Setting,
    /// Right-hand sides.
    most: f64,
    stop: &'a AtomicBool,
}

impl Bound<'_> {
    /// A rejected step counts too: a series that is taken shorter costs no other.
    fn work(&self, stats: &Stats) -> f64 {
        work(self.setting.method, self.setting.rtol(), &stats.work) + stats.n_rejected as f64
    }

    fn judge(&self, stats: &Stats) -> ControlFlow<()> {
        if self.work(stats) > self.most || self.stop.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

impl Brake for Bound<'_> {
    fn step(&mut self, _t: f64, stats: &Stats) -> ControlFlow<()> {
        self.judge(stats)
    }

    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()> {
        self.judge(stats)
    }

    fn event(&mut self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use deltazero_solvers::Method;
    use deltazero_solvers::problems::CompliantBall;

    use super::*;
    use crate::problems::balls::HEAVY_BALL;
    use crate::run::Accuracy;

    static RUNNING: AtomicBool = AtomicBool::new(false);

    /// Two balls between walls with a run of each at rtol 1e-9 over 0.1 s, in which each hits both walls.
    fn two_balls() -> (Subject, Setting, [Span; 2]) {
        let ball = |speed: f64| CompliantBall { start: [1e-4, -speed], ..HEAVY_BALL };
        let parts = [1e-2, 2e-2].map(|speed| Part::new(ball(speed))).to_vec();
        let method = Method::named("rk45").unwrap();
        let accuracy = Accuracy::Rtol(1e-9, None);
        let setting = Setting { method, events: Events::Located, accuracy };
        (
            Subject { parts },
            setting,
            [Span { t_end: 0.1, reached: 0.1, is_stopped: false, work: 1e4 }; 2],
        )
    }

    #[test]
    fn where_no_tight_run_came_to_the_end_nothing_is_said_of_error_and_events() {
        let (subject, setting, spans) = two_balls();
        let whole = estimate(&subject, &setting, &spans, &RUNNING);
        assert_eq!((whole.horizon, whole.has_events), (Horizon::WholeRun, Some(true)));
        // Measured: 9.2e-7.
        assert!(whole.e.is_some_and(|e| e < 5e-6), "{whole:?}");
        // Each run is broken off after its first step.
        let none = estimate(&subject, &setting, &spans, &AtomicBool::new(true));
        assert_eq!(none, Estimate { horizon: Horizon::NotMeasured, e: None, has_events: None });
    }

    #[test]
    fn a_part_that_was_not_followed_to_the_horizon_leaves_the_error_unknown() {
        let (subject, setting, spans) = two_balls();
        let judged = |reached: f64| {
            let mut pairs = Pairs::new(&subject, &spans, 1, &RUNNING);
            let [Some(lost), Some(broken_off)] = &mut pairs.0[..] else { panic!("no tight runs") };
            let at = lost.own.1.times.iter().position(|t| *t >= 0.05).unwrap();
            lost.nudged.1.states[at..].iter_mut().for_each(|y| y[0] += 1e-4);
            let (run, trace) = &mut broken_off.own;
            (run.outcome, run.t) = (Ok(Outcome::Interrupted), reached);
            let n = trace.times.iter().take_while(|t| **t <= reached).count();
            trace.times.truncate(n);
            trace.states.truncate(n);
            pairs.judged(&subject, &setting, &spans, &RUNNING)
        };
        let early = judged(0.02);
        assert!(matches!(early.horizon, Horizon::LostAt(t) if t < 0.06), "{early:?}");
        assert_eq!((early.e, early.has_events), (None, None));
        let late = judged(0.08);
        assert!(late.e.is_some() && late.has_events == Some(true), "{late:?}");
    }

    #[test]
    fn a_finer_run_judges_beyond_tight_ones_that_did_not_come_to_the_end() {
        let (subject, setting, spans) = two_balls();
        let mut pairs = Pairs::new(&subject, &spans, 1, &RUNNING);
        let told = |pairs: &Pairs<'_>, setting: &Setting| {
            pairs.told_with_finer(&subject, setting, &spans, &RUNNING)
        };
        assert_eq!(told(&pairs, &setting).events[0].len(), 1);
        let Some(pair) = &mut pairs.0[0] else { panic!("no tight runs") };
        let all = pair.events().changes;
        for (run, _) in [&mut pair.own, &mut pair.nudged] {
            (run.outcome, run.t) = (Ok(Outcome::Interrupted), 0.05);
        }
        let judges = told(&pairs, &setting);
        assert_eq!(judges.events.iter().map(Vec::len).collect::<Vec<_>>(), [2, 1]);
        let message = |run: &[Vec<ModeChange>]| {
            judges.warning(&subject, 0, run, (0.1, false)).map(|warning| warning.message)
        };
        assert_eq!(message(&all), None);
        for (t, by) in [(0.0, "than runs at rounding"), (0.05, "than a run at rtol 1e-11 (")] {
            let mut run = all.clone();
            let lost = run[0].iter().position(|change| change.t > t).unwrap();
            run[0].remove(lost);
            assert!(message(&run).is_some_and(|own| own.contains(by)), "{by}: {:?}", message(&run));
        }
        let blind = Setting { events: Events::Blind, ..setting };
        assert_eq!(told(&pairs, &blind).events[0].len(), 1);
    }

    #[test]
    fn where_tight_runs_part_at_once_no_error_is_told() {
        let (subject, setting, spans) = two_balls();
        let mut pairs = Pairs::new(&subject, &spans, 1, &RUNNING);
        if let Some(lost) = &mut pairs.0[0] {
            lost.nudged.1.states.iter_mut().for_each(|y| y[0] += 1e-4);
        }
        assert_eq!(pairs.judged(&subject, &setting, &spans, &RUNNING).e, None);
    }

    #[test]
    fn a_run_that_only_rejects_is_broken_off_too() {
        let (_, setting, _) = two_balls();
        let stats = |n_rejected| Stats { n_rejected, ..Stats::default() };
        let ends = |most: f64, stop: &AtomicBool, n_rejected| {
            Bound { setting: &setting, most, stop }.rejected(&stats(n_rejected)).is_break()
        };
        assert!(!ends(100.0, &RUNNING, 64) && ends(100.0, &RUNNING, 128));
        assert!(ends(f64::INFINITY, &AtomicBool::new(true), 64));
    }

    #[test]
    fn times_are_the_same_wherever_a_run_ends() {
        let span = |reached| Span { t_end: 14.0, reached, is_stopped: false, work: 0.0 };
        let times = |reached| span(reached).times(1000);
        let [early, late] = [13.4, 13.5].map(times);
        assert_eq!(early, late[..early.len()]);
        assert_eq!(times(14.0).len(), 1000);
        assert_eq!(times(1e-3).last().map(|t| *t > 0.99e-3), Some(true));
        assert!(times(1e-3).len() >= 500);
    }
}

//! From when on a run is not predictable: two runs at rounding part, though only the last bit of the start differs.
//!
//! That is the motion's and no method's: it is measured by two tight runs, whatever the run asked about was made
//! by. Two loose ones part by their tolerance where a step is accepted in the one and rejected in the other,
//! without any chaos.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use deltazero_solvers::{Grid, Outcome, Stats};

use crate::errors::Largest;
use crate::parallel::in_parallel;
use crate::part::{Part, Start, Subject};
use crate::reference::{parted_at, settings};
use crate::run::{Brake, PartRun, Setting};
use crate::selection::work;
use crate::trace::Trace;

/// Times at which runs are compared.
const TIMES: usize = 1000;
/// The same of a problem of very many states.
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

/// What part of the motion of a part is asked about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The end that was asked for [s].
    pub t_end: f64,
    /// How far the run came [s].
    pub reached: f64,
    /// The [work] of the run that it is about, in right-hand sides.
    pub work: f64,
}

impl Span {
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

/// How far the motion of `subject` is predictable, each part over its span.
pub fn horizon(subject: &Subject, spans: &[Span], stop: &AtomicBool) -> Horizon {
    let pairs = subject.parts.iter().zip(spans).map(|(part, span)| pair(part, *span, stop));
    let pairs: Vec<Option<Pair<'_>>> = pairs.collect();
    let measured = || pairs.iter().flatten();
    let mut largest = Largest::default();
    measured().for_each(|pair| pair.measure(&mut largest));
    let lost = measured().filter_map(|pair| pair.lost_at(&largest)).reduce(f64::min);
    let is_whole = pairs.iter().all(|pair| pair.as_ref().is_some_and(Pair::is_whole));
    match lost {
        Some(t) => Horizon::LostAt(t),
        None if is_whole => Horizon::WholeRun,
        None => Horizon::NotMeasured,
    }
}

/// A run of a part, and one from a start changed in its last bit.
struct Pair<'a> {
    part: &'a Part,
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

    /// The same, lengths measured by its own alone.
    fn lost_by_itself(&self) -> Option<f64> {
        let mut largest = Largest::default();
        self.measure(&mut largest);
        self.lost_at(&largest)
    }

    /// Whether both came to their end.
    fn is_whole(&self) -> bool {
        let is_whole =
            |run: &PartRun| matches!(run.outcome, Ok(Outcome::Finished | Outcome::Stopped));
        is_whole(&self.own.0) && is_whole(&self.nudged.0)
    }
}

/// The pair of the first method of a reference that comes to the end, or to where the runs part; else the last one.
fn pair<'a>(part: &'a Part, span: Span, stop: &AtomicBool) -> Option<Pair<'a>> {
    if span.reached <= 0.0 {
        return None;
    }
    let n_times = (MOST_NUMBERS / part.states.len().max(1)).clamp(LEAST_TIMES, TIMES);
    let grid = Grid::Times(span.times(n_times));
    let mut left = (SHARE * span.work).max(LEAST_WORK / part.sites.len().max(1) as f64);
    let mut last = None;
    for setting in settings() {
        let bound = Bound { setting: &setting, most: 0.5 * left, stop };
        let run =
            |start: &Start| part.run(&setting, *start, span.reached, &grid, &mut bound.clone());
        let mut runs = in_parallel(&[Start::Exact, Start::Up], 2, run).into_iter();
        let pair = Pair { part, own: runs.next()?, nudged: runs.next()? };
        let is_settled = pair.is_whole() || pair.lost_by_itself().is_some();
        left -= bound.work(&pair.own.0.stats);
        last = Some(pair);
        if is_settled || stop.load(Ordering::Relaxed) {
            break;
        }
    }
    last
}

/// What breaks a run off.
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
}

impl Brake for Bound<'_> {
    fn step(&mut self, _t: f64, stats: &Stats) -> ControlFlow<()> {
        if self.work(stats) > self.most || self.stop.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    fn rejected(&mut self, _stats: &Stats) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_the_same_wherever_a_run_ends() {
        let times = |reached| Span { t_end: 14.0, reached, work: 0.0 }.times(1000);
        let [early, late] = [13.4, 13.5].map(times);
        assert_eq!(early, late[..early.len()]);
        assert_eq!(times(14.0).len(), 1000);
        assert_eq!(times(1e-3).last().map(|t| *t > 0.99e-3), Some(true));
        assert!(times(1e-3).len() >= 500);
    }
}

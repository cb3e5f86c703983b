//! From when on a run is not predictable: two runs at rounding part, though only the last bit of the start differs.
//!
//! That is the motion's and no method's: it is measured by two tight runs, whatever the run asked about was made
//! by. Two loose ones part by their tolerance where a step is accepted in the one and rejected in the other,
//! without any chaos.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use deltazero_solvers::{Accepted, Event, Grid, Needs, Outcome, Record, Stats, System, Trajectory};

use super::parallel::in_parallel;
use crate::contest::work;
use crate::metrics::ErrorScale;
use crate::model::{Block, Mechanism, Part};
use crate::reference::{parted_at, settings};
use crate::run::{BlockTrajectory, Integrable, JointsRun, Setting, integrate, trajectories};

/// Times at which runs are compared.
const TIMES: usize = 1000;
/// The same of a chain of very many bays.
const LEAST_TIMES: usize = 50;
/// States of joints that a run keeps.
const MOST_STATES: usize = 100_000;

/// Each of the two runs takes at most this many times the work of the run asked about, all methods that are tried
/// together.
const SHARE: f64 = 8.0;
/// Right-hand sides, times joints, that it may take in any case: a tenth of a second.
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

/// How far the motion of `mechanism` is predictable, each part over its span.
pub fn horizon(mechanism: &Mechanism, spans: &[Span], stop: &AtomicBool) -> Horizon {
    let pairs = mechanism.parts.iter().zip(spans).map(|(part, span)| match part {
        Part::Block(block) => pair(block, *span, stop),
        Part::Chain(chain) => pair(chain, *span, stop),
    });
    let pairs: Vec<Option<Pair<'_>>> = pairs.collect();
    let measured = || pairs.iter().flatten();
    let theta = measured().map(Pair::largest_angle).fold(f64::MIN_POSITIVE, f64::max);
    let lost = measured().filter_map(|pair| pair.lost_at(theta)).reduce(f64::min);
    let is_whole = pairs.iter().all(|pair| pair.as_ref().is_some_and(Pair::is_whole));
    match lost {
        Some(t) => Horizon::LostAt(t),
        None if is_whole => Horizon::WholeRun,
        None => Horizon::NotMeasured,
    }
}

/// A run of a part, and one from a start changed in its last bit.
struct Pair<'a> {
    block: &'a Block,
    own: Path,
    nudged: Path,
}

struct Path {
    run: JointsRun,
    joints: Vec<BlockTrajectory>,
}

impl Pair<'_> {
    fn largest_angle(&self) -> f64 {
        let samples = self.own.joints.iter().flat_map(|joint| &joint.samples);
        samples.map(|sample| sample.y[2].abs()).fold(f64::MIN_POSITIVE, f64::max)
    }

    /// The first time at which they differ [s], angles measured by `theta` [rad].
    fn lost_at(&self, theta: f64) -> Option<f64> {
        let scale = ErrorScale::of(self.block, theta);
        let joints = self.own.joints.iter().zip(&self.nudged.joints);
        let lost = joints.filter_map(|(own, nudged)| parted_at(own, nudged, scale));
        lost.reduce(f64::min)
    }

    /// Whether both came to their end.
    fn is_whole(&self) -> bool {
        let is_whole =
            |path: &Path| matches!(path.run.outcome, Ok(Outcome::Finished | Outcome::Stopped));
        is_whole(&self.own) && is_whole(&self.nudged)
    }
}

/// The pair of the first method of a reference that comes to the end, or to where the runs part; else the last one.
fn pair<'a, P: Integrable + Sync>(part: &'a P, span: Span, stop: &AtomicBool) -> Option<Pair<'a>> {
    if span.reached <= 0.0 {
        return None;
    }
    let n_joints = part.n_joints();
    let n_times = (MOST_STATES / n_joints).clamp(LEAST_TIMES, TIMES);
    let grid = Grid::Times(span.times(n_times));
    let mut left = (SHARE * span.work).max(LEAST_WORK / n_joints as f64);
    let mut last = None;
    for setting in settings() {
        let bound = Bound { setting, most: 0.5 * left, stop };
        let path = |is_nudged: &bool| {
            let y0 = if *is_nudged { part.start_nudged(f64::next_up) } else { part.start() };
            let mut record = (Trajectory::on(grid.clone()), bound);
            let run = integrate(part, &setting, y0, span.reached, &mut record);
            Path { run: run.by_joint(part), joints: trajectories(part, &record.0) }
        };
        let mut paths = in_parallel(&[false, true], 2, path).into_iter();
        let pair = Pair { block: part.block(), own: paths.next()?, nudged: paths.next()? };
        let is_settled = pair.is_whole() || pair.lost_at(pair.largest_angle()).is_some();
        left -= bound.work(&pair.own.run.stats);
        last = Some(pair);
        if is_settled || stop.load(Ordering::Relaxed) {
            break;
        }
    }
    last
}

/// What breaks a run off, as a recorder.
#[derive(Clone, Copy)]
struct Bound<'a> {
    setting: Setting,
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

impl<P: System> Record<P> for Bound<'_> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        if self.work(accepted.stats) > self.most || self.stop.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    fn event(&mut self, _: &Event<'_, P>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Ends
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;
    use crate::reference::Reference;
    use crate::run::Limits;
    use crate::study::work_precision::sample_times;

    static RUNNING: AtomicBool = AtomicBool::new(false);

    fn measured(config: &Config, work: f64) -> Horizon {
        let mechanism = Mechanism::new(config);
        let spans = vec![
            Span { t_end: config.run.t_end, reached: config.run.t_end, work };
            mechanism.parts.len()
        ];
        horizon(&mechanism, &spans, &RUNNING)
    }

    #[test]
    fn the_horizon_is_that_of_the_reference() {
        for sets in [&["contact.damping=0"][..], &["reading=full", "run.t_end=0.3"]] {
            let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
            let config = Config::load(None, &sets).unwrap();
            let limits = Limits::none(&RUNNING);
            let (times, t_end) = (sample_times(&config), config.run.t_end);
            let reference =
                Reference::new(&Mechanism::new(&config), t_end, &times, limits).unwrap();
            match measured(&config, 0.0) {
                // Times of the reference are 0.01 s apart, these ones 0.002 s.
                Horizon::LostAt(t) => assert!((reference.horizon() - t).abs() < 0.02, "{t}"),
                other => assert_eq!((other, reference.horizon()), (Horizon::WholeRun, t_end)),
            }
        }
    }

    #[test]
    fn a_motion_that_costs_too_much_to_follow_is_not_measured() {
        let config = Config::table1().unwrap();
        let mechanism = Mechanism::new(&config);
        assert_eq!(measured(&config, 0.0), Horizon::WholeRun);
        let spans = [Span { t_end: 1e3, reached: 1e3, work: 0.0 }; 2];
        assert_eq!(horizon(&mechanism, &spans, &AtomicBool::new(true)), Horizon::NotMeasured);
        let failed_at_once = [Span { t_end: 2.0, reached: 0.0, work: 0.0 }; 2];
        assert_eq!(horizon(&mechanism, &failed_at_once, &RUNNING), Horizon::NotMeasured);
    }

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

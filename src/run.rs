//! One run: a mechanism, block by block, by one method at one setting.

mod chain;
mod part;

use std::fmt;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use deltazero_solvers::{
    Accepted, Blind, Control, Error, Event, Grid, Integration, Method, ModeOfState, Next, Outcome,
    Record, Stats, Switch, System, Tolerance, Trajectory, Unblind,
};

use serde::{Deserialize, Serialize};

use deltazero_solvers::Real as _;
use deltazero_solvers::taylor::ExtendedIntegration;

use crate::config::{Atol, Config, Events};
use crate::model::{Block, Mechanism, Mode, State};

pub use chain::{ChainRun, ChainTrajectory, chain_mode_changes, integrate_chain};
pub use part::{JointHistory, JointSample, Part};

/// How accurate a method is asked to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Accuracy {
    /// Relative tolerance, and absolute tolerances if not `rtol` times the scale of each state.
    Rtol(f64, Option<Atol>),
    /// Fixed step [s].
    Step(f64),
}

impl fmt::Display for Accuracy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rtol(rtol, _) => write!(f, "rtol {rtol:e}"),
            Self::Step(step) => write!(f, "h {step:e} s"),
        }
    }
}

/// A method with all that is chosen about it.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// The method.
    pub method: &'static Method,
    /// What it does with events.
    pub events: Events,
    /// Its tolerance or step.
    pub accuracy: Accuracy,
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}, {}", self.method.name, self.events, self.accuracy)
    }
}

impl Setting {
    /// The `[solver]` table of a configuration; none if its method does not exist.
    pub fn of(config: &Config) -> Option<Self> {
        let solver = &config.solver;
        let method = Method::named(&solver.method)?;
        let accuracy = if method.is_fixed_step() {
            Accuracy::Step(solver.step)
        } else {
            Accuracy::Rtol(solver.rtol, solver.atol)
        };
        Some(Self { method, events: solver.events, accuracy })
    }

    /// The relative tolerance, where it has one.
    pub fn rtol(&self) -> Option<f64> {
        match self.accuracy {
            Accuracy::Rtol(rtol, _) => Some(rtol),
            Accuracy::Step(_) => None,
        }
    }

    /// The fixed step [s], where it has one.
    pub fn step(&self) -> Option<f64> {
        match self.accuracy {
            Accuracy::Rtol(..) => None,
            Accuracy::Step(step) => Some(step),
        }
    }

    fn control(&self, block: &Block) -> Control {
        match self.accuracy {
            Accuracy::Step(step) => Control::Fixed(step),
            Accuracy::Rtol(rtol, atol) => {
                let atol = match atol {
                    None => block.scale().map(|scale| rtol * scale).to_vec(),
                    Some(atol) => block.in_paper_order(&atol.each()).to_vec(),
                };
                Control::Adaptive(Tolerance { rtol, atol })
            }
        }
    }
}

/// What became of one block.
#[derive(Clone, Debug)]
pub struct BlockRun {
    /// Number of the joint, 1 or 2.
    pub joint: usize,
    /// How it ended.
    pub outcome: Result<Outcome, Error>,
    /// Time of the last accepted step [s].
    pub t: f64,
    /// State there.
    pub y: State<f64>,
    /// Mode there.
    pub mode: Mode,
    /// Work.
    pub stats: Stats,
    /// Time that the integration took.
    pub wall: Duration,
}

impl BlockRun {
    /// When θ reached 90° [s], if it did.
    pub fn reached_90(&self) -> Option<f64> {
        (self.outcome == Ok(Outcome::Stopped)).then_some(self.t)
    }
}

/// Integrates `block` from `y0` at t = 0 to `t_end`, shown to `record`.
///
/// The one stopwatch is here: [`BlockRun::wall`] is the time of the integration with its recorder.
pub fn integrate(
    block: &Block,
    setting: &Setting,
    y0: State<f64>,
    t_end: f64,
    record: &mut dyn Record<Block>,
) -> BlockRun {
    let start = Instant::now();
    if let Err(error) = block.check() {
        let mode = block.initial_mode(0.0, &y0);
        let (stats, wall) = (Stats::default(), start.elapsed());
        return BlockRun {
            joint: block.joint,
            outcome: Err(error),
            t: 0.0,
            y: y0,
            mode,
            stats,
            wall,
        };
    }
    match setting.events {
        Events::Located => {
            let mut run = Integration::new(block, 0.0, y0);
            let outcome = solve(block, block, &mut run, setting, t_end, record);
            finished(block, &run, run.point.mode, outcome, start)
        }
        Events::Blind => {
            let blind = Blind(block);
            let mut run = Integration::new(&blind, 0.0, y0);
            let mut record = Unblind::new(block, 0.0, &y0, record);
            let outcome = solve(block, &blind, &mut run, setting, t_end, &mut record);
            let mode = block.mode_of_state(run.point.t, &run.point.y);
            finished(block, &run, mode, outcome, start)
        }
    }
}

/// Integrates `block` as [`integrate`] does from each of `starts`, with the same bits, each into the
/// trajectory of its place: located runs by [several at once](Method::run_many), the time shared among them.
///
/// # Panics
/// Where there are fewer trajectories than starts.
pub fn integrate_many(
    block: &Block,
    setting: &Setting,
    starts: &[State<f64>],
    t_end: f64,
    trajectories: &mut [BlockTrajectory],
) -> Vec<BlockRun> {
    assert!(trajectories.len() >= starts.len(), "a trajectory for each start is needed");
    let start = Instant::now();
    let mut runs: Vec<_> = starts.iter().map(|y| Integration::new(block, 0.0, *y)).collect();
    let control = setting.control(block);
    let ends = match setting.events {
        Events::Located => block
            .check()
            .and_then(|()| setting.method.run_many(&mut runs, t_end, &control, trajectories)),
        Events::Blind => {
            let pairs = starts.iter().zip(trajectories);
            return pairs.map(|(y, record)| integrate(block, setting, *y, t_end, record)).collect();
        }
    };
    let ends = ends.unwrap_or_else(|error| vec![Err(error); runs.len()]);
    let share = start.elapsed().div_f64(runs.len().max(1) as f64);
    let finished = |(run, end): (&Integration<'_, Block>, _)| BlockRun {
        wall: share,
        ..finished(block, run, run.point.mode, end, start)
    };
    runs.iter().zip(ends).map(finished).collect()
}

/// Integrates `block` as [`integrate`] does, located, in extended precision: Taylor series over pairs of f64
/// at the relative tolerance `rtol`, the absolute ones `rtol` times the scale of each state.
pub fn integrate_extended(
    block: &Block,
    rtol: f64,
    y0: State<f64>,
    t_end: f64,
    record: &mut dyn Record<Block>,
) -> BlockRun {
    let start = Instant::now();
    let atol = block.scale().map(|scale| rtol * scale).to_vec();
    let mut run = ExtendedIntegration::new(block, 0.0, &y0, Tolerance { rtol, atol });
    let outcome = block.check().and_then(|()| run.run(t_end, record));
    BlockRun {
        joint: block.joint,
        outcome: block.judged(outcome, run.t.value(), run.mode, &run.rounded()),
        t: run.t.value(),
        y: run.rounded(),
        mode: run.mode,
        stats: run.stats,
        wall: start.elapsed(),
    }
}

fn solve<P: System>(
    block: &Block,
    problem: &P,
    run: &mut Integration<'_, P>,
    setting: &Setting,
    t_end: f64,
    record: &mut dyn Record<P>,
) -> Result<Outcome, Error> {
    let mut solver = setting.method.solver(problem, setting.control(block))?;
    run.run(t_end, &mut *solver, record)
}

fn finished<P: System<State<f64> = State<f64>>>(
    block: &Block,
    run: &Integration<'_, P>,
    mode: Mode,
    outcome: Result<Outcome, Error>,
    start: Instant,
) -> BlockRun {
    BlockRun {
        joint: block.joint,
        outcome: block.judged(outcome, run.point.t, mode, &run.point.y),
        t: run.point.t,
        y: run.point.y,
        mode,
        stats: run.stats,
        wall: start.elapsed(),
    }
}

/// The mode that `block` is computed in at `(t, y)`, inside a step begun in `mode`: this very one where
/// events are located, and what the state says where they are not.
pub fn mode_within(block: &Block, events: Events, mode: Mode, t: f64, y: &State<f64>) -> Mode {
    match events {
        Events::Located => mode,
        Events::Blind => block.mode_of_state(t, y),
    }
}

/// Samples and events of a block.
pub type BlockTrajectory = Trajectory<State<f64>, Mode>;

/// What breaks a run off, as a recorder.
#[derive(Clone, Copy, Debug)]
pub struct Limits<'a> {
    /// Evaluations of the right-hand side beyond which it is cut.
    pub max_rhs: u64,
    /// Set from outside to interrupt it.
    pub stop: &'a AtomicBool,
}

impl Limits<'_> {
    /// Whether it was interrupted from outside.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

impl<P: System> Record<P> for Limits<'_> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        if accepted.stats.work.n_rhs > self.max_rhs || self.is_stopped() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    fn event(&mut self, _: &Event<'_, P>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn interpolates(&self, _t0: f64, _t1: f64) -> bool {
        false
    }
}

/// A run of both blocks with its trajectories.
#[derive(Clone, Debug)]
pub struct Run {
    /// What became of each block.
    pub blocks: Vec<BlockRun>,
    /// Samples and events of each block.
    pub trajectories: Vec<BlockTrajectory>,
}

impl Run {
    /// Runs both blocks of `mechanism` from the paper's start to `t_end`, keeping samples on
    /// `grid`, within `limits`.
    pub fn new(
        mechanism: &Mechanism,
        setting: &Setting,
        t_end: f64,
        grid: &Grid,
        limits: Limits<'_>,
    ) -> Self {
        let mut left = limits;
        let run = mechanism.blocks.iter().map(|block| {
            let mut record = (Trajectory::on(grid.clone()), left);
            let run = integrate(block, setting, block.initial_state(), t_end, &mut record);
            left.max_rhs = left.max_rhs.saturating_sub(run.stats.work.n_rhs);
            (run, record.0)
        });
        let (blocks, trajectories) = run.unzip();
        Self { blocks, trajectories }
    }

    /// Work of both blocks together.
    pub fn stats(&self) -> Stats {
        let mut sum = Stats::default();
        for block in &self.blocks {
            sum += block.stats;
        }
        sum
    }

    /// Time that the integration of both blocks took.
    pub fn wall(&self) -> Duration {
        self.blocks.iter().map(|block| block.wall).sum()
    }

    /// Whether a limit broke it off.
    pub fn is_broken_off(&self) -> bool {
        self.blocks.iter().any(|block| block.outcome == Ok(Outcome::Interrupted))
    }

    /// The first failure, if any.
    pub fn error(&self) -> Option<&Error> {
        self.blocks.iter().find_map(|block| block.outcome.as_ref().err())
    }
}

/// A row of the events file: a switch of the mode as the files write it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModeChange {
    /// Time [s].
    pub t: f64,
    /// Code of the mode before.
    pub before: i8,
    /// Code of the mode after.
    pub after: i8,
}

/// Contacts that began at the floor of the impact speed or below it, of a law that asks for that speed.
pub fn contacts_at_floor(block: &Block, trajectory: &BlockTrajectory) -> usize {
    let is_at_floor = |switch: &&Switch<Mode>| match switch.after {
        Next::Mode(after) => block.begins_at_floor(switch.before, after),
        Next::Stop => false,
    };
    trajectory.events.iter().filter(is_at_floor).count()
}

/// The mode changes among the events of a block; free apart and free relaxing are one mode.
pub fn mode_changes(trajectory: &BlockTrajectory) -> Vec<ModeChange> {
    let change = |switch: &Switch<Mode>| match switch.after {
        Next::Mode(after) if after.code() != switch.before.code() => {
            Some(ModeChange { t: switch.t, before: switch.before.code(), after: after.code() })
        }
        _ => None,
    };
    trajectory.events.iter().filter_map(change).collect()
}

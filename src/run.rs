//! One run: a mechanism, part by part, by one method at one setting.

mod integrate;
mod joints;
mod limits;
mod stopwatch;

use std::fmt;

use deltazero_solvers::{
    Control, Error, Grid, Method, Next, Outcome, Stats, Switch, Tolerance, Trajectory,
};
use serde::{Deserialize, Serialize};

use crate::config::{Atol, Config, Events};
use crate::model::{Block, Jointed, Mechanism, Mode, Part, State};

pub use integrate::{
    BlockRun, Integrable, JointsRun, OwnRun, PartRun, integrate, integrate_many, integrate_pair,
};
pub use joints::{JointHistory, JointSample, OwnTrajectory, histories, switches, trajectories};
pub use limits::{Clock, Limit, Limits, Price, SERIES, Watch};
pub use stopwatch::Took;

/// How accurate a method is asked to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Accuracy {
    /// Relative tolerance, and absolute tolerances if not `rtol` times the scale of each state.
    Rtol(f64, Option<Atol>),
    /// Fixed step [s].
    Step(f64),
}

impl Accuracy {
    /// That of a row of a table, with a tolerance or a step; none where it has neither.
    pub fn of_columns(rtol: Option<f64>, step: Option<f64>, atol: Option<Atol>) -> Option<Self> {
        rtol.map(|rtol| Self::Rtol(rtol, atol)).or(step.map(Self::Step))
    }
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

    fn control<P: Jointed>(&self, part: &P) -> Control {
        match self.accuracy {
            Accuracy::Step(step) => Control::Fixed(step),
            Accuracy::Rtol(rtol, atol) => {
                let mut all = part.scales().as_ref().to_vec();
                all.iter_mut().for_each(|scale| *scale *= rtol);
                if let Some(Atol::Same(atol)) = atol {
                    all.fill(atol);
                } else if let Some(atol) = atol {
                    part.set_each(&mut all, &part.block().in_paper_order(&atol.each()));
                }
                Control::Adaptive(Tolerance { rtol, atol: all })
            }
        }
    }
}
/// Samples and events of a block.
pub type BlockTrajectory = Trajectory<State<f64>, Mode>;

/// A run of a mechanism with its trajectories.
#[derive(Clone, Debug)]
pub struct Run {
    /// What became of each part.
    pub parts: Vec<JointsRun>,
    /// Samples and events of each joint.
    pub trajectories: Vec<BlockTrajectory>,
    /// The limit that broke it off, if one did.
    pub cut: Option<Limit>,
}

impl Run {
    /// Runs the parts of `mechanism` from the paper's start to `t_end`, keeping samples on
    /// `grid`, within `limits`.
    pub fn new(
        mechanism: &Mechanism,
        setting: &Setting,
        t_end: f64,
        grid: &Grid,
        limits: Limits<'_>,
    ) -> Self {
        let (mut left, price) = (limits, Price::of_setting(setting));
        let mut all = Self { parts: Vec::new(), trajectories: Vec::new(), cut: None };
        for part in &mechanism.parts {
            let (run, trajectories, cut) = match part {
                Part::Block(block) => one(block, setting, t_end, grid, left),
                Part::Chain(chain) => one(chain, setting, t_end, grid, left),
            };
            left = left.after(&run, price);
            all.cut = all.cut.or(cut);
            all.parts.push(run);
            all.trajectories.extend(trajectories);
        }
        all
    }

    /// Work of all parts together.
    pub fn stats(&self) -> Stats {
        let mut sum = Stats::default();
        for part in &self.parts {
            sum += part.stats;
        }
        sum
    }

    /// Time that the integration of all parts took.
    pub fn took(&self) -> Took {
        self.parts.iter().map(|part| part.took).sum()
    }

    /// Whether a limit broke it off.
    pub fn is_broken_off(&self) -> bool {
        self.parts.iter().any(|part| part.outcome == Ok(Outcome::Interrupted))
    }

    /// The first failure, if any.
    pub fn error(&self) -> Option<&Error> {
        self.parts.iter().find_map(|part| part.outcome.as_ref().err())
    }
}

/// One part of a [`Run`].
fn one<P: Integrable>(
    part: &P,
    setting: &Setting,
    t_end: f64,
    grid: &Grid,
    limits: Limits<'_>,
) -> (JointsRun, Vec<BlockTrajectory>, Option<Limit>) {
    let watch = limits.watch(Price::of_setting(setting));
    let mut record = (Trajectory::on(grid.clone()), watch);
    let run = integrate(part, setting, part.start(), t_end, &mut record);
    (run.by_joint(part), trajectories(part, &record.0), record.1.cut)
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
pub fn contacts_at_floor(block: &Block, events: &[Switch<Mode>]) -> usize {
    let is_at_floor = |switch: &&Switch<Mode>| match switch.after {
        Next::Mode(after) => block.begins_at_floor(switch.before, after),
        Next::Stop => false,
    };
    events.iter().filter(is_at_floor).count()
}

/// The mode changes among the events of a block; free apart and free relaxing are one mode.
pub fn mode_changes(trajectory: &BlockTrajectory) -> Vec<ModeChange> {
    changes_among(&trajectory.events)
}

fn changes_among(events: &[Switch<Mode>]) -> Vec<ModeChange> {
    let change = |switch: &Switch<Mode>| match switch.after {
        Next::Mode(after) if after.code() != switch.before.code() => {
            Some(ModeChange { t: switch.t, before: switch.before.code(), after: after.code() })
        }
        _ => None,
    };
    events.iter().filter_map(change).collect()
}

//! One run of a mechanism, joint by joint.

mod joints;

use deltazero_solvers::{Error, Grid, Next, Stats, Switch, Trajectory};
use deltazero_study::run::{Braked, Limit, Limits, ModeChange, PartRun, Price, Setting, Took};

use crate::config::Config;
use crate::model::{Jointed, Joints, Mode, Part, State};

pub use joints::{switches, trajectories};

/// The `[solver]` table of a configuration; none if its method does not exist.
pub fn setting(config: &Config) -> Option<Setting> {
    use deltazero_solvers::Method;
    use deltazero_study::setting::Accuracy;
    let solver = &config.solver;
    let method = Method::named(&solver.method)?;
    let accuracy = if method.is_fixed_step() {
        Accuracy::Step(solver.step)
    } else {
        Accuracy::Rtol(solver.rtol, solver.atol.clone().map(Into::into))
    };
    Some(Setting { method, events: solver.events, accuracy })
}

/// Samples and events of a block.
pub type BlockTrajectory = Trajectory<State<f64>, Mode>;

/// A run of a mechanism with its trajectories.
#[derive(Clone, Debug)]
pub struct Run {
    /// What became of each part.
    pub parts: Vec<PartRun>,
    /// Samples and events of each joint.
    pub trajectories: Vec<BlockTrajectory>,
    /// The limit that broke it off, if one did.
    pub cut: Option<Limit>,
}

impl Run {
    /// Runs the parts of `mechanism` from the paper's start to `t_end`, keeping samples on
    /// `grid`, within `limits`.
    pub fn new(
        mechanism: &Joints,
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

    /// The first failure, if any.
    pub fn error(&self) -> Option<&Error> {
        self.parts.iter().find_map(|part| part.outcome.as_ref().err())
    }
}

/// One part of a [`Run`].
fn one<P: Jointed>(
    part: &P,
    setting: &Setting,
    t_end: f64,
    grid: &Grid,
    limits: Limits<'_>,
) -> (PartRun, Vec<BlockTrajectory>, Option<Limit>) {
    let mut watch = limits.watch(Price::of_setting(setting));
    let mut record = (Trajectory::on(grid.clone()), Braked(&mut watch));
    let run = part.integrate(setting, part.start(), t_end, &mut record);
    let trajectories = trajectories(part, &record.0);
    (run.plain(), trajectories, watch.cut)
}

/// The mode changes among the events of a block; free apart and free relaxing are one mode.
pub fn mode_changes(trajectory: &BlockTrajectory) -> Vec<ModeChange> {
    let change = |switch: &Switch<Mode>| match switch.after {
        Next::Mode(after) if after.code() != switch.before.code() => {
            Some(ModeChange::new(switch.t, switch.before.code(), after.code()))
        }
        _ => None,
    };
    trajectory.events.iter().filter_map(change).collect()
}

/// Those of the mode changes of a joint that runs are compared by: all but that of a start on the surface, whose time has no
/// digits.
pub fn without_start<'a>(part: &impl Jointed, changes: &'a [ModeChange]) -> &'a [ModeChange] {
    let n_of_start = usize::from(part.starts_on_surface()).min(changes.len());
    &changes[n_of_start..]
}

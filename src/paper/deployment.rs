//! The deployment of one joint to 90° under a reading, and from when on its digits are lost.

use deltazero_solvers::{Grid, Trajectory};
use deltazero_study::energy_balance::EnergyBalance;
use deltazero_study::errors::Largest;
use deltazero_study::part::Start;
use deltazero_study::problem::changes;
use deltazero_study::reference::parted_at;
use deltazero_study::run::{Braked, Limits, OwnRun, Price, Setting};
use deltazero_study::setting::Events;
use deltazero_study::trace::Trace;
use serde::{Deserialize, Serialize};

use super::course::{Bin, Binning, Quantity, Range};
use super::ideal::{RIGHT_ANGLE, time_to};
use crate::config::Config;
use crate::keys::ReadingName;
use crate::model::struts::struts;
use crate::model::{Block, Jointed as _, Part, State};
use crate::run::BlockTrajectory;

/// A run lasts at most this many times as long as the ideal joint takes to 90°.
pub const PATIENCE: f64 = 2.0;
/// The first part of a deployment, in which the paper sees fluctuations [s].
pub const TRANSIENT_S: f64 = 2.0;
/// Most bins, and most samples: of a joint that takes longer they are wider.
const MOST_BINS: f64 = 1e5;
/// Width of the bins [s]: a rattling pin changes its mode some fifteen times a second.
const BIN_S: f64 = 0.01;
/// Spacing of the samples that the horizon is looked for on [s].
const SAMPLE_S: f64 = 0.01;

/// The run of one joint to 90°.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunRow {
    /// Reading; none without clearance.
    pub reading: Option<ReadingName>,
    /// Joint, 1 or 2.
    pub joint: usize,
    /// When θ reaches 90° [s]; none if it never does.
    pub reached_90_s: Option<f64>,
    /// By how much a last-bit change of the start moves that [s].
    pub moved_s: Option<f64>,
    /// From when on the digits are lost: a last-bit change of the start exceeds e = 1e-9 [s].
    pub horizon_s: Option<f64>,
    /// When the run ended [s].
    pub end_s: f64,
    /// Largest θ [rad], in the direction of the torque.
    pub theta_max_rad: f64,
    /// When that was [s].
    pub theta_max_at_s: f64,
    /// Mode changes, the start's own left out.
    pub n_events: usize,
    /// Separations of pin and bush in the first [`TRANSIENT_S`]; none of a run that ends before without being at 90°.
    pub separations: Option<usize>,
    /// Largest normal force before the horizon [N].
    pub force_before_horizon_n: f64,
    /// Largest normal force of the whole run [N].
    pub force_n: f64,
    /// By how much last-bit changes of the start move that [N]; none where an earlier version did not say.
    #[serde(default)]
    pub force_moved_n: Option<f64>,
    /// Work of the torque [J].
    pub work_j: f64,
    /// Energy that nothing accounts for [J]: what an inconsistent reading feeds in.
    pub fed_in_j: f64,
    /// Why it ended early, if it did.
    pub error: Option<String>,
}

/// A run with its motion.
#[derive(Clone, Debug)]
pub struct Course {
    /// What is said of it.
    pub run: RunRow,
    /// Its motion.
    pub bins: Vec<Bin>,
    /// The state at its end, in the order of the block.
    pub end: State<f64>,
    /// The same from starts moved by their last bit, up and down: what they do not share is beyond the horizon. They
    /// have no such runs of their own.
    pub nudged: Vec<Course>,
}

impl Course {
    /// What there is of it up to `t` [s]: its motion, and whether it has arrived by then.
    pub(super) fn cut(&self, t: f64) -> Self {
        let RunRow { reached_90_s, end_s, separations, .. } = self.run;
        let run = RunRow {
            reached_90_s: reached_90_s.filter(|at| *at <= t),
            end_s: end_s.min(t),
            separations: separations
                .filter(|_| t >= TRANSIENT_S || reached_90_s.is_some_and(|at| at <= t)),
            ..self.run.clone()
        };
        Self { run, bins: self.until(t).to_vec(), end: self.end, nudged: Vec::new() }
    }

    /// A quantity in one of its bins, counted in the direction that θ turned in.
    pub fn onward(&self, bin: &Bin, quantity: Quantity) -> Range {
        let range = bin.of(quantity);
        if self.end[2] < 0.0 {
            return Range { least: -range.most, most: -range.least, mean: -range.mean };
        }
        range
    }

    /// The part that lies before `t` [s].
    pub fn until(&self, t: f64) -> &[Bin] {
        let n = self.bins.iter().take_while(|bin| bin.begin_s + bin.length_s <= t).count();
        &self.bins[..n]
    }
}

/// The struts of `config` under `reading`, its blocks ending at 90°.
pub(super) fn under(config: &Config, reading: ReadingName) -> [Block; 2] {
    let mut config = config.clone();
    (config.reading, config.bays) = (reading, 1);
    config.run.stop_at_90 = true;
    struts(&config)
}

/// How long `block` is given to reach 90° [s].
pub(super) fn patience(block: &Block) -> f64 {
    time_to(block, RIGHT_ANGLE).map_or(0.0, |t| PATIENCE * t)
}

/// The run of `block` to 90°, beside those from starts moved by their last bit.
pub(super) fn course(
    reading: Option<ReadingName>,
    block: &Block,
    setting: &Setting,
    limits: Limits<'_>,
) -> Course {
    let from = |y0| followed(reading, block, setting, y0, limits);
    let (mut own, trajectory) = from(block.initial_state());
    let nudged = [Start::Up, Start::Down].map(|start| from(start.of(block)));
    let lost = nudged.iter().filter_map(|(_, other)| lost_at(block, &trajectory, other));
    own.run.horizon_s = lost.reduce(f64::min);
    own.nudged = nudged.into_iter().map(|(course, _)| course).collect();
    let beside = own.nudged.iter().find_map(|other| other.run.error.as_ref());
    let beside = beside.map(|error| format!("from a start moved by its last bit: {error}"));
    own.run.error = own.run.error.take().or(beside);

    let moved = |t: f64| {
        let apart = own.nudged.iter().map(|other| Some((other.run.reached_90_s? - t).abs()));
        apart.reduce(|a, b| Some(a?.max(b?)))?
    };
    own.run.moved_s = own.run.reached_90_s.and_then(moved);
    let horizon = own.run.horizon_s.unwrap_or(f64::INFINITY);
    own.run.force_before_horizon_n = largest_force(own.until(horizon));
    let force = own.run.force_n;
    let apart = own.nudged.iter().map(|other| (other.run.force_n - force).abs());
    own.run.force_moved_n = Some(apart.fold(0.0, f64::max));
    own
}

fn largest_force(bins: &[Bin]) -> f64 {
    bins.iter().map(|bin| bin.of(Quantity::Force).most).fold(0.0, f64::max)
}

/// The run of `block` from `y0`, and its samples; what other runs tell of it is still to be said.
fn followed(
    reading: Option<ReadingName>,
    block: &Block,
    setting: &Setting,
    y0: State<f64>,
    limits: Limits<'_>,
) -> (Course, BlockTrajectory) {
    let t_end = patience(block);
    let least = t_end / MOST_BINS;
    let samples = Trajectory::on(Grid::uniform(SAMPLE_S.max(least), t_end));
    let balance = EnergyBalance::new(block, Events::Located, &y0);
    let mut watch = limits.watch(Price::of_setting(setting));
    let mut record =
        ((Binning::new(block, BIN_S.max(least)), balance), (samples, Braked(&mut watch)));
    let run = block.integrate(setting, y0, t_end, &mut record);
    let ((binning, balance), (trajectory, _)) = record;

    let bins = binning.bins;
    let balance = balance.at(&run.mode, run.t, &run.y).unwrap_or_default();
    let turned = |bin: &Bin| {
        let theta = bin.of(Quantity::Theta);
        if block.torque < 0.0 { -theta.least } else { theta.most }
    };
    let furthest = bins.iter().max_by(|a, b| turned(a).total_cmp(&turned(b)));
    // A block has one site.
    let events = changes(block, &trajectory.events).concat();
    let separations = events.iter().filter(|event| event.t <= TRANSIENT_S && event.after == 0);
    let row = RunRow {
        reading,
        joint: block.joint,
        reached_90_s: run.stopped_at(),
        moved_s: None,
        horizon_s: None,
        end_s: run.t,
        theta_max_rad: furthest.map_or(0.0, turned),
        theta_max_at_s: furthest.map_or(0.0, Bin::middle_s),
        n_events: events.len(),
        separations: (run.t >= TRANSIENT_S || run.stopped_at().is_some())
            .then(|| separations.count()),
        force_before_horizon_n: largest_force(&bins),
        force_n: largest_force(&bins),
        force_moved_n: None,
        work_j: balance.work,
        fed_in_j: -balance.residual,
        error: failure(&run, watch.cut.map(|limit| limits.told(limit))),
    };
    (Course { run: row, bins, end: run.y, nudged: Vec::new() }, trajectory)
}

/// Why a run ended before its time, if not by the limit that `cut` it.
fn failure(run: &OwnRun<Block>, cut: Option<String>) -> Option<String> {
    match &run.outcome {
        Ok(_) => cut,
        Err(error) => Some(error.to_string()),
    }
}

/// The first sample time at which two runs differ by more than [`HORIZON_ERROR`](deltazero_study::reference::HORIZON_ERROR) [s].
fn lost_at(block: &Block, one: &BlockTrajectory, other: &BlockTrajectory) -> Option<f64> {
    let end = |run: &BlockTrajectory| run.samples.last().map_or(0.0, |sample| sample.t);
    let [one, other] = [one, other].map(|run| Trace::of(block, run, end(run)));
    let (part, mut largest) =
        (deltazero_study::Part::from(Part::Block(block.clone())), Largest::default());
    part.measure(&one.states, &mut largest);
    parted_at(&one, &other, &part.error_scale(&largest))
}

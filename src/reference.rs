//! What errors are measured against: the tightest run, checked by a second method.

use deltazero_solvers::{Grid, Method, Outcome, Trajectory};
use serde::{Deserialize, Serialize};

use crate::config::Events;
use crate::metrics::{ErrorScale, sample_error, worse};
use crate::model::{Block, Mechanism, State};
use crate::run::{
    Accuracy, BlockRun, BlockTrajectory, Limits, ModeChange, Setting, integrate, mode_changes,
};

/// Tolerance of the reference run: the tightest at which rounding does not yet show.
const RTOL: f64 = 1e-13;
/// The second method takes this many steps for each of the reference run.
const CHECK_STEPS: u64 = 2;
/// A last-bit change of the start that grows beyond this `e` ends the horizon.
pub const HORIZON_ERROR: f64 = 1e-9;

/// Why there is no reference.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReferenceError {
    /// A run of it failed.
    #[error("no reference: {method} stopped on joint {joint} at t = {t} s in {mode}: {error}")]
    Failed {
        /// The method.
        method: &'static str,
        /// The joint.
        joint: usize,
        /// Time of the last accepted step [s].
        t: f64,
        /// Mode there.
        mode: String,
        /// Why.
        error: deltazero_solvers::Error,
    },
    /// It was interrupted, or cost more than the limit of work.
    #[error(
        "no reference: it needs more than study.max_rhs = {max_rhs} right-hand sides, or was interrupted; shorten run.t_end or raise the limit"
    )]
    BrokenOff {
        /// The limit.
        max_rhs: u64,
    },
    /// A method that it is built on is not in the list of methods.
    #[error("no reference: there is no method {0}")]
    NoMethod(&'static str),
}

/// The reference of one block.
#[derive(Clone, Debug)]
pub struct BlockReference {
    /// Number of the joint.
    pub joint: usize,
    /// States on the grid.
    pub samples: Vec<State<f64>>,
    /// Times of the samples [s].
    pub times: Vec<f64>,
    /// Mode changes; the first one may be the start's own, see [`counted`].
    pub events: Vec<ModeChange>,
    /// First sample time at which a last-bit change of the start exceeds [`HORIZON_ERROR`] [s];
    /// infinite where none does.
    pub lost_at: f64,
    /// The end of the run [s].
    pub t_end: f64,
    /// Scales of its errors.
    pub scale: ErrorScale,
}

/// The reference of a mechanism.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Block by block.
    pub blocks: Vec<BlockReference>,
    /// How it was made, and how good it is.
    pub summary: ReferenceSummary,
}

/// How a reference was made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceSummary {
    /// The method and setting of the reference run.
    pub method: String,
    /// The method and setting of the check.
    pub check: String,
    /// Largest `e` between both, within the horizon: the reference is at least this good.
    pub agreement: f64,
    /// Largest difference of their event times [s]; none where their sequences differ.
    pub event_time_agreement_s: Option<f64>,
    /// Largest |θ| over samples and joints, the scale of θ in `e` [rad].
    pub theta_scale_rad: f64,
    /// Horizon of each joint [s].
    pub horizon_s: Vec<f64>,
}

/// The events of a joint that count: all but the one at the start on the surface, where the pin
/// leaves it as δ ≈ a t⁴ and the time has no digits.
pub fn counted(events: &[ModeChange], block: &Block) -> Vec<ModeChange> {
    let starts_on_surface = block.clearance > 0.0;
    events[usize::from(starts_on_surface && !events.is_empty())..].to_vec()
}

impl Reference {
    /// Makes the reference of `mechanism` on the sample times `times` up to `t_end`: `rk45` located
    /// at rtol 1e-13, the same from a start changed in its last bit, and `rk4` located with twice
    /// its number of steps.
    ///
    /// # Errors
    /// [`ReferenceError`].
    pub fn new(
        mechanism: &Mechanism,
        t_end: f64,
        times: &[f64],
        limits: Limits<'_>,
    ) -> Result<Self, ReferenceError> {
        let method = |name| Method::named(name).ok_or(ReferenceError::NoMethod(name));
        let (tight, second) = (method("rk45")?, method("rk4")?);
        let grid = Grid::Times(times.to_vec());
        let located = |method, accuracy| Setting { method, events: Events::Located, accuracy };
        let tight = located(tight, Accuracy::Rtol(RTOL, None));
        let run = |block: &Block, y0, setting: Setting| {
            let mut record = (Trajectory::on(grid.clone()), limits);
            let run = integrate(block, &setting, y0, t_end, &mut record);
            checked(&run, setting.method.name, limits.max_rhs)?;
            Ok((run, record.0))
        };
        let mut runs = Vec::new();
        for block in &mechanism.blocks {
            let y0 = block.initial_state();
            let (reference, trajectory) = run(block, y0, tight)?;
            let nudge = |y: f64| if y == 0.0 { y } else { y.next_up() };
            let (_, nudged) = run(block, y0.map(nudge), tight)?;
            let steps = (CHECK_STEPS * reference.stats.n_accepted) as f64;
            let check = located(second, Accuracy::Step(reference.t / steps));
            let (_, check) = run(block, y0, check)?;
            runs.push((reference, trajectory, nudged, check));
        }
        let theta = runs
            .iter()
            .flat_map(|(_, trajectory, ..)| &trajectory.samples)
            .fold(f64::MIN_POSITIVE, |largest, sample| largest.max(sample.y[2].abs()));
        let mut agreement = 0.0_f64;
        let mut event_agreement = Some(0.0_f64);
        let mut blocks = Vec::new();
        for (block, (run, trajectory, nudged, check)) in mechanism.blocks.iter().zip(&runs) {
            let reference = block_reference(block, run, trajectory, nudged, theta);
            agreement = worse(agreement, reference.error(check));
            let times = reference.matched(block, check);
            let whole = times.missed == 0 && times.spurious == 0;
            event_agreement =
                event_agreement.filter(|_| whole).map(|worst| worst.max(times.time_error));
            blocks.push(reference);
        }
        let summary = ReferenceSummary {
            method: tight.to_string(),
            check: format!("rk4 located, {CHECK_STEPS} times as many steps"),
            agreement,
            event_time_agreement_s: event_agreement,
            theta_scale_rad: theta,
            horizon_s: blocks.iter().map(BlockReference::horizon).collect(),
        };
        Ok(Self { blocks, summary })
    }

    /// The shortest horizon of its blocks [s].
    pub fn horizon(&self) -> f64 {
        self.blocks.iter().fold(f64::INFINITY, |least, block| least.min(block.horizon()))
    }
}

fn checked(run: &BlockRun, method: &'static str, max_rhs: u64) -> Result<(), ReferenceError> {
    match &run.outcome {
        Err(error) => Err(ReferenceError::Failed {
            method,
            joint: run.joint,
            t: run.t,
            mode: run.mode.to_string(),
            error: error.clone(),
        }),
        Ok(Outcome::Interrupted) => Err(ReferenceError::BrokenOff { max_rhs }),
        Ok(_) => Ok(()),
    }
}

fn block_reference(
    block: &Block,
    run: &BlockRun,
    trajectory: &BlockTrajectory,
    nudged: &BlockTrajectory,
    theta: f64,
) -> BlockReference {
    let clearance = if block.clearance > 0.0 { block.clearance } else { 1e-4 };
    let scale = ErrorScale { clearance, theta };
    let pairs = trajectory.samples.iter().zip(&nudged.samples);
    let lost_at = pairs
        .filter(|(a, b)| sample_error(&b.y, &a.y, scale).total_cmp(&HORIZON_ERROR).is_gt())
        .map(|(a, _)| a.t)
        .next()
        .unwrap_or(f64::INFINITY);
    BlockReference {
        joint: block.joint,
        samples: trajectory.samples.iter().map(|sample| sample.y).collect(),
        times: trajectory.samples.iter().map(|sample| sample.t).collect(),
        events: mode_changes(trajectory),
        lost_at,
        t_end: run.t,
        scale,
    }
}

impl BlockReference {
    /// The time up to which the run is predictable: where it is lost, or its end [s].
    pub fn horizon(&self) -> f64 {
        self.lost_at.min(self.t_end)
    }

    /// Largest `e` of a run's samples, on the same times, within the horizon.
    pub fn error(&self, run: &BlockTrajectory) -> f64 {
        let pairs = self.times.iter().zip(&self.samples).zip(&run.samples);
        let within = pairs.filter(|((t, _), _)| **t < self.lost_at);
        let errors = within.map(|((_, y), sample)| sample_error(&sample.y, y, self.scale));
        errors.fold(0.0, worse)
    }

    /// A run's events against its own, within the horizon.
    pub fn matched(&self, block: &Block, run: &BlockTrajectory) -> crate::metrics::EventMatch {
        let within = |events: Vec<ModeChange>| -> Vec<ModeChange> {
            events.into_iter().filter(|event| event.t < self.lost_at).collect()
        };
        let run = within(counted(&mode_changes(run), block));
        crate::metrics::match_events(&run, &within(counted(&self.events, block)))
    }
}

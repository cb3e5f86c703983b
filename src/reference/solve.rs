//! The runs that a reference is made of: one, another that tells its error, and one from a start changed in
//! its last bit.

use std::ops::ControlFlow;

use deltazero_solvers::taylor::MAX_ORDER;
use deltazero_solvers::{
    Accepted, Event, Grid, Method, Needs, Next, Outcome, Record, Trajectory, Vector as _,
};
use num_dual::Dual64;

use super::{ReferenceError, counted};
use crate::config::Events;
use crate::energy_balance::{Balance, EnergyBalance};
use crate::metrics::contacts::{Contact, Contacts};
use crate::metrics::dense::{Node, Nodes};
use crate::metrics::{ErrorScale, match_events, sample_error, worse};
use crate::model::{Block, Jointed};
use crate::run::{
    Accuracy, BlockTrajectory, Integrable, JointsRun, Limit, Limits, ModeChange, OwnRun, Price,
    Setting, integrate, trajectories,
};
use crate::warning::Warning;

/// Changes with whatever changes results: what is kept on disk of a reference, a study or a map that is not
/// finished is then made anew.
pub const RECIPE: u32 = 6;

/// Method and tolerance of the reference, and those of the run that tells its error.
type Pair = [(&'static str, f64); 2];

/// In the order in which they are tried.
///
/// Taylor series of order 23 and 25 are at rounding: on Table 1 the former agrees with extended precision to
/// `e = 2.2e-14`, and they differ by 2.9e-14. An explicit series is out of reach where damping is so strong that
/// stability bounds its steps (K = 1e9 N/m, ζ = 10 takes 5e5 series): `radau5` is then right to 1e-11 with
/// a tenth of the time, and `rodas5p` has the events right where two tolerances of `radau5` differ in them.
/// `vern98` and `dop853` are for what none of these can do.
const PAIRS: [Pair; 4] = [
    [("taylor", 1e-14), ("taylor", 1e-15)],
    [("radau5", 1e-14), ("radau5", 1e-13)],
    [("rodas5p", 1e-13), ("radau5", 1e-14)],
    [("vern98", 1e-13), ("dop853", 1e-14)],
];

/// The settings of a reference in f64, in the order in which they are tried.
pub(crate) fn settings() -> impl Iterator<Item = Setting> {
    PAIRS.into_iter().filter_map(|[(name, rtol), _]| {
        let (method, accuracy) = (Method::named(name)?, Accuracy::Rtol(rtol, None));
        Some(Setting { method, events: Events::Located, accuracy })
    })
}

/// Relative tolerances in extended precision, where a run on Table 1 changes by 3e-16 of the clearance.
const EXTENDED_RTOL: [f64; 2] = [1e-18, 1e-20];

/// Runs that differ by more than this in `e` let the next pair try.
const AGREED: f64 = 1e-8;

/// A last-bit change of the start that grows beyond this `e` ends the horizon.
pub const HORIZON_ERROR: f64 = 1e-9;

/// The first sample time at which two runs of a joint differ by more than [`HORIZON_ERROR`] [s].
pub(crate) fn parted_at(
    own: &BlockTrajectory,
    other: &BlockTrajectory,
    scale: ErrorScale,
) -> Option<f64> {
    let is_lost = |a, b| sample_error(b, a, scale).total_cmp(&HORIZON_ERROR).is_gt();
    let mut pairs = own.samples.iter().zip(&other.samples);
    pairs.find(|(a, b)| is_lost(&a.y, &b.y)).map(|(a, _)| a.t)
}

/// One run of a part, and what a reference keeps of it.
#[derive(Clone, Debug)]
pub(super) struct Path {
    pub(super) run: JointsRun,
    pub(super) joints: Vec<JointPath>,
    pub(super) balance: Balance,
    /// What it tells of itself.
    pub(super) warnings: Vec<Warning>,
}

/// What it keeps of one joint.
#[derive(Clone, Debug)]
pub(super) struct JointPath {
    pub(super) trajectory: BlockTrajectory,
    /// Mode changes, at the roots of their guards.
    pub(super) events: Vec<ModeChange>,
    pub(super) nodes: Vec<Node>,
    pub(super) contacts: Vec<Contact>,
}

/// What the reference of a part is made of.
#[derive(Clone, Debug)]
pub(super) struct Solved {
    /// Method and setting of the reference.
    pub(super) method: String,
    /// Method and setting of the run that tells its error.
    pub(super) check_method: String,
    pub(super) path: Path,
    pub(super) check: Path,
    /// The samples of a run like `path` from a start changed in its last bit, of each joint.
    pub(super) nudged: Vec<BlockTrajectory>,
}

impl Solved {
    /// The first sample time at which a last-bit change of the start exceeds [`HORIZON_ERROR`] in any joint
    /// [s]; infinite where none does.
    pub(super) fn lost_at(&self, scale: ErrorScale) -> f64 {
        let joints = self.path.joints.iter().zip(&self.nudged);
        let lost = joints.filter_map(|(own, nudged)| parted_at(&own.trajectory, nudged, scale));
        lost.fold(f64::INFINITY, f64::min)
    }

    /// Largest `e` between both runs before `lost_at`, and the largest difference of their event times
    /// [s]; none where their events differ.
    pub(super) fn disagreement(
        &self,
        block: &Block,
        scale: ErrorScale,
        lost_at: f64,
    ) -> (f64, Option<f64>) {
        let (mut largest, mut latest) = (0.0, Some(0.0_f64));
        for (own, check) in self.path.joints.iter().zip(&self.check.joints) {
            let pairs = own.trajectory.samples.iter().zip(&check.trajectory.samples);
            let errors = pairs.filter(|(a, _)| a.t < lost_at);
            largest = errors.map(|(a, b)| sample_error(&b.y, &a.y, scale)).fold(largest, worse);
            let events = |path: &JointPath| -> Vec<ModeChange> {
                let events = counted(&path.events, block).into_iter();
                events.filter(|event| event.t < lost_at).collect()
            };
            let times = match_events(&events(check), &events(own), scale);
            let is_whole = times.missed == 0 && times.spurious == 0;
            latest = latest.filter(|_| is_whole).map(|most| most.max(times.time_error));
        }
        (largest, latest)
    }
}

/// The reference of `part` in f64: the first of [`PAIRS`] whose runs come to their end and agree; else
/// the one that agrees best.
///
/// # Errors
/// That of the last pair, where none came to its end.
pub(super) fn solve<P: Integrable>(
    part: &P,
    t_end: f64,
    times: &[f64],
    limits: Limits<'_>,
) -> Result<Solved, ReferenceError> {
    let mut best: Option<(f64, Solved)> = None;
    let mut failure = None;
    for pair in PAIRS {
        match solve_by(pair, part, t_end, times, limits) {
            Err(ReferenceError::Interrupted) => return Err(ReferenceError::Interrupted),
            Err(error) => failure = Some(error),
            Ok(solved) => {
                let theta = solved.path.largest_angle();
                let scale = ErrorScale::of(part.block(), theta);
                let (e, times) = solved.disagreement(part.block(), scale, solved.lost_at(scale));
                if e <= AGREED && times.is_some() && solved.path.is_sound() {
                    return Ok(solved);
                }
                if best.as_ref().is_none_or(|(least, _)| e < *least) {
                    best = Some((e, solved));
                }
            }
        }
    }
    match (best, failure) {
        (Some((_, solved)), _) => Ok(solved),
        (None, Some(error)) => Err(error),
        (None, None) => Err(ReferenceError::Interrupted),
    }
}

fn solve_by<P: Integrable>(
    pair: Pair,
    part: &P,
    t_end: f64,
    times: &[f64],
    limits: Limits<'_>,
) -> Result<Solved, ReferenceError> {
    let setting = |(name, rtol)| {
        let method = Method::named(name).ok_or(ReferenceError::NoMethod(name))?;
        let accuracy = Accuracy::Rtol(rtol, None);
        Ok(Maker::Method(Setting { method, events: Events::Located, accuracy }))
    };
    let [own, other] = pair.map(setting);
    solve_with([own?, other?], part, t_end, times, limits)
}

/// The reference of `part` in extended precision.
///
/// # Errors
/// [`ReferenceError`].
pub(super) fn solve_extended<P: Integrable>(
    part: &P,
    t_end: f64,
    times: &[f64],
    limits: Limits<'_>,
) -> Result<Solved, ReferenceError> {
    solve_with(EXTENDED_RTOL.map(Maker::Extended), part, t_end, times, limits)
}

fn solve_with<P: Integrable>(
    [own, other]: [Maker; 2],
    part: &P,
    t_end: f64,
    times: &[f64],
    limits: Limits<'_>,
) -> Result<Solved, ReferenceError> {
    let y0 = part.start();
    // First the one that may cost more: too much of it, and the others are spared.
    let check = path(part, &other, y0.clone(), t_end, times, limits)?;
    let own_path = path(part, &own, y0, t_end, times, limits)?;
    let nudged = path(part, &own, part.start_nudged(f64::next_up), t_end, times, limits)?;
    Ok(Solved {
        method: own.described(),
        check_method: other.described(),
        path: own_path,
        check,
        nudged: nudged.joints.into_iter().map(|joint| joint.trajectory).collect(),
    })
}

/// What makes a run of a reference.
enum Maker {
    /// A method at a setting, in f64.
    Method(Setting),
    /// Taylor series in extended precision, at this relative tolerance.
    Extended(f64),
}

impl Maker {
    fn name(&self) -> &'static str {
        match self {
            Self::Method(setting) => setting.method.name,
            Self::Extended(_) => "extended taylor",
        }
    }

    /// Its relative tolerance; the members of a pair all have one.
    fn rtol(&self) -> f64 {
        match self {
            Self::Method(setting) => setting.rtol().unwrap_or(f64::INFINITY),
            Self::Extended(rtol) => *rtol,
        }
    }

    /// Order of its series, where it has one.
    fn series_order(&self) -> Option<usize> {
        match self {
            Self::Method(setting) => setting.method.series_order(setting.rtol()),
            Self::Extended(_) => Some(MAX_ORDER),
        }
    }

    fn described(&self) -> String {
        let text = match self {
            Self::Method(setting) => setting.to_string(),
            Self::Extended(rtol) => format!("{} located, rtol {rtol:e}", self.name()),
        };
        self.series_order().map_or(text.clone(), |order| format!("{text} (order {order})"))
    }

    /// What its work is worth: a series of order N counts as N²/2 right-hand sides. That is several times its cost;
    /// where series are so many, an implicit method is faster.
    fn price(&self) -> Price {
        let of_series = |order: usize| Price::of_series((order * order / 2) as f64);
        self.series_order().map_or(Price::PLAIN, of_series)
    }

    fn run<P: Integrable>(
        &self,
        part: &P,
        y0: P::State<f64>,
        t_end: f64,
        record: &mut dyn Record<P>,
    ) -> OwnRun<P> {
        match self {
            Self::Method(setting) => integrate(part, setting, y0, t_end, record),
            Self::Extended(rtol) => part.integrate_extended(*rtol, y0, t_end, record),
        }
    }
}

fn path<P: Integrable>(
    part: &P,
    maker: &Maker,
    y0: P::State<f64>,
    t_end: f64,
    times: &[f64],
    limits: Limits<'_>,
) -> Result<Path, ReferenceError> {
    let trajectory = Trajectory::on(Grid::Times(times.to_vec()));
    let contacts = Contacts::new(part, Events::Located);
    let balance = EnergyBalance::new(part, Events::Located, &y0);
    let roots = Roots::new(part, maker);
    let mut record = (
        ((trajectory, limits.watch(maker.price())), roots),
        (Nodes::new(part), (contacts, balance)),
    );
    let run = maker.run(part, y0, t_end, &mut record);
    let (((trajectory, watch), roots), (nodes, (contacts, balance))) = record;
    match &run.outcome {
        Err(error) => Err(ReferenceError::Failed {
            method: maker.name(),
            joint: run.joint,
            t: run.t,
            mode: format!("{:?}", run.mode),
            error: error.clone(),
        }),
        Ok(Outcome::Interrupted) if limits.is_stopped() => Err(ReferenceError::Interrupted),
        Ok(Outcome::Interrupted) => Err(match watch.cut {
            Some(Limit::Time) => ReferenceError::TooMuchTime { max_seconds: limits.max_seconds },
            _ => ReferenceError::TooMuchWork { max_rhs: limits.max_rhs },
        }),
        Ok(_) => {
            let kept = roots.changes.into_iter().zip(nodes.lists).zip(contacts.lists());
            let joints = trajectories(part, &trajectory).into_iter().zip(kept);
            let joint = |(trajectory, ((events, nodes), contacts))| JointPath {
                trajectory,
                events,
                nodes,
                contacts,
            };
            Ok(Path {
                warnings: balance.check.warnings(Some(maker.rtol())),
                balance: balance.at(run.mode.clone(), &run.y),
                joints: joints.map(joint).collect(),
                run: run.by_joint(part),
            })
        }
    }
}

impl Path {
    /// Whether nothing that it tells of itself makes it wrong.
    fn is_sound(&self) -> bool {
        !self.warnings.iter().any(|warning| warning.code.is_of_a_wrong_run())
    }

    /// Largest |θ| of the samples [rad].
    pub(super) fn largest_angle(&self) -> f64 {
        let samples = self.joints.iter().flat_map(|joint| &joint.trajectory.samples);
        let angles = samples.map(|sample| sample.y[2].abs());
        angles.fold(f64::MIN_POSITIVE, f64::max)
    }
}

/// A recorder of mode changes at the roots of their guards.
///
/// A run lands past the surface, by half the guard's rounding bound: where a guard falls slowly, as that of
/// sticking does, that is late by picoseconds. One step of Newton's iteration goes back to the root.
struct Roots<'a, P> {
    part: &'a P,
    /// Of each joint.
    changes: Vec<Vec<ModeChange>>,
    /// Whether runs land on the root itself.
    is_exact: bool,
    /// By how much the last step landed late [s].
    late: f64,
}

impl<'a, P: Jointed> Roots<'a, P> {
    fn new(part: &'a P, maker: &Maker) -> Self {
        let is_exact = matches!(maker, Maker::Extended(_));
        Self { part, changes: vec![Vec::new(); part.n_joints()], is_exact, late: 0.0 }
    }
}

impl<P: Jointed> Record<P> for Roots<'_, P> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        let guard = match accepted.landed_on {
            Some(guard) if !self.is_exact => guard,
            _ => return ControlFlow::Continue(()),
        };
        let step = accepted.step;
        let (y, slope) = (step.y1().as_ref(), step.slope1().as_ref());
        let along = P::State::from_fn(y.len(), |i| Dual64::new(y[i], slope[i]));
        let mut guards = P::Guards::from_fn(self.part.n_guards(), |_| Dual64::new(0.0, 0.0));
        let t = Dual64::new(step.t1(), 1.0);
        self.part.guards(accepted.mode.clone(), t, &along, &mut guards);
        let guard = guards.as_ref()[guard];
        let late = guard.re / guard.eps;
        self.late = if late.abs() <= step.t1() - step.t0() { late } else { 0.0 };
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        let k = P::joint_of_guard(event.guard);
        if let Next::Mode(after) = &event.after {
            let [before, after] = [&event.before, after].map(|mode| P::joint_mode(mode, k).code());
            if before != after {
                self.changes[k].push(ModeChange { t: event.t - self.late, before, after });
            }
        }
        ControlFlow::Continue(())
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Ends
    }
}

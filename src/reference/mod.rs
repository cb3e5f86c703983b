//! What errors are measured against: the best run that serves, told its own error by a second one.
//!
//! In f64 both are Taylor series at two high orders, or what comes next where those are out of reach.

mod solve;

use deltazero_solvers::Sample;
use serde::{Deserialize, Serialize};

use crate::energy_balance::Balance;
use crate::json_number;
use crate::metrics::contacts::{Contact, total_impulse};
use crate::metrics::dense::Node;
use crate::metrics::{ErrorScale, EventMatch, match_events, sample_error, worse};
use crate::model::{Block, Mechanism, Part, State};
use crate::run::{BlockTrajectory, Limits, ModeChange, mode_changes};
use crate::warning::Warning;

pub(crate) use solve::parted_at;
pub(crate) use solve::settings;
pub use solve::{HORIZON_ERROR, RECIPE};
use solve::{JointPath, Path, Solved, solve, solve_extended};

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
    /// It cost more than the limit of work.
    #[error(
        "no reference: it needs more than study.max_rhs = {max_rhs} right-hand sides; shorten run.t_end or raise the limit"
    )]
    TooMuchWork {
        /// The limit.
        max_rhs: u64,
    },
    /// It took longer than the limit of time.
    #[error(
        "no reference: it takes longer than study.max_seconds = {max_seconds} s; shorten run.t_end or raise the limit"
    )]
    TooMuchTime {
        /// The limit [s].
        max_seconds: f64,
    },
    /// It was interrupted.
    #[error("no reference: interrupted")]
    Interrupted,
    /// A method that it is built on is not in the list of methods.
    #[error("no reference: there is no method {0}")]
    NoMethod(&'static str),
}

/// The reference of one joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointReference {
    /// Its bay, from 1.
    pub bay: usize,
    /// Number of the joint.
    pub joint: usize,
    /// States on the grid.
    pub samples: Vec<State<f64>>,
    /// Times of the samples [s].
    pub times: Vec<f64>,
    /// Mode changes at the roots of their guards; the first one may be the start's own, see [`counted`].
    pub events: Vec<ModeChange>,
    /// First sample time at which a last-bit change of the start exceeds [`HORIZON_ERROR`] in any joint of its
    /// part [s]; infinite where none does.
    #[serde(with = "finite_or_none")]
    pub lost_at: f64,
    /// The end of the run [s].
    pub t_end: f64,
    /// State there.
    pub y_end: State<f64>,
    /// Scales of its errors.
    pub scale: ErrorScale,
    /// Largest magnitude of each state over the nodes.
    pub amplitude: State<f64>,
    /// States between the samples.
    pub nodes: Vec<Node>,
    /// Contacts.
    pub contacts: Vec<Contact>,
}

/// JSON has no infinity.
mod finite_or_none {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<S: Serializer>(x: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        x.is_finite().then_some(*x).serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(from)?.unwrap_or(f64::INFINITY))
    }
}

/// The reference of a mechanism.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Joint by joint, in the order of [`Mechanism::joints`].
    pub joints: Vec<JointReference>,
    /// How it was made, and how good it is.
    pub summary: ReferenceSummary,
}

/// How a reference was made, and how good it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceSummary {
    /// The method and setting of the reference run.
    pub method: String,
    /// The method and setting of the run that tells its error.
    pub check: String,
    /// Its error: the largest `e` between both, within the horizon.
    #[serde(with = "json_number::one")]
    pub agreement: f64,
    /// The error of its event times: the largest difference between both, within the horizon [s]; none
    /// where their sequences differ.
    #[serde(default, with = "json_number::maybe")]
    pub event_time_agreement_s: Option<f64>,
    /// Largest |θ| over samples and joints, the scale of θ in `e` [rad].
    pub theta_scale_rad: f64,
    /// The bay of each joint, from 1.
    #[serde(default)]
    pub bays: Vec<usize>,
    /// The number of each joint.
    #[serde(default)]
    pub joints: Vec<usize>,
    /// Horizon of each joint [s].
    pub horizon_s: Vec<f64>,
    /// End of each joint's run [s].
    #[serde(default)]
    pub t_end_s: Vec<f64>,
    /// Mode changes of each joint, the start's own left out.
    #[serde(default)]
    pub n_events: Vec<usize>,
    /// Impulse of the contacts of each joint [N s].
    #[serde(default)]
    pub impulse_n_s: Vec<f64>,
    /// Energy balance, all joints together.
    #[serde(default)]
    pub energy: Balance,
    /// What its runs tell of themselves.
    #[serde(default)]
    pub warnings: Vec<Warning>,
}

/// The events of a joint that count: all but the one of a start on the surface, where the pin
/// leaves it as δ ≈ a t⁴ and the time has no digits.
pub fn counted(events: &[ModeChange], block: &Block) -> Vec<ModeChange> {
    events[usize::from(block.starts_on_surface() && !events.is_empty())..].to_vec()
}

impl Reference {
    /// Makes the reference of `mechanism` on the sample times `times` up to `t_end`.
    ///
    /// Of each part a run by Taylor series at rtol 1e-14, one at 1e-15, which tells the error of the
    /// first, and one like the first from a start changed in its last bit, whose growth is the horizon. A
    /// part whose series cost more than `limits` allow (one of order N as N²/2 right-hand sides), fail, or
    /// differ by more than 1e-8 or in their events, goes to `radau5` at 1e-14 and 1e-13, then to `rodas5p`
    /// with `radau5`, then to `vern98` with `dop853`.
    ///
    /// # Errors
    /// [`ReferenceError`].
    pub fn new(
        mechanism: &Mechanism,
        t_end: f64,
        times: &[f64],
        limits: Limits<'_>,
    ) -> Result<Self, ReferenceError> {
        Self::by(mechanism, |part| match part {
            Part::Block(block) => solve(block, t_end, times, limits),
            Part::Chain(chain) => solve(chain, t_end, times, limits),
        })
    }

    /// The same with 31 digits: Taylor series of order 25 over pairs of f64, at rtol 1e-18, its error told by
    /// a run at 1e-20. It has no other method to go to where series are out of reach.
    ///
    /// # Errors
    /// [`ReferenceError`].
    pub fn extended(
        mechanism: &Mechanism,
        t_end: f64,
        times: &[f64],
        limits: Limits<'_>,
    ) -> Result<Self, ReferenceError> {
        Self::by(mechanism, |part| match part {
            Part::Block(block) => solve_extended(block, t_end, times, limits),
            Part::Chain(chain) => solve_extended(chain, t_end, times, limits),
        })
    }

    fn by(
        mechanism: &Mechanism,
        solve: impl FnMut(&Part) -> Result<Solved, ReferenceError>,
    ) -> Result<Self, ReferenceError> {
        let solved = mechanism.parts.iter().map(solve).collect::<Result<Vec<_>, _>>()?;
        Ok(Self::joined(mechanism, solved))
    }

    /// The reference that these runs of the parts of `mechanism` make, whatever they were computed in.
    fn joined(mechanism: &Mechanism, solved: Vec<Solved>) -> Self {
        let theta = solved.iter().map(|solved| solved.path.largest_angle()).fold(0.0, f64::max);
        let mut agreement = 0.0_f64;
        let mut event_agreement = Some(0.0_f64);
        let mut energy = Balance::default();
        let of_joints = |text: fn(&Solved) -> &String| joined_text(solved.iter().map(text));
        let (method, check) = (of_joints(|s| &s.method), of_joints(|s| &s.check_method));
        let (mut joints, mut warnings) = (Vec::new(), Vec::new());
        for (block, solved) in mechanism.blocks().into_iter().zip(solved) {
            let scale = ErrorScale::of(block, theta);
            let lost_at = solved.lost_at(scale);
            let (e, times) = solved.disagreement(block, scale, lost_at);
            agreement = worse(agreement, e);
            event_agreement = event_agreement.zip(times).map(|(a, b)| a.max(b));
            energy += solved.path.balance;
            warnings.extend_from_slice(&solved.path.warnings);
            joints.extend(JointReference::all(solved, scale, lost_at));
        }
        let events = mechanism.joints().into_iter().zip(&joints);
        let summary = ReferenceSummary {
            method,
            check,
            agreement,
            event_time_agreement_s: event_agreement,
            theta_scale_rad: theta,
            horizon_s: joints.iter().map(JointReference::horizon).collect(),
            t_end_s: joints.iter().map(|joint| joint.t_end).collect(),
            bays: joints.iter().map(|joint| joint.bay).collect(),
            joints: joints.iter().map(|joint| joint.joint).collect(),
            n_events: events.map(|((_, block), own)| counted(&own.events, block).len()).collect(),
            impulse_n_s: joints.iter().map(|joint| total_impulse(&joint.contacts)).collect(),
            energy,
            warnings,
        };
        Self { joints, summary }
    }

    /// Leaves of its samples, events, nodes and contacts those up to `t_end` [s], and measures angles by the
    /// largest that is left; states at the end, balances and the summary stay those of the whole.
    pub fn cut(&mut self, t_end: f64) {
        for joint in &mut self.joints {
            joint.cut(t_end);
        }
        let angles = self.joints.iter().flat_map(|joint| &joint.samples).map(|y| y[2].abs());
        let theta = angles.fold(0.0, f64::max);
        for joint in &mut self.joints {
            joint.scale.theta = theta;
        }
    }

    /// The shortest horizon of its joints [s].
    pub fn horizon(&self) -> f64 {
        self.joints.iter().fold(f64::INFINITY, |least, joint| least.min(joint.horizon()))
    }

    /// Those of each part of `mechanism`, in its order.
    pub fn of_parts<'a>(
        &'a self,
        mechanism: &'a Mechanism,
    ) -> impl Iterator<Item = (&'a Part, &'a [JointReference])> {
        let mut ahead = self.joints.as_slice();
        mechanism.parts.iter().map(move |part| {
            let (own, rest) = ahead.split_at(part.n_joints().min(ahead.len()));
            ahead = rest;
            (part, own)
        })
    }
}

/// What is said of the joints: once, where it is the same.
fn joined_text<'a>(mut of_joints: impl Iterator<Item = &'a String> + Clone) -> String {
    let all = of_joints.clone();
    match of_joints.next() {
        Some(first) if of_joints.all(|other| other == first) => first.clone(),
        _ => {
            let joints = (1..).zip(all);
            joints
                .map(|(joint, text)| format!("joint {joint}: {text}"))
                .collect::<Vec<_>>()
                .join("; ")
        }
    }
}

impl ReferenceSummary {
    /// Whether the reference is good enough to tell which runs reach an error `e`.
    pub fn can_decide(&self, e: f64) -> bool {
        self.unsound().is_none() && self.agreement <= 0.1 * e
    }

    /// The warning by which its runs are wrong, if they are.
    fn unsound(&self) -> Option<&Warning> {
        self.warnings.iter().find(|warning| warning.code.is_of_a_wrong_run())
    }

    /// Why it does not decide on some error, in words.
    pub fn undecided(&self) -> String {
        match self.unsound() {
            Some(warning) => {
                format!("the reference is wrong, by its own account: {}", warning.message)
            }
            None => format!("the reference is good to {:.1e}", self.agreement),
        }
    }

    /// Those of the `warnings` of another run that are its own: that it is wrong, or what the reference does not have,
    /// as what both have is the motion's.
    pub fn not_shared(&self, mut warnings: Vec<Warning>) -> Vec<Warning> {
        let is_shared =
            |warning: &Warning| self.warnings.iter().any(|own| own.code == warning.code);
        warnings.retain(|warning| warning.code.is_of_a_wrong_run() || !is_shared(warning));
        warnings
    }

    /// Number and bay of the joint at place `i`; a summary of one bay may have been written without them.
    fn joint(&self, i: usize) -> (usize, usize) {
        let own = self.joints.get(i).zip(self.bays.get(i));
        own.map_or((i + 1, 1), |(joint, bay)| (*joint, *bay))
    }

    /// The horizon of each joint [s], said once for all bays of a chain.
    pub fn horizons(&self) -> String {
        let of_root = self.horizon_s.iter().enumerate().filter(|(i, _)| self.joint(*i).1 == 1);
        of_root.map(|(_, t)| format!("{t}")).collect::<Vec<_>>().join(" and ")
    }

    /// What it cannot serve for, a sentence each.
    pub fn limits(&self) -> Vec<String> {
        let mut limits = Vec::new();
        limits.extend(self.warnings.iter().map(|warning| warning.message.clone()));
        if self.agreement > 1e-10 {
            let good = self.agreement;
            limits.push(format!(
                "the reference is good to e = {good:.1e}: it decides nothing below ten times that"
            ));
        }
        if self.event_time_agreement_s.is_none() {
            limits.push("its two runs differ in their events: missed, spurious and event times are doubtful".into());
        }
        for (i, (horizon, t_end)) in self.horizon_s.iter().zip(&self.t_end_s).enumerate() {
            // The joints of a chain have one horizon.
            if let (joint, 1) = self.joint(i)
                && horizon < t_end
            {
                limits.push(format!(
                    "joint {joint} is predictable up to {horizon} s of {t_end} s: beyond, only the number of events, impulse and dissipation are compared"
                ));
            }
        }
        limits
    }
}

impl JointReference {
    /// Those of the joints of a part.
    fn all(solved: Solved, scale: ErrorScale, lost_at: f64) -> Vec<Self> {
        let Path { run, joints, .. } = solved.path;
        let joint = |(k, own): (usize, JointPath)| {
            let mut amplitude = [0.0_f64; 6];
            for node in &own.nodes {
                for (largest, y) in amplitude.iter_mut().zip(node.y) {
                    *largest = largest.max(y.abs());
                }
            }
            let samples = own.trajectory.samples;
            Self {
                bay: k + 1,
                joint: run.joint,
                times: samples.iter().map(|Sample { t, .. }| *t).collect(),
                samples: samples.into_iter().map(|Sample { y, .. }| y).collect(),
                events: own.events,
                lost_at,
                t_end: run.t,
                y_end: run.y[k],
                scale,
                amplitude,
                nodes: own.nodes,
                contacts: own.contacts,
            }
        };
        joints.into_iter().enumerate().map(joint).collect()
    }

    fn cut(&mut self, t_end: f64) {
        let n = self.times.partition_point(|t| *t <= t_end);
        self.times.truncate(n);
        self.samples.truncate(n);
        self.events.retain(|event| event.t <= t_end);
        self.nodes.truncate(self.nodes.partition_point(|node| node.t <= t_end));
        self.contacts.retain(|contact| contact.end <= t_end);
    }

    /// Whether `t` lies within the horizon.
    pub fn is_within(&self, t: f64) -> bool {
        t < self.lost_at
    }

    /// The time up to which the run is predictable: where it is lost, or its end [s].
    pub fn horizon(&self) -> f64 {
        self.lost_at.min(self.t_end)
    }

    /// The nodes within the horizon.
    pub fn nodes_within(&self) -> &[Node] {
        &self.nodes[..self.nodes.partition_point(|node| self.is_within(node.t))]
    }

    /// Largest `e` of a run's samples, on the same times, within the horizon; infinite for a run that ends
    /// before them.
    pub fn error(&self, run: &BlockTrajectory) -> f64 {
        // A run that ends a sample early stopped at 90° beside the sample; one that ends earlier
        // still went astray.
        let n_within = self.times.iter().filter(|t| self.is_within(**t)).count();
        if run.samples.len() + 1 < n_within {
            return f64::INFINITY;
        }
        let pairs = self.times.iter().zip(&self.samples).zip(&run.samples);
        let within = pairs.filter(|((t, _), _)| self.is_within(**t));
        let errors = within.map(|((_, y), sample)| sample_error(&sample.y, y, self.scale));
        errors.fold(0.0, worse)
    }

    /// Error of the state at a run's end: the worst of the six, each relative to the largest
    /// magnitude that it takes; none where the end lies beyond the horizon.
    pub fn end_error(&self, y_end: &State<f64>) -> Option<f64> {
        let errors = (0..6).map(|i| match (y_end[i] - self.y_end[i]).abs() {
            0.0 => 0.0,
            error => error / self.amplitude[i],
        });
        (self.lost_at == f64::INFINITY).then(|| errors.fold(0.0, worse))
    }

    /// A run's events against its own, within the horizon.
    pub fn matched(&self, block: &Block, run: &BlockTrajectory) -> EventMatch {
        let within = |events: Vec<ModeChange>| -> Vec<ModeChange> {
            events.into_iter().filter(|event| self.is_within(event.t)).collect()
        };
        let run = within(counted(&mode_changes(run), block));
        match_events(&run, &within(counted(&self.events, block)), self.scale)
    }
}

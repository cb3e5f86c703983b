//! A run with all that is measured of it, apart from its time.

use deltazero_solvers::{Grid, Stats, Trajectory, WorkByKind};
use serde::{Deserialize, Serialize};

use crate::energy_balance::{Balance, EnergyBalance};
use crate::json_number;
use crate::metrics::contacts::{Contact, Contacts, contact_errors, total_impulse};
use crate::metrics::dense::Distance;
use crate::metrics::work::WorkByPhase;
use crate::metrics::worse;
use crate::model::{Mechanism, Part, State};
use crate::reference::{JointReference, Reference, counted};
use crate::run::{Integrable, Limits, Price, Run, Setting, integrate, mode_changes, trajectories};
use crate::warning::Warning;

/// Errors of a run beside `e`, the worst of all joints. Up to the horizon, but for those of impulse and
/// dissipation, which are of the whole run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Largest `e` on the dense output.
    #[serde(default, with = "json_number::maybe")]
    pub e_max: Option<f64>,
    /// `√(∫ e² dt / T)` over the dense output.
    #[serde(default, with = "json_number::maybe")]
    pub e_l2: Option<f64>,
    /// Worst of the states at the end, each relative to the largest magnitude that it takes.
    #[serde(default, with = "json_number::maybe")]
    pub e_final: Option<f64>,
    /// Worst error of the peak force of a contact, relative to the largest peak.
    #[serde(default, with = "json_number::maybe")]
    pub peak_force_error: Option<f64>,
    /// Worst error of the impulse of a contact, relative to the largest such impulse.
    #[serde(default, with = "json_number::maybe")]
    pub contact_impulse_error: Option<f64>,
    /// Error of the impulse of all contacts, relative to it.
    #[serde(default, with = "json_number::maybe")]
    pub impulse_error: Option<f64>,
    /// Error of the dissipated energy, relative to the work of the drive.
    #[serde(default, with = "json_number::maybe")]
    pub dissipation_error: Option<f64>,
    /// Residual of the run's own energy balance, relative to the work of the drive.
    #[serde(default, with = "json_number::maybe")]
    pub energy_residual: Option<f64>,
    /// Largest peak force [N].
    #[serde(default, with = "json_number::maybe")]
    pub peak_force_n: Option<f64>,
    /// Impulse of all contacts [N s].
    #[serde(default, with = "json_number::maybe")]
    pub impulse_n_s: Option<f64>,
    /// Dissipated energy [J].
    #[serde(default, with = "json_number::maybe")]
    pub dissipated_j: Option<f64>,
}

/// What the reference says of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compared {
    /// Error `e`.
    pub e: f64,
    /// Worst time error of the paired events [s], if there are any.
    pub event_time_error_s: Option<f64>,
    /// Mode changes, the start's own left out.
    pub n_events: usize,
    /// Events of the reference that it lacks.
    pub missed: usize,
    /// Events that the reference lacks.
    pub spurious: usize,
    /// All others.
    pub errors: Errors,
}

/// A run of a mechanism, seen by every recorder there is: none of its time is a cost of the method.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The run.
    pub run: Run,
    /// Where its work went.
    pub work: WorkByPhase,
    /// What was recorded of each joint.
    audits: Vec<Audit>,
    /// All parts together.
    balance: Balance,
    /// What the run tells of itself.
    pub warnings: Vec<Warning>,
}

/// What is recorded of one joint.
#[derive(Clone, Debug)]
struct Audit {
    /// `e_max` and `e_l2`.
    dense: (f64, f64),
    contacts: Vec<Contact>,
    /// State at its end.
    y_end: State<f64>,
}

impl Measured {
    /// Runs `setting` from the paper's start to `t_end`, as [`Run::new`] does.
    pub fn new(
        mechanism: &Mechanism,
        reference: &Reference,
        setting: &Setting,
        t_end: f64,
        grid: &Grid,
        limits: Limits<'_>,
    ) -> Self {
        let (mut left, price) = (limits, Price::of_setting(setting));
        let run = Run { parts: Vec::new(), trajectories: Vec::new(), cut: None };
        let (work, audits) = (WorkByPhase::default(), Vec::new());
        let mut all = Self { run, work, audits, balance: Balance::default(), warnings: Vec::new() };
        let mut kinds = Vec::new();
        for (part, joints) in reference.of_parts(mechanism) {
            kinds.extend(match part {
                Part::Block(block) => all.add(block, joints, setting, t_end, grid, left),
                Part::Chain(chain) => all.add(chain, joints, setting, t_end, grid, left),
            });
            left = all.run.parts.last().map_or(left, |run| left.after(run, price));
        }
        all.work = WorkByPhase::new(&kinds);
        all
    }

    /// Runs one part, whose joints have these references; its work by phase.
    fn add<P: Integrable>(
        &mut self,
        part: &P,
        joints: &[JointReference],
        setting: &Setting,
        t_end: f64,
        grid: &Grid,
        limits: Limits<'_>,
    ) -> Vec<(&'static str, Stats)> {
        let y0 = part.start();
        let trajectory = Trajectory::on(grid.clone());
        let of_joints = joints.iter().map(|joint| (joint.nodes_within(), joint.scale));
        let distance = Distance::new(part, of_joints);
        let contacts = Contacts::new(part, setting.events);
        let balance = EnergyBalance::new(part, setting.events, &y0);
        let kinds = WorkByKind::new(|mode: P::Mode| P::foremost(&mode).phase());
        let watch = limits.watch(Price::of_setting(setting));
        let mut record = ((trajectory, watch), ((distance, contacts), (balance, kinds)));
        let run = integrate(part, setting, y0, t_end, &mut record);
        let ((trajectory, watch), ((distance, contacts), (balance, kinds))) = record;
        self.run.cut = self.run.cut.or(watch.cut);
        self.warnings.extend(balance.check.warnings(setting.rtol()));
        self.balance += balance.at(run.mode.clone(), &run.y);
        let run = run.by_joint(part);
        let kept = distance.joints.iter().zip(contacts.lists()).zip(&run.y);
        self.audits.extend(kept.map(|((dense, contacts), y_end)| Audit {
            dense: (dense.largest, dense.l2()),
            contacts,
            y_end: *y_end,
        }));
        self.run.parts.push(run);
        self.run.trajectories.extend(trajectories(part, &trajectory));
        kinds.kinds
    }

    /// The run against the reference that it was measured with.
    pub fn compared(&self, mechanism: &Mechanism, reference: &Reference) -> Compared {
        let mut all = Compared {
            e: 0.0,
            event_time_error_s: None,
            n_events: 0,
            missed: 0,
            spurious: 0,
            errors: Errors::default(),
        };
        let errors = &mut all.errors;
        let joints = mechanism.joints().into_iter().zip(&reference.joints);
        let runs = self.run.trajectories.iter().zip(&self.audits);
        for (((_, block), reference), (trajectory, audit)) in joints.zip(runs) {
            let e = reference.error(trajectory);
            all.e = worse(all.e, e);
            let events = reference.matched(block, trajectory);
            all.n_events += counted(&mode_changes(trajectory), block).len();
            all.missed += events.missed;
            all.spurious += events.spurious;
            if events.paired > 0 {
                all.event_time_error_s = worst(all.event_time_error_s, Some(events.time_error));
            }
            let (largest, l2) = audit.dense;
            errors.e_max = worst(errors.e_max, Some(worse(e, largest)));
            errors.e_l2 = worst(errors.e_l2, Some(l2));
            errors.e_final = worst(errors.e_final, reference.end_error(&audit.y_end));
            audit.add_to(errors, reference);
        }
        let balance = self.balance;
        let energy = reference.summary.energy;
        let part = |joules: f64| (energy.work != 0.0).then(|| (joules / energy.work).abs());
        errors.dissipation_error = part(balance.dissipated - energy.dissipated);
        errors.energy_residual = part(balance.residual);
        errors.dissipated_j = Some(balance.dissipated);
        all
    }
}

impl Audit {
    /// Enters what it says of the contacts.
    fn add_to(&self, errors: &mut Errors, reference: &JointReference) {
        let within = |contacts: &[Contact]| -> Vec<Contact> {
            contacts.iter().filter(|contact| reference.is_within(contact.end)).copied().collect()
        };
        let (own, exact) = (within(&self.contacts), within(&reference.contacts));
        if let Some(own) = contact_errors(&own, &exact, reference.scale) {
            errors.peak_force_error = worst(errors.peak_force_error, Some(own.peak));
            errors.contact_impulse_error = worst(errors.contact_impulse_error, Some(own.impulse));
        }
        let (own, exact) = (total_impulse(&self.contacts), total_impulse(&reference.contacts));
        if exact != 0.0 {
            let error = ((own - exact) / exact).abs();
            errors.impulse_error = worst(errors.impulse_error, Some(error));
        }
        *errors.impulse_n_s.get_or_insert_default() += own;
        let peak = self.contacts.iter().fold(0.0, |peak, contact| worse(peak, contact.peak));
        errors.peak_force_n = worst(errors.peak_force_n, Some(peak));
    }
}

/// The larger of two errors that may not be there.
fn worst(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(worse(a, b)),
        (a, b) => a.or(b),
    }
}

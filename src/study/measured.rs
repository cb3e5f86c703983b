//! A run with all that is measured of it, apart from its time.

use deltazero_solvers::{Grid, Stats, Trajectory, WorkByKind};
use serde::{Deserialize, Serialize};

use crate::energy_balance::{Balance, EnergyBalance};
use crate::metrics::contacts::{Contact, Contacts, contact_errors, total_impulse};
use crate::metrics::dense::Distance;
use crate::metrics::work::WorkByPhase;
use crate::metrics::worse;
use crate::model::{Mechanism, Mode};
use crate::reference::{BlockReference, Reference, counted};
use crate::run::{Limits, Run, Setting, integrate, mode_changes};

/// Errors of a run beside `e`, the worst of both joints. Up to the horizon, but for those of impulse and
/// dissipation, which are of the whole run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Largest `e` on the dense output.
    pub e_max: Option<f64>,
    /// `√(∫ e² dt / T)` over the dense output.
    pub e_l2: Option<f64>,
    /// Worst of the states at the end, each relative to the largest magnitude that it takes.
    pub e_final: Option<f64>,
    /// Worst error of the peak force of a contact, relative to the largest peak.
    pub peak_force_error: Option<f64>,
    /// Worst error of the impulse of a contact, relative to the largest such impulse.
    pub contact_impulse_error: Option<f64>,
    /// Error of the impulse of all contacts, relative to it.
    pub impulse_error: Option<f64>,
    /// Error of the dissipated energy, relative to the work of the drive.
    pub dissipation_error: Option<f64>,
    /// Residual of the run's own energy balance, relative to the work of the drive.
    pub energy_residual: Option<f64>,
    /// Largest peak force [N].
    pub peak_force_n: Option<f64>,
    /// Impulse of all contacts [N s].
    pub impulse_n_s: Option<f64>,
    /// Dissipated energy [J].
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

/// A run of both blocks, seen by every recorder there is: none of its time is a cost of the method.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The run.
    pub run: Run,
    /// Where its work went.
    pub work: WorkByPhase,
    /// What was recorded of each block.
    audits: Vec<Audit>,
}

#[derive(Clone, Debug)]
struct Audit {
    /// `e_max` and `e_l2`.
    dense: (f64, f64),
    contacts: Vec<Contact>,
    balance: Balance,
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
        let mut left = limits;
        let mut run = Run { blocks: Vec::new(), trajectories: Vec::new() };
        let (mut audits, mut work) = (Vec::new(), Vec::<(&'static str, Stats)>::new());
        for (block, reference) in mechanism.blocks.iter().zip(&reference.blocks) {
            let y0 = block.initial_state();
            let trajectory = Trajectory::on(grid.clone());
            let distance = Distance::new(reference.nodes_within(), reference.scale);
            let contacts = Contacts::new(block, setting.events);
            let balance = EnergyBalance::new(block, setting.events, &y0);
            let kinds = WorkByKind::new(Mode::phase);
            let mut record = ((trajectory, left), ((distance, contacts), (balance, kinds)));
            let own = integrate(block, setting, y0, t_end, &mut record);
            let ((trajectory, _), ((distance, contacts), (balance, kinds))) = record;
            left.max_rhs = left.max_rhs.saturating_sub(own.stats.work.n_rhs);
            work.extend(kinds.kinds);
            audits.push(Audit {
                dense: (distance.largest, distance.l2()),
                contacts: contacts.list,
                balance: balance.at(own.mode, &own.y),
            });
            run.blocks.push(own);
            run.trajectories.push(trajectory);
        }
        Self { run, work: WorkByPhase::new(&work), audits }
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
        let mut balance = Balance::default();
        let blocks = mechanism.blocks.iter().zip(&reference.blocks);
        let runs = self.run.blocks.iter().zip(&self.run.trajectories).zip(&self.audits);
        for ((block, reference), ((run, trajectory), audit)) in blocks.zip(runs) {
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
            errors.e_final = worst(errors.e_final, reference.end_error(&run.y));
            audit.add_to(errors, reference);
            balance += audit.balance;
        }
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
    fn add_to(&self, errors: &mut Errors, reference: &BlockReference) {
        let within = |contacts: &[Contact]| -> Vec<Contact> {
            contacts.iter().filter(|contact| reference.is_within(contact.end)).copied().collect()
        };
        if let Some(own) = contact_errors(&within(&self.contacts), &within(&reference.contacts)) {
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

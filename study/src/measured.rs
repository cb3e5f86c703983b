//! A run with all that is measured of it, apart from its time.

use deltazero_solvers::{Grid, Stats, Trajectory, WorkByKind};
use serde::{Deserialize, Serialize};

use crate::account::Account;
use crate::balance::Balance;
use crate::errors::contacts::{Contact, contact_errors, total_impulse};
use crate::errors::dense::Distance;
use crate::errors::work::WorkByPhase;
use crate::errors::{worse, worst};
use crate::json_number;
use crate::part::Subject;
use crate::problem::{Problem, leading_site};
use crate::reference::{Judged, PartReference, Reference};
use crate::run::{Brake, Braked, Limit, Limits, PartRun, Price, Setting, integrate};
use crate::trace::Trace;
use crate::warning::Warning;

/// Errors of a run beside `e`, the worst of all sites. Up to the horizon, but for those of impulse and
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
    /// Worst error of the speed at which a contact begins, relative to the largest such speed.
    #[serde(default, with = "json_number::maybe")]
    pub impact_speed_error: Option<f64>,
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
    /// Impulse of all contacts, impacts of no duration apart [N s].
    #[serde(default, with = "json_number::maybe")]
    pub impulse_n_s: Option<f64>,
    /// Dissipated energy [J].
    #[serde(default, with = "json_number::maybe")]
    pub dissipated_j: Option<f64>,
}

/// What the reference says of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compared {
    /// Its states and events.
    pub judged: Judged,
    /// Its events that the reference's are compared with.
    pub n_events: usize,
    /// All other errors.
    pub errors: Errors,
}

/// A run of a subject, seen by every recorder there is: none of its time is a cost of the method.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Part by part; those after one that was broken off ran too, within what the limits left.
    pub parts: Vec<MeasuredPart>,
    /// Where its work went.
    pub work: WorkByPhase,
    /// The limit that broke it off, if one did.
    pub cut: Option<Limit>,
    /// All parts together, where it is known.
    balance: Option<Balance>,
    /// What the run tells of itself.
    pub warnings: Vec<Warning>,
}

/// What is measured of a run of one part.
#[derive(Clone, Debug)]
pub struct MeasuredPart {
    /// How it ended.
    pub run: PartRun,
    trace: Trace,
    /// `e_max` and `e_l2` of each site.
    dense: Vec<(f64, f64)>,
    /// The contacts of each site, where they are known.
    contacts: Option<Vec<Vec<Contact>>>,
    balance: Option<Balance>,
    kinds: Vec<(&'static str, Stats)>,
    warnings: Vec<Warning>,
}

/// Runs `problem` from its start to `t_end`, seen by every recorder there is.
pub(crate) fn measure<P: Problem>(
    problem: &P,
    setting: &Setting,
    reference: &PartReference,
    t_end: f64,
    grid: &Grid,
    brake: &mut dyn Brake,
) -> MeasuredPart {
    let (y0, n_sites) = (problem.start(), problem.n_sites());
    let trajectory = Trajectory::on(grid.clone());
    let distance = Distance::new(n_sites, reference.nodes_within(), &reference.scale);
    let account = Account::new(problem, setting.method.order, setting.events, &y0);
    let phase = |mode: P::Mode| problem.role(&mode, leading_site(problem, &mode)).phase();
    let mut record = ((trajectory, Braked(brake)), ((distance, account), WorkByKind::new(phase)));
    let run = integrate(problem, setting, y0, t_end, &mut record);
    let ((trajectory, _), ((distance, Account { balance, contacts }), kinds)) = record;
    let dense = distance.sites.iter().zip(distance.l2());
    MeasuredPart {
        trace: Trace::of(problem, &trajectory, run.t),
        dense: dense.map(|(site, l2)| (site.largest, l2)).collect(),
        contacts: contacts.lists(),
        warnings: balance.check.warnings(setting.rtol()),
        balance: balance.at(&run.mode, run.t, &run.y),
        kinds: kinds.kinds,
        run: run.plain(),
    }
}

impl Measured {
    /// Runs `setting` from the start of `subject` to `t_end`, part by part.
    pub fn new(
        subject: &Subject,
        reference: &Reference,
        setting: &Setting,
        t_end: f64,
        grid: &Grid,
        limits: Limits<'_>,
    ) -> Self {
        let (mut left, price) = (limits, Price::of_setting(setting));
        let (mut parts, mut warnings) = (Vec::new(), Vec::new());
        let (mut kinds, mut balance, mut cut) = (Vec::new(), None::<Balance>, None);
        for (part, reference) in subject.parts.iter().zip(&reference.parts) {
            let mut watch = left.watch(price);
            let mut own = part.runs.measure(setting, reference, t_end, grid, &mut watch);
            cut = cut.or(watch.cut);
            left = left.after(&own.run, price);
            warnings.append(&mut own.warnings);
            kinds.append(&mut own.kinds);
            if let Some(own) = own.balance {
                *balance.get_or_insert_default() += own;
            }
            parts.push(own);
        }
        Self { parts, work: WorkByPhase::new(&kinds), cut, balance, warnings }
    }

    /// Work of all parts together.
    pub fn stats(&self) -> Stats {
        let mut sum = Stats::default();
        self.parts.iter().for_each(|part| sum += part.run.stats);
        sum
    }

    /// The run against the reference that it was measured with.
    pub fn compared(&self, reference: &Reference) -> Compared {
        let mut all = Compared { judged: Judged::NOTHING, n_events: 0, errors: Errors::default() };
        for (part, reference) in self.parts.iter().zip(&reference.parts) {
            part.compare(reference, &mut all);
        }
        if let Some((own, exact)) = self.balance.zip(reference.summary.energy) {
            let errors = &mut all.errors;
            let part = |joules: f64| (exact.work != 0.0).then(|| (joules / exact.work).abs());
            errors.dissipation_error = part(own.dissipated - exact.dissipated);
            errors.energy_residual = part(own.residual);
            errors.dissipated_j = Some(own.dissipated);
        }
        all
    }
}

impl MeasuredPart {
    /// Enters what its reference says of it.
    fn compare(&self, reference: &PartReference, all: &mut Compared) {
        let judged = reference.judge(&self.trace);
        all.judged = all.judged.with(judged);
        all.n_events += self.trace.changes.iter().map(Vec::len).sum::<usize>();
        let errors = &mut all.errors;
        for (largest, l2) in &self.dense {
            errors.e_max = worst(errors.e_max, Some(worse(judged.e, *largest)));
            errors.e_l2 = worst(errors.e_l2, Some(*l2));
        }
        errors.e_final =
            worst(errors.e_final, reference.end_error(&self.run.y, self.trace.jumps()));
        for (own, site) in self.contacts.iter().flatten().zip(&reference.sites) {
            if let Some(exact) = &site.contacts {
                compare_contacts(errors, own, exact, reference);
            }
        }
    }
}

/// Enters the errors of the contacts of a site. Where neither has one nothing is known: impacts of no duration have no force.
fn compare_contacts(
    errors: &mut Errors,
    all: &[Contact],
    exact_all: &[Contact],
    reference: &PartReference,
) {
    if all.is_empty() && exact_all.is_empty() {
        return;
    }
    let within = |contacts: &[Contact]| -> Vec<Contact> {
        contacts.iter().filter(|contact| reference.is_within(contact.end)).copied().collect()
    };
    let window = reference.scale.event_window;
    if let Some(own) = contact_errors(&within(all), &within(exact_all), window) {
        errors.peak_force_error = worst(errors.peak_force_error, Some(own.peak));
        errors.contact_impulse_error = worst(errors.contact_impulse_error, Some(own.impulse));
        errors.impact_speed_error = worst(errors.impact_speed_error, own.impact_speed);
    }
    let (own, exact) = (total_impulse(all), total_impulse(exact_all));
    if exact != 0.0 {
        let error = ((own - exact) / exact).abs();
        errors.impulse_error = worst(errors.impulse_error, Some(error));
    }
    *errors.impulse_n_s.get_or_insert_default() += own;
    let peak = all.iter().fold(0.0, |peak, contact| worse(peak, contact.peak));
    errors.peak_force_n = worst(errors.peak_force_n, Some(peak));
}

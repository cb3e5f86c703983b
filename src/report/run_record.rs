//! `run.json`: what was run, what became of it, at which cost.

use std::collections::BTreeMap;

use deltazero_solvers::{Outcome, Stats};
use deltazero_study::Part;
use deltazero_study::energy_balance::Balance;
use deltazero_study::errors::contact_summary::ContactSummary;
use deltazero_study::errors::work::WorkByPhase;
use deltazero_study::horizon::Horizon;
use deltazero_study::run::Setting;
use deltazero_study::simulation::Simulation;
use deltazero_study::warning::Warning;
use serde::{Serialize, Serializer};
use serde_json::Value;

/// A part of what is integrated, and its run.
pub struct Simulated<'a> {
    /// The part.
    pub part: &'a Part,
    /// Its run.
    pub own: Simulation,
    /// Why it was broken off, if by too many rows.
    pub too_long: Option<String>,
}

/// The record of a run.
#[derive(Debug, Serialize)]
pub struct RunRecord {
    /// The hash of command and configuration.
    pub hash: String,
    /// The configuration.
    pub config: Value,
    /// Of the program.
    pub version: &'static str,
    /// Time of the integration alone [s].
    pub wall_s: f64,
    /// Parts that were computed at once when it was timed.
    pub batch: usize,
    /// What to know before trusting it.
    pub warnings: Vec<Warning>,
    /// How far it is predictable: a time [s], null for a run that is to its end, `"not_measured"`.
    #[serde(serialize_with = "time_or_word")]
    pub horizon_s: Option<Horizon>,
    /// What became of its parts.
    #[serde(flatten)]
    pub parts: PartsRecord,
}

/// What became of the parts of a run, all together.
#[derive(Debug, Serialize)]
pub struct PartsRecord {
    /// Work and events.
    pub counts: Counts,
    /// Where the work went.
    pub work_by_phase: WorkByPhase,
    /// How it ended.
    pub outcome: &'static str,
    /// The first failure, where a part failed.
    pub error: Option<Failed>,
    /// Under `stopped_s`, or the name that the model has for its end: where and when parts came to it.
    #[serde(flatten)]
    pub ends: BTreeMap<String, Vec<Ended>>,
    /// Where the energy went, where the model tells of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy: Option<Balance>,
    /// The contacts of each site, where the model tells of any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contacts: Option<Vec<SiteContacts>>,
}

/// Work and events of a run.
#[derive(Debug, Serialize)]
pub struct Counts {
    /// Evaluations of the right-hand side of a part.
    pub n_rhs: u64,
    /// Accepted steps.
    pub n_accepted: u64,
    /// Of these, those by an implicit method.
    pub n_implicit: u64,
    /// Rejected steps.
    pub n_rejected: u64,
    /// Steps retaken to land on events.
    pub n_retaken: u64,
    /// Events that count.
    pub n_events: usize,
    /// Surfaces touched within the error of the method.
    pub n_grazing: u64,
    /// Jacobians.
    pub n_jac: u64,
    /// Factorisations of an iteration matrix.
    pub n_factorisations: u64,
    /// Linear systems solved.
    pub n_lin_solves: u64,
    /// Contacts that are reckoned with the least speed of impact.
    pub n_at_speed_floor: usize,
    /// Order of the series, of a method that has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub series_order: Option<usize>,
}

/// What tells a site apart: `joint`, `bay`; none of a part whose site is not known.
type Labels = BTreeMap<&'static str, Option<usize>>;

/// Why and where a part failed.
#[derive(Debug, Serialize)]
pub struct Failed {
    #[serde(flatten)]
    labels: Labels,
    /// When [s].
    pub t: f64,
    /// In which mode.
    pub mode: String,
    /// Why.
    pub message: String,
}

/// Where and when a part came to its end.
#[derive(Debug, Serialize)]
pub struct Ended {
    #[serde(flatten)]
    labels: Labels,
    /// When [s].
    pub t_s: f64,
}

/// The contacts of a site, in short.
#[derive(Debug, Serialize)]
pub struct SiteContacts {
    #[serde(flatten)]
    labels: Labels,
    /// The contacts.
    #[serde(flatten)]
    pub contacts: ContactSummary,
}

impl PartsRecord {
    /// Of runs at `setting`.
    pub fn new(setting: &Setting, parts: &[Simulated<'_>]) -> Self {
        let (mut energy, mut work) = (None::<Balance>, Vec::new());
        for Simulated { own, .. } in parts {
            if let Some(own) = own.balance {
                *energy.get_or_insert_default() += own;
            }
            work.extend_from_slice(&own.work);
        }
        let end_name = parts.first().map_or("stopped", |part| part.part.end_name.key);
        let has_contacts = parts.iter().any(|part| part.own.contacts.is_some());
        Self {
            counts: Counts::new(setting, parts),
            work_by_phase: WorkByPhase::new(&work),
            outcome: outcome(parts),
            error: parts.iter().find_map(Simulated::failed),
            ends: BTreeMap::from([(
                format!("{end_name}_s"),
                parts.iter().filter_map(Simulated::ended).collect(),
            )]),
            energy,
            contacts: has_contacts.then(|| parts.iter().flat_map(Simulated::contacts).collect()),
        }
    }
}

impl Counts {
    fn new(setting: &Setting, parts: &[Simulated<'_>]) -> Self {
        let mut stats = Stats::default();
        parts.iter().for_each(|part| stats += part.own.run.stats);
        let count = |of: fn(&Simulation) -> usize| parts.iter().map(|part| of(&part.own)).sum();
        Self {
            n_rhs: stats.work.n_rhs,
            n_accepted: stats.n_accepted,
            n_implicit: stats.n_implicit,
            n_rejected: stats.n_rejected,
            n_retaken: stats.n_retaken,
            n_events: count(|own| own.n_events),
            n_grazing: stats.n_grazing,
            n_jac: stats.work.n_jac,
            n_factorisations: stats.work.n_factorisations,
            n_lin_solves: stats.work.n_lin_solves,
            n_at_speed_floor: count(|own| own.n_at_speed_floor),
            series_order: setting.method.series_order(setting.rtol()),
        }
    }
}

impl Simulated<'_> {
    /// Why it failed, if it did.
    pub fn failed(&self) -> Option<Failed> {
        let Self { part, own, too_long } = self;
        let failure = own.run.outcome.as_ref().err().map(ToString::to_string);
        let message = failure.or_else(|| too_long.clone())?;
        let mut labels = self.labels(own.failed_site.unwrap_or(0));
        if own.failed_site.is_none() && part.labels.len() > 1 {
            labels.insert(part.labels[0][0].0, None);
        }
        Some(Failed { labels, t: own.run.t, mode: own.run.mode.clone(), message })
    }

    /// Where and when it came to its end, if it did.
    fn ended(&self) -> Option<Ended> {
        Some(Ended { labels: self.labels(self.own.stopped?), t_s: self.own.run.t })
    }

    /// The contacts of each site; none where the model tells of none.
    fn contacts(&self) -> Vec<SiteContacts> {
        let sites = self.own.contacts.iter().flatten().enumerate();
        let row = |(site, contacts): (usize, &Vec<_>)| SiteContacts {
            labels: self.labels(site),
            contacts: ContactSummary::of(contacts.iter()),
        };
        sites.map(row).collect()
    }

    fn labels(&self, site: usize) -> Labels {
        self.part.labels[site].iter().map(|&(name, value)| (name, Some(value))).collect()
    }
}

/// `failed` if any part did, else `interrupted`, else the name of the end if every part came to it.
fn outcome(parts: &[Simulated<'_>]) -> &'static str {
    let any = |outcome| parts.iter().any(|part| part.own.run.outcome == Ok(outcome));
    if parts.iter().any(|part| part.own.run.outcome.is_err() || part.too_long.is_some()) {
        "failed"
    } else if any(Outcome::Interrupted) {
        "interrupted"
    } else if any(Outcome::Finished) {
        "finished"
    } else {
        parts.first().map_or("finished", |part| part.part.end_name.key)
    }
}

fn time_or_word<S: Serializer>(horizon: &Option<Horizon>, to: S) -> Result<S::Ok, S::Error> {
    match horizon {
        Some(Horizon::LostAt(t)) => to.serialize_f64(*t),
        Some(Horizon::WholeRun) => to.serialize_none(),
        Some(Horizon::NotMeasured) | None => to.serialize_str("not_measured"),
    }
}

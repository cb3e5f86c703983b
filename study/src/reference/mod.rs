//! The run that errors are measured against, and a second run that estimates its error.
//!
//! In f64 both are Taylor series at two high orders, or what comes next where those are out of reach.

mod solve;
mod summary;

use serde::{Deserialize, Serialize};

use crate::balance::Balance;
use crate::check::{ProblemError, check_end};
use crate::errors::contacts::{Contact, total_impulse};
use crate::errors::dense::Node;
use crate::errors::{ErrorScale, EventMatch, Largest, match_to_end, worse, worst};
use crate::part::{Part, Subject};
use crate::problem::GroupScale;
use crate::run::{Limits, ModeChange};
use crate::trace::{Jumps, Samples, Trace, is_between};

pub use solve::{HORIZON_ERROR, RECIPE, parted_at, settings};
pub(crate) use solve::{Maker, Path, path};
use solve::{Solved, solve, solve_extended};
pub use summary::{PartSummary, ReferenceSummary, ScaleSummary, SiteSummary};

/// Why there is no reference.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReferenceError {
    /// A run of it failed.
    #[error("no reference: {method} stopped{place} at t = {t} s in {mode}: {error}")]
    Failed {
        /// The method.
        method: &'static str,
        /// On which part, as ` on joint 1`; empty where there is one without a name.
        place: String,
        /// Time of the last accepted step [s].
        t: f64,
        /// Mode there.
        mode: String,
        /// Why.
        error: Box<deltazero_solvers::Error>,
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
    /// The problem contradicts itself.
    #[error("no reference: {0}")]
    Problem(#[from] ProblemError),
    /// It was interrupted.
    #[error("no reference: interrupted")]
    Interrupted,
    /// A method that it is built on is not in the list of methods.
    #[error("no reference: there is no method {0}")]
    NoMethod(&'static str),
}

/// ` on joint 1`; nothing of what has no name.
fn place(name: &str) -> String {
    if name.is_empty() { String::new() } else { format!(" on {name}") }
}

/// The reference of one site.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SiteReference {
    /// The events that runs are compared by, at the roots of their guards; see [`changes`](crate::problem::changes).
    pub events: Vec<ModeChange>,
    /// Contacts, where they are known.
    pub contacts: Option<Vec<Contact>>,
}

/// The reference of one part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartReference {
    /// Times of the samples [s].
    pub times: Vec<f64>,
    /// States there.
    pub samples: Vec<Vec<f64>>,
    /// What is kept of each site.
    pub sites: Vec<SiteReference>,
    /// First sample time at which a last-bit change of the start exceeds [`HORIZON_ERROR`] [s]; infinite where none
    /// does.
    #[serde(with = "finite_or_none")]
    pub lost_at: f64,
    /// The end of the run [s].
    pub t_end: f64,
    /// State there.
    pub y_end: Vec<f64>,
    /// Scales of its errors.
    pub scale: ErrorScale,
    /// Largest magnitude of each state: at its start and over the nodes.
    pub amplitude: Vec<f64>,
    /// States between the samples.
    pub nodes: Vec<Node>,
    /// Times of the events at which a state jumps [s].
    pub jumps: Vec<f64>,
    /// All events of its run, also those that runs are not compared by.
    pub n_all_events: u64,
}

/// What the reference says of the states and events of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Error `e`; see [`PartReference::error`].
    pub e: f64,
    /// Worst time error of the paired events [s]; none where no event has a partner.
    pub event_time_error_s: Option<f64>,
    /// Events of the reference that the run lacks.
    pub missed: usize,
    /// Events of the run that the reference lacks.
    pub spurious: usize,
}

impl Judged {
    /// What sums begin with: no error, no event.
    pub(crate) const NOTHING: Self =
        Self { e: 0.0, event_time_error_s: None, missed: 0, spurious: 0 };

    /// The judgement of this part of a run and another together: the larger errors, the events of both.
    pub(crate) fn with(self, other: Self) -> Self {
        Self {
            e: worse(self.e, other.e),
            event_time_error_s: worst(self.event_time_error_s, other.event_time_error_s),
            missed: self.missed + other.missed,
            spurious: self.spurious + other.spurious,
        }
    }
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

/// The reference of a subject.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Part by part.
    pub parts: Vec<PartReference>,
    /// How it was made, and how good it is.
    pub summary: ReferenceSummary,
}

impl Reference {
    /// Makes the reference of `subject` on the sample times `times` up to `t_end`.
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
        subject: &Subject,
        t_end: f64,
        times: &[f64],
        limits: Limits<'_>,
    ) -> Result<Self, ReferenceError> {
        Self::by(subject, t_end, |part| solve(part, t_end, times, limits))
    }

    /// As [`new`](Self::new) with 31 digits: Taylor series of order 25 over pairs of f64, at rtol 1e-18, its error told by
    /// a run at 1e-20. It has no other method to go to where series are out of reach.
    ///
    /// # Errors
    /// [`ReferenceError`].
    pub fn extended(
        subject: &Subject,
        t_end: f64,
        times: &[f64],
        limits: Limits<'_>,
    ) -> Result<Self, ReferenceError> {
        Self::by(subject, t_end, |part| solve_extended(part, t_end, times, limits))
    }

    fn by(
        subject: &Subject,
        t_end: f64,
        solve: impl FnMut(&Part) -> Result<Solved, ReferenceError>,
    ) -> Result<Self, ReferenceError> {
        check_end(t_end)?;
        subject.parts.iter().try_for_each(Part::check)?;
        let solved = subject.parts.iter().map(solve).collect::<Result<Vec<_>, _>>()?;
        Ok(Self::joined(subject, solved))
    }

    /// The reference that these runs of the parts of `subject` make, whatever they were computed in.
    fn joined(subject: &Subject, solved: Vec<Solved>) -> Self {
        let mut largest = Largest::default();
        for (part, solved) in subject.parts.iter().zip(&solved) {
            part.measure(&solved.path.trace.states, &mut largest);
        }
        let mut agreement = 0.0_f64;
        let mut event_agreement = Some(0.0_f64);
        let mut energy: Option<Balance> = None;
        let of_parts = |text: fn(&Solved) -> &String| joined_text(subject, solved.iter().map(text));
        let (method, check) = (of_parts(|s| &s.method), of_parts(|s| &s.check_method));
        let (mut parts, mut warnings) = (Vec::new(), Vec::new());
        for (part, solved) in subject.parts.iter().zip(solved) {
            let scale = part.error_scale(&largest);
            let lost_at = solved.lost_at(&scale);
            let (e, times) = solved.disagreement(&scale, lost_at);
            agreement = worse(agreement, e.unwrap_or(f64::NAN));
            event_agreement = event_agreement.zip(times).map(|(a, b)| a.max(b));
            if let Some(balance) = solved.path.balance {
                *energy.get_or_insert_default() += balance;
            }
            warnings.extend_from_slice(&solved.path.warnings);
            parts.push(PartReference::new(solved, scale, lost_at));
        }
        let summary = ReferenceSummary {
            method,
            check,
            agreement,
            event_time_agreement_s: event_agreement,
            scales: scales(subject, &largest),
            parts: subject.parts.iter().zip(&parts).map(PartReference::summary).collect(),
            energy,
            warnings,
        };
        Self { parts, summary }
    }

    /// The first time at which a part is [lost](PartReference::lost_at) [s]; infinite where none is.
    pub fn lost_at(&self) -> f64 {
        self.parts.iter().fold(f64::INFINITY, |least, part| least.min(part.lost_at))
    }

    /// The shortest horizon of its parts [s].
    pub fn horizon(&self) -> f64 {
        self.parts.iter().fold(f64::INFINITY, |least, part| least.min(part.horizon()))
    }

    /// The number of events that runs are compared by.
    pub fn n_events(&self) -> usize {
        self.parts.iter().map(PartReference::n_events).sum()
    }

    /// The number of [all events](PartReference::n_all_events) of its runs.
    pub fn n_all_events(&self) -> u64 {
        self.parts.iter().map(|part| part.n_all_events).sum()
    }
}

/// The scales of the groups of all parts: of each name once, or where they differ each once, with the first part that has
/// it.
fn scales<'a>(subject: &'a Subject, largest: &Largest) -> Vec<ScaleSummary> {
    let mut all: Vec<(&Part, ScaleSummary)> = Vec::new();
    let groups = |part: &'a Part| part.groups.iter().map(move |group| (part, group));
    for (part, group) in subject.parts.iter().flat_map(groups) {
        let (is_largest, scale) = match group.scale {
            GroupScale::Fixed(scale) => (false, scale),
            GroupScale::Largest => (true, largest.of(&group.name)),
        };
        if !all.iter().any(|(_, known)| known.group == group.name && known.scale == scale) {
            let (group, unit) = (group.name.to_string(), group.unit.to_string());
            all.push((part, ScaleSummary { group, unit, scale, is_largest }));
        }
    }
    let names: Vec<String> = all.iter().map(|(_, own)| own.group.clone()).collect();
    let named = |(part, mut own): (&Part, ScaleSummary)| {
        let n_scales = names.iter().filter(|name| **name == own.group).count();
        if n_scales > 1 && !part.name.is_empty() {
            own.group += &format!(" of {}", part.name);
        }
        own
    };
    all.into_iter().map(named).collect()
}

/// The texts of all parts as one: the text alone where all have the same, else each with the name of its part.
fn joined_text<'a>(
    subject: &Subject,
    mut of_parts: impl Iterator<Item = &'a String> + Clone,
) -> String {
    let all = of_parts.clone();
    match of_parts.next() {
        Some(first) if of_parts.all(|other| other == first) => first.clone(),
        _ => {
            let parts = subject.parts.iter().zip(all);
            let texts = parts.map(|(part, text)| format!("{}: {text}", part.name));
            texts.collect::<Vec<_>>().join("; ")
        }
    }
}

impl PartReference {
    fn new(solved: Solved, scale: ErrorScale, lost_at: f64) -> Self {
        let path = solved.path;
        let mut amplitude: Vec<f64> = path.y_start.iter().map(|y| y.abs()).collect();
        for node in &path.nodes {
            for (largest, y) in amplitude.iter_mut().zip(&node.y) {
                *largest = largest.max(y.abs());
            }
        }
        let mut contacts = path.contacts.map(Vec::into_iter);
        let site = |events| SiteReference {
            events,
            contacts: contacts.as_mut().map(|contacts| contacts.next().unwrap_or_default()),
        };
        Self {
            sites: path.events.into_iter().map(site).collect(),
            times: path.trace.times,
            samples: path.trace.states,
            lost_at,
            n_all_events: path.run.stats.n_events,
            t_end: path.run.t,
            y_end: path.run.y,
            scale,
            amplitude,
            nodes: path.nodes,
            jumps: path.trace.jumps,
        }
    }

    fn summary((part, own): (&Part, &Self)) -> PartSummary {
        let site = |(name, site): (&String, &SiteReference)| SiteSummary {
            name: name.clone(),
            n_events: site.events.len(),
            impulse_n_s: site.contacts.as_deref().filter(|all| !all.is_empty()).map(total_impulse),
        };
        PartSummary {
            name: part.name.clone(),
            horizon_s: own.horizon(),
            t_end_s: own.t_end,
            sites: part.sites.iter().zip(&own.sites).map(site).collect(),
        }
    }

    /// Whether `t` lies within the horizon.
    pub fn is_within(&self, t: f64) -> bool {
        t < self.lost_at
    }

    /// The time up to which the run is predictable: where it is lost, or its end [s].
    pub fn horizon(&self) -> f64 {
        self.lost_at.min(self.t_end)
    }

    /// The events of all sites that runs are compared by.
    pub fn events(&self) -> impl Iterator<Item = &ModeChange> {
        self.sites.iter().flat_map(|site| &site.events)
    }

    fn n_events(&self) -> usize {
        self.events().count()
    }

    /// The nodes within the horizon.
    pub fn nodes_within(&self) -> &[Node] {
        &self.nodes[..self.nodes.partition_point(|node| self.is_within(node.t))]
    }

    /// Compares a run of the same part with it: the error of its states, and its events at all sites.
    pub fn judge(&self, run: &Trace) -> Judged {
        let mut judged = Judged { e: self.error(run), ..Judged::NOTHING };
        for site in 0..self.sites.len() {
            let EventMatch { paired, missed, spurious, time_error } = self.matched(site, run);
            let event_time_error_s = (paired > 0).then_some(time_error);
            judged = judged.with(Judged { e: 0.0, event_time_error_s, missed, spurious });
        }
        judged
    }

    /// Largest `e` of a run's samples, on the same times, within the horizon, of those that [can be compared](Samples::pairs).
    /// Infinite for a run that ends before them, not a number where there is none.
    pub fn error(&self, run: &Trace) -> f64 {
        if self.ends_early(run) {
            return f64::INFINITY;
        }
        let errors = self.pairs_within(run).map(|(y, own)| self.scale.error(own, y));
        errors.reduce(worse).unwrap_or(f64::NAN)
    }

    /// Whether a run ends before the samples of the reference do. One that ends a sample early stopped at its end
    /// beside the sample; one that ends earlier still went astray.
    fn ends_early(&self, run: &Trace) -> bool {
        let n_within = self.times.iter().filter(|t| self.is_within(**t)).count();
        run.states.len() + 1 < n_within
    }

    fn pairs_within<'a>(
        &'a self,
        run: &'a Trace,
    ) -> impl Iterator<Item = (&'a [f64], &'a [f64])> + 'a {
        let samples = Samples {
            times: &self.times,
            states: &self.samples,
            jumps: Jumps { at: &self.jumps, t_end: self.t_end },
        };
        let pairs = samples.pairs(run.samples(), self.scale.event_window);
        pairs.filter(|(t, ..)| self.is_within(*t)).map(|(_, y, own)| (y, own))
    }

    /// Error of the state at a run's end: the worst of all states, each relative to the largest
    /// magnitude that it takes; none where the end lies beyond the horizon, or between a jump of one of both, at `jumps`, and
    /// the same jump of the other.
    pub fn end_error(&self, y_end: &[f64], jumps: Jumps<'_>) -> Option<f64> {
        let own = Jumps { at: &self.jumps, t_end: self.t_end };
        let end = self.t_end.max(jumps.t_end);
        if is_between([own, jumps], self.scale.event_window, end) {
            return None;
        }
        let errors = (0..self.y_end.len()).map(|i| match (y_end[i] - self.y_end[i]).abs() {
            0.0 => 0.0,
            error => error / self.amplitude[i],
        });
        (self.lost_at == f64::INFINITY).then(|| errors.fold(0.0, worse))
    }

    /// The events of a run's site against its own, within the horizon. What ends a run counts at the first site: one that goes on
    /// has missed it, one that ends before has made it up.
    pub fn matched(&self, site: usize, run: &Trace) -> EventMatch {
        let within = |events: &[ModeChange]| -> Vec<ModeChange> {
            events.iter().filter(|event| self.is_within(event.t)).copied().collect()
        };
        let (own, reference) = (within(&run.changes[site]), within(&self.sites[site].events));
        // One that went on longer does not have what ended the reference.
        let end = run.t_end.max(self.t_end).min(self.lost_at);
        let mut found = match_to_end(&own, &reference, (self.scale.event_window, end));
        let late = run.t_end - self.t_end;
        if site == 0 && late.abs() > self.scale.event_window && self.is_within(end) {
            found.missed += usize::from(late > 0.0);
            found.spurious += usize::from(late < 0.0);
        }
        found
    }
}

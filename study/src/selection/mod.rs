//! The contest: of several methods, each at the cheapest setting that truly reaches an accuracy, which
//! one is the fastest?
//!
//! A [`Setting`] reaches an accuracy if its error `e` keeps below it up to the end, and if, at an accuracy
//! of [`EVENTS_FROM`] or better, a run that locates events has found each event of the reference and no
//! other. A blind run makes no claim about events. How many of them are wrong is told beside `e`.
//!
//! Error against tolerance is jagged, so one run that reaches it proves little. A setting counts if
//! `e` keeps a [`MARGIN`], and so does the next tighter setting, and both again from a start moved by
//! its last bit: the spread of the four goes with the answer.
//!
//! The search is ordered by *work*, a count that is the same on every machine: all candidates that locate
//! events run under a budget that grows until one of them arrives; from then on a run is cut at [`CUT`]
//! times the least work so far, or at [`FINAL`] times the least of its own kind (explicit or implicit). So
//! cheap winners come first, hopeless ones cost little, and the best of each kind is known where it comes
//! within ten times the best of all. Then the blind ones run, each cut at [`FINAL`] times the least of
//! those that locate events by a method that is the same throughout, too. Where events must be right, a run
//! with far more of them than the reference is broken off. Those that stay within [`FINAL`] times the least work of a
//! method that is the same throughout, which `auto` is not, are then timed, one after the other in turns, so
//! that what disturbs the machine disturbs them alike.

mod benchmark;
mod bracket;
mod finals;
mod known;
mod outcome;
mod search;
mod settings;
mod trial;

use std::sync::atomic::{AtomicBool, Ordering};

use deltazero_solvers::{METHODS, Method, Stats};
use serde::{Deserialize, Serialize};

use crate::json_number;
use crate::setting::{Accuracy, Atol, Events, Setting, chooses};

pub use benchmark::Benchmark;
pub use trial::{Start, Trial, TrialEnd, TrialLimit, work};

pub(crate) use known::Known;
use search::{Search, Step};

/// A setting counts if `e` keeps below this part of the accuracy.
pub const MARGIN: f64 = 0.8;
/// A run is cut at this many times the least work of those that arrived.
pub const CUT: f64 = 10.0;
/// Candidates within this many times the least work of a method that is the same throughout are timed.
pub const FINAL: f64 = 3.0;
/// From this accuracy on a run that locates events must have their sequence right, where not every run must.
pub const EVENTS_FROM: f64 = 1e-6;
/// Work of the first budget: some milliseconds.
const FIRST_BUDGET: f64 = 5e4;
/// Growth of the budget while no candidate has arrived.
const BUDGET_GROWTH: f64 = 4.0;

/// A method with what it does about events; the contest finds its setting.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// The method.
    pub method: &'static Method,
    /// What it does about events.
    pub events: Events,
}

impl Candidate {
    /// Every pair of `methods`, by name, and `events`; an unknown method none.
    pub fn all(methods: &[String], events: &[Events]) -> Vec<Self> {
        let known = METHODS.iter().filter(|method| methods.iter().any(|name| name == method.name));
        known.flat_map(|method| events.iter().map(move |&events| Self { method, events })).collect()
    }
}

/// Which runs must have every event of the reference, and no other, to count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RightEvents {
    /// All.
    #[default]
    Always,
    /// Those that locate events, from an accuracy of [`EVENTS_FROM`] on.
    FromTight,
}

impl RightEvents {
    /// Whether a run that treats events in this way must have them right at this accuracy.
    pub(super) fn must_be_right(self, accuracy: f64, events: Events) -> bool {
        self == Self::Always || accuracy <= EVENTS_FROM && events == Events::Located
    }

    /// Whether `trial`, which treats events in this way, has them right, or need not have at this accuracy.
    pub fn accept(self, accuracy: f64, events: Events, trial: &Trial) -> bool {
        !self.must_be_right(accuracy, events) || trial.events_are_right()
    }
}

/// Who takes part in contests, and how they are run.
#[derive(Clone, Debug)]
pub struct Rules {
    /// Who takes part.
    pub candidates: Vec<Candidate>,
    /// Absolute tolerance that goes with every relative one; none: its multiple of the scales.
    pub atol: Option<Atol>,
    /// Times that each of the fastest is run.
    pub repeats: u32,
    /// Work beyond which a run is cut whatever the others need.
    pub max_work: f64,
    /// Whose events must be right.
    pub right_events: RightEvents,
}

impl Default for Rules {
    /// Every method, its events located and right.
    fn default() -> Self {
        let located = |method| Candidate { method, events: Events::Located };
        let candidates = METHODS.iter().map(located).collect();
        let right_events = RightEvents::Always;
        Self { candidates, atol: None, repeats: 5, max_work: 1e8, right_events }
    }
}

/// What a contest is about.
#[derive(Clone, Copy, Debug)]
pub struct Contest<'a> {
    /// The subject, with the reference that judges.
    pub benchmark: &'a Benchmark,
    /// The error `e` to be reached.
    pub accuracy: f64,
    /// Who takes part, and how.
    pub rules: &'a Rules,
    /// Set from outside to interrupt it.
    pub stop: &'a AtomicBool,
}

/// A candidate that reaches the accuracy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Method.
    pub method: String,
    /// What it does about events.
    pub events: Events,
    /// Relative tolerance, if it has one.
    pub rtol: Option<f64>,
    /// Fixed step [s], if it has one.
    pub step: Option<f64>,
    /// Its error.
    #[serde(with = "json_number::one")]
    pub e: f64,
    /// Least and largest error of it, the next tighter setting, and the start moved by its last bit.
    #[serde(with = "json_number::pair")]
    pub e_spread: [f64; 2],
    /// Events of the reference that it lacks.
    pub missed: usize,
    /// Events that the reference lacks.
    pub spurious: usize,
    /// Whether it is implicit; `auto`, which is by turns, is not.
    pub implicit: bool,
    /// Evaluations of the right-hand side of a part.
    pub n_rhs: u64,
    /// Accepted steps.
    pub n_accepted: u64,
    /// Those of them that `auto` took with its implicit half; none of another method, or where an earlier version
    /// did not say.
    #[serde(default)]
    pub n_implicit: Option<u64>,
    /// Mean of the accepted steps [s].
    #[serde(with = "json_number::one")]
    pub mean_step_s: f64,
    /// Steps that a tolerance ten times tighter takes for each of its own; none for a fixed step.
    #[serde(default, with = "json_number::maybe")]
    pub growth: Option<f64>,
    /// Whether stability, not accuracy, sets its steps.
    pub bound_by_stability: bool,
    /// Work; see [`work`].
    #[serde(with = "json_number::one")]
    pub work: f64,
    /// Shortest time of its runs [s].
    #[serde(with = "json_number::one")]
    pub wall_s: f64,
    /// Shortest time of the processor of its runs [s], by which entries are ranked; none where an earlier version did
    /// not say, and the shortest time ranks.
    #[serde(default)]
    pub cpu_s: Option<f64>,
    /// How uncertain [`time_s`](Self::time_s) is, as a factor: the median of those in turns over the
    /// shortest; none where there were no turns.
    #[serde(default)]
    pub noise: Option<f64>,
    /// Whether a tighter setting has the events wrong.
    pub grazes: bool,
    /// Whether it was timed in turns with the fastest.
    pub timed: bool,
}

impl Entry {
    /// Whether it is the method that chooses between others as it goes.
    pub fn is_auto(&self) -> bool {
        chooses(&self.method)
    }

    /// The time that ranks [s]: of the processor, or on the wall where that is all that is known.
    pub fn time_s(&self) -> f64 {
        self.cpu_s.unwrap_or(self.wall_s)
    }

    /// Whether the noise of their times leaves open which of it and the faster `first` is the faster one.
    pub fn is_within_noise_of(&self, first: &Self) -> bool {
        let noise = |entry: &Self| entry.noise.unwrap_or(1.0);
        self.timed && self.time_s() <= first.time_s() * noise(self).max(noise(first))
    }

    /// What `auto` is here, as text: `4007 of its 4704 steps implicit`; none of another method.
    pub fn implicit_steps(&self) -> Option<String> {
        let n_implicit = self.n_implicit?;
        Some(format!("{n_implicit} of its {} steps implicit", self.n_accepted))
    }

    /// Tolerance or step as text: `rtol 1e-6`, `h 1e-4 s`.
    pub fn setting(&self) -> String {
        let accuracy = Accuracy::of_columns(self.rtol, self.step, None);
        accuracy.map_or_else(String::new, |accuracy| accuracy.to_string())
    }
}

/// Why a candidate does not reach the accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FailureKind {
    /// It needs more than [`CUT`] times the least work, or [`FINAL`] times that of its kind or, blind, of those that
    /// locate events.
    Cut,
    /// It needs more than the limit of work or of time, whatever the others need.
    Limit,
    /// Its error stays above the accuracy, however tight the setting.
    OutOfReach,
    /// Its error is small enough, its sequence of events wrong.
    EventsWrong,
    /// Its iteration does not converge.
    NoConvergence,
    /// Its events accumulate, its transitions at one instant do not end, or it has far more events than the reference
    /// where they must be right.
    EventStorm,
    /// It stopped for another reason.
    Failed,
    /// It was interrupted.
    Interrupted,
}

impl FailureKind {
    /// As the files write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cut => "cut",
            Self::Limit => "limit",
            Self::OutOfReach => "out_of_reach",
            Self::EventsWrong => "events_wrong",
            Self::NoConvergence => "no_convergence",
            Self::EventStorm => "event_storm",
            Self::Failed => "failed",
            Self::Interrupted => "interrupted",
        }
    }
}

/// A candidate that does not reach the accuracy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// Method.
    pub method: String,
    /// What it does about events.
    pub events: Events,
    /// Whether it is implicit.
    pub implicit: bool,
    /// Why.
    pub kind: FailureKind,
    /// Why, with numbers.
    pub message: String,
    /// Mean accepted step of its last run [s], if it took one.
    pub mean_step_s: Option<f64>,
}

impl Standings {
    /// The failures of methods that locate events and are [explicit or implicit](Failure::implicit) throughout.
    pub fn lost(&self, implicit: bool) -> impl Iterator<Item = &Failure> {
        let is_fixed = move |own: &&Failure| !own.is_auto() && own.implicit == implicit;
        self.failures.iter().filter(|own| own.events == Events::Located).filter(is_fixed)
    }
}

impl Failure {
    /// Whether it is of the method that chooses between others as it goes.
    pub fn is_auto(&self) -> bool {
        chooses(&self.method)
    }
}

/// How a contest ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Standings {
    /// Those that reach the accuracy, the fastest first.
    pub entries: Vec<Entry>,
    /// Those that do not, in the order of the candidates.
    pub failures: Vec<Failure>,
    /// Runs made, the repeats for time left out.
    pub n_trials: usize,
}

impl Contest<'_> {
    /// Whether the reference is good enough to tell who reaches the accuracy.
    pub fn is_decidable(&self) -> bool {
        self.benchmark.reference.summary.can_decide(self.accuracy)
    }

    /// Runs the contest between the candidates of its rules; `progress` hears of each that is through.
    pub fn run(&self, progress: &dyn Fn(&str)) -> Standings {
        self.run_knowing(&Known::default(), progress)
    }

    /// The same, knowing what contests on this benchmark at smaller errors found out.
    pub(crate) fn run_knowing(&self, known: &Known, progress: &dyn Fn(&str)) -> Standings {
        let candidates = self.rules.candidates.iter();
        let mut searches: Vec<Search<'_>> =
            candidates.map(|candidate| Search::new(self, known, *candidate)).collect();
        let timing_limit = self.search(&mut searches, progress);
        let mut standings = Standings {
            n_trials: searches.iter().map(|search| search.n_trials).sum(),
            ..Standings::default()
        };
        let mut settings = Vec::new();
        for search in &searches {
            match search.entry() {
                Ok((setting, entry)) => {
                    settings.push(setting);
                    standings.entries.push(entry);
                }
                Err(failure) => standings.failures.push(failure),
            }
        }
        finals::time(self, &settings, &mut standings.entries, timing_limit);
        standings
    }

    /// Advances every search until it is over, under budgets that grow; the work up to which candidates are
    /// timed.
    fn search(&self, searches: &mut [Search<'_>], progress: &dyn Fn(&str)) -> f64 {
        let mut least = LeastWork::default();
        let next = |least: &LeastWork, budget: f64| {
            let first = least.of_all();
            if first.is_finite() { CUT * first } else { budget }
        };
        for &events in Events::ALL {
            let mut budget = next(&least, FIRST_BUDGET);
            loop {
                let mut open = false;
                let own = searches.iter_mut().filter(|search| search.candidate.events == events);
                for search in own.filter(|search| !search.is_over()) {
                    let of_others = least.limit(search.candidate);
                    let most = self.rules.max_work.min(of_others);
                    let limit = budget.min(most);
                    match search.advance(limit, &least) {
                        Step::Over => {
                            least.arrived(search.candidate, search.work());
                            progress(search.candidate.method.name);
                        }
                        // A later, lower limit would cut it all the more.
                        Step::Cut if limit >= most => {
                            let by_others = of_others <= self.rules.max_work;
                            search.give_up(by_others.then(|| least.of_all()));
                            progress(search.candidate.method.name);
                        }
                        Step::Cut => open = true,
                    }
                }
                if !open {
                    break;
                }
                budget = next(&least, BUDGET_GROWTH * budget);
            }
        }
        least.timing_limit()
    }

    fn is_interrupted(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn setting(&self, candidate: Candidate, index: i32) -> Setting {
        let Candidate { method, events } = candidate;
        let atol = self.rules.atol.clone();
        Setting { method, events, accuracy: settings::accuracy(method, index, atol) }
    }
}

/// The least work of those that arrived, kind by kind; infinite where none did.
struct LeastWork {
    explicit: LeastByEvents,
    implicit: LeastByEvents,
    /// That of `auto`, which is cut as an explicit method is and cuts none.
    auto: f64,
}

/// The least work of one kind of methods, by what they do about events.
struct LeastByEvents {
    located: f64,
    blind: f64,
}

impl Default for LeastWork {
    fn default() -> Self {
        let none = || LeastByEvents { located: f64::INFINITY, blind: f64::INFINITY };
        Self { explicit: none(), implicit: none(), auto: f64::INFINITY }
    }
}

impl LeastWork {
    /// Notes the work by which a candidate arrived.
    fn arrived(&mut self, candidate: Candidate, work: f64) {
        let Candidate { method, events } = candidate;
        let kind = if method.is_implicit() { &mut self.implicit } else { &mut self.explicit };
        let own = match events {
            _ if method.chooses() => &mut self.auto,
            Events::Located => &mut kind.located,
            Events::Blind => &mut kind.blind,
        };
        *own = own.min(work);
    }

    /// That of the methods that are the same throughout.
    fn of_fixed(&self) -> f64 {
        let Self { explicit, implicit, .. } = self;
        least([explicit.located, explicit.blind, implicit.located, implicit.blind])
    }

    fn of_all(&self) -> f64 {
        self.of_fixed().min(self.auto)
    }

    /// The work up to which a candidate may be among the fastest.
    fn timing_limit(&self) -> f64 {
        let fixed = self.of_fixed();
        FINAL * if fixed.is_finite() { fixed } else { self.of_all() }
    }

    /// Where a candidate is cut.
    fn limit(&self, Candidate { method, events }: Candidate) -> f64 {
        let Self { explicit, implicit, .. } = self;
        let own = if method.is_implicit() { implicit } else { explicit };
        let rivals = match events {
            Events::Located => own.located,
            Events::Blind => least([own.blind, explicit.located, implicit.located]),
        };
        (CUT * self.of_all()).min(FINAL * rivals)
    }
}

fn least(each: impl IntoIterator<Item = f64>) -> f64 {
    each.into_iter().fold(f64::INFINITY, f64::min)
}

/// Mean accepted step [s] of a run that came `covered` seconds far, parts added.
fn mean_step(covered: f64, stats: &Stats) -> Option<f64> {
    (stats.n_accepted > 0).then(|| covered / stats.n_accepted as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_located_runs_of_tight_accuracies_must_be_right_where_few_must() {
        let asked = |accuracy, events| RightEvents::FromTight.must_be_right(accuracy, events);
        assert!(asked(EVENTS_FROM, Events::Located) && !asked(2.0 * EVENTS_FROM, Events::Located));
        assert!(!asked(EVENTS_FROM, Events::Blind));
        assert!(RightEvents::Always.must_be_right(1.0, Events::Blind));
    }
}

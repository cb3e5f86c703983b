//! The search for the loosest setting of one candidate that can be trusted to reach the accuracy.

use std::collections::BTreeMap;

use super::bracket::{Bracket, LONGEST, Move};
use super::settings::{self, A_DECADE};
use super::trial::{EARLY, ON_COURSE, Start, Trial, TrialEnd, TrialLimit, chatter_bound};
use super::{Candidate, Contest, FailureKind, Known, LeastWork, MARGIN};

/// Settings that are skipped where events are wrong, the next time twice as many, and so on; or where a run
/// fails.
const EVENTS_WRONG: i32 = 2;
const FAILED: i32 = A_DECADE;

/// What came of a search under a limit of work.
pub(super) enum Step {
    /// It is over.
    Over,
    /// It needs a higher limit.
    Cut,
}

/// The search of one candidate.
pub(super) struct Search<'a> {
    pub(super) contest: &'a Contest<'a>,
    known: &'a Known,
    pub(super) candidate: Candidate,
    /// Runs by the index of their setting.
    pub(super) trials: BTreeMap<i32, Trial>,
    /// Runs from starts moved up and down, by the index of their setting, of the settings that were confirmed.
    pub(super) nudged: BTreeMap<i32, [Trial; 2]>,
    pub(super) verdict: Option<Result<i32, (FailureKind, String)>>,
    pub(super) last: i32,
    /// Work beyond which its setting need not be found to a quarter of a decade.
    timing_limit: f64,
    /// The least work of those that arrived; zero where none did.
    least: f64,
    pub(super) n_trials: usize,
}

/// What a setting is.
enum Kind {
    /// It reaches the accuracy.
    Meets,
    /// It does not; a tighter one may, so many settings away.
    Misses(i32),
    /// It needs more than the limit.
    Cut,
}

impl<'a> Search<'a> {
    pub(super) fn new(contest: &'a Contest<'a>, known: &'a Known, candidate: Candidate) -> Self {
        Self {
            contest,
            known,
            candidate,
            trials: BTreeMap::new(),
            nudged: BTreeMap::new(),
            verdict: None,
            last: 0,
            timing_limit: f64::INFINITY,
            least: 0.0,
            n_trials: 0,
        }
    }

    pub(super) fn is_over(&self) -> bool {
        self.verdict.is_some()
    }

    /// Ends it as cut: at a limit that follows from `least`, the least work of the others, or where there is none at the
    /// limit of work.
    pub(super) fn give_up(&mut self, least: Option<f64>) {
        let needs = self.needs(self.last);
        let is_late = |trial: &Trial| trial.end == TrialEnd::OutOfTime;
        let Contest { benchmark, rules, .. } = self.contest;
        let (max_seconds, max_work) = (benchmark.max_seconds, rules.max_work);
        let failure = if self.trials.get(&self.last).is_some_and(is_late) {
            (FailureKind::Limit, format!("needs more than study.max_seconds = {max_seconds} s"))
        } else if let Some(least) = least {
            let times = needs / least;
            let message = if times.is_finite() {
                format!("would need some {times:.0} times the work of the best")
            } else {
                "needs more than its limit for its first step".to_owned()
            };
            (FailureKind::Cut, message)
        } else {
            (FailureKind::Limit, format!("needs more than contest.max_work = {max_work:e}"))
        };
        self.verdict = Some(Err(failure));
    }

    /// Goes on until it is over or `limit` of work, which follows from the `least` of the others, cuts it.
    pub(super) fn advance(&mut self, limit: f64, least: &LeastWork) -> Step {
        let of_all = least.of_all();
        self.timing_limit = least.timing_limit();
        self.least = if of_all.is_finite() { of_all } else { 0.0 };
        // What was on course for more than this limit, too, is not run again: an explicit method whose steps stability binds
        // goes on as it began. Another one may take long steps once the first impacts have rung out.
        let method = self.candidate.method;
        let may_calm = method.is_implicit() || method.chooses();
        let judged_from = if may_calm { self.early(limit) } else { self.least };
        let is_hopeless =
            |trial: &Trial| trial.work > judged_from && trial.needs() > ON_COURSE * limit;
        self.trials.retain(|_, trial| trial.end != TrialEnd::Cut || is_hopeless(trial));
        let found = self.bracket(limit).and_then(|index| self.confirm(index, limit));
        // Where events are right at few settings, the search may pass by the one that is known.
        let found = found.or_else(|end| match self.known.reached(self.candidate) {
            Some(index) => self.confirm(index, limit),
            None => Err(end),
        });
        if self.contest.is_interrupted() {
            let message = "interrupted".to_owned();
            self.verdict = Some(Err((FailureKind::Interrupted, message)));
            return Step::Over;
        }
        match found {
            Ok(index) => {
                self.known.note_reached(self.candidate, index);
                self.verdict = Some(Ok(index));
                Step::Over
            }
            Err(End::Cut) => Step::Cut,
            Err(End::Failure(kind, message)) => {
                self.verdict = Some(Err((kind, message)));
                Step::Over
            }
        }
    }

    /// The loosest setting that meets the accuracy, as far as bisection finds it.
    fn bracket(&mut self, limit: f64) -> Result<i32, End> {
        let Contest { benchmark, accuracy, .. } = *self.contest;
        let method = self.candidate.method;
        let mut index = settings::first(method, benchmark.t_end, accuracy);
        let mut bracket = Bracket::new(settings::indices(method, benchmark.t_end), index);
        loop {
            let away = match self.look(index, limit) {
                Kind::Meets => {
                    bracket.note_meets(index);
                    self.slack(index)
                }
                Kind::Misses(to_go) => {
                    let e = self.trials.get(&index).map_or(f64::INFINITY, |trial| trial.e);
                    bracket.note_misses(index, to_go, (e, accuracy))
                }
                Kind::Cut => {
                    let is_hopeless = self.needs(index) > self.looser_saves(index) * limit;
                    bracket.note_cut(index, is_hopeless).ok_or(End::Cut)?
                }
            };
            if self.contest.is_interrupted() {
                return Err(End::Cut);
            }
            index = match bracket.next(away, |misses, meets| self.fineness(misses, meets)) {
                Move::Found(index) => return Ok(index),
                Move::Cut => return Err(End::Cut),
                Move::NoneReaches(last) => return Err(self.failure(last)),
                Move::Between(low, high) => self.between(low, high),
                Move::At(index) => index,
            };
        }
    }

    /// How many settings apart what misses and what meets may stay: one where the latter may be among the fastest; any number
    /// where what misses already needs too much for that, and a decade where what meets does.
    fn fineness(&self, misses: i32, meets: Option<i32>) -> i32 {
        let is_dear = |trial: &&Trial| trial.work > self.timing_limit;
        // One that did not come to its end may cost more than a tighter one: it rejects, or chatters.
        let least = self.trials.get(&misses).filter(|trial| trial.end == TrialEnd::Reached);
        match meets {
            Some(_) if least.filter(is_dear).is_some() => i32::MAX,
            Some(meets) if self.trials.get(&meets).filter(is_dear).is_some() => A_DECADE,
            _ => 1,
        }
    }

    /// The first setting from `index` on that meets the accuracy together with the next one, and from starts moved by the last
    /// bit.
    fn confirm(&mut self, mut index: i32, limit: f64) -> Result<i32, End> {
        let tightest =
            *settings::indices(self.candidate.method, self.contest.benchmark.t_end).end();
        loop {
            let next = (index + 1).min(tightest);
            let failed =
                [index, next].into_iter().rev().find_map(|at| match self.look(at, limit) {
                    Kind::Meets => None,
                    Kind::Misses(_) => Some(Ok(at)),
                    Kind::Cut => Some(Err(End::Cut)),
                });
            index = match failed {
                None if self.holds_when_nudged(index) => return Ok(index),
                None => index + 1,
                Some(Err(end)) => return Err(end),
                Some(Ok(at)) => at + 1,
            };
            if self.contest.is_interrupted() {
                return Err(End::Cut);
            }
            if index > tightest {
                return Err(self.failure(tightest));
            }
        }
    }

    /// The work from which on a run is judged by its course: one that needs less than those that arrived comes to its end.
    fn early(&self, limit: f64) -> f64 {
        self.least.max(EARLY * limit)
    }

    /// The work that the run of a setting needs to its end.
    fn needs(&self, index: i32) -> f64 {
        self.trials.get(&index).map_or(f64::INFINITY, Trial::needs)
    }

    /// The factor by which the loosest setting that may still reach the accuracy, two decades from
    /// `index`, can at best reduce the work: `10^(1/p)` a decade at order p.
    fn looser_saves(&self, index: i32) -> f64 {
        let loosest =
            *settings::indices(self.candidate.method, self.contest.benchmark.t_end).start();
        let decades = f64::from((index - loosest).min(LONGEST)) / f64::from(A_DECADE);
        libm::exp10(decades / self.candidate.method.order as f64)
    }

    /// Runs a setting, unless that is done, and judges it.
    fn look(&mut self, index: i32, limit: f64) -> Kind {
        let contest = self.contest;
        self.last = index;
        if !self.trials.contains_key(&index) {
            let trial = self.run(index, Start::Exact, limit);
            self.trials.insert(index, trial);
        }
        let trial = &self.trials[&index];
        let goal = MARGIN * contest.accuracy;
        let n_events = contest.benchmark.reference.n_all_events() as f64 * trial.covered
            / contest.benchmark.whole();
        match &trial.end {
            TrialEnd::Chatters => Kind::Misses(LONGEST),
            // Cut with far more events than the reference has by then: a tighter one may cost less.
            TrialEnd::Cut if trial.n_events as f64 > chatter_bound(n_events) => {
                Kind::Misses(LONGEST)
            }
            TrialEnd::Cut | TrialEnd::OutOfTime | TrialEnd::Interrupted => Kind::Cut,
            TrialEnd::Failed(_) => Kind::Misses(FAILED),
            TrialEnd::Reached if trial.e <= goal => {
                // One that was affordable under an earlier, higher limit, or in another contest.
                if trial.work > limit {
                    Kind::Cut
                } else if self.accepts_events(trial) {
                    Kind::Meets
                } else {
                    Kind::Misses(EVENTS_WRONG)
                }
            }
            TrialEnd::Reached => Kind::Misses(settings_of(trial.e / goal).ceil() as i32),
        }
    }

    /// Whether a setting reaches the accuracy from starts moved by the last bit, too; not asked where it
    /// cannot be among the fastest.
    fn holds_when_nudged(&mut self, index: i32) -> bool {
        if self.trials.get(&index).is_some_and(|trial| trial.work > self.timing_limit) {
            return true;
        }
        if !self.nudged.contains_key(&index) {
            let both = [Start::Up, Start::Down].map(|start| self.run(index, start, f64::INFINITY));
            self.nudged.insert(index, both);
        }
        let goal = MARGIN * self.contest.accuracy;
        self.nudged[&index].iter().all(|trial| trial.e <= goal && self.accepts_events(trial))
    }

    /// The run of a setting from `start`, as known or made under `limit`.
    fn run(&mut self, index: i32, start: Start, limit: f64) -> Trial {
        let Contest { benchmark, accuracy, rules, stop } = *self.contest;
        let setting = self.contest.setting(self.candidate, index);
        let chatter = rules.right_events.must_be_right(accuracy, self.candidate.events);
        let limit = TrialLimit { work: limit, early: self.early(limit), chatter };
        let make = || Trial::new(benchmark, &setting, start, limit, stop);
        let (trial, is_made) = self.known.or_make((self.candidate, index, start), limit, make);
        self.n_trials += usize::from(is_made);
        trial
    }

    /// How many settings looser than one that meets the accuracy another might meet it.
    fn slack(&self, index: i32) -> i32 {
        let e = self.trials.get(&index).map_or(0.0, |trial| trial.e);
        (settings_of(MARGIN * self.contest.accuracy / e).floor() as i32).clamp(1, LONGEST)
    }

    /// A setting between one that misses and one that meets (or is cut): where a power law through both
    /// errors has the accuracy, or else the middle.
    fn between(&self, low: i32, high: i32) -> i32 {
        let e = |index: i32| {
            self.trials.get(&index).map(|trial| trial.e).filter(|e| *e > 0.0 && e.is_finite())
        };
        let goal = MARGIN * self.contest.accuracy;
        let part = match (e(low), e(high)) {
            (Some(a), Some(b)) if a > goal && goal > b => libm::log(a / goal) / libm::log(a / b),
            _ => 0.5,
        };
        let at = f64::from(low) + part * f64::from(high - low);
        (at.round() as i32).clamp(low + 1, high - 1)
    }

    pub(super) fn accepts_events(&self, trial: &Trial) -> bool {
        let Contest { accuracy, rules, .. } = *self.contest;
        rules.right_events.accept(accuracy, self.candidate.events, trial)
    }

    /// The work of the setting that was found; infinite where none was.
    pub(super) fn work(&self) -> f64 {
        let found = self.verdict.as_ref().and_then(|verdict| verdict.as_ref().ok());
        found.and_then(|index| self.trials.get(index)).map_or(f64::INFINITY, |trial| trial.work)
    }
}

/// Why a search stops.
pub(super) enum End {
    /// The limit of work.
    Cut,
    /// No setting reaches the accuracy.
    Failure(FailureKind, String),
}

/// Settings that a factor in the error is worth, where error goes with tolerance.
fn settings_of(factor: f64) -> f64 {
    let settings = f64::from(A_DECADE) * libm::log10(factor);
    let longest = f64::from(LONGEST);
    if settings.is_nan() { longest } else { settings.clamp(-longest, longest) }
}

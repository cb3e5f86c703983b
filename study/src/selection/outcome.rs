//! What a search found: an entry of the contest, or why no setting reaches the accuracy.

use deltazero_solvers::Error;

use super::search::{End, Search};
use super::settings::{self, A_DECADE};
use super::trial::{Trial, TrialEnd};
use super::{Candidate, Entry, Failure, FailureKind, mean_step};
use crate::setting::Setting;

/// Largest distance of two settings whose steps are compared for [`Entry::growth`].
const GROWTH_SPAN: i32 = 2 * A_DECADE;

/// A fixed step whose error is below this part of the accuracy is not chosen for accuracy.
const TOO_GOOD: f64 = 0.01;
/// Where a phase has fewer steps than this, in the mean, its events set them, or the growth from a short first step, and no
/// limit of stability. A quadrature over 2 s takes 5 to 7.
const FEW_STEPS: u64 = 10;

impl Search<'_> {
    /// Why no setting reaches the accuracy, told by the last one looked at.
    pub(super) fn failure(&self, index: i32) -> End {
        let Some(trial) = self.trials.get(&index) else {
            return End::Cut;
        };
        let setting = self.contest.setting(self.candidate, index).accuracy;
        let (kind, what) = match &trial.end {
            TrialEnd::Cut | TrialEnd::OutOfTime | TrialEnd::Interrupted => return End::Cut,
            TrialEnd::Chatters => {
                let message = format!("far more events than the reference: {}", trial.n_events);
                (FailureKind::EventStorm, message)
            }
            TrialEnd::Failed(error) => {
                let kind = match error {
                    Error::NoConvergence { .. } => FailureKind::NoConvergence,
                    Error::EventStorm { .. } | Error::Chatter { .. } => FailureKind::EventStorm,
                    _ => FailureKind::Failed,
                };
                (kind, error.to_string())
            }
            TrialEnd::Reached if trial.e <= self.contest.accuracy => {
                let (missed, spurious) = (trial.missed, trial.spurious);
                (FailureKind::EventsWrong, format!("events missed: {missed}, spurious: {spurious}"))
            }
            TrialEnd::Reached => (FailureKind::OutOfReach, format!("e = {:.1e}", trial.e)),
        };
        End::Failure(kind, format!("at {setting}: {what}"))
    }

    /// What was found, with its setting.
    pub(super) fn entry(&self) -> Result<(Setting, Entry), Failure> {
        let Candidate { method, events } = self.candidate;
        let failure = |kind, message: &str, last: Option<&Trial>| Failure {
            method: method.name.to_owned(),
            events,
            implicit: method.is_implicit(),
            kind,
            message: message.to_owned(),
            mean_step_s: last.and_then(|trial| mean_step(trial.covered, &trial.stats)),
        };
        let last = self.trials.get(&self.last);
        let (index, trial) = match &self.verdict {
            Some(Ok(index)) => match self.trials.get(index) {
                Some(trial) => (*index, trial),
                None => return Err(failure(FailureKind::Interrupted, "not run", None)),
            },
            Some(Err((kind, message))) => return Err(failure(*kind, message, last)),
            None => return Err(failure(FailureKind::Interrupted, "not finished", last)),
        };
        let next = self.trials.get(&(index + 1));
        let nudged = self.nudged.get(&index).into_iter().flatten();
        let neighbours = next.into_iter().chain(nudged).map(|trial| trial.e);
        let spread = neighbours.fold([trial.e; 2], |[a, b], e| [a.min(e), b.max(e)]);
        let setting = self.contest.setting(self.candidate, index);
        let growth = self.growth(index, trial);
        let entry = Entry {
            method: method.name.to_owned(),
            events,
            rtol: setting.rtol(),
            step: setting.step(),
            e: trial.e,
            e_spread: spread,
            missed: trial.missed,
            spurious: trial.spurious,
            implicit: method.is_implicit(),
            n_rhs: trial.stats.work.n_rhs,
            n_accepted: trial.stats.n_accepted,
            n_implicit: method.chooses().then_some(trial.stats.n_implicit),
            mean_step_s: mean_step(trial.covered, &trial.stats).unwrap_or(f64::NAN),
            growth,
            bound_by_stability: self.is_bound_by_stability(index, trial, growth),
            work: trial.work,
            wall_s: trial.took.wall.as_secs_f64(),
            cpu_s: Some(trial.took.cpu.as_secs_f64()),
            noise: None,
            grazes: self.grazes(index),
            timed: false,
        };
        Ok((setting, entry))
    }

    /// See [`Entry::growth`].
    fn growth(&self, index: i32, trial: &Trial) -> Option<f64> {
        if self.candidate.method.is_fixed_step() {
            return None;
        }
        let mut tighter = self.trials.range(index + 1..=index + GROWTH_SPAN);
        let (other, far) = tighter.rfind(|(_, trial)| trial.end == TrialEnd::Reached)?;
        let ratio = far.stats.n_accepted as f64 / trial.stats.n_accepted as f64;
        Some(libm::pow(ratio, f64::from(A_DECADE) / f64::from(other - index)))
    }

    /// Whether stability sets the steps: of a method that chooses them, where they depend on the
    /// tolerance less than a quarter as much as accuracy asks, `10^(1/p)` a decade at order p, and are not
    /// [few](FEW_STEPS) a phase; of a fixed step that could be longer, where the error is far below what was asked.
    fn is_bound_by_stability(&self, index: i32, trial: &Trial, growth: Option<f64>) -> bool {
        let (method, benchmark) = (self.candidate.method, self.contest.benchmark);
        if method.is_implicit() {
            return false;
        }
        if method.is_fixed_step() {
            let is_coarsest = index <= *settings::indices(method, benchmark.t_end).start();
            return trial.e < TOO_GOOD * self.contest.accuracy && !is_coarsest;
        }
        let n_phases = benchmark.n_events as u64 + 1;
        let are_many = trial.stats.n_accepted >= FEW_STEPS * n_phases;
        are_many && growth.is_some_and(|growth| growth < libm::exp10(0.25 / method.order as f64))
    }

    /// Whether a setting tighter than the one found has the events wrong.
    fn grazes(&self, index: i32) -> bool {
        let wrong = |trial: &Trial| match trial.end {
            TrialEnd::Reached => !self.accepts_events(trial),
            TrialEnd::Chatters => true,
            _ => false,
        };
        self.trials.range(index + 1..).any(|(_, trial)| wrong(trial))
    }
}

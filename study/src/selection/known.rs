//! The runs that were made on a benchmark: contests at several accuracies look at the same settings.

use std::cell::RefCell;
use std::collections::HashMap;

use super::Candidate;
use super::trial::{Start, Trial, TrialEnd};
use crate::setting::Events;

/// A run: its method, what that does about events, its rung, its start.
type Key = (&'static str, Events, i32, Start);

/// Runs that came to their end.
#[derive(Debug, Default)]
pub(crate) struct Known(RefCell<HashMap<Key, Trial>>);

impl Known {
    /// The run of `candidate` at `rung` from `start`, and whether it had to be made, by `make`.
    pub(super) fn or_make(
        &self,
        candidate: Candidate,
        rung: i32,
        start: Start,
        make: impl FnOnce() -> Trial,
    ) -> (Trial, bool) {
        let key = (candidate.method.name, candidate.events, rung, start);
        if let Some(trial) = self.0.borrow().get(&key) {
            return (trial.clone(), false);
        }
        let trial = make();
        if trial.end == TrialEnd::Reached {
            self.0.borrow_mut().insert(key, trial.clone());
        }
        (trial, true)
    }
}

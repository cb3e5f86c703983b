//! What contests on one benchmark, at smaller and smaller demands, know of each other: they look at the same settings.

use std::cell::RefCell;
use std::collections::HashMap;

use super::Candidate;
use super::trial::{Start, Trial, TrialEnd, TrialLimit};
use crate::setting::Events;

/// A run: its method, what that does about events, the index of its setting, its start.
type Key = (&'static str, Events, i32, Start);

/// What the contests so far on a benchmark found out; they are held from the smallest error to the largest.
#[derive(Debug, Default)]
pub(crate) struct Known {
    /// Each run with the limit that it was made under.
    runs: RefCell<HashMap<Key, (Trial, TrialLimit)>>,
    /// The last setting at which each method, by what it does about events, reached an accuracy.
    reached: RefCell<HashMap<(&'static str, Events), i32>>,
}

impl Known {
    /// The run of `candidate` at the setting `index` from `start` up to `limit`, and whether it had to be made, by `make`: one
    /// that was broken off is made again under a wider limit.
    pub(super) fn or_make(
        &self,
        (candidate, index, start): (Candidate, i32, Start),
        limit: TrialLimit,
        make: impl FnOnce() -> Trial,
    ) -> (Trial, bool) {
        let key = (candidate.method.name, candidate.events, index, start);
        if let Some((trial, own)) = self.runs.borrow().get(&key) {
            let serves = match trial.end {
                TrialEnd::Reached | TrialEnd::Failed(_) | TrialEnd::OutOfTime => true,
                // Not by its course, where it would be judged by that later.
                TrialEnd::Cut => {
                    limit.work <= own.work && (limit.early <= own.early || trial.work > limit.early)
                }
                TrialEnd::Chatters => limit.chatter,
                TrialEnd::Interrupted => false,
            };
            if serves {
                return (trial.clone(), false);
            }
        }
        let trial = make();
        self.runs.borrow_mut().insert(key, (trial.clone(), limit));
        (trial, true)
    }

    /// Keeps that `candidate` reaches an accuracy at the setting with this index.
    pub(super) fn note_reached(&self, candidate: Candidate, index: i32) {
        self.reached.borrow_mut().insert((candidate.method.name, candidate.events), index);
    }

    /// The setting at which `candidate` reached a smaller error, if it did: it reaches a larger one there, too.
    pub(super) fn reached(&self, candidate: Candidate) -> Option<i32> {
        self.reached.borrow().get(&(candidate.method.name, candidate.events)).copied()
    }
}

#[cfg(test)]
mod tests {
    use deltazero_solvers::Method;

    use super::*;

    #[test]
    fn a_run_that_was_broken_off_serves_where_it_would_be_again() {
        let candidate =
            Candidate { method: Method::named("rk45").unwrap(), events: Events::Located };
        let wide = |work| TrialLimit::work(work);
        let narrow = |work| TrialLimit { chatter: true, ..TrialLimit::work(work) };
        let later = |work| TrialLimit { early: work, ..TrialLimit::work(work) };
        for (end, made_under, serves, not) in [
            (TrialEnd::Reached, wide(1e3), vec![wide(1e2), narrow(1e9)], vec![]),
            (TrialEnd::Cut, wide(1e3), vec![wide(1e3), narrow(1e2)], vec![wide(2e3), later(1e3)]),
            (TrialEnd::Chatters, narrow(1e3), vec![narrow(1e9)], vec![wide(1e3)]),
            (TrialEnd::Interrupted, wide(1e3), vec![], vec![wide(1e3)]),
        ] {
            let is_made = |limit, is_asked_before: bool| {
                let known = Known::default();
                let key = (candidate, 3, Start::Exact);
                if is_asked_before {
                    known.or_make(key, made_under, || Trial { end: end.clone(), ..Trial::begun() });
                }
                known.or_make(key, limit, Trial::begun).1
            };
            assert!(serves.iter().all(|limit| !is_made(*limit, true)), "{end:?}");
            assert!(not.iter().all(|limit| is_made(*limit, true)), "{end:?}");
            assert!(is_made(made_under, false));
        }
    }

    #[test]
    fn the_setting_that_a_candidate_reached_last_is_known_of_it_alone() {
        let candidate = |events| Candidate { method: Method::named("rk45").unwrap(), events };
        let [own, other] = [Events::Located, Events::Blind].map(candidate);
        let known = Known::default();
        [7, 5].into_iter().for_each(|index| known.note_reached(own, index));
        assert_eq!([known.reached(own), known.reached(other)], [Some(5), None]);
    }
}

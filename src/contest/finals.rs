//! The finals: those that need little work are timed in turns.

use super::trial::{Start, Trial, TrialEnd};
use super::{Contest, Entry, least};
use crate::run::Setting;

/// Those that take longer than this many times the shortest time, and more than this many times the least
/// work, are not run again: a time alone may be long because the machine was busy just then.
const CLOSE: f64 = 2.0;
/// Those that take longer than this are run twice at most: noise is a smaller part of them [s].
const LONG_S: f64 = 0.2;

/// Times the entries up to `of_note` in work, and puts all in order: the timed ones by their shortest time,
/// then the others by their work. `settings` are those of the entries.
pub(super) fn time(
    contest: &Contest<'_>,
    settings: &[Setting],
    entries: &mut [Entry],
    of_note: f64,
) {
    for entry in entries.iter_mut() {
        entry.timed = entry.work <= of_note;
    }
    let least_work = least_of(entries, |entry| entry.work);
    for turn in 0..contest.repeats {
        let shortest = least_of(entries, |entry| entry.wall_s);
        for (entry, setting) in entries.iter_mut().zip(settings) {
            // The search has run each of them once, but at different times: not to be judged by that.
            let is_slow = entry.wall_s > CLOSE * shortest && entry.work > CLOSE * least_work;
            let is_far = is_slow || entry.wall_s > LONG_S;
            if !entry.timed || turn > 1 && is_far {
                continue;
            }
            let run = Trial::new(contest.arena, setting, Start::Exact, f64::INFINITY, contest.stop);
            if run.end == TrialEnd::Reached {
                entry.wall_s = entry.wall_s.min(run.wall_s);
            }
        }
    }
    entries.sort_by(|a, b| {
        let by_cost =
            if a.timed { a.wall_s.total_cmp(&b.wall_s) } else { a.work.total_cmp(&b.work) };
        b.timed.cmp(&a.timed).then(by_cost)
    });
}

/// The least `of` those that are timed.
fn least_of(entries: &[Entry], of: impl Fn(&Entry) -> f64) -> f64 {
    least(entries.iter().filter(|entry| entry.timed).map(of))
}

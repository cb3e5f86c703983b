//! The finals: those that need little work are timed in turns.

use super::trial::{Start, Trial, TrialEnd};
use super::{Contest, Entry};
use crate::run::Setting;

/// Those that take longer than this many times the shortest time are not run again.
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
    for turn in 0..contest.repeats {
        let best = shortest(entries);
        for (entry, setting) in entries.iter_mut().zip(settings) {
            // The search has run each of them once, but at different times: not to be judged by that.
            let is_far = entry.wall_s > CLOSE * best || entry.wall_s > LONG_S;
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

/// The shortest time so far of those that are timed [s].
fn shortest(entries: &[Entry]) -> f64 {
    let timed = entries.iter().filter(|entry| entry.timed);
    timed.fold(f64::INFINITY, |least, entry| least.min(entry.wall_s))
}

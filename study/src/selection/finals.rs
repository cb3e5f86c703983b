//! The finals: those that need little work are timed in turns.

use super::{Contest, Entry, least};
use crate::part::Timing;
use crate::quantile::quantile;
use crate::run::Setting;

/// Those that take longer than this many times the shortest time, and more than this many times the least
/// work, are run twice at most: a time alone may be long because the machine was busy just then.
const CLOSE: f64 = 2.0;
/// Those that take longer than this are run twice at most: noise is a smaller part of them [s].
const LONG_S: f64 = 0.2;

/// Times the entries whose work is at most `timing_limit`, and puts all in order: the timed ones by their shortest time of the
/// processor, then the others by their work. `settings` are those of the entries.
pub(super) fn time(
    contest: &Contest<'_>,
    settings: &[Setting],
    entries: &mut [Entry],
    timing_limit: f64,
) {
    for entry in entries.iter_mut() {
        entry.timed = entry.work <= timing_limit;
    }
    let least_work = least_of(entries, |entry| entry.work);
    let mut turns: Vec<Vec<f64>> = vec![Vec::new(); entries.len()];
    for turn in 0..contest.rules.repeats {
        let shortest = least_of(entries, Entry::time_s);
        for ((entry, setting), own) in entries.iter_mut().zip(settings).zip(&mut turns) {
            // The search has run each of them once, but at different times: not to be judged by that.
            let is_slow = entry.time_s() > CLOSE * shortest && entry.work > CLOSE * least_work;
            let is_far = is_slow || entry.time_s() > LONG_S;
            if !entry.timed || turn > 1 && is_far {
                continue;
            }
            if let Some(Timing { took, .. }) = contest.benchmark.took(setting, contest.stop) {
                let [wall, cpu] = [took.wall, took.cpu].map(|time| time.as_secs_f64());
                // The search ran its parts one after the other: its time is not one of these.
                let is_first = own.is_empty();
                let least = |known: f64, time: f64| if is_first { time } else { known.min(time) };
                entry.wall_s = least(entry.wall_s, wall);
                entry.cpu_s = entry.cpu_s.map(|known| least(known, cpu));
                own.push(cpu);
            }
        }
    }
    for (entry, own) in entries.iter_mut().zip(&mut turns) {
        let median = quantile(own, 0.5);
        entry.noise = median.map(|median| (median / entry.time_s()).max(1.0));
    }
    entries.sort_by(|a, b| {
        let by_cost =
            if a.timed { a.time_s().total_cmp(&b.time_s()) } else { a.work.total_cmp(&b.work) };
        b.timed.cmp(&a.timed).then(by_cost)
    });
}

/// The least `of` those that are timed.
fn least_of(entries: &[Entry], of: impl Fn(&Entry) -> f64) -> f64 {
    least(entries.iter().filter(|entry| entry.timed).map(of))
}

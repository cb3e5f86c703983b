//! The stopwatch: the minimum of many repeats, in rounds, so that a disturbance meets few of them.

use std::error::Error;
use std::time::{Duration, Instant};

use rustix::time::{ClockId, clock_gettime};

use crate::entry::{Entry, Label};
use crate::problem::{Problem, Track};
use crate::row::{Build, Outcome, Row, Times};

/// How long to measure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Time spent on one run in one round.
    pub(crate) per_run: Duration,
    /// Rounds over all runs.
    pub(crate) rounds: u32,
    /// A run longer than this is the last of its ladder.
    pub(crate) longest: Duration,
}

impl Effort {
    /// Time spent on one run in all rounds.
    pub(crate) fn budget(&self) -> Duration {
        self.per_run * self.rounds
    }
}

/// Measures every entry, ladder after ladder from the loosest tolerance on.
pub(crate) fn measure(problem: &Problem, entries: &[Entry<'_>], effort: Effort) -> Vec<Row> {
    let mut rows: Vec<(Row, &Entry<'_>)> = Vec::new();
    let mut ended: Option<&Label> = None;
    for entry in entries {
        if ended.is_some_and(|last| last.same_ladder(&entry.label)) {
            continue;
        }
        let start = cpu_ms();
        let outcome = first(problem, entry);
        if cpu_ms() - start > 1e3 * effort.longest.as_secs_f64() {
            ended = Some(&entry.label);
        }
        rows.push((Row { label: entry.label.clone(), build: Build::own(), outcome }, entry));
    }
    for _ in 0..effort.rounds {
        for (row, entry) in &mut rows {
            if let Ok(outcome) = &mut row.outcome {
                repeat(entry, effort.per_run, outcome);
            }
        }
    }
    rows.into_iter().map(|(row, _)| row).collect()
}

/// The first run, judged.
fn first(problem: &Problem, entry: &Entry<'_>) -> Result<Outcome, String> {
    let (delivered, times) = timed(entry);
    let mut delivered = delivered.map_err(|error| error.to_string())?;
    if let Some(see_events) = &entry.see_events {
        let seen = see_events().map_err(|error| error.to_string())?;
        for (track, seen) in delivered.iter_mut().zip(seen) {
            track.events = seen.events;
        }
    }
    judged(problem, &delivered, times, 1)
}

/// A delivery and its times, judged.
pub(crate) fn judged(
    problem: &Problem,
    delivered: &[Track; 2],
    times: Times,
    repeats: u32,
) -> Result<Outcome, String> {
    let verdict = problem.judge(delivered).map_err(|error| error.to_string())?;
    let n_rhs = delivered[0].n_rhs.zip(delivered[1].n_rhs).map(|(one, two)| one + two);
    Ok(Outcome { verdict, n_rhs, times, repeats })
}

/// Repeats a run for `per_run` on the processor.
fn repeat(entry: &Entry<'_>, per_run: Duration, outcome: &mut Outcome) {
    let mut left_ms = 1e3 * per_run.as_secs_f64();
    // A run that does not fit twice is not worth waiting for in every round.
    while left_ms > 0.5 * outcome.times.cpu_ms {
        let (run, times) = timed(entry);
        left_ms -= times.cpu_ms;
        if run.is_err() {
            return;
        }
        outcome.times = outcome.times.least(times);
        outcome.repeats += 1;
    }
}

fn timed(entry: &Entry<'_>) -> (Delivery, Times) {
    let (wall, cpu) = (Instant::now(), cpu_ms());
    let run = (entry.run)();
    (run, Times { wall_ms: 1e3 * wall.elapsed().as_secs_f64(), cpu_ms: cpu_ms() - cpu })
}

/// What a run returns.
type Delivery = Result<[Track; 2], Box<dyn Error>>;

/// Time of this thread on the processor [ms].
fn cpu_ms() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    1e3 * time.tv_sec as f64 + 1e-6 * time.tv_nsec as f64
}

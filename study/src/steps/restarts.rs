//! What does a restart cost: which steps follow an event?

use std::collections::HashSet;

use serde::{Deserialize, Serialize};

use super::step_size::{StepHistory, StepRow};
use crate::quantile::quantile;

/// Steps after an event that are looked at.
pub const FIRST: usize = 10;
/// Part of the settled step with which a method has recovered.
const RECOVERED: f64 = 0.5;

/// The steps with one number after the events of one method; all parts together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RestartRow {
    /// Method.
    pub method: String,
    /// Tolerance or step as text.
    pub setting: String,
    /// Whether the event led into contact, or from one contact mode to another; else into flight.
    pub into_contact: bool,
    /// What the event led into: contact, flight, or the mode by its name.
    pub mode: String,
    /// Number of the step after the event, from 1.
    pub step: usize,
    /// Such steps, those that land on the next event left out: their size is not the method's choice.
    pub n: usize,
    /// First quartile, median and third quartile of their sizes [s].
    pub h_s: [f64; 3],
    /// The same of their sizes over the [settled](RestartCost::settled_s) one of their part.
    pub h_over_settled: [f64; 3],
    /// Steps rejected before them.
    pub n_rejected: u64,
}

/// What events cost one method; all parts together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RestartCost {
    /// Method.
    pub method: String,
    /// Tolerance or step as text.
    pub setting: String,
    /// Events.
    pub n_events: usize,
    /// Settled step size of each part: median of the steps more than ten after a restart [s].
    pub settled_s: Vec<Option<f64>>,
    /// Steps after an event before one has at least half the settled size; median over the events
    /// after which one has, before the next.
    pub recovery_steps: Option<f64>,
    /// By how many settled steps those steps fall short, `Σ (1 − h/h_settled)`; median over the same.
    pub lost_steps: Option<f64>,
    /// Rejected steps an event, within ten steps after it.
    pub rejected: f64,
    /// Right-hand sides to begin a phase.
    pub rhs_restart: f64,
    /// Right-hand sides to locate an event.
    pub rhs_location: f64,
    /// Right-hand sides a step, accepted or rejected, without restarts and location.
    pub rhs_step: f64,
}

impl RestartCost {
    /// What an event costs in right-hand sides: restart, location, steps lost and rejected.
    pub fn rhs_event(&self) -> f64 {
        let steps = self.lost_steps.unwrap_or(0.0) + self.rejected;
        self.rhs_restart + self.rhs_location + steps * self.rhs_step
    }
}

/// The histories of each method, in their order.
fn by_method(histories: &[StepHistory]) -> Vec<Vec<&StepHistory>> {
    let mut methods: Vec<Vec<&StepHistory>> = Vec::new();
    for history in histories {
        let own = |known: &&mut Vec<&StepHistory>| known[0].method == history.method;
        match methods.iter_mut().find(own) {
            Some(known) => known.push(history),
            None => methods.push(vec![history]),
        }
    }
    methods
}

/// The phases that begin with an event, each with all its steps.
fn restarted(history: &StepHistory) -> impl Iterator<Item = &[StepRow]> {
    history.steps.chunk_by(|_, next| next.since_restart > 1).skip(1)
}

fn settled(history: &StepHistory) -> Option<f64> {
    let late = |step: &&StepRow| step.since_restart > FIRST && !step.lands;
    let mut sizes: Vec<f64> = history.steps.iter().filter(late).map(|step| step.h_s).collect();
    quantile(&mut sizes, 0.5)
}

/// What events may lead into, in the order of figures.
fn stay_names<'a>(own: &[&'a StepHistory]) -> Vec<&'a str> {
    let Some(first) = own.first().filter(|first| !first.modes.is_empty()) else {
        return vec!["contact", "flight"];
    };
    let steps = own.iter().flat_map(|history| &history.steps);
    let taken: HashSet<usize> = steps.map(|step| usize::from(step.mode_number)).collect();
    let names = first.modes.iter().enumerate().filter(|(i, _)| taken.contains(i));
    names.map(|(_, name)| name.as_str()).collect()
}

/// The first ten steps after each event, step by step, after events into contact and into flight, or into each mode.
pub fn restarts(histories: &[StepHistory]) -> Vec<RestartRow> {
    let mut rows = Vec::new();
    for own in by_method(histories) {
        let names = stay_names(&own);
        for (mode, step) in names.iter().flat_map(|name| (1..=FIRST).map(move |i| (*name, i))) {
            let (mut sizes, mut ratios, mut n_rejected) = (Vec::new(), Vec::new(), 0);
            let mut into_contact = false;
            for history in &own {
                let Some(settled) = settled(history) else { continue };
                for phase in restarted(history) {
                    let Some(row) = phase.get(step - 1) else { continue };
                    if history.stay_name(row) != mode {
                        continue;
                    }
                    into_contact = row.kind().is_contact();
                    n_rejected += row.n_rejected;
                    if !row.lands {
                        sizes.push(row.h_s);
                        ratios.push(row.h_s / settled);
                    }
                }
            }
            if sizes.is_empty() {
                continue;
            }
            rows.push(RestartRow {
                method: own[0].method.clone(),
                setting: own[0].setting.clone(),
                into_contact,
                mode: mode.to_owned(),
                step,
                n: sizes.len(),
                h_s: quartiles(&mut sizes),
                h_over_settled: quartiles(&mut ratios),
                n_rejected,
            });
        }
    }
    rows
}

/// What an event costs each method; a method without events is left out.
pub fn restart_costs(histories: &[StepHistory]) -> Vec<RestartCost> {
    let has_events = |own: &&Vec<&StepHistory>| own.iter().any(|own| !own.events.is_empty());
    by_method(histories).iter().filter(has_events).map(|own| restart_cost(own)).collect()
}

/// The steps of a phase before one has recovered, and by how many settled ones they fall short; none
/// where the next event or the end comes first.
fn recovery(phase: &[StepRow], settled: f64) -> Option<(usize, f64)> {
    let count = phase.iter().position(|step| step.h_s >= RECOVERED * settled)?;
    let short = phase[..count].iter().fold(0.0, |sum, step| sum + 1.0 - step.h_s / settled);
    Some((count, short))
}

fn restart_cost(own: &[&StepHistory]) -> RestartCost {
    let (mut counts, mut lost) = (Vec::new(), Vec::new());
    let (mut n_rejected, mut n_attempts) = (0, 0);
    for history in own {
        for phase in restarted(history) {
            let first = &phase[..FIRST.min(phase.len())];
            n_rejected += first.iter().map(|step| step.n_rejected).sum::<u64>();
            let settled = settled(history);
            if let Some((count, short)) = settled.and_then(|settled| recovery(phase, settled)) {
                counts.push(count as f64);
                lost.push(short);
            }
        }
        n_attempts += history.steps.iter().map(|step| 1 + step.n_rejected).sum::<u64>();
    }
    let sum = |count: fn(&StepHistory) -> u64| own.iter().map(|own| count(own)).sum::<u64>() as f64;
    let (restart, location) = (sum(|own| own.n_rhs_restart), sum(|own| own.n_rhs_location));
    let n_events = own.iter().map(|own| own.events.len()).sum::<usize>();
    let an_event = |n: f64| n / n_events as f64;
    RestartCost {
        method: own[0].method.clone(),
        setting: own[0].setting.clone(),
        n_events,
        settled_s: own.iter().map(|own| settled(own)).collect(),
        recovery_steps: quantile(&mut counts, 0.5),
        lost_steps: quantile(&mut lost, 0.5),
        rejected: an_event(n_rejected as f64),
        // Each run has one phase more than events.
        rhs_restart: restart / (n_events + own.len()) as f64,
        rhs_location: an_event(location),
        rhs_step: (sum(|own| own.n_rhs) - restart - location) / n_attempts.max(1) as f64,
    }
}

fn quartiles(values: &mut [f64]) -> [f64; 3] {
    [0.25, 0.5, 0.75].map(|fraction| quantile(values, fraction).unwrap_or(f64::NAN))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A phase to its landing, then steps that double up to the settled size of one second.
    fn history() -> StepHistory {
        let sizes = [1.0, 0.3, 0.125, 0.25, 0.5, 1.0];
        let row = |i: usize| StepRow {
            t_s: i as f64,
            h_s: *sizes.get(i).unwrap_or(&1.0),
            mode: if i < 2 { 0 } else { 1 },
            mode_number: 0,
            since_restart: if i < 2 { i + 1 } else { i - 1 },
            n_rejected: u64::from(i == 3),
            lands: i == 1,
        };
        StepHistory {
            method: "any".into(),
            setting: String::new(),
            e: 0.0,
            part: 1,
            name: String::new(),
            n_sites: 1,
            modes: Vec::new(),
            steps: (0..40).map(row).collect(),
            events: vec![2.0],
            n_rhs: 41 * 4 + 5,
            n_rhs_restart: 2,
            n_rhs_location: 3,
        }
    }

    #[test]
    fn steps_that_double_after_an_event_lose_what_they_fall_short_of_the_settled_one() {
        let cost = &restart_costs(&[history()])[0];
        assert_eq!(cost.settled_s, [Some(1.0)]);
        assert_eq!(cost.recovery_steps, Some(2.0));
        assert_eq!(cost.lost_steps, Some(0.875 + 0.75));
        assert_eq!((cost.rejected, cost.rhs_restart, cost.rhs_location), (1.0, 1.0, 3.0));
        // 40 accepted and one rejected step share what neither began nor located.
        assert_eq!(cost.rhs_step, 4.0);
        assert_eq!(cost.rhs_event(), 4.0 + (1.625 + 1.0) * 4.0);
    }

    #[test]
    fn the_first_steps_after_an_event_are_told_by_their_number() {
        let rows = restarts(&[history()]);
        assert!(rows.iter().all(|row| row.into_contact && row.n == 1));
        let medians: Vec<f64> = rows.iter().map(|row| row.h_over_settled[1]).collect();
        assert_eq!(medians, [0.125, 0.25, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
        let rejected: Vec<u64> = rows.iter().map(|row| row.n_rejected).collect();
        assert_eq!(rejected, [0, 1, 0, 0, 0, 0, 0, 0, 0, 0]);
    }
}

//! A thousand hybrid systems drawn at random, whose events are known exactly: with every method none
//! is missed, none is made up and none is out of order.
//!
//! In each mode the flow is linear and the guards are planes, so [`oracle`] needs no integrator and no
//! root finder of ours. Draws whose events an error of the run could change are set aside and counted.

// Helpers are not marked as tests.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

#[path = "../common/mod.rs"]
mod common;
mod draw;
mod found;
mod oracle;
mod search;

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use common::{at_most, tolerance};
use deltazero_solvers::{
    Accepted, Control, Event, Integration, METHODS, Method, Next, Outcome, Record,
};
use draw::{Drawn, T_END};
use oracle::{Exact, Reason};

/// Draw number `i` is made of `SEED + i`.
const SEED: u64 = 0xde17a;
/// Systems for each method.
const N: usize = 1000;

/// A drawn system whose events can be told.
struct Kept {
    index: u64,
    system: Drawn,
    events: Vec<Exact>,
}

/// The first [`N`] systems whose events an error of `error`, made at the start, does not change.
fn kept(error: f64) -> Vec<Kept> {
    let mut kept = Vec::new();
    let mut aside: BTreeMap<Reason, usize> = BTreeMap::new();
    let mut index = 0;
    while kept.len() < N {
        let system = Drawn::number(index, SEED);
        match oracle::events(&system, error) {
            Ok(events) => kept.push(Kept { index, system, events }),
            Err(reason) => *aside.entry(reason).or_default() += 1,
        }
        index += 1;
    }
    let n_events: usize = kept.iter().map(|kept| kept.events.len()).sum();
    println!("{N} of {index} kept, with {n_events} events; set aside: {aside:?}");
    kept
}

/// The events of a run, and the step that was being taken at each.
#[derive(Default)]
struct Log {
    /// Time, guard, mode before and after.
    events: Vec<(f64, usize, usize, usize)>,
    /// Start of the step that landed on each, and the size of the last full step before it.
    steps: Vec<(f64, f64)>,
    t0: f64,
    full: f64,
}

impl Record<Drawn> for Log {
    fn step(&mut self, accepted: &Accepted<'_, Drawn>) -> ControlFlow<()> {
        self.t0 = accepted.step.t0();
        if accepted.landed_on.is_none() {
            self.full = accepted.step.t1() - self.t0;
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<'_, Drawn>) -> ControlFlow<()> {
        let Next::Mode(after) = event.after else { unreachable!("no guard stops a run") };
        self.events.push((event.t, event.guard, event.before, after));
        self.steps.push((self.t0, self.full));
        ControlFlow::Continue(())
    }
}

/// What is wrong with the run that `log` shows, if anything.
fn fault(log: &Log, exact: &[Exact]) -> Option<String> {
    for (i, found) in log.events.iter().enumerate() {
        let Some(exact) = exact.get(i) else { return Some(format!("made up {found:?}")) };
        if (found.1, found.2, found.3) != (exact.guard, exact.before, exact.after) {
            return Some(format!("event {i} is {found:?} for {exact:?}"));
        }
    }
    exact.get(log.events.len()).map(|exact| format!("missed {exact:?}"))
}

/// Asserts that `method` finds the events of all systems in `kept`, their times to `bound`; how many of
/// their guards would rise again within the step that they fall in, so that the search alone finds them.
fn check(kept: &[Kept], method: &Method, control: impl Fn(&Drawn) -> Control, bound: f64) -> usize {
    let (mut faults, mut late, mut n_short) = (Vec::new(), 0.0_f64, 0);
    for Kept { index, system, events } in kept {
        let mut log = Log::default();
        let mut integration = Integration::new(system, 0.0, system.start);
        let mut solver = method.solver(system, control(system)).unwrap();
        let outcome = integration.run(T_END, &mut *solver, &mut log);
        let wrong = fault(&log, events)
            .or_else(|| (outcome != Ok(Outcome::Finished)).then(|| "events right".to_owned()));
        if let Some(wrong) = wrong {
            faults.push(format!("seed {SEED:#x}, index {index}: {wrong}; {outcome:?}"));
            continue;
        }
        for ((found, (t0, h)), exact) in log.events.iter().zip(&log.steps).zip(events) {
            late = late.max((found.0 - exact.t).abs());
            n_short += usize::from(t0 + h > exact.t + exact.excursion);
        }
    }
    assert!(faults.is_empty(), "{}: {} faults:\n{}", method.name, faults.len(), faults.join("\n"));
    println!("{}: {n_short} excursions within one step", method.name);
    at_most(method.name, late, bound);
    n_short
}

#[test]
fn no_event_is_missed_made_up_or_out_of_order_at_1e_8() {
    // The error of a run may be worth a hundred tolerances of its start.
    let kept = kept(1e-6);
    for method in METHODS.iter().filter(|method| !method.is_fixed_step()) {
        // Measured: 2.3e-4 for tr_bdf2, 2.1e-4 for esdirk34, 2.5e-5 for bs32; 9.2e-5 for bdf, 2.9e-6 for
        // rk45, 9.6e-7 for tsit45, 5.9e-8 for dop853.
        let bound = if method.order < 5 { 2e-3 } else { 9e-4 };
        let n_short = check(&kept, method, |_| tolerance(1e-8), bound);
        // Measured: 377 for dop853; 61 for tsit45, 54 for rk45, 9 for bdf, none below order 5.
        assert!(method.order < 6 || n_short > 40, "{}: {n_short}", method.name);
    }
}

#[test]
fn none_is_in_the_large_steps_of_high_orders_at_1e_5() {
    let kept = kept(1e-5);
    for method in METHODS.iter().filter(|method| method.order > 5) {
        // Measured: 1.0e-4 and 543 for dop853.
        let n_short = check(&kept, method, |_| tolerance(1e-5), 1e-3);
        assert!(n_short > 60, "{}: {n_short}", method.name);
    }
}

#[test]
fn none_is_at_fixed_steps_of_a_fiftieth_of_a_radian() {
    let kept = kept(1e-6);
    for method in METHODS.iter().filter(|method| method.is_fixed_step()) {
        let control = |system: &Drawn| {
            let rate = system.modes.iter().map(|mode| mode.flow.rate()).fold(0.5, f64::max);
            Control::Fixed(0.02 / rate)
        };
        // Measured: 4.3e-7 for rk4.
        check(&kept, method, control, 4e-6);
    }
}

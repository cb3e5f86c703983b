//! What the guards are at the start of a run.

use deltazero_solvers::{METHODS, Outcome};

use crate::common::{at_most, steps_itself, tolerance};
use crate::log::{Setting, run, settings};
use crate::script::{Script, chain, expect_events, guard, unused};

#[test]
fn a_start_on_the_surface_going_in_gives_no_event() {
    expect_events(&chain(&[&[0.0, 1.0]]), 2.0, &[]);
}

#[test]
fn a_start_on_the_surface_going_out_gives_one_event_there() {
    expect_events(&chain(&[&[0.0, -1.0]]), 2.0, &[0.0]);
}

#[test]
fn a_guard_violated_at_the_start_switches_before_the_first_step() {
    let script = chain(&[&[-1.0, 0.0], &[-1.0, 1e-3], &[1.0, 0.0]]);
    expect_events(&script, 2.0, &[0.0, 0.0]);
    for setting in settings() {
        let (log, ..) = run(&script, &setting, (0.0, [0.0, 0.0]), 2.0);
        assert!(log.events.iter().all(|event| event.4 == 0 && event.0 == 0.0));
    }
}

/// Rounding bound of the guard `z − 1` near z = 1.
const BOUND: f64 = 16.0 * f64::EPSILON;

#[test]
fn a_guard_below_zero_within_its_rounding_bound_holds() {
    let surface = vec![guard(&[-1.0], 1.0, 1)];
    let script = Script { rate: vec![vec![]; 2], guards: vec![surface, vec![unused()]] };
    for (depth, n) in [(0.5 * BOUND, 0), (2.0 * BOUND, 1)] {
        for setting in settings() {
            let (log, outcome, ..) = run(&script, &setting, (0.0, [0.0, 1.0 - depth]), 2.0);
            assert_eq!(
                (outcome, log.events.len()),
                (Ok(Outcome::Finished), n),
                "{}",
                setting.0.name
            );
        }
    }
}

/// `z = 1 + a xⁿ`, guarded by `z − 1`: on the surface at the start, with n − 1 rates of zero. Once
/// it is the state that moves, once the surface.
fn lift_offs(a: f64, n: usize) -> [Script; 2] {
    let (mut rate, mut surface) = (vec![0.0; n], vec![0.0; n + 1]);
    (rate[n - 1], surface[0], surface[n]) = (a * n as f64, -1.0, a);
    [(rate, vec![-1.0]), (vec![], surface)].map(|(rate, surface)| Script {
        rate: vec![rate.clone(), rate],
        guards: vec![vec![guard(&surface, 1.0, 1)], vec![unused()]],
    })
}

/// What the start of `script` gives with `setting`: the event times until t = 2.
fn events_of(script: &Script, setting: &Setting) -> Vec<f64> {
    let (log, outcome, t, _) = run(script, setting, (0.0, [0.0, 1.0]), 2.0);
    assert_eq!((outcome, t), (Ok(Outcome::Finished), 2.0), "{}", setting.0.name);
    log.times()
}

/// No event for `+xⁿ`.
fn expect_a_rise(n: usize, setting: &Setting) {
    for script in lift_offs(1.0, n) {
        let times = events_of(&script, setting);
        assert!(times.is_empty(), "{} with n = {n}: {times:?}", setting.0.name);
    }
}

/// One event for `−xⁿ`, not after where it reaches the rounding bound; the methods that land on their
/// interpolant promise no more than their tolerance, here 1e-8.
fn expect_a_fall(n: usize, setting: &Setting) {
    let name = setting.0.name;
    for script in lift_offs(-1.0, n) {
        let times = events_of(&script, setting);
        assert_eq!(times.len(), 1, "{name} with n = {n}: {times:?}");
        // Measured: 2.6e-15, for esdirk34 with n = 4 1.4e-10.
        let depth = if steps_itself(setting.0, &script) { 1e-9 } else { BOUND };
        at_most(name, times[0].powi(n as i32), depth);
    }
}

#[test]
fn a_start_on_the_surface_rising_at_second_order_gives_no_event() {
    settings().iter().for_each(|setting| expect_a_rise(2, setting));
}

#[test]
fn a_start_on_the_surface_rising_at_fourth_order_gives_no_event() {
    settings().iter().for_each(|setting| expect_a_rise(4, setting));
}

#[test]
fn a_start_on_the_surface_rising_at_any_order_gives_no_event() {
    for n in 3..9 {
        settings().iter().for_each(|setting| expect_a_rise(n, setting));
        for rtol in [1e-4, 1e-6, 1e-10] {
            let adaptive = METHODS.iter().filter(|method| !method.is_fixed_step());
            adaptive.for_each(|method| expect_a_rise(n, &(method, tolerance(rtol))));
        }
    }
}

#[test]
fn a_start_on_the_surface_falling_at_second_order_gives_one_event_near_it() {
    settings().iter().for_each(|setting| expect_a_fall(2, setting));
}

#[test]
fn a_start_on_the_surface_falling_at_fourth_order_gives_one_event_near_it() {
    settings().iter().for_each(|setting| expect_a_fall(4, setting));
}

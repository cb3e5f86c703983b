//! Transitions that change the state, and what the guards are after them.

use deltazero_solvers::problems::BouncingBall;
use deltazero_solvers::{Error, Next, Outcome};

use crate::common::{at_most, steps_itself};
use crate::log::{ROUNDING, run, settings};
use crate::script::{Script, chain, expect_events, floor, unused};

#[test]
fn a_reset_does_not_trigger_its_guard_again() {
    let ball = BouncingBall { restitution: 0.8, gravity: 9.8, height: 1.0 };
    for setting in settings() {
        let name = setting.0.name;
        let (log, outcome, t, y) = run(&ball, &setting, (0.0, ball.start()), 3.0);
        assert_eq!((outcome, t), (Ok(Outcome::Finished), 3.0), "{name}");
        let times = log.times();
        assert!(ball.bounce_time(times.len()) > 3.0, "{name}: {times:?}");
        for (n, t) in times.iter().enumerate() {
            // Measured: 1.7e-14 s, for bdf 5.5e-9 s at rtol 1e-8.
            let bound = if steps_itself(setting.0, &ball) { 5e-8 } else { 1e-13 };
            at_most(name, (t - ball.bounce_time(n)).abs(), bound);
        }
        // Measured: 1.9e-13, for bdf 6.3e-8.
        let bound = if steps_itself(setting.0, &ball) { 5e-7 } else { 1e-12 };
        let exact = ball.state(3.0);
        at_most("state", (y[0] - exact[0]).abs().max((y[1] - exact[1]).abs()), bound);
    }
}

/// z falls to the surface at x = 0.5, where it is set to `z` and goes on in mode 1 at `rate`, under
/// a guard that is z again, set to 1 and left alone when it falls.
fn falls_then(z: f64, rate: f64) -> Script {
    Script {
        rate: vec![vec![-1.0], vec![rate], vec![]],
        guards: vec![vec![floor(1, z)], vec![floor(2, 1.0)], vec![unused()]],
    }
}

/// The event times of `script` from z = 0.5 with every method must be `n` times 0.5; with the same
/// time to the bit where `at_once`.
fn expect_at_half(script: &Script, n: usize, at_once: bool) {
    for setting in settings() {
        let name = setting.0.name;
        let (log, outcome, t, _) = run(script, &setting, (0.0, [0.0, 0.5]), 2.0);
        assert_eq!((outcome, t), (Ok(Outcome::Finished), 2.0), "{name}");
        let times = log.times();
        assert_eq!(times.len(), n, "{name}: {times:?}");
        // Measured: 5.9e-15 (tsit45); the second one 1.1e-16 after the first.
        at_most(name, (times[0] - 0.5).abs(), 5e-14);
        at_most(name, times[n - 1] - times[0], if at_once { 0.0 } else { f64::EPSILON });
    }
}

#[test]
fn a_reset_that_leaves_the_new_guard_violated_switches_again_at_once() {
    expect_at_half(&falls_then(-1.0, 0.0), 2, true);
    expect_at_half(&falls_then(-1.0, 1.0), 2, true);
}

#[test]
fn a_reset_onto_the_surface_going_out_switches_again_within_rounding() {
    expect_at_half(&falls_then(0.0, -1.0), 2, false);
}

#[test]
fn a_reset_onto_the_surface_staying_or_going_in_gives_no_second_event() {
    expect_at_half(&falls_then(0.0, 0.0), 1, true);
    expect_at_half(&falls_then(0.0, 1.0), 1, true);
}

#[test]
fn a_reset_that_violates_its_own_guard_for_ever_is_chatter() {
    let mut script = falls_then(-1.0, -1.0);
    script.guards[0][0].next = Next::Mode(0);
    for setting in settings() {
        let name = setting.0.name;
        let (log, outcome, at, _) = run(&script, &setting, (0.0, [0.0, 0.5]), 2.0);
        let cure = match outcome {
            Err(Error::Chatter { t, n: 16, guard: 0, cure, .. }) if t == at => cure,
            other => panic!("{name}: {other:?}"),
        };
        assert!(cure.contains("put the state on the surface"), "{name}: {cure}");
        assert!((at - 0.5).abs() < ROUNDING && log.events.len() == 16, "{name}: {at}");
    }
}

#[test]
fn a_reset_onto_the_surface_going_out_for_ever_is_an_error_and_not_a_hang() {
    let mut script = falls_then(0.0, -1.0);
    script.guards[0][0].next = Next::Mode(0);
    for setting in settings() {
        let name = setting.0.name;
        let (_, outcome, at, _) = run(&script, &setting, (0.0, [0.0, 0.5]), 2.0);
        let expected = matches!(outcome, Err(Error::Chatter { .. } | Error::EventStorm { .. }));
        assert!(expected && (at - 0.5).abs() < ROUNDING, "{name}: {outcome:?} at {at}");
    }
}

#[test]
fn a_guard_that_jumps_at_a_switch_is_judged_by_its_new_value() {
    // At x = 0.7 the new mode's guard is p(0.7): 0.3 and falling, 1.7 and rising, −0.3 and rising.
    let jumps = |p: &[f64]| chain(&[&[0.7, -1.0], p]);
    expect_events(&jumps(&[1.0, -1.0]), 2.0, &[0.7, 1.0]);
    expect_events(&jumps(&[1.0, 1.0]), 2.0, &[0.7]);
    expect_events(&jumps(&[-1.0, 1.0]), 2.0, &[0.7, 0.7]);
    for setting in settings() {
        let (log, ..) = run(&jumps(&[-1.0, 1.0]), &setting, (0.0, [0.0; 2]), 2.0);
        assert_eq!(log.times()[0], log.times()[1], "{}", setting.0.name);
    }
}

//! Guards that fall at one time, or almost.

use deltazero_solvers::{Next, Outcome};

use crate::log::{ROUNDING, run, settings};
use crate::script::{Guard, Script, chain, expect_events, floor, guard, unused};

#[test]
fn two_guards_at_one_instant_switch_one_after_the_other() {
    // The second one is a thousand times as steep, so it is violated where the first one lands.
    let mode = |next| vec![guard(&[0.7, -1.0], 0.0, next), guard(&[700.0, -1e3], 0.0, 2)];
    let script = Script {
        rate: vec![vec![]; 3],
        guards: vec![mode(1), vec![unused(), mode(0)[1].clone()], vec![unused(), unused()]],
    };
    for setting in settings() {
        let (log, outcome, ..) = run(&script, &setting, (0.0, [0.0, 0.0]), 2.0);
        assert_eq!(outcome, Ok(Outcome::Finished));
        let times = log.times();
        let modes: Vec<_> = log.events.iter().map(|event| event.3).collect();
        assert_eq!(*modes.last().unwrap(), Next::Mode(2), "{modes:?}");
        assert!(modes.len() <= 2 && times.iter().all(|t| (t - 0.7).abs() < ROUNDING), "{times:?}");
    }
}

#[test]
fn two_very_close_events_keep_their_order() {
    let close = 0.7 + 1e-9;
    expect_events(&chain(&[&[0.7, -1.0], &[close, -1.0]]), 2.0, &[0.7, close]);
    // Both guards of one mode; the one numbered first falls last.
    let script = Script {
        rate: vec![vec![]; 3],
        guards: vec![
            vec![guard(&[close, -1.0], 0.0, 2), guard(&[0.7, -1.0], 0.0, 1)],
            vec![guard(&[close, -1.0], 0.0, 2), unused()],
            vec![unused(), unused()],
        ],
    };
    expect_events(&script, 2.0, &[0.7, close]);
}

#[test]
fn two_guards_within_the_location_tolerance_both_switch_once() {
    // Mode 1: guard 0 has switched; mode 2: guard 1 has; mode 3: both have.
    for n_ulps in 0..8 {
        let later = 0.7 + f64::from(n_ulps) * 0.5 * f64::EPSILON;
        for (first, second) in [(0.7, later), (later, 0.7)] {
            let lines = |a, b| vec![guard(&[first, -1.0], 0.0, a), guard(&[second, -1.0], 0.0, b)];
            let mut guards = vec![lines(1, 2), lines(1, 3), lines(3, 2), vec![unused(), unused()]];
            guards[1][0] = unused();
            guards[2][1] = unused();
            let script = Script { rate: vec![vec![]; 4], guards };
            for setting in settings() {
                let name = setting.0.name;
                let (log, outcome, ..) = run(&script, &setting, (0.0, [0.0; 2]), 2.0);
                assert_eq!(outcome, Ok(Outcome::Finished), "{name}");
                let mut fallen = log.guards();
                fallen.sort_unstable();
                assert_eq!(fallen, [0, 1], "{name}: {:?}", log.events);
                assert_eq!(log.events[1].3, Next::Mode(3), "{name}");
                let times = log.times();
                assert!(times[0] <= times[1], "{name}: {times:?}");
                assert!(times.iter().all(|t| (t - 0.7).abs() < ROUNDING), "{name}: {times:?}");
            }
        }
    }
}

#[test]
fn a_transition_that_lifts_another_violated_guard_cancels_its_event() {
    // z and 1.5 z fall at once at x = 0.5; the first transition puts z on 1, and both hold again.
    let steep = Guard { a: 1.5, ..floor(1, 1.0) };
    let script = Script {
        rate: vec![vec![-1.0], vec![]],
        guards: vec![vec![floor(1, 1.0), steep], vec![floor(0, 1.0), floor(0, 1.0)]],
    };
    for setting in settings() {
        let name = setting.0.name;
        let (log, outcome, _, [_, z]) = run(&script, &setting, (0.0, [0.0, 0.5]), 2.0);
        assert_eq!((outcome, z), (Ok(Outcome::Finished), 1.0), "{name}");
        assert_eq!(log.events.len(), 1, "{name}: {:?}", log.events);
        assert!((log.times()[0] - 0.5).abs() < ROUNDING, "{name}");
    }
}

#[test]
fn forty_guards_at_one_instant_all_switch_once() {
    const N: usize = 40;
    // All guards fall at x = 0.7, and each transition uses one up.
    let fall = |mode: usize| guard(&[0.7, -1.0], 0.0, mode + 1);
    let mode = |m: usize| (0..N).map(|i| if i < m { unused() } else { fall(m) }).collect();
    let script = Script { rate: vec![vec![]; N + 1], guards: (0..=N).map(mode).collect() };
    for setting in settings() {
        let name = setting.0.name;
        let (log, outcome, ..) = run(&script, &setting, (0.0, [0.0, 0.0]), 2.0);
        assert_eq!(outcome, Ok(Outcome::Finished), "{name}");
        let times = log.times();
        assert_eq!(times.len(), N, "{name}");
        assert!(times.iter().all(|t| (t - 0.7).abs() < ROUNDING), "{name}: {times:?}");
    }
}

//! Guards that hold, and guards that fall once.

use deltazero_solvers::{Integration, Next, Outcome};

use crate::common::at_most;
use crate::log::{Log, ROUNDING, run, settings, settings_with};
use crate::script::{Script, chain, expect_events, guard, unused};

#[test]
fn no_guard_that_holds_gives_an_event() {
    expect_events(&chain(&[&[1.0, 1.0]]), 2.0, &[]);
    expect_events(&chain(&[]), 2.0, &[]);
}

#[test]
fn one_crossing_gives_one_event() {
    expect_events(&chain(&[&[0.7, -1.0]]), 2.0, &[0.7]);
}

#[test]
fn a_crossing_at_the_end_of_a_step_gives_one_event() {
    expect_events(&chain(&[&[0.5, -1.0], &[1.0, -1.0]]), 2.0, &[0.5, 1.0]);
}

#[test]
fn a_crossing_at_t_end_belongs_to_the_run_that_goes_on() {
    let script = chain(&[&[1.0, -1.0]]);
    for (method, control) in settings() {
        let mut log = Log::default();
        let mut integration = Integration::new(&script, 0.0, [0.0, 0.0]);
        let mut solver = method.solver(&script, control).unwrap();
        let mut ends = [0; 2];
        for (n, t_end) in ends.iter_mut().zip([1.0, 2.0]) {
            let outcome = integration.run(t_end, &mut *solver, &mut log);
            assert_eq!(outcome, Ok(Outcome::Finished));
            assert_eq!(integration.point.t, t_end);
            *n = log.events.len();
        }
        assert_eq!(ends, [0, 1], "{}: {:?}", method.name, log.events);
        assert!((log.events[0].0 - 1.0).abs() < 1e-14);
    }
}

#[test]
fn a_guard_that_is_zero_throughout_gives_no_event() {
    expect_events(&chain(&[&[0.0]]), 2.0, &[]);
}

#[test]
fn a_terminal_event_stops_the_run() {
    let mut script = chain(&[&[0.7, -1.0]]);
    script.guards[0][0].next = Next::Stop;
    for setting in settings() {
        let (log, outcome, t, [x, _]) = run(&script, &setting, (0.0, [0.0; 2]), 2.0);
        assert_eq!(outcome, Ok(Outcome::Stopped), "{}", setting.0.name);
        assert!((t - 0.7).abs() < ROUNDING && (x - 0.7).abs() < ROUNDING, "{t} {x}");
        assert_eq!(log.times(), [t]);
        assert_eq!(log.steps.last().unwrap().1, t);
    }
}

#[test]
fn a_guard_that_is_zero_in_one_mode_leaves_the_others_alive() {
    // Guard 0 is zero throughout mode 0, falls at 1.1 in mode 1 and is zero again in mode 2.
    let script = Script {
        rate: vec![vec![]; 4],
        guards: vec![
            vec![guard(&[0.0], 0.0, 3), guard(&[0.7, -1.0], 0.0, 1)],
            vec![guard(&[1.1, -1.0], 0.0, 2), guard(&[0.0], 0.0, 3)],
            vec![guard(&[0.0], 0.0, 3), guard(&[1.3, -1.0], 0.0, 3)],
            vec![unused(), unused()],
        ],
    };
    expect_events(&script, 2.0, &[0.7, 1.1, 1.3]);
}

#[test]
fn twenty_events_in_one_step_come_in_order() {
    // Three guards are live in each mode, those of the next three events; the spacing falls to 1e-9.
    let times: Vec<f64> = (0..20)
        .map(|k| 0.3 + 0.01 * f64::from(k) + if k % 5 == 4 { 1e-9 - 0.01 } else { 0.0 })
        .collect();
    let falls = |k: usize| match times.get(k) {
        Some(&at) => guard(&[at, -1.0], 0.0, k + 1),
        None => unused(),
    };
    let mode = |i: usize| {
        let mut guards = vec![unused(); 3];
        for k in i..i + 3 {
            guards[k % 3] = falls(k);
        }
        guards
    };
    let script = Script { rate: vec![vec![]; 21], guards: (0..21).map(mode).collect() };
    for setting in settings_with(4.0) {
        let name = setting.0.name;
        let (log, outcome, ..) = run(&script, &setting, (0.0, [0.0; 2]), 4.0);
        assert_eq!(outcome, Ok(Outcome::Finished), "{name}");
        assert_eq!(log.guards(), (0..20).map(|k| k % 3).collect::<Vec<_>>(), "{name}");
        for (t, expected) in log.times().iter().zip(&times) {
            // Measured: 9.4e-16, for tsit45 9.9e-15.
            at_most(name, (t - expected).abs(), 5e-14);
        }
    }
}

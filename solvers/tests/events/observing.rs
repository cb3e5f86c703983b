//! Functions that a run is observed by, which switch nothing.

use std::f64::consts::PI;

use deltazero_solvers::observe::Observations;
use deltazero_solvers::problems::BouncingBall;
use deltazero_solvers::{
    Control, Integration, METHODS, Next, Outcome, Point, Real, Record, Stats, System, Tolerance,
};

use crate::common::at_most;
use crate::log::{Log, Setting, as_records, settings, settings_with};
use crate::script::chain;

/// `ẍ = −x` from x = 1, with a guard that falls at no time; `(x, ẋ) = (cos t, −sin t)`.
struct Swing;

impl System for Swing {
    type Mode = ();
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) {}

    fn rhs<S: Real>(&self, (): (), _t: S, &[x, v]: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [v, -x];
    }

    fn guards<S: Real>(&self, (): (), _t: S, &[x, _]: &[S; 2], g: &mut [S; 1]) {
        *g = [x + 2.0];
    }

    fn guard_bounds(&self, (): (), _t: f64, _y: &[f64; 2], bounds: &mut [f64; 1]) {
        *bounds = [1e-15];
    }

    fn transition<S: Real>(&self, (): (), _: usize, _t: S, _y: &mut [S; 2]) -> Next<()> {
        Next::Stop
    }
}

/// Runs `problem` shown to `record`, and returns its end and its work as text.
fn run<P: System>(
    problem: &P,
    (method, control): &Setting,
    (t0, y0): (f64, P::State<f64>),
    t_end: f64,
    record: &mut dyn Record<P>,
) -> (String, Stats) {
    let mut integration = Integration::new(problem, t0, y0);
    let Ok(mut solver) = method.solver(problem, control.clone()) else {
        panic!("{} does not take {control:?}", method.name);
    };
    assert_eq!(integration.run(t_end, &mut *solver, record), Ok(Outcome::Finished));
    let Point { t, y, mode } = integration.point;
    (format!("{t:?} {y:?} {mode:?}"), integration.stats)
}

#[test]
fn zeros_are_located_as_exactly_as_the_dense_output_in_both_directions() {
    for setting in settings() {
        let (name, control) = (setting.0.name, &setting.1);
        let mut seen = Observations::default()
            .of(1e-15, |(), _t, &[x, _]: &[f64; 2]| x - 0.3)
            .of(1e-15, |(), t, &[_, v]: &[f64; 2]| v - 0.1 * (t - 3.0));
        run(&Swing, &setting, (0.0, [1.0, 0.0]), 10.0, &mut seen);
        assert!(seen.unfollowed.is_empty(), "{name}");
        let a = 0.3_f64.acos();
        let of_x: Vec<_> = seen.zeros.iter().filter(|zero| zero.function == 0).collect();
        let expected = [(a, false), (2.0 * PI - a, true), (2.0 * PI + a, false)];
        assert_eq!(of_x.len(), 3, "{name}");
        // Measured: 2.5e-3 for bs32 with steps of a quarter, 5.3e-6 for tr_bdf2 at 1e-8.
        let bound = if matches!(control, Control::Fixed(_)) { 1e-2 } else { 2e-5 };
        for (zero, (t, rises)) in of_x.iter().zip(expected) {
            assert_eq!(zero.rises, rises, "{name}");
            at_most(name, (zero.t - t).abs(), bound);
            // Measured: 2.5e-15.
            at_most("state at the zero", (zero.y[0] - 0.3).abs(), 2e-14);
        }
        for zero in seen.zeros.iter().filter(|zero| zero.function == 1) {
            let off = -zero.t.sin() - 0.1 * (zero.t - 3.0);
            at_most(name, off.abs(), bound);
        }
        assert!(seen.zeros.is_sorted_by(|a, b| a.t <= b.t), "{name}");
        assert_eq!(seen.zeros.len(), 6, "{name}");
    }
}

#[test]
fn a_run_that_is_observed_has_the_bits_of_one_that_is_not() {
    let ball = BouncingBall { restitution: 0.8, gravity: 9.8, height: 1.0 };
    for setting in settings() {
        let (mut alone, mut beside) = (Log::default(), Log::default());
        let start = (0.0, ball.start());
        let unseen = run(&ball, &setting, start, 3.0, &mut ());
        assert_eq!(run(&ball, &setting, start, 3.0, &mut alone), unseen, "{}", setting.0.name);
        let seen = Observations::default().of(1e-15, |_, _, y: &[f64; 2]| y[0] - 0.2);
        let mut both = (&mut beside, seen);
        assert_eq!(run(&ball, &setting, start, 3.0, &mut both), unseen, "{}", setting.0.name);
        assert!(both.1.zeros.len() > 5);
        assert_eq!(alone.steps, beside.steps, "{}", setting.0.name);
        assert_eq!(alone.events, beside.events, "{}", setting.0.name);
    }
}

#[test]
fn two_zeros_within_one_step_are_found_however_near_to_each_other() {
    for setting in settings_with(1.0) {
        for half in [0.3, 1e-2, 1e-4, 1e-6] {
            for middle in [0.37, 0.5, 0.62, 1.0, 1.4] {
                let mut seen = Observations::default()
                    .of(1e-15, |_, _, &[x, _]: &[f64; 2]| (x - middle).powi(2) - half * half);
                run(&chain(&[]), &setting, (0.0, [0.0; 2]), 2.0, &mut seen);
                let found: Vec<_> = seen.zeros.iter().map(|zero| zero.rises).collect();
                assert_eq!(found, [false, true], "{}: {half}, {middle}", setting.0.name);
                for (zero, t) in seen.zeros.iter().zip([middle - half, middle + half]) {
                    // Measured: 2.6e-14 for tsit45, which adds up its steps.
                    at_most(setting.0.name, (zero.t - t).abs(), 2e-13);
                }
            }
        }
    }
}

#[test]
fn a_function_that_turns_while_the_states_rest_is_followed() {
    for setting in settings() {
        let mut seen = Observations::default().of(1e-12, |_, t, _: &[f64; 2]| (1000.0 * t).sin());
        run(&chain(&[]), &setting, (0.0, [0.0; 2]), 2.0, &mut seen);
        assert_eq!(seen.zeros.len(), 636, "{}", setting.0.name);
        for (n, zero) in seen.zeros.iter().enumerate() {
            // Measured: 4.4e-16.
            at_most(setting.0.name, (zero.t - PI * (n + 1) as f64 / 1000.0).abs(), 4e-15);
        }
    }
}

#[test]
fn neither_a_start_on_zero_nor_a_touch_nor_a_jump_is_a_zero() {
    let ball = BouncingBall { restitution: 0.8, gravity: 9.8, height: 1.0 };
    for setting in settings() {
        let name = setting.0.name;
        let mut seen = Observations::default()
            .of(1e-15, |_, t, _: &[f64; 2]| t)
            .of(1e-15, |_, t, _: &[f64; 2]| (t - 0.6) * (t - 0.6))
            .of(1e-12, |_, _, y: &[f64; 2]| y[1]);
        // Two bounces, and the tops after them.
        run(&ball, &setting, (0.0, ball.start()), 1.8, &mut seen);
        let found: Vec<_> = seen.zeros.iter().map(|zero| (zero.function, zero.rises)).collect();
        assert_eq!(found, [(2, false), (2, false)], "{name}");
    }
}

#[test]
fn observations_go_on_with_the_run_and_run_backward() {
    for (method, control) in settings() {
        let mut seen = Observations::default().of(1e-15, |(), _, y: &[f64; 2]| y[0]);
        let mut integration = Integration::new(&Swing, 10.0, [10.0_f64.cos(), -10.0_f64.sin()]);
        let mut solver = method.solver(&Swing, control.clone()).unwrap();
        // The second run ends on a zero.
        for t_end in [9.0, 2.5 * PI, 0.5] {
            integration.run(t_end, &mut *solver, &mut seen).unwrap();
        }
        let found: Vec<_> = seen.zeros.iter().map(|zero| zero.rises).collect();
        assert_eq!(found, [true, false, true], "{}", method.name);
        // Measured: 1.1e-3 for bs32 with steps of a quarter, 6.4e-6 for tr_bdf2 at 1e-8.
        let bound = if matches!(control, Control::Fixed(_)) { 1e-2 } else { 5e-5 };
        for (zero, n) in seen.zeros.iter().zip([2.5, 1.5, 0.5]) {
            at_most(method.name, (zero.t - n * PI).abs(), bound);
        }
    }
}

#[test]
fn a_function_that_is_not_a_number_is_told() {
    for setting in settings() {
        let mut seen = Observations::default().of(1e-15, |_, t, _: &[f64; 2]| {
            if (0.9..=1.3).contains(&t) { f64::NAN } else { t - 0.5 }
        });
        run(&chain(&[]), &setting, (0.0, [0.0; 2]), 2.0, &mut seen);
        assert!(!seen.unfollowed.is_empty(), "{}", setting.0.name);
        for step in &seen.unfollowed {
            assert!(step.t1 > 0.9 && step.t0 < 1.3, "{}: {step:?}", setting.0.name);
        }
    }
}

#[test]
fn a_function_that_is_noise_above_its_bound_is_not_followed_and_does_not_hang() {
    let setting = settings().into_iter().find(|(method, _)| method.name == "taylor").unwrap();
    // Rounded by some 1e-8, seven orders more than it says.
    let noise = |(): &(), t: f64, _: &[f64; 2]| (1e8 + 1e8 * t).sin() * 1e-8;
    let mut seen = Observations::default().of(1e-15, noise);
    run(&Swing, &setting, (0.0, [1.0, 0.0]), 1.0, &mut seen);
    assert!(!seen.unfollowed.is_empty());
}

#[test]
fn a_second_run_begins_without_the_sides_of_the_first() {
    for setting in settings() {
        let mut seen = Observations::default().of(1e-15, |(), _t, &[x, _]: &[f64; 2]| x);
        run(&Swing, &setting, (0.0, [-1.0, 0.0]), 1.0, &mut seen);
        // It starts on zero and rises.
        run(&Swing, &setting, (5.0, [0.0, 1.0]), 6.0, &mut seen);
        assert!(seen.zeros.is_empty(), "{}: {:?}", setting.0.name, seen.zeros);
    }
}

#[test]
fn runs_of_a_batch_are_observed_as_each_alone() {
    let balls: Vec<_> = (0..10)
        .map(|k| BouncingBall { restitution: 0.8, gravity: 9.0 + 0.1 * f64::from(k), height: 1.0 })
        .collect();
    let observe = || Observations::default().of(1e-15, |_, _, y: &[f64; 2]| y[0] - 0.2);
    for method in METHODS.iter().filter(|method| !method.is_fixed_step()) {
        let control = Control::Adaptive(Tolerance { rtol: 1e-8, atol: vec![1e-8; 2] });
        let mut runs: Vec<_> =
            balls.iter().map(|ball| Integration::new(ball, 0.0, ball.start())).collect();
        let mut seen: Vec<_> = balls.iter().map(|_| observe()).collect();
        let controls = vec![control.clone(); balls.len()];
        method.run_batch(&mut runs, 3.0, &controls, &mut as_records(&mut seen)).unwrap();
        for (ball, seen) in balls.iter().zip(&seen) {
            let mut alone = observe();
            let setting = (method, control.clone());
            run(ball, &setting, (0.0, ball.start()), 3.0, &mut alone);
            assert_eq!(seen.zeros, alone.zeros, "{}", method.name);
        }
    }
}

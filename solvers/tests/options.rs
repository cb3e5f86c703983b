//! The options of a run, and what a trajectory keeps.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test panics to fail")]

mod common;

use std::ops::ControlFlow;

use common::{at_most, distance, steps_itself};
use deltazero_solvers::problems::{BouncingBall, BouncingMode, SpringStop, StopMode};
use deltazero_solvers::{
    Control, Error, Grid, Integration, METHODS, Method, Next, Outcome, Point, Real, Run, Sample,
    Steps, System, Tolerance, Trajectory, Watch,
};

const BALL: BouncingBall = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
const STOP: SpringStop =
    SpringStop { mass: 1.0, stiffness: 4.0, stop_stiffness: 400.0, gap: 0.1, start: [-0.3, 0.4] };

fn control(method: &Method) -> Control {
    if method.is_fixed_step() { Control::Fixed(0.01) } else { common::tolerance(1e-8) }
}

/// A run of the stop to 3, shown to a trajectory; returns it and the number of accepted steps.
fn run(
    method: &Method,
    steps: Steps,
    mut trajectory: Trajectory<[f64; 2], StopMode>,
) -> (Trajectory<[f64; 2], StopMode>, u64) {
    let mut solver = method.solver(&STOP, steps).unwrap();
    let mut run = Integration::new(&STOP, 0.0, STOP.start);
    run.run(3.0, &mut *solver, &mut trajectory).unwrap();
    (trajectory, run.stats.n_accepted)
}

#[test]
fn the_first_step_is_the_given_one_or_shorter() {
    for method in METHODS.iter().filter(|method| !method.is_fixed_step()) {
        let steps = Steps { first: Some(1e-5), ..control(method).into() };
        let (short, _) = run(method, steps, Trajectory::on(Grid::Steps));
        assert_eq!(short.samples[0].t, 1e-5, "{}", method.name);
        // It holds for the first step alone.
        let lengths = short.samples.windows(2).map(|pair| pair[1].t - pair[0].t);
        assert!(lengths.fold(0.0, f64::max) > 1e-3, "{}", method.name);
    }
}

#[test]
fn no_step_is_longer_than_the_longest() {
    for method in METHODS.iter().filter(|method| !steps_itself(method, &STOP)) {
        if method.is_fixed_step() {
            continue;
        }
        let (own, n_own) = run(method, control(method).into(), Trajectory::on(Grid::Steps));
        let steps = Steps { longest: 2e-3, ..control(method).into() };
        let (short, n) = run(method, steps, Trajectory::on(Grid::Steps));
        let longest = |trajectory: &Trajectory<[f64; 2], StopMode>| {
            let lengths = trajectory.samples.windows(2).map(|pair| pair[1].t - pair[0].t);
            lengths.fold(0.0, f64::max)
        };
        assert!(longest(&own) > 2e-3, "{}", method.name);
        assert!(longest(&short) <= 2e-3 * 1.01, "{}: {}", method.name, longest(&short));
        assert!(n >= 1500 && n > n_own, "{}: {n}", method.name);
    }
}

#[test]
fn limits_that_a_method_cannot_keep_are_refused() {
    let refused = |method: &Method, steps| method.solver(&STOP, steps).err().unwrap();
    let steps = |method| Steps::from(control(method));
    for method in METHODS {
        let negative = refused(method, Steps { first: Some(-1.0), ..steps(method) });
        let none = refused(method, Steps { longest: 0.0, ..steps(method) });
        if method.is_fixed_step() {
            assert!(matches!(negative, Error::BadControl { .. }), "{negative}");
            assert!(matches!(none, Error::BadControl { .. }), "{none}");
        } else {
            assert!(matches!(negative, Error::BadArgument { name: "first step", .. }));
        }
        if steps_itself(method, &STOP) {
            assert!(matches!(none, Error::BadControl { .. }), "{none}");
        } else if !method.is_fixed_step() {
            assert!(matches!(none, Error::BadArgument { name: "longest step", .. }), "{none}");
        }
    }
}

#[test]
fn a_run_without_a_time_to_start_or_to_end_is_refused() {
    for method in METHODS {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for (start, end, expected) in [(bad, 1.0, "t"), (0.0, bad, "t_end")] {
                let mut solver = method.solver(&BALL, control(method)).unwrap();
                let mut run = Integration::new(&BALL, start, BALL.start());
                let mut samples = Trajectory::on(Grid::Times(vec![0.5]));
                let error = run.run(end, &mut *solver, &mut samples).unwrap_err();
                let is_told = matches!(error, Error::BadArgument { name, .. } if name == expected);
                assert!(is_told, "{}: {error}", method.name);
            }
        }
    }
}

#[test]
fn a_run_of_no_length_keeps_a_sample_of_its_start() {
    // It lies on the floor, and is thrown up before the first step.
    let (t, y) = (0.5, [-0.1, -1.0]);
    for method in METHODS {
        let mut solver = method.solver(&BALL, control(method)).unwrap();
        let mut run = Integration::new(&BALL, t, y);
        let mut samples = Trajectory::on(Grid::Times(vec![t, 0.6]));
        for t_end in [t, 0.6] {
            run.run(t_end, &mut *solver, &mut samples).unwrap();
        }
        let [first, last] = &samples.samples[..] else { panic!("{}", method.name) };
        assert_eq!((first.t, first.y), (t, [0.0, 0.5]), "{}", method.name);
        assert_eq!((last.t, last.y), (0.6, run.point.y), "{}", method.name);
    }
}

/// A clock without any state.
struct Clock;

impl System for Clock {
    type Mode = u8;
    type State<S: Real> = Vec<S>;
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &Vec<f64>) -> u8 {
        1
    }

    fn dim(&self) -> usize {
        0
    }

    fn rhs<S: Real>(&self, _n: u8, _t: S, _y: &Vec<S>, _dydt: &mut Vec<S>) {}

    fn guards<S: Real>(&self, n: u8, t: S, _y: &Vec<S>, g: &mut [S; 1]) {
        *g = [-t + f64::from(n)];
    }

    fn guard_bounds(&self, _n: u8, _t: f64, _y: &Vec<f64>, bounds: &mut [f64; 1]) {
        *bounds = [1e-14];
    }

    fn transition<S: Real>(&self, n: u8, _guard: usize, _t: S, _y: &mut Vec<S>) -> Next<u8> {
        Next::Mode(n + 1)
    }
}

#[test]
fn a_system_without_states_is_refused() {
    for method in METHODS {
        let control = match control(method) {
            Control::Adaptive(own) => Control::Adaptive(Tolerance { atol: vec![], ..own }),
            fixed => fixed,
        };
        let refused = method.solver(&Clock, control).and_then(|mut solver| {
            Integration::new(&Clock, 0.0, vec![]).run(3.5, &mut *solver, &mut ())
        });
        let error = refused.unwrap_err();
        assert!(matches!(error, Error::BadArgument { .. }), "{}: {error}", method.name);
    }
}

#[test]
fn a_dense_trajectory_of_a_run_without_steps_knows_its_start() {
    let method = Method::named("rk45").unwrap();
    let of_run = |t_end, start: [f64; 2]| {
        let mut solver = method.solver(&BALL, control(method)).unwrap();
        let mut trajectory = Trajectory::dense();
        let mut run = Integration::new(&BALL, 0.0, start);
        run.run(t_end, &mut *solver, &mut trajectory).unwrap();
        assert_eq!(trajectory.at(0.5), None);
        trajectory.at(0.0).map(|sample| sample.y)
    };
    assert_eq!(of_run(0.0, [1.0, 0.0]), Some([1.0, 0.0]));
    // One that begins below the floor bounces at once.
    assert_eq!(of_run(0.0, [-1e-3, -2.0]), Some([0.0, 1.0]));
}

#[test]
fn a_run_starts_in_the_mode_of_its_point() {
    let method = Method::named("rk45").unwrap();
    let mut solver = method.solver(&BALL, control(method)).unwrap();
    let mode = BouncingMode::Rest;
    let mut run = Integration::at(&BALL, Point { t: 0.0, y: BALL.start(), mode });
    run.run(1.0, &mut *solver, &mut ()).unwrap();
    assert_eq!((run.point.mode, run.point.y), (mode, BALL.start()));
}

#[test]
fn a_watch_sees_each_step_and_ends_the_run() {
    for method in METHODS {
        let mut times = Vec::new();
        let mut watch = Watch::new(|t, stats: &deltazero_solvers::Stats| {
            times.push(t);
            assert_eq!(stats.n_accepted, times.len() as u64);
            if t < 1.0 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        let mut solver = method.solver(&STOP, control(method)).unwrap();
        let mut run = Integration::new(&STOP, 0.0, STOP.start);
        let outcome = run.run(3.0, &mut *solver, &mut watch).unwrap();
        assert_eq!(outcome, Outcome::Interrupted, "{}", method.name);
        assert!(times.is_sorted() && times.last() == Some(&run.point.t), "{}", method.name);
    }
}

#[test]
fn a_trajectory_keeps_the_start_and_both_sides_of_each_event() {
    for method in METHODS {
        let mut solver = method.solver(&BALL, control(method)).unwrap();
        let mut trajectory = Trajectory::of_events();
        let mut run = Integration::new(&BALL, 0.0, BALL.start());
        for t_end in [1.0, 1.2] {
            run.run(t_end, &mut *solver, &mut trajectory).unwrap();
        }
        let start = Sample { t: 0.0, mode: BouncingMode::Flight, y: BALL.start() };
        assert_eq!(trajectory.start, Some(start));
        assert_eq!((trajectory.events.len(), trajectory.sides.len()), (3, 3));
        assert!(trajectory.samples.is_empty());
        for (n, [before, after]) in trajectory.sides.iter().enumerate() {
            let speed = BALL.bounce_speed(n);
            // Measured: 1.2e-14 and 1.3e-8.
            let bound = if steps_itself(method, &BALL) { 1e-7 } else { 1e-13 };
            at_most(method.name, distance(before, &[0.0, -2.0 * speed]), bound);
            at_most(method.name, distance(after, &[0.0, speed]), bound);
        }
    }
}

#[test]
fn a_dense_trajectory_is_the_dense_output_at_any_time() {
    let times: Vec<f64> = (1..300).map(|k| 0.01 * f64::from(k)).collect();
    for method in METHODS {
        let steps = || Steps::from(control(method));
        let (dense, n_accepted) = run(method, steps(), Trajectory::dense());
        let (sampled, _) = run(method, steps(), Trajectory::on(Grid::Times(times.clone())));
        assert_eq!(dense.samples.len() as u64, n_accepted);
        let mut worst = 0.0_f64;
        for sample in &sampled.samples {
            let found = dense.at(sample.t).unwrap();
            assert_eq!((found.t, found.mode), (sample.t, sample.mode));
            worst = worst.max(distance(&found.y, &sample.y));
        }
        // Measured: 2.9e-15.
        at_most(method.name, worst, 2e-14);
        for (event, [before, after]) in dense.events.iter().zip(&dense.sides) {
            assert_eq!(dense.at(event.t).unwrap().y, *after);
            // The velocity changes by 7 m/s².
            at_most("before", distance(&dense.at(event.t - 1e-9).unwrap().y, before), 1e-8);
        }
        assert_eq!(dense.at(3.0).as_ref(), dense.samples.last());
        assert_eq!(dense.at(0.0).map(|sample| sample.y), Some(STOP.start));
        assert_eq!((dense.at(-1e-9), dense.at(3.1)), (None, None));
        assert_eq!(sampled.at(1.0), None);
    }
}

#[test]
fn a_dense_trajectory_runs_backward_too() {
    let method = Method::named("dop853").unwrap();
    let tolerance = Tolerance { rtol: 1e-10, atol: vec![1e-10; 2] };
    let mut solver = method.solver(&STOP, Control::Adaptive(tolerance)).unwrap();
    let (start, _) = STOP.solution(3.0);
    let mut trajectory = Trajectory::dense();
    Integration::new(&STOP, 3.0, start).run(0.0, &mut *solver, &mut trajectory).unwrap();
    for t in [0.0, 0.7, 1.9, 3.0] {
        let found = trajectory.at(t).unwrap().y;
        // Measured: 2.0e-10.
        at_most("backward", distance(&found, &STOP.solution(t).0), 2e-9);
    }
    assert_eq!((trajectory.at(-1e-9), trajectory.at(3.0 + 1e-9)), (None, None));
}

#[test]
fn a_run_does_what_an_integration_with_the_same_options_does() {
    let method = Method::named("rk45").unwrap();
    let steps = Steps { first: Some(1e-4), longest: 0.05, control: common::tolerance(1e-8) };
    let mut solver = method.solver(&BALL, steps).unwrap();
    let (mut own, y) = (Trajectory::on(Grid::Steps), [1.0, 2.0]);
    let mut integration = Integration::new(&BALL, 0.5, y);
    integration.run(1.5, &mut *solver, &mut own).unwrap();

    let run = Run::of(&BALL, y).from(0.5).method("rk45").tolerance(1e-8, 1e-8);
    let run = run.first_step(1e-4).longest_step(0.05).to(1.5).unwrap();
    assert_eq!((run.outcome, &run.trajectory.samples), (Outcome::Finished, &own.samples));
    assert_eq!((run.end.t, run.end.y), (1.5, integration.point.y));
    assert_eq!((run.trajectory.events, run.stats), (own.events, integration.stats));
}

#[test]
fn a_run_has_defaults_and_keeps_its_limits() {
    let run = || Run::of(&BALL, BALL.start()).tolerance(1e-6, 1e-9);
    let ended = run().to(1.3).unwrap();
    assert_eq!(ended.trajectory.events.len(), 5);
    at_most("by default", distance(&ended.end.y, &BALL.state(1.3)), 1e-5);
    let untold = Run::of(&BALL, BALL.start()).to(1.3).unwrap_err();
    assert_eq!(untold, Error::BadControl { method: "auto", needs: "a tolerance or a step" });

    let rest = run().in_mode(BouncingMode::Rest).to(1.3).unwrap();
    assert_eq!((rest.end.y, rest.trajectory.events.len()), (BALL.start(), 0));
    let fixed = run().method("rk4").step(0.01).keep(Trajectory::dense()).to(0.4).unwrap();
    assert!((39..=41).contains(&fixed.stats.n_accepted) && fixed.trajectory.at(0.333).is_some());

    let few = run().longest_step(1e-3).most_work(500).to(1.3).unwrap();
    assert_eq!(few.outcome, Outcome::Interrupted);
    assert!((500..700).contains(&few.stats.work.n_rhs), "{:?}", few.stats);
    let none = run().most_time(std::time::Duration::ZERO).to(1.3).unwrap();
    assert_eq!((none.outcome, none.stats.n_accepted), (Outcome::Interrupted, 1));
    let mut latest = 0.0;
    let broken_off = run().longest_step(0.01).progress(|t, _| {
        latest = t;
        if t < 0.2 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    assert_eq!(broken_off.to(1.3).unwrap().outcome, Outcome::Interrupted);
    assert!((0.2..0.22).contains(&latest), "{latest}");
}

#[test]
fn a_method_that_is_not_there_is_named() {
    let error = Run::of(&BALL, BALL.start()).method("rk54").to(1.0).unwrap_err();
    assert!(matches!(&error, Error::UnknownMethod { name, .. } if name == "rk54"));
    assert!(error.to_string().contains("no method rk54; there are rk4, rk43, "), "{error}");
}

//! The same rules backward in time.

use deltazero_solvers::problems::BouncingBall;
use deltazero_solvers::{Grid, METHODS, Outcome, Run, Trajectory};

use crate::common::{at_most, steps_itself};
use crate::log::{ROUNDING, run, settings};
use crate::script::chain;

#[test]
fn events_are_located_backward_in_time() {
    let script = chain(&[&[-1.1, 1.0], &[-0.35, 1.0]]);
    for setting in settings() {
        let name = setting.0.name;
        let (log, outcome, t, [x, _]) = run(&script, &setting, (2.0, [2.0, 0.0]), 0.0);
        assert_eq!((outcome, t), (Ok(Outcome::Finished), 0.0), "{name}");
        let times = log.times();
        assert_eq!(times.len(), 2, "{name}: {times:?}");
        // Measured: 2e-16 for ours, 1.7e-14 for those of diffsol.
        let late = (times[0] - 1.1).abs().max((times[1] - 0.35).abs());
        assert!(late < ROUNDING, "{name}: {times:?}");
        assert!(x.abs() < ROUNDING, "{name}: {x}");
        assert!(log.steps.iter().all(|(t0, t1, _)| t1 < t0), "{name}");
    }
}

#[test]
fn a_guard_that_falls_and_rises_within_one_step_is_found_backward() {
    let (a, d) = (0.6_f64, 0.05_f64);
    let inside = [a * a - d * d, -2.0 * a, 1.0];
    let outside = inside.map(|c| -c);
    let script = chain(&[&inside, &outside]);
    for setting in settings() {
        let name = setting.0.name;
        let (log, outcome, ..) = run(&script, &setting, (2.0, [2.0, 0.0]), 0.0);
        assert_eq!(outcome, Ok(Outcome::Finished), "{name}");
        let times = log.times();
        assert_eq!(times.len(), 2, "{name}: {times:?}");
        // Measured: 2.9e-14.
        at_most(name, (times[0] - (a + d)).abs().max((times[1] - (a - d)).abs()), ROUNDING);
    }
}

#[test]
fn a_reset_does_not_trigger_its_guard_again_backward() {
    // Without loss a bounce is its own inverse.
    let ball = BouncingBall { restitution: 1.0, gravity: 9.8, height: 1.0 };
    for setting in settings() {
        let name = setting.0.name;
        let (log, outcome, t, y) = run(&ball, &setting, (3.0, ball.state(3.0)), 0.0);
        assert_eq!((outcome, t), (Ok(Outcome::Finished), 0.0), "{name}");
        let mut times = log.times();
        times.reverse();
        assert!(ball.bounce_time(times.len()) > 3.0, "{name}: {times:?}");
        let is_diffsol = steps_itself(setting.0, &ball);
        for (n, t) in times.iter().enumerate() {
            // Measured: 9.2e-15 s, for bdf 1.7e-9 s.
            at_most(name, (t - ball.bounce_time(n)).abs(), if is_diffsol { 1e-8 } else { 5e-14 });
        }
        // Measured: 1.2e-13, for bdf 2.2e-8.
        let distance = (y[0] - 1.0).abs().max(y[1].abs());
        at_most(name, distance, if is_diffsol { 2e-7 } else { 1e-12 });
    }
}

#[test]
fn a_start_on_the_surface_counts_the_same_backward() {
    // Going in and going out, backward from x = 2.
    for (slope, n) in [(-1.0, 0), (1.0, 1)] {
        let script = chain(&[&[-2.0 * slope, slope]]);
        for setting in settings() {
            let name = setting.0.name;
            let (log, outcome, ..) = run(&script, &setting, (2.0, [2.0, 0.0]), 0.0);
            assert_eq!((outcome, log.events.len()), (Ok(Outcome::Finished), n), "{name}");
            assert!(log.times().iter().all(|t| (t - 2.0).abs() < ROUNDING), "{name}");
        }
    }
}

#[test]
fn samples_after_an_event_at_the_start_are_those_of_the_motion_backward() {
    // Backward from x = 0 the guard falls at once: the step to there is too short to change the time.
    let script = chain(&[&[0.0, 1.0]]);
    for method in METHODS.iter().filter(|method| !method.is_fixed_step()) {
        let run = Run::of(&script, [0.0, 0.0]).from(1.5).method(method.name).tolerance(1e-9, 1e-9);
        let times = vec![1.2, 1.0, 0.5];
        let ran = run.keep(Trajectory::on(Grid::Times(times.clone()))).to(0.0).unwrap();
        let samples: Vec<_> = ran.trajectory.samples.iter().map(|at| (at.t, at.y[0])).collect();
        assert_eq!(samples.len(), 3, "{}", method.name);
        for ((t, x), time) in samples.into_iter().zip(times) {
            assert!(t == time && (x - (t - 1.5)).abs() < ROUNDING, "{}: {t}, {x}", method.name);
        }
    }
}

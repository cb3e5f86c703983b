//! How runs end, and how they go on.

use deltazero_solvers::problems::BouncingBall;
use deltazero_solvers::{Control, Error, Grid, Integration, METHODS, Outcome, Trajectory};

use crate::common::{at_most, steps_itself};
use crate::log::{run, settings};
use crate::script::chain;

#[test]
fn fixed_steps_end_exactly_on_t_end_without_a_sliver() {
    for method in METHODS {
        for (h, n) in [(0.1, 30), (1.0 / 3.0, 9), (0.7, 5)] {
            let setting = (method, Control::Fixed(h));
            let script = chain(&[]);
            if method.solver(&script, setting.1.clone()).is_err() {
                continue;
            }
            let (log, _, t, _) = run(&script, &setting, (0.0, [0.0; 2]), 3.0);
            assert_eq!((t, log.steps.len()), (3.0, n), "{} with h = {h}", method.name);
        }
    }
}

#[test]
fn a_fixed_step_below_the_resolution_of_time_is_an_error_and_not_a_hang() {
    for method in METHODS {
        let setting = (method, Control::Fixed(1e-17));
        let script = chain(&[]);
        if method.solver(&script, setting.1.clone()).is_err() {
            continue;
        }
        let (_, outcome, ..) = run(&script, &setting, (1.0, [0.0; 2]), 2.0);
        let expected = matches!(outcome, Err(Error::StepUnderflow { t: 1.0, .. }));
        assert!(expected, "{}: {outcome:?}", method.name);
    }
}

#[test]
fn a_run_over_a_tiny_span_or_none_finishes_at_its_end() {
    for setting in settings() {
        for t0 in [0.0_f64, 1.0, -1e6] {
            for span in [0.0, f64::EPSILON, 1e-15, 1e-12, 1e-9] {
                for sign in [1.0, -1.0] {
                    let t_end = t0 + sign * span * f64::max(1.0, t0.abs());
                    let start = (t0, [0.0; 2]);
                    let (log, outcome, t, [x, _]) =
                        run(&chain(&[&[1.0, -1.0]]), &setting, start, t_end);
                    let name = setting.0.name;
                    assert_eq!(outcome, Ok(Outcome::Finished), "{name}: {t0} to {t_end}");
                    assert_eq!(t, t_end, "{name}");
                    assert!(
                        (x - (t_end - t0)).abs() <= 1e-15 * f64::max(1.0, t0.abs()),
                        "{name}: {x}"
                    );
                    assert!(log.events.is_empty());
                    assert_eq!(log.steps.is_empty(), t0 == t_end, "{name}: {t0} to {t_end}");
                }
            }
        }
    }
}

#[test]
fn a_run_that_goes_on_gives_what_one_run_gives() {
    let ball = BouncingBall { restitution: 0.9, gravity: 9.8, height: 1.0 };
    for (method, control) in settings() {
        let name = method.name;
        let mut trajectory = Trajectory::on(Grid::uniform(0.1, 3.0));
        let mut integration = Integration::new(&ball, 0.0, ball.start());
        let mut solver = method.solver(&ball, control).unwrap();
        for t_end in [0.35, 1.0, 1.0, 1.0 + 1e-15, 3.0] {
            let outcome = integration.run(t_end, &mut *solver, &mut trajectory);
            assert_eq!((outcome, integration.point.t), (Ok(Outcome::Finished), t_end), "{name}");
        }
        assert_eq!(trajectory.samples.len(), 30, "{name}");
        for sample in &trajectory.samples {
            let exact = ball.state(sample.t);
            // Measured: 2.7e-14 m, for bdf 1.3e-8 m.
            let bound = if steps_itself(method, &ball) { 1e-7 } else { 2e-13 };
            at_most(name, (sample.y[0] - exact[0]).abs(), bound);
        }
    }
}

#[test]
fn every_run_ends_exactly_on_t_end() {
    let ball = BouncingBall { restitution: 0.9, gravity: 9.8, height: 1.0 };
    for setting in settings() {
        for n in 1..100 {
            let t_end = 0.013 * f64::from(n);
            let (log, outcome, t, _) = run(&ball, &setting, (0.0, ball.start()), t_end);
            assert_eq!((outcome, t), (Ok(Outcome::Finished), t_end), "{}", setting.0.name);
            assert_eq!(log.steps.last().unwrap().1, t_end, "{}", setting.0.name);
        }
    }
}

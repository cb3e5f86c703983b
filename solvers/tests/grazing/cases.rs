//! Touches, dips and bounces whose course is known in closed form.

use deltazero_solvers::problems::BouncingBall;
use deltazero_solvers::{
    Control, Grazing, Grid, Integration, METHODS, Method, Next, Outcome, Real, Steps, System,
    Tolerance, Trajectory,
};

/// `ẋ = 1`, `ż = 0` with the guard `p(x) + z`, and none in the other mode.
struct Course {
    /// Coefficients of 1, x, x², x³.
    p: [f64; 4],
}

impl System for Course {
    /// Whether it is watched.
    type Mode = bool;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> bool {
        true
    }

    fn rhs<S: Real>(&self, _: bool, _t: S, _y: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [S::cst(1.0), S::cst(0.0)];
    }

    fn guards<S: Real>(&self, is_watched: bool, _t: S, &[x, z]: &[S; 2], g: &mut [S; 1]) {
        let p = self.p.iter().rev().fold(S::cst(0.0), |p, c| p * x + *c);
        *g = [if is_watched { p + z } else { S::cst(1.0) }];
    }

    fn guard_bounds(&self, _: bool, _t: f64, y: &[f64; 2], bounds: &mut [f64; 1]) {
        let size = self.p.iter().rev().fold(0.0, |p, c| p * y[0].abs() + c.abs());
        *bounds = [8.0 * f64::EPSILON * size];
    }

    fn transition<S: Real>(&self, _: bool, _: usize, _t: S, _: &mut [S; 2]) -> Next<bool> {
        Next::Mode(false)
    }
}

/// Every method, with fixed steps of a quarter or to a tolerance of 1e-8.
fn settings() -> impl Iterator<Item = (&'static Method, Control)> {
    let control = |method: &Method| {
        if method.is_fixed_step() {
            Control::Fixed(0.25)
        } else {
            Control::Adaptive(Tolerance { rtol: 1e-8, atol: vec![1e-8; 2] })
        }
    };
    METHODS.iter().map(move |method| (method, control(method)))
}

/// What a run from `y0` at t = 0 to 2 tells of.
fn run<P: System>(
    problem: &P,
    (method, control): (&Method, Control),
    y0: P::State<f64>,
) -> Trajectory<P::State<f64>, P::Mode> {
    let mut run = Trajectory::on(Grid::Times(vec![]));
    let mut integration = Integration::new(problem, 0.0, y0);
    let mut solver = method.solver(problem, control).unwrap();
    assert_eq!(integration.run(2.0, &mut *solver, &mut run), Ok(Outcome::Finished));
    assert_eq!(integration.stats.n_grazing, run.grazings.len() as u64, "{}", method.name);
    run
}

#[test]
fn a_touch_is_told_also_at_the_end_of_a_step_where_the_rate_is_zero() {
    // (x − 0.6)², and (x − 0.5)² with fixed steps of a quarter.
    for (p, touch) in [([0.36, -1.2, 1.0, 0.0], 0.6), ([0.25, -1.0, 1.0, 0.0], 0.5)] {
        for setting in settings() {
            let name = setting.0.name;
            let run = run(&Course { p }, setting, [0.0; 2]);
            let [Grazing { t, depth, error, is_event, .. }] = run.grazings[..] else {
                panic!("{name}: {:?}", run.grazings)
            };
            assert!(!is_event && depth.abs() <= error, "{name}: {depth:e}");
            // Measured: 7.2e-9, a search for a minimum.
            assert!((t - touch).abs() < 7e-8, "{name}: {t}");
        }
    }
}

#[test]
fn a_touch_is_told_by_steps_that_are_short_beside_it() {
    // (x − 0.6)² above 1e-7, and below zero by that, by steps of 1e-5, each of which is far from falling. The event is 32
    // steps from the turn.
    for level in [1e-7, -1e-7] {
        let course = Course { p: [0.36 + level, -1.2, 1.0, 0.0] };
        let mut n_methods = 0;
        for (method, control) in settings().filter(|(method, _)| !method.is_fixed_step()) {
            let steps = Steps { longest: 1e-5, ..Steps::from(control) };
            // Those of diffsol take no longest step.
            let Ok(mut solver) = method.solver(&course, steps) else { continue };
            n_methods += 1;
            let mut run = Trajectory::on(Grid::Times(vec![]));
            let mut integration = Integration::new(&course, 0.0, [0.0; 2]);
            integration.run(2.0, &mut *solver, &mut run).unwrap();
            let [Grazing { t, depth, is_event, .. }] = run.grazings[..] else {
                panic!("{}: {:?}", method.name, run.grazings)
            };
            assert_eq!(is_event, level < 0.0, "{}", method.name);
            let at = if is_event { 0.6 - 1e-7_f64.sqrt() } else { 0.6 };
            assert!((t - at).abs() < 1e-7, "{}: {t}", method.name);
            assert!((depth + level).abs() < 1e-11, "{}: {depth:e}", method.name);
        }
        assert_eq!(n_methods, METHODS.len() - 5);
    }
}

/// `ẋ = 1` with the guards `(x − 0.1)²`, `0.3 − x` and `(x − 0.7)² + 5`.
struct Crossed;

impl System for Crossed {
    type Mode = ();
    type State<S: Real> = [S; 1];
    type Guards<S: Real> = [S; 3];

    fn initial_mode(&self, _t: f64, _y: &[f64; 1]) {}

    fn rhs<S: Real>(&self, (): (), _t: S, _y: &[S; 1], dydt: &mut [S; 1]) {
        *dydt = [S::cst(1.0)];
    }

    fn guards<S: Real>(&self, (): (), _t: S, &[x]: &[S; 1], g: &mut [S; 3]) {
        let square = |x: S| x * x;
        *g = [square(x - 0.1), -x + 0.3, square(x - 0.7) + 5.0];
    }

    fn guard_bounds(&self, (): (), _t: f64, _y: &[f64; 1], bounds: &mut [f64; 3]) {
        *bounds = [8.0 * f64::EPSILON; 3];
    }

    fn transition<S: Real>(&self, (): (), _: usize, _t: S, _: &mut [S; 1]) -> Next<()> {
        Next::Stop
    }
}

#[test]
fn a_touch_is_told_before_another_guard_falls() {
    for (method, control) in settings() {
        let control = match control {
            Control::Adaptive(Tolerance { rtol, .. }) => {
                Control::Adaptive(Tolerance { rtol, atol: vec![rtol] })
            }
            Control::Fixed(_) => Control::Fixed(1.0),
        };
        let mut run = Trajectory::on(Grid::Times(vec![]));
        let mut integration = Integration::new(&Crossed, 0.0, [0.0]);
        let mut solver = method.solver(&Crossed, control).unwrap();
        integration.run(2.0, &mut *solver, &mut run).unwrap();
        let [Grazing { t, guard, is_event, .. }] = run.grazings[..] else {
            panic!("{}: {:?}", method.name, run.grazings)
        };
        assert!(guard == 0 && !is_event && (t - 0.1).abs() < 1e-6, "{}: {t}", method.name);
    }
}

#[test]
fn a_turn_beyond_the_error_is_not_told() {
    // (x − 0.6)² above 1e-3, and below zero by that.
    for level in [1e-3, -1e-3] {
        for setting in settings().filter(|(method, _)| !method.is_fixed_step()) {
            let name = setting.0.name;
            let run = run(&Course { p: [0.36 + level, -1.2, 1.0, 0.0] }, setting, [0.0; 2]);
            assert!(run.grazings.is_empty(), "{name}: {:?}", run.grazings);
            assert_eq!(run.events.len(), usize::from(level < 0.0), "{name}");
        }
    }
}

#[test]
fn a_shallow_dip_after_a_steep_fall_is_told() {
    // (x − 0.9)² (x + 0.45) − 1e-9, largest at 0: the rate at the event is nearly that at the start of a long step.
    let (c, d) = (0.9 * 0.9, 0.45);
    let p = [c * d - 1e-9, c - 1.8 * d, d - 1.8, 1.0];
    for setting in settings().filter(|(method, _)| !method.is_fixed_step()) {
        let name = setting.0.name;
        let run = run(&Course { p }, setting, [0.0; 2]);
        let [Grazing { t, depth, is_event, .. }] = run.grazings[..] else {
            panic!("{name}: {:?}", run.grazings)
        };
        assert_eq!(is_event, run.events.len() == 1, "{name}");
        // Measured: 2.8e-5 before it, and 2.4e-14 off.
        assert!((t - 0.9).abs() < 1e-4 && (depth - 1e-9).abs() < 1e-12, "{name}: {depth:e}");
    }
}

#[test]
fn bounces_too_low_to_resolve_are_told() {
    let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
    for (method, control) in settings() {
        let is_own = !["bdf", "tr_bdf2", "esdirk34", "tsit45"].contains(&method.name);
        let run = run(&ball, (method, control), ball.start());
        let late = (run.events.last().unwrap().t - ball.accumulation_time()).abs();
        println!(
            "{}: {} told of {}, rest off by {late:e}",
            method.name,
            run.grazings.len(),
            run.events.len()
        );
        if is_own {
            assert!(run.grazings.is_empty(), "{}: {:?}", method.name, run.grazings);
            continue;
        }
        assert!(run.grazings.iter().any(|graze| graze.is_event));
        // What is not told is true. Measured: 5e-6 s.
        let first = run.grazings.first().map_or(2.0, |graze| graze.t);
        let sure = run.events.iter().filter(|event| event.t < first).enumerate();
        let off = sure.map(|(n, event)| (event.t - ball.bounce_time(n)).abs()).fold(0.0, f64::max);
        assert!(off < 1e-5, "{}: {off:e}", method.name);
        println!("{off:e}");
    }
}

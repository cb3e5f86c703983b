//! Models and settings that no run can do right by are refused by name.

use deltazero_solvers::{
    Control, Error, Grid, Integration, Next, Outcome, Real, System, Tolerance, Trajectory,
};

use crate::log::{Setting, run, settings, settings_with};
use crate::script::chain;

/// `ẋ = 1` with two guards, of which it writes what it is told to.
struct Forgetful {
    writes_guard: bool,
    bounds: [Option<f64>; 2],
}

impl System for Forgetful {
    type Mode = ();
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 2];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) {}

    fn rhs<S: Real>(&self, _: (), _t: S, _y: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [S::cst(1.0), S::cst(0.0)];
    }

    fn guards<S: Real>(&self, _: (), _t: S, y: &[S; 2], g: &mut [S; 2]) {
        g[0] = -y[0] + 5.0;
        if self.writes_guard {
            g[1] = S::cst(1.0);
        }
    }

    fn guard_bounds(&self, _: (), _t: f64, _y: &[f64; 2], bounds: &mut [f64; 2]) {
        for (bound, own) in bounds.iter_mut().zip(self.bounds) {
            if let Some(own) = own {
                *bound = own;
            }
        }
    }

    fn transition<S: Real>(&self, _: (), _guard: usize, _t: S, _y: &mut [S; 2]) -> Next<()> {
        Next::Stop
    }
}

#[test]
fn a_guard_that_is_never_written_is_refused() {
    let model = Forgetful { writes_guard: false, bounds: [Some(1e-15); 2] };
    for setting in settings() {
        let (_, outcome, ..) = run(&model, &setting, (0.0, [0.0; 2]), 1.0);
        let expected = matches!(outcome, Err(Error::NonFiniteGuard { t: 0.0, guard: 1, .. }));
        assert!(expected, "{}: {outcome:?}", setting.0.name);
    }
}

#[test]
fn a_rounding_bound_that_is_not_above_zero_is_refused() {
    for bad in [Some(0.0), Some(-1.0), Some(f64::NAN), None] {
        let model = Forgetful { writes_guard: true, bounds: [Some(1e-15), bad] };
        for setting in settings() {
            let (_, outcome, ..) = run(&model, &setting, (0.0, [0.0; 2]), 1.0);
            let expected = matches!(outcome, Err(Error::BadGuardBound { t: 0.0, guard: 1, .. }));
            assert!(expected, "{} with {bad:?}: {outcome:?}", setting.0.name);
        }
    }
    let model = Forgetful { writes_guard: true, bounds: [Some(1e-15); 2] };
    for setting in settings() {
        let (_, outcome, ..) = run(&model, &setting, (0.0, [0.0; 2]), 1.0);
        assert_eq!(outcome, Ok(Outcome::Finished), "{}", setting.0.name);
    }
}

#[test]
fn a_step_that_the_span_does_not_resolve_is_refused_before_the_first_one() {
    let script = chain(&[&[5.0]]);
    for (method, control) in settings_with(1e-18) {
        let Control::Fixed(_) = control else { continue };
        let (log, outcome, ..) = run(&script, &(method, control), (0.0, [0.0; 2]), 1.0);
        let expected = matches!(outcome, Err(Error::StepUnderflow { t: 1.0, h: 1e-18, .. }));
        assert!(expected && log.steps.is_empty(), "{}: {outcome:?}", method.name);
    }
}

#[test]
fn a_relative_tolerance_beyond_f64_is_refused() {
    for (method, control) in settings() {
        let Control::Adaptive(_) = control else { continue };
        let tight = Control::Adaptive(Tolerance { rtol: 1e-16, atol: vec![1e-16; 2] });
        let refused = method.solver(&chain(&[]), tight).err();
        let expected = matches!(refused, Some(Error::BadArgument { name: "rtol", .. }));
        assert!(expected, "{}: {refused:?}", method.name);
    }
}

#[test]
fn sample_times_out_of_order_are_refused() {
    let script = chain(&[&[5.0]]);
    let run = |times: &[f64], (t0, t_end): (f64, f64), (method, control): &Setting| {
        let mut integration = Integration::new(&script, t0, [0.0; 2]);
        let mut solver = method.solver(&script, control.clone()).unwrap();
        let mut trajectory = Trajectory::on(Grid::Times(times.to_vec()));
        let outcome = integration.run(t_end, &mut *solver, &mut trajectory);
        outcome.map(|_| trajectory.samples.len())
    };
    for setting in settings() {
        for times in
            [&[0.5, 0.2][..], &[-0.1, 0.5], &[0.2, f64::NAN], &[0.2, 0.2], &[0.2, f64::INFINITY]]
        {
            let refused = run(times, (0.0, 1.0), &setting);
            let expected = matches!(refused, Err(Error::BadArgument { name: "sample time", .. }));
            assert!(expected, "{} at {times:?}: {refused:?}", setting.0.name);
        }
        assert_eq!(run(&[0.0, 0.2, 0.5, 7.0], (0.0, 1.0), &setting), Ok(3));
        assert_eq!(run(&[0.8, 0.1], (1.0, 0.0), &setting), Ok(2));
    }
}

//! Runs that only reject: the recorder is asked all the same, and may end them.

use std::fmt::Debug;
use std::ops::ControlFlow;

use deltazero_solvers::record::REJECTIONS_A_LOOK;
use deltazero_solvers::taylor::ExtendedIntegration;
use deltazero_solvers::{
    Accepted, Alike, Control, Integration, Needs, Next, Outcome, Over, Real, Record, Stats, System,
    Tolerance,
};

use crate::common::steps_itself;
use crate::log::{as_records, settings};

/// `ẏ = 1/t` from t = 0 on, where the slope is zero: `h ẏ` is no smaller for a smaller step, and none is accepted
/// that is above the least number.
struct Cliff;

/// The same without a branch, for batches: `ẏ = t/(t² + 1e-300)`.
struct Slope;

macro_rules! quadrature {
    ($name:ident, $slope:expr) => {
        impl System for $name {
            type Mode = ();
            type State<S: Real> = [S; 2];
            type Guards<S: Real> = [S; 1];

            fn initial_mode(&self, _t: f64, _y: &[f64; 2]) {}

            fn rhs<S: Real>(&self, (): (), t: S, _y: &[S; 2], dydt: &mut [S; 2]) {
                *dydt = [$slope(t), S::cst(0.0)];
            }

            fn guards<S: Real>(&self, (): (), _t: S, _y: &[S; 2], g: &mut [S; 1]) {
                *g = [S::cst(1.0)];
            }

            fn guard_bounds(&self, (): (), _t: f64, _y: &[f64; 2], bounds: &mut [f64; 1]) {
                *bounds = [f64::EPSILON];
            }

            fn transition<S: Real>(
                &self,
                (): (),
                _guard: usize,
                _t: S,
                _y: &mut [S; 2],
            ) -> Next<()> {
                Next::Stop
            }
        }
    };
}

quadrature!(Cliff, |t: S| if t.value() > 0.0 { S::cst(1.0) / t } else { S::cst(0.0) });
quadrature!(Slope, |t: S| t / (t * t + S::cst(1e-300)));

impl Alike for Slope {
    type Parameters<C: Copy + Debug> = [C; 0];

    fn parameters(&self, (): &()) -> Option<[f64; 0]> {
        Some([])
    }

    fn rhs_of<S: Over<C>, C: Copy + Debug>(_: &[C; 0], t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        Slope.rhs((), t, y, dydt);
    }

    fn guards_of<S: Over<C>, C: Copy + Debug>(_: &[C; 0], t: S, y: &[S; 2], g: &mut [S; 1]) {
        Slope.guards((), t, y, g);
    }
}

/// Ends a run at the second look.
#[derive(Default)]
struct Impatient {
    looks: Vec<u64>,
    n_steps: usize,
}

impl<P: System> Record<P> for Impatient {
    fn step(&mut self, _: &Accepted<'_, P>) -> ControlFlow<()> {
        self.n_steps += 1;
        ControlFlow::Continue(())
    }

    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()> {
        self.looks.push(stats.n_rejected);
        if self.looks.len() == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Ends
    }
}

fn tolerance() -> Tolerance {
    Tolerance { rtol: 1e-3, atol: vec![1e-3; 2] }
}

fn assert_ended(what: &str, outcome: Outcome, t: f64, seen: &Impatient) {
    assert_eq!((outcome, t, seen.n_steps), (Outcome::Interrupted, 0.0, 0), "{what}");
    assert_eq!(seen.looks, [REJECTIONS_A_LOOK, 2 * REJECTIONS_A_LOOK], "{what}");
}

#[test]
fn a_recorder_ends_a_run_that_only_rejects() {
    for (method, control) in settings() {
        // The methods of diffsol give up a step by themselves.
        if matches!(control, Control::Fixed(_)) || steps_itself(method, &Cliff) {
            continue;
        }
        let mut seen = Impatient::default();
        let mut run = Integration::new(&Cliff, 0.0, [0.0; 2]);
        let mut solver = method.solver(&Cliff, Control::Adaptive(tolerance())).unwrap();
        let outcome = run.run(1.0, &mut *solver, &mut seen).unwrap();
        assert_ended(method.name, outcome, run.point.t, &seen);
        // A pair of recorders is asked as each of them.
        let mut pair = ((), Impatient::default());
        let mut run = Integration::new(&Cliff, 0.0, [0.0; 2]);
        let mut solver = method.solver(&Cliff, Control::Adaptive(tolerance())).unwrap();
        let outcome = run.run(1.0, &mut *solver, &mut pair).unwrap();
        assert_ended(method.name, outcome, run.point.t, &pair.1);
    }
}

#[test]
fn each_run_of_a_batch_ends_by_its_own_recorder_while_it_rejects() {
    for (method, control) in settings() {
        let is_explicit = ["bs32", "rk45", "dop853", "vern98"].contains(&method.name);
        if matches!(control, Control::Fixed(_)) || !is_explicit {
            continue;
        }
        let mut runs: Vec<_> = (0..3).map(|_| Integration::new(&Slope, 0.0, [0.0; 2])).collect();
        let mut seen: Vec<_> = (0..3).map(|_| Impatient::default()).collect();
        let controls = vec![Control::Adaptive(tolerance()); 3];
        let ends = method.run_batch(&mut runs, 1.0, &controls, &mut as_records(&mut seen)).unwrap();
        for ((run, end), seen) in runs.iter().zip(ends).zip(&seen) {
            assert_ended(method.name, end.unwrap(), run.point.t, seen);
        }
    }
}

#[test]
fn a_recorder_ends_a_run_in_extended_precision_that_only_rejects() {
    let mut seen = Impatient::default();
    let mut run = ExtendedIntegration::new(&Cliff, 0.0, &[0.0; 2], tolerance());
    let outcome = run.run(1.0, &mut seen).unwrap();
    assert_ended("extended", outcome, run.t().hi(), &seen);
}

//! Runs for the tests of the mechanisms.

use deltazero_solvers::{Grid, METHODS, Method, Switch, Trajectory};
use deltazero_study::Problem;
use deltazero_study::energy_balance::{Balance, EnergyBalance};
use deltazero_study::run::{Accuracy, OwnRun, Setting, integrate};
use deltazero_study::setting::Events;

/// The method of this name at this relative tolerance, its events located.
pub(super) fn setting(method: &str, rtol: f64) -> Setting {
    let method = Method::named(method).unwrap();
    Setting { method, events: Events::Located, accuracy: Accuracy::Rtol(rtol, None) }
}

/// A run with its events located, and the events; a run that fails is a panic.
pub(super) struct Run<P: Problem> {
    pub(super) end: OwnRun<P>,
    pub(super) trajectory: Trajectory<P::State<f64>, P::Mode>,
}

impl<P: Problem> Run<P> {
    /// By the method of this name at this relative tolerance, from the start to `t_end`, with every step.
    pub(super) fn by(problem: &P, method: &str, rtol: f64, t_end: f64) -> Self {
        Self::at(problem, &setting(method, rtol), t_end)
    }

    pub(super) fn at(problem: &P, setting: &Setting, t_end: f64) -> Self {
        let mut trajectory = Trajectory::on(Grid::Steps);
        let end = integrate(problem, setting, problem.start(), t_end, &mut trajectory);
        assert!(end.outcome.is_ok(), "{}: {:?}", setting.method.name, end.outcome);
        Self { end, trajectory }
    }

    pub(super) fn events(&self) -> &[Switch<P::Mode>] {
        &self.trajectory.events
    }
}

/// Runs by every method with an error estimate at a relative tolerance of 1e-10.
pub(super) fn by_every_method<P: Problem>(
    problem: &P,
    t_end: f64,
) -> impl Iterator<Item = (&'static str, Run<P>)> {
    let adaptive = METHODS.iter().filter(|method| !method.is_fixed_step());
    adaptive.map(move |method| (method.name, Run::by(problem, method.name, 1e-10, t_end)))
}

/// The largest distance of two states, each over its scale.
pub(super) fn distance<P: Problem>(problem: &P, a: &P::State<f64>, b: &P::State<f64>) -> f64 {
    let states = problem.states().into_iter().map(|state| state.scale);
    let pairs = a.as_ref().iter().zip(b.as_ref());
    states.zip(pairs).map(|(scale, (a, b))| (a - b).abs() / scale).fold(0.0, f64::max)
}

/// The energy balance of a run by the method of this name at this relative tolerance.
pub(super) fn balance<P: Problem>(problem: &P, method: &str, rtol: f64, t_end: f64) -> Balance {
    let start = problem.start();
    let mut record = EnergyBalance::new(problem, Events::Located, &start);
    let run = integrate(problem, &setting(method, rtol), start, t_end, &mut record);
    record.at(&run.mode, run.t, &run.y).unwrap()
}

/// Fails unless numbers are those that the equations give, here computed with 30 digits, but for this part of them.
pub(super) fn assert_numbers(what: &str, bound: f64, found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (found, expected) in found.iter().zip(expected) {
        let error = (found - expected).abs();
        assert!(error <= bound * expected.abs(), "{what}: {found:e} for {expected:e}");
    }
}

//! The methods of `diffsol` on one smooth phase.

use std::fmt::Debug;

use diffsol::{
    DiffsolError, OdeBuilder, OdeSolverMethod, OdeSolverProblem, OdeSolverState,
    OdeSolverStopReason,
};
use diffsol_la::{MatrixRef, VectorRef};

use super::DiffsolScheme;
use super::algebra::{Algebra, Dense, Sparse};
use super::equations::{Equations, Places};
use super::field::Field;
use crate::error::Error;
use crate::phase::PhaseEnd;
use crate::tolerance::Tolerance;
use crate::work::Stats;

/// Longest span that `diffsol` takes for zero, and the shortest first step that is chosen for it, as a fraction of the time.
pub(super) const RESOLUTION: f64 = 100.0 * f64::EPSILON;

/// Shortest step as a fraction of the time left.
const LEAST_STEP: f64 = 1e-16;

/// A method that steps through a phase.
pub(super) trait Stepper {
    /// Has steps end at `t_end`.
    fn stop_at(&mut self, t_end: f64) -> Result<(), Error>;

    /// Takes one step, and returns whether it ends at the stop time.
    ///
    /// # Errors
    /// [`Error::NonFinite`] where a Jacobian was not finite, or a slope in a step that failed; [`Error::Diffsol`].
    fn step(&mut self) -> Result<bool, Error>;

    /// Whether Jacobians have had entries that their matrices have no place for, as where the system branches. They were
    /// left out, so the iteration of further steps would converge badly or not at all.
    fn is_outgrown(&self) -> bool;

    /// The time reached.
    fn t(&self) -> f64;

    /// The state there.
    fn y(&self) -> &[f64];

    /// The slope there.
    fn dydt(&self) -> &[f64];

    /// Writes the interpolant at `t` to `y`, beyond the last step that at its end; not a number where there is none.
    fn interpolate(&self, t: f64, y: &mut [f64]);

    /// Writes the slope of the interpolant at `t` to `dydt`, beyond the last step that at its end.
    fn interpolate_slope(&self, t: f64, dydt: &mut [f64]) -> Result<(), Error>;

    /// Adds the work done so far to `stats`.
    fn count(&self, stats: &mut Stats);
}

/// What is done with the method on a phase; `None` where it is to begin anew, [outgrown](Stepper::is_outgrown).
pub(super) type Then<'t> = &'t mut dyn FnMut(&mut dyn Stepper) -> Result<Option<PhaseEnd>, Error>;

/// A phase to be stepped through.
pub(super) struct Phase<'f> {
    pub(super) scheme: DiffsolScheme,
    pub(super) tolerance: &'f Tolerance,
    /// The equations.
    pub(super) field: &'f dyn Field,
    /// The mode that they are of, for errors.
    pub(super) mode: &'f dyn Debug,
    /// Time at its start.
    pub(super) t: f64,
    /// State at its start.
    pub(super) y: &'f [f64],
    /// Places of entries of its Jacobian beside those at its start.
    pub(super) further: &'f Places,
    /// Its length, negative where time runs backward.
    pub(super) span: f64,
    /// Size of the first step, where one is given.
    pub(super) first: Option<f64>,
}

impl Phase<'_> {
    /// Begins the phase with dense linear algebra, and hands the method to `then`.
    // Never inlined: it would be compiled for each system.
    #[inline(never)]
    pub(super) fn with_dense(&self, then: Then<'_>) -> Result<Option<PhaseEnd>, Error> {
        self.with::<Dense>(then)
    }

    /// The same with sparse linear algebra.
    #[inline(never)]
    pub(super) fn with_sparse(&self, then: Then<'_>) -> Result<Option<PhaseEnd>, Error> {
        self.with::<Sparse>(then)
    }

    fn with<A: Algebra>(&self, then: Then<'_>) -> Result<Option<PhaseEnd>, Error>
    where
        for<'b> &'b A::V: VectorRef<A::V>,
        for<'b> &'b A::M: MatrixRef<A::M>,
    {
        let refused = |error| failure(self.t, self.mode, &error);
        let mut built = OdeBuilder::<A::M>::new()
            .t0(self.t)
            .rtol(self.tolerance.rtol)
            .atol(self.tolerance.atol.iter().copied())
            .build_from_eqn(Equations::<A>::new(self.field, (self.t, self.y), self.further))
            .map_err(refused)?;
        built.ode_options.max_nonlinear_solver_failures = usize::MAX;
        built.ode_options.min_timestep = LEAST_STEP * self.span.abs();
        let (equations, mode) = (&built.eqn, self.mode);
        macro_rules! hand {
            ($solver:ident $(::<$linear:ty>)?) => {{
                let solver = built.$solver$(::<$linear>)?(self.started(&built)?).map_err(refused)?;
                then(&mut OnPhase { solver, equations, mode, t0: self.t })
            }};
        }
        match self.scheme {
            DiffsolScheme::Bdf => hand!(bdf_solver::<A::Solver>),
            DiffsolScheme::TrBdf2 => hand!(tr_bdf2_solver::<A::Solver>),
            DiffsolScheme::Esdirk34 => hand!(esdirk34_solver::<A::Solver>),
            DiffsolScheme::Tsit45 => hand!(tsit45_solver),
        }
    }

    /// A solver state of `diffsol` at the start of `built`, with a first step towards the end of the phase: the given one, or
    /// one chosen for the order with which the method starts. The rule of diffsol has no lower limit: where
    /// the state is small beside its slope, as between the last bounces of a ball, its step is below the shortest one.
    fn started<A: Algebra, S: OdeSolverState<A::V>>(
        &self,
        built: &OdeSolverProblem<Equations<'_, A>>,
    ) -> Result<S, Error> {
        let refused = |error| failure(self.t, self.mode, &error);
        let mut start = S::new_without_initialise(built).map_err(refused)?;
        let slope = A::components(start.as_ref().dy);
        if let Some(component) = slope.iter().position(|d| !d.is_finite()) {
            return Err(non_finite(self.t, self.mode, component));
        }
        let sign = 1_f64.copysign(self.span);
        let order = self.scheme.starting_order();
        start.as_mut().set_step_size(sign, &built.atol, built.rtol, &built.eqn, order);
        let h = start.as_mut().h;
        let resolved = RESOLUTION * (self.t.abs() + self.span.abs());
        let first = self.first.unwrap_or(h.abs().max(resolved));
        *h = first.min(self.span.abs()).copysign(self.span);
        Ok(start)
    }
}

/// A method of `diffsol` on the `equations` of a `mode`.
struct OnPhase<'a, 'f, A: Algebra, S> {
    solver: S,
    equations: &'a Equations<'f, A>,
    mode: &'a dyn Debug,
    /// Start of the last step.
    t0: f64,
}

impl<'a, 'f: 'a, A: Algebra, S: OdeSolverMethod<'a, Equations<'f, A>>> OnPhase<'a, 'f, A, S> {
    /// `t`, or the time reached where that is beyond.
    fn within(&self, t: f64) -> f64 {
        let reached = self.t();
        if (t - reached) * (reached - self.t0) > 0.0 { reached } else { t }
    }
}

impl<'a, 'f: 'a, A: Algebra, S: OdeSolverMethod<'a, Equations<'f, A>>> Stepper
    for OnPhase<'a, 'f, A, S>
{
    fn stop_at(&mut self, t_end: f64) -> Result<(), Error> {
        let t = self.t();
        self.solver.set_stop_time(t_end).map_err(|error| failure(t, self.mode, &error))
    }

    fn step(&mut self) -> Result<bool, Error> {
        self.t0 = self.t();
        let reason = self.solver.step();
        let of_failed = || self.equations.non_finite.get().filter(|_| reason.is_err());
        if let Some(component) = self.equations.non_finite_row.get().or_else(of_failed) {
            return Err(non_finite(self.t0, self.mode, component));
        }
        let reason = reason.map_err(|error| failure(self.t0, self.mode, &error))?;
        Ok(reason == OdeSolverStopReason::TstopReached)
    }

    fn is_outgrown(&self) -> bool {
        self.equations.is_outgrown.get()
    }

    fn t(&self) -> f64 {
        self.solver.state().t
    }

    fn y(&self) -> &[f64] {
        A::components(self.solver.state().y)
    }

    fn dydt(&self) -> &[f64] {
        A::components(self.solver.state().dy)
    }

    fn interpolate(&self, t: f64, y: &mut [f64]) {
        match self.solver.interpolate(self.within(t)) {
            Ok(found) => y.copy_from_slice(A::components(&found)),
            Err(_) => y.fill(f64::NAN),
        }
    }

    fn interpolate_slope(&self, t: f64, dydt: &mut [f64]) -> Result<(), Error> {
        let found = self.solver.interpolate_dy(self.within(t));
        let found = found.map_err(|error| failure(self.t0, self.mode, &error))?;
        dydt.copy_from_slice(A::components(&found));
        Ok(())
    }

    fn count(&self, stats: &mut Stats) {
        let done = self.solver.get_statistics();
        let rejected = done.number_of_error_test_failures + done.number_of_nonlinear_solver_fails;
        stats.work.n_rhs += self.equations.n_rhs.get();
        stats.n_accepted += done.number_of_steps as u64;
        stats.n_rejected += rejected as u64;
        stats.work.n_jac += self.equations.n_jac.get();
        stats.work.n_factorisations += done.number_of_linear_solver_setups as u64;
        stats.work.n_lin_solves += done.number_of_nonlinear_solver_iterations as u64;
    }
}

fn failure(t: f64, mode: &dyn Debug, error: &DiffsolError) -> Error {
    Error::Diffsol { t, mode: format!("{mode:?}"), message: error.to_string() }
}

fn non_finite(t: f64, mode: &dyn Debug, component: usize) -> Error {
    Error::NonFinite { t, mode: format!("{mode:?}"), component }
}

//! The models by the crate `diffsol`: tsit45, BDF, TR-BDF2, ESDIRK34, their root finding with modes frozen, their dense output at
//! the samples.
//!
//! Vectors and dense matrices are those of nalgebra; matrices of the carts are sparse, of faer: 0.2 to 0.7 of the time.
//!
//! Traps worked around: every mode gets a solver of its own, as slope, step and Jacobian are of the mode before; an instant that is
//! known is its stop time; guards have no direction and are blind at zero, so on the surface they are inside; several may fall in one
//! step, so all are looked at after moving back; the absolute tolerance of the rocking block shrinks with its flights, as in `../../cvode`.

mod models;

use std::cell::RefCell;
use std::error::Error;
use std::path::Path;

use diffsol::matrix::MatrixRef;
use diffsol::ode_solver::state::StateCommon;
use diffsol::{
    BdfState, DefaultDenseMatrix, FaerSparseLU, FaerSparseMat, LinearSolver, Matrix, NalgebraLU,
    NalgebraMat, NonLinearOp, OdeBuilder, OdeEquations, OdeEquationsImplicit, OdeSolverMethod,
    OdeSolverProblem, OdeSolverState, OdeSolverStopReason, RkState, StateRefMut, Vector, VectorRef,
};
use models::{BuckConverter, Carts, IntegrateAndFire, Model, RockingBlock, VanDerPol};

use crate::{Delivered, tell, tolerances};

/// A run with more events than this chatters.
const MOST_EVENTS: u64 = 5000;
/// Guards that fall at one instant.
const MOST_AT_ONCE: usize = 200;

#[derive(Clone, Copy)]
enum Method {
    Tsit45,
    Bdf,
    TrBdf2,
    Esdirk34,
}

/// A method, its name, and the order its first step is chosen by.
type Named = (Method, &'static str, usize);

const EXPLICIT: [Named; 1] = [(Method::Tsit45, "tsit45", 5)];
const IMPLICIT: [Named; 3] =
    [(Method::Bdf, "bdf", 1), (Method::TrBdf2, "tr_bdf2", 2), (Method::Esdirk34, "esdirk34", 3)];
const ALL: [Named; 4] = [EXPLICIT[0], IMPLICIT[0], IMPLICIT[1], IMPLICIT[2]];

/// The states at the sample times, one after the other, as far as they are known.
struct Samples<'a, V> {
    times: &'a [f64],
    states: Vec<f64>,
    taken: usize,
    state: V,
}

impl<V: Vector<T = f64>> Samples<'_, V> {
    /// Takes those up to `t` from the last step.
    fn take<'a, E: OdeEquations<T = f64, V = V> + 'a>(
        &mut self,
        solver: &impl OdeSolverMethod<'a, E>,
        t: f64,
    ) -> Result<(), Box<dyn Error>> {
        while self.taken < self.times.len() && self.times[self.taken] <= t {
            let at = self.times[self.taken].min(solver.state().t);
            solver.interpolate_inplace(at, &mut self.state)?;
            self.states.extend((0..self.state.len()).map(|i| self.state.get_index(i)));
            self.taken += 1;
        }
        Ok(())
    }
}

/// The state at the end of a mode, and the guard that fell.
type Ended<V> = (StateCommon<V>, Option<usize>);

/// Steps to the end of a mode.
fn phase<'a, E: OdeEquations<T = f64> + 'a>(
    mut solver: impl OdeSolverMethod<'a, E>,
    end: f64,
    samples: &mut Samples<'_, E::V>,
) -> Result<Ended<E::V>, Box<dyn Error>> {
    solver.set_stop_time(end)?;
    let fallen = loop {
        match solver.step()? {
            OdeSolverStopReason::InternalTimestep => samples.take(&solver, solver.state().t)?,
            OdeSolverStopReason::TstopReached => {
                samples.take(&solver, end)?;
                break None;
            }
            OdeSolverStopReason::RootFound(t, guard) => {
                samples.take(&solver, t)?;
                solver.state_mut_back(t)?;
                break Some(guard);
            }
        }
    };
    Ok((solver.into_state().into_common(), fallen))
}

/// The start of a phase: a fresh slope, and a first step of order `order`; of what rests all of it.
fn started<E: OdeEquations<T = f64>, S: OdeSolverState<E::V>>(
    problem: &OdeSolverProblem<E>,
    mut common: StateCommon<E::V>,
    end: f64,
    order: usize,
) -> S {
    problem.eqn.rhs().call_inplace(&common.y, common.t, &mut common.dy);
    let span = end - common.t;
    let mut start = S::new_from_common(common);
    let mut state = start.as_mut();
    state.set_step_size(1.0, &problem.atol, problem.rtol, &problem.eqn, order);
    let StateRefMut { dy, h, .. } = start.as_mut();
    let rests = (0..dy.len()).all(|i| dy.get_index(i) == 0.0);
    *h = if rests { span } else { h.min(span) };
    start
}

/// One run.
fn run<M: Model, E, LS>(
    problem: &mut OdeSolverProblem<E>,
    model: &RefCell<M>,
    (method, order): (Method, usize),
    times: &[f64],
) -> Result<Delivered, Box<dyn Error>>
where
    E: OdeEquationsImplicit<T = f64>,
    E::V: DefaultDenseMatrix,
    for<'b> &'b E::V: VectorRef<E::V>,
    for<'b> &'b E::M: MatrixRef<E::M>,
    LS: LinearSolver<E::M>,
{
    *model.borrow_mut() = M::default();
    let mut common = RkState::<E::V>::new_without_initialise(problem)?.into_common();
    let mut samples = Samples {
        times,
        states: Vec::with_capacity(times.len() * common.y.len()),
        taken: 0,
        state: common.y.clone(),
    };
    let mut g = vec![1.0; M::N_GUARDS];
    let rtol = problem.rtol;
    let mut n_events = 0;
    loop {
        for (i, scale) in model.borrow().scale().into_iter().enumerate() {
            problem.atol.set_index(i, rtol * scale);
        }
        let end = model.borrow().until().min(M::T_END);
        let (problem, samples) = (&*problem, &mut samples);
        let mut fallen;
        (common, fallen) = match method {
            Method::Tsit45 => {
                phase(problem.tsit45_solver(started(problem, common, end, order))?, end, samples)?
            }
            Method::Bdf => {
                let start: BdfState<E::V> = started(problem, common, end, order);
                phase(problem.bdf_solver::<LS>(start)?, end, samples)?
            }
            Method::TrBdf2 => phase(
                problem.tr_bdf2_solver::<LS>(started(problem, common, end, order))?,
                end,
                samples,
            )?,
            Method::Esdirk34 => phase(
                problem.esdirk34_solver::<LS>(started(problem, common, end, order))?,
                end,
                samples,
            )?,
        };
        let mut y = common.y.clone_as_vec();
        if y.iter().any(|y| !y.is_finite()) {
            return Err(format!("not finite at t = {} s", common.t).into());
        }
        if fallen.is_none() && end == M::T_END {
            return Ok((std::mem::take(&mut samples.states), n_events));
        }
        for _ in 0..MOST_AT_ONCE {
            model.borrow_mut().jump(fallen, common.t, &mut y)?;
            n_events += 1;
            model.borrow().guards(&y, &mut g);
            fallen = g.iter().position(|g| *g < 0.0);
            if fallen.is_none() {
                break;
            }
        }
        if n_events > MOST_EVENTS {
            return Err(format!("more than {MOST_EVENTS} events").into());
        }
        for (i, y) in y.into_iter().enumerate() {
            common.y.set_index(i, y);
        }
    }
}

/// All runs of a model by these methods.
fn ladders<M: Model, Ma, LS>(
    methods: &[Named],
    times: &[f64],
    folder: &Path,
) -> Result<(), Box<dyn Error>>
where
    Ma: Matrix<T = f64>,
    Ma::V: DefaultDenseMatrix,
    for<'b> &'b Ma::V: VectorRef<Ma::V>,
    for<'b> &'b Ma: MatrixRef<Ma>,
    LS: LinearSolver<Ma>,
{
    for &(method, name, order) in methods {
        for tolerance in tolerances() {
            let model = RefCell::new(M::default());
            let start = M::default().start();
            let n = start.len();
            let mut problem = OdeBuilder::<Ma>::new()
                .rtol(tolerance.parse()?)
                .atol(vec![1.0; n])
                .rhs_implicit(
                    |y: &[f64], _p: &[f64], _t, dydt: &mut [f64]| model.borrow().rates(y, dydt),
                    |y: &[f64], _p: &[f64], _t, v: &[f64], jv: &mut [f64]| {
                        model.borrow().jacobian_times(y, v, jv)
                    },
                )
                .init(|_p: &[f64], _t, y: &mut [f64]| y.copy_from_slice(&start), n)
                .root(
                    |y: &[f64], _p: &[f64], _t, g: &mut [f64]| model.borrow().guards(y, g),
                    M::N_GUARDS,
                )
                .build()?;
            // The first counts over the life of a solver, the second is absolute.
            problem.ode_options.max_nonlinear_solver_failures = usize::MAX;
            problem.ode_options.min_timestep = 1e-16;
            let run = || run::<M, _, LS>(&mut problem, &model, (method, order), times);
            if !tell(["diffsol", name, &tolerance], n, folder, run)? {
                break;
            }
        }
    }
    Ok(())
}

/// All runs of the model of this name.
pub(crate) fn model(name: &str, times: &[f64], folder: &Path) -> Result<(), Box<dyn Error>> {
    match name {
        VanDerPol::NAME => by_nalgebra::<VanDerPol>(&IMPLICIT, times, folder),
        IntegrateAndFire::NAME => by_nalgebra::<IntegrateAndFire>(&ALL, times, folder),
        BuckConverter::NAME => by_nalgebra::<BuckConverter>(&ALL, times, folder),
        RockingBlock::NAME => by_nalgebra::<RockingBlock>(&ALL, times, folder),
        Carts::NAME => {
            by_nalgebra::<Carts>(&EXPLICIT, times, folder)?;
            ladders::<Carts, FaerSparseMat<f64>, FaerSparseLU<f64>>(&IMPLICIT, times, folder)
        }
        _ => Err(format!("unknown: {name}").into()),
    }
}

/// All runs of a model with dense matrices.
fn by_nalgebra<M: Model>(
    methods: &[Named],
    times: &[f64],
    folder: &Path,
) -> Result<(), Box<dyn Error>> {
    ladders::<M, NalgebraMat<f64>, NalgebraLU<f64>>(methods, times, folder)
}

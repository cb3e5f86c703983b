//! The crate `diffsol`, used directly: BDF, TR-BDF2, ESDIRK34, Tsit45; naive, and with events by its
//! own root finding.
//!
//! Traps worked around, all in the located runs: a guard that is exactly zero at the start of a step
//! is blind there, so guards within rounding of zero are given the sign of the inside; several guards
//! may fall in one step, so all are looked at after moving back; the slope, the step and the Jacobian of
//! before an event are stale, so every smooth phase gets a solver of its own. Flights shorter than
//! one step are invisible to it (signs at step ends only), and that is left as it is.

use std::cell::Cell;
use std::error::Error;

use deltazero::model::contact::Onset;
use deltazero::model::mode::N_GUARDS;
use deltazero::model::{Block, Mode, State};
use deltazero_solvers::{ModeOfState, Next, System};
use deltazero_study::run::ModeChange;
use diffsol::{
    BdfState, NalgebraContext, NalgebraLU, NalgebraMat, NalgebraVec, NonLinearOp, OdeBuilder,
    OdeEquations, OdeSolverMethod, OdeSolverProblem, OdeSolverState, OdeSolverStopReason, RkState,
    Vector as _, VectorCommon,
};
use num_dual::Dual64;

use crate::entry::{Entry, Handling, atol, ladder};
use crate::naive;
use crate::problem::{Problem, Track, Watch};

/// Name and version of the tool.
const TOOL: (&str, &str) = ("diffsol", "0.18.0");
/// What a guard within rounding of zero becomes.
const INSIDE: f64 = 1e-100;

type M = NalgebraMat<f64>;
type V = NalgebraVec<f64>;
type LU = NalgebraLU<f64>;

/// A method: its name and the order its first step is chosen by.
#[derive(Clone, Copy, PartialEq)]
enum Method {
    Tsit45,
    Bdf,
    Esdirk34,
    TrBdf2,
}

const METHODS: [(&str, Method, usize); 4] = [
    ("tsit45", Method::Tsit45, 5),
    ("bdf", Method::Bdf, 1),
    ("esdirk34", Method::Esdirk34, 3),
    ("tr_bdf2", Method::TrBdf2, 2),
];

/// All methods, located and naive.
pub(super) fn entries(problem: &Problem) -> Vec<Entry<'_>> {
    let handled = METHODS
        .into_iter()
        .flat_map(|method| [Handling::Located, Handling::Naive].map(|handling| (method, handling)));
    handled
        .flat_map(|((name, method, order), handling)| {
            ladder().map(move |rtol| {
                let run = move || {
                    problem.both(|block| match handling {
                        Handling::Located => located(problem, block, (method, order), rtol),
                        Handling::Naive => naive_run(problem, block, (method, order), rtol),
                    })
                };
                Entry::new(TOOL, (name, handling), rtol, run)
            })
        })
        .collect()
}

/// Samples of a run, filled step by step.
struct Samples<'a> {
    times: &'a [f64],
    states: Vec<State<f64>>,
}

impl<'t> Samples<'t> {
    fn new(times: &'t [f64]) -> Self {
        Self { times, states: Vec::with_capacity(times.len()) }
    }

    /// Takes those up to `t` from the interpolant of the last step.
    fn take<'a, E: OdeEquations<T = f64, V = V, M = M, C = NalgebraContext> + 'a>(
        &mut self,
        solver: &impl OdeSolverMethod<'a, E>,
        t: f64,
    ) -> Result<(), Box<dyn Error>> {
        let reached = solver.state().t;
        while let Some(&at) = self.times.get(self.states.len()).filter(|&&at| at <= t) {
            let y = solver.interpolate(at.min(reached))?;
            self.states.push(naive::state(y.inner().as_slice()));
        }
        Ok(())
    }
}

/// `ẏ = f(y)` in the mode that the parameter names, or in that of the state; with `J v` by a dual number.
macro_rules! equations {
    ($block:ident, $rtol:ident, $n_rhs:ident, $mode:expr) => {
        OdeBuilder::<M>::new()
            .p([f64::from(Mode::Apart.code())])
            .rtol($rtol)
            .atol(atol($block, $rtol))
            .rhs_implicit(
                |y: &[f64], p: &[f64], _t, dydt: &mut [f64]| {
                    $n_rhs.set($n_rhs.get() + 1);
                    let (y, mut slope) = (naive::state(y), [0.0; 6]);
                    $block.rhs($mode(p, &y), 0.0, &y, &mut slope);
                    dydt.copy_from_slice(&slope);
                },
                |y: &[f64], p: &[f64], _t, v: &[f64], jv: &mut [f64]| {
                    let along: State<Dual64> = std::array::from_fn(|i| Dual64::new(y[i], v[i]));
                    let mut slope = [Dual64::from_re(0.0); 6];
                    let mode = $mode(p, &naive::state(y));
                    $block.rhs(mode, Dual64::from_re(0.0), &along, &mut slope);
                    for (jv, slope) in jv.iter_mut().zip(slope) {
                        *jv = slope.eps;
                    }
                },
            )
            .init(|_p: &[f64], _t, y: &mut [f64]| y.copy_from_slice(&$block.initial_state()), 6)
    };
}

/// Runs `$phase` on a solver of `$method` that starts from `$common`.
macro_rules! with_solver {
    ($problem:ident, $method:ident, $common:ident, $t_end:ident, $solver:ident => $phase:expr) => {
        match $method {
            (Method::Bdf, order) => {
                let start: BdfState<V> = started!($problem, $common, $t_end, order);
                let mut $solver = $problem.bdf_solver::<LU>(start)?;
                $phase
            }
            (Method::Tsit45, order) => {
                let start: RkState<V> = started!($problem, $common, $t_end, order);
                let mut $solver = $problem.tsit45_solver(start)?;
                $phase
            }
            (Method::Esdirk34, order) => {
                let start: RkState<V> = started!($problem, $common, $t_end, order);
                let mut $solver = $problem.esdirk34_solver::<LU>(start)?;
                $phase
            }
            (Method::TrBdf2, order) => {
                let start: RkState<V> = started!($problem, $common, $t_end, order);
                let mut $solver = $problem.tr_bdf2_solver::<LU>(start)?;
                $phase
            }
        }
    };
}

/// A state with a fresh slope and first step from `$common`.
macro_rules! started {
    ($problem:ident, $common:ident, $t_end:ident, $order:ident) => {{
        let mut common = $common;
        $problem.eqn.rhs().call_inplace(&common.y, common.t, &mut common.dy);
        let span = $t_end - common.t;
        let mut start = OdeSolverState::new_from_common(common);
        let mut state = OdeSolverState::<V>::as_mut(&mut start);
        state.set_step_size(1.0, &$problem.atol, $problem.rtol, &$problem.eqn, $order);
        let h = OdeSolverState::<V>::as_mut(&mut start).h;
        *h = h.min(span);
        start
    }};
}

/// A run whose right-hand side reads its mode off the state.
fn naive_run(
    problem: &Problem,
    block: &Block,
    method: (Method, usize),
    rtol: f64,
) -> Result<Track, Box<dyn Error>> {
    let n_rhs = Cell::new(0);
    let mode = |_: &[f64], y: &State<f64>| block.mode_of_state(0.0, y);
    let mut built = equations!(block, rtol, n_rhs, mode).build()?;
    unlimited(&mut built);
    let t_end = problem.t_end;
    let mut samples = Samples::new(&problem.times);
    let mut watch = Watch::new();
    let common = RkState::<V>::new_without_initialise(&built)?.into_common();
    with_solver!(built, method, common, t_end, solver => {
        solver.set_stop_time(t_end)?;
        loop {
            let reason = solver.step()?;
            let at_end = matches!(reason, OdeSolverStopReason::TstopReached);
            let reached = solver.state().t;
            samples.take(&solver, if at_end { t_end } else { reached })?;
            watch.look(block, reached, &naive::state(solver.state().y.inner().as_slice()));
            if at_end {
                break;
            }
        }
    });
    Ok(Track { samples: samples.states, events: watch.events, n_rhs: Some(n_rhs.get()) })
}

/// A run in frozen modes, one solver a smooth phase.
fn located(
    problem: &Problem,
    block: &Block,
    method: (Method, usize),
    rtol: f64,
) -> Result<Track, Box<dyn Error>> {
    let n_rhs = Cell::new(0);
    let mode = |p: &[f64], _: &State<f64>| mode_of(p[0]);
    let guards = |y: &[f64], p: &[f64], _t: f64, g: &mut [f64]| {
        g.copy_from_slice(&guards_of(block, p[0], &naive::state(y)))
    };
    let mut built = equations!(block, rtol, n_rhs, mode).root(guards, N_GUARDS).build()?;
    unlimited(&mut built);
    let t_end = problem.t_end;
    let mut samples = Samples::new(&problem.times);
    let mut events = Vec::new();
    let mut common = RkState::<V>::new_without_initialise(&built)?.into_common();
    let mut before = Mode::Apart;
    loop {
        let parameter = V::from_vec(vec![f64::from(before.code())], NalgebraContext::default());
        built.eqn_mut().set_params(&parameter);
        let fallen;
        (common, fallen) = with_solver!(built, method, common, t_end, solver => {
            solver.set_stop_time(t_end)?;
            let fallen = loop {
                match solver.step()? {
                    OdeSolverStopReason::InternalTimestep => {
                        let reached = solver.state().t;
                        samples.take(&solver, reached)?;
                    }
                    OdeSolverStopReason::TstopReached => {
                        samples.take(&solver, t_end)?;
                        break None;
                    }
                    OdeSolverStopReason::RootFound(t, guard) => {
                        samples.take(&solver, t)?;
                        solver.state_mut_back(t)?;
                        break Some(guard);
                    }
                }
            };
            (solver.into_state().into_common(), fallen)
        });
        let Some(mut guard) = fallen else {
            return Ok(Track { samples: samples.states, events, n_rhs: Some(n_rhs.get()) });
        };
        let mut y = naive::state(common.y.inner().as_slice());
        if events.len() > MAX_EVENTS {
            return Err(format!("chatter at t = {} s", common.t).into());
        }
        // Guards that fell together, one after the other.
        for _ in 0..MAX_SWITCHES {
            let Next::Mode(after) = block.transition(before, guard, common.t, &mut y) else {
                return Err("the struts line up".into());
            };
            events.push(ModeChange::new(common.t, before.code(), after.code()));
            before = after;
            let g = guards_of(block, f64::from(before.code()), &y);
            match g.iter().position(|g| *g < 0.0) {
                Some(next) => guard = next,
                None => break,
            }
        }
        common.y.inner_mut().as_mut_slice().copy_from_slice(&y);
    }
}

/// A run with more events than this chatters.
const MAX_EVENTS: usize = 100_000;
/// Switches at one instant.
const MAX_SWITCHES: usize = 16;

/// The mode with that code.
fn mode_of(code: f64) -> Mode {
    match code as i8 {
        1 => Mode::SlipPlus(Onset::PLAIN),
        -1 => Mode::SlipMinus(Onset::PLAIN),
        2 => Mode::Stick(Onset::PLAIN),
        _ => Mode::Apart,
    }
}

/// The guards of a mode, those within rounding of zero on its inside.
fn guards_of(block: &Block, code: f64, y: &State<f64>) -> [f64; N_GUARDS] {
    let mode = mode_of(code);
    let (mut g, mut bounds) = ([0.0; N_GUARDS], [0.0; N_GUARDS]);
    block.guards(mode, 0.0, y, &mut g);
    block.guard_bounds(mode, 0.0, y, &mut bounds);
    std::array::from_fn(|i| if g[i].abs() <= bounds[i] { INSIDE } else { g[i] })
}

/// Lifts the limits that count over the life of a solver or are absolute.
fn unlimited<E: OdeEquations<T = f64, V = V, M = M, C = NalgebraContext>>(
    built: &mut OdeSolverProblem<E>,
) {
    built.ode_options.max_nonlinear_solver_failures = usize::MAX;
    built.ode_options.min_timestep = 1e-16;
}

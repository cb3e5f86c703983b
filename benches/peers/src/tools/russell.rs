//! The crate `russell_ode`: DoPri5, DoPri8 and Radau5, naive, since it has no events. It is pure Rust
//! by default (its own linear algebra): no system library is linked.

use std::error::Error;

use deltazero::model::{Block, State};
use russell_lab::Vector;
use russell_ode::{Method, OdeSolver, Output, Params, System};
use russell_sparse::Sym;

use crate::entry::{Entry, Handling, ladder, scalar_atol};
use crate::naive;
use crate::problem::{Problem, Track, Watch};

/// Name and version of the tool.
const TOOL: (&str, &str) = ("russell_ode", "5.0.0");
/// Its limit of steps; the default is 100,000.
const MAX_STEPS: usize = 100_000_000;
/// The least absolute tolerance that it takes.
const LEAST_ATOL: f64 = 11.0 * f64::EPSILON;
/// The methods.
const METHODS: [(&str, Method); 3] =
    [("dopri5", Method::DoPri5), ("dopri8", Method::DoPri8), ("radau5", Method::Radau5)];

/// What its callbacks fill.
struct Kept {
    samples: Vec<State<f64>>,
    watch: Watch,
}

/// All methods.
pub(super) fn entries(problem: &Problem) -> Vec<Entry<'_>> {
    METHODS
        .into_iter()
        .flat_map(|(name, method)| {
            ladder().map(move |rtol| {
                let run = move || problem.both(|block| solve(problem, block, method, rtol));
                Entry::new(TOOL, (name, Handling::Naive), rtol, run)
            })
        })
        .collect()
}

fn solve(
    problem: &Problem,
    block: &Block,
    method: Method,
    rtol: f64,
) -> Result<Track, Box<dyn Error>> {
    let mut system = System::new(6, |dydt: &mut Vector, _t, y: &Vector, _: &mut Kept| {
        let mut slope = [0.0; 6];
        naive::rhs(block, &naive::state(y.as_data()), &mut slope);
        dydt.as_mut_data().copy_from_slice(&slope);
        Ok(())
    });
    system.set_jacobian(None, Sym::No, |jacobian, alpha, _t, y: &Vector, _: &mut Kept| {
        jacobian.reset();
        let mut outcome = Ok(());
        naive::jacobian(block, &naive::state(y.as_data()), |i, j, entry| {
            outcome = outcome.and_then(|()| jacobian.put(i, j, alpha * entry));
        });
        outcome
    })?;
    let mut params = Params::new(method);
    params.set_tolerances(scalar_atol(block, rtol).max(LEAST_ATOL), rtol, None)?;
    params.step.n_step_max = MAX_STEPS;
    // One thread, as everywhere here; the default solves Radau's two systems on two.
    params.radau5.concurrent = false;
    let mut output = Output::new();
    output.set_step_callback(|_, _h, t, y, kept: &mut Kept| {
        kept.watch.look(block, t, &naive::state(y.as_data()));
        Ok(false)
    });
    let inner = &problem.times[..problem.times.len() - 1];
    output.set_dense_x_out(inner)?.set_dense_callback(|_, _h, t, y, kept: &mut Kept| {
        if t > 0.0 {
            kept.samples.push(naive::state(y.as_data()));
        }
        Ok(false)
    });
    let mut kept = Kept { samples: Vec::with_capacity(problem.times.len()), watch: Watch::new() };
    let mut y = Vector::from(&block.initial_state());
    let mut solver = OdeSolver::new(params, system)?;
    solver.solve(&mut y, 0.0, problem.t_end, None, &mut kept, Some(&mut output))?;
    let n_rhs = Some(solver.stats().n_function as u64);
    Ok(Track { samples: kept.samples, events: kept.watch.events, n_rhs })
}

//! The crate `differential-equations`: dopri5 and dop853, naive, since a located event does not
//! restart its methods.

use std::error::Error;

use deltazero::model::{Block, State};
use differential_equations::control::ControlFlag;
use differential_equations::interpolate::Interpolation;
use differential_equations::methods::ExplicitRungeKutta;
use differential_equations::ode::{ODE, OrdinaryNumericalMethod, solve_ode};
use differential_equations::solout::Solout;
use differential_equations::solution::Solution;

use crate::entry::{Entry, Handling, atol, ladder};
use crate::naive;
use crate::problem::{Problem, Track, Watch};

/// Name and version of the tool.
const TOOL: (&str, &str) = ("differential-equations", "0.7.0");
/// Its limit of steps; the default is 10,000.
const MAX_STEPS: usize = 100_000_000;

type Y = State<f64>;

struct Joint<'a>(&'a Block);

impl ODE<f64, Y> for Joint<'_> {
    fn diff(&self, _t: f64, y: &Y, dydt: &mut Y) {
        naive::rhs(self.0, y, dydt);
    }
}

/// Samples and mode changes.
struct Keep<'a> {
    block: &'a Block,
    times: &'a [f64],
    watch: Watch,
    samples: Vec<Y>,
}

impl Solout<f64, Y> for Keep<'_> {
    fn solout<I: Interpolation<f64, Y> + ?Sized>(
        &mut self,
        t: f64,
        _t_prev: f64,
        y: &Y,
        _y_prev: &Y,
        interpolant: &mut I,
        _solution: &mut Solution<f64, Y>,
    ) -> ControlFlag<f64, Y> {
        while let Some(&sample) = self.times.get(self.samples.len()).filter(|&&at| at <= t) {
            match interpolant.interpolate(sample) {
                Ok(y) => self.samples.push(y),
                Err(_) => return ControlFlag::Terminate,
            }
        }
        self.watch.look(self.block, t, y);
        ControlFlag::Continue
    }
}

/// Both methods.
pub(super) fn entries(problem: &Problem) -> Vec<Entry<'_>> {
    let dopri5 = ladder().map(|rtol| {
        let run = move || {
            problem.both(|block| {
                let method = ExplicitRungeKutta::dopri5().max_steps(MAX_STEPS);
                solve(problem, block, method.rtol(rtol).atol(atol(block, rtol)))
            })
        };
        Entry::new(TOOL, ("dopri5", Handling::Naive), rtol, run)
    });
    let dop853 = ladder().map(|rtol| {
        let run = move || {
            problem.both(|block| {
                let method = ExplicitRungeKutta::dop853().max_steps(MAX_STEPS);
                solve(problem, block, method.rtol(rtol).atol(atol(block, rtol)))
            })
        };
        Entry::new(TOOL, ("dop853", Handling::Naive), rtol, run)
    });
    dopri5.chain(dop853).collect()
}

fn solve(
    problem: &Problem,
    block: &Block,
    mut method: impl OrdinaryNumericalMethod<f64, Y> + Interpolation<f64, Y>,
) -> Result<Track, Box<dyn Error>> {
    let (times, y0) = (&problem.times, block.initial_state());
    let samples = Vec::with_capacity(times.len());
    let mut keep = Keep { block, times, watch: Watch::new(), samples };
    let solution = solve_ode(&mut method, &Joint(block), 0.0, problem.t_end, &y0, &mut keep);
    let solution = solution.map_err(|error| format!("{error:?}"))?;
    let n_rhs = Some(solution.evals.function as u64);
    Ok(Track { samples: keep.samples, events: keep.watch.events, n_rhs })
}

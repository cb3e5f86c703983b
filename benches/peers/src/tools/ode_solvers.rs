//! The crate `ode_solvers`: Dopri5 and Dop853, naive, since it has no events.
//!
//! Its dense output at 0.01 s is what is timed. The callback of a step is then shown the last sample
//! rather than the step, so mode changes are seen by a second run without dense output, not timed.

use std::error::Error;

use deltazero::model::Block;
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, Dopri5, SVector, System};

use crate::entry::{Entry, Handling, ladder, scalar_atol};
use crate::naive;
use crate::problem::{Problem, Track, Watch};

/// Name and version of the tool.
const TOOL: (&str, &str) = ("ode_solvers", "0.6.2");
/// The run ends this much later [s]: a sample at its very end is extrapolated from the step before
/// (`solution_output` asks whether it is near the end, not whether the step has reached it).
const OVERSHOOT: f64 = 1e-6;
/// Its limit of steps; the default is 100,000.
const MAX_STEPS: u32 = 100_000_000;

type Y = SVector<f64, 6>;

struct Joint<'a>(&'a Block);

impl System<f64, Y> for Joint<'_> {
    fn system(&self, _t: f64, y: &Y, dydt: &mut Y) {
        naive::rhs(self.0, &y.data.0[0], &mut dydt.data.0[0]);
    }
}

/// Both methods.
pub(super) fn entries(problem: &Problem) -> Vec<Entry<'_>> {
    let ladders = ["dopri5", "dop853"]
        .into_iter()
        .flat_map(|method| ladder().map(move |rtol| (method, rtol)));
    ladders
        .map(|(method, rtol)| {
            let run = move |output: fn() -> OutputType| {
                problem.both(|block| match method {
                    "dopri5" => dopri5(problem, block, rtol, output()),
                    _ => dop853(problem, block, rtol, output()),
                })
            };
            let timed = move || run(|| OutputType::Dense);
            let mut entry = Entry::new(TOOL, (method, Handling::Naive), rtol, timed);
            entry.see_events = Some(Box::new(move || run(|| OutputType::Sparse)));
            entry
        })
        .collect()
}

/// One function for each of both types, which share no trait. Safety factor, β, bounds of the
/// step's change and the stiffness test are the crate's defaults.
macro_rules! method {
    ($name:ident, $solver:ident, $beta:expr, $fac_min:expr, $fac_max:expr) => {
        fn $name(
            problem: &Problem,
            block: &Block,
            rtol: f64,
            output: OutputType,
        ) -> Result<Track, Box<dyn Error>> {
            let (atol, dx) = (scalar_atol(block, rtol), problem.times[0]);
            let (t_end, y0) = (problem.t_end + OVERSHOOT, Y::from(block.initial_state()));
            let is_dense = output == OutputType::Dense;
            let mut solver = $solver::from_param(
                Joint(block),
                0.0,
                t_end,
                dx,
                y0,
                rtol,
                atol,
                0.9,
                $beta,
                $fac_min,
                $fac_max,
                t_end,
                0.0,
                MAX_STEPS,
                u32::MAX,
                output,
            );
            let stats = solver.integrate()?;
            let (times, states) = solver.results().get();
            let mut track = Track { n_rhs: Some(u64::from(stats.num_eval)), ..Track::default() };
            if is_dense {
                // The first is the start; the end may come twice.
                let samples = states.iter().skip(1).take(problem.times.len());
                track.samples = samples.map(|y| y.data.0[0]).collect();
            } else {
                let mut watch = Watch::new();
                times.iter().zip(states).for_each(|(t, y)| watch.look(block, *t, &y.data.0[0]));
                track.events = watch.events;
            }
            Ok(track)
        }
    };
}

method!(dopri5, Dopri5, 0.04, 0.2, 10.0);
method!(dop853, Dop853, 0.0, 0.333, 6.0);

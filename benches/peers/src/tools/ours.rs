//! Ours: every method of the list, events located; and two explicit ones event-blind.

use std::sync::atomic::AtomicBool;

use deltazero::config::Events;
use deltazero::run::{Accuracy, Limits, Run, Setting, mode_changes};
use deltazero_solvers::{Grid, METHODS, Method};

use crate::entry::{Entry, Handling, ladder};
use crate::problem::{Problem, Track};

/// Name and version of the tool.
const TOOL: (&str, &str) = ("deltazero", env!("CARGO_PKG_VERSION"));
/// Nothing breaks a run off.
static GO_ON: AtomicBool = AtomicBool::new(false);

/// The methods that are shown event-blind too: the price of events.
const BLIND: [&str; 2] = ["rk45", "dop853"];

/// Steps of a method that has them fixed [s].
const STEPS: [f64; 7] = [1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5];

/// All of ours.
pub(super) fn entries(problem: &Problem) -> Vec<Entry<'_>> {
    let located = METHODS.iter().map(|method| (method, Events::Located, Handling::Located));
    let blind = METHODS.iter().filter(|method| BLIND.contains(&method.name));
    let blind = blind.map(|method| (method, Events::Blind, Handling::Naive));
    located
        .chain(blind)
        .flat_map(|(method, events, handling)| {
            accuracies(method).into_iter().map(move |(number, accuracy)| {
                let run = move || Ok(run(problem, &Setting { method, events, accuracy })?);
                Entry::new(TOOL, (method.name, handling), number, run)
            })
        })
        .collect()
}

/// Steps or tolerances of `method`, as a number too.
fn accuracies(method: &Method) -> Vec<(f64, Accuracy)> {
    if method.is_fixed_step() {
        STEPS.map(|step| (step, Accuracy::Step(step))).to_vec()
    } else {
        ladder().map(|rtol| (rtol, Accuracy::Rtol(rtol, None))).collect()
    }
}

/// One run as the study makes it.
fn run(problem: &Problem, setting: &Setting) -> Result<[Track; 2], deltazero_solvers::Error> {
    let limits = Limits { max_rhs: u64::MAX, stop: &GO_ON };
    let grid = Grid::Times(problem.times.clone());
    let run = Run::new(&problem.mechanism, setting, problem.t_end, &grid, limits);
    if let Some(error) = run.error() {
        return Err(error.clone());
    }
    Ok(std::array::from_fn(|i| {
        let trajectory = &run.trajectories[i];
        Track {
            samples: trajectory.samples.iter().map(|sample| sample.y).collect(),
            events: mode_changes(trajectory),
            n_rhs: Some(run.parts[i].stats.work.n_rhs),
        }
    }))
}

//! Ours: every method of the list, events located; those that can with both joints at once too; and two explicit
//! ones event-blind.

use std::sync::atomic::AtomicBool;

use deltazero::model::Block;
use deltazero::run::{BlockTrajectory, Run, mode_changes};
use deltazero_solvers::{Grid, METHODS, Method, Record, Stats};
use deltazero_study::run::{Accuracy, Limits, Setting, integrate_all};
use deltazero_study::setting::Events;

use crate::entry::{Entry, Handling, ladder};
use crate::problem::{Problem, Track};

/// Name and version of the tool.
const TOOL: (&str, &str) = ("deltazero", env!("CARGO_PKG_VERSION"));
/// Nothing breaks a run off.
static GO_ON: AtomicBool = AtomicBool::new(false);

/// The methods that are shown event-blind too: the price of events.
const BLIND: [&str; 2] = ["rk45", "dop853"];

/// Steps of a method that has them fixed [s], twentieths of a decade apart from 1e-3 to 1e-5, rounded to three
/// digits: about as far as quarters of a decade of tolerance set those of order 4 and 5.
fn steps() -> impl Iterator<Item = f64> {
    let step = |k: u32| format!("{:.2e}", libm::pow(10.0, -3.0 - 0.05 * f64::from(k)));
    (0..=40).filter_map(move |k| step(k).parse().ok())
}

/// All of ours.
pub(super) fn entries(problem: &Problem) -> Vec<Entry<'_>> {
    let located = METHODS.iter().map(|method| (method, Events::Located, Handling::Located));
    let blind = METHODS.iter().filter(|method| BLIND.contains(&method.name));
    let blind = blind.map(|method| (method, Events::Blind, Handling::Naive));
    let one_by_one = located.chain(blind).flat_map(|(method, events, handling)| {
        accuracies(method).into_iter().map(move |(number, accuracy)| {
            let setting = Setting { method, events, accuracy };
            let run = move || Ok(run(problem, &setting)?);
            Entry::new(TOOL, (method.name, handling), number, run)
        })
    });
    let in_pairs = METHODS.iter().filter(|method| method.is_for_batches()).flat_map(|method| {
        accuracies(method).into_iter().map(move |(number, accuracy)| {
            let setting = Setting { method, events: Events::Located, accuracy };
            let run = move || Ok(pair(problem, &setting)?);
            let name = format!("{} (both at once)", method.name);
            Entry::new(TOOL, (&name, Handling::Located), number, run)
        })
    });
    in_pairs.chain(one_by_one).collect()
}

/// Steps or tolerances of `method`, as a number too.
fn accuracies(method: &Method) -> Vec<(f64, Accuracy)> {
    if method.is_fixed_step() {
        steps().map(|step| (step, Accuracy::Step(step))).collect()
    } else {
        ladder().map(|rtol| (rtol, Accuracy::Rtol(rtol, None))).collect()
    }
}

/// One run as the study makes it.
fn run(problem: &Problem, setting: &Setting) -> Result<[Track; 2], deltazero_solvers::Error> {
    let limits = Limits::none(&GO_ON);
    let grid = Grid::Times(problem.times.clone());
    let run = Run::new(&problem.mechanism, setting, problem.t_end, &grid, limits);
    if let Some(error) = run.error() {
        return Err(error.clone());
    }
    Ok(std::array::from_fn(|i| track(&run.trajectories[i], &run.parts[i].stats)))
}

/// A run of both joints at once.
fn pair(problem: &Problem, setting: &Setting) -> Result<[Track; 2], deltazero_solvers::Error> {
    let blocks = problem.mechanism.blocks();
    let mut trajectories = [0, 1].map(|_| BlockTrajectory::on(Grid::Times(problem.times.clone())));
    let starts: Vec<_> = blocks.iter().map(|block| (*block, block.initial_state())).collect();
    let mut records: Vec<&mut dyn Record<Block>> =
        trajectories.iter_mut().map(|own| own as _).collect();
    let runs = integrate_all(&starts, setting, problem.t_end, &mut records);
    for run in &runs {
        run.outcome.clone()?;
    }
    Ok([0, 1].map(|i| track(&trajectories[i], &runs[i].stats)))
}

fn track(trajectory: &BlockTrajectory, stats: &Stats) -> Track {
    Track {
        samples: trajectory.samples.iter().map(|sample| sample.y).collect(),
        events: mode_changes(trajectory),
        n_rhs: Some(stats.work.n_rhs),
    }
}

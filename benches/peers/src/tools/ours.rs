//! Ours: every adaptive method of the list, events located; and the explicit ones event-blind.

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

/// All of ours.
pub(super) fn entries(problem: &Problem) -> Vec<Entry<'_>> {
    let adaptive = || METHODS.iter().filter(|method| !method.is_fixed_step());
    let located = adaptive().map(|method| (method, Events::Located, Handling::Located));
    let blind = adaptive().filter(|method| BLIND.contains(&method.name));
    let blind = blind.map(|method| (method, Events::Blind, Handling::Naive));
    located
        .chain(blind)
        .flat_map(|(method, events, handling)| {
            ladder().map(move |rtol| {
                let run = move || Ok(run(problem, method, events, rtol)?);
                Entry::new(TOOL, (method.name, handling), rtol, run)
            })
        })
        .collect()
}

/// One run as the study makes it.
fn run(
    problem: &Problem,
    method: &'static Method,
    events: Events,
    rtol: f64,
) -> Result<[Track; 2], deltazero_solvers::Error> {
    let setting = Setting { method, events, accuracy: Accuracy::Rtol(rtol, None) };
    let limits = Limits { max_rhs: u64::MAX, stop: &GO_ON };
    let grid = Grid::Times(problem.times.clone());
    let run = Run::new(&problem.mechanism, &setting, problem.t_end, &grid, limits);
    if let Some(error) = run.error() {
        return Err(error.clone());
    }
    Ok(std::array::from_fn(|i| {
        let trajectory = &run.trajectories[i];
        Track {
            samples: trajectory.samples.iter().map(|sample| sample.y).collect(),
            events: mode_changes(trajectory),
            n_rhs: Some(run.blocks[i].stats.work.n_rhs),
        }
    }))
}

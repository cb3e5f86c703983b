//! The models by `deltazero-solvers`, by the methods of `../../run.py`, each run made as a user would.

mod models;

use std::error::Error;
use std::path::Path;

use deltazero_solvers::{Grid, Outcome, Run, Tolerance, Trajectory};
use models::{BuckConverter, Carts, IntegrateAndFire, Model, RockingBlock, VanDerPol};

use crate::{tell, tolerances};

const EXPLICIT: [&str; 5] = ["rk45", "dop853", "vern98", "taylor", "auto"];
const IMPLICIT: [&str; 4] = ["rodas5p", "radau5", "bdf", "auto"];

/// All runs of the model of this name.
pub(crate) fn model(name: &str, times: &[f64], folder: &Path) -> Result<(), Box<dyn Error>> {
    match name {
        "van_der_pol" => ladders(&VanDerPol, &IMPLICIT, times, folder),
        "integrate_and_fire" => ladders(&IntegrateAndFire, &EXPLICIT, times, folder),
        "buck_converter" => ladders(&BuckConverter, &EXPLICIT, times, folder),
        "rocking_block" => ladders(&RockingBlock::new(), &EXPLICIT, times, folder),
        "carts" => ladders(&Carts, &EXPLICIT, times, folder),
        _ => Err(format!("unknown: {name}").into()),
    }
}

/// All runs of a model by these methods.
fn ladders<P: Model>(
    model: &P,
    methods: &[&str],
    times: &[f64],
    folder: &Path,
) -> Result<(), Box<dyn Error>> {
    for method in methods {
        for tolerance in tolerances() {
            let rtol: f64 = tolerance.parse()?;
            let atol: Vec<f64> = model.scale().into_iter().map(|scale| rtol * scale).collect();
            let run = || {
                let grid = Trajectory::on(Grid::Times(times.to_vec()));
                let tolerance = Tolerance { rtol, atol: atol.clone() };
                let run = Run::of(model, model.start()).method(method).tolerances(tolerance);
                let run = run.keep(grid).to(P::T_END)?;
                if run.outcome != Outcome::Finished {
                    return Err(format!("{:?}", run.outcome).into());
                }
                let states = run.trajectory.samples.iter().flat_map(|sample| sample.y.as_ref());
                Ok((states.copied().collect(), run.stats.n_events))
            };
            if !tell(["deltazero-rust", method, &tolerance], model.dim(), folder, run)? {
                break;
            }
        }
    }
    Ok(())
}

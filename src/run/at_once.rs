//! Runs of several blocks at once, in vector lanes.

use deltazero_solvers::{Integration, Record};
use deltazero_study::Problem as _;
use deltazero_study::run::{Events, OwnRun, Setting, Stopwatch, ended, integrate};

use crate::model::{Block, State};

/// Integrates each block from its start as [`integrate`] does, with the same bits, as one
/// [batch](deltazero_solvers::Method::run_batch) where events are located. The time is shared evenly among the runs.
///
/// A comparison of methods runs one joint after the other instead, because how well two of them overlap in vector
/// lanes is no merit of a method.
///
/// # Panics
/// Where there are fewer records than runs.
pub fn integrate_at_once<R: Record<Block>>(
    runs: &[(&Block, State<f64>)],
    setting: &Setting,
    t_end: f64,
    records: &mut [R],
) -> Vec<OwnRun<Block>> {
    if setting.events == Events::Blind || runs.iter().any(|(block, _)| block.check().is_err()) {
        let pairs = runs.iter().zip(records);
        return pairs.map(|((block, y), r)| integrate(*block, setting, *y, t_end, r)).collect();
    }
    let watch = Stopwatch::start();
    let controls: Vec<_> = runs.iter().map(|(block, _)| setting.control(*block)).collect();
    let mut batch: Vec<_> =
        runs.iter().map(|(block, y)| Integration::new(*block, 0.0, *y)).collect();
    let ends = setting.method.run_batch(&mut batch, t_end, &controls, records);
    let ends = ends.unwrap_or_else(|error| vec![Err(error); runs.len()]);
    let share = watch.took().share(runs.len());
    let pairs = batch.into_iter().zip(ends).zip(runs);
    pairs.map(|((run, end), (block, _))| ended(*block, run, end, share)).collect()
}

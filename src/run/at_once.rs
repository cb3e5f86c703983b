//! Several runs at once, in the lanes of a vector.

use deltazero_solvers::{Integration, Record};
use deltazero_study::Problem as _;
use deltazero_study::run::{Events, OwnRun, Setting, Stopwatch, ended, integrate};

use super::BlockTrajectory;
use crate::model::{Block, State};

/// Integrates two joints as [`integrate`](deltazero_study::run::integrate) does, with the same bits, [both at once](Method::run_pair) where events
/// are located and the method [can](Method::is_for_pairs); the time is shared between them.
///
/// What compares methods runs one joint after the other: how well two of them overlap is none of a method's merits.
pub fn integrate_pair<R: Record<Block>>(
    blocks: [&Block; 2],
    setting: &Setting,
    t_end: f64,
    records: [&mut R; 2],
) -> [OwnRun<Block>; 2] {
    let starts = blocks.map(Block::initial_state);
    if setting.events == Events::Blind || blocks.iter().any(|block| block.check().is_err()) {
        let [first, second] = records;
        return [
            integrate(blocks[0], setting, starts[0], t_end, first),
            integrate(blocks[1], setting, starts[1], t_end, second),
        ];
    }
    let watch = Stopwatch::start();
    let controls = blocks.map(|block| setting.control(block));
    let mut runs = [0, 1].map(|i| Integration::new(blocks[i], 0.0, starts[i]));
    let [first, second] = &mut runs;
    let ends = setting.method.run_pair([first, second], t_end, controls.each_ref(), records);
    let [end_1, end_2] = ends.unwrap_or_else(|error| [Err(error.clone()), Err(error)]);
    let (share, [run_1, run_2]) = (watch.took().share(2), runs);
    [ended(blocks[0], run_1, end_1, share), ended(blocks[1], run_2, end_2, share)]
}

/// Integrates `block` as [`integrate`](deltazero_study::run::integrate) does from each of `starts`, with the same bits, each into the
/// trajectory of its place: located runs by [several at once](Method::run_many), the time shared among them.
///
/// # Panics
/// Where there are fewer trajectories than starts.
pub fn integrate_many(
    block: &Block,
    setting: &Setting,
    starts: &[State<f64>],
    t_end: f64,
    trajectories: &mut [BlockTrajectory],
) -> Vec<OwnRun<Block>> {
    assert!(trajectories.len() >= starts.len(), "a trajectory for each start is needed");
    let watch = Stopwatch::start();
    let mut runs: Vec<_> = starts.iter().map(|y| Integration::new(block, 0.0, *y)).collect();
    let control = setting.control(block);
    let ends = match setting.events {
        Events::Located => block
            .check()
            .and_then(|()| setting.method.run_many(&mut runs, t_end, &control, trajectories)),
        Events::Blind => {
            let pairs = starts.iter().zip(trajectories);
            return pairs.map(|(y, record)| integrate(block, setting, *y, t_end, record)).collect();
        }
    };
    let ends = ends.unwrap_or_else(|error| vec![Err(error); runs.len()]);
    let share = watch.took().share(runs.len());
    let pairs = runs.into_iter().zip(ends);
    pairs.map(|(run, outcome)| ended(block, run, outcome, share)).collect()
}

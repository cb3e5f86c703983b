//! Throughput of one core: runs of Table 1 from starts that differ a little, one after the other and several
//! at once, each shown to the recorder of its samples; the results must be the same.
#![allow(missing_docs, clippy::print_stdout, reason = "a program, not a library")]

use std::error::Error;
use std::time::Instant;

use deltazero::config::Config;
use deltazero::model::{Block, Joints, State};
use deltazero::run::{BlockTrajectory, integrate_many};
use deltazero_solvers::{Grid, Method, Stats, Trajectory};
use deltazero_study::run::{Accuracy, Setting, integrate};
use deltazero_study::setting::Events;

/// Starts, each turning a little faster than the one before [rad/s].
const STARTS: usize = 256;
const FASTER: f64 = 1e-5;
/// End of each run, and time between its samples [s].
const T_END: f64 = 2.0;
const SAMPLE: f64 = 0.01;
/// Rounds, in each of which both ways have their turn.
const ROUNDS: usize = 7;

fn main() -> Result<(), Box<dyn Error>> {
    let config = Config::table1()?;
    let mechanism = Joints::new(&config);
    let blocks = mechanism.blocks();
    println!(
        "method   rtol   joints  one by one [runs/s]  at once [runs/s]  ratio (of each round)"
    );
    for (name, rtol) in [("rk45", 1e-6), ("dop853", 1e-8)] {
        let method = Method::named(name).ok_or("no such method")?;
        let accuracy = Accuracy::Rtol(rtol, None);
        let setting = Setting { method, events: Events::Located, accuracy };
        for blocks in [&blocks[..1], &blocks[..]] {
            let mut seconds = Vec::new();
            for _ in 0..ROUNDS {
                let (alone, t_alone) = timed(blocks, |block| one_by_one(&setting, block));
                let (many, t_many) = timed(blocks, |block| at_once(&setting, block));
                if alone != many {
                    return Err("runs at once have other results".into());
                }
                seconds.push([t_alone, t_many, t_alone / t_many]);
            }
            let median = |i: usize| {
                let mut all: Vec<f64> = seconds.iter().map(|round| round[i]).collect();
                all.sort_by(f64::total_cmp);
                (all[ROUNDS / 2], all[0], all[ROUNDS - 1])
            };
            let (n, (ratio, least, most)) = (STARTS as f64, median(2));
            let (alone, many) = (n / median(0).0, n / median(1).0);
            println!(
                "{name:<8} {rtol:<6e} {:<7} {alone:<20.0} {many:<17.0} {ratio:.2} ({least:.2} to {most:.2})",
                blocks.len()
            );
        }
    }
    Ok(())
}

/// What runs came to: counts of work, and trajectories.
type Results = Vec<(Stats, BlockTrajectory)>;

fn timed(blocks: &[&Block], mut runs: impl FnMut(&Block) -> Results) -> (Vec<String>, f64) {
    let start = Instant::now();
    let results: Vec<_> = blocks.iter().map(|block| runs(block)).collect();
    let seconds = start.elapsed().as_secs_f64();
    let shown = |(stats, trajectory): &(Stats, BlockTrajectory)| {
        format!("{stats:?} {:?} {:?}", trajectory.samples.last(), trajectory.events)
    };
    (results.iter().flatten().map(shown).collect(), seconds)
}

fn begun(block: &Block) -> (Vec<State<f64>>, Vec<BlockTrajectory>) {
    let start = |i: usize| {
        let mut y = block.initial_state();
        y[5] = FASTER * i as f64;
        (y, Trajectory::on(Grid::uniform(SAMPLE, T_END)))
    };
    (0..STARTS).map(start).unzip()
}

fn one_by_one(setting: &Setting, block: &Block) -> Results {
    let (starts, trajectories) = begun(block);
    let run = |(y, mut trajectory): (State<f64>, _)| {
        (integrate(block, setting, y, T_END, &mut trajectory).stats, trajectory)
    };
    starts.into_iter().zip(trajectories).map(run).collect()
}

fn at_once(setting: &Setting, block: &Block) -> Results {
    let (starts, mut trajectories) = begun(block);
    let runs = integrate_many(block, setting, &starts, T_END, &mut trajectories);
    runs.iter().map(|run| run.stats).zip(trajectories).collect()
}

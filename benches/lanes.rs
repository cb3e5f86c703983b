//! Throughput of one core: runs of Table 1 one after the other and at once in vector lanes, each shown to the recorder
//! of its samples. Both joints are a batch of two; starts that differ a little are a batch of many. The results must
//! be the same.
#![allow(missing_docs, clippy::print_stdout, reason = "a program, not a library")]

use std::error::Error;
use std::time::Instant;

use deltazero::config::Config;
use deltazero::model::{Block, Jointed as _, Joints, State};
use deltazero::run::BlockTrajectory;
use deltazero_solvers::{Grid, Method, Stats, Trajectory};
use deltazero_study::run::{Accuracy, Setting, integrate_all};
use deltazero_study::setting::Events;

/// Starts of each joint in a batch of many, each turning a little faster than the one before [rad/s].
const STARTS: usize = 256;
const FASTER: f64 = 1e-5;
/// Number of times that a batch of two is run in a round.
const REPEATS: usize = 40;
/// End of each run, and time between its samples [s].
const T_END: f64 = 2.0;
const SAMPLE: f64 = 0.01;
/// Rounds, in each of which both ways have their turn.
const ROUNDS: usize = 7;

fn main() -> Result<(), Box<dyn Error>> {
    let config = Config::table1()?;
    let mechanism = Joints::from(&config);
    let blocks = mechanism.blocks();
    println!("method   setting runs  one by one [runs/s]  at once [runs/s]  ratio (of each round)");
    let settings = [
        ("rk4", Accuracy::Step(5e-4)),
        ("rk45", Accuracy::Rtol(1e-6, None)),
        ("rk45", Accuracy::Rtol(1e-9, None)),
        ("dop853", Accuracy::Rtol(1e-6, None)),
        ("dop853", Accuracy::Rtol(1e-9, None)),
        ("taylor", Accuracy::Rtol(1e-6, None)),
        ("taylor", Accuracy::Rtol(1e-9, None)),
    ];
    for (name, accuracy) in settings {
        let method = Method::named(name).ok_or("no such method")?;
        let at = match accuracy {
            Accuracy::Step(x) | Accuracy::Rtol(x, _) => x,
        };
        let setting = Setting { method, events: Events::Located, accuracy };
        for (n_starts, blocks) in [(1, &blocks[..]), (STARTS, &blocks[..1]), (STARTS, &blocks[..])]
        {
            let repeats = if n_starts == 1 { REPEATS } else { 1 };
            let mut seconds = Vec::new();
            for _ in 0..ROUNDS {
                let (alone, t_alone) = timed(repeats, || one_by_one(&setting, blocks, n_starts));
                let (many, t_many) = timed(repeats, || at_once(&setting, blocks, n_starts));
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
            let n_runs = n_starts * blocks.len();
            let (n, (ratio, least, most)) = ((repeats * n_runs) as f64, median(2));
            let (alone, many) = (n / median(0).0, n / median(1).0);
            println!(
                "{name:<8} {at:<7e} {n_runs:<5} {alone:<20.0} {many:<17.0} {ratio:.2} ({least:.2} to {most:.2})"
            );
        }
    }
    Ok(())
}

/// What runs came to: counts of work, and trajectories.
type Results = Vec<(Stats, BlockTrajectory)>;

/// What the last of `n` repetitions came to, and the time of all [s].
fn timed(n: usize, runs: impl Fn() -> Results) -> (Vec<String>, f64) {
    let start = Instant::now();
    let mut results = runs();
    for _ in 1..n {
        results = runs();
    }
    let seconds = start.elapsed().as_secs_f64();
    let shown = |(stats, trajectory): &(Stats, BlockTrajectory)| {
        format!("{stats:?} {:?} {:?}", trajectory.samples.last(), trajectory.events)
    };
    (results.iter().map(shown).collect(), seconds)
}

/// Each block from each of `n` starts.
fn begun<'b>(
    blocks: &[&'b Block],
    n: usize,
) -> (Vec<(&'b Block, State<f64>)>, Vec<BlockTrajectory>) {
    let start = |i: usize| {
        let block = blocks[i / n];
        let mut y = block.initial_state();
        y[5] = FASTER * (i % n) as f64;
        ((block, y), Trajectory::on(Grid::uniform(SAMPLE, T_END)))
    };
    (0..n * blocks.len()).map(start).unzip()
}

fn one_by_one(setting: &Setting, blocks: &[&Block], n: usize) -> Results {
    let (starts, trajectories) = begun(blocks, n);
    let run = |((block, y), mut trajectory): ((&Block, State<f64>), _)| {
        (block.integrate(setting, y, T_END, &mut trajectory).stats, trajectory)
    };
    starts.into_iter().zip(trajectories).map(run).collect()
}

fn at_once(setting: &Setting, blocks: &[&Block], n: usize) -> Results {
    let (starts, mut trajectories) = begun(blocks, n);
    let runs = integrate_all(&starts, setting, T_END, &mut trajectories);
    runs.iter().map(|run| run.stats).zip(trajectories).collect()
}

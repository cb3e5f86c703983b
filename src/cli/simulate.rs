//! `deltazero simulate`.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use clap::Args;
use deltazero::config::Config;
use deltazero::energy_balance::{Balance, EnergyBalance};
use deltazero::metrics::work::WorkByPhase;
use deltazero::model::{Block, Mechanism, Mode};
use deltazero::reference::counted;
use deltazero::report;
use deltazero::run::{
    BlockRun, BlockTrajectory, Limits, Setting, contacts_at_floor, integrate, mode_changes,
};
use deltazero_solvers::{Grid, Outcome, Stats, Trajectory, WorkByKind};
use serde_json::{Value, json};

use super::output::{Output, hash};
use super::progress::{TimeBar, TimeOf};
use super::{Failure, RunArgs, print, say};

#[derive(Args)]
pub(super) struct SimulateArgs {
    #[command(flatten)]
    run: RunArgs,
}

/// A run beyond this is not repeated for its time: audit and progress are then part of it.
const REPLAY: Duration = Duration::from_secs(5);

/// One block of a simulation.
struct Simulated<'a> {
    block: &'a Block,
    run: BlockRun,
    trajectory: BlockTrajectory,
    balance: Balance,
    /// Work by the phase that it was done in.
    work: Vec<(&'static str, Stats)>,
    wall: Duration,
}

pub(super) fn run(args: &SimulateArgs, stop: &AtomicBool) -> Result<(), Failure> {
    let config = args.run.load()?;
    let setting = Setting::of(&config)
        .ok_or_else(|| Failure::Usage(format!("no method {}", config.solver.method)))?;
    let dir = args.run.out.clone().unwrap_or_else(|| PathBuf::from("deltazero-out/simulate"));
    let output = Output::open(&dir, hash("simulate", &config.to_json()), args.run.force)?;

    let mechanism = Mechanism::new(&config);
    let bar = TimeBar::new(args.run.quiet);
    let blocks: Vec<Simulated<'_>> = mechanism
        .blocks
        .iter()
        .map(|block| {
            let time = bar.of(block, mechanism.blocks.len(), config.run.t_end);
            simulate(block, &setting, &config, time, stop)
        })
        .collect();
    drop(bar);
    let trajectories = || blocks.iter().map(|block| (block.block, &block.trajectory));
    let summary = run_json(&output, &config, &setting, &blocks);
    output.write("trajectory.csv", report::trajectory_csv(trajectories()).as_bytes())?;
    output.write("events.csv", report::events_csv(trajectories()).as_bytes())?;
    output.write("run.json", format!("{summary:#}\n").as_bytes())?;

    if args.run.json {
        print(&format!("{summary:#}\n"))?;
    } else {
        print(&report_lines(&summary, &blocks))?;
    }
    if !args.run.quiet {
        say(&format!("written to {}: trajectory.csv, events.csv, run.json", output.path()));
    }
    match outcome(&blocks) {
        "failed" => Err(Failure::Run(failure(&summary))),
        "interrupted" => Err(Failure::Interrupted("what was computed until then is written")),
        _ => Ok(()),
    }
}

fn simulate<'a>(
    block: &'a Block,
    setting: &Setting,
    config: &Config,
    time: TimeOf<'_>,
    stop: &AtomicBool,
) -> Simulated<'a> {
    let (y0, t_end) = (block.initial_state(), config.run.t_end);
    let balance = EnergyBalance::new(block, setting.events, &y0);
    let trajectory = Trajectory::on(Grid::uniform(config.run.sample, t_end));
    let limits = Limits { max_rhs: u64::MAX, stop };
    let work = WorkByKind::new(Mode::phase);
    let mut record = ((trajectory, balance), ((time, limits), work));
    let run = integrate(block, setting, y0, t_end, &mut record);
    let ((trajectory, balance), (_, work)) = record;
    let wall = if run.outcome == Ok(Outcome::Interrupted) || run.wall > REPLAY {
        run.wall
    } else {
        // The integration alone: the same run without audit and progress.
        let mut plain = Trajectory::on(Grid::uniform(config.run.sample, t_end));
        integrate(block, setting, y0, t_end, &mut plain).wall
    };
    let balance = balance.at(run.mode, &run.y);
    Simulated { block, run, trajectory, balance, work: work.kinds, wall }
}

/// `failed` if any block did, else `interrupted`, else `reached_90` if every block did.
fn outcome(blocks: &[Simulated<'_>]) -> &'static str {
    let any = |outcome| blocks.iter().any(|block| block.run.outcome == Ok(outcome));
    if blocks.iter().any(|block| block.run.outcome.is_err()) {
        "failed"
    } else if any(Outcome::Interrupted) {
        "interrupted"
    } else if any(Outcome::Finished) {
        "finished"
    } else {
        "reached_90"
    }
}

fn run_json(
    output: &Output,
    config: &Config,
    setting: &Setting,
    blocks: &[Simulated<'_>],
) -> Value {
    let (mut stats, mut balance) = (Stats::default(), Balance::default());
    let mut work = Vec::new();
    for block in blocks {
        stats += block.run.stats;
        balance += block.balance;
        work.extend_from_slice(&block.work);
    }
    let n_events: usize = blocks
        .iter()
        .map(|block| counted(&mode_changes(&block.trajectory), block.block).len())
        .sum();
    let n_at_floor: usize =
        blocks.iter().map(|block| contacts_at_floor(block.block, &block.trajectory)).sum();
    let reached = |block: &Simulated<'_>| {
        let t_s = block.run.reached_90()?;
        Some(json!({ "bay": 1, "joint": block.run.joint, "t_s": t_s }))
    };
    let error = blocks.iter().find_map(|block| {
        let message = block.run.outcome.as_ref().err()?.to_string();
        let run = &block.run;
        let mode = run.mode.to_string();
        Some(json!({ "t": run.t, "bay": 1, "joint": run.joint, "mode": mode, "message": message }))
    });
    let mut counts = json!({
        "n_rhs": stats.work.n_rhs,
        "n_accepted": stats.n_accepted,
        "n_implicit": stats.n_implicit,
        "n_rejected": stats.n_rejected,
        "n_retaken": stats.n_retaken,
        "n_events": n_events,
        "n_jac": stats.work.n_jac,
        "n_factorisations": stats.work.n_factorisations,
        "n_lin_solves": stats.work.n_lin_solves,
        "n_at_speed_floor": n_at_floor,
    });
    if let Some(order) = setting.method.series_order(setting.rtol()) {
        counts["series_order"] = order.into();
    }
    json!({
        "hash": output.hash,
        "config": config.to_json(),
        "version": env!("CARGO_PKG_VERSION"),
        "wall_s": blocks.iter().map(|block| block.wall).sum::<Duration>().as_secs_f64(),
        "counts": counts,
        "work_by_phase": WorkByPhase::new(&work),
        "energy": balance,
        "reached_90_s": blocks.iter().filter_map(reached).collect::<Vec<_>>(),
        "outcome": outcome(blocks),
        "error": error,
    })
}

/// The message of a failed run: where, in which mode, what to try.
fn failure(summary: &Value) -> String {
    let error = &summary["error"];
    let message = error["message"].as_str().unwrap_or_default();
    format!("joint {}: {message}; what was computed until then is written", error["joint"])
}

fn report_lines(summary: &Value, blocks: &[Simulated<'_>]) -> String {
    let counts = &summary["counts"];
    let mut text = format!(
        "{}: {} events, {} right-hand sides, {} steps ({} rejected, {} retaken), {:.2} ms\n",
        outcome(blocks),
        counts["n_events"],
        counts["n_rhs"],
        counts["n_accepted"],
        counts["n_rejected"],
        counts["n_retaken"],
        1e3 * summary["wall_s"].as_f64().unwrap_or(f64::NAN)
    );
    for block in blocks {
        let run = &block.run;
        let angle = match run.reached_90() {
            Some(t) => format!("reached 90 degrees at {t:.6} s"),
            None => format!("theta = {:.6e} rad at t = {:e} s", run.y[2], run.t),
        };
        text += &format!(
            "joint {}: {angle}, {}; energy residual {:.1e} J of {:.1e} J of work\n",
            run.joint, run.mode, block.balance.residual, block.balance.work
        );
    }
    text
}

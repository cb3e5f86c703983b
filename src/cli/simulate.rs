//! `deltazero simulate`.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use clap::Args;
use deltazero::config::Config;
use deltazero::energy_balance::{Balance, EnergyBalance};
use deltazero::metrics::work::WorkByPhase;
use deltazero::model::chain::Modes;
use deltazero::model::{Block, Chain, Mechanism, Mode};
use deltazero::reference::counted;
use deltazero::report;
use deltazero::run::{JointHistory, Limits, Part, Setting, integrate, integrate_chain};
use deltazero_solvers::{Error, Grid, Next, Outcome, Stats, Trajectory, WorkByKind};
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

/// One part of a simulation: a block, or the chain.
struct Simulated<'a> {
    part: Part<'a>,
    outcome: Result<Outcome, Error>,
    /// Where it ended [s].
    t: f64,
    /// Its modes there.
    mode: String,
    /// The angle of each bay there [rad].
    angles: Vec<f64>,
    /// The bay whose error ended it, where it is known.
    failed_bay: Option<usize>,
    stats: Stats,
    balance: Balance,
    /// Work by the phase that it was done in.
    work: Vec<(&'static str, Stats)>,
    wall: Duration,
}

impl Simulated<'_> {
    fn joint(&self) -> usize {
        match &self.part {
            Part::Block(block, _) => block.joint,
            Part::Chain(chain, _) => chain.bay.joint,
        }
    }

    /// The bay that reached 90°, if one did.
    fn reached_90(&self) -> Option<usize> {
        let stopped = self.outcome == Ok(Outcome::Stopped);
        stopped.then(|| match &self.part {
            Part::Block(..) => 1,
            Part::Chain(_, trajectory) => {
                let last = trajectory.events.last().filter(|event| event.after == Next::Stop);
                last.map_or(1, |event| Chain::bay_of(event.guard) + 1)
            }
        })
    }
}

pub(super) fn run(args: &SimulateArgs, stop: &AtomicBool) -> Result<(), Failure> {
    let config = args.run.load_chain()?;
    let setting = Setting::of(&config)
        .ok_or_else(|| Failure::Usage(format!("no method {}", config.solver.method)))?;
    let dir = args.run.out.clone().unwrap_or_else(|| PathBuf::from("deltazero-out/simulate"));
    let output = Output::open(&dir, hash("simulate", &config.to_json()), args.run.force)?;

    let (mechanism, chain) = (Mechanism::new(&config), Chain::new(&config));
    let bar = TimeBar::new(args.run.quiet);
    let time = |joint| bar.of(joint, mechanism.blocks.len(), config.run.t_end);
    let parts = mechanism.blocks.iter().map(|block| match block.joint {
        1 if chain.bays > 1 => simulate_chain(&chain, &setting, &config, time(1), stop),
        joint => simulate(block, &setting, &config, time(joint), stop),
    });
    let parts: Vec<_> = parts.collect();
    drop(bar);
    let joints: Vec<_> = parts.iter().flat_map(|part| part.part.joints()).collect();
    let summary = run_json(&output, &config, &setting, &parts, &joints);
    output.write("trajectory.csv", report::trajectory_csv(&joints).as_bytes())?;
    output.write("events.csv", report::events_csv(&joints).as_bytes())?;
    output.write("run.json", format!("{summary:#}\n").as_bytes())?;

    if args.run.json {
        print(&format!("{summary:#}\n"))?;
    } else {
        print(&report_lines(&summary, &parts))?;
    }
    if !args.run.quiet {
        say(&format!("written to {}: trajectory.csv, events.csv, run.json", output.path()));
    }
    match outcome(&parts) {
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
    let trajectory = || Trajectory::on(Grid::uniform(config.run.sample, t_end));
    let limits = Limits { max_rhs: u64::MAX, stop };
    let work = WorkByKind::new(Mode::phase);
    let mut record = ((trajectory(), balance), ((time, limits), work));
    let run = integrate(block, setting, y0, t_end, &mut record);
    let ((kept, balance), (_, work)) = record;
    let alone = || integrate(block, setting, y0, t_end, &mut trajectory()).wall;
    Simulated {
        part: Part::Block(block, kept),
        wall: wall(&run.outcome, run.wall, alone),
        outcome: run.outcome,
        t: run.t,
        mode: run.mode.to_string(),
        angles: vec![run.y[2]],
        failed_bay: Some(1),
        stats: run.stats,
        balance: balance.at(run.mode, &run.y),
        work: work.kinds,
    }
}

/// The same for a chain.
fn simulate_chain<'a>(
    chain: &'a Chain,
    setting: &Setting,
    config: &Config,
    time: TimeOf<'_>,
    stop: &AtomicBool,
) -> Simulated<'a> {
    let (y0, t_end) = (chain.initial_state(), config.run.t_end);
    let (method, accuracy) = (setting.method, setting.accuracy);
    let balance = EnergyBalance::new(chain, setting.events, &y0);
    let trajectory = || Trajectory::on(Grid::uniform(config.run.sample, t_end));
    let limits = Limits { max_rhs: u64::MAX, stop };
    let work = WorkByKind::new(|modes: Modes| modes.phase());
    let mut record = ((trajectory(), balance), ((time, limits), work));
    let run = integrate_chain(chain, method, accuracy, y0.clone(), t_end, &mut record);
    let ((kept, balance), (_, work)) = record;
    let alone = || integrate_chain(chain, method, accuracy, y0, t_end, &mut trajectory()).wall;
    Simulated {
        part: Part::Chain(chain, kept),
        wall: wall(&run.outcome, run.wall, alone),
        failed_bay: run.failed_bay(),
        outcome: run.outcome,
        t: run.t,
        mode: format!("{:?}", run.modes),
        angles: run.y.chunks_exact(6).map(|bay| bay[2]).collect(),
        stats: run.stats,
        balance: balance.at(run.modes, &run.y),
        work: work.kinds,
    }
}

/// The time of the integration alone: that of the same run without audit and progress, where it is short
/// and was not broken off.
fn wall(
    outcome: &Result<Outcome, Error>,
    wall: Duration,
    alone: impl FnOnce() -> Duration,
) -> Duration {
    if *outcome == Ok(Outcome::Interrupted) || wall > REPLAY { wall } else { alone() }
}

/// `failed` if any part did, else `interrupted`, else `reached_90` if every part did.
fn outcome(parts: &[Simulated<'_>]) -> &'static str {
    let any = |outcome| parts.iter().any(|part| part.outcome == Ok(outcome));
    if parts.iter().any(|part| part.outcome.is_err()) {
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
    parts: &[Simulated<'_>],
    joints: &[JointHistory<'_>],
) -> Value {
    let (mut stats, mut balance) = (Stats::default(), Balance::default());
    let mut work = Vec::new();
    for part in parts {
        stats += part.stats;
        balance += part.balance;
        work.extend_from_slice(&part.work);
    }
    let n_events: usize =
        joints.iter().map(|joint| counted(&joint.changes, joint.block).len()).sum();
    let n_at_floor: usize = parts.iter().map(|part| part.part.n_at_floor()).sum();
    let reached = |part: &Simulated<'_>| {
        let bay = part.reached_90()?;
        Some(json!({ "bay": bay, "joint": part.joint(), "t_s": part.t }))
    };
    let error = parts.iter().find_map(|part| {
        let message = part.outcome.as_ref().err()?.to_string();
        let (t, bay, joint, mode) = (part.t, part.failed_bay, part.joint(), &part.mode);
        Some(json!({ "t": t, "bay": bay, "joint": joint, "mode": mode, "message": message }))
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
        "wall_s": parts.iter().map(|part| part.wall).sum::<Duration>().as_secs_f64(),
        "counts": counts,
        "work_by_phase": WorkByPhase::new(&work),
        "energy": balance,
        "reached_90_s": parts.iter().filter_map(reached).collect::<Vec<_>>(),
        "outcome": outcome(parts),
        "error": error,
    })
}

/// The message of a failed run: where, in which mode, what to try.
fn failure(summary: &Value) -> String {
    let error = &summary["error"];
    let message = error["message"].as_str().unwrap_or_default();
    format!("joint {}: {message}; what was computed until then is written", error["joint"])
}

fn report_lines(summary: &Value, parts: &[Simulated<'_>]) -> String {
    let counts = &summary["counts"];
    let mut text = format!(
        "{}: {} events, {} right-hand sides, {} steps ({} rejected, {} retaken), {:.2} ms\n",
        outcome(parts),
        counts["n_events"],
        counts["n_rhs"],
        counts["n_accepted"],
        counts["n_rejected"],
        counts["n_retaken"],
        1e3 * summary["wall_s"].as_f64().unwrap_or(f64::NAN)
    );
    for part in parts {
        let what = match part.angles.len() {
            1 => format!("joint {}", part.joint()),
            bays => format!("joint {} of {bays} bays", part.joint()),
        };
        let angle = match part.reached_90() {
            Some(bay) if part.angles.len() > 1 => {
                format!("bay {bay} reached 90 degrees at {:.6} s", part.t)
            }
            Some(_) => format!("reached 90 degrees at {:.6} s", part.t),
            None => {
                let angles: Vec<_> = ends(&part.angles).map(|a| format!("{a:.6e}")).collect();
                format!("theta = {} rad at t = {:e} s", angles.join(" to "), part.t)
            }
        };
        text += &format!(
            "{what}: {angle}, {}; energy residual {:.1e} J of {:.1e} J of work\n",
            part.mode, part.balance.residual, part.balance.work
        );
    }
    text
}

/// The first and, of several, the last.
fn ends(angles: &[f64]) -> impl Iterator<Item = &f64> {
    let last = if angles.len() > 1 { angles.last() } else { None };
    angles.first().into_iter().chain(last)
}

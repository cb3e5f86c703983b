//! `deltazero simulate`.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use clap::Args;
use deltazero::config::Config;
use deltazero::report::run_lines::{failure, run_lines};
use deltazero::report::run_record::{PartsRecord, RunRecord, Simulated};
use deltazero::report::simulation::{events_csv, trajectory_csv};
use deltazero_solvers::{Grid, Outcome};
use deltazero_study::Subject;
use deltazero_study::digits::as_meant;
use deltazero_study::horizon::{Horizon, Span, TightRuns, tight_runs};
use deltazero_study::part::Timing;
use deltazero_study::run::{Limits, Price, Setting};
use deltazero_study::selection::work;
use deltazero_study::simulation::{Asked, SiteMotion};
use deltazero_study::warning::{Code, Warning};
use serde_json::json;

use super::output::{Output, hash};
use super::progress::TimeBar;
use super::rows::Rows;
use super::{Failure, RunArgs, print, say, warn};

/// The record of a run.
const RECORD: &str = "run.json";
/// What stands beside it.
const FILES: [&str; 2] = ["trajectory.csv", "events.csv"];

/// Runs up to this are run again without audit, to be timed.
const REPLAY: Duration = Duration::from_secs(5);
/// Those up to this so many times.
const SHORT: Duration = Duration::from_millis(50);
const REPEATS: usize = 5;

#[derive(Args)]
pub(super) struct SimulateArgs {
    #[command(flatten)]
    run: RunArgs,
    /// Do not measure how far the motion is predictable, which takes two tight runs more
    #[arg(long)]
    no_horizon: bool,
}

pub(super) fn run(args: &SimulateArgs, stop: &AtomicBool) -> Result<(), Failure> {
    let config = args.run.load()?;
    let setting = deltazero::run::setting(&config)
        .ok_or_else(|| Failure::Usage(format!("no method {}", config.solver.method)))?;
    let rows = Rows::new(&config, &setting)?;
    let dir = args.run.to.dir("deltazero-out/simulate");
    let output = Output::open(&dir, hash("simulate", &config.identity()), args.run.to.force)?;
    output.remove_of_another(RECORD, &FILES, &[])?;

    let subject = config.mechanism.subject(&config);
    let bar = TimeBar::new(args.run.to.quiet);
    let (n, t_end) = (subject.parts.len(), config.run.t_end);
    let simulated = subject.parts.iter().enumerate().map(|(i, part)| {
        let grid = Grid::uniform(config.run.sample, t_end);
        let tell = |warning: &Warning| warn(&[warning.of(&part.name)], args.run.to.quiet);
        let asked = Asked { setting: &setting, t_end, grid, tell: &tell };
        let mut watch = Limits::none(stop).watch(Price::of_setting(&setting));
        let mut brake = rows.over(bar.over(&mut watch, (i, n), &part.name, t_end));
        let own = part.simulate(&asked, &mut brake);
        Simulated { part, too_long: brake.complaint(own.run.t), own }
    });
    let parts: Vec<_> = simulated.collect();
    let tight = (!args.no_horizon).then(|| {
        bar.say("horizon");
        tight_runs(&subject, &setting, &spans(&config, &setting, &parts), stop)
    });
    drop(bar);
    let horizon = tight.as_ref().map(|tight| tight.horizon);
    let mut warnings = warnings(&config, &parts, horizon);
    warnings.extend(tight.iter().flat_map(|tight| other_events(&subject, &parts, tight)));
    let time = Alone::of(&subject, &setting, &parts, &config, stop);
    let record = RunRecord {
        hash: output.hash.clone(),
        config: config.to_json(),
        version: env!("CARGO_PKG_VERSION"),
        wall_s: time.wall.as_secs_f64(),
        batch: time.batch,
        warnings,
        horizon_s: horizon,
        parts: PartsRecord::new(&setting, &parts),
    };
    let json = json!(record);
    let sites: Vec<_> = parts.iter().flat_map(|part| &part.own.sites).collect();
    output.write_by("trajectory.csv", |out| trajectory_csv(out, &sites))?;
    output.write("events.csv", events_csv(&sites).as_bytes())?;
    output.write_json(RECORD, &json)?;

    if args.run.to.json {
        print(&format!("{json:#}\n"))?;
    } else {
        print(&run_lines(&record, &parts, stop.load(Ordering::Relaxed)))?;
    }
    warn(&record.warnings, args.run.to.quiet);
    if !args.run.to.quiet {
        say(&format!("written to {}: trajectory.csv, events.csv, run.json", output.path()));
    }
    match record.parts.outcome {
        "failed" => Err(Failure::Run(failure(&parts))),
        "interrupted" => Err(Failure::Interrupted("what was computed until then is written")),
        _ if stop.load(Ordering::Relaxed) => Err(Failure::Interrupted(written(horizon))),
        _ => Ok(()),
    }
}

/// What to know before trusting a run of these parts.
fn warnings(config: &Config, parts: &[Simulated<'_>], horizon: Option<Horizon>) -> Vec<Warning> {
    let mut all = config.warnings();
    if let Some(Horizon::LostAt(t)) = horizon {
        let end = parts.iter().map(|part| part.own.run.t).fold(0.0, f64::max);
        let message = format!(
            "the last bit of the start is seen at {} s, the run is {end} s long: beyond that its course is one \
             of many, and only what they have in common means anything",
            as_meant(t)
        );
        all.push(Warning { code: Code::Horizon, message });
    }
    for Simulated { part, own, .. } in parts {
        all.extend(own.warnings.iter().map(|warning| warning.of(&part.name)));
    }
    all
}

/// The time of the integration alone.
struct Alone {
    wall: Duration,
    /// Parts that were computed at once.
    batch: usize,
}

impl Alone {
    /// The shortest of some runs without audit and progress, where those of `parts` are short and neither they nor all
    /// of these were broken off; else that of `parts`, which were run one after the other.
    fn of(
        subject: &Subject,
        setting: &Setting,
        parts: &[Simulated<'_>],
        config: &Config,
        stop: &AtomicBool,
    ) -> Self {
        let wall = parts.iter().map(|part| part.own.run.took.wall).sum();
        let audited = Self { wall, batch: 1 };
        let is_broken_off = |part: &Simulated<'_>| part.own.run.outcome == Ok(Outcome::Interrupted);
        if wall > REPLAY || parts.iter().any(is_broken_off) {
            return audited;
        }
        let t_end = config.run.t_end;
        let grid = Grid::uniform(config.run.sample, t_end);
        let repeats = if wall > SHORT { 1 } else { REPEATS };
        let once = |_| subject.took(setting, t_end, &grid, Limits::none(stop));
        let shortest = (0..repeats).filter_map(once).min_by_key(|timing| timing.took.wall);
        shortest.map_or(audited, |Timing { took, batch }| Self { wall: took.wall, batch })
    }
}

/// The parts that have other events than tight runs have.
fn other_events(subject: &Subject, parts: &[Simulated<'_>], tight: &TightRuns) -> Vec<Warning> {
    let warning = |(i, Simulated { own, .. }): (usize, &Simulated<'_>)| {
        let changes = |site: &SiteMotion| site.compared().map(|own| own.by_code).collect();
        let all: Vec<_> = own.sites.iter().map(changes).collect();
        tight.warning(subject, i, &all, (own.run.t, own.run.stopped_at().is_some()))
    };
    parts.iter().enumerate().filter_map(warning).collect()
}

/// What was run, and at which cost; of what failed or was broken off, that until then.
fn spans(config: &Config, setting: &Setting, parts: &[Simulated<'_>]) -> Vec<Span> {
    let span = |Simulated { own, .. }: &Simulated<'_>| Span {
        t_end: config.run.t_end,
        reached: own.run.t,
        is_stopped: own.run.stopped_at().is_some(),
        work: work(setting.method, setting.rtol(), &own.run.stats.work),
    };
    parts.iter().map(span).collect()
}

/// What there is of a run that came to its end before an interruption.
fn written(horizon: Option<Horizon>) -> &'static str {
    match horizon {
        Some(Horizon::NotMeasured) => {
            "the run is written, how far it is predictable is not measured"
        }
        _ => "the run is written, `wall_s` may be the time with its audit",
    }
}

#[cfg(test)]
mod tests {
    use deltazero_study::Part;

    use super::*;

    #[test]
    fn after_an_interruption_the_time_is_that_of_the_parts_one_after_the_other() {
        let sets = ["run.t_end=0.02".to_owned()];
        let config = Config::load(None, &sets).unwrap();
        let setting = deltazero::run::setting(&config).unwrap();
        let subject = config.mechanism.subject(&config);
        let (running, stopped) = (AtomicBool::new(false), AtomicBool::new(true));
        let simulated = |part| {
            let grid = Grid::Times(Vec::new());
            let asked = Asked { setting: &setting, t_end: config.run.t_end, grid, tell: &|_| {} };
            let mut watch = Limits::none(&running).watch(Price::of_setting(&setting));
            let own = Part::simulate(part, &asked, &mut watch);
            Simulated { part, own, too_long: None }
        };
        let parts: Vec<_> = subject.parts.iter().map(simulated).collect();
        let of = |stop| Alone::of(&subject, &setting, &parts, &config, stop);
        assert_eq!((of(&running).batch, of(&stopped).batch), (2, 1));
        let wall: Duration = parts.iter().map(|part| part.own.run.took.wall).sum();
        assert_eq!(of(&stopped).wall, wall);
    }

    #[test]
    fn an_interruption_says_of_the_horizon_what_run_json_has() {
        assert!(written(Some(Horizon::NotMeasured)).contains("is not measured"));
        for horizon in [None, Some(Horizon::WholeRun), Some(Horizon::LostAt(0.1))] {
            assert!(!written(horizon).contains("predictable"), "{horizon:?}");
        }
    }
}

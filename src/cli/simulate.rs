//! `deltazero simulate`.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use clap::Args;
use deltazero::config::Config;
use deltazero::report::simulation::{events_csv, trajectory_csv};
use deltazero_solvers::{Grid, Outcome, Stats};
use deltazero_study::digits::{as_meant, count_of};
use deltazero_study::energy_balance::Balance;
use deltazero_study::errors::contact_summary::ContactSummary;
use deltazero_study::errors::work::WorkByPhase;
use deltazero_study::horizon::{Horizon, Span, TightRuns, tight_runs};
use deltazero_study::part::Timing;
use deltazero_study::run::{Limits, Price, Setting};
use deltazero_study::selection::work;
use deltazero_study::simulation::{Asked, Simulation, SiteMotion};
use deltazero_study::warning::{Code, Warning, place};
use deltazero_study::{Part, Subject};
use serde_json::{Map, Value, json};

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

/// A part of what is integrated, and its run.
struct Simulated<'a> {
    part: &'a Part,
    own: Simulation,
    /// Why it was broken off, if by too many rows.
    too_long: Option<String>,
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
    let mut summary = run_json(&output, &config, &setting, &parts, &time);
    summary["warnings"] = json!(warnings);
    summary["horizon_s"] = horizon_json(horizon);
    let sites: Vec<_> = parts.iter().flat_map(|part| &part.own.sites).collect();
    output.write_by("trajectory.csv", |out| trajectory_csv(out, &sites))?;
    output.write("events.csv", events_csv(&sites).as_bytes())?;
    output.write_json(RECORD, &summary)?;

    if args.run.to.json {
        print(&format!("{summary:#}\n"))?;
    } else {
        print(&report_lines(&summary, &parts, horizon, stop.load(Ordering::Relaxed)))?;
    }
    warn(&warnings, args.run.to.quiet);
    if !args.run.to.quiet {
        say(&format!("written to {}: trajectory.csv, events.csv, run.json", output.path()));
    }
    match outcome(&parts) {
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

/// A time [s], null for a run that is predictable to its end, `"not_measured"`.
fn horizon_json(horizon: Option<Horizon>) -> Value {
    match horizon {
        Some(Horizon::LostAt(t)) => t.into(),
        Some(Horizon::WholeRun) => Value::Null,
        Some(Horizon::NotMeasured) | None => "not_measured".into(),
    }
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

fn horizon_line(horizon: Option<Horizon>, has_failed: bool, is_interrupted: bool) -> String {
    match horizon {
        Some(Horizon::LostAt(t)) => format!("predictable up to {} s\n", as_meant(t)),
        Some(Horizon::WholeRun) if has_failed => "predictable as far as it came\n".to_owned(),
        Some(Horizon::WholeRun) => "predictable to its end\n".to_owned(),
        Some(Horizon::NotMeasured) if is_interrupted => "horizon not measured\n".to_owned(),
        Some(Horizon::NotMeasured) => {
            "horizon not measured: no tight run came to the end at a few times the work\n"
                .to_owned()
        }
        None => String::new(),
    }
}

/// `failed` if any part did, else `interrupted`, else the name of the end if every part came to it.
fn outcome(parts: &[Simulated<'_>]) -> &'static str {
    let any = |outcome| parts.iter().any(|part| part.own.run.outcome == Ok(outcome));
    if parts.iter().any(|part| part.own.run.outcome.is_err() || part.too_long.is_some()) {
        "failed"
    } else if any(Outcome::Interrupted) {
        "interrupted"
    } else if any(Outcome::Finished) {
        "finished"
    } else {
        parts.first().map_or("finished", |part| part.part.end_name.key)
    }
}

/// What tells a site of a part apart, as the fields of a row.
fn labels(part: &Part, site: usize) -> Map<String, Value> {
    part.labels[site].iter().map(|(name, value)| ((*name).to_owned(), (*value).into())).collect()
}

fn run_json(
    output: &Output,
    config: &Config,
    setting: &Setting,
    parts: &[Simulated<'_>],
    time: &Alone,
) -> Value {
    let (mut stats, mut balance) = (Stats::default(), None::<Balance>);
    let mut work = Vec::new();
    for Simulated { own, .. } in parts {
        stats += own.run.stats;
        if let Some(own) = own.balance {
            *balance.get_or_insert_default() += own;
        }
        work.extend_from_slice(&own.work);
    }
    let count =
        |of: fn(&Simulation) -> usize| parts.iter().map(|part| of(&part.own)).sum::<usize>();
    let end_name = parts.first().map_or("stopped", |part| part.part.end_name.key);
    let mut counts = json!({
        "n_rhs": stats.work.n_rhs,
        "n_accepted": stats.n_accepted,
        "n_implicit": stats.n_implicit,
        "n_rejected": stats.n_rejected,
        "n_retaken": stats.n_retaken,
        "n_events": count(|own| own.n_events),
        "n_grazing": stats.n_grazing,
        "n_jac": stats.work.n_jac,
        "n_factorisations": stats.work.n_factorisations,
        "n_lin_solves": stats.work.n_lin_solves,
        "n_at_speed_floor": count(|own| own.n_at_speed_floor),
    });
    if let Some(order) = setting.method.series_order(setting.rtol()) {
        counts["series_order"] = order.into();
    }
    let mut all = json!({
        "hash": output.hash,
        "config": config.to_json(),
        "version": env!("CARGO_PKG_VERSION"),
        "wall_s": time.wall.as_secs_f64(),
        "batch": time.batch,
        "counts": counts,
        "work_by_phase": WorkByPhase::new(&work),
        "outcome": outcome(parts),
        "error": parts.iter().find_map(error),
    });
    all[format!("{end_name}_s")] = parts.iter().filter_map(reached).collect();
    if let Some(balance) = balance {
        all["energy"] = json!(balance);
    }
    if parts.iter().any(|part| part.own.contacts.is_some()) {
        all["contacts"] = parts.iter().flat_map(contact_rows).collect();
    }
    all
}

/// Where and when a part came to its end.
fn reached(Simulated { part, own, .. }: &Simulated<'_>) -> Option<Value> {
    let mut row = labels(part, own.stopped?);
    row.insert("t_s".to_owned(), own.run.t.into());
    Some(row.into())
}

/// Why a part failed, if it did.
fn error(Simulated { part, own, too_long }: &Simulated<'_>) -> Option<Value> {
    let failure = own.run.outcome.as_ref().err().map(ToString::to_string);
    let message = failure.or_else(|| too_long.clone())?;
    let mut row = labels(part, own.failed_site.unwrap_or(0));
    if own.failed_site.is_none() && part.labels.len() > 1 {
        row.insert(part.labels[0][0].0.to_owned(), Value::Null);
    }
    row.insert("t".to_owned(), own.run.t.into());
    row.insert("mode".to_owned(), own.run.mode.clone().into());
    row.insert("message".to_owned(), message.into());
    Some(row.into())
}

/// The contacts of each site of a part, in short; none where the model tells of none.
fn contact_rows(Simulated { part, own, .. }: &Simulated<'_>) -> Vec<Value> {
    let row = |(site, contacts): (usize, &Vec<_>)| {
        let mut row = json!(ContactSummary::of(contacts.iter()));
        for (name, value) in labels(part, site) {
            row[name] = value;
        }
        row
    };
    own.contacts.iter().flatten().enumerate().map(row).collect()
}

/// The contacts of a part in a line; none where there are none.
fn contact_line(Simulated { own, .. }: &Simulated<'_>) -> Option<String> {
    let own = ContactSummary::of(own.contacts.iter().flatten().flatten());
    let (force, at) = own.peak_force_n.zip(own.peak_force_at_s)?;
    let speeds = own.smallest_impact_speed_m_s.zip(own.largest_impact_speed_m_s);
    // A contact without penetration has no rate of it.
    let speeds = speeds.filter(|(_, most)| *most > 0.0);
    let speeds = speeds.map_or_else(String::new, |(least, most)| {
        format!(", impacts at {least:.3e} to {most:.3e} m/s")
    });
    Some(format!(
        "  {}: peak force {force:.4e} N at {at:.6} s, deepest {:.3e} m{speeds}, impulse {:.4e} N s, \
         longest {:.3e} s\n",
        count_of(own.n, "contact"),
        own.deepest_m?,
        own.impulse_n_s,
        own.longest_s?
    ))
}

/// The message of a failed run: where, in which mode, what to try.
fn failure(parts: &[Simulated<'_>]) -> String {
    let failed = parts.iter().find_map(|part| Some((part, error(part)?)));
    let Some((Simulated { part, own, .. }, error)) = failed else { return String::new() };
    let message = error["message"].as_str().unwrap_or_default();
    let lines = own.failed_place.as_ref().map_or_else(String::new, |lines| format!("\n{lines}"));
    format!("{}{message}; what was computed until then is written{lines}", place(&part.name))
}

fn report_lines(
    summary: &Value,
    parts: &[Simulated<'_>],
    horizon: Option<Horizon>,
    is_interrupted: bool,
) -> String {
    let counts = &summary["counts"];
    let counted = |key: &str, thing| count_of(counts[key].as_u64().unwrap_or(0), thing);
    let mut text = format!(
        "{}: {}, {}, {} ({} rejected, {} retaken), {:.2} ms{}\n",
        outcome(parts),
        counted("n_events", "event"),
        counted("n_rhs", "right-hand side"),
        counted("n_accepted", "step"),
        counts["n_rejected"],
        counts["n_retaken"],
        1e3 * summary["wall_s"].as_f64().unwrap_or(f64::NAN),
        match summary["batch"].as_u64() {
            Some(n) if n > 1 => format!(" ({n} parts at once)"),
            _ => String::new(),
        }
    );
    for part in parts {
        text += &part_line(part);
        text += &contact_line(part).unwrap_or_default();
    }
    let has_failed = parts.iter().any(|part| error(part).is_some());
    text += &horizon_line(horizon, has_failed, is_interrupted);
    match summary["warnings"].as_array().map_or(0, Vec::len) {
        0 => {}
        n => text += &format!("{}, in run.json\n", count_of(n, "warning")),
    }
    text
}

/// A part in a line: where it ended, in which mode, and how good its energy balance is.
fn part_line(Simulated { part, own, .. }: &Simulated<'_>) -> String {
    let name = match (part.name.as_str(), part.sites.len()) {
        ("", _) => String::new(),
        (name, 1) => format!("{name}: "),
        (name, n) => format!("{name} of {n} {}s: ", part.labels[0][0].0),
    };
    let t = own.run.t;
    let end = match own.stopped {
        Some(site) => {
            let place = match part.labels[site].first() {
                Some((label, value)) if part.sites.len() > 1 => format!("{label} {value} "),
                _ => String::new(),
            };
            format!("{place}{} at {t:.6} s, {}", part.end_name.words, own.end)
        }
        None => format!("{} at t = {t:e} s", own.end),
    };
    let energy = own.balance.map_or_else(String::new, |balance| {
        format!("; energy residual {:.1e} J of {:.1e} J of work", balance.residual, balance.work)
    });
    format!("{name}{end}, {}{energy}\n", own.run.mode)
}

#[cfg(test)]
mod tests {
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

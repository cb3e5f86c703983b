//! `deltazero simulate`.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use clap::Args;
use deltazero::config::Config;
use deltazero::model::{Jointed, Mechanism, Part};
use deltazero::report;
use deltazero::run::{JointHistory, contacts_at_floor, histories, switches};
use deltazero::study::restitution;
use deltazero_solvers::{Error, Grid, Next, Outcome, Stats, Trajectory, WorkByKind};
use deltazero_study::Problem as _;
use deltazero_study::energy_balance::{Balance, EnergyBalance};
use deltazero_study::errors::contact_summary::ContactSummary;
use deltazero_study::errors::contacts::{Contact, Contacts};
use deltazero_study::errors::work::WorkByPhase;
use deltazero_study::horizon::{Horizon, Span, horizon};
use deltazero_study::part::counted;
use deltazero_study::problem::leading_site;
use deltazero_study::run::{Braked, Limits, OwnRun, PartRun, Price, Setting, integrate};
use deltazero_study::selection::work;
use deltazero_study::stiffness::Stiffness;
use deltazero_study::warning::{Code, Warning};
use serde_json::{Value, json};

use super::output::{Output, hash};
use super::progress::{TimeBar, TimeOf};
use super::rows::Rows;
use super::{Failure, RunArgs, print, say, warn};

#[derive(Args)]
pub(super) struct SimulateArgs {
    #[command(flatten)]
    run: RunArgs,
    /// Do not measure how far the motion is predictable, which takes two tight runs more
    #[arg(long)]
    no_horizon: bool,
}

/// A run beyond this is not repeated for its time: audit and progress are then part of it.
const REPLAY: Duration = Duration::from_secs(5);

/// One part of a simulation.
struct Simulated<'a> {
    joints: Vec<JointHistory<'a>>,
    /// The contacts of each joint.
    contacts: Vec<Vec<Contact>>,
    /// Contacts that began at the floor of the impact speed or below it.
    n_at_floor: usize,
    run: PartRun,
    /// The number of its joint.
    joint: usize,
    /// The angle of each joint at the end [rad].
    angles: Vec<f64>,
    /// Its modes at the end, as a message says them.
    mode: String,
    /// The bay that reached 90°, if one did.
    reached_90: Option<usize>,
    /// The bay whose error ended it, where it is known.
    failed_bay: Option<usize>,
    /// Why it was broken off, if by too many rows.
    too_long: Option<String>,
    balance: Balance,
    /// Work by the phase that it was done in.
    work: Vec<(&'static str, Stats)>,
    wall: Duration,
    /// What to know before trusting it.
    warnings: Vec<Warning>,
}

pub(super) fn run(args: &SimulateArgs, stop: &AtomicBool) -> Result<(), Failure> {
    let config = args.run.load()?;
    let setting = deltazero::run::setting(&config)
        .ok_or_else(|| Failure::Usage(format!("no method {}", config.solver.method)))?;
    let rows = Rows::new(&config, &setting)?;
    let dir = args.run.out.clone().unwrap_or_else(|| PathBuf::from("deltazero-out/simulate"));
    let output = Output::open(&dir, hash("simulate", &config.to_json()), args.run.force)?;

    let mechanism = Mechanism::new(&config);
    let bar = TimeBar::new(args.run.quiet);
    let time = |joint| bar.of(joint, mechanism.parts.len(), config.run.t_end);
    let parts = mechanism.parts.iter().map(|part| {
        let time = time(part.block().joint);
        match part {
            Part::Block(block) => {
                simulate(block, &setting, &config, (time, rows), (args.run.quiet, stop))
            }
            Part::Chain(chain) => {
                simulate(chain, &setting, &config, (time, rows), (args.run.quiet, stop))
            }
        }
    });
    let parts: Vec<_> = parts.collect();
    let horizon = (!args.no_horizon).then(|| {
        bar.say("horizon");
        horizon(&mechanism.subject(), &spans(&config, &setting, &parts), stop)
    });
    drop(bar);
    let warnings = warnings(&config, &parts, horizon);
    let mut summary = run_json(&output, &config, &setting, &parts);
    summary["warnings"] = json!(warnings);
    summary["horizon_s"] = horizon_json(horizon);
    let joints: Vec<_> = parts.iter().flat_map(|part| &part.joints).collect();
    output.write_by("trajectory.csv", |out| report::trajectory_csv(out, &joints))?;
    output.write("events.csv", report::events_csv(&joints).as_bytes())?;
    output.write("run.json", format!("{summary:#}\n").as_bytes())?;

    if args.run.json {
        print(&format!("{summary:#}\n"))?;
    } else {
        print(&report_lines(&summary, &parts, horizon))?;
    }
    warn(&warnings, args.run.quiet);
    if !args.run.quiet {
        say(&format!("written to {}: trajectory.csv, events.csv, run.json", output.path()));
    }
    match outcome(&parts) {
        "failed" => Err(Failure::Run(failure(&summary))),
        "interrupted" => Err(Failure::Interrupted("what was computed until then is written")),
        _ if stop.load(Ordering::Relaxed) => Err(Failure::Interrupted(
            "the run is written, how far it is predictable is not measured",
        )),
        _ => Ok(()),
    }
}

fn simulate<'a, P: Jointed>(
    part: &'a P,
    setting: &Setting,
    config: &Config,
    (time, rows): (TimeOf<'_>, Rows),
    (quiet, stop): (bool, &AtomicBool),
) -> Simulated<'a> {
    let (y0, t_end) = (part.start(), config.run.t_end);
    let balance = EnergyBalance::new(part, setting.events, &y0);
    let trajectory = || Trajectory::on(Grid::uniform(config.run.sample, t_end));
    let mut watch = Limits::none(stop).watch(Price::of_setting(setting));
    let phase = |mode: P::Mode| part.role(&mode, leading_site(part, &mode)).phase();
    let work = WorkByKind::new(phase);
    let contacts = Contacts::new(part, setting.events);
    let is_explicit = !setting.method.is_implicit() && !setting.method.chooses();
    let tell = |warning: &Warning| warn(std::slice::from_ref(warning), quiet || !is_explicit);
    let audit = (balance, Stiffness::new(part, &tell));
    let mut record =
        ((trajectory(), audit), ((time, (Braked(&mut watch), rows)), (work, contacts)));
    let run = integrate(part, setting, y0.clone(), t_end, &mut record);
    let ((kept, (balance, stiffness)), ((_, (_, rows)), (work, contacts))) = record;
    let stiff =
        stiffness.warning().filter(|_| is_explicit).map(|warning| with_floor(part, warning));
    let alone = || integrate(part, setting, y0, t_end, &mut trajectory()).took.wall;
    let events = switches(part, &kept.events);
    let last = kept.events.last().filter(|event| event.after == Next::Stop);
    let reached_90 = run
        .stopped_at()
        .map(|_| last.map_or(1, |event| part.site_of_guard(&event.before, event.guard) + 1));
    Simulated {
        joints: histories(part, &kept, part.n_sites()),
        contacts: contacts.lists().unwrap_or_else(|| vec![Vec::new(); part.n_sites()]),
        n_at_floor: events.iter().map(|own| contacts_at_floor(part.block(), own)).sum(),
        wall: wall(&run.outcome, run.took.wall, alone),
        mode: format!("{:?}", run.mode),
        reached_90,
        failed_bay: failed_bay(part, &run),
        too_long: rows.complaint(run.t),
        warnings: balance.check.warnings(setting.rtol()).into_iter().chain(stiff).collect(),
        balance: balance.at(&run.mode, &run.y).unwrap_or_default(),
        joint: part.block().joint,
        angles: (0..part.n_sites()).map(|k| part.joint_state(run.y.as_ref(), k)[2]).collect(),
        run: run.plain(),
        work: work.kinds,
    }
}

/// Another way out of stiffness, of a law with hysteresis.
fn with_floor<P: Jointed>(part: &P, mut warning: Warning) -> Warning {
    if part.block().normal.hysteresis != 0.0 {
        warning.message +=
            ", or, where a contact begins slowly, a larger contact.impact_speed_floor";
    }
    warning
}

/// The bay that an error of a run is about, where it is about one.
fn failed_bay<P: Jointed>(part: &P, run: &OwnRun<P>) -> Option<usize> {
    let error = run.outcome.as_ref().err()?;
    part.failed_joint(error, &run.mode, &run.y).map(|k| k + 1)
}

/// What to know before trusting a run of these parts.
fn warnings(config: &Config, parts: &[Simulated<'_>], horizon: Option<Horizon>) -> Vec<Warning> {
    let mut all = restitution::warnings(config);
    if let Some(Horizon::LostAt(t)) = horizon {
        let end = parts.iter().map(|part| part.run.t).fold(0.0, f64::max);
        let message = format!(
            "the last bit of the start is seen at {t} s, the run is {end} s long: beyond that its course is one \
             of many, and only what they have in common means anything"
        );
        all.push(Warning { code: Code::Horizon, message });
    }
    all.extend(parts.iter().flat_map(|part| part.warnings.iter().cloned()));
    all
}

/// What was run, and at which cost; of what failed or was broken off, that until then.
fn spans(config: &Config, setting: &Setting, parts: &[Simulated<'_>]) -> Vec<Span> {
    let span = |part: &Simulated<'_>| Span {
        t_end: config.run.t_end,
        reached: part.run.t,
        work: work(setting.method, setting.rtol(), &part.run.stats.work),
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

fn horizon_line(horizon: Option<Horizon>) -> String {
    match horizon {
        Some(Horizon::LostAt(t)) => format!("predictable up to {t} s\n"),
        Some(Horizon::WholeRun) => "predictable to its end\n".to_owned(),
        Some(Horizon::NotMeasured) => {
            "horizon not measured: no tight run came to the end at a few times the work\n"
                .to_owned()
        }
        None => String::new(),
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
    let any = |outcome| parts.iter().any(|part| part.run.outcome == Ok(outcome));
    if parts.iter().any(|part| part.run.outcome.is_err() || part.too_long.is_some()) {
        "failed"
    } else if any(Outcome::Interrupted) {
        "interrupted"
    } else if any(Outcome::Finished) {
        "finished"
    } else {
        "reached_90"
    }
}

fn run_json(output: &Output, config: &Config, setting: &Setting, parts: &[Simulated<'_>]) -> Value {
    let (mut stats, mut balance) = (Stats::default(), Balance::default());
    let mut work = Vec::new();
    for part in parts {
        stats += part.run.stats;
        balance += part.balance;
        work.extend_from_slice(&part.work);
    }
    let joints = parts.iter().flat_map(|part| &part.joints);
    let n_events: usize =
        joints.map(|own| counted(&own.changes, own.block.starts_on_surface()).len()).sum();
    let n_at_floor: usize = parts.iter().map(|part| part.n_at_floor).sum();
    let reached = |part: &Simulated<'_>| {
        let bay = part.reached_90?;
        Some(json!({ "bay": bay, "joint": part.joint, "t_s": part.run.t }))
    };
    let error = parts.iter().find_map(|part| {
        let failure = part.run.outcome.as_ref().err().map(ToString::to_string);
        let message = failure.or_else(|| part.too_long.clone())?;
        let (t, bay, joint, mode) = (part.run.t, part.failed_bay, part.joint, &part.mode);
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
        "contacts": parts.iter().flat_map(contact_rows).collect::<Vec<_>>(),
        "reached_90_s": parts.iter().filter_map(reached).collect::<Vec<_>>(),
        "outcome": outcome(parts),
        "error": error,
    })
}

/// The contacts of each joint of a part, in short.
fn contact_rows<'a>(part: &'a Simulated<'_>) -> impl Iterator<Item = Value> + use<'a> {
    part.joints.iter().zip(&part.contacts).map(|(joint, contacts)| {
        let mut row = json!(ContactSummary::of(contacts.iter()));
        row["bay"] = joint.bay.into();
        row["joint"] = part.joint.into();
        row
    })
}

/// The contacts of a part in a line; none where there are none.
fn contact_line(part: &Simulated<'_>) -> Option<String> {
    let own = ContactSummary::of(part.contacts.iter().flatten());
    let (force, at) = own.peak_force_n.zip(own.peak_force_at_s)?;
    let speeds = own.smallest_impact_speed_m_s.zip(own.largest_impact_speed_m_s);
    let speeds = speeds.map_or_else(String::new, |(least, most)| {
        format!(", impacts at {least:.3e} to {most:.3e} m/s")
    });
    Some(format!(
        "  {} contact{}: peak force {force:.4e} N at {at:.6} s, deepest {:.3e} m{speeds}, impulse {:.4e} N s, \
         longest {:.3e} s\n",
        own.n,
        if own.n == 1 { "" } else { "s" },
        own.deepest_m?,
        own.impulse_n_s,
        own.longest_s?
    ))
}

/// The message of a failed run: where, in which mode, what to try.
fn failure(summary: &Value) -> String {
    let error = &summary["error"];
    let message = error["message"].as_str().unwrap_or_default();
    format!("joint {}: {message}; what was computed until then is written", error["joint"])
}

fn report_lines(summary: &Value, parts: &[Simulated<'_>], horizon: Option<Horizon>) -> String {
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
        let (joint, t) = (part.joint, part.run.t);
        let what = match part.joints.len() {
            1 => format!("joint {joint}"),
            bays => format!("joint {joint} of {bays} bays"),
        };
        let angle = match part.reached_90 {
            Some(bay) if part.joints.len() > 1 => {
                format!("bay {bay} reached 90 degrees at {t:.6} s")
            }
            Some(_) => format!("reached 90 degrees at {t:.6} s"),
            None => {
                let angles: Vec<_> =
                    ends(&part.angles).map(|angle| format!("{angle:.6e}")).collect();
                format!("theta = {} rad at t = {t:e} s", angles.join(" to "))
            }
        };
        text += &format!(
            "{what}: {angle}, {}; energy residual {:.1e} J of {:.1e} J of work\n",
            part.mode, part.balance.residual, part.balance.work
        );
        text += &contact_line(part).unwrap_or_default();
    }
    text += &horizon_line(horizon);
    match summary["warnings"].as_array().map_or(0, Vec::len) {
        0 => {}
        1 => text += "1 warning, in run.json\n",
        n => text += &format!("{n} warnings, in run.json\n"),
    }
    text
}

/// The first and, of several, the last.
fn ends(angles: &[f64]) -> impl Iterator<Item = &f64> {
    let last = if angles.len() > 1 { angles.last() } else { None };
    angles.first().into_iter().chain(last)
}

//! `deltazero audit`.

use std::sync::atomic::{AtomicBool, Ordering};

use clap::Args;
use deltazero::config::Config;
use deltazero::keys::{FrictionLaw, Shared, Study};
use deltazero::paper::audit::{Audit, audit};
use deltazero::{figures, report};
use serde_json::{Value, json};

use super::output::{Output, hash};
use super::progress::Bar;
use super::{Failure, RunArgs, default_only, or_cores, print, say, warn};

/// The record of an audit.
const RECORD: &str = "audit.json";
/// What stands beside it.
const FILES: [&str; 4] = ["audit.html", "audit.md", "audit.csv", "courses.csv"];

#[derive(Args)]
pub(super) struct AuditArgs {
    #[command(flatten)]
    run: RunArgs,
    /// Runs at the same time; the default is one a core
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

pub(super) fn run(args: &AuditArgs, stop: &AtomicBool) -> Result<(), Failure> {
    let config =
        one_bay(default_only(args.run.load()?, "the claims are those of the struts' paper")?)?;
    let asked = used(&config)?;
    let dir = args.run.to.dir("deltazero-out/audit");
    let output = Output::open(&dir, hash("audit", &asked), args.run.to.force)?;
    warn(&config.warnings(), args.run.to.quiet);
    let unused = differing(&config.to_json(), &asked);
    if !unused.is_empty() && !args.run.to.quiet {
        let unused = unused.join(", ");
        say(&format!(
            "warning: an audit does not use {unused}: readings, methods, tolerances and times are those of its claims"
        ));
    }
    output.remove_of_another(RECORD, &FILES, &figures::OF_AUDITS)?;
    let bar = Bar::new(args.run.to.quiet);
    let audit = audit(&config, or_cores(args.threads), stop, &|progress| bar.show(progress));
    if stop.load(Ordering::Relaxed) {
        return Err(Failure::Interrupted("nothing is written; the same command begins anew"));
    }
    let audit = audit.ok_or_else(|| Failure::Run("the method of the audit is missing".into()))?;
    report::audit::cut_short(&audit).for_each(|run| bar.line(&format!("warning: {run}")));
    bar.say("figures");
    write(&output, &config, &audit)?;
    drop(bar);
    if args.run.to.json {
        print(&format!("{:#}\n", json!(audit.rows)))?;
    } else {
        print(&report::audit::text(&audit))?;
    }
    if !args.run.to.quiet {
        say(&format!(
            "written to {}: audit.html, audit.md, audit.csv, audit.json, courses.csv, figures/",
            output.path()
        ));
    }
    Ok(())
}

/// Refuses what an audit, which integrates each joint as a block of six states, cannot have.
fn one_bay(config: Config) -> Result<Config, Failure> {
    let refused = |what: &str| {
        let way_out = "an audit takes one bay, without bristles; `simulate`, `study`, `recommend`, `sweep` \
                       and `regimes` take it";
        Err(Failure::Usage(format!("{what}: {way_out}")))
    };
    if config.bays > 1 {
        return refused(&format!("bays = {}", config.bays));
    }
    if config.joints.iter().any(|joint| joint.friction.law == FrictionLaw::Lugre) {
        return refused("friction.law = lugre");
    }
    for (key, torque) in [("drive.m1", config.drive.m1), ("drive.m4", config.drive.m4)] {
        if torque == 0.0 {
            return Err(Failure::Usage(format!(
                "{key} = 0: a strut without torque stays where it is, and the claims are of its way to 90°; give it a torque"
            )));
        }
    }
    Ok(config)
}

/// The configuration as results are named by: without what an audit does not use.
fn used(config: &Config) -> Result<Value, Failure> {
    let Shared { reading, bays, run, solver, study, contest, regimes, .. } =
        Config::table1()?.shared;
    let Study { max_rhs, max_seconds, .. } = config.study;
    let study = Study { max_rhs, max_seconds, ..study };
    let shared =
        Shared { reading, bays, run, solver, study, contest, regimes, ..config.shared.clone() };
    let used = Config { shared, ..config.clone() };
    Ok(used.to_json())
}

/// Paths of the values in which two configurations differ.
fn differing(a: &Value, b: &Value) -> Vec<String> {
    let Some(entries) = a.as_object() else { return Vec::new() };
    let mut paths = Vec::new();
    for (name, own) in entries.iter().filter(|(name, own)| b[name.as_str()] != **own) {
        let inner = differing(own, &b[name.as_str()]);
        let path = |inner: String| format!("{name}.{inner}");
        if inner.is_empty() {
            paths.push(name.clone())
        } else {
            paths.extend(inner.into_iter().map(path))
        }
    }
    paths
}

fn write(output: &Output, config: &Config, audit: &Audit) -> Result<(), Failure> {
    let mut drawings = figures::audit::drawings(audit);
    drawings.push(figures::torque_ratio::drawing(&audit.torque_ratio));
    let pictures = output.draw(&drawings)?;
    let record = json!({
        "hash": output.hash,
        "version": env!("CARGO_PKG_VERSION"),
        "config": config.to_json(),
        "audit": audit,
    });
    output.write("audit.csv", report::audit::csv(&audit.rows).as_bytes())?;
    output.write("courses.csv", report::audit::courses_csv(audit).as_bytes())?;
    output.write("audit.md", report::audit::markdown(config, audit, &drawings).as_bytes())?;
    output
        .write("audit.html", report::html::audit_page(config, audit, pictures).html().as_bytes())?;
    output.write_json(RECORD, &record)
}

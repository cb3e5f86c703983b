//! `deltazero regimes`.

use std::sync::atomic::{AtomicBool, Ordering};

use clap::Args;
use deltazero::chunks::Chunks;
use deltazero::config::Config;
use deltazero::figures;
use deltazero::keys::JointConfig;
use deltazero::report::html::regimes_page;
use deltazero::report::regimes::{csv, markdown};
use deltazero::study::contests::keep;
use deltazero::study::machine::Machine;
use deltazero::study::regimes::{Cell, Site, cells, estimate, quick, sites};
use deltazero_study::digits::count_of;
use deltazero_study::forecast::Forecast;
use deltazero_study::reference::RECIPE;
use serde_json::json;

use super::contests;
use super::output::{Output, hash, is_current};
use super::progress::{Bar, spoken};
use super::{Failure, RESUMED, RunArgs, default_only, note_left_out, print, say, warn};

/// The record of a map.
const RECORD: &str = "regimes.json";
/// What stands beside it.
const FILES: [&str; 3] = ["regimes.html", "regimes.md", "regimes.csv"];

#[derive(Args)]
pub(super) struct RegimesArgs {
    #[command(flatten)]
    pub(super) run: RunArgs,
    /// One of the two numbers of the mechanism, or parameters of a model, that the map is over, in place of stiffness and damping ratio:
    /// NAME=v1,v2,... or NAME=a:b:n, n values from a to b, each the same factor above the last (twice)
    #[arg(long, value_name = "NAME=VALUES", conflicts_with = "quick")]
    pub(super) axis: Vec<String>,
    /// Cells at the same time, instead of regimes.threads
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
    /// A preview: every third stiffness, every second damping ratio, at most 0.25 s
    #[arg(long)]
    quick: bool,
}

/// Refuses what the map, which gives both joints the same stiffness and damping, would not be of.
fn of_power(config: Config) -> Result<Config, Failure> {
    let by_axes = |what: String| {
        let way_out = "`--axis NAME=VALUES` twice makes a map over any two numbers";
        Err(Failure::Usage(format!("{what}; {way_out}")))
    };
    let [one, two] = &config.joints;
    if let Some(joint) = [one, two].into_iter().find(|joint| joint.contact.law.word != "power") {
        let law = joint.contact.law;
        return by_axes(format!(
            "the map is over K and ζ of F_N = K δⁿ + D δ̇, and contact.law = {law} does not have both"
        ));
    }
    if one.joint.clearance == 0.0 && two.joint.clearance == 0.0 {
        let what =
            "joint.clearance = 0: there is no contact to make a map of; give one joint a clearance";
        return Err(Failure::Usage(what.to_owned()));
    }
    let of_map = |joint: &JointConfig| (joint.contact.stiffness, joint.contact.damping);
    if of_map(one) != of_map(two) {
        let what = "contact.stiffness or contact.damping differs from joint to joint, and the map gives both joints the same";
        return by_axes(what.to_owned());
    }
    Ok(config)
}

pub(super) fn run(args: &RegimesArgs, stop: &AtomicBool) -> Result<(), Failure> {
    let why = "the map's damping ratio is that of the struts' masses under F_N = K δ + D δ̇";
    let mut config = of_power(default_only(args.run.load()?, why)?)?;
    let mut dir = "deltazero-out/regimes";
    if args.quick {
        config = quick(&config);
        dir = "deltazero-out/regimes-quick";
    }
    let dir = args.run.to.dir(dir);
    let output = Output::open(&dir, hash("regimes", &config.identity()), args.run.to.force)?;
    contests::remove_of_another(&dir, &output, RECORD)?;
    output.remove_of_another(RECORD, &FILES, &figures::regimes::ALL)?;
    if let Some(threads) = args.threads {
        config.regimes.threads = usize::from(threads);
    }
    note_left_out(&config, &config.contest.events, args.run.to.quiet);
    warn(&config.warnings(), args.run.to.quiet);
    let sites = sites(&config);
    let chunks = contests::chunks(&dir, &output, RECORD, sites.len())?;
    take_up(&output, &config, &sites, &chunks)?;
    let site = |number: &u64| sites[*number as usize];
    // The stiffest first: they take longest, and none of them is left for the end.
    let mut order = contests::missing(&chunks)?;
    order.sort_by(|a, b| site(b).stiffness.total_cmp(&site(a).stiffness));
    let missing: Vec<Site> = order.iter().map(site).collect();
    let told = (args.run.to.quiet, stop);
    let forecast = announce(&config, &missing, told);
    let subject = |number| site(&number).subject(&config);
    let contests = contests::run(&config, &chunks, &order, &subject, forecast, told)?;
    let cells = cells(&config, &sites, &contests);
    output.write("regimes.csv", csv(&cells).as_bytes())?;
    if stop.load(Ordering::Relaxed) {
        write_json(&output, &config, &cells)?;
        return Err(Failure::Interrupted(RESUMED));
    }
    write(&output, &config, &cells, args)?;
    Ok(chunks.clear()?)
}

/// Takes up the cells that are in no chunk: of a map that is finished, or that a version without chunks began.
fn take_up(
    output: &Output,
    config: &Config,
    sites: &[Site],
    chunks: &Chunks,
) -> Result<(), Failure> {
    let known = known(output);
    for number in contests::missing(chunks)? {
        if let Some(contests) = sites[number as usize].contests(config, &known) {
            keep(chunks, number, &contests)?;
        }
    }
    Ok(())
}

/// Writes the files of a finished map, and prints it.
fn write(
    output: &Output,
    config: &Config,
    cells: &[Cell],
    args: &RegimesArgs,
) -> Result<(), Failure> {
    let drawings = figures::regimes::drawings(cells);
    let pictures = output.draw(&drawings)?;
    let page = regimes_page(config, cells, pictures);
    output.write("regimes.html", page.html().as_bytes())?;
    let text = markdown(config, cells, &drawings);
    output.write("regimes.md", text.as_bytes())?;
    write_json(output, config, cells)?;
    print(&if args.run.to.json { format!("{:#}\n", json!(cells)) } else { text })?;
    if !args.run.to.quiet {
        say(&format!(
            "written to {}: regimes.html, regimes.md, regimes.csv, regimes.json, figures/",
            output.path()
        ));
    }
    Ok(())
}

/// Says how long it will take, after short trials; none where nobody is told, or it was interrupted.
fn announce(
    config: &Config,
    missing: &[Site],
    (quiet, stop): (bool, &AtomicBool),
) -> Option<Forecast> {
    if quiet || missing.is_empty() {
        return None;
    }
    let grid = &config.regimes;
    say(&format!(
        "stiffness x damping ratio x accuracy: {} x {} x {}, {}, to {} s; {} to make",
        grid.stiffness.len(),
        grid.damping_ratio.len(),
        grid.accuracy.len(),
        count_of(grid.readings.as_ref().map_or(1, Vec::len), "reading"),
        config.run.t_end,
        count_of(missing.len(), "site")
    ));
    say("short trials, to tell how long it will take");
    let bar = Bar::new(quiet);
    let shown = |n, of| bar.show_part(n, of, "short trials".to_owned());
    let forecast = estimate(config, missing, stop, &shown)?;
    drop(bar);
    let time = spoken(forecast.left());
    say(&format!("it will take some {time} on {}", count_of(grid.threads, "thread")));
    Some(forecast)
}

/// The cells of an earlier run of the same configuration on this machine and by this build.
fn known(output: &Output) -> Vec<Cell> {
    let cells = output.own(RECORD).and_then(|mut map| {
        if !is_current(&map) || !Machine::here().wrote(&map) {
            return None;
        }
        serde_json::from_value::<Vec<Cell>>(map.get_mut("cells")?.take()).ok()
    });
    cells.unwrap_or_default()
}

fn write_json(output: &Output, config: &Config, cells: &[Cell]) -> Result<(), Failure> {
    let map = json!({
        "hash": output.hash,
        "version": env!("CARGO_PKG_VERSION"),
        "recipe": RECIPE,
        "machine": Machine::here(),
        "config": config.to_json(),
        "cells": cells,
    });
    output.write_json(RECORD, &map)
}

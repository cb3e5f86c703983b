//! `deltazero regimes --axis …`: the contest over any two numbers of a mechanism, or parameters of a model.

use std::sync::atomic::{AtomicBool, Ordering};

use deltazero::config::{Config, ConfigError, Model, Place, Variants, is_of_runs};
use deltazero::figures::map::{WINNERS, winners};
use deltazero::report::regimes::map_csv;
use deltazero::studied::{map_markdown, map_table};
use deltazero::sweep::plan::Values;
use deltazero_study::digits::in_short;
use deltazero_study::map::{Map, MapAxis, pairs};
use serde_json::json;

use super::contests;
use super::output::{Output, hash};
use super::regimes::RegimesArgs;
use super::{Failure, RESUMED, note_left_out, print, say, warn};

/// Most values of an axis.
const MOST: usize = 1000;
/// The record of a map.
const RECORD: &str = "map.json";

/// Runs the contest in every cell of the two axes, and writes the map.
pub(super) fn run(args: &RegimesArgs, stop: &AtomicBool) -> Result<(), Failure> {
    let mut axes = axes(&args.axis)?;
    let mut variants = variants(args, &axes)?;
    let mut config = variants.config().clone();
    for (i, (axis, varied)) in axes.iter_mut().zip(variants.varied()).enumerate() {
        let name = &axis.name;
        if let Some(why) = variants.why_not(i) {
            return Err(Failure::Usage(format!("--axis {name}: {why}")));
        }
        if varied.key.is_some_and(is_of_runs) {
            let why = "is no number of the mechanism: every cell is run by the same settings";
            return Err(Failure::Usage(format!("--axis {name} {why}; give it by --set")));
        }
        axis.unit.clone_from(&varied.unit);
    }
    // All cells are looked at before the first is run: a value out of range is told at once.
    let mut subjects = Vec::new();
    for [x, y] in pairs(&axes) {
        if stop.load(Ordering::Relaxed) {
            return Err(Failure::Interrupted(RESUMED));
        }
        let config = variants.set(&[variants.number(0, x)?, variants.number(1, y)?]);
        let config = config.map_err(|error| not_a_cell(&axes, [x, y], &error))?;
        subjects.push(config.mechanism.subject(config));
    }
    let dir = args.run.to.dir("deltazero-out/map");
    let asked = json!({ "config": config.identity(), "axes": args.axis });
    let output = Output::open(&dir, hash("map", &asked), args.run.to.force)?;
    contests::remove_of_another(&dir, &output, RECORD)?;
    output.remove_of_another(RECORD, &["map.md", "map.csv"], &[WINNERS])?;
    if let Some(threads) = args.threads {
        config.regimes.threads = usize::from(threads);
    }
    note_left_out(&config, &config.contest.events, args.run.to.quiet);
    warn(&config.warnings(), args.run.to.quiet);

    let chunks = contests::chunks(&dir, &output, RECORD, subjects.len())?;
    let subject = |site: u64| subjects[site as usize].clone();
    let (order, told) = (contests::missing(&chunks)?, (args.run.to.quiet, stop));
    let contests = contests::run(&config, &chunks, &order, &subject, None, told)?;
    if stop.load(Ordering::Relaxed) {
        return Err(Failure::Interrupted(RESUMED));
    }
    write(&output, &config, &Map::of(axes, contests.into_iter().flatten()), args)?;
    Ok(chunks.clear()?)
}

/// The complaint about values that do not go together.
fn not_a_cell(axes: &[MapAxis; 2], at: [f64; 2], error: &ConfigError) -> Failure {
    let [x, y] = [0, 1].map(|i| format!("{} = {}", axes[i].name, in_short(at[i])));
    Failure::Usage(format!("cell {x}, {y}: {error}"))
}

/// Writes the files of a finished map, and prints it.
fn write(output: &Output, config: &Config, map: &Map, args: &RegimesArgs) -> Result<(), Failure> {
    let pictures = output.draw(&[winners(map)])?;
    output.write("map.csv", map_csv(map).as_bytes())?;
    output.write("map.md", map_markdown(map, &pictures).as_bytes())?;
    let record = json!({
        "hash": output.hash,
        "version": env!("CARGO_PKG_VERSION"),
        "config": config.to_json(),
        "axes": map.axes,
        "cells": map.cells,
    });
    output.write_json(RECORD, &record)?;
    print(&if args.run.to.json { format!("{record:#}\n") } else { map_table(map) })?;
    if !args.run.to.quiet {
        say(&format!("written to {}: map.md, map.csv, map.json, figures/", output.path()));
    }
    Ok(())
}

/// The configuration of which the numbers of the two axes vary.
fn variants(args: &RegimesArgs, axes: &[MapAxis; 2]) -> Result<Variants, Failure> {
    let from = &args.run.from;
    if axes.iter().any(|axis| axis.name == "mechanism") {
        let why = "is a word: give two numbers of the mechanism";
        return Err(Failure::Usage(format!("--axis mechanism {why}")));
    }
    let model = from.model.as_deref().map(Model::read).transpose()?;
    let paths = axes
        .each_ref()
        .map(|axis| (axis.name.as_str(), Place::Varied(format!("--axis {}", axis.name).into())));
    Ok(Variants::new(model, from.config.as_deref(), &from.set, &paths)?)
}

/// The two axes, each `NAME=v1,v2,…` or `NAME=a:b:n`: n values from a to b, each the same factor above the one before.
fn axes(given: &[String]) -> Result<[MapAxis; 2], Failure> {
    let axes: Vec<MapAxis> = given.iter().map(|text| axis(text)).collect::<Result<_, _>>()?;
    let found = axes.len();
    let axes: [MapAxis; 2] = axes.try_into().map_err(|_| {
        Failure::Usage(format!("--axis is given {found} times: a map has two axes"))
    })?;
    if axes[0].name == axes[1].name {
        let name = &axes[0].name;
        return Err(Failure::Usage(format!("--axis {name} is given twice: axes differ")));
    }
    Ok(axes)
}

fn axis(text: &str) -> Result<MapAxis, Failure> {
    let refuse = |why: &str| {
        let forms = "expected NAME=1e5,1e6,1e7 or NAME=1e5:1e10:6, which is logarithmic";
        Failure::Usage(format!("--axis {text}: {why}; {forms}"))
    };
    let (name, values) = text.split_once('=').ok_or_else(|| refuse("no ="))?;
    let number = |text: &str| {
        let x: f64 = text.trim().parse().ok()?;
        x.is_finite().then_some(x)
    };
    let mut values = match values.split(':').collect::<Vec<_>>()[..] {
        [list] => list.split(',').map(number).collect::<Option<Vec<f64>>>(),
        [from, to, n] => match (number(from), number(to), n.trim().parse::<usize>()) {
            (Some(from), Some(to), Ok(n)) if from > 0.0 && to > from && (2..=MOST).contains(&n) => {
                let points = n as u64;
                let values = Values::Log { ends: [from, to], points, whole: false };
                (0..points).map(|i| values.number(i)).collect()
            }
            (Some(_), Some(_), Ok(_)) => {
                return Err(refuse("a:b:n needs 0 < a < b and n from 2 to 1000"));
            }
            _ => None,
        },
        _ => None,
    }
    .ok_or_else(|| refuse("not numbers"))?;
    values.sort_by(f64::total_cmp);
    values.dedup();
    if values.len() > MOST {
        return Err(refuse("more than 1000 values"));
    }
    // A parameter of a model has a long name, too.
    let name = name.trim();
    Ok(MapAxis::new(name.strip_prefix("parameters.").unwrap_or(name), "", &values))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<f64> {
        axis(text).map(|axis| axis.values).unwrap_or_default()
    }

    #[test]
    fn an_axis_is_a_list_or_a_logarithmic_range() {
        assert_eq!(values("K=3, 1,2,2"), [1.0, 2.0, 3.0]);
        let log = values("K=1e5:1e8:4");
        assert_eq!(log.len(), 4);
        assert!(log.iter().zip([1e5, 1e6, 1e7, 1e8]).all(|(a, b)| (a / b - 1.0).abs() < 1e-12));
        for wrong in ["K", "K=", "K=a", "K=1:2", "K=0:1:3", "K=2:1:3", "K=1:2:1", "K=nan"] {
            assert!(axis(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_map_has_two_axes_that_differ() {
        let axes = |list: &[&str]| axes(&list.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>());
        assert!(axes(&["a=1", "b=2"]).is_ok());
        assert!(axes(&["a=1"]).is_err() && axes(&["a=1", "a=2"]).is_err());
        assert!(axes(&["a=1", "b=1", "c=1"]).is_err());
    }
}

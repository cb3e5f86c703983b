//! `deltazero recommend`.

use std::sync::atomic::{AtomicBool, Ordering};

use clap::Args;
use deltazero::report::recommend::{json, text};
use deltazero::study::plan::recommend;

use super::progress::Bar;
use super::{ConfigFrom, Failure, note_left_out, print};

/// Errors that can be asked for.
const ACCURACIES: std::ops::RangeInclusive<f64> = 1e-12..=1e-1;

#[derive(Args)]
pub(super) struct RecommendArgs {
    #[command(flatten)]
    from: ConfigFrom,
    /// Error e to be reached: pin error over clearance, angle error over the largest angle
    #[arg(long, value_name = "E", default_value = "1e-6", value_parser = accuracy)]
    accuracy: f64,
    /// No progress
    #[arg(long)]
    quiet: bool,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

fn accuracy(text: &str) -> Result<f64, String> {
    let (low, high) = (ACCURACIES.start(), ACCURACIES.end());
    match text.parse::<f64>() {
        Ok(e) if ACCURACIES.contains(&e) => Ok(e),
        _ => Err(format!("must be a number from {low:e} to {high:e}")),
    }
}

pub(super) fn run(args: &RecommendArgs, stop: &AtomicBool) -> Result<(), Failure> {
    let config = args.from.load()?;
    note_left_out(&config, &config.contest.events, args.quiet);
    let bar = Bar::new(args.quiet);
    let answer = recommend(&config, args.accuracy, stop, &|progress| bar.show(progress));
    drop(bar);
    if stop.load(Ordering::Relaxed) {
        return Err(Failure::Interrupted("a recommendation keeps nothing; give the command again"));
    }
    if args.json {
        print(&format!("{:#}\n", json(&answer)))?;
    } else {
        print(&text(&answer))?;
    }
    match answer.first() {
        Some(_) => Ok(()),
        None => Err(Failure::Run(format!("none for e = {:e}: {}", args.accuracy, answer.reason))),
    }
}

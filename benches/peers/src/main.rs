//! The impact transient of Table 1 by other tools, beside ours, with one metric.
//!
//! Every tool integrates the two joints from 0 to 2 s on one thread, one after the other or both at once,
//! and delivers 200 samples of each and its mode changes. One program, this one, judges all deliveries against the
//! golden run, and writes `peers.csv`, `peers.md` and the figure. See `README.md` beside `Cargo.toml`.
//!
//! ```text
//! deltazero-peers [--out FOLDER] [--native COMMAND]... [--plain COMMAND]... [--only WORD]
//!                 [--method NAME] [--hand-over FOLDER]
//! ```
//!
//! Two variables of the environment, in seconds on the processor: `PEERS_BUDGET` for the repeats of each
//! run (0.3), `PEERS_LONGEST` for the longest run, which ends its ladder (1).

mod entry;
mod figure;
mod hand;
mod machine;
mod measure;
mod naive;
mod problem;
mod row;
mod script;
mod table;
mod tools;

use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use measure::{Effort, measure};
use problem::Problem;
use row::{Build, Row};

/// What the command line asks for.
struct Asked {
    out: PathBuf,
    /// Commands of other tools.
    scripts: Vec<(Build, String)>,
    /// Only tools with this in their name.
    only: Option<String>,
    /// Only the method of this name.
    method: Option<String>,
    effort: Effort,
    /// Measure ours and the hand-written code alone, and hand them over in this folder.
    hand_over: Option<PathBuf>,
}

impl Asked {
    fn from_args(mut args: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let mut asked = Self {
            out: Path::new(env!("CARGO_MANIFEST_DIR")).join("results"),
            scripts: Vec::new(),
            only: None,
            method: None,
            effort: Effort {
                per_run: seconds("PEERS_BUDGET", 0.3)? / 3,
                rounds: 3,
                longest: seconds("PEERS_LONGEST", 1.0)?,
            },
            hand_over: None,
        };
        while let Some(key) = args.next() {
            let value = args.next().ok_or_else(|| format!("{key} needs a value"))?;
            match key.as_str() {
                "--out" => asked.out = value.into(),
                "--native" => asked.scripts.push((Build::Native, value)),
                "--plain" => asked.scripts.push((Build::Plain, value)),
                "--only" => asked.only = Some(value),
                "--method" => asked.method = Some(value),
                "--hand-over" => asked.hand_over = Some(value.into()),
                _ => return Err(format!("unknown: {key}").into()),
            }
        }
        Ok(asked)
    }
}

/// A variable of the environment in seconds.
fn seconds(name: &str, default: f64) -> Result<Duration, Box<dyn Error>> {
    let value = std::env::var(name).ok().map(|text| text.parse()).transpose()?;
    Ok(Duration::try_from_secs_f64(value.unwrap_or(default))?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let asked = Asked::from_args(std::env::args().skip(1))?;
    let problem = Problem::new()?;
    let mut entries = tools::own(&problem);
    if let Some(folder) = &asked.hand_over {
        let rows = measure(&problem, &entries, asked.effort);
        print!("{}", script::hand_over(&rows, &entries, folder)?);
        return Ok(());
    }
    entries.extend(tools::crates(&problem));
    if let Some(only) = &asked.only {
        entries.retain(|entry| entry.label.tool.contains(only.as_str()));
    }
    if let Some(method) = &asked.method {
        entries.retain(|entry| entry.label.method == *method);
    }
    eprintln!("{} runs in Rust, {} build", entries.len(), Build::own().name());
    let mut rows = measure(&problem, &entries, asked.effort);
    for (i, (build, command)) in asked.scripts.iter().enumerate() {
        eprintln!("{command}");
        let folder =
            std::env::temp_dir().join(format!("deltazero-peers-{}-{i}", std::process::id()));
        let found = script::rows(&problem, command, *build, asked.effort, &folder);
        std::fs::remove_dir_all(&folder)?;
        match found {
            Ok(Ok(found)) => rows.extend(found),
            Ok(Err(reason)) => eprintln!("skipped: {reason}"),
            Err(error) => eprintln!("skipped: {error}"),
        }
    }
    write(&asked.out, &rows)
}

/// Writes `peers.csv`, `peers.md`, `peers.png` and `peers.svg`.
fn write(out: &Path, rows: &[Row]) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(out)?;
    std::fs::write(out.join("peers.csv"), row::csv(rows))?;
    let figure = figure::figure(rows);
    std::fs::write(out.join("peers.png"), figure.png()?)?;
    std::fs::write(out.join("peers.svg"), figure.svg()?)?;
    let mut text = String::from("# Table 1 by other tools\n\n");
    write!(
        text,
        "The fastest run of each method at or below each error: time [ms] (right-hand sides of one joint; \
         contacts begun and ended, of 52, and slip reversals, of 8, as −missed +spurious where not right). \
         —: never reached.\n\n{}\n## Ours over others, at equal error\n\n{}\n## Measured on\n\n{}\n\
         ![time against error, the best of each tool](peers.png)\n",
        table::methods(rows),
        table::ratios(rows),
        machine::record()
    )?;
    std::fs::write(out.join("peers.md"), text)?;
    Ok(())
}

//! `deltazero sweep`.

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use clap::Args;
use deltazero::chunks::{Chunks, Work, work};
use deltazero::figures::sweep::may_be_named;
use deltazero::study::machine::Machine;
use deltazero::sweep::{Joined, Over, RECORD, ROWS, SHARDS, Sweep, SweepError, join};
use deltazero_study::digits::count_of;
use serde_json::{Value, json};

use super::meter::Meter;
use super::output::{FIGURES, Output, hash};
use super::report::PAGE;
use super::{Failure, RESUMED, ResultsTo, or_cores, print, say, warn};

/// All rows by column.
const BY_COLUMN: &str = "runs.parquet";
/// Times that chunks found altered are made again.
const REPAIRS: usize = 3;

#[derive(Args)]
pub(super) struct SweepArgs {
    /// Plan in TOML: axes and random draws of any keys of the configuration, or parameters of the model
    #[arg(value_name = "PLAN")]
    plan: PathBuf,
    /// A model of your own in TOML, in place of that of the plan; `deltazero model` has some to start from
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Set one key of the plan's configuration, or a parameter of the model, after its file (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    #[command(flatten)]
    to: ResultsTo,
    /// Runs at the same time; the default is one a core
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Make part I of N only, beside the others in the same DIR
    #[arg(long, value_name = "I/N", conflicts_with_all = ["merge", "force"])]
    shard: Option<Shard>,
    /// Make runs.csv of the parts, and no run
    #[arg(long, conflicts_with = "force")]
    merge: bool,
    /// Write runs.parquet too: the same rows by column, with types
    #[arg(long, conflicts_with = "shard")]
    parquet: bool,
    /// Exit 1 if a run failed
    #[arg(long)]
    strict: bool,
}

/// A part of a sweep: every chunk whose number leaves I − 1 when divided by N.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shard {
    i: u64,
    n: u64,
}

impl FromStr for Shard {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let numbers =
            text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((i, n)) if 1 <= i && i <= n => Ok(Self { i, n }),
            _ => Err("expected I/N with 1 ≤ I ≤ N, such as 3/7"),
        }
    }
}

impl Shard {
    fn has(self, chunk: u64) -> bool {
        chunk % self.n == self.i - 1
    }

    /// As its files are named.
    fn name(self) -> String {
        format!("{}-of-{}", self.i, self.n)
    }

    /// The shard of a file's name.
    fn named(name: &str) -> Option<Self> {
        let (i, n) = name.strip_suffix(".json")?.split_once("-of-")?;
        format!("{i}/{n}").parse().ok()
    }
}

impl From<SweepError> for Failure {
    fn from(error: SweepError) -> Self {
        match error {
            SweepError::File(_) | SweepError::Row { .. } | SweepError::Altered { .. } => {
                Self::Run(error.to_string())
            }
            _ => Self::Usage(error.to_string()),
        }
    }
}

/// A sweep with the place of its results.
struct Command<'a> {
    args: &'a SweepArgs,
    sweep: Sweep,
    dir: PathBuf,
    output: Output,
    chunks: Chunks,
    stop: &'a AtomicBool,
    /// Time that earlier commands spent on it [s].
    wall_before: f64,
    start: Instant,
}

pub(super) fn run(args: &SweepArgs, stop: &AtomicBool) -> Result<(), Failure> {
    let dir = args.to.dir("deltazero-out/sweep");
    let begun = begun(&dir);
    let model = begun.as_ref().filter(|_| !args.to.force).and_then(model_of);
    let over = Over { model: args.model.as_deref(), sets: &args.set, begun: model };
    let sweep = Sweep::read(&args.plan, &over)?;
    let identity = sweep.identity();
    let hash = hash("sweep", &identity);
    if let Some(begun) = begun.filter(|begun| !args.to.force && begun["hash"] != hash) {
        return Err(another(&dir, &begun, &identity));
    }
    warn(&sweep.config().warnings(), args.to.quiet);
    let output = match args.shard {
        Some(shard) => Output::open_part(&dir, hash, &shard.name())?,
        None => Output::open(&dir, hash, args.to.force)?,
    };
    let chunks = Chunks::new(&dir, &output.hash, sweep.n_runs, sweep.plan.chunk);
    let known = output.own(RECORD).filter(|_| !args.to.force);
    if args.shard.is_none() && known.is_none() && output.bytes(RECORD).is_some() {
        chunks.clear()?;
        let hash = output.read(RECORD).and_then(|of| Some(of["hash"].as_str()?.to_owned()));
        hash.map_or(Ok(()), |hash| Chunks::new(&dir, &hash, 0, 1).clear())?;
        output.remove(old_files(&dir, &output))?;
    }
    let wall_before = known.as_ref().and_then(|known| known["wall_s"].as_f64()).unwrap_or(0.0);
    let start = Instant::now();
    let command = Command { args, sweep, dir, output, chunks, stop, wall_before, start };
    match known {
        Some(known) if command.is_finished(&known) => {
            command.chunks.clear()?;
            return command.tell(&known);
        }
        Some(_) => {}
        None => command.output.write_json(RECORD, &command.record(None))?,
    }
    match args.shard {
        Some(shard) => command.shard(shard),
        None if args.merge => command.merge(),
        None => command.whole(),
    }
}

/// The record of the sweep that a directory holds, if it holds one.
fn begun(dir: &Path) -> Option<Value> {
    serde_json::from_slice(&std::fs::read(dir.join(RECORD)).ok()?).ok()
}

/// What a sweep that is begun anew, and its reports and plots, left beside its record.
fn old_files(dir: &Path, output: &Output) -> Vec<String> {
    let record = output.read(RECORD).unwrap_or_default();
    let columns: Vec<&str> =
        record["columns"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let in_folder = |folder: &str, is_own: &dyn Fn(&str) -> bool| -> Vec<String> {
        let entries = std::fs::read_dir(dir.join(folder)).into_iter().flatten().flatten();
        let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
        names.filter(|name| is_own(name)).map(|name| format!("{folder}/{name}")).collect()
    };
    let is_figure = |name: &str| {
        let stem = name.strip_suffix(".svg").or_else(|| name.strip_suffix(".png"));
        stem.is_some_and(|stem| may_be_named(stem, &columns))
    };
    let mut files = [ROWS, BY_COLUMN, PAGE].map(str::to_owned).to_vec();
    files.extend(in_folder(SHARDS, &|name| Shard::named(name).is_some()));
    files.extend(in_folder(FIGURES, &is_figure));
    files
}

/// Name and text of the model of a sweep, if it has one.
fn model_of(record: &Value) -> Option<(String, String)> {
    let word = |name| record["config"]["model"][name].as_str().map(str::to_owned);
    Some((word("name")?, word("text")?))
}

/// Says what is different in the sweep that a directory holds.
fn another(dir: &Path, begun: &Value, identity: &Value) -> Failure {
    let part = |of: &Value, part: &str| match part {
        "model" => of["config"]["model"].clone(),
        "configuration" => {
            let mut config = of["config"].clone();
            config.as_object_mut().map(|config| config.remove("model"));
            config
        }
        other => of[other].clone(),
    };
    let is_other = |name: &&str| part(begun, name) != part(identity, name);
    let parts = ["plan", "model", "configuration", "version", "build"].into_iter();
    let mut different = parts.filter(is_other).collect::<Vec<_>>().join(" and ");
    if is_other(&"build") {
        different +=
            " (one has fused multiply-add, the other has not; build both with the same RUSTFLAGS)";
    }
    Failure::Usage(format!(
        "{}: holds a sweep of another {different}; name another directory with --out, or begin anew with --force",
        dir.display()
    ))
}

impl Command<'_> {
    /// Every run that is missing, then `runs.csv`.
    fn whole(&self) -> Result<(), Failure> {
        let missing: Vec<u64> =
            (0..self.chunks.n()).filter(|chunk| !self.chunks.is_there(*chunk)).collect();
        self.make(&missing, self.sweep.n_runs)?;
        for _ in 0..REPAIRS {
            let joined = self.join()?;
            if joined.altered.is_empty() {
                return self.finish(&joined);
            }
            self.say(&format!(
                "not as they were written, and made again: {}",
                count_of(joined.altered.len(), "chunk")
            ));
            joined.altered.iter().for_each(|chunk| self.chunks.remove(*chunk));
            self.make(&joined.altered, self.sweep.n_runs)?;
        }
        let joined = self.join()?;
        if joined.altered.is_empty() {
            return self.finish(&joined);
        }
        let path = self.chunks.dir().to_owned();
        Err(SweepError::Altered { path, n: joined.altered.len() }.into())
    }

    /// The runs of a part that are missing.
    fn shard(&self, shard: Shard) -> Result<(), Failure> {
        let own: Vec<u64> = (0..self.chunks.n()).filter(|chunk| shard.has(*chunk)).collect();
        let n_runs =
            own.iter().map(|chunk| self.chunks.runs(*chunk)).map(|runs| runs.end - runs.start);
        let n_runs: u64 = n_runs.sum();
        let missing: Vec<u64> =
            own.iter().copied().filter(|chunk| !self.chunks.is_there(*chunk)).collect();
        let name = format!("{SHARDS}/{}.json", shard.name());
        let before = self.output.own(&name).and_then(|own| own["wall_s"].as_f64()).unwrap_or(0.0);
        let record = |finished: bool, failed: u64| {
            json!({
                "shard": shard.i, "of": shard.n, "hash": self.output.hash, "finished": finished,
                "runs": n_runs, "failed": failed,
                "wall_s": before + self.start.elapsed().as_secs_f64(),
                "machine": Machine::here(),
            })
        };
        self.output.write_json(&name, &record(false, 0))?;
        if let Err(failure) = self.make(&missing, n_runs) {
            self.output.write_json(&name, &record(false, 0))?;
            return Err(failure);
        }
        let failed = own.iter().filter_map(|chunk| self.chunks.failed(*chunk)).sum();
        self.output.write_json(&name, &record(true, failed))?;
        if self.args.to.json {
            print(&format!("{:#}\n", record(true, failed)))?;
        } else {
            let ok = n_runs - failed;
            let runs = count_of(n_runs, "run");
            print(&format!(
                "shard {} of {}: {runs}, {ok} ok, {failed} failed\n",
                shard.i, shard.n
            ))?;
        }
        self.say("when all shards are there, the same command with --merge instead of --shard makes runs.csv");
        self.strict(failed)
    }

    /// `runs.csv` of chunks that are there.
    fn merge(&self) -> Result<(), Failure> {
        let missing: Vec<u64> =
            (0..self.chunks.n()).filter(|chunk| !self.chunks.is_there(*chunk)).collect();
        if !missing.is_empty() {
            return Err(self.refuse(&missing, "missing"));
        }
        let joined = self.join()?;
        if !joined.altered.is_empty() {
            joined.altered.iter().for_each(|chunk| self.chunks.remove(*chunk));
            return Err(self.refuse(&joined.altered, "not as they were written, and removed"));
        }
        self.finish(&joined)
    }

    /// The complaint about chunks that cannot be merged, by the shards that make them.
    fn refuse(&self, chunks: &[u64], what: &str) -> Failure {
        let dir = self.dir.join(SHARDS);
        let names = std::fs::read_dir(dir).into_iter().flatten().flatten();
        let names = names.map(|entry| entry.file_name().to_string_lossy().into_owned());
        let mut of: Vec<u64> =
            names.filter_map(|name| Shard::named(&name)).map(|shard| shard.n).collect();
        of.sort_unstable();
        of.dedup();
        let which = match of[..] {
            [n] => {
                let mut shards: Vec<u64> = chunks.iter().map(|chunk| chunk % n + 1).collect();
                shards.sort_unstable();
                shards.dedup();
                let shards: Vec<String> =
                    shards.iter().map(|i| format!("--shard {i}/{n}")).collect();
                format!("run the same plan with {}", shards.join(", "))
            }
            _ => "the same command without --merge makes them".to_owned(),
        };
        let runs = chunks.iter().take(3).map(|chunk| {
            let runs = self.chunks.runs(*chunk);
            format!("{} to {}", runs.start, runs.end - 1)
        });
        let more = if chunks.len() > 3 { ", …" } else { "" };
        Failure::Usage(format!(
            "{}: {} of {} chunks are {what} (runs {}{more}); {which}",
            self.dir.display(),
            chunks.len(),
            self.chunks.n(),
            runs.collect::<Vec<_>>().join(", "),
        ))
    }

    /// Makes chunks, of `n_runs` in all with those that are there.
    fn make(&self, numbers: &[u64], n_runs: u64) -> Result<(), Failure> {
        let left = numbers.iter().map(|chunk| self.chunks.runs(*chunk));
        let left: u64 = left.map(|runs| runs.end - runs.start).sum();
        let (chunks, stop, threads) = (&self.chunks, self.stop, or_cores(self.args.threads));
        let meter = Meter::new("run", (n_runs - left, n_runs), &|| None, self.args.to.quiet);
        let made = |made| meter.count(made);
        work(&Work { chunks, threads, stop, made: &made }, numbers, || self.sweep.runner())
            .map_err(SweepError::from)?;
        meter.end(threads);
        if stop.load(Ordering::Relaxed) {
            if self.args.shard.is_none() {
                self.output.write_json(RECORD, &self.record(None))?;
            }
            return Err(Failure::Interrupted(RESUMED));
        }
        Ok(())
    }

    fn join(&self) -> Result<Joined, SweepError> {
        let n_keys = self.sweep.plan.keys().len();
        Ok(join(&self.chunks, &self.sweep.header(), n_keys, &self.dir.join(ROWS))?)
    }

    /// Records that all rows are in `runs.csv`, and removes the chunks.
    fn finish(&self, joined: &Joined) -> Result<(), Failure> {
        let record = self.record(Some(joined));
        self.output.write_json(RECORD, &record)?;
        self.chunks.clear()?;
        self.tell(&record)
    }

    fn tell(&self, record: &Value) -> Result<(), Failure> {
        if self.args.parquet {
            self.sweep.write_parquet(&self.dir.join(ROWS), &self.dir.join(BY_COLUMN))?;
        }
        let failed = record["failed"].as_u64().unwrap_or(0);
        if self.args.to.json {
            print(&format!("{record:#}\n"))?;
        } else {
            let n = self.sweep.n_runs;
            let (runs, ok) = (count_of(n, "run"), n - failed.min(n));
            let mut text = format!("{runs}: {ok} ok, {failed} failed\n");
            for first in record["first_failed"].as_array().into_iter().flatten() {
                let error = first["error"].as_str().unwrap_or_default();
                text += &format!("  run {}: {error}\n", first["run"]);
            }
            print(&text)?;
        }
        let also = if self.args.parquet { format!("{BY_COLUMN}, ") } else { String::new() };
        self.say(&format!("written to {}: {ROWS}, {also}{RECORD}", self.output.path()));
        self.strict(failed)
    }

    fn strict(&self, failed: u64) -> Result<(), Failure> {
        if self.args.strict && failed > 0 {
            return Err(Failure::Run(format!(
                "{} failed; {ROWS} says why, in `status`",
                count_of(failed, "run")
            )));
        }
        Ok(())
    }

    /// Whether a record is of rows that are all there.
    fn is_finished(&self, record: &Value) -> bool {
        let length = std::fs::metadata(self.dir.join(ROWS)).map(|metadata| metadata.len()).ok();
        record["finished"] == true && length.is_some() && record["bytes"].as_u64() == length
    }

    fn record(&self, joined: Option<&Joined>) -> Value {
        let mut record = self.sweep.identity();
        record["hash"] = self.output.hash.clone().into();
        record["machine"] = json!(Machine::here());
        record["runs"] = self.sweep.n_runs.into();
        record["columns"] = self.sweep.columns().into();
        record["units"] = self.sweep.units().into();
        record["kinds"] = self.sweep.kinds().into();
        record["wall_s"] = (self.wall_before + self.start.elapsed().as_secs_f64()).into();
        record["finished"] = joined.is_some().into();
        if let Some(joined) = joined {
            record["ok"] = (self.sweep.n_runs - joined.failed).into();
            record["failed"] = joined.failed.into();
            record["first_failed"] = json!(joined.first_failed);
            record["bytes"] = joined.bytes.into();
        }
        record
    }

    fn say(&self, text: &str) {
        if !self.args.to.quiet {
            say(text);
        }
    }
}

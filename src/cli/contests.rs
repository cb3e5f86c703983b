//! The contests of a map, each site's kept as soon as they are done: a map over its own grid, and one over `--axis`.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use deltazero::chunks::{Chunks, Work, work};
use deltazero::config::Config;
use deltazero::study::contests::{Contests, kept};
use deltazero::study::machine::Machine;
use deltazero::study::regimes::map_plan;
use deltazero_study::Subject;
use deltazero_study::forecast::Forecast;
use deltazero_study::map::Contested;
use deltazero_study::reference::RECIPE;
use serde_json::json;

use super::meter::Meter;
use super::output::{Output, hash};
use super::{Failure, RESUMED};

/// Where the contests of a map of so many sites are kept in `dir`, which is that map's from now on: of this version, machine
/// and build, others may find others.
pub(super) fn chunks(
    dir: &Path,
    output: &Output,
    record: &str,
    n_sites: usize,
) -> Result<Chunks, Failure> {
    if output.own(record).is_none() {
        output.write_json(record, &json!({ "hash": output.hash }))?;
    }
    Ok(Chunks::new(dir, &hash_of(&output.hash), n_sites as u64, 1))
}

/// Removes the contests that were kept of a map of another configuration, the one in `record`.
pub(super) fn remove_of_another(dir: &Path, output: &Output, record: &str) -> Result<(), Failure> {
    let record = output.read(record).unwrap_or_default();
    match record["hash"].as_str() {
        Some(map) if *map != output.hash => Ok(Chunks::new(dir, &hash_of(map), 0, 1).clear()?),
        _ => Ok(()),
    }
}

/// The hash of the contests of a map that has the hash `map`: of this machine and build, because their times are compared.
fn hash_of(map: &str) -> String {
    let version = env!("CARGO_PKG_VERSION");
    hash("contests", &json!([map, version, RECIPE, Machine::here().identity()]))
}

/// The numbers of the sites whose contests are not there.
pub(super) fn missing(chunks: &Chunks) -> Result<Vec<u64>, Failure> {
    let kept = (0..).zip(kept(chunks)?);
    Ok(kept.filter(|(_, kept)| kept.is_none()).map(|(site, _)| site).collect())
}

/// Runs the contests of the sites of these numbers, in this order, of which a `forecast` tells what is left. Returns those of
/// every site, or of as many as are done once `stop` is set.
pub(super) fn run(
    config: &Config,
    chunks: &Chunks,
    order: &[u64],
    subject: &(dyn Fn(u64) -> Subject + Sync),
    forecast: Option<Forecast>,
    (quiet, stop): (bool, &AtomicBool),
) -> Result<Vec<Option<Vec<Contested>>>, Failure> {
    let forecast = forecast.map(Mutex::new);
    let forecast = || forecast.as_ref()?.lock().ok();
    let done = |site, took| {
        let place = order.iter().position(|own| *own == site);
        if let (Some(mut forecast), Some(place)) = (forecast(), place) {
            forecast.done(place, took);
        }
    };
    let left = || Some(forecast()?.left());
    let known = chunks.n_runs - order.len() as u64;
    let meter = Meter::new("site", (known, chunks.n_runs), &left, quiet);
    let (plan, threads) = (map_plan(config), config.regimes.threads);
    let contests = || Contests { subject, plan: &plan, stop, done: &done };
    let made = |made| meter.count(made);
    work(&Work { chunks, threads, stop, made: &made }, order, contests)
        .map_err(|error| Failure::Run(format!("{error}; {RESUMED}")))?;
    meter.end(threads);
    let kept = kept(chunks)?;
    if !stop.load(Ordering::Relaxed) && kept.iter().any(Option::is_none) {
        let why = "a chunk is not as it was written; the same command makes it again";
        return Err(Failure::Run(format!("{}: {why}", chunks.dir().display())));
    }
    Ok(kept)
}

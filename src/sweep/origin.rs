//! What a finished sweep was made of, and by: what `sweep.json` and the records of its shards tell beside the plan.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::results::{Results, ResultsError};
use super::{FOLLOWING, RECORD, SHARDS};
use crate::config::Config;
use crate::study::machine::Machine;
use crate::study::record::Provenance;

/// What a finished sweep was made of, and by.
pub struct Origin {
    /// The configuration that was varied.
    pub config: Config,
    /// Keys of it that were not given, and follow `run.t_end` in each run.
    pub following: Vec<String>,
    /// Version of the program, and the machine that made the sweep or joined it.
    pub provenance: Provenance,
    /// Time that its commands took by the clock, one after the other, those of shards included [s].
    pub wall_s: f64,
    /// Shards that made it, beside the command that joined them.
    pub shards: u64,
}

impl Origin {
    /// That of the sweep in `dir`, which has these results.
    ///
    /// # Errors
    /// A record whose configuration this version does not know.
    pub fn of(results: &Results, dir: &Path) -> Result<Self, ResultsError> {
        let record = &results.record;
        let config = Config::from_json(&record["config"])
            .map_err(|_| ResultsError::Record { path: dir.join(RECORD) })?;
        let seconds = |record: &Value| record["wall_s"].as_f64().unwrap_or_default();
        let own = |shard: &Value| shard["hash"] == record["hash"] && shard["finished"] == true;
        let shards: Vec<f64> = shards(dir).iter().filter(|shard| own(shard)).map(seconds).collect();
        let machine: Option<Machine> = serde_json::from_value(record["machine"].clone()).ok();
        let version = record["version"].as_str().unwrap_or_default().to_owned();
        let following = record[FOLLOWING].as_array().into_iter().flatten();
        Ok(Self {
            config,
            following: following.filter_map(|key| Some(key.as_str()?.to_owned())).collect(),
            provenance: Provenance { version, machine, time: None },
            wall_s: seconds(record) + shards.iter().sum::<f64>(),
            shards: shards.len() as u64,
        })
    }
}

/// The records of the shards that a directory has, in the order of their names.
fn shards(dir: &Path) -> Vec<Value> {
    let entries = fs::read_dir(dir.join(SHARDS)).into_iter().flatten().flatten();
    let mut paths: Vec<_> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    let read = |path| serde_json::from_slice(&fs::read(path).ok()?).ok();
    paths.iter().filter_map(read).collect()
}

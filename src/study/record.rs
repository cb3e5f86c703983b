//! A study as it is kept: all that its report is made from.

use deltazero_study::work_precision::WorkPrecision;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::machine::Machine;
use crate::config::Config;

/// Where and when a study was measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Provenance {
    /// Version of the program.
    pub version: String,
    /// The machine, where it is known.
    pub machine: Option<Machine>,
    /// When, where it is known.
    pub time: Option<String>,
}

/// `study.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StudyRecord {
    /// Hash of command and configuration.
    pub hash: String,
    /// Version of the program that measured.
    pub version: String,
    /// [`RECIPE`](deltazero_study::reference::RECIPE) that it was made by; zero where an earlier version did not say.
    #[serde(default)]
    pub recipe: u32,
    /// What it was measured on; none where an earlier version did not say.
    #[serde(default)]
    pub machine: Option<Machine>,
    /// When the last run was done, RFC 3339, UTC; none where an earlier version did not say.
    #[serde(default)]
    pub time: Option<String>,
    /// What was asked.
    pub config: Config,
    /// Whether figures and report are on disk too.
    pub finished: bool,
    /// The reference and the rows.
    #[serde(flatten)]
    pub table: WorkPrecision,
}

impl StudyRecord {
    /// As `study.json` has it: each row names its reading.
    pub fn to_json(&self) -> Value {
        let mut json = json!(self);
        name_reading(&mut json, &self.config);
        json
    }

    /// Where and when it was measured.
    pub fn provenance(&self) -> Provenance {
        let Self { version, machine, time, .. } = self.clone();
        Provenance { version, machine, time }
    }
}

/// Puts the reading into each of the `rows` of a table.
pub fn name_reading(table: &mut Value, config: &Config) {
    let rows = table.get_mut("rows").and_then(Value::as_array_mut);
    for row in rows.into_iter().flatten() {
        row["reading"] = config.reading.name().into();
    }
}

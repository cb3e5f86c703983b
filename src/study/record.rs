//! A study as it is kept: all that its report is made from.

use serde::{Deserialize, Serialize};

use super::machine::Machine;
use super::work_precision::WorkPrecision;
use crate::config::Config;

/// `study.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StudyRecord {
    /// Hash of command and configuration.
    pub hash: String,
    /// Version of the program that measured.
    pub version: String,
    /// [`RECIPE`](crate::reference::RECIPE) that it was made by; zero where an earlier version did not say.
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

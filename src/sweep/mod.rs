//! Sweeps: the runs of a plan, over threads and shards, kept on disk as they are made.
//!
//! ```text
//! plan → run number → values of the keys → configuration → run in brief → row → chunk → runs.csv
//! ```
//!
//! | module | what it is |
//! |---|---|
//! | `read`, `keys`, `table` | a plan's file, every complaint with its place |
//! | [`plan`], [`draw`], [`saltelli`] | the values of a run, from its number alone |
//! | `columns`, `layout` | what a run tells, and which columns the runs of a plan have |
//! | `runner`, `course` | some runs together: their rows, and the runs with parts of a kind at once |
//! | [`chunks`], [`whole`] | rows on disk, with their checksums |
//! | `work`, `join` | chunks over threads; `runs.csv` of all of them |
//! | `parquet_file` | the same rows by column, with types |
//! | [`results`] | the columns of a finished sweep, as they are asked for |
//! | [`sensitivity`], [`sobol`] | Sobol indices from samples, and of a column at each grid point |

pub mod chunks;
mod columns;
mod course;
mod csv;
pub mod draw;
mod error;
mod join;
mod keys;
mod layout;
mod normal;
mod parquet_file;
pub mod plan;
mod read;
pub mod results;
mod results_error;
mod runner;
pub mod saltelli;
pub mod sensitivity;
pub mod sobol;
mod table;
#[cfg(test)]
mod tests;
pub mod whole;
mod work;

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use deltazero_solvers::lanes::FUSED;
use serde_json::{Value, json};

use crate::config::{Config, Kind, MODEL_TABLES, Variants, Varied};
use crate::report::field;

pub use error::SweepError;
pub use join::{Failed, Joined, join};
pub use read::Over;
pub use runner::Runner;
pub use work::{Made, Work, work};

use columns::CellKind;
use layout::Layout;
use plan::Plan;

/// Most chunks of a sweep, each a file.
pub const MOST_CHUNKS: u64 = 1_000_000;

/// A sweep: a plan and the configuration that it varies, all values checked.
pub struct Sweep {
    /// What is run.
    pub plan: Plan,
    /// How many runs that are.
    pub n_runs: u64,
    variants: Variants,
    layout: Layout,
}

impl Sweep {
    /// Reads the plan in `path`, with what stands over it.
    ///
    /// # Errors
    /// The first complaint: about the plan, its configuration, a value that a key is to take, or if of no combination of
    /// words and whole numbers a run can be made.
    pub fn read(path: &Path, over: &Over<'_>) -> Result<Self, SweepError> {
        let read::Read { plan, variants, n_runs } = read::plan(path, over)?;
        let file = path.display().to_string();
        let layout = Layout::new(&file, &plan, &mut variants.clone())?;
        Ok(Self { plan, n_runs, variants, layout })
    }

    /// The configuration that is varied.
    pub fn config(&self) -> &Config {
        self.variants.config()
    }

    /// What its rows follow from: the plan, the configuration, the version of the program, and its build where that has
    /// fused multiply-add.
    pub fn identity(&self) -> Value {
        let mut config = self.config().clone();
        config.study.threads = 1;
        config.regimes.threads = 1;
        let mut identity = json!({
            "plan": self.plan,
            "config": config.to_json(),
            "version": env!("CARGO_PKG_VERSION"),
        });
        if FUSED {
            identity["build"] = "fused multiply-add".into();
        }
        identity
    }

    /// The names of the columns. A parameter of a model with the name of another column has its long name.
    pub fn columns(&self) -> Vec<String> {
        let is_taken = |key: &str| {
            ["run", "status"].contains(&key)
                || self.layout.heads.iter().any(|head| head.name == key)
        };
        let own = |key: &str| {
            let long = if is_taken(key) { format!("{}.", MODEL_TABLES[1]) } else { String::new() };
            long + key
        };
        let keys = self.plan.keys().into_iter().map(own);
        let names = ["run".to_owned()].into_iter().chain(keys).chain(["status".to_owned()]);
        names.chain(self.layout.heads.iter().map(|head| head.name.clone())).collect()
    }

    /// The units of the columns, empty for none.
    pub fn units(&self) -> Vec<String> {
        let keys = self.variants.varied().iter().map(|varied| varied.unit.clone());
        let units = [String::new()].into_iter().chain(keys).chain([String::new()]);
        units.chain(self.layout.heads.iter().map(|head| head.unit.clone())).collect()
    }

    /// What the columns have.
    fn kinds(&self) -> Vec<CellKind> {
        let of_key = |varied: &Varied| match varied.kind {
            Kind::Number(_) => CellKind::Number,
            Kind::Integer(..) => CellKind::Count,
            _ => CellKind::Text,
        };
        let keys = self.variants.varied().iter().map(of_key);
        let kinds = [CellKind::Count].into_iter().chain(keys).chain([CellKind::Text]);
        kinds.chain(self.layout.heads.iter().map(|head| head.kind)).collect()
    }

    /// Writes the rows of `csv`, which is `runs.csv`, to the Parquet file `path`.
    ///
    /// # Errors
    /// Those of the file system, and a row that is not one of this sweep.
    pub fn write_parquet(&self, csv: &Path, path: &Path) -> Result<(), SweepError> {
        let mut metadata = self.identity();
        metadata["units"] = self.columns().into_iter().zip(self.units()).collect();
        let read = |source| SweepError::File { path: csv.to_owned(), doing: "read", source };
        let rows = BufReader::new(File::open(csv).map_err(read)?);
        let written = parquet_file::write(rows, &self.kinds(), metadata.to_string(), path);
        written.map_err(|source| SweepError::File { path: path.to_owned(), doing: "write", source })
    }

    /// The first line of `runs.csv`.
    pub fn header(&self) -> String {
        let names: Vec<String> = self.columns().iter().map(|name| field(name)).collect();
        names.join(",") + "\n"
    }

    /// What makes its runs, on one thread.
    pub fn runner(&self) -> Runner<'_> {
        Runner::new(self)
    }
}

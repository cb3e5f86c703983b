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
//! | `runner`, `course` | some runs together, [as chunks are made](crate::chunks): their rows, and the runs with parts of a kind at once |
//! | `join` | `runs.csv` of all [chunks](crate::chunks) |
//! | `parquet_file` | the same rows by column, with types |
//! | [`results`] | the columns of a finished sweep, as they are asked for |
//! | `reasons`, [`ranks`], [`summary`] | why runs failed; rank correlation; what the runs say and what it follows |
//! | `default_columns` | which of them a report is of |
//! | [`origin`], [`plan_toml`] | what a finished sweep was made of; its plan as a file again |
//! | [`sensitivity`], [`sobol`] | Sobol indices from samples, and of a column at each grid point |

mod columns;
mod course;
mod default_columns;
pub mod draw;
mod error;
mod join;
mod keys;
mod layout;
mod normal;
pub mod origin;
mod parquet_file;
pub mod plan;
pub mod plan_toml;
pub mod ranks;
mod read;
mod reasons;
pub mod results;
mod results_error;
mod runner;
pub mod saltelli;
pub mod sensitivity;
pub mod sobol;
pub mod summary;
mod table;
#[cfg(test)]
mod tests;

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use deltazero_solvers::lanes::FUSED;
use deltazero_study::reference::RECIPE;
use serde_json::{Value, json};

use crate::atomic_file::FileError;
use crate::config::{Config, Variants};
use crate::csv::field;

pub use default_columns::default_columns;
pub use error::SweepError;
pub use join::{Failed, Joined, join};
pub use read::Over;
pub use runner::Runner;

use columns::{Head, heads_of_rows};
use layout::Layout;
use parquet_file::Refused;
use plan::Plan;

/// The key of a record for what follows `run.t_end`.
const FOLLOWING: &str = "follow_t_end";
/// The record of a sweep in its directory.
pub const RECORD: &str = "sweep.json";
/// All rows.
pub const ROWS: &str = "runs.csv";
/// Where each shard has its record.
pub const SHARDS: &str = "shards";

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
    /// The heads of all columns.
    heads: Vec<Head>,
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
        let heads = heads_of_rows(&plan, variants.varied(), &layout.heads);
        Ok(Self { plan, n_runs, variants, layout, heads })
    }

    /// The configuration that is varied.
    pub fn config(&self) -> &Config {
        self.variants.config()
    }

    /// What its rows follow from: the plan, the configuration, which of its keys follow `run.t_end`, the version of the program and its [`RECIPE`], and its build
    /// where that has fused multiply-add.
    pub fn identity(&self) -> Value {
        let mut identity = json!({
            "plan": self.plan,
            "config": self.config().identity(),
            "version": env!("CARGO_PKG_VERSION"),
            "recipe": RECIPE,
        });
        let following = self.variants.following();
        if !following.is_empty() {
            identity[FOLLOWING] = following.into();
        }
        if FUSED {
            identity["build"] = "fused multiply-add".into();
        }
        identity
    }

    /// The names of the columns. A parameter of a model with the name of another column has its long name.
    pub fn columns(&self) -> Vec<String> {
        self.heads.iter().map(|head| head.name.clone()).collect()
    }

    /// The units of the columns, empty for none.
    pub fn units(&self) -> Vec<String> {
        self.heads.iter().map(|head| head.unit.clone()).collect()
    }

    /// What the cells of each column are: number, whole number, true or false, word.
    pub fn kinds(&self) -> Vec<String> {
        self.heads.iter().map(|head| head.kind.to_string()).collect()
    }

    /// Writes the rows of `csv`, which is `runs.csv`, to the Parquet file `path`.
    ///
    /// # Errors
    /// Those of the file system, and a row that is not one of this sweep.
    pub fn write_parquet(&self, csv: &Path, path: &Path) -> Result<(), SweepError> {
        let mut metadata = self.identity();
        metadata["units"] = self.columns().into_iter().zip(self.units()).collect();
        let rows = BufReader::new(File::open(csv).map_err(FileError::of(csv, "read"))?);
        parquet_file::write(rows, &self.heads, metadata.to_string(), path).map_err(|refused| {
            match refused {
                Refused::File(error) => SweepError::File(error),
                Refused::Unread(error) => SweepError::File(FileError::of(csv, "read")(error)),
                row => SweepError::Row { path: csv.to_owned(), what: row.to_string() },
            }
        })
    }

    /// The first line of `runs.csv`.
    pub fn header(&self) -> String {
        let names: Vec<String> = self.heads.iter().map(|head| field(&head.name)).collect();
        names.join(",") + "\n"
    }

    /// What makes its runs, on one thread.
    pub fn runner(&self) -> Runner<'_> {
        Runner::new(self)
    }
}

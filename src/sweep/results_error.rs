//! What can keep the results of a sweep from being read, in words that lead out.

use std::io;
use std::path::PathBuf;

/// Why a finished sweep cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ResultsError {
    /// A file that is not there.
    #[error("cannot read {}: {source}; name the DIR of a sweep", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// No record of a sweep, or one of another version.
    #[error("{}: not the record of a sweep of this version", path.display())]
    Record {
        /// The file.
        path: PathBuf,
    },
    /// Rows are missing.
    #[error("{}: the sweep is not finished; `deltazero sweep` with its plan goes on", dir.display())]
    Unfinished {
        /// Where it is.
        dir: PathBuf,
    },
    /// A file that was cut.
    #[error("{}: not as long as it was written; make the sweep again with --force", path.display())]
    Length {
        /// The file.
        path: PathBuf,
    },
    /// No such column.
    #[error(
        "{} has no column \"{name}\"{}; it has {known}", path.display(),
        nearest.as_ref().map_or_else(String::new, |near| format!(", did you mean \"{near}\"?"))
    )]
    Column {
        /// The file.
        path: PathBuf,
        /// What was asked for.
        name: String,
        /// The most similar one, if one is similar.
        nearest: Option<String>,
        /// All.
        known: String,
    },
    /// A key where a result is asked for.
    #[error("{name} is a key that the plan sets; give a column that runs tell: {known}")]
    Key {
        /// The column.
        name: String,
        /// Those that are results.
        known: String,
    },
    /// A row that does not have a field for each column.
    #[error("{}:{line}: not as it was written; make the sweep again with --force", path.display())]
    Row {
        /// The file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: u64,
    },
    /// Rows in another order than they were written in.
    #[error(
        "{}:{line}: run {wanted} is wanted here; the rows stand by their numbers: put them in that order, or make the sweep again \
         with --force", path.display()
    )]
    Order {
        /// The file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: u64,
        /// Number of the run that belongs there.
        wanted: u64,
    },
    /// A column of words that has too many.
    #[error("column \"{name}\" has more than {most} different words")]
    Words {
        /// The column.
        name: String,
        /// How many it may have.
        most: usize,
    },
    /// Words where there must be numbers.
    #[error("column {column} holds words, not numbers; give it as --x or --color")]
    NotNumbers {
        /// The column.
        column: String,
    },
    /// Sobol indices of a sweep that was not made for them.
    #[error(
        "Sobol indices need a design of their own: give the plan [random] with sampling = \"saltelli\", which makes samples × (keys + 2) runs, and sweep it into another DIR"
    )]
    NoDesign,
    /// Sobol indices of what is the same in all runs.
    #[error(
        "{column} has no Sobol indices: it does not vary, or fewer than {least} samples have it in all their runs (runs that did not come to their end: {failed})"
    )]
    NoIndices {
        /// The column.
        column: String,
        /// Fewest samples.
        least: usize,
        /// Runs that are left out.
        failed: u64,
    },
}

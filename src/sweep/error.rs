//! What can stop a sweep, in words that lead out.

use std::path::PathBuf;

use crate::atomic_file::FileError;
use crate::config::{ConfigError, Place};

/// Why a sweep is refused, or cannot go on; the message is one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// What is wrong with the configuration, or with a value that a key is to take.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A key that no plan has.
    #[error("{place}: {table} has no key \"{key}\"; it takes {known}{}", hint(nearest.as_deref()))]
    UnknownKey {
        /// Where.
        place: Place,
        /// The table that it is in.
        table: &'static str,
        /// The key.
        key: String,
        /// The keys that there are.
        known: String,
        /// The most similar one, if one is similar.
        nearest: Option<String>,
    },
    /// A key of the plan that is not there, or one too many.
    #[error("{place}: {table} {what}")]
    Incomplete {
        /// Where the table begins.
        place: Place,
        /// The table.
        table: &'static str,
        /// What is missing, and what to give.
        what: &'static str,
    },
    /// A value of the plan that does not do.
    #[error("{place}: {key} = {value}: {reason}")]
    Value {
        /// Where.
        place: Place,
        /// The key of the plan.
        key: String,
        /// The value as given, shortened.
        value: String,
        /// What does not do, and what would.
        reason: String,
    },
    /// A key of the configuration that cannot be swept.
    #[error("{place}: {key} cannot be swept: {reason}")]
    NotSwept {
        /// Where.
        place: Place,
        /// The key of the configuration.
        key: String,
        /// Why not, and the way out.
        reason: String,
    },
    /// More runs than can be counted, or kept.
    #[error("{file}: the plan has more than {most:e} runs; give an axis fewer points")]
    TooManyRuns {
        /// The plan.
        file: String,
        /// Largest number.
        most: f64,
    },
    /// More chunks than a directory holds well.
    #[error(
        "{file}: chunk = {chunk} makes {chunks} chunks of {runs} runs, at most {most}; raise chunk"
    )]
    TooManyChunks {
        /// The plan.
        file: String,
        /// Runs of a chunk.
        chunk: u64,
        /// Number of chunks.
        chunks: u64,
        /// Number of runs.
        runs: u64,
        /// Largest number of chunks.
        most: u64,
    },
    /// More combinations of words and whole numbers than columns are looked up for.
    #[error(
        "{file}: the axes of words and whole numbers have more than {most} combinations; make a plan of each part"
    )]
    TooManyShapes {
        /// The plan.
        file: String,
        /// Largest number.
        most: u64,
    },
    /// A file that cannot be written or read.
    #[error("{0}; what was finished is kept, and the same command goes on")]
    File(#[from] FileError),
    /// A row that is not as it was written, so that it cannot be told by column.
    #[error("{}: {what}; make the sweep again with --force", path.display())]
    Row {
        /// The file.
        path: PathBuf,
        /// Which line, and what is wrong with it.
        what: String,
    },
    /// Chunks that were found altered again and again.
    #[error(
        "{n} chunks in {} are altered each time they are written; look at the disk",
        path.display()
    )]
    Altered {
        /// Where they are.
        path: PathBuf,
        /// How many.
        n: usize,
    },
}

/// The end of the message on an unknown key.
fn hint(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |key| format!("; did you mean \"{key}\"?"))
}

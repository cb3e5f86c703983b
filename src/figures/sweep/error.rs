//! What can keep a figure of a sweep from being drawn, in words that lead out.

use crate::sweep::results::ResultsError;

/// Why a figure is refused; the message is one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// A column that is not there, or a sweep that cannot be read.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// Two axes of the grid, and nothing to show over them.
    #[error("{x} and {y} are both axes of the grid; give the value over them with --color")]
    TwoAxes {
        /// The one to the right.
        x: String,
        /// The one upwards.
        y: String,
    },
    /// A distribution whose colour has no classes.
    #[error(
        "--color {color} has too many values to tell apart in a distribution of {x}; give a column of words or an axis of at most {most} values, or --y for a scatter"
    )]
    NoClasses {
        /// The column that is drawn.
        x: String,
        /// The column that was to colour it.
        color: String,
        /// Most classes.
        most: usize,
    },
    /// No run that came to its end has what is asked for.
    #[error(
        "no run has a value to show in each of {columns}; runs that did not come to their end: {failed}, `status` in runs.csv says why"
    )]
    Nothing {
        /// The columns.
        columns: String,
        /// Runs that are left out.
        failed: u64,
    },
    /// Sobol indices at more grid points than a figure shows.
    #[error(
        "the grid has {n} points, Sobol indices are drawn at most at {most}; make a plan of fewer"
    )]
    GridPoints {
        /// How many there are.
        n: u64,
        /// How many there may be.
        most: u64,
    },
    /// The figure itself.
    #[error("cannot draw: {0}")]
    Drawing(#[from] deltazero_plots::Error),
}

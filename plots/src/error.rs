//! What can keep a figure from being drawn.

use plotters_backend::DrawingErrorKind;

use crate::size::{LARGEST_SIDE, SMALLEST_SIDE};

/// Why a figure cannot be drawn; each message carries the value that is at fault.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The figure is too small to hold anything or too large to be rendered.
    #[error(
        "figure of {width}×{height} px; both sides must lie in {SMALLEST_SIDE}..={LARGEST_SIDE}"
    )]
    Size {
        /// Logical width, in pixels.
        width: u32,
        /// Logical height, in pixels.
        height: u32,
    },
    /// There are more panels than cells of the grid.
    #[error("{panels} panels do not fit into {rows} rows of {cols}; enlarge the grid")]
    Grid {
        /// Number of panels.
        panels: usize,
        /// Rows of the grid.
        rows: usize,
        /// Columns of the grid.
        cols: usize,
    },
    /// Titles, labels and legend leave no room for the data.
    #[error(
        "labels leave a plot area of {width:.0}×{height:.0} px; enlarge the figure or shorten the labels"
    )]
    Crowded {
        /// Width left for each panel's data, in pixels.
        width: f64,
        /// Height left for each panel's data, in pixels.
        height: f64,
    },
    /// A requested axis range is empty, not finite, too large, or not positive on a logarithmic axis.
    #[error(
        "axis `{axis}` cannot span {lo:e} to {hi:e}; a range rises, is finite, and on a log axis positive"
    )]
    Range {
        /// Label of the axis.
        axis: String,
        /// Requested lower end.
        lo: f64,
        /// Requested upper end.
        hi: f64,
    },
    /// Panels that share an axis disagree whether it is logarithmic.
    #[error(
        "panels share axis `{axis}` but some are logarithmic and some linear; give all one scale"
    )]
    SharedScale {
        /// Label of the first axis that differs from the first panel's.
        axis: String,
    },
    /// A heat map has not one cell for each pair of row and column.
    #[error("heat map `{title}` has {cells} {what} for {rows} rows of {cols}; give one a cell")]
    Cells {
        /// Title of the panel.
        title: String,
        /// What was counted: values, categories or texts.
        what: &'static str,
        /// How many there are.
        cells: usize,
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        cols: usize,
    },
    /// A heat map's cell names a category that is not in the list.
    #[error("heat map `{title}` has a cell of category {index} but only {names} names")]
    Category {
        /// Title of the panel.
        title: String,
        /// The category asked for.
        index: usize,
        /// Number of names.
        names: usize,
    },
    /// The embedded font cannot be read.
    #[error("embedded font cannot be read: {0}")]
    Font(#[from] ab_glyph::InvalidFont),
    /// The drawing backend failed.
    #[error("drawing failed: {0}")]
    Backend(Box<dyn std::error::Error + Send + Sync>),
    /// The image cannot be encoded as PNG.
    #[error("encoding as png failed: {0}")]
    Png(#[from] png::EncodingError),
}

impl<E: std::error::Error + Send + Sync + 'static> From<DrawingErrorKind<E>> for Error {
    fn from(error: DrawingErrorKind<E>) -> Self {
        Self::Backend(Box::new(error))
    }
}

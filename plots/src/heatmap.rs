//! Heat maps: a table of coloured cells, of categories with a legend or of numbers with a colour bar.

use crate::axis::Axis;

/// What the cells hold, row by row from the top, in each row from the left.
#[derive(Clone, Debug, PartialEq)]
pub enum Cells {
    /// Numbers, coloured along a gradient; the cell of one that cannot be shown is crossed out.
    Values {
        /// Quantity and unit at the colour bar, its scale, and the values at its ends.
        bar: Axis,
        /// One a cell.
        values: Vec<f64>,
    },
    /// One of a few names; a cell without a name is crossed out.
    Categories {
        /// What the legend says of those that a cell has; the index is that of the palette's colour.
        names: Vec<String>,
        /// Index of the name, one a cell.
        indices: Vec<Option<usize>>,
    },
}

impl Default for Cells {
    fn default() -> Self {
        Self::Values { bar: Axis::default(), values: Vec::new() }
    }
}

/// A table of coloured cells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Heatmap {
    /// Written above the panel.
    pub title: String,
    /// Label of the horizontal axis.
    pub x_label: String,
    /// Label of the vertical axis.
    pub y_label: String,
    /// Names of the columns, from left to right.
    pub columns: Vec<String>,
    /// Names of the rows, from top to bottom.
    pub rows: Vec<String>,
    /// Colours of the cells.
    pub cells: Cells,
    /// Texts in the cells, in the same order; empty for none. A text that does not fit is left out.
    pub texts: Vec<String>,
}

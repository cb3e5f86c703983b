//! Figures of a finished sweep: which one follows from the columns that are asked for.
//!
//! | `--x` | `--y` | figure |
//! |---|---|---|
//! | any column | none | distribution: a histogram, in classes by `--color` |
//! | axis | another axis | heat map of `--color`, the median of the runs of a cell |
//! | axis | numbers | lines: the median at each value of x with its 5 to 95 % band, one line a class of `--color` |
//! | any other two | | scatter, coloured by a number or in classes |
//!
//! An axis is one of the plan's grid. Classes are words, or the values of an axis with at most eight. An axis of more than
//! 100 values (heat map), or colours without classes (lines), make a scatter too. Runs that did not come to their end
//! are left out.

mod chosen;
mod distribution;
mod error;
mod field;
mod heat_map;
mod lines;
mod scatter;
pub mod sobol;

use deltazero_study::digits::count_of;

use super::Drawing;
use crate::sweep::results::{Results, Table};

pub use chosen::chosen;
pub use error::PlotError;

use field::{Field, Role};

/// Which columns a figure is of.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// To the right.
    pub x: &'a str,
    /// Upwards.
    pub y: Option<&'a str>,
    /// As colour.
    pub color: Option<&'a str>,
}

impl<'a> Asked<'a> {
    fn names(self) -> impl Iterator<Item = &'a str> {
        [Some(self.x), self.y, self.color].into_iter().flatten()
    }

    /// A name for the files of its figure.
    pub fn file_name(&self) -> String {
        let over = self.y.map_or_else(|| self.x.to_owned(), |y| format!("{y}_over_{}", self.x));
        self.color.map_or(over.clone(), |color| format!("{over}_by_{color}"))
    }
}

/// Whether a figure of some of these columns is called `name`.
pub fn may_be_named(name: &str, columns: &[&str]) -> bool {
    let is_column = |name: &str| columns.contains(&name);
    let is_over = |name: &str| {
        let mut each = columns.iter().filter_map(|y| name.strip_prefix(y)?.strip_prefix("_over_"));
        is_column(name) || each.any(is_column)
    };
    let mut colored = columns.iter().filter_map(|own| name.strip_suffix(own)?.strip_suffix("_by_"));
    let is_sobol = columns.iter().any(|own| sobol::file_name(own) == name);
    is_sobol || is_over(name) || colored.any(is_over)
}

/// What is drawn: the columns of the runs that came to their end.
struct Data<'a> {
    x: Field<'a>,
    y: Option<Field<'a>>,
    color: Option<Field<'a>>,
    n: usize,
    failed: u64,
}

/// The figure of these columns.
///
/// # Errors
/// A column that is not there, or columns of which no figure can be made.
pub fn drawing(results: &Results, asked: Asked<'_>) -> Result<Drawing, PlotError> {
    let names: Vec<&str> = asked.names().collect();
    drawing_of(results, &results.table(&names)?, asked)
}

/// The figure of these columns of a table that was read with them.
///
/// # Errors
/// Columns that the table lacks, or of which no figure can be made.
pub fn drawing_of(
    results: &Results,
    table: &Table,
    asked: Asked<'_>,
) -> Result<Drawing, PlotError> {
    let field = |name: &str| Some(Field::new(results, name, table.column(name)?));
    let nothing = || PlotError::Nothing {
        columns: asked.names().collect::<Vec<_>>().join(", "),
        failed: table.failed,
    };
    let data = Data {
        x: field(asked.x).ok_or_else(nothing)?,
        y: asked.y.and_then(field),
        color: asked.color.and_then(field),
        n: table.n_rows(),
        failed: table.failed,
    };
    if data.n_points() == 0 {
        return Err(nothing());
    }
    data.drawing()
}

impl Data<'_> {
    fn drawing(&self) -> Result<Drawing, PlotError> {
        let Some(y) = &self.y else { return distribution::drawing(self) };
        if self.x.role == Role::Axis && y.role == Role::Axis && self.x.name != y.name {
            let Some(color) = &self.color else {
                return Err(PlotError::TwoAxes { x: self.x.name.clone(), y: y.name.clone() });
            };
            if let Some(drawing) = heat_map::drawing(self, y, color) {
                return Ok(drawing);
            }
        } else if self.x.role == Role::Axis && !y.has_words() {
            let classes = self.color.as_ref().map(Field::classes);
            if !matches!(classes, Some(None)) {
                return lines::drawing(self, y, classes.flatten());
            }
        }
        scatter::drawing(self, y)
    }

    /// Number of runs that have a place in the figure, and a colour where there are some.
    fn n_points(&self) -> usize {
        let fields = [Some(&self.x), self.y.as_ref(), self.color.as_ref()].into_iter().flatten();
        let places: Vec<_> = fields.map(|field| (field, field.places())).collect();
        let is_shown = |row: &usize| places.iter().all(|(field, own)| field.shows(own[*row]));
        (0..self.n).filter(is_shown).count()
    }

    /// The end of a caption: how many runs it is of.
    fn of_runs(&self) -> String {
        self.of_shown(self.n_points())
    }

    /// The same where only `n` have a value that is shown.
    fn of_shown(&self, n: usize) -> String {
        of_runs(n as u64, (self.n - n) as u64, self.failed)
    }
}

/// Runs that are shown, and those that are not: without a value, and without an end.
fn of_runs(n: u64, without_value: u64, failed: u64) -> String {
    let left_out = [(without_value, "that have no value to show"), (failed, "that failed")];
    let left_out = left_out.into_iter().filter(|(n, _)| *n > 0);
    let left_out: Vec<String> = left_out.map(|(n, which)| format!("{n} {which}")).collect();
    let beside = match left_out.is_empty() {
        true => String::new(),
        false => format!("; left out: {}", left_out.join(", ")),
    };
    format!("Shown: {}{beside}.", count_of(n, "run"))
}

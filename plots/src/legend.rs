//! The legend: one entry for each look, outside of all plot areas.

use crate::canvas::{Align, Canvas};
use crate::font::Fonts;
use crate::frame::CAP_HEIGHT;
use crate::geometry::Rect;
use crate::marker::Marker;
use crate::stroke::Stroke;
use crate::style::{BORDER, LEGEND, Rgb, TEXT};

/// Where the legend stands; it never covers data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Legend {
    /// Below up to four entries that fit in two lines, else at the right.
    #[default]
    Auto,
    /// At the right.
    Right,
    /// Below, in as many lines as are needed.
    Below,
    /// No legend.
    Hidden,
}

/// The sample that an entry shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sample {
    Series { color: Rgb, stroke: Stroke, marker: Marker, hollow: bool },
    Swatch(Rgb),
    Tick(Rgb),
}

/// A line of the legend.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entry {
    pub(crate) label: String,
    pub(crate) sample: Sample,
}

/// Width of a sample, room after it, and room between two columns.
const SAMPLE: f64 = 30.0;
const GAP: f64 = 7.0;
const COLUMN_GAP: f64 = 20.0;
/// Distance of the legend from the panels.
const DISTANCE: f64 = 12.0;
/// Most entries that `Legend::Auto` puts below.
const FEW: usize = 4;

/// Takes the legend's room from `area` and draws it there.
pub(crate) fn draw(
    legend: Legend,
    mut entries: Vec<Entry>,
    area: &mut Rect,
    canvas: &mut Canvas,
    fonts: &Fonts,
) {
    let mut seen = Vec::new();
    entries.retain(|entry| {
        let new = !entry.label.is_empty() && !seen.contains(entry);
        if new {
            seen.push(entry.clone());
        }
        new
    });
    if entries.is_empty() || legend == Legend::Hidden {
        return;
    }
    let below = Rows::below(&entries, area.width(), fonts);
    let right = match legend {
        Legend::Right => true,
        Legend::Below | Legend::Hidden => false,
        Legend::Auto => entries.len() > FEW || below.rows > 2,
    };
    if right {
        draw_right(&entries, area, canvas, fonts);
    } else {
        area.bottom -= below.height() + DISTANCE;
        let left = area.center().0 - below.width() / 2.0;
        below.draw(&entries, (left, area.bottom + DISTANCE), canvas);
    }
}

/// As few columns as the height allows, at most two fifths of the figure wide.
fn draw_right(entries: &[Entry], area: &mut Rect, canvas: &mut Canvas, fonts: &Fonts) {
    let column = |columns: usize| 0.4 * area.width() / columns as f64;
    let choices: Vec<_> = (1..=3).map(|n| Rows::new(entries, n, true, column(n), fonts)).collect();
    let tall = |rows: &&Rows| rows.height() <= area.height();
    let Some(rows) = choices.iter().find(tall).or(choices.last()) else {
        return;
    };
    area.right -= rows.width() + DISTANCE;
    let top = area.top + ((area.height() - rows.height()) / 2.0).clamp(0.0, 24.0);
    rows.draw(entries, (area.right + DISTANCE, top), canvas);
}

/// Entries laid out in a table.
struct Rows {
    labels: Vec<Vec<String>>,
    rows: usize,
    widths: Vec<f64>,
    row_height: f64,
    by_column: bool,
}

impl Rows {
    /// As few lines as fit into `room`, equally long, filled line by line.
    fn below(entries: &[Entry], room: f64, fonts: &Fonts) -> Self {
        let table = |rows| Self::new(entries, entries.len().div_ceil(rows), false, room, fonts);
        let wide = |rows: &Self| rows.width() <= room;
        (1..entries.len()).map(table).find(wide).unwrap_or_else(|| table(entries.len()))
    }

    /// Labels are broken at `room`, the width of a column.
    fn new(entries: &[Entry], columns: usize, by_column: bool, room: f64, fonts: &Fonts) -> Self {
        let room = room - SAMPLE - GAP - COLUMN_GAP;
        let labels: Vec<_> =
            entries.iter().map(|entry| fonts.wrap(&entry.label, LEGEND, room)).collect();
        let lines = labels.iter().map(Vec::len).max().unwrap_or(1);
        let rows = entries.len().div_ceil(columns);
        let mut widths = vec![0.0_f64; columns];
        for (i, lines) in labels.iter().enumerate() {
            let width = &mut widths[if by_column { i / rows } else { i % columns }];
            *width = width.max(SAMPLE + GAP + fonts.widest(lines, LEGEND) + COLUMN_GAP);
        }
        let row_height = LEGEND.line_height() * lines as f64 + if lines > 1 { 5.0 } else { 2.5 };
        Self { labels, rows, widths, row_height, by_column }
    }

    fn width(&self) -> f64 {
        self.widths.iter().sum::<f64>() - COLUMN_GAP
    }

    fn height(&self) -> f64 {
        self.rows as f64 * self.row_height
    }

    fn draw(&self, entries: &[Entry], (left, top): (f64, f64), canvas: &mut Canvas) {
        let columns = self.widths.len();
        for (i, (entry, lines)) in entries.iter().zip(&self.labels).enumerate() {
            let (row, column) = if self.by_column {
                (i % self.rows, i / self.rows)
            } else {
                (i / columns, i % columns)
            };
            let x = left + self.widths[..column].iter().sum::<f64>();
            let middle = top + row as f64 * self.row_height + LEGEND.line_height() / 2.0;
            entry.sample.draw((x, middle), canvas);
            for (line, text) in lines.iter().enumerate() {
                let y =
                    middle + CAP_HEIGHT / 2.0 * LEGEND.size + line as f64 * LEGEND.line_height();
                canvas.text(text, (x + SAMPLE + GAP, y), LEGEND, TEXT, Align::Start);
            }
        }
    }
}

impl Sample {
    fn draw(self, (x, y): (f64, f64), canvas: &mut Canvas) {
        match self {
            Sample::Series { color, stroke, marker, hollow } => {
                stroke.draw(&[(x, y), (x + SAMPLE, y)], color, canvas);
                marker.draw((x + SAMPLE / 2.0, y), color, hollow, canvas);
            }
            Sample::Swatch(color) => {
                let swatch =
                    Rect { left: x + 6.0, top: y - 6.0, right: x + SAMPLE - 4.0, bottom: y + 6.0 };
                canvas.rect(swatch, color);
                canvas.outline(swatch, BORDER);
            }
            Sample::Tick(color) => {
                let middle = x + SAMPLE / 2.0;
                canvas.rule(vec![(middle, y - 5.0), (middle, y + 5.0)], color);
            }
        }
    }
}

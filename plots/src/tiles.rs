//! Draws heat maps: cells and their texts.

use crate::canvas::{Align, Canvas};
use crate::color_bar::ColorBar;
use crate::content::Content;
use crate::error::Error;
use crate::font::Fonts;
use crate::frame::{CAP_HEIGHT, Frame, Side};
use crate::geometry::Rect;
use crate::heatmap::{Cells, Heatmap};
use crate::legend::{Entry, Sample};
use crate::style::{
    CELL, GRID_MINOR, LABEL, MARK, MUTED, NOTE, PANEL, Rgb, THIN, TICK, WHITE, palette,
};
use crate::ticks::Ticks;

/// A heat map with its colours.
pub(crate) struct Tiles<'a> {
    map: &'a Heatmap,
    colors: Vec<Option<Rgb>>,
    bar: Option<ColorBar<'a>>,
}

impl<'a> Tiles<'a> {
    pub(crate) fn new(map: &'a Heatmap) -> Result<Self, Error> {
        let (rows, cols) = (map.rows.len(), map.columns.len());
        let (what, count) = match &map.cells {
            Cells::Values { values, .. } => ("values", values.len()),
            Cells::Categories { indices, .. } => ("categories", indices.len()),
        };
        let texts = if map.texts.is_empty() { rows * cols } else { map.texts.len() };
        for (what, cells) in [(what, count), ("texts", texts)] {
            if cells != rows * cols {
                return Err(Error::Cells { title: map.title.clone(), what, cells, rows, cols });
            }
        }
        match &map.cells {
            Cells::Values { bar, values } => {
                let bar = ColorBar::new(bar, values.iter().copied())?;
                let colors = values.iter().map(|value| bar.color(*value)).collect();
                Ok(Self { map, colors, bar: Some(bar) })
            }
            Cells::Categories { names, indices } => {
                if let Some(index) =
                    indices.iter().copied().flatten().find(|&index| index >= names.len())
                {
                    return Err(Error::Category {
                        title: map.title.clone(),
                        index,
                        names: names.len(),
                    });
                }
                let color = |index: &Option<usize>| index.map(category);
                Ok(Self { map, colors: indices.iter().map(color).collect(), bar: None })
            }
        }
    }

    fn draw_cells(&self, plot: Rect, canvas: &mut Canvas, fonts: &Fonts) {
        let (rows, cols) = (self.map.rows.len(), self.map.columns.len());
        let (width, height) = (plot.width() / cols as f64, plot.height() / rows as f64);
        for (i, color) in self.colors.iter().enumerate() {
            let (left, top) =
                (plot.left + (i % cols) as f64 * width, plot.top + (i / cols) as f64 * height);
            let cell = Rect { left, top, right: left + width, bottom: top + height };
            let fill = color.unwrap_or(GRID_MINOR);
            let text = self.map.texts.get(i).map_or("", String::as_str);
            let text_width = fonts.width(text, NOTE);
            let (x, y) = cell.center();
            canvas.rect(cell, fill);
            if color.is_none() {
                cross_out(cell, text_width, canvas);
            }
            canvas.outline(cell, WHITE);
            if text_width <= width - 4.0 && NOTE.line_height() <= height {
                canvas.text(
                    text,
                    (x, y + CAP_HEIGHT / 2.0 * NOTE.size),
                    NOTE,
                    fill.ink(),
                    Align::Middle,
                );
            }
        }
        if self.colors.is_empty() {
            canvas.text("no data", plot.center(), LABEL, MUTED, Align::Middle);
        }
    }
}

/// Both diagonals, with room for a text of this width: a pale cell alone could be taken for one of a grey colour.
fn cross_out(cell: Rect, text_width: f64, canvas: &mut Canvas) {
    let [a, b, c, d] = cell.corners();
    for diagonal in [[a, c], [b, d]] {
        canvas.stroke(diagonal.to_vec(), THIN, MARK);
    }
    let ((x, y), half) = (cell.center(), NOTE.line_height() / 2.0);
    let room = Rect {
        left: x - text_width / 2.0,
        right: x + text_width / 2.0,
        top: y - half,
        bottom: y + half,
    };
    if text_width > 0.0 && cell.contains((room.left, room.top)) {
        canvas.rect(room, GRID_MINOR);
    }
}

fn category(index: usize) -> Rgb {
    palette(index).over_white(CELL)
}

impl Content for Tiles<'_> {
    fn frame(&self, width: f64, height: f64, fonts: &Fonts) -> Frame {
        let map = self.map;
        let rows = fonts.names(&map.rows, width);
        Frame {
            title: fonts.wrap(&map.title, PANEL, width),
            x: Side::across(&map.x_label, &map.columns, (width, height), fonts),
            y: Side {
                label: fonts.wrap(&map.y_label, LABEL, height),
                ticks: Ticks::middles(&rows, height / TICK.line_height(), true),
                upright: false,
            },
            right: self.bar.as_ref().map_or(0.0, |bar| bar.room(height, fonts)),
            square: false,
        }
    }

    fn draw(&self, plot: Rect, frame: &Frame, canvas: &mut Canvas, fonts: &Fonts) {
        self.draw_cells(plot, canvas, fonts);
        if let Some(bar) = &self.bar {
            bar.draw(plot, canvas, fonts);
        }
        frame.draw(plot, canvas, fonts);
    }

    fn is_empty(&self) -> bool {
        let has_no_color = self.colors.iter().all(Option::is_none);
        has_no_color && self.map.texts.iter().all(String::is_empty)
    }

    fn legend(&self) -> Vec<Entry> {
        let Cells::Categories { names, indices } = &self.map.cells else {
            return Vec::new();
        };
        let entry = |(i, name): (usize, &String)| Entry {
            label: name.clone(),
            sample: Sample::Swatch(category(i)),
        };
        let is_there = |(i, _): &(usize, &String)| indices.contains(&Some(*i));
        names.iter().enumerate().filter(is_there).map(entry).collect()
    }
}

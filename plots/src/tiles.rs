//! Draws heat maps: cells, texts, colour bar.

use crate::axis::Span;
use crate::canvas::{Align, Canvas};
use crate::error::Error;
use crate::font::Fonts;
use crate::frame::{CAP_HEIGHT, Frame, Side};
use crate::geometry::Rect;
use crate::heatmap::{Cells, Heatmap};
use crate::legend::{Entry, Sample};
use crate::panel::Content;
use crate::style::{
    BORDER, CELL, GRID_MINOR, LABEL, MUTED, NOTE, PANEL, Rgb, TEXT, TICK, TICK_LENGTH, WHITE,
    gradient, palette,
};
use crate::ticks::{Tick, Ticks};

/// Distance of the colour bar from the cells, and its width [px].
const BAR_GAP: f64 = 14.0;
const BAR_WIDTH: f64 = 14.0;
/// Colour steps of the bar.
const BAR_STEPS: i32 = 128;

/// A heat map with its colours.
pub(crate) struct Tiles<'a> {
    map: &'a Heatmap,
    colors: Vec<Option<Rgb>>,
    bar: Option<(&'a str, Span)>,
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
                let span = bar.span(values.iter().copied(), 0.0)?;
                let color = |&value: &f64| span.fraction(value).map(gradient);
                Ok(Self {
                    map,
                    colors: values.iter().map(color).collect(),
                    bar: Some((&bar.label, span)),
                })
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
            let color = color.unwrap_or(GRID_MINOR);
            canvas.rect(cell, color);
            canvas.outline(cell, WHITE);
            let text = self.map.texts.get(i).map_or("", String::as_str);
            if fonts.width(text, NOTE) <= width - 4.0 && NOTE.line_height() <= height {
                let (x, y) = cell.center();
                canvas.text(
                    text,
                    (x, y + CAP_HEIGHT / 2.0 * NOTE.size),
                    NOTE,
                    color.ink(),
                    Align::Middle,
                );
            }
        }
        if self.colors.is_empty() {
            canvas.text("no data", plot.center(), LABEL, MUTED, Align::Middle);
        }
    }

    fn draw_bar(&self, plot: Rect, canvas: &mut Canvas, fonts: &Fonts) {
        let Some((label, span)) = self.bar else {
            return;
        };
        let left = plot.right + BAR_GAP;
        let bar = Rect { left, right: left + BAR_WIDTH, ..plot };
        for i in 0..BAR_STEPS {
            let at = |part: f64| bar.at((0.0, part / f64::from(BAR_STEPS))).1;
            // Each step reaches to the bar's top, so that no seam shows between two.
            canvas.rect(
                Rect { bottom: at(f64::from(i)), ..bar },
                gradient((f64::from(i) + 0.5) / f64::from(BAR_STEPS)),
            );
        }
        canvas.outline(bar, BORDER);
        let ticks = Ticks::up(span, plot.height());
        let x = bar.right + TICK_LENGTH + 3.0;
        for tick in &ticks.major {
            let y = bar.at((0.0, tick.at)).1;
            canvas.rule(vec![(bar.right, y), (bar.right + TICK_LENGTH, y)], BORDER);
            canvas.text(
                &tick.label,
                (x, y + CAP_HEIGHT / 2.0 * TICK.size),
                TICK,
                TEXT,
                Align::Start,
            );
        }
        canvas.text(&ticks.factor, (bar.left, bar.top - 6.0), TICK, TEXT, Align::Start);
        let widest = fonts.widest(ticks.major.iter().map(|tick| &tick.label), TICK);
        let mut baseline = x + widest + LABEL.line_height();
        for line in fonts.wrap(label, LABEL, plot.height()) {
            canvas.vertical_text(&line, (baseline, plot.center().1), LABEL, TEXT, Align::Middle);
            baseline += LABEL.line_height();
        }
    }

    /// Room at the right of the cells for the bar.
    fn bar_room(&self, height: f64, fonts: &Fonts) -> f64 {
        self.bar.map_or(0.0, |(label, span)| {
            let ticks = Ticks::up(span, height);
            let labels = fonts.widest(ticks.major.iter().map(|tick| &tick.label), TICK);
            let lines = fonts.wrap(label, LABEL, height).len() as f64 * LABEL.line_height();
            let beside = BAR_WIDTH + TICK_LENGTH + 3.0 + labels + lines + 4.0;
            BAR_GAP + beside.max(fonts.width(&ticks.factor, TICK))
        })
    }
}

fn category(index: usize) -> Rgb {
    palette(index).over_white(CELL)
}

/// Ticks in the middle of equal intervals; too many of them for `most` get a label only now and then.
fn middles(names: &[String], most: f64, reversed: bool) -> Ticks {
    let stride = (names.len() as f64 / most.max(1.0)).ceil().max(1.0) as usize;
    let tick = |(i, name): (usize, &String)| {
        let at = (i as f64 + 0.5) / names.len() as f64;
        Tick { at: if reversed { 1.0 - at } else { at }, label: name.clone() }
    };
    Ticks {
        major: names.iter().enumerate().step_by(stride).map(tick).collect(),
        ..Ticks::default()
    }
}

impl Content for Tiles<'_> {
    fn frame(&self, width: f64, height: f64, fonts: &Fonts) -> Frame {
        let map = self.map;
        let cell = width / map.columns.len().max(1) as f64;
        let upright = fonts.widest(&map.columns, TICK) > cell - 6.0;
        let most = if upright { width / TICK.line_height() } else { f64::INFINITY };
        let side = |label: &str, ticks, room, upright| Side {
            label: fonts.wrap(label, LABEL, room),
            ticks,
            upright,
        };
        Frame {
            title: fonts.wrap(&map.title, PANEL, width),
            x: side(&map.x_label, middles(&map.columns, most, false), width, upright),
            y: side(
                &map.y_label,
                middles(&map.rows, height / TICK.line_height(), true),
                height,
                false,
            ),
            right: self.bar_room(height, fonts),
            square: false,
        }
    }

    fn draw(&self, plot: Rect, frame: &Frame, canvas: &mut Canvas, fonts: &Fonts) {
        self.draw_cells(plot, canvas, fonts);
        self.draw_bar(plot, canvas, fonts);
        frame.draw(plot, canvas, fonts);
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

//! What surrounds the data of every panel: title, frame, ticks, grid, axis labels.

use crate::canvas::{Align, Canvas};
use crate::font::Fonts;
use crate::geometry::Rect;
use crate::style::{BORDER, Face, GRID, GRID_MINOR, LABEL, PANEL, TEXT, TICK, TICK_LENGTH};
use crate::ticks::Ticks;

/// Room between a tick's label and the axis' label, and above the frame.
const GAP: f64 = 6.0;
/// Distance of the power of ten of a y axis from the frame: above the label of a tick at its end.
const FACTOR_RISE: f64 = 9.0;
/// Height of capitals and digits [em].
pub(crate) const CAP_HEIGHT: f64 = 0.73;

/// One axis as it is drawn.
#[derive(Clone, Debug, Default)]
pub(crate) struct Side {
    /// Lines of the axis' label.
    pub(crate) label: Vec<String>,
    pub(crate) ticks: Ticks,
    /// Tick labels of an x axis read from bottom to top.
    pub(crate) upright: bool,
}

/// Everything around the data.
#[derive(Clone, Debug, Default)]
pub(crate) struct Frame {
    pub(crate) title: Vec<String>,
    pub(crate) x: Side,
    pub(crate) y: Side,
    /// Extra room at the right that the content itself fills.
    pub(crate) right: f64,
    /// The plot area is to be a square.
    pub(crate) square: bool,
}

/// Room that a frame needs around the plot area [px].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Margins {
    pub(crate) left: f64,
    pub(crate) right: f64,
    pub(crate) top: f64,
    pub(crate) bottom: f64,
}

fn labels(ticks: &Ticks) -> impl Iterator<Item = &String> {
    ticks.major.iter().map(|tick| &tick.label).chain([&ticks.factor])
}

fn block(lines: &[String], face: Face) -> f64 {
    lines.len() as f64 * face.line_height()
}

impl Side {
    /// An x axis of named places, their names upright where they are too wide for their places.
    pub(crate) fn across(
        label: &str,
        names: &[String],
        (width, height): (f64, f64),
        fonts: &Fonts,
    ) -> Self {
        let upright = fonts.widest(names, TICK) > width / names.len().max(1) as f64 - 6.0;
        let most = if upright { width / TICK.line_height() } else { f64::INFINITY };
        let ticks = Ticks::middles(&fonts.names(names, height), most, false);
        Self { label: fonts.wrap(label, LABEL, width), ticks, upright }
    }

    /// Takes away what a neighbour sharing this axis already says.
    pub(crate) fn silence(&mut self) {
        self.label.clear();
        self.ticks.factor.clear();
        self.ticks.major.iter_mut().for_each(|tick| tick.label.clear());
    }

    fn labelled(&self) -> bool {
        labels(&self.ticks).any(|label| !label.is_empty())
    }

    /// Extent below the tick marks of an x axis' tick labels.
    fn depth(&self, fonts: &Fonts) -> f64 {
        match (self.labelled(), self.upright) {
            (false, _) => 0.0,
            (true, false) => TICK.line_height(),
            (true, true) => fonts.widest(labels(&self.ticks), TICK) + 2.0,
        }
    }
}

impl Frame {
    pub(crate) fn margins(&self, fonts: &Fonts) -> Margins {
        let gap = |lines: &[String]| if lines.is_empty() { 0.0 } else { GAP };
        let half_label = |side: &Side| match (side.upright, side.labelled()) {
            (false, true) => fonts.widest(labels(&side.ticks), TICK) / 2.0,
            _ => 0.0,
        };
        let factor =
            if self.y.ticks.factor.is_empty() { 0.0 } else { FACTOR_RISE + TICK.size - GAP };
        let left =
            TICK_LENGTH + 3.0 + fonts.widest(labels(&self.y.ticks), TICK) + gap(&self.y.label);
        Margins {
            left: (left + block(&self.y.label, LABEL)).max(half_label(&self.x)),
            right: half_label(&self.x).max(GAP) + self.right,
            top: GAP + factor.max(block(&self.title, PANEL) + gap(&self.title)),
            bottom: TICK_LENGTH
                + 2.0
                + self.x.depth(fonts)
                + block(&self.x.label, LABEL)
                + gap(&self.x.label),
        }
    }

    /// Grid lines; what is drawn later covers them.
    pub(crate) fn draw_grid(&self, plot: Rect, canvas: &mut Canvas) {
        let majors = |ticks: &Ticks| ticks.major.iter().map(|tick| tick.at).collect::<Vec<_>>();
        let (x, y) = (&self.x.ticks, &self.y.ticks);
        for (xs, ys, color) in
            [(x.minor.clone(), y.minor.clone(), GRID_MINOR), (majors(x), majors(y), GRID)]
        {
            for at in xs {
                canvas.rule(vec![plot.at((at, 0.0)), plot.at((at, 1.0))], color);
            }
            for at in ys {
                canvas.rule(vec![plot.at((0.0, at)), plot.at((1.0, at))], color);
            }
        }
    }

    /// Frame, ticks, labels and title.
    pub(crate) fn draw(&self, plot: Rect, canvas: &mut Canvas, fonts: &Fonts) {
        canvas.outline(plot, BORDER);
        self.draw_x(plot, canvas, fonts);
        self.draw_y(plot, canvas, fonts);
        let mut baseline = plot.top - GAP - PANEL.line_height() * (self.title.len() as f64 - 1.0);
        let factor_at = (plot.left - TICK_LENGTH - 3.0, plot.top - FACTOR_RISE);
        canvas.text(&self.y.ticks.factor, factor_at, TICK, TEXT, Align::End);
        for line in &self.title {
            canvas.text(line, (plot.left, baseline), PANEL, TEXT, Align::Start);
            baseline += PANEL.line_height();
        }
    }

    fn draw_x(&self, plot: Rect, canvas: &mut Canvas, fonts: &Fonts) {
        for at in &self.x.ticks.minor {
            let (x, y) = plot.at((*at, 0.0));
            canvas.rule(vec![(x, y), (x, y + TICK_LENGTH / 2.0)], BORDER);
        }
        let top = plot.bottom + TICK_LENGTH + 2.0;
        for tick in &self.x.ticks.major {
            let (x, y) = plot.at((tick.at, 0.0));
            canvas.rule(vec![(x, y), (x, y + TICK_LENGTH)], BORDER);
            if self.x.upright {
                let at = (x + CAP_HEIGHT / 2.0 * TICK.size, top);
                canvas.vertical_text(&tick.label, at, TICK, TEXT, Align::End);
            } else {
                canvas.text(&tick.label, (x, top + TICK.size), TICK, TEXT, Align::Middle);
            }
        }
        let mut baseline = top + self.x.depth(fonts) + GAP + CAP_HEIGHT * LABEL.size;
        canvas.text(&self.x.ticks.factor, (plot.right, baseline), TICK, TEXT, Align::End);
        for line in &self.x.label {
            canvas.text(line, (plot.center().0, baseline), LABEL, TEXT, Align::Middle);
            baseline += LABEL.line_height();
        }
    }

    fn draw_y(&self, plot: Rect, canvas: &mut Canvas, fonts: &Fonts) {
        for at in &self.y.ticks.minor {
            let (x, y) = plot.at((0.0, *at));
            canvas.rule(vec![(x - TICK_LENGTH / 2.0, y), (x, y)], BORDER);
        }
        let right = plot.left - TICK_LENGTH - 3.0;
        for tick in &self.y.ticks.major {
            let (x, y) = plot.at((0.0, tick.at));
            canvas.rule(vec![(x - TICK_LENGTH, y), (x, y)], BORDER);
            let at = (right, y + CAP_HEIGHT / 2.0 * TICK.size);
            canvas.text(&tick.label, at, TICK, TEXT, Align::End);
        }
        let mut baseline = right - fonts.widest(labels(&self.y.ticks), TICK) - GAP - 2.0;
        for line in self.y.label.iter().rev() {
            canvas.vertical_text(line, (baseline, plot.center().1), LABEL, TEXT, Align::Middle);
            baseline -= LABEL.line_height();
        }
    }
}

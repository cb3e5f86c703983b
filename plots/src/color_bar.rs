//! The bar beside a chart that says which colour stands for which number.

use crate::axis::{Axis, Span};
use crate::canvas::{Align, Canvas};
use crate::error::Error;
use crate::font::Fonts;
use crate::frame::CAP_HEIGHT;
use crate::geometry::Rect;
use crate::style::{BORDER, LABEL, Rgb, TEXT, TICK, TICK_LENGTH, gradient};
use crate::ticks::Ticks;

/// Distance of the bar from the data, and its width [px].
const GAP: f64 = 14.0;
const WIDTH: f64 = 14.0;
/// Its colour steps.
const STEPS: i32 = 128;

/// A colour bar with what it covers.
pub(crate) struct ColorBar<'a> {
    label: &'a str,
    span: Span,
}

impl<'a> ColorBar<'a> {
    /// The bar of an axis over these values.
    pub(crate) fn new(axis: &'a Axis, values: impl Iterator<Item = f64>) -> Result<Self, Error> {
        Ok(Self { label: &axis.label, span: axis.span(values, 0.0)? })
    }

    /// The colour of a value, if it can be shown.
    pub(crate) fn color(&self, value: f64) -> Option<Rgb> {
        self.span.fraction(value).map(gradient)
    }

    /// Draws it at the right of a plot area.
    pub(crate) fn draw(&self, plot: Rect, canvas: &mut Canvas, fonts: &Fonts) {
        let left = plot.right + GAP;
        let bar = Rect { left, right: left + WIDTH, ..plot };
        for i in 0..STEPS {
            let at = |part: f64| bar.at((0.0, part / f64::from(STEPS))).1;
            // Each step reaches to the bar's top, so that no seam shows between two.
            canvas.rect(
                Rect { bottom: at(f64::from(i)), ..bar },
                gradient((f64::from(i) + 0.5) / f64::from(STEPS)),
            );
        }
        canvas.outline(bar, BORDER);
        let ticks = Ticks::up(self.span, plot.height());
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
        for line in fonts.wrap(self.label, LABEL, plot.height()) {
            canvas.vertical_text(&line, (baseline, plot.center().1), LABEL, TEXT, Align::Middle);
            baseline += LABEL.line_height();
        }
    }

    /// Room that it takes at the right of a plot area of that height.
    pub(crate) fn room(&self, height: f64, fonts: &Fonts) -> f64 {
        let ticks = Ticks::up(self.span, height);
        let labels = fonts.widest(ticks.major.iter().map(|tick| &tick.label), TICK);
        let lines = fonts.wrap(self.label, LABEL, height).len() as f64 * LABEL.line_height();
        let beside = WIDTH + TICK_LENGTH + 3.0 + labels + lines + 4.0;
        GAP + beside.max(fonts.width(&ticks.factor, TICK))
    }
}

//! What stands in one cell of a figure's grid, and what the layout asks of it.

use std::borrow::Cow;

use crate::axis::Span;
use crate::canvas::Canvas;
use crate::error::Error;
use crate::font::Fonts;
use crate::frame::Frame;
use crate::geometry::Rect;
use crate::heatmap::Heatmap;
use crate::histogram::Histogram;
use crate::legend::Entry;
use crate::line::LineChart;
use crate::orbit::Orbit;
use crate::plane::Plane;
use crate::steps::StepHistory;
use crate::tiles::Tiles;

/// One chart of a figure.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Panel {
    /// y over x.
    Line(LineChart),
    /// Step size over time.
    Steps(StepHistory),
    /// Counts over bins.
    Histogram(Histogram),
    /// A curve in the plane.
    Orbit(Orbit),
    /// A table of colours.
    Heatmap(Heatmap),
}

/// An axis with the values it covers.
#[derive(Clone, Debug)]
pub(crate) struct Ruler {
    pub(crate) label: String,
    pub(crate) span: Span,
    /// The span says something: there is data, or a range was asked for.
    pub(crate) settled: bool,
    /// A neighbour that shares this axis has its labels.
    pub(crate) silent: bool,
}

/// A chart made ready to be laid out and drawn.
pub(crate) trait Content {
    /// Title, ticks and labels for a plot area of that size.
    fn frame(&self, width: f64, height: f64, fonts: &Fonts) -> Frame;

    /// Draws the data and the frame.
    fn draw(&self, plot: Rect, frame: &Frame, canvas: &mut Canvas, fonts: &Fonts);

    /// Entries for the figure's legend.
    fn legend(&self) -> Vec<Entry>;

    /// Whether it has no data.
    fn is_empty(&self) -> bool;

    /// Both axes, x first, if other panels can share them.
    fn rulers(&mut self) -> Option<&mut [Ruler; 2]> {
        None
    }
}

impl Panel {
    pub(crate) fn content(&self) -> Result<Box<dyn Content + '_>, Error> {
        let chart = match self {
            Panel::Heatmap(map) => return Ok(Box::new(Tiles::new(map)?)),
            Panel::Line(chart) => Cow::Borrowed(chart),
            Panel::Steps(history) => Cow::Owned(history.chart()),
            Panel::Histogram(histogram) => Cow::Owned(histogram.chart()),
            Panel::Orbit(orbit) => Cow::Owned(orbit.chart()),
        };
        Ok(Box::new(Plane::new(chart)?))
    }
}

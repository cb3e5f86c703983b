//! What the layout asks of a chart.

use crate::axis::Span;
use crate::canvas::Canvas;
use crate::font::Fonts;
use crate::frame::Frame;
use crate::geometry::Rect;
use crate::legend::Entry;

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

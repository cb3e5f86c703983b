//! What stands in one cell of a figure's grid: a chart of any kind.

use std::borrow::Cow;

use crate::content::Content;
use crate::error::Error;
use crate::heatmap::Heatmap;
use crate::histogram::Histogram;
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

impl From<LineChart> for Panel {
    fn from(chart: LineChart) -> Self {
        Panel::Line(chart)
    }
}

impl From<StepHistory> for Panel {
    fn from(history: StepHistory) -> Self {
        Panel::Steps(history)
    }
}

impl From<Histogram> for Panel {
    fn from(histogram: Histogram) -> Self {
        Panel::Histogram(histogram)
    }
}

impl From<Orbit> for Panel {
    fn from(orbit: Orbit) -> Self {
        Panel::Orbit(orbit)
    }
}

impl From<Heatmap> for Panel {
    fn from(map: Heatmap) -> Self {
        Panel::Heatmap(map)
    }
}

//! Charts of y over x: series, and what helps to read them.

use crate::axis::Axis;
use crate::marker::Marker;
use crate::series::Series;

/// A shaded interval of x: a mode, a regime.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Band {
    /// Both ends.
    pub x: (f64, f64),
    /// Index into the palette; the band has a pale tint of it.
    pub color: usize,
    /// What the legend says; bands alike in label and colour have one entry.
    pub label: String,
}

/// A dashed grey line of known slope, to compare series with.
///
/// The slope is that of the drawn coordinates: on two logarithmic axes the exponent p of `y ∝ xᵖ`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Guide {
    /// The slope p.
    pub slope: f64,
    /// A point the line passes through.
    pub through: (f64, f64),
    /// The part of x to be drawn; all of it without.
    pub span: Option<(f64, f64)>,
    /// Written at the line's right end.
    pub label: String,
}

/// A horizontal reference line; a y axis without a range includes it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Level {
    /// Its height.
    pub y: f64,
    /// Written above its right end.
    pub label: String,
}

/// A labelled vertical reference line; an x axis without a range includes it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Upright {
    /// Where it stands.
    pub x: f64,
    /// Written beside it.
    pub label: String,
}

/// Bars from zero, or from the lower end of a logarithmic axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bars {
    /// What the legend says; empty for no entry.
    pub label: String,
    /// Index into the palette.
    pub color: usize,
    /// Both sides of each, and the value that it goes to.
    pub bars: Vec<((f64, f64), f64)>,
}

/// The area between two curves, pale: what a quantity covers that oscillates too fast to be followed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ribbon {
    /// Index into the palette; the area has a pale tint of it, its edges the colour itself.
    pub color: usize,
    /// x, and the lower and the upper y there.
    pub points: Vec<(f64, f64, f64)>,
}

/// Points coloured by a third number, with a colour bar at the right of the chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// Quantity and unit of the colour at the bar, its scale, and the values at its ends.
    pub bar: Axis,
    /// The sign at each point.
    pub marker: Marker,
    /// x, y, and what colours the point; one that cannot be shown leaves it grey.
    pub points: Vec<(f64, f64, f64)>,
}

/// A text at a point of the chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Note {
    /// The point, at the text's lower left; the text moves left where it would leave the chart.
    pub at: (f64, f64),
    /// What it says.
    pub text: String,
}

/// A chart of y over x.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineChart {
    /// Written above the panel.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The data, later series above earlier ones.
    pub series: Vec<Series>,
    /// Points coloured by a number, below the series.
    pub cloud: Option<Box<Cloud>>,
    /// Bars, below the series.
    pub bars: Vec<Bars>,
    /// Areas, below the grid; an axis without a range does not include them.
    pub ribbons: Vec<Ribbon>,
    /// Shaded intervals of x.
    pub bands: Vec<Band>,
    /// Thin vertical lines: times of events.
    pub marks: Vec<f64>,
    /// Short ticks inside the upper border, for events too many to draw as lines.
    pub ticks: Vec<f64>,
    /// What the legend says of `ticks`.
    pub ticks_label: String,
    /// Lines of known slope.
    pub guides: Vec<Guide>,
    /// Horizontal reference lines.
    pub levels: Vec<Level>,
    /// Vertical reference lines.
    pub uprights: Vec<Upright>,
    /// Texts.
    pub notes: Vec<Note>,
    /// One unit of x is as long as one of y, in a square plot area.
    pub equal_aspect: bool,
}

//! Orbits: curves in the plane, both axes at one scale.

use crate::axis::Axis;
use crate::line::LineChart;
use crate::marker::Marker;
use crate::series::Series;
use crate::stroke::Stroke;

/// A circle to compare an orbit with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Circle {
    /// Its centre.
    pub center: (f64, f64),
    /// Its radius, in the unit of the axes.
    pub radius: f64,
    /// What the legend says.
    pub label: String,
}

/// Curves in the plane; each curve's first point is marked with a circle, its last with a square.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Orbit {
    /// Written above the panel.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis, in the same unit.
    pub y: Axis,
    /// The curves.
    pub curves: Vec<Series>,
    /// A circle to compare with.
    pub circle: Option<Circle>,
}

/// Corners of the polygon that stands for a circle.
const CORNERS: i32 = 180;
/// Palette index of the circle and of the marks at both ends.
const REFERENCE: usize = 6;

impl Circle {
    fn series(&self) -> Series {
        let corner = |i: i32| {
            let (sin, cos) =
                libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(CORNERS));
            (self.center.0 + self.radius * cos, self.center.1 + self.radius * sin)
        };
        let points = (0..=CORNERS).map(corner).collect();
        Series { stroke: Stroke::Dashed, ..Series::line(self.label.clone(), REFERENCE, points) }
    }
}

impl Orbit {
    pub(crate) fn chart(&self) -> LineChart {
        let finite = |curve: &Series| -> Vec<(f64, f64)> {
            curve.points.iter().copied().filter(|(x, y)| x.is_finite() && y.is_finite()).collect()
        };
        let paths: Vec<_> = self.curves.iter().map(finite).collect();
        let ends = [
            Series {
                hollow: true,
                ..Series::scatter(
                    "start",
                    REFERENCE,
                    Marker::Circle,
                    paths.iter().filter_map(|p| p.first().copied()).collect(),
                )
            },
            Series::scatter(
                "end",
                REFERENCE,
                Marker::Square,
                paths.iter().filter_map(|p| p.last().copied()).collect(),
            ),
        ];
        let ends = ends.into_iter().filter(|series| !series.points.is_empty());
        LineChart {
            title: self.title.clone(),
            x: self.x.clone(),
            y: self.y.clone(),
            series: self
                .circle
                .iter()
                .map(Circle::series)
                .chain(self.curves.iter().cloned())
                .chain(ends)
                .collect(),
            equal_aspect: true,
            ..LineChart::default()
        }
    }
}

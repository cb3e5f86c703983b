//! A series of points with one look.

use crate::canvas::Canvas;
use crate::geometry::{Point, clip, thin};
use crate::legend::{Entry, Sample};
use crate::marker::{Marker, Once};
use crate::stroke::Stroke;
use crate::style::palette;
use crate::view::View;

/// Points in the order in which they are joined.
///
/// A point that is not finite, or not positive on a logarithmic axis, is left out and interrupts the line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// What the legend says; empty for no entry.
    pub label: String,
    /// Index into the palette of [`PALETTE_LEN`](crate::PALETTE_LEN) colours.
    pub color: usize,
    /// How the line is drawn.
    pub stroke: Stroke,
    /// The sign at each point.
    pub marker: Marker,
    /// Only the outline of each marker; a cross and a dot look the same either way.
    pub hollow: bool,
    /// x and y.
    pub points: Vec<(f64, f64)>,
}

impl Series {
    /// A solid line without markers.
    pub fn line(label: impl Into<String>, color: usize, points: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), color, points, ..Self::default() }
    }

    /// A solid line with filled markers.
    pub fn filled(
        label: impl Into<String>,
        color: usize,
        marker: Marker,
        points: Vec<(f64, f64)>,
    ) -> Self {
        Self { marker, ..Self::line(label, color, points) }
    }

    /// A dashed line with hollow markers: the other variant of a filled series.
    pub fn hollow(
        label: impl Into<String>,
        color: usize,
        marker: Marker,
        points: Vec<(f64, f64)>,
    ) -> Self {
        Self { stroke: Stroke::Dashed, hollow: true, ..Self::filled(label, color, marker, points) }
    }

    /// Markers without a line.
    pub fn scatter(
        label: impl Into<String>,
        color: usize,
        marker: Marker,
        points: Vec<(f64, f64)>,
    ) -> Self {
        Self { stroke: Stroke::None, ..Self::filled(label, color, marker, points) }
    }

    pub(crate) fn entry(&self) -> Entry {
        let sample = Sample::Series {
            color: palette(self.color),
            stroke: self.stroke,
            marker: self.marker,
            hollow: self.hollow,
        };
        Entry { label: self.label.clone(), sample }
    }

    pub(crate) fn draw(&self, view: &View, canvas: &mut Canvas) {
        let placed: Vec<Option<Point>> =
            self.points.iter().map(|&point| view.place(point)).collect();
        if self.stroke != Stroke::None {
            for run in placed.split(Option::is_none) {
                let run: Vec<Point> = run.iter().copied().flatten().collect();
                for part in clip(&thin(&run), &view.plot) {
                    self.stroke.draw(&part, palette(self.color), canvas);
                }
            }
        }
        let mut once = Once::new(self.marker);
        for point in placed.into_iter().flatten().filter(|&point| view.plot.contains(point)) {
            if self.marker != Marker::None && once.is_first(point) {
                self.marker.draw(point, palette(self.color), self.hollow, canvas);
            }
        }
    }
}

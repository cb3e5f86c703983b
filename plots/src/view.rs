//! A plot area with the spans of its axes: where values are drawn.

use crate::axis::Span;
use crate::geometry::{Point, Rect};

/// Maps values to places.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    pub(crate) plot: Rect,
    pub(crate) x: Span,
    pub(crate) y: Span,
}

impl View {
    /// Where a point lies, in the plot area or outside, if it can be shown.
    pub(crate) fn place(&self, (x, y): Point) -> Option<Point> {
        Some(self.plot.at((self.x.fraction(x)?, self.y.fraction(y)?)))
    }

    /// Where a value of x lies, if inside.
    pub(crate) fn across(&self, x: f64) -> Option<f64> {
        let at = self.x.fraction(x).filter(|at| (0.0..=1.0).contains(at))?;
        Some(self.plot.at((at, 0.0)).0)
    }

    /// Where a value of y lies, if inside.
    pub(crate) fn up(&self, y: f64) -> Option<f64> {
        let at = self.y.fraction(y).filter(|at| (0.0..=1.0).contains(at))?;
        Some(self.plot.at((0.0, at)).1)
    }

    /// The visible part of an interval of x.
    pub(crate) fn band(&self, (from, to): (f64, f64)) -> Option<Rect> {
        let (a, b) = (self.x.fraction(from)?, self.x.fraction(to)?);
        let (left, right) = (a.min(b).max(0.0), a.max(b).min(1.0));
        let at = |part: f64| self.plot.at((part, 0.0)).0;
        (left < right).then(|| Rect { left: at(left), right: at(right), ..self.plot })
    }

    /// The visible part of a bar from zero, or from the lower end of a logarithmic axis, to a value above or below.
    pub(crate) fn bar(&self, sides: (f64, f64), value: f64) -> Option<Rect> {
        let clamped = |at: f64| self.plot.at((0.0, at.clamp(0.0, 1.0))).1;
        let base = clamped(self.y.fraction(0.0).unwrap_or(0.0));
        let end = clamped(self.y.fraction(value)?);
        let rect = Rect { top: end.min(base), bottom: end.max(base), ..self.band(sides)? };
        (rect.top < rect.bottom).then_some(rect)
    }

    /// The visible part of the area between two curves: its lower and its upper edge, from left to right.
    pub(crate) fn ribbon(&self, points: &[(f64, f64, f64)]) -> [Vec<Point>; 2] {
        let edge = |y: fn(&(f64, f64, f64)) -> f64| -> Vec<Point> {
            let inside = points.iter().filter_map(|point| Some((self.across(point.0)?, y(point))));
            // What lies below a logarithmic axis lies at its lower end.
            let height = |y: f64| self.y.fraction(y).unwrap_or(0.0).clamp(0.0, 1.0);
            inside.map(|(x, y)| (x, self.plot.at((0.0, height(y))).1)).collect()
        };
        [edge(|point| point.1), edge(|point| point.2)]
    }

    /// Where vertical lines stand, at most one each half pixel.
    pub(crate) fn columns(&self, values: &[f64]) -> Vec<f64> {
        let mut places: Vec<f64> = values.iter().filter_map(|&x| self.across(x)).collect();
        places.sort_by(f64::total_cmp);
        places.dedup_by(|b, a| *b - *a < 0.5);
        places
    }
}

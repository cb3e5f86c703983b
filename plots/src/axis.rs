//! Axes: what is written along them, how they are scaled, which values they cover.

use crate::error::Error;

/// How values are laid out along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences take equal lengths.
    #[default]
    Linear,
    /// Equal ratios take equal lengths; only positive values are shown.
    Log,
}

/// Values of larger magnitude are left out; on a logarithmic axis values below its inverse, too.
const LARGEST: f64 = 1e300;
/// Room that is left between the data and the ends of an axis.
pub(crate) const ROOM: f64 = 0.04;
/// A span narrower than this part of its values is widened: it could not be labelled.
const NARROWEST: f64 = 1e-11;

impl Scale {
    /// Whether a value has a place on such an axis: no infinite or larger one than 1e300, and on a logarithmic axis only a
    /// positive one.
    pub fn shows(self, value: f64) -> bool {
        self.coordinate(value).is_some()
    }

    /// The coordinate (the value, or its logarithm) of a value that can be shown.
    pub(crate) fn coordinate(self, value: f64) -> Option<f64> {
        match self {
            Scale::Linear => (value.abs() <= LARGEST).then_some(value),
            Scale::Log => (1.0 / LARGEST..=LARGEST).contains(&value).then(|| libm::log10(value)),
        }
    }
}

/// An axis of a chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Quantity and unit, `t [s]`.
    pub label: String,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// Values at both ends; without them the axis covers the data and a little more.
    pub range: Option<(f64, f64)>,
    /// Names of the places 0, 1, … in the order of the axis; none where it has numbers. A named axis is linear, has room
    /// for each of its places, and no range.
    pub names: Vec<String>,
}

impl Axis {
    /// A linear axis that covers the data.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), ..Self::default() }
    }

    /// A logarithmic axis that covers the data.
    pub fn log(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Log, ..Self::default() }
    }

    /// An axis of named places.
    pub fn named(label: impl Into<String>, names: Vec<String>) -> Self {
        Self { label: label.into(), names, ..Self::default() }
    }

    /// This axis from `lo` to `hi`; what lies outside is cut off.
    #[must_use]
    pub fn within(self, lo: f64, hi: f64) -> Self {
        Self { range: Some((lo, hi)), ..self }
    }

    /// The span to draw for data with these values, with `room` at both ends (a part of the span).
    pub(crate) fn span(&self, values: impl Iterator<Item = f64>, room: f64) -> Result<Span, Error> {
        let scale = self.scale;
        if !self.names.is_empty() {
            return Ok(Span { scale: Scale::Linear, lo: -0.5, hi: self.names.len() as f64 - 0.5 });
        }
        if let Some((lo, hi)) = self.range {
            return match (scale.coordinate(lo), scale.coordinate(hi)) {
                (Some(a), Some(b)) if b - a > NARROWEST * a.abs().max(b.abs()) => {
                    Ok(Span { scale, lo: a, hi: b })
                }
                _ => Err(Error::Range { axis: self.label.clone(), lo, hi }),
            };
        }
        let (lo, hi) = values
            .filter_map(|value| scale.coordinate(value))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), c| (lo.min(c), hi.max(c)));
        Ok(Span { scale, lo, hi }.padded(room))
    }
}

/// Both ends of an axis, as coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    pub(crate) scale: Scale,
    pub(crate) lo: f64,
    pub(crate) hi: f64,
}

impl Span {
    /// Leaves room at both ends; widens what is too narrow to be labelled; 0 to 1 if there is nothing.
    fn padded(self, room: f64) -> Self {
        if self.lo > self.hi {
            return Self { lo: 0.0, hi: 1.0, ..self };
        }
        let magnitude = self.lo.abs().max(self.hi.abs());
        let room = if self.hi - self.lo > NARROWEST * magnitude {
            room * (self.hi - self.lo)
        } else {
            match self.scale {
                Scale::Linear if magnitude > 0.0 => 0.1 * magnitude,
                Scale::Linear => 1.0,
                Scale::Log => 0.5,
            }
        };
        Self { lo: self.lo - room, hi: self.hi + room, ..self }
    }

    /// Where a value lies between the ends, from 0 to 1; outside of that for values beyond them.
    pub(crate) fn fraction(&self, value: f64) -> Option<f64> {
        self.scale.coordinate(value).map(|c| (c - self.lo) / (self.hi - self.lo))
    }

    /// The values at both ends.
    pub(crate) fn ends(&self) -> (f64, f64) {
        match self.scale {
            Scale::Linear => (self.lo, self.hi),
            Scale::Log => (libm::exp10(self.lo), libm::exp10(self.hi)),
        }
    }

    /// The span that covers both.
    pub(crate) fn union(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi), ..self }
    }

    /// The same centre with another width.
    pub(crate) fn with_width(self, width: f64) -> Self {
        let center = (self.lo + self.hi) / 2.0;
        Self { lo: center - width / 2.0, hi: center + width / 2.0, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_value_is_given_room() {
        let span = Axis::linear("x").span([3.0].into_iter(), ROOM).unwrap();
        assert!(span.lo < 3.0 && span.hi > 3.0);
        let span = Axis::log("x").span([1e-9].into_iter(), ROOM).unwrap();
        assert_eq!((span.lo, span.hi), (-9.5, -8.5));
    }

    #[test]
    fn what_cannot_be_shown_does_not_widen_the_axis() {
        let values = [1.0, f64::NAN, f64::INFINITY, -5.0, 0.0, 100.0];
        let span = Axis::log("x").span(values.into_iter(), ROOM).unwrap();
        assert!((span.lo + 0.08).abs() < 1e-12 && (span.hi - 2.08).abs() < 1e-12);
    }

    #[test]
    fn impossible_ranges_are_errors() {
        let none = std::iter::empty;
        for (lo, hi) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            assert!(Axis::linear("x").within(lo, hi).span(none(), ROOM).is_err(), "{lo} {hi}");
        }
        assert!(Axis::log("x").within(0.0, 1.0).span(none(), ROOM).is_err());
    }
}

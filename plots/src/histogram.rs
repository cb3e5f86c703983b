//! Histograms: bars over common bins, those of several groups beside each other in each bin.

use crate::axis::{Axis, Scale};
use crate::line::{Bars, LineChart};

/// Part of a bin's width that its bars take together.
const FILLED: f64 = 0.9;

/// The counts of one group.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// What the legend says.
    pub label: String,
    /// Index into the palette.
    pub color: usize,
    /// One count a bin.
    pub counts: Vec<f64>,
}

/// A histogram of one quantity in several groups.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Histogram {
    /// Written above the panel.
    pub title: String,
    /// The quantity.
    pub x: Axis,
    /// The count; on a logarithmic axis bars stand on its lower end, else on zero.
    pub y: Axis,
    /// Lower and upper end of each bin.
    pub bins: Vec<(f64, f64)>,
    /// The groups, drawn from left to right in each bin.
    pub groups: Vec<Group>,
}

impl Histogram {
    pub(crate) fn chart(&self) -> LineChart {
        let n = self.groups.len().max(1) as f64;
        let bars = self.groups.iter().enumerate().map(|(i, group)| Bars {
            label: group.label.clone(),
            color: group.color,
            bars: self
                .bins
                .iter()
                .zip(&group.counts)
                .filter(|(_, count)| **count > 0.0)
                .map(|(bin, count)| (self.part(*bin, i as f64 / n, (i + 1) as f64 / n), *count))
                .collect(),
        });
        LineChart {
            title: self.title.clone(),
            x: self.x.clone(),
            y: self.y.clone(),
            bars: bars.collect(),
            ..LineChart::default()
        }
    }

    /// The part of a bin's filled width from one fraction to another, as the axis scales it.
    fn part(&self, (lo, hi): (f64, f64), from: f64, to: f64) -> (f64, f64) {
        let at = |fraction: f64| {
            let fraction = 0.5 + FILLED * (fraction - 0.5);
            match self.x.scale {
                Scale::Linear => lo + fraction * (hi - lo),
                Scale::Log => lo * libm::pow(hi / lo, fraction),
            }
        };
        (at(from), at(to))
    }
}

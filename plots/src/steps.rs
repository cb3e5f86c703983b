//! Step histories: the step size over time.

use crate::axis::Axis;
use crate::line::{Band, LineChart};
use crate::marker::Marker;
use crate::series::Series;
use crate::stroke::Stroke;

/// How the accepted steps are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StepLook {
    /// A dot at the start of each step.
    #[default]
    Dots,
    /// A line as long as each step at the height of its size.
    Stairs,
}

/// The step sizes that a method chose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepHistory {
    /// Written above the panel: the method.
    pub title: String,
    /// Time.
    pub t: Axis,
    /// Step size, usually on a logarithmic axis.
    pub h: Axis,
    /// Start and size of each accepted step.
    pub accepted: Vec<(f64, f64)>,
    /// Start and size of each rejected step, drawn as crosses.
    pub rejected: Vec<(f64, f64)>,
    /// Times of events, drawn as ticks at the upper border.
    pub events: Vec<f64>,
    /// Shaded intervals of time: modes.
    pub bands: Vec<Band>,
    /// Index into the palette, for the accepted steps.
    pub color: usize,
    /// How the accepted steps are drawn.
    pub look: StepLook,
}

/// Palette index of the rejected steps.
const REJECTED: usize = 6;

impl StepHistory {
    pub(crate) fn chart(&self) -> LineChart {
        let accepted = match self.look {
            StepLook::Dots => Series::scatter("", self.color, Marker::Dot, self.accepted.clone()),
            StepLook::Stairs => Series::line("", self.color, self.stairs()),
        };
        let rejected = Series {
            label: if self.rejected.is_empty() { String::new() } else { "rejected step".into() },
            color: REJECTED,
            stroke: Stroke::None,
            marker: Marker::Cross,
            points: self.rejected.clone(),
            ..Series::default()
        };
        LineChart {
            title: self.title.clone(),
            x: self.t.clone(),
            y: self.h.clone(),
            series: vec![accepted, rejected],
            bands: self.bands.clone(),
            ticks: self.events.clone(),
            ticks_label: "event".into(),
            ..LineChart::default()
        }
    }

    fn stairs(&self) -> Vec<(f64, f64)> {
        self.accepted.iter().flat_map(|&(t, h)| [(t, h), (t + h, h)]).collect()
    }
}

//! Step size over time, a panel a method.

use deltazero_plots::{Axis, Figure, Panel, StepHistory as Chart, StepLook};

use super::Drawing;
use crate::study::step_size::StepHistory;

/// Step size of each method on joint 1 over time, events as ticks.
pub(super) fn drawing(histories: &[StepHistory]) -> Drawing {
    let panel = |(color, history): (usize, &StepHistory)| -> Panel {
        Chart {
            title: history.title.clone(),
            t: Axis::linear("t [s]"),
            h: Axis::log("h [s]"),
            accepted: history.steps.clone(),
            events: history.events.clone(),
            color,
            look: StepLook::Dots,
            ..Chart::default()
        }
        .into()
    };
    let panels = histories.iter().enumerate().map(panel).collect();
    let spreads: Vec<String> = histories.iter().map(spread).collect();
    let caption = format!(
        "Accepted steps on joint 1 over time, events located (ticks). {}.",
        spreads.join("; ")
    );
    Drawing { name: "step_size", caption, figure: Figure::stacked("Step size over time", panels) }
}

fn spread(history: &StepHistory) -> String {
    let mut sizes: Vec<f64> = history.steps.iter().map(|(_, h)| *h).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let at = |fraction: f64| {
        let last = sizes.len().saturating_sub(1) as f64;
        sizes.get((fraction * last) as usize).copied().unwrap_or(f64::NAN)
    };
    format!(
        "{}: {} steps, nine in ten between {:.1e} and {:.1e} s",
        history.title,
        sizes.len(),
        at(0.05),
        at(0.95)
    )
}

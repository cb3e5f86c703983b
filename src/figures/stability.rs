//! The error of rk4 around its limit of stability.

use deltazero_plots::{Axis, Figure, LineChart, Marker, Panel, Series, Size, Upright};
use deltazero_study::steps::step_size::ACCURACY;

use super::Drawing;
use crate::study::stability::{Stability, StepErrorRow, StiffnessRow};

/// Name of its files.
pub(super) const NAME: &str = "rk4_stability";

/// `e` and the events of each joint against its step over the contact's time scale.
pub(super) fn drawing(stability: &Stability) -> Drawing {
    let runs = |joint: usize| stability.runs.iter().filter(move |run| run.joint == joint);
    let mut uprights = vec![Upright { x: 1.0, label: "√(m/K)".into() }];
    let (mut errors, mut events) = (Vec::new(), Vec::new());
    for (color, row) in stability.stiffness.iter().enumerate() {
        let over = |h: f64| h / row.time_scale_s;
        let curve = |points| {
            Series::filled(format!("joint {}", row.joint), color, Marker::cycle(color), points)
        };
        // What is not a number ends a line: a run that broke off is a gap.
        let error = |run: &StepErrorRow| (over(run.h_s), run.e.unwrap_or(f64::NAN));
        errors.push(curve(runs(row.joint).map(error).collect()));
        let count = |run: &StepErrorRow| (over(run.h_s), finished_events(run));
        events.push(curve(runs(row.joint).map(count).collect()));
        // Joints that differ by less than a tenth of the time scale share a line.
        let label = format!("stability limit {:.1} √(m/K)", over(row.limit_s));
        if !uprights.iter().any(|known| known.label == label) {
            uprights.push(Upright { x: over(row.limit_s), label });
        }
    }
    let findings: Vec<String> = stability
        .stiffness
        .iter()
        .map(|row| finding(row, &runs(row.joint).collect::<Vec<_>>()))
        .collect();
    let caption = format!(
        "Error e of rk4 against its step, events located, in units of √(m/K) = 1/ω, ω the highest \
         natural frequency of the undamped contact over the run. {}.{}",
        findings.join("; "),
        gaps(&stability.runs)
    );
    let panel = |y: Axis, series: Vec<Series>, uprights: Vec<Upright>| -> Panel {
        let x = Axis::log("step over time scale of the contact, h / √(m/K)");
        LineChart { x, y, series, uprights, ..LineChart::default() }.into()
    };
    let unnamed = uprights.iter().map(|known| Upright { label: String::new(), ..*known }).collect();
    let panels = vec![
        panel(Axis::log("error e of the joint"), errors, uprights),
        panel(Axis::log("events found"), events, unnamed),
    ];
    let figure = Figure {
        size: Size { width: 760, height: 720 },
        ..Figure::stacked("rk4: where stability binds", panels)
    };
    Drawing { name: NAME, caption, figure }
}

/// The events of a run that came to its end.
fn finished_events(run: &StepErrorRow) -> f64 {
    run.e.map_or(f64::NAN, |_| run.n_events as f64)
}

/// How many runs are not shown.
fn gaps(runs: &[StepErrorRow]) -> String {
    match runs.iter().filter(|run| run.e.is_none()).count() {
        0 => String::new(),
        1 => format!(" Of {} runs 1 broke off and is a gap.", runs.len()),
        n => format!(" Of {} runs {n} broke off and are gaps.", runs.len()),
    }
}

fn finding(row: &StiffnessRow, runs: &[&StepErrorRow]) -> String {
    let reaching = runs.iter().filter(|run| run.e.is_some_and(|e| e <= ACCURACY));
    let bound = match reaching.map(|run| run.h_s).reduce(f64::max) {
        Some(h) => {
            format!("e ≤ {ACCURACY:e} needs h = {h:.1e} s, {:.1} times below", row.limit_s / h)
        }
        None => format!("none of these runs has e ≤ {ACCURACY:e}"),
    };
    let at = |run: Option<&&StepErrorRow>| match run {
        Some(StepErrorRow { e: Some(e), n_events, .. }) => {
            format!("e = {e:.1e} and {n_events} events")
        }
        _ => "no finished run".to_owned(),
    };
    let (least, largest) = row.omega_rad_s;
    format!(
        "Joint {}: ω from {least:.0} to {largest:.0} rad/s, √(m/K) = {:.2e} s, limit of the damped \
         spectrum {:.2e} s = {:.2} √(m/K); at the limit {}, at the next step beyond {}; {bound}",
        row.joint,
        row.time_scale_s,
        row.limit_s,
        row.limit_s / row.time_scale_s,
        at(runs.iter().rfind(|run| run.h_s <= row.limit_s)),
        at(runs.iter().find(|run| run.h_s > row.limit_s)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_that_broke_off_is_a_gap() {
        let run = |h_s: f64, e: Option<f64>| StepErrorRow { joint: 1, h_s, e, n_events: 1 };
        let stability = Stability {
            stiffness: vec![StiffnessRow {
                joint: 1,
                n_samples: 1,
                omega_rad_s: (1e3, 1e3),
                time_scale_s: 1e-3,
                limit_s: 3e-3,
            }],
            runs: vec![run(1e-3, Some(1e-6)), run(2e-3, Some(1e-5)), run(4e-3, None)],
        };
        let Drawing { figure, caption, .. } = drawing(&stability);
        for panel in &figure.panels {
            let Panel::Line(LineChart { series, .. }) = panel else { panic!("{panel:?}") };
            let shown: Vec<bool> = series[0].points.iter().map(|(_, y)| !y.is_nan()).collect();
            assert_eq!(shown, [true, true, false]);
        }
        assert!(caption.ends_with("Of 3 runs 1 broke off and is a gap."), "{caption}");
    }
}

//! The first steps after an event, a panel a method.

use deltazero_plots::{Axis, Level, LineChart, Marker, Panel, Series};
use deltazero_study::steps::restarts::{FIRST, RestartCost, RestartRow};
use deltazero_study::steps::step_size::ModeKind;

use super::{Drawing, in_threes, kind_color};

/// Shift of what follows events into flight, so that whiskers do not hide each other.
const ASIDE: f64 = 0.25;

/// Steps below which there are no quartiles to speak of.
const LEAST: usize = 3;

/// Median and quartiles of the first ten steps after an event over the settled step.
pub(super) fn drawing(rows: &[RestartRow], costs: &[RestartCost]) -> Drawing {
    let panel = |cost: &RestartCost| -> Panel {
        let own: Vec<&RestartRow> = rows.iter().filter(|row| row.method == cost.method).collect();
        LineChart {
            title: format!("{}, {}", cost.method, cost.setting),
            x: Axis::linear("step after the event").within(0.5, FIRST as f64 + 0.5),
            y: Axis::log("h over settled h"),
            series: [true, false].into_iter().flat_map(|into| series(&own, into)).collect(),
            levels: vec![Level { y: 1.0, label: String::new() }],
            ..LineChart::default()
        }
        .into()
    };
    let panels: Vec<Panel> = costs.iter().map(panel).collect();
    let findings: Vec<String> = costs.iter().map(finding).collect();
    let over = match costs.iter().map(|cost| cost.n_events).max() {
        Some(most) if most > LEAST => format!("{LEAST} to {most}"),
        _ => LEAST.to_string(),
    };
    let caption = format!(
        "Step size after an event over the settled one (median of the steps more than ten after an \
         event): median and quartiles over {over} events, steps that land on \
         the next event left out. Right-hand sides that an event costs, without Jacobians and linear \
         algebra: {}.",
        findings.join("; ")
    );
    let figure = in_threes("After a restart", panels);
    Drawing { name: "restarts", caption, figure }
}

/// Medians as markers, quartiles as whiskers.
fn series(own: &[&RestartRow], into_contact: bool) -> [Series; 2] {
    let (kind, marker, label, aside) = if into_contact {
        (ModeKind::Slip, Marker::Circle, "into contact", -0.5 * ASIDE)
    } else {
        (ModeKind::Flight, Marker::Square, "into flight", 0.5 * ASIDE)
    };
    let (mut medians, mut whiskers) = (Vec::new(), Vec::new());
    for row in own.iter().filter(|row| row.into_contact == into_contact && row.n >= LEAST) {
        let x = row.step as f64 + aside;
        let [low, median, high] = row.h_over_settled;
        medians.push((x, median));
        // What is not a number ends a line.
        whiskers.extend([(x, low), (x, high), (x, f64::NAN)]);
    }
    let color = kind_color(kind);
    [Series::line("", color, whiskers), Series::scatter(label, color, marker, medians)]
}

fn finding(cost: &RestartCost) -> String {
    let number = |n: Option<f64>| n.map_or_else(|| "–".to_owned(), |n| format!("{n:.0}"));
    format!(
        "{} {:.0} ({:.1} to begin, {:.1} to locate; {} steps to half the settled size, {} steps lost, {:.1} \
         rejected, at {:.1} each)",
        cost.method,
        cost.rhs_event(),
        cost.rhs_restart,
        cost.rhs_location,
        number(cost.recovery_steps),
        number(cost.lost_steps),
        cost.rejected,
        cost.rhs_step
    )
}

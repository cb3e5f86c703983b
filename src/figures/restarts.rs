//! The first steps after an event, a panel a method.

use deltazero_plots::{Axis, Level, LineChart, Marker, Panel, Series};
use deltazero_study::digits::count_of;
use deltazero_study::steps::restarts::{FIRST, RestartCost, RestartRow};
use deltazero_study::steps::step_size::ModeKind;

use super::modes::look;
use super::{Drawing, in_threes};

/// Shift of what follows events into one mode from that of the next, so that whiskers do not hide each other; and of the
/// last from the first, at most.
const ASIDE: f64 = 0.25;
const WIDEST: f64 = 0.7;

/// Steps below which there are no quartiles to speak of.
const LEAST: usize = 3;

/// Median and quartiles of the first ten steps after an event over the settled step.
pub(super) fn drawing(rows: &[RestartRow], costs: &[RestartCost], modes: &[String]) -> Drawing {
    let entered = entered(rows, modes);
    let panel = |cost: &RestartCost| -> Panel {
        let own: Vec<&RestartRow> = rows.iter().filter(|row| row.method == cost.method).collect();
        LineChart {
            title: format!("{}, {}", cost.method, cost.setting),
            x: Axis::linear("step after the event").within(0.5, FIRST as f64 + 0.5),
            y: Axis::log("h over settled h"),
            series: (0..entered.len()).flat_map(|i| series(&own, &entered, i, modes)).collect(),
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

/// What events lead into: contact and flight, or those of the modes that have names and rows to speak of.
fn entered<'a>(rows: &'a [RestartRow], modes: &'a [String]) -> Vec<&'a str> {
    if modes.is_empty() {
        return vec!["contact", "flight"];
    }
    let is_told = |mode: &&String| rows.iter().any(|row| row.mode == **mode && row.n >= LEAST);
    modes.iter().filter(is_told).map(String::as_str).collect()
}

/// Medians as markers, quartiles as whiskers, of the steps after events into one of the modes `entered`.
fn series(own: &[&RestartRow], entered: &[&str], i: usize, modes: &[String]) -> [Series; 2] {
    let n = entered.len();
    let aside = ASIDE.min(WIDEST / n as f64) * (i as f64 - 0.5 * (n - 1) as f64);
    let (mut medians, mut whiskers) = (Vec::new(), Vec::new());
    for row in own.iter().filter(|row| row.mode == entered[i] && row.n >= LEAST) {
        let x = row.step as f64 + aside;
        let [low, median, high] = row.h_over_settled;
        medians.push((x, median));
        // What is not a number ends a line.
        whiskers.extend([(x, low), (x, high), (x, f64::NAN)]);
    }
    let kind = if entered[i] == "contact" { ModeKind::Contact } else { ModeKind::Flight };
    let (name, color) = look(modes, entered[i], kind);
    let label = format!("into {name}");
    [Series::line("", color, whiskers), Series::scatter(label, color, Marker::cycle(i), medians)]
}

fn finding(cost: &RestartCost) -> String {
    let steps = |n: Option<f64>| match n {
        Some(n) => count_of(n.round_ties_even(), "step"),
        None => "– steps".to_owned(),
    };
    format!(
        "{} {:.0} ({:.1} to begin, {:.1} to locate; {} to half the settled size, {} lost, {:.1} \
         rejected, at {:.1} each)",
        cost.method,
        cost.rhs_event(),
        cost.rhs_restart,
        cost.rhs_location,
        steps(cost.recovery_steps),
        steps(cost.lost_steps),
        cost.rejected,
        cost.rhs_step
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_step_is_told_as_one() {
        let cost = RestartCost {
            method: "bdf".into(),
            setting: String::new(),
            n_events: 3,
            settled_s: Vec::new(),
            recovery_steps: Some(1.0),
            lost_steps: None,
            rejected: 0.0,
            rhs_restart: 0.0,
            rhs_location: 0.0,
            rhs_step: 0.0,
        };
        let told = finding(&cost);
        assert!(told.contains("; 1 step to half the settled size, – steps lost,"), "{told}");
    }
}

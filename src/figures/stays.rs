//! Steps in each contact and flight against how long it lasts.

use deltazero_plots::{Axis, Figure, Guide, LineChart, Marker, Series, Size};
use deltazero_study::quantile::quantile;
use deltazero_study::steps::stays::StayRow;

use super::{Drawing, number};

/// Steps per contact (filled) and per flight (hollow) of each method; what the end of the run cuts
/// is left out, and what the run starts in.
pub(super) fn drawing(rows: &[StayRow]) -> Drawing {
    let counted = |row: &&StayRow| row.is_whole && row.t_s > 0.0;
    let whole: Vec<&StayRow> = rows.iter().filter(counted).collect();
    let mut methods: Vec<&str> = Vec::new();
    for row in &whole {
        if !methods.contains(&row.method.as_str()) {
            methods.push(&row.method);
        }
    }
    let mut series = Vec::new();
    for is_contact in [true, false] {
        for method in &methods {
            let own =
                whole.iter().filter(|row| row.method == *method && row.is_contact == is_contact);
            let points = own.map(|row| (row.duration_s, row.n_steps as f64)).collect();
            let (color, kind) = (number(method), kind(is_contact));
            let label = format!("{method}, {kind}");
            let marks = Series::scatter(label, color, Marker::cycle(color), points);
            series.push(Series { hollow: !is_contact, ..marks });
        }
    }
    let findings: Vec<String> = methods.iter().map(|method| finding(&whole, method)).collect();
    let medians = match findings[..] {
        [] => "No contact begins and ends within the run".to_owned(),
        _ => format!("Median {}", findings.join("; ")),
    };
    let caption = format!(
        "Accepted steps in each whole contact (filled; slip reversals and sticks belong to it) and \
         flight (hollow) over its duration, those at both ends of the run left out; \
         dashed: a constant step. {medians}."
    );
    let guides = guide(&whole).into_iter().collect();
    let chart = LineChart {
        x: Axis::log("duration of the contact or flight [s]"),
        y: Axis::log("accepted steps in it"),
        series,
        guides,
        ..LineChart::default()
    };
    let figure = Figure { size: Size::WIDE, ..Figure::single("Steps per contact", chart) };
    Drawing { name: "steps_per_contact", caption, figure }
}

fn kind(is_contact: bool) -> &'static str {
    if is_contact { "contact" } else { "flight" }
}

/// A constant step: that of the contact with the fewest steps.
fn guide(whole: &[&StayRow]) -> Option<Guide> {
    let contacts = whole.iter().filter(|row| row.is_contact && row.n_steps > 1);
    let longest = contacts.max_by(|a, b| a.mean_step().total_cmp(&b.mean_step()))?;
    let through = (longest.duration_s, longest.n_steps as f64);
    let label = format!("h = {:.1e} s", longest.mean_step());
    Some(Guide { slope: 1.0, through, span: None, label })
}

/// Median steps and mean step of a method in contacts and in flights.
fn finding(whole: &[&StayRow], method: &str) -> String {
    let median = |is_contact: bool| {
        let own = whole.iter().filter(|row| row.method == method && row.is_contact == is_contact);
        let mut steps: Vec<f64> = own.map(|row| row.n_steps as f64).collect();
        let n = steps.len();
        let median = quantile(&mut steps, 0.5)?;
        Some(format!("{median} in {n} {}s", kind(is_contact)))
    };
    let medians: Vec<String> = [true, false].into_iter().filter_map(median).collect();
    format!("{method}: {}", medians.join(", "))
}

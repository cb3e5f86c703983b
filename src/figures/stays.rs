//! Steps in each contact and flight, or stay in a mode that has a name, against how long it lasts.

use deltazero_plots::{Axis, Figure, Guide, LineChart, Marker, Panel, Series, Size};
use deltazero_study::digits::count_of;
use deltazero_study::quantile::quantile;
use deltazero_study::steps::stays::StayRow;

use super::modes::quoted;
use super::{Drawing, in_threes, number};

/// Name of its files.
pub(super) const NAME: &str = "steps_per_contact";

/// Modes that have a panel, at most.
const MOST_MODES: usize = 9;

/// Steps per contact (filled) and per flight (hollow) of each method, or per stay in each of `modes`, which have names;
/// what the end of the run cuts is left out, and what the run starts in.
pub(super) fn drawing(rows: &[StayRow], modes: &[String]) -> Drawing {
    let whole: Vec<&StayRow> = rows.iter().filter(|row| row.is_whole).collect();
    let mut methods: Vec<&str> = Vec::new();
    for row in &whole {
        if !methods.contains(&row.method.as_str()) {
            methods.push(&row.method);
        }
    }
    if !modes.is_empty() {
        return by_mode(&whole, &methods, modes);
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
    let guides = guide(whole.iter().copied().filter(|row| row.is_contact)).into_iter().collect();
    let chart = LineChart {
        x: Axis::log("duration of the contact or flight [s]"),
        y: Axis::log("accepted steps in it"),
        series,
        guides,
        ..LineChart::default()
    };
    let figure = Figure { size: Size::WIDE, ..Figure::single("Steps per contact", chart) };
    Drawing { name: NAME, caption, figure }
}

/// A panel for each of the modes that are stayed in.
fn by_mode(whole: &[&StayRow], methods: &[&str], modes: &[String]) -> Drawing {
    let is_stayed_in = |mode: &&String| whole.iter().any(|row| row.mode == **mode);
    let stayed_in: Vec<&String> = modes.iter().filter(is_stayed_in).collect();
    let shown = &stayed_in[..stayed_in.len().min(MOST_MODES)];
    let panel = |mode: &&String| -> Panel {
        let own = || whole.iter().copied().filter(|row| row.mode == **mode);
        let series = methods.iter().map(|method| {
            let rows = own().filter(|row| row.method == *method);
            let points = rows.map(|row| (row.duration_s, row.n_steps as f64)).collect();
            let color = number(method);
            Series::scatter(*method, color, Marker::cycle(color), points)
        });
        LineChart {
            title: format!("in {}", quoted([*mode])),
            x: Axis::log("duration of the stay [s]"),
            y: Axis::log("accepted steps in it"),
            series: series.collect(),
            guides: guide(own()).into_iter().collect(),
            ..LineChart::default()
        }
        .into()
    };
    let finding = |method: &&str| {
        let told = |mode: &&String| {
            let is_own = |row: &&&StayRow| row.method == *method && row.mode == **mode;
            let (median, n) = median(whole.iter().filter(is_own))?;
            Some(format!("{median} in {} in {}", count_of(n, "stay"), quoted([*mode])))
        };
        let told: Vec<String> = shown.iter().filter_map(told).collect();
        format!("{method}: {}", told.join(", "))
    };
    let findings: Vec<String> = methods.iter().map(finding).collect();
    let left_out = match stayed_in.len() - shown.len() {
        0 => String::new(),
        n => format!(" Not shown: {}.", count_of(n, "further mode")),
    };
    let caption = format!(
        "Accepted steps in each whole stay in a mode, from one event to the next, over its duration, those at both ends \
         of the run left out; dashed: a constant step. Median {}.{left_out}",
        findings.join("; ")
    );
    let panels = shown.iter().map(panel).collect();
    Drawing { name: NAME, caption, figure: in_threes("Steps per stay", panels) }
}

fn kind(is_contact: bool) -> &'static str {
    if is_contact { "contact" } else { "flight" }
}

/// A constant step: that of the stay with the fewest steps.
fn guide<'a>(stays: impl Iterator<Item = &'a StayRow>) -> Option<Guide> {
    let stays = stays.filter(|row| row.n_steps > 1);
    let longest = stays.max_by(|a, b| a.mean_step().total_cmp(&b.mean_step()))?;
    let through = (longest.duration_s, longest.n_steps as f64);
    let label = format!("h = {:.1e} s", longest.mean_step());
    Some(Guide { slope: 1.0, through, span: None, label })
}

/// Median steps and mean step of a method in contacts and in flights.
fn finding(whole: &[&StayRow], method: &str) -> String {
    let told = |is_contact: bool| {
        let own = |row: &&&StayRow| row.method == method && row.is_contact == is_contact;
        let (median, n) = median(whole.iter().filter(own))?;
        Some(format!("{median} in {}", count_of(n, kind(is_contact))))
    };
    let medians: Vec<String> = [true, false].into_iter().filter_map(told).collect();
    format!("{method}: {}", medians.join(", "))
}

/// Median steps of these stays, and their number.
fn median<'a>(stays: impl Iterator<Item = &'a &'a StayRow>) -> Option<(f64, usize)> {
    let mut steps: Vec<f64> = stays.map(|row| row.n_steps as f64).collect();
    let n = steps.len();
    Some((quantile(&mut steps, 0.5)?, n))
}

//! Sobol indices: main and total of each key, with their intervals, as a figure and as a table.

use std::fmt::Write as _;

use deltazero_plots::{Axis, Bars, Figure, Legend, LineChart, Panel, Series, Size};
use deltazero_study::digits::count_of;

use super::field::short;
use super::{Drawing, PlotError};
use crate::sweep::sensitivity::{Index, LEAST_SAMPLES};
use crate::sweep::sobol::{OfKey, Point, Sobol, Without};

/// Sum of the main indices from which on interactions are no more than their error.
const ADDITIVE: f64 = 0.95;
/// Sum beyond which the error is too large to tell how the keys act.
const SURPLUS: f64 = 1.05;
/// Most grid points, a panel each.
pub const MOST: usize = 12;
/// Half the width of a bar and of the gap between two, in places of the axis.
const HALF: f64 = 0.17;
const GAP: f64 = 0.02;
/// What main and total index are called, and where their bars stand.
const LOOKS: [(&str, f64); 2] =
    [("main: the key alone", -HALF - GAP), ("total: with all its interactions", HALF + GAP)];
/// Colours of main and total index, and of the intervals.
const COLORS: [usize; 2] = [0, 4];
const INTERVAL: usize = 6;

/// A name for the files of the figure of a column.
pub fn file_name(column: &str) -> String {
    format!("sobol_of_{column}")
}

/// A point of the grid by its values.
fn place(at: &[(String, serde_json::Value)]) -> String {
    let value = |value: &serde_json::Value| match value {
        serde_json::Value::String(word) => word.clone(),
        other => other.as_f64().map_or_else(|| other.to_string(), short),
    };
    let at = at.iter().map(|(key, own)| format!("{key} = {}", value(own)));
    at.collect::<Vec<_>>().join(", ")
}

impl Without {
    /// Where it is on the grid, and why it has no indices.
    fn reason(&self) -> String {
        let why = match self.samples < LEAST_SAMPLES as u64 {
            true => format!("{} of {LEAST_SAMPLES} needed", count_of(self.samples, "whole sample")),
            false => "it does not vary".to_owned(),
        };
        format!("{} ({why})", place(&self.at))
    }
}

impl Sobol {
    /// Which points of the grid have no indices, and why; empty where all have them.
    pub(crate) fn gaps(&self) -> String {
        let n = self.without.len();
        if n == 0 {
            return String::new();
        }
        let reasons: Vec<String> = self.without.iter().map(Without::reason).collect();
        let of = self.points.len() + n;
        format!(
            "No indices at {n} of {}: {}.",
            count_of(of as u64, "grid point"),
            reasons.join("; ")
        )
    }
}

impl Point {
    /// Where it is on the grid.
    pub(crate) fn title(&self) -> String {
        place(&self.at)
    }

    /// What the main indices leave to interactions, where their intervals together tell it.
    pub(crate) fn finding(&self) -> String {
        let sum: f64 = self.keys.iter().map(|own| own.main.value).sum();
        let [low, high] =
            [0, 1].map(|end| self.keys.iter().map(|own| own.main.interval[end]).sum::<f64>());
        let most = self.keys.iter().max_by(|a, b| a.total.value.total_cmp(&b.total.value));
        let most = most.map_or_else(String::new, |own| {
            format!("{} explains most (total {:.2})", own.key, own.total.value)
        });
        let rest = match sum {
            ..ADDITIVE if high >= 1.0 || high - low > 1.0 => {
                "too few samples to tell whether there are interactions"
            }
            ..ADDITIVE => "the rest to 1 is in interactions",
            ..=SURPLUS => "so the keys act nearly one by one",
            _ => "and what is above 1 is the error of few samples",
        };
        format!("{most}; main indices add up to {sum:.2}, {rest}.")
    }
}

/// The indices as tables, in Markdown.
pub fn table(sobol: &Sobol) -> String {
    let mut text = String::new();
    for point in &sobol.points {
        let title = point.title();
        let at = if title.is_empty() { String::new() } else { format!(" at {title}") };
        let _ = writeln!(
            text,
            "Sobol indices of {}{at}, from {}, with 95 % intervals:\n\n\
             | key | main | interval | total | interval |\n|---|---|---|---|---|",
            sobol.column,
            count_of(point.samples, "sample")
        );
        for OfKey { key, main, total } in &point.keys {
            let [main, total] = [main, total].map(|Index { value, interval: [low, high] }| {
                format!("{value:.3} | {low:.3} to {high:.3}")
            });
            let _ = writeln!(text, "| {key} | {main} | {total} |");
        }
        let _ = writeln!(text, "\n{}\n", point.finding());
    }
    if !sobol.without.is_empty() {
        let _ = writeln!(text, "{}\n", sobol.gaps());
    }
    text
}

/// The indices as bars, a panel a grid point.
///
/// # Errors
/// More grid points than a figure has panels.
pub fn drawing(sobol: &Sobol) -> Result<Drawing, PlotError> {
    let n = sobol.points.len();
    if n > MOST {
        return Err(PlotError::GridPoints { n: n as u64, most: MOST as u64 });
    }
    let ends = sobol.points.iter().flat_map(|point| &point.keys);
    let ends = ends.flat_map(|own| [own.main.interval, own.total.interval]);
    let (low, high) = ends.fold((0.0_f64, 1.0_f64), |(low, high), [own_low, own_high]| {
        (low.min(own_low), high.max(own_high))
    });
    let range = (low - if low < 0.0 { 0.03 } else { 0.0 }, high + 0.03);
    let panels: Vec<Panel> = sobol.points.iter().map(|point| panel(point, range).into()).collect();
    let cols = if n == 1 { 1 } else { 2 };
    let rows = n.div_ceil(cols).max(1);
    let title = format!("What the scatter of {} comes from", sobol.column);
    let samples = || sobol.points.iter().map(|point| point.samples);
    let (least, most) = (samples().min().unwrap_or(0), samples().max().unwrap_or(0));
    let up_to = if least < most { format!("{least} to ") } else { String::new() };
    let left_out = sobol.points.iter().map(|point| point.left_out);
    let left_out: u64 = left_out.chain(sobol.without.iter().map(|own| own.left_out)).sum();
    let mut caption = format!(
        "Main and total Sobol indices of {}, lines: 95 % intervals, from {up_to}{}",
        sobol.column,
        count_of(most, "sample")
    );
    if left_out > 0 {
        let (samples, runs) = (count_of(left_out, "sample"), count_of(sobol.failed, "run"));
        let _ = write!(caption, "; left out for want of a value: {samples} ({runs} failed)");
    }
    for point in &sobol.points {
        let title = point.title();
        let at = if title.is_empty() { String::new() } else { format!("{title}: ") };
        let _ = write!(caption, ". {at}{}", point.finding().trim_end_matches('.'));
    }
    let caption = [caption + ".", sobol.gaps()].join(" ").trim_end().to_owned();
    let size = match n {
        1 => Size::SINGLE,
        _ => Size { width: 1000, height: 120 + 320 * u32::try_from(rows).unwrap_or(1) },
    };
    let figure =
        Figure { title, rows, cols, panels, size, legend: Legend::Below, ..Figure::default() };
    Ok(Drawing { name: "sobol", caption, figure })
}

fn panel(point: &Point, (low, high): (f64, f64)) -> LineChart {
    let names = point.keys.iter().map(|own| own.key.clone()).collect();
    let mut chart = LineChart {
        title: point.title(),
        x: Axis::named("", names),
        y: Axis::linear("part of the variance").within(low, high),
        ..LineChart::default()
    };
    let mut intervals = Vec::new();
    for (of, ((label, beside), color)) in LOOKS.into_iter().zip(COLORS).enumerate() {
        let mut bars = Vec::new();
        for (i, own) in point.keys.iter().enumerate() {
            let (x, Index { value, interval: [low, high] }) =
                (i as f64 + beside, [own.main, own.total][of]);
            bars.push(((x - HALF, x + HALF), value));
            intervals.extend([(x, low), (x, high), (f64::NAN, f64::NAN)]);
        }
        chart.bars.push(Bars { label: label.to_owned(), color, bars });
    }
    chart.series.push(Series::line("", INTERVAL, intervals));
    chart
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point whose keys have these main indices with their intervals.
    fn point(mains: &[(f64, [f64; 2])]) -> Point {
        let of_key = |&(value, interval): &(f64, [f64; 2])| {
            let index = Index { value, interval };
            OfKey { key: "K".to_owned(), main: index, total: index }
        };
        let keys = mains.iter().map(of_key).collect();
        Point { at: Vec::new(), samples: 8, left_out: 0, keys }
    }

    #[test]
    fn interactions_are_told_only_where_the_intervals_exclude_that_there_are_none() {
        for (mains, rest) in [
            (&[(0.3, [0.2, 0.4]), (0.4, [0.3, 0.5])][..], "0.70, the rest to 1 is in interactions"),
            (&[(-0.01, [-0.1, 0.1])], "-0.01, the rest to 1 is in interactions"),
            (&[(0.91, [0.35, 1.9]), (0.0, [0.0, 0.0])], "0.91, too few samples to tell"),
            (&[(0.08, [-0.38, 0.59]), (-1.6, [-2.76, -0.49])], "-1.52, too few samples to tell"),
        ] {
            let finding = point(mains).finding();
            assert!(finding.contains(rest), "no {rest:?} in: {finding}");
        }
    }
}

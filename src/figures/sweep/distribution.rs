//! How a column is distributed over the runs.

use deltazero_plots::{Axis, Figure, Group, Histogram};
use deltazero_study::quantile::quantile;

use super::field::{Levels, MOST_CLASSES, short};
use super::{Data, Drawing, PlotError};
use crate::sweep::summary::are_alike;

/// Fewest and most bins of equal width, or of equal ratio.
const BINS: (f64, f64) = (8.0, 50.0);
/// Most whole numbers that have a bin each.
const MOST_WHOLE: f64 = 40.0;
/// What is told of it, and its name.
const TOLD: [(f64, &str); 3] = [(0.05, "5 %"), (0.5, "median"), (0.95, "95 %")];

/// The histogram.
pub(super) fn drawing(data: &Data<'_>) -> Result<Drawing, PlotError> {
    let x = &data.x;
    let classes = match &data.color {
        None => Levels::one(data.n),
        Some(color) => color.classes().ok_or_else(|| PlotError::NoClasses {
            x: x.name.clone(),
            color: color.name.clone(),
            most: MOST_CLASSES,
        })?,
    };
    let named = x.has_words().then(|| x.levels());
    let (axis, places) = match &named {
        None => (x.axis(), x.places()),
        Some(Levels { names, of_row, .. }) => {
            let place = |level: &Option<usize>| level.map_or(f64::NAN, |level| level as f64);
            (Axis::named(&x.label, names.clone()), of_row.iter().map(place).collect())
        }
    };
    let shown = |at: f64| if named.is_some() { at.is_finite() } else { x.shows(at) };
    let mut sorted: Vec<f64> = places.iter().copied().filter(|x| shown(*x)).collect();
    let marks = TOLD.map(|(part, name)| (quantile(&mut sorted, part).unwrap_or(f64::NAN), name));
    let bins = match axis.names.len() {
        0 => bins(&sorted, x.is_log()),
        n => (0..n).map(|i| (i as f64 - 0.5, i as f64 + 0.5)).collect(),
    };
    let mut counts = vec![vec![0.0; bins.len()]; classes.names.len()];
    for (row, x) in places.iter().enumerate().filter(|(_, x)| shown(**x)) {
        // The last whose lower end is not above; values at the upper end of all are in the last.
        let bin = bins.partition_point(|(low, _)| low <= x).saturating_sub(1);
        if let Some(class) = classes.of_row[row] {
            counts[class][bin] += 1.0;
        }
    }
    let n_shown = counts.iter().flatten().sum::<f64>() as usize;
    let group = |(i, counts): (usize, Vec<f64>)| {
        let label = data
            .color
            .as_ref()
            .map_or_else(String::new, |color| format!("{} = {}", color.name, classes.names[i]));
        Group { label, color: i, counts }
    };
    let groups = counts.into_iter().enumerate().map(group).collect();
    let y = Axis::linear("runs");
    let told = marks.map(|(at, name)| format!("{name} {}", short(at))).join(", ");
    let told = if named.is_some() { String::new() } else { told };
    let title = told.clone();
    let histogram = Histogram { title, x: axis, y, bins, groups };
    let mut caption = format!("Distribution of {}", x.name);
    if !told.is_empty() {
        caption += &format!(": {told}");
    }
    caption += &format!(". {}", data.of_shown(n_shown));
    let figure = Figure::single(format!("Distribution of {}", x.name), histogram);
    Ok(Drawing { name: "distribution", caption, figure })
}

/// Bins of equal widths, or of equal ratios on a logarithmic axis; for a few whole numbers one each.
fn bins(sorted: &[f64], is_log: bool) -> Vec<(f64, f64)> {
    let (Some(low), Some(high)) = (sorted.first().copied(), sorted.last().copied()) else {
        return Vec::new();
    };
    let is_whole = sorted.iter().all(|x| x.fract() == 0.0) && high - low < MOST_WHOLE;
    if is_whole && !is_log {
        let n = (high - low) as u64;
        return (0..=n).map(|i| low + i as f64).map(|at| (at - 0.5, at + 0.5)).collect();
    }
    if are_alike(low, high) {
        let half = if low == 0.0 { 0.5 } else { 0.05 * low.abs() };
        return vec![(low - half, low + half)];
    }
    let n = (sorted.len() as f64).sqrt().ceil().clamp(BINS.0, BINS.1);
    let at = |i: u64| {
        let part = i as f64 / n;
        match is_log {
            // Not by the ratio of both ends, which may be larger than any number.
            true => libm::pow(low, 1.0 - part) * libm::pow(high, part),
            false => low + part * (high - low),
        }
    };
    (0..n as u64).map(|i| (at(i), at(i + 1))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_reach_over_more_decades_than_a_number_has() {
        let bins = bins(&[1e-275, 1.0, 1e265], true);
        assert_eq!(bins.first().map(|bin| bin.0), Some(1e-275));
        assert_eq!(bins.last().map(|bin| bin.1), Some(1e265));
        assert!(bins.iter().all(|(low, high)| low < high), "{bins:?}");
    }

    #[test]
    fn values_that_differ_by_rounding_have_one_bin() {
        let next = 1.0 + f64::EPSILON;
        for sorted in [[0.0, 0.0], [1.5, 1.5], [1.0, next], [-next, -1.0]] {
            let all = bins(&sorted, false);
            assert!(all.len() == 1 && all[0].0 < sorted[0] && sorted[1] < all[0].1, "{all:?}");
        }
        assert!(bins(&[1.0, 1.0 + 1e-9], false).len() > 1);
    }
}

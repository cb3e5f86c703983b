//! Maps of the contest: who wins, by how much, and what it costs against stiffness.

use deltazero_plots::{
    Axis, Cells, Figure, Heatmap, Legend, LineChart, Marker, Panel, Series, Size, Upright,
};
use deltazero_study::quantile::quantile;
use deltazero_study::selection::{CUT, FINAL};

use super::Drawing;
use super::map::{WINNERS, cells_won, winner_colors, winner_word};
use crate::keys::ReadingName;
use crate::study::regimes::{Cell, maps, of_map};

/// The names of its figures.
pub const ALL: [&str; 3] = [WINNERS, MARGIN, COST];
const MARGIN: &str = "margin";
const COST: &str = "cost";
/// The second is close to the first within this factor.
const CLOSE: f64 = 1.1;

/// The figures of a map; those without any data are left out.
pub fn drawings(cells: &[Cell]) -> Vec<Drawing> {
    if cells.is_empty() {
        return Vec::new();
    }
    let mut drawings = vec![winners(cells), margin(cells), cost(cells)];
    drawings.retain(|drawing| !drawing.figure.is_empty());
    drawings
}

/// The values of one axis of the map, ascending.
fn values(cells: &[Cell], of: impl Fn(&Cell) -> f64) -> Vec<f64> {
    let mut values: Vec<f64> = cells.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

fn stiffnesses(cells: &[Cell]) -> Vec<f64> {
    values(cells, |cell| cell.stiffness)
}

fn ratios(cells: &[Cell]) -> Vec<f64> {
    values(cells, |cell| cell.damping_ratio)
}

/// A heat map with K to the right and ζ upwards; `colors` and `texts` come from the cells, row by row
/// from the top.
fn map(
    cells: &[Cell],
    (reading, accuracy): (ReadingName, f64),
    colors: impl Fn(Vec<Option<&Cell>>) -> Cells,
    text: impl Fn(&Cell) -> String,
) -> Panel {
    let own = of_map(cells, reading, accuracy);
    let (columns, mut rows) = (stiffnesses(cells), ratios(cells));
    rows.reverse();
    let at = |zeta: f64, stiffness: f64| {
        let here = |cell: &&&Cell| cell.damping_ratio == zeta && cell.stiffness == stiffness;
        own.iter().find(here).copied()
    };
    let grid: Vec<Option<&Cell>> =
        rows.iter().flat_map(|zeta| columns.iter().map(|k| at(*zeta, *k))).collect();
    let texts = grid.iter().map(|cell| cell.map_or_else(String::new, &text)).collect();
    Heatmap {
        title: format!("{reading}, e ≤ {accuracy:e}"),
        x_label: "contact stiffness K [N/m]".into(),
        y_label: "damping ratio ζ".into(),
        columns: columns.iter().map(|k| format!("{k:e}")).collect(),
        rows: rows.iter().map(|zeta| format!("{zeta}")).collect(),
        cells: colors(grid),
        texts,
    }
    .into()
}

/// A figure of one panel for each reading and accuracy.
fn of_maps(title: &str, cells: &[Cell], panel: impl Fn((ReadingName, f64)) -> Panel) -> Figure {
    let mut maps = maps(cells);
    // Readings below each other, accuracies beside each other.
    maps.sort_by_key(|(reading, _)| ReadingName::ALL.iter().position(|known| known == reading));
    let cols = values(cells, |cell| cell.accuracy).len().max(1);
    let rows = maps.len().div_ceil(cols).max(1);
    Figure {
        title: title.into(),
        rows,
        cols,
        panels: maps.into_iter().map(panel).collect(),
        size: Size { width: 1200, height: 140 + 260 * u32::try_from(rows).unwrap_or(1) },
        legend: Legend::Below,
        ..Figure::default()
    }
}

fn winners(cells: &[Cell]) -> Drawing {
    let mut names: Vec<String> = Vec::new();
    for entry in cells.iter().filter_map(|cell| cell.winner()) {
        if !names.contains(&entry.method) {
            names.push(entry.method.clone());
        }
    }
    names.sort();
    let colors = |grid: Vec<Option<&Cell>>| {
        winner_colors(grid.into_iter().map(|cell| cell.map(|cell| &cell.contest)))
    };
    let text = |cell: &Cell| winner_word(cell);
    let figure = of_maps("The fastest method", cells, |which| map(cells, which, colors, text));
    let counts: Vec<String> = names
        .iter()
        .map(|name| {
            let own =
                cells.iter().filter_map(|cell| cell.winner()).filter(|entry| entry.method == *name);
            format!("{name} {}", own.count())
        })
        .collect();
    let caption = format!(
        "The fastest method that reaches e, over contact stiffness and damping ratio. {}",
        cells_won(&counts, cells.iter().map(|cell| &cell.contest))
    );
    Drawing { name: WINNERS, caption, figure }
}

fn margin(cells: &[Cell]) -> Drawing {
    let most = cells.iter().filter_map(|cell| cell.margin()).fold(1.0_f64, f64::max);
    let colors = |grid: Vec<Option<&Cell>>| {
        let value = |cell: &Option<&Cell>| cell.and_then(|cell| cell.margin()).unwrap_or(f64::NAN);
        let label = "time of the second over the first".to_owned();
        Cells::Values {
            bar: Axis::log(label).within(1.0, most.max(CLOSE)),
            values: grid.iter().map(value).collect(),
        }
    };
    let text = |cell: &Cell| cell.margin().map_or_else(String::new, |m| format!("{m:.2}"));
    let figure =
        of_maps("How far ahead the fastest is", cells, |which| map(cells, which, colors, text));
    let mut margins: Vec<f64> = cells.iter().filter_map(|cell| cell.margin()).collect();
    let median = quantile(&mut margins, 0.5).unwrap_or(f64::NAN);
    let close = margins.iter().filter(|margin| **margin < CLOSE).count();
    let open = cells.iter().filter(|cell| !cell.within_noise().is_empty()).count();
    let caption = format!(
        "Time of the second over that of the first, median {median:.2}, largest {most:.2}; in {close} of {} \
         cells the two are within a tenth, in {open} the winner is within the noise of the times.",
        margins.len()
    );
    Drawing { name: MARGIN, caption, figure }
}

/// Cost against K of the best explicit and the best implicit method, a panel a damping ratio.
fn cost(cells: &[Cell]) -> Drawing {
    let zetas = ratios(cells);
    let maps = maps(cells);
    let mut crossovers = Vec::new();
    let mut panels: Vec<Panel> = Vec::new();
    for &(reading, accuracy) in &maps {
        for &zeta in &zetas {
            let mut own = of_map(cells, reading, accuracy);
            own.retain(|cell| cell.damping_ratio == zeta);
            own.sort_by(|a, b| a.stiffness.total_cmp(&b.stiffness));
            let curve = |implicit: bool| -> Vec<(f64, f64)> {
                let point = |cell: &&Cell| {
                    let best = cell.best(|entry| entry.implicit == implicit);
                    (cell.stiffness, best.map_or(f64::NAN, |entry| 1e3 * entry.time_s()))
                };
                own.iter().map(point).collect()
            };
            let (explicit, implicit) = (curve(false), curve(true));
            let crossing = crossover(&explicit, &implicit);
            if let Some(k) = crossing {
                crossovers.push(format!("{reading}, e ≤ {accuracy:e}, ζ = {zeta}: {k:.0e} N/m"));
            }
            let chart = LineChart {
                title: format!("{reading}, e ≤ {accuracy:e}, ζ = {zeta}"),
                x: Axis::log("K [N/m]"),
                y: Axis::log("time [ms]"),
                series: vec![
                    Series::filled("best explicit", 0, Marker::cycle(0), explicit),
                    Series::filled("best implicit", 1, Marker::cycle(1), implicit),
                ],
                uprights: crossing
                    .map(|k| Upright { x: k, label: format!("{k:.0e}") })
                    .into_iter()
                    .collect(),
                ..LineChart::default()
            };
            panels.push(chart.into());
        }
    }
    let caption = format!(
        "Time of the fastest explicit and the fastest implicit method against contact stiffness. A \
         missing point is one that does not reach the accuracy, or is given up: at {CUT} times the least work, \
         a blind run at {FINAL} times that of the best that locates events. \
         Crossovers (vertical lines): {}.",
        if crossovers.is_empty() { "none".to_owned() } else { crossovers.join("; ") }
    );
    let (rows, cols) = (maps.len().max(1), zetas.len().max(1));
    let side =
        |n: usize, each: u32, most: u32| (120 + each * u32::try_from(n).unwrap_or(1)).min(most);
    let figure = Figure {
        title: "Cost against stiffness".into(),
        rows,
        cols,
        panels,
        size: Size { width: side(cols, 270, 2000), height: side(rows, 250, 2000) },
        legend: Legend::Below,
        share_x: true,
        share_y: true,
    };
    Drawing { name: COST, caption, figure }
}

/// The K from which on the second curve is below the first, by power laws between the points.
fn crossover(explicit: &[(f64, f64)], implicit: &[(f64, f64)]) -> Option<f64> {
    let ratios: Vec<(f64, f64)> = explicit
        .iter()
        .zip(implicit)
        .map(|(a, b)| (a.0, libm::log(a.1 / b.1)))
        .filter(|(_, ratio)| ratio.is_finite())
        .collect();
    let last_above = ratios.iter().rposition(|(_, ratio)| *ratio <= 0.0)?;
    let ((k0, r0), (k1, r1)) = (*ratios.get(last_above)?, *ratios.get(last_above + 1)?);
    Some(k0 * libm::pow(k1 / k0, -r0 / (r1 - r0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn power_laws_cross_where_they_are_equal() {
        let powers =
            |p: f64| (5..10).map(|k| (10_f64.powi(k), 10_f64.powf(p * f64::from(k)))).collect();
        let explicit: Vec<(f64, f64)> = powers(0.5);
        let implicit: Vec<(f64, f64)> =
            (5..10).map(|k| (10_f64.powi(k), 10_f64.powf(3.75))).collect();
        let k = crossover(&explicit, &implicit).unwrap();
        assert!((k / 10_f64.powf(7.5) - 1.0).abs() < 1e-12);
        assert_eq!(crossover(&implicit, &implicit), None);
    }
}

//! The fastest method over two parameters of a model.

use deltazero_plots::{Cells, Figure, Heatmap, Legend, Panel, Size};
use deltazero_solvers::METHODS;
use deltazero_study::digits::in_short;
use deltazero_study::map::{CellStatus, Contested, Map, MapCell};
use deltazero_study::setting::Events;

use super::{Drawing, number};

/// The name of its figure.
pub const WINNERS: &str = "winners";

/// A colour for each cell, row by row from the top: that of its winner.
pub(super) fn winner_colors<'a>(grid: impl Iterator<Item = Option<&'a Contested>>) -> Cells {
    let methods = METHODS.iter().map(|method| method.name.to_owned());
    // That of a method which is no longer in the list.
    let names = methods.chain(["another".to_owned()]).collect();
    let index = |cell: Option<&Contested>| Some(number(&cell?.winner()?.method));
    Cells::Categories { names, indices: grid.map(index).collect() }
}

/// What the winner of a cell does with events; why there is none.
pub(super) fn winner_word(contest: &Contested) -> String {
    match (contest.winner(), contest.status) {
        (Some(entry), _) => match entry.events {
            Events::Located => "located".to_owned(),
            Events::Blind => "blind".to_owned(),
        },
        (None, CellStatus::NoReference) => "no ref.".to_owned(),
        (None, status) => status.name().to_owned(),
    }
}

/// The winners of a map, a panel an accuracy: the first parameter to the right, the second upwards.
pub fn winners(map: &Map) -> Drawing {
    let mut accuracies: Vec<f64> = map.cells.iter().map(|cell| cell.contest.accuracy).collect();
    accuracies.sort_by(|a, b| b.total_cmp(a));
    accuracies.dedup();
    let panels: Vec<Panel> = accuracies.iter().map(|accuracy| panel(map, *accuracy)).collect();
    let mut wins: Vec<(String, usize)> = Vec::new();
    for entry in map.cells.iter().filter_map(|cell| cell.contest.winner()) {
        match wins.iter_mut().find(|(name, _)| *name == entry.method) {
            Some((_, n)) => *n += 1,
            None => wins.push((entry.method.clone(), 1)),
        }
    }
    wins.sort();
    let counts: Vec<String> = wins.iter().map(|(name, n)| format!("{name} {n}")).collect();
    let [x, y] = map.axes.each_ref().map(|axis| axis.name.as_str());
    let caption = format!(
        "The fastest method that reaches e, over {x} and {y}. {}",
        cells_won(&counts, map.cells.iter().map(|cell| &cell.contest))
    );
    let figure = Figure {
        title: "The fastest method".into(),
        rows: 1,
        cols: panels.len().max(1),
        panels,
        size: Size { width: 1200, height: 440 },
        legend: Legend::Below,
        ..Figure::default()
    };
    Drawing { name: WINNERS, caption, figure }
}

/// How many cells each method won, as `counts` tell it, and how many nobody did.
pub(super) fn cells_won<'a>(
    counts: &[String],
    cells: impl Iterator<Item = &'a Contested>,
) -> String {
    let (mut n, mut without) = (0, 0);
    for contest in cells {
        n += 1;
        without += usize::from(contest.winner().is_none());
    }
    match counts {
        [] => format!("No cell of {n} has a winner (crossed out)."),
        _ => format!(
            "Cells won: {}; {without} of {n} without a winner (crossed out).",
            counts.join(", ")
        ),
    }
}

fn panel(map: &Map, accuracy: f64) -> Panel {
    let [x, y] = &map.axes;
    let at = |at: [f64; 2]| {
        let here = |cell: &&MapCell| cell.at == at && cell.contest.accuracy == accuracy;
        map.cells.iter().find(here).map(|cell| &cell.contest)
    };
    let rows = || y.values.iter().rev();
    let grid: Vec<_> =
        rows().flat_map(|up| x.values.iter().map(move |right| at([*right, *up]))).collect();
    let texts = grid.iter().map(|cell| cell.map_or_else(String::new, winner_word)).collect();
    Heatmap {
        title: format!("e ≤ {accuracy:e}"),
        x_label: x.label(),
        y_label: y.label(),
        columns: x.values.iter().copied().map(in_short).collect(),
        rows: rows().copied().map(in_short).collect(),
        cells: winner_colors(grid.into_iter()),
        texts,
    }
    .into()
}

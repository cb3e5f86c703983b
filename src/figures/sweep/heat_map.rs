//! A value over two axes of the grid.

use deltazero_plots::{Cells, Figure, Heatmap, Legend, Size};
use deltazero_study::digits::{count_of, in_short, rounded_to};
use deltazero_study::quantile::quantile;

use super::field::{Field, Levels, short};
use super::{Data, Drawing};
use crate::sweep::results::Column;

/// Most rows and columns.
const MOST: usize = 100;
/// Most rows and columns whose cells say their value.
const MOST_TOLD: usize = 12;

/// The heat map, if the axes have few enough values.
pub(super) fn drawing(data: &Data<'_>, y: &Field<'_>, color: &Field<'_>) -> Option<Drawing> {
    let (across, up) = (data.x.levels(), y.levels());
    let (cols, rows) = (across.names.len(), up.names.len());
    if cols.max(rows) > MOST {
        return None;
    }
    let color_of = color.places();
    let cell = |row: usize| {
        if !color.shows(color_of[row]) {
            return None;
        }
        let (x, y) = (across.of_row[row]?, up.of_row[row]?);
        Some((rows - 1 - y) * cols + x)
    };
    let mut of_cell: Vec<Vec<usize>> = vec![Vec::new(); rows * cols];
    (0..data.n)
        .filter_map(|row| Some((row, cell(row)?)))
        .for_each(|(row, at)| of_cell[at].push(row));
    let most_runs = of_cell.iter().map(Vec::len).max().unwrap_or(0);
    let (cells, texts, finding) = match color.column {
        Column::Numbers(numbers) => values(color, numbers, &of_cell),
        Column::Words { .. } => words(&color.levels(), &color.classes()?, &of_cell),
    };
    let how = match (most_runs > 1, color.has_words()) {
        (false, _) => String::new(),
        (true, false) => format!("median of up to {most_runs} runs a cell"),
        (true, true) => format!("most frequent of up to {most_runs} runs a cell"),
    };
    let is_told = cols.max(rows) <= MOST_TOLD && !color.has_words();
    let map = Heatmap {
        title: how.clone(),
        x_label: data.x.label.clone(),
        y_label: y.label.clone(),
        columns: across.names,
        rows: up.names.into_iter().rev().collect(),
        cells,
        texts: if is_told { texts } else { Vec::new() },
    };
    let empty = of_cell.iter().filter(|rows| rows.is_empty()).count();
    let crossed = match empty {
        0 => String::new(),
        _ => format!(" No value in {} (crossed out).", count_of(empty, "cell")),
    };
    let comma = if how.is_empty() { "" } else { ", " };
    let caption = format!(
        "{}{comma}{how}, over {} and {}: {finding}{crossed} {}",
        color.name,
        data.x.name,
        y.name,
        data.of_shown(of_cell.iter().map(Vec::len).sum())
    );
    let figure = Figure {
        size: Size { width: 820, height: 520 },
        legend: Legend::Below,
        ..Figure::single(format!("{} over {} and {}", color.name, data.x.name, y.name), map)
    };
    Some(Drawing { name: "heat map", caption, figure })
}

/// The median of each cell, as colour and text, and which are least and largest.
fn values(
    color: &Field<'_>,
    numbers: &[f64],
    cells: &[Vec<usize>],
) -> (Cells, Vec<String>, String) {
    let median = |rows: &Vec<usize>| {
        let mut own: Vec<f64> = rows.iter().map(|row| numbers[*row]).collect();
        quantile(&mut own, 0.5).unwrap_or(f64::NAN)
    };
    let values: Vec<f64> = cells.iter().map(median).collect();
    let texts = values.iter().map(|x| if x.is_nan() { String::new() } else { three_digits(*x) });
    let finite = || values.iter().copied().filter(|x| x.is_finite());
    let (least, most) = (finite().reduce(f64::min), finite().reduce(f64::max));
    let finding = match (least, most) {
        (Some(least), Some(most)) => format!("{} to {}.", short(least), short(most)),
        _ => "no number.".to_owned(),
    };
    let texts = texts.collect();
    (Cells::Values { bar: color.axis(), values }, texts, finding)
}

fn three_digits(x: f64) -> String {
    in_short(rounded_to(x, 3))
}

/// The class of the most frequent word of each cell, of several the first, and how many cells each has.
fn words(levels: &Levels, classes: &Levels, cells: &[Vec<usize>]) -> (Cells, Vec<String>, String) {
    let most_frequent = |rows: &Vec<usize>| {
        // Words are counted one by one: those that share a class are not one word.
        let mut counts = vec![0_usize; levels.names.len()];
        rows.iter().filter_map(|row| levels.of_row[*row]).for_each(|word| counts[word] += 1);
        let most = counts.iter().copied().max().filter(|most| *most > 0)?;
        let word = counts.iter().position(|count| *count == most)?;
        Some(word.min(classes.names.len() - 1))
    };
    let indices: Vec<Option<usize>> = cells.iter().map(most_frequent).collect();
    let count = |class: usize| indices.iter().filter(|own| **own == Some(class)).count();
    let counts = classes.names.iter().enumerate();
    let counts: Vec<String> = counts.map(|(i, name)| format!("{name} {}", count(i))).collect();
    let finding = format!("cells of each: {}.", counts.join(", "));
    (Cells::Categories { names: classes.names.clone(), indices }, Vec::new(), finding)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pool_of_words_is_not_more_frequent_than_one_of_them() {
        let levels = |n: usize, of_row: [usize; 4]| Levels {
            names: (0..n).map(|i| i.to_string()).collect(),
            places: Vec::new(),
            of_row: of_row.map(Some).to_vec(),
        };
        // Twice the first word, and two others once each, which share a class.
        let (cells, ..) =
            words(&levels(3, [0, 1, 0, 2]), &levels(2, [0, 1, 0, 1]), &[vec![0, 1, 2, 3]]);
        assert!(matches!(cells, Cells::Categories { indices, .. } if indices == [Some(0)]));
    }
}

//! One column over another, a sign a run.

use deltazero_plots::{Cloud, Figure, LineChart, Marker, Series};

use super::field::Field;
use super::{Data, Drawing, PlotError};
use crate::sweep::draw::mixed;

/// Runs up to which all are drawn; of more, some so many.
const MOST: usize = 20_000;
/// Most runs that have signs larger than a dot.
const FEW: usize = 1500;

/// The scatter.
pub(super) fn drawing(data: &Data<'_>, y: &Field<'_>) -> Result<Drawing, PlotError> {
    let stride = data.n.div_ceil(MOST).max(1) as u64;
    let (xs, ys) = (data.x.places(), y.places());
    let point = |row: usize| (xs[row], ys[row]);
    // By chance: every n-th run could be of one value of an axis.
    let rows = || (0..data.n).filter(|row| mixed(0, *row as u64).is_multiple_of(stride));
    let is_few = data.n <= FEW;
    let dot = if is_few { Marker::Circle } else { Marker::Dot };
    let mut chart = LineChart { x: data.x.axis(), y: y.axis(), ..LineChart::default() };
    let mut by = String::new();
    match &data.color {
        None => {
            let points = rows().map(point).collect();
            chart.series.push(Series::scatter("", 0, dot, points));
        }
        Some(color) => {
            by = format!(", coloured by {}", color.name);
            match (color.classes().filter(|_| color.is_discrete()), color.numbers()) {
                (Some(classes), _) => {
                    for (class, name) in classes.names.iter().enumerate() {
                        let own = rows().filter(|row| classes.of_row[*row] == Some(class));
                        let marker = if is_few { Marker::cycle(class) } else { Marker::Dot };
                        let label = format!("{} = {name}", color.name);
                        chart.series.push(Series::scatter(
                            label,
                            class,
                            marker,
                            own.map(point).collect(),
                        ));
                    }
                }
                (None, numbers) => {
                    let numbers = numbers?;
                    let points = rows().map(|row| (xs[row], ys[row], numbers[row])).collect();
                    chart.cloud = Some(Box::new(Cloud { bar: color.axis(), marker: dot, points }));
                }
            }
        }
    }
    let each = match stride {
        1 => String::new(),
        _ => format!(" One run in {stride}, chosen at random, is drawn."),
    };
    let caption = format!("{} over {}{by}.{each} {}", y.name, data.x.name, data.of_runs());
    let figure = Figure::single(format!("{} over {}", y.name, data.x.name), chart);
    Ok(Drawing { name: "scatter", caption, figure })
}

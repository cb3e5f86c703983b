//! A value over one axis of the grid: a line a class, with a band where there are several runs at a point.

use deltazero_plots::{Figure, LineChart, Marker, Ribbon, Series, Stroke};
use deltazero_study::quantile::quantile;

use super::field::{Field, Levels, short};
use super::{Data, Drawing, PlotError};

/// Ends of the band.
const BAND: [f64; 2] = [0.05, 0.95];
/// Most points of a line that have markers.
const MOST_MARKERS: usize = 40;
/// Most classes whose spread is shown beside each other.
const MOST_SPREADS: usize = 4;
/// Part of a named place that the classes take beside each other.
const BESIDE: f64 = 0.5;

/// A class: its values at each level of x, as x, 5 %, median, 95 %.
type Curve = Vec<(f64, [f64; 3])>;

/// The curve of each class of the `rows` with their values, those over words beside each other, and the most runs at a point.
fn curves(
    rows: impl Iterator<Item = (usize, f64)>,
    levels: &Levels,
    classes: &Levels,
    are_words: bool,
) -> (Vec<Curve>, usize) {
    let n_levels = levels.names.len();
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); classes.names.len() * n_levels];
    for (row, value) in rows {
        if let (Some(class), Some(level)) = (classes.of_row[row], levels.of_row[row]) {
            values[class * n_levels + level].push(value);
        }
    }
    let most_runs = values.iter().map(Vec::len).max().unwrap_or(0);
    let n_classes = classes.names.len() as f64;
    let beside = |class: usize| match are_words {
        true => BESIDE * ((class as f64 + 0.5) / n_classes - 0.5),
        false => 0.0,
    };
    let curve = |(class, own): (usize, &mut [Vec<f64>])| -> Curve {
        let point = |(values, x): (&mut Vec<f64>, &f64)| {
            let [low, high] = BAND.map(|end| quantile(values, end));
            Some((x + beside(class), [low?, quantile(values, 0.5)?, high?]))
        };
        own.iter_mut().zip(&levels.places).filter_map(point).collect()
    };
    (values.chunks_mut(n_levels.max(1)).enumerate().map(curve).collect(), most_runs)
}

/// The lines, one for each of `classes`.
pub(super) fn drawing(
    data: &Data<'_>,
    y: &Field<'_>,
    classes: Option<Levels>,
) -> Result<Drawing, PlotError> {
    let numbers = y.numbers()?.iter().copied();
    let shown = numbers.enumerate().filter(|(_, value)| y.shows(*value));
    let levels = data.x.levels();
    let has_classes = classes.is_some();
    let classes = classes.unwrap_or_else(|| Levels::one(data.n));
    let (curves, most_runs) = curves(shown, &levels, &classes, data.x.has_words());
    let label = |class: usize| match (&data.color, has_classes) {
        (Some(color), true) => format!("{} = {}", color.name, classes.names[class]),
        _ => String::new(),
    };
    let mut chart = LineChart { x: data.x.axis(), y: y.axis(), ..LineChart::default() };
    let spread = match (most_runs > 1, curves.len()) {
        (true, 1) => Spread::Band,
        (true, _) if data.x.has_words() => Spread::Band,
        (true, ..=MOST_SPREADS) => Spread::Edges,
        _ => Spread::None,
    };
    for (class, curve) in curves.iter().enumerate().filter(|(_, curve)| !curve.is_empty()) {
        add(&mut chart, class, label(class), curve, spread);
    }
    let what = match spread {
        Spread::None => "median",
        Spread::Edges => "median and, dashed, 5 and 95 %",
        Spread::Band => "median and 5 to 95 %",
    };
    let how = if most_runs > 1 {
        format!("{what} of up to {most_runs} runs at a point")
    } else {
        String::new()
    };
    chart.title.clone_from(&how);
    let findings: Vec<String> = curves
        .iter()
        .enumerate()
        .filter_map(|(class, curve)| finding(&label(class), curve))
        .collect();
    let comma = if how.is_empty() { "" } else { ", " };
    let caption = format!(
        "{} over {}{comma}{how}. {} {}",
        y.name,
        data.x.name,
        findings.join(" "),
        data.of_runs()
    );
    let figure = Figure::single(format!("{} over {}", y.name, data.x.name), chart);
    Ok(Drawing { name: "lines", caption, figure })
}

/// How the spread of the runs at a point is shown.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Spread {
    /// Not at all.
    None,
    /// By dashed lines, which do not cover those of other classes.
    Edges,
    /// By an area, or by an upright line at a named place.
    Band,
}

/// Adds a class to the chart: a line, at named places signs.
fn add(chart: &mut LineChart, class: usize, label: String, curve: &Curve, spread: Spread) {
    let of = |part: usize| curve.iter().map(|(x, own)| (*x, own[part])).collect::<Vec<_>>();
    let is_named = !chart.x.names.is_empty();
    let marker = if curve.len() <= MOST_MARKERS { Marker::cycle(class) } else { Marker::None };
    match spread {
        Spread::None => {}
        Spread::Band if is_named => {
            let ends = |(x, [low, _, high]): &(f64, [f64; 3])| {
                [(*x, *low), (*x, *high), (f64::NAN, f64::NAN)]
            };
            chart.series.push(Series::line("", class, curve.iter().flat_map(ends).collect()));
        }
        Spread::Band => {
            let points = curve.iter().map(|(x, [low, _, high])| (*x, *low, *high)).collect();
            chart.ribbons.push(Ribbon { color: class, points });
            // Not drawn: they only have the axis reach around the band.
            let edges = [of(0), of(2)].concat();
            chart.series.push(Series::scatter("", class, Marker::None, edges));
        }
        Spread::Edges => {
            let edge =
                |part| Series { stroke: Stroke::Dashed, ..Series::line("", class, of(part)) };
            chart.series.extend([edge(0), edge(2)]);
        }
    }
    let stroke = if is_named { Stroke::None } else { Stroke::Solid };
    chart.series.push(Series { stroke, ..Series::filled(label, class, marker, of(1)) });
}

/// From where to where the median goes.
fn finding(label: &str, curve: &Curve) -> Option<String> {
    let [first, last] = [curve.first()?, curve.last()?].map(|(_, [_, median, _])| short(*median));
    let what = if label.is_empty() { "Median" } else { label };
    Some(format!("{what}: from {first} at the first to {last} at the last."))
}

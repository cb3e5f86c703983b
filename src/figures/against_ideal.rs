//! A quantity that moves with the contact, beside the same without clearance.

use deltazero_plots::{Axis, Figure, LineChart, Panel, Series, Size};
use deltazero_study::motion::Motion;

use super::Drawing;

/// Name of its files.
pub(super) const NAME: &str = "against_ideal";

/// A column with this before the name of another is the same without clearance.
const MARK: &str = "ideal_";
/// Colours of the quantity with clearance and without.
const WITH: usize = 0;
const IDEAL: usize = 1;
/// The lower panel is cut to so many times the ideal quantity.
const CUT: f64 = 3.0;

/// The quantity over time, whole above and cut below; none where no column has an ideal one beside it.
pub(super) fn drawing(motion: &Motion) -> Option<Drawing> {
    let site = motion.sites.first()?;
    let columns = &site.columns;
    let ideal = columns.iter().position(|column| column.name.starts_with(MARK))?;
    let name = columns[ideal].name.trim_start_matches(MARK);
    let is_same = |column: &_| *column == columns[ideal].unit;
    let own = columns.iter().position(|c| c.name == name && is_same(&c.unit))?;
    let unit = columns[own].unit.replace("s2", "s²");
    let points = |column: usize| -> Vec<(f64, f64)> {
        site.samples().map(|(t, _, row)| (t, row[column])).collect()
    };
    let (with, without) = (points(own), points(ideal));
    let most = |of: &[(f64, f64)]| of.iter().fold(0.0, |most: f64, (_, x)| most.max(x.abs()));
    let (most, least) = (most(&with), most(&without));
    if site.times.is_empty() || least == 0.0 {
        return None;
    }
    let free = site.touches.iter().filter(|(is_contact, _)| !is_contact).count();
    let caption = format!(
        "The {name} over time, in {unit}, {}. It reaches {most:.3e} {unit} among the points shown, {:.1} times the \
         {least:.3e} {unit} without clearance; the joint is free of contact {:.1} % of the time.",
        motion.method,
        most / least,
        100.0 * free as f64 / site.touches.len().max(1) as f64
    );
    let panel = |title: String, y: Axis| -> Panel {
        LineChart {
            title,
            x: Axis::linear("t [s]"),
            y,
            series: vec![
                Series::line("with clearance", WITH, with.clone()),
                Series::line("without", IDEAL, without.clone()),
            ],
            ..LineChart::default()
        }
        .into()
    };
    let y = || Axis::linear(format!("{name} [{unit}]"));
    let cut = CUT * least;
    let figure = Figure {
        title: format!("The {name} with clearance and without"),
        rows: 2,
        cols: 1,
        panels: vec![
            panel("whole".to_owned(), y()),
            panel(format!("cut to {CUT} times that without clearance"), y().within(-cut, cut)),
        ],
        size: Size { width: 1100, height: 720 },
        ..Figure::default()
    };
    Some(Drawing { name: NAME, caption, figure })
}

//! Error against tolerance: proportional, or not, and down to which floor?

use deltazero_plots::{Axis, Figure, Guide, Level, LineChart, Panel, Series, Size};
use deltazero_study::setting::Events;
use deltazero_study::steps::proportionality::{Floor, ToleranceRow};
use deltazero_study::work_precision::{Row, WorkPrecision};

use super::work_precision::not_drawn;
use super::{Drawing, curve, groups};

/// Name of its files.
pub(super) const NAME: &str = "tolerance";

/// `e` against rtol of each method, located on the left, blind on the right.
pub(super) fn drawing(table: &WorkPrecision, rows: &[ToleranceRow]) -> Drawing {
    let kinds = [Events::Located, Events::Blind];
    let panels: Vec<Panel> = kinds
        .into_iter()
        .filter(|events| rows.iter().any(|row| row.events == *events))
        .map(|events| panel(table, rows, events))
        .collect();
    let findings: Vec<String> = rows.iter().map(|row| finding(table, row)).collect();
    let n_exact = table.rows.iter().filter(|row| row.rtol.is_some() && row.e == Some(0.0)).count();
    let caption = format!(
        "Error e against the relative tolerance, dashed: e = rtol, where that is in the frame, and level the floors. Slope of log e over log rtol (1 is ideal) by least \
         squares where e < 1e-2, down to the floor; with it the largest distance from the line, and \
         the floor: the tolerance that no tighter one improves by half. {}.{}",
        findings.join("; "),
        not_drawn(n_exact, "e")
    );
    let figure = Figure {
        title: "Does the error track the tolerance".into(),
        cols: panels.len().max(1),
        panels,
        size: Size { width: 1100, height: 520 },
        share_x: true,
        share_y: true,
        ..Figure::default()
    };
    Drawing { name: NAME, caption, figure }
}

/// One treatment of events; the legend has a method by where it is drawn first.
fn panel(table: &WorkPrecision, rows: &[ToleranceRow], events: Events) -> Panel {
    let mut series: Vec<Series> = Vec::new();
    let is_located = |method: &str| {
        let mut drawn = table.rows.iter().filter(|row| row.rtol.is_some() && row.e > Some(0.0));
        drawn.any(|row| row.method == method && row.events == Events::Located)
    };
    for (method, own, runs) in groups(&table.rows) {
        let points: Vec<(f64, f64)> = runs.iter().filter_map(|row| row.rtol.zip(row.e)).collect();
        if own == events {
            let is_named = own == Events::Blind && is_located(method);
            series.push(Series {
                label: if is_named { String::new() } else { method.into() },
                ..curve(method, own, points)
            });
        }
    }
    let (title, label) = match events {
        Events::Located => ("events located", "e = rtol"),
        Events::Blind => ("event-blind", ""),
    };
    let good = table.reference.agreement;
    let tightest = table.rows.iter().filter_map(|row| row.rtol).fold(f64::INFINITY, f64::min);
    let ideal = Guide { slope: 1.0, through: (1e-6, 1e-6), span: None, label: label.into() };
    let floor = |row: &ToleranceRow| {
        let Floor { rtol, e } = row.floor?;
        let span = Some((tightest, rtol));
        Some(Guide { slope: 0.0, through: (rtol, e), span, label: String::new() })
    };
    let floors = rows.iter().filter(|row| row.events == events).filter_map(floor);
    LineChart {
        title: title.into(),
        x: Axis::log("rtol"),
        y: Axis::log("error e"),
        series,
        guides: floors.chain([ideal]).collect(),
        levels: vec![Level { y: good, label: "the reference's own error".into() }],
        ..LineChart::default()
    }
    .into()
}

fn finding(table: &WorkPrecision, row: &ToleranceRow) -> String {
    let is_own = |run: &&Row| (&run.method, run.events) == (&row.method, row.events);
    let mut errors = table.rows.iter().filter(is_own).filter_map(|run| run.e);
    if errors.all(|e| e == 0.0) {
        return format!("{} {}: exact at every tolerance", row.method, row.events);
    }
    let fit = match (row.slope, row.scatter_decades) {
        (Some(slope), Some(scatter)) => {
            // A line through two runs is as near to any two.
            let how = match row.n_fitted {
                ..=2 => "through two runs".to_owned(),
                _ => format!("within {scatter:.1} decades"),
            };
            let e_over_rtol = row.e_over_rtol.unwrap_or(f64::NAN);
            format!("slope {slope:.2} {how}, e about {e_over_rtol:.0e} rtol")
        }
        _ => "too few runs for a slope".to_owned(),
    };
    let floor = match row.floor {
        Some(Floor { rtol, e }) => format!("floor {e:.1e} from rtol {rtol:e}"),
        None => "no floor".to_owned(),
    };
    format!("{} {}: {fit}, {floor}", row.method, row.events)
}

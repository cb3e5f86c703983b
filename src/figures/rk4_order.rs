//! The error of rk4 against its step: fourth order through events, or not.

use deltazero_plots::{Axis, Figure, Guide, LineChart, Size};
use deltazero_study::errors::log_log_slope;
use deltazero_study::setting::Events;
use deltazero_study::work_precision::WorkPrecision;

use super::work_precision::not_drawn;
use super::{Drawing, curve, groups};

/// Name of its files.
pub(super) const NAME: &str = "rk4_order";

/// Errors below this are near rounding and above this far from the limit of small steps; neither
/// tells the order.
const SLOPE_RANGE: (f64, f64) = (1e-11, 1e-2);

/// `e` against `h` of the classical method, located and blind.
pub(super) fn drawing(table: &WorkPrecision) -> Drawing {
    let (mut series, mut guides, mut slopes) = (Vec::new(), Vec::new(), Vec::new());
    let mut n_exact = 0;
    for (method, events, rows) in groups(&table.rows) {
        let points: Vec<(f64, f64)> = rows.iter().filter_map(|row| row.step.zip(row.e)).collect();
        if method != "rk4" || points.is_empty() {
            continue;
        }
        n_exact += points.iter().filter(|(_, e)| *e == 0.0).count();
        let (least, most) = SLOPE_RANGE;
        let fitted: Vec<(f64, f64)> =
            points.iter().copied().filter(|(_, e)| (least..most).contains(e)).collect();
        if let Some(slope) = log_log_slope(&fitted) {
            let how = if fitted.len() > 2 { "" } else { " through two runs" };
            slopes.push(format!("{events}: {slope:.2}{how}"));
        }
        if let (Events::Located, Some(through)) = (events, fitted.get(fitted.len() / 2)) {
            let label = "order 4".to_owned();
            guides.push(Guide { slope: 4.0, through: *through, span: None, label });
        }
        series.push(curve(method, events, points));
    }
    let caption = format!(
        "Error e of rk4 against its step h. Slope by least squares where {:.0e} ≤ e < {:.0e}: {}. \
         A blind step that straddles δ = 0 loses the order; a step that ends there keeps it.{}",
        SLOPE_RANGE.0,
        SLOPE_RANGE.1,
        if slopes.is_empty() { "too few runs".to_owned() } else { slopes.join(", ") },
        not_drawn(n_exact, "e")
    );
    let chart = LineChart {
        x: Axis::log("step h [s]"),
        y: Axis::log("error e"),
        series,
        guides,
        ..LineChart::default()
    };
    let figure =
        Figure { size: Size::SINGLE, ..Figure::single("rk4: error against step size", chart) };
    Drawing { name: NAME, caption, figure }
}

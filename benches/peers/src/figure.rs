//! Time against error: the best of each tool.

use deltazero_plots::{Axis, Figure, LineChart, Marker, Series, Size};

use crate::row::{Build, Row};

/// The figure. A tool's curve is its front: over all its methods, the runs that no other run of it
/// beats in both time and error.
pub(crate) fn figure(rows: &[Row]) -> Figure {
    let mut tools: Vec<&str> = Vec::new();
    for row in rows {
        if !tools.contains(&row.label.tool.as_str()) {
            tools.push(&row.label.tool);
        }
    }
    let series = tools.iter().enumerate().map(|(i, tool)| {
        let own = rows.iter().filter(|row| row.label.tool == *tool && row.build == Build::Native);
        let points = front(own.filter_map(|row| row.cpu_ms().zip(row.e())).collect());
        if i < deltazero_plots::PALETTE_LEN {
            Series::filled(*tool, i, Marker::cycle(i), points)
        } else {
            Series::hollow(*tool, i, Marker::cycle(i), points)
        }
    });
    let chart = LineChart {
        x: Axis::log("time of both joints, 0-2 s, one thread [ms]"),
        y: Axis::log("error e"),
        series: series.filter(|series| !series.points.is_empty()).collect(),
        ..LineChart::default()
    };
    let size = Size { width: 1000, height: 620 };
    Figure { size, ..Figure::single("Table 1 by other tools: the best of each", chart) }
}

/// Errors above this tell nothing.
const WORST: f64 = 0.1;

fn front(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = WORST;
    points.retain(|(_, e)| {
        let better = *e < best && *e > 0.0;
        best = best.min(*e);
        better
    });
    points
}

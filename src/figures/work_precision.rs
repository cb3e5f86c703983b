//! Error against time, and against right-hand sides: which method is cheapest at which error?

use deltazero_plots::{Axis, Figure, LineChart, Size};

use super::{Drawing, curve, groups};
use crate::study::work_precision::{ACCURACIES, Row, WorkPrecision, cheapest};

/// `e` against the shortest time of each run.
pub(super) fn against_time(table: &WorkPrecision) -> Drawing {
    let chart =
        chart(table, "time of the integration [ms]", |row| row.wall_s_min.map(|wall| 1e3 * wall));
    let winners: Vec<String> = ACCURACIES
        .iter()
        .filter(|e| table.can_decide(**e))
        .map(|e| winner(&table.rows, *e))
        .collect();
    let caption = format!(
        "Error e against the shortest time of each run; down and left is better. Cheapest {}. \
         Filled: events located; hollow: event-blind. Times depend on the machine, their ratios less.",
        winners.join("; ")
    );
    let figure = Figure { size: Size::WIDE, ..Figure::single("Work and precision: time", chart) };
    Drawing { name: "work_precision_time", caption, figure }
}

/// `e` against evaluations of the right-hand side.
pub(super) fn against_rhs(table: &WorkPrecision) -> Drawing {
    let chart = chart(table, "right-hand sides of a block, n_rhs", |row| Some(row.n_rhs as f64));
    let located_wrong = table.rows.iter().filter(|row| row.e.is_some() && !row.events_are_right());
    let caption = format!(
        "Error e against evaluations of the right-hand side, Jacobians and linear algebra not \
         counted. {} of {} runs have missed or spurious events, which e alone hardly shows.",
        located_wrong.count(),
        table.rows.len()
    );
    let figure = Figure {
        size: Size::WIDE,
        ..Figure::single("Work and precision: right-hand sides", chart)
    };
    Drawing { name: "work_precision_rhs", caption, figure }
}

fn chart(table: &WorkPrecision, label: &str, work: impl Fn(&Row) -> Option<f64>) -> LineChart {
    let mut methods: Vec<&str> = Vec::new();
    let mut series = Vec::new();
    for (method, events, rows) in groups(&table.rows) {
        let color = methods.iter().position(|known| *known == method).unwrap_or_else(|| {
            methods.push(method);
            methods.len() - 1
        });
        let point = |row: &&Row| work(row).zip(row.e);
        series.push(curve(method, events, color, rows.iter().filter_map(point).collect()));
    }
    LineChart { x: Axis::log(label), y: Axis::log("error e"), series, ..LineChart::default() }
}

fn winner(rows: &[Row], e: f64) -> String {
    match cheapest(rows, e) {
        None => format!("at e ≤ {e:e}: none"),
        Some(row) => format!(
            "at e ≤ {e:e}: {} {}, {}, {:.2} ms",
            row.method,
            row.events,
            row.setting(),
            1e3 * row.wall_s_min.unwrap_or(f64::NAN)
        ),
    }
}

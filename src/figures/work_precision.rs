//! Error against time, and against right-hand sides: which method is cheapest at which error?

use deltazero_plots::{Axis, Figure, LineChart, Size};
use deltazero_study::columns::Column;
use deltazero_study::digits::count_of;
use deltazero_study::setting::Events;
use deltazero_study::work_precision::{ACCURACIES, Row, WorkPrecision, cheapest, doubt};

use super::{Drawing, curve, groups};

/// Names of the files of the three figures.
pub(super) const TIME: &str = "work_precision_time";
pub(super) const RHS: &str = "work_precision_rhs";
pub(super) const CHOSEN: &str = "chosen_axes";

/// `e` against the shortest time of each run.
pub(super) fn against_time(table: &WorkPrecision) -> Drawing {
    let x = Axis::log("time of the integration [ms]");
    let chart =
        chart(table, x, Axis::log("error e"), |row| row.time_s().map(|time| 1e3 * time).zip(row.e));
    let winners: Vec<String> = ACCURACIES
        .iter()
        .filter(|e| table.can_decide(**e))
        .map(|e| winner(&table.rows, *e))
        .collect();
    let cheapest = match winners[..] {
        [] => String::new(),
        _ => format!("Cheapest {}. ", winners.join("; ")),
    };
    let caption = format!(
        "Error e against the shortest time of each run; down and left is better. {cheapest}\
         Filled: events located; hollow: event-blind. Times depend on the machine, their ratios less.{}",
        not_drawn(n_exact(table), "e")
    );
    let figure = Figure { size: Size::WIDE, ..Figure::single("Work and precision: time", chart) };
    Drawing { name: TIME, caption, figure }
}

/// `e` against evaluations of the right-hand side.
pub(super) fn against_rhs(table: &WorkPrecision) -> Drawing {
    let x = Axis::log("right-hand sides of a part, n_rhs");
    let chart = chart(table, x, Axis::log("error e"), |row| Some(row.n_rhs as f64).zip(row.e));
    let located_wrong = table.rows.iter().filter(|row| row.e.is_some() && !row.events_are_right());
    let caption = format!(
        "Error e against evaluations of the right-hand side, Jacobians and linear algebra not \
         counted. {} of {} runs have missed or spurious events, which e alone hardly shows.{}",
        located_wrong.count(),
        table.rows.len(),
        not_drawn(n_exact(table), "e")
    );
    let figure = Figure {
        size: Size::WIDE,
        ..Figure::single("Work and precision: right-hand sides", chart)
    };
    Drawing { name: RHS, caption, figure }
}

/// How many runs have no error at all.
fn n_exact(table: &WorkPrecision) -> usize {
    table.rows.iter().filter(|row| row.e == Some(0.0)).count()
}

/// That a scale of logarithms has no place for `n` runs, of which this is zero; empty where there are none.
pub(super) fn not_drawn(n: usize, zero: &str) -> String {
    match n {
        0 => String::new(),
        n => format!(" Not drawn, having {zero} = 0: {}.", count_of(n, "run")),
    }
}

/// Two columns of `study.csv` against each other; none where there is no such column.
pub fn chosen_axes(table: &WorkPrecision, x: &str, y: &str) -> Option<Drawing> {
    let (x, y) = (Column::named(x)?, Column::named(y)?);
    let at = |row: &Row| (x.value)(row).number().zip((y.value)(row).number());
    let chart = chart(table, Axis::log(x.label()), Axis::log(y.label()), at);
    let all: Vec<(&Row, (f64, f64))> =
        table.rows.iter().filter_map(|row| Some((row, at(row)?))).collect();
    let lowest = all.iter().filter(|(_, (_, y))| *y >= 0.0).min_by(|a, b| a.1.1.total_cmp(&b.1.1));
    let finding = match lowest {
        None => "No run has both".to_owned(),
        Some((_, (_, 0.0))) => {
            let n = all.iter().filter(|(_, (_, y))| *y == 0.0).count();
            format!("Lowest: {} = 0, of {}", y.name, count_of(n, "run"))
        }
        Some((row, (at_x, at_y))) => {
            let (method, events, setting) = (&row.method, row.events, row.setting());
            let (x, y) = (x.name, y.name);
            format!("Lowest: {method} {events}, {setting}, {y} = {at_y:.1e} at {x} = {at_x:.1e}")
        }
    };
    let n_zero = all.iter().filter(|(_, (x, y))| *x == 0.0 || *y == 0.0).count();
    let not_drawn = not_drawn(n_zero, &format!("{} or {}", y.name, x.name));
    let caption = format!(
        "{} ({}) against {} ({}). {finding}.{not_drawn} Chosen by study.y and study.x.",
        y.name, y.about, x.name, x.about
    );
    let title = format!("{} against {}", y.name, x.name);
    let figure = Figure { size: Size::WIDE, ..Figure::single(title, chart) };
    Some(Drawing { name: CHOSEN, caption, figure })
}

/// The curve of each method, of the points that its rows are `at`.
fn chart(
    table: &WorkPrecision,
    x: Axis,
    y: Axis,
    at: impl Fn(&Row) -> Option<(f64, f64)>,
) -> LineChart {
    let own = |(method, events, rows): (&str, Events, Vec<&Row>)| {
        curve(method, events, rows.iter().filter_map(|row| at(row)).collect())
    };
    let series = groups(&table.rows).into_iter().map(own).collect();
    LineChart { x, y, series, ..LineChart::default() }
}

fn winner(rows: &[Row], e: f64) -> String {
    match cheapest(rows, e) {
        None => format!("at e ≤ {e:e}: none"),
        Some(row) => format!(
            "at e ≤ {e:e}: {} {}, {}, {:.2} ms{}",
            row.method,
            row.events,
            row.setting(),
            1e3 * row.time_s().unwrap_or(f64::NAN),
            doubt(rows, e)
        ),
    }
}

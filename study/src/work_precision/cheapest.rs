//! The cheapest run at an accuracy.

use super::Row;
use crate::setting::Events;

/// Errors at which a study names the cheapest run.
pub const ACCURACIES: [f64; 3] = [1e-3, 1e-6, 1e-9];

/// The runs whose error is at most `e`, with their times.
pub(super) fn reaching(rows: &[Row], e: f64) -> impl Iterator<Item = (&Row, f64)> {
    let is_trusted = |row: &&Row| row.warnings.is_empty();
    let reaching = rows.iter().filter(move |row| row.e.is_some_and(|own| own <= e));
    reaching.filter(is_trusted).filter_map(|row| row.time_s().map(|time| (row, time)))
}

/// The cheapest run, by shortest [time](Row::time_s), among those whose error is at most `e`.
pub fn cheapest(rows: &[Row], e: f64) -> Option<&Row> {
    reaching(rows, e).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(row, _)| row)
}

/// As [`cheapest`], among the runs that have every event of the reference, and no other.
pub fn cheapest_right(rows: &[Row], e: f64) -> Option<&Row> {
    let right = reaching(rows, e).filter(|(row, _)| row.events_are_right());
    right.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(row, _)| row)
}

/// The runs that the [noise](Row::noise) of their times, or of the cheapest's, does not tell from it: of each other
/// method and treatment of events the fastest whose error is at most `e`.
pub fn within_noise(rows: &[Row], e: f64) -> Vec<&Row> {
    let Some(best) = cheapest(rows, e) else { return Vec::new() };
    let same = |a: &Row, b: &Row| (&a.method, a.events) == (&b.method, b.events);
    let is_near = |row: &Row, time: f64| {
        best.time_s().is_some_and(|least| time <= least * row.noise().max(best.noise()))
    };
    let mut near: Vec<(&Row, f64)> =
        reaching(rows, e).filter(|(row, time)| !same(row, best) && is_near(row, *time)).collect();
    near.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut fastest: Vec<&Row> = Vec::new();
    for (row, _) in near {
        if !fastest.iter().any(|known| same(known, row)) {
            fastest.push(row);
        }
    }
    fastest
}

/// Who else may be the cheapest at an accuracy, where the times do not tell: ` (within the noise: also taylor located)`.
pub fn doubt(rows: &[Row], e: f64) -> String {
    let near = within_noise(rows, e);
    in_doubt(near.iter().map(|row| (&*row.method, row.events)))
}

/// The text of [`doubt`] of these methods; empty where there are none.
pub fn in_doubt<'a>(near: impl Iterator<Item = (&'a str, Events)>) -> String {
    let names: Vec<String> = near.map(|(method, events)| format!("{method} {events}")).collect();
    if names.is_empty() {
        return String::new();
    }
    format!(" (within the noise: also {})", names.join(", "))
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use deltazero_solvers::Method;

    use super::super::work_precision;
    use super::*;
    use crate::part::Subject;
    use crate::plan::Plan;
    use crate::problems::balls::LIGHT_BALL;
    use crate::run::{Accuracy, Setting};

    #[test]
    fn of_each_other_method_the_fastest_run_that_noise_hides_is_told() {
        let (method, accuracy) = (Method::named("rk45").unwrap(), Accuracy::Rtol(1e-6, None));
        let setting = Setting { method, events: Events::Located, accuracy };
        let plan = Plan { settings: vec![setting], repeats: 1, ..Plan::new(0.2) };
        let subject = Subject::of(LIGHT_BALL);
        let table = work_precision(&subject, &plan, &[], &AtomicBool::new(false), &|_| {});
        let own = table.unwrap().rows.remove(0);
        let timed = |method: &str, events, least: f64| Row {
            method: method.to_owned(),
            events,
            e: Some(1e-7),
            cpu_s_min: Some(least),
            cpu_s_median: Some(1.1 * least),
            ..own.clone()
        };
        let (located, blind) = (Events::Located, Events::Blind);
        let rows = [
            timed("rk45", located, 1.0),
            timed("rk45", located, 1.01),
            timed("rk45", blind, 1.09),
            timed("dop853", located, 1.07),
            timed("dop853", located, 1.05),
            timed("taylor", located, 1.2),
        ];
        let near = within_noise(&rows, 1e-6)
            .into_iter()
            .map(|row| (&*row.method, row.events, row.time_s()));
        let expected = [("dop853", located, Some(1.05)), ("rk45", blind, Some(1.09))];
        assert_eq!(near.collect::<Vec<_>>(), expected);
        assert!(rows[0].is_same_run(&rows[1]) && !rows[0].is_same_run(&rows[2]));
        assert!(!rows[0].is_same_run(&rows[3]));
        assert!(!rows[0].is_same_run(&Row { rtol: Some(1e-7), ..rows[0].clone() }));
    }
}

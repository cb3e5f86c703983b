//! The figures, one a file: a caption, and a function from a table to a chart.

mod contact;
mod orbit;
mod rk4_order;
mod step_size;
mod work_precision;

use deltazero_plots::{Figure, Marker, Series};

use crate::config::Events;
use crate::study::motion::Motion;
use crate::study::step_size::StepHistory;
use crate::study::work_precision::{Row, WorkPrecision};

/// A figure with what is said about it.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Name of its files, without ending.
    pub name: &'static str,
    /// Setting and finding, with numbers of the run.
    pub caption: String,
    /// The picture.
    pub figure: Figure,
}

/// All figures of a study.
pub fn of_study(
    table: &WorkPrecision,
    histories: &[StepHistory],
    motion: Option<&Motion>,
) -> Vec<Drawing> {
    let mut drawings = vec![
        work_precision::against_time(table),
        work_precision::against_rhs(table),
        step_size::drawing(histories),
    ];
    if let Some(motion) = motion {
        drawings.push(contact::drawing(motion));
        drawings.push(orbit::drawing(motion));
    }
    drawings.push(rk4_order::drawing(table));
    drawings
}

/// The curve of one method: filled and solid where events are located, hollow and dashed where
/// they are not. `color` is the method's number.
fn curve(method: &str, events: Events, color: usize, points: Vec<(f64, f64)>) -> Series {
    let label = format!("{method}, {events}");
    let marker = Marker::cycle(color);
    match events {
        Events::Located => Series::filled(label, color, marker, points),
        Events::Blind => Series::hollow(label, color, marker, points),
    }
}

/// The rows of each method and treatment of events, in the order of the table.
fn groups(rows: &[Row]) -> Vec<(&str, Events, Vec<&Row>)> {
    let mut groups: Vec<(&str, Events, Vec<&Row>)> = Vec::new();
    for row in rows {
        let own =
            |group: &&mut (&str, Events, Vec<&Row>)| group.0 == row.method && group.1 == row.events;
        match groups.iter_mut().find(own) {
            Some(group) => group.2.push(row),
            None => groups.push((&row.method, row.events, vec![row])),
        }
    }
    groups
}

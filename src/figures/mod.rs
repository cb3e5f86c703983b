//! The figures, one a file: a caption, and a function from a table to a chart.

mod against_ideal;
pub mod audit;
mod contact;
pub mod map;
mod modes;
mod motion;
mod orbit;
mod proportionality;
pub mod regimes;
mod restarts;
mod rk4_order;
mod stability;
mod stays;
mod step_histogram;
mod step_size;
pub mod sweep;
pub mod torque_ratio;
mod work_precision;

pub use work_precision::chosen_axes;

use deltazero_plots::{Axis, Error, Figure, Marker, Panel, Series, Size};
use deltazero_solvers::METHODS;
use deltazero_study::digits::{in_short, rounded_to};
use deltazero_study::motion::Motion;
use deltazero_study::parallel::{cores, in_parallel};
use deltazero_study::setting::Events;
use deltazero_study::steps::StepTables;
use deltazero_study::steps::step_size::{ModeKind, StepHistory, StepRow};
use deltazero_study::work_precision::{Row, WorkPrecision};

use crate::study::stability::Stability;

/// Room left at both ends of an axis of step sizes, as factors: above, for the ticks of events.
const SIZE_ROOM: (f64, f64) = (1.5, 3.0);

/// A step that lands on an event in a smaller part of the run is not told from none.
const LANDING: f64 = 1e-9;

/// The names of all figures that studies have.
pub const OF_STUDIES: [&str; 15] = [
    work_precision::TIME,
    work_precision::RHS,
    "step_size",
    "step_size_zoom",
    "step_histogram",
    stays::NAME,
    "restarts",
    motion::NAME,
    contact::NAME,
    against_ideal::NAME,
    orbit::NAME,
    rk4_order::NAME,
    stability::NAME,
    proportionality::NAME,
    work_precision::CHOSEN,
];

/// The names of all figures that audits have.
pub const OF_AUDITS: [&str; 9] = {
    let [ab_ideal, af_ideal, ab, x01, y01, f_n1, af, f_n2] = audit::NAMES;
    [ab_ideal, af_ideal, ab, x01, y01, f_n1, af, f_n2, torque_ratio::NAME]
};

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

/// A figure drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Name of its files, without ending.
    pub name: String,
    /// What stands above it.
    pub title: String,
    /// Setting and finding, with numbers of the run.
    pub caption: String,
    /// As an SVG document.
    pub svg: String,
    /// As a PNG file.
    pub png: Vec<u8>,
}

impl Drawing {
    /// Draws it.
    ///
    /// # Errors
    /// Where the figure cannot be drawn.
    pub fn picture(&self) -> Result<Picture, Error> {
        Ok(Picture {
            name: self.name.to_owned(),
            title: self.figure.title.clone(),
            caption: self.caption.clone(),
            svg: self.figure.svg()?,
            png: self.figure.png()?,
        })
    }
}

/// Draws them, on all cores, in their order.
///
/// # Errors
/// Where one cannot be drawn, with its name.
pub fn pictures(drawings: &[Drawing]) -> Result<Vec<Picture>, (&'static str, Error)> {
    let draw = |drawing: &Drawing| drawing.picture().map_err(|error| (drawing.name, error));
    in_parallel(drawings, cores(), draw).into_iter().collect()
}

/// The figures of a study: of its motion, of the pins in joints of these clearances, and of the limit of stability where
/// there is one; those without any data are left out.
pub fn of_study(
    table: &WorkPrecision,
    steps: &StepTables,
    motion: Option<&Motion>,
    clearances: &[f64],
    stability: Option<&Stability>,
) -> Vec<Drawing> {
    let modes = steps.histories.first().map_or(&[][..], |history| &history.modes);
    let mut drawings = vec![
        work_precision::against_time(table),
        work_precision::against_rhs(table),
        step_size::whole(&steps.histories),
        step_size::zoom(&steps.histories, motion),
        step_histogram::drawing(&steps.histories, &steps.histogram),
        stays::drawing(&steps.stays, modes),
        restarts::drawing(&steps.restarts, &steps.restart_costs, modes),
    ];
    drawings.extend(motion.and_then(motion::drawing));
    drawings.extend(motion.and_then(contact::drawing));
    drawings.extend(motion.and_then(against_ideal::drawing));
    drawings.extend(motion.and_then(|motion| orbit::drawing(motion, clearances)));
    drawings.push(rk4_order::drawing(table));
    drawings.extend(stability.map(stability::drawing));
    drawings.push(proportionality::drawing(table, &steps.proportionality));
    drawings.retain(|drawing| !drawing.figure.is_empty());
    drawings
}

/// The number of a method, which is that of its colour and marker in every figure and map: its place in the list
/// of methods, whatever others are there.
fn number(method: &str) -> usize {
    METHODS.iter().position(|known| known.name == method).unwrap_or(METHODS.len())
}

/// The colour of a kind of modes.
fn kind_color(kind: ModeKind) -> usize {
    match kind {
        ModeKind::Flight => 0,
        ModeKind::Contact => 9,
        ModeKind::Stick => 3,
    }
}

/// A time in milliseconds, or in the unit that a reader thinks in where that would be a very long or short number; below a
/// tenth of a nanosecond to two digits.
fn duration(t: f64, decimals: usize) -> String {
    let (unit, per_second) = match t {
        10.0.. => ("s", 1.0),
        1e-4.. => ("ms", 1e3),
        1e-7.. => ("µs", 1e6),
        1e-10.. => ("ns", 1e9),
        _ => return format!("{} s", in_short(rounded_to(t, 2))),
    };
    format!("{:.decimals$} {unit}", per_second * t)
}

/// An axis for the step sizes of all methods but their smallest per mille, and but [`LANDING`]: a step cut short by an
/// event may be as small as time resolves.
fn size_axis(histories: &[StepHistory]) -> Axis {
    let axis = Axis::log("h [s]");
    let at = |fraction: f64| {
        histories.iter().filter_map(move |history| {
            let least = LANDING * history.steps.last().map_or(0.0, StepRow::end);
            let told = history.steps.iter().filter(|step| !step.lands || step.h_s >= least);
            let mut sizes: Vec<f64> = told.map(|step| step.h_s).collect();
            sizes.sort_unstable_by(f64::total_cmp);
            sizes.get((fraction * sizes.len().checked_sub(1)? as f64) as usize).copied()
        })
    };
    match (at(1e-3).reduce(f64::min), at(1.0).reduce(f64::max)) {
        (Some(least), Some(most)) => axis.within(least / SIZE_ROOM.0, most * SIZE_ROOM.1),
        _ => axis,
    }
}

/// Panels that share both axes, three in a row; three rows are as high as a screen, more are higher.
fn in_threes(title: &str, panels: Vec<Panel>) -> Figure {
    let cols = panels.len().clamp(1, 3);
    let rows = panels.len().div_ceil(cols).max(1);
    let least = u32::try_from(rows).unwrap_or(u32::MAX).saturating_mul(200).saturating_add(120);
    Figure {
        title: title.into(),
        rows,
        cols,
        panels,
        size: Size { width: 1100, height: least.max(720) },
        share_x: true,
        share_y: true,
        ..Figure::default()
    }
}

/// The curve of one method, in its look: filled and solid where events are located, hollow and dashed where
/// they are not.
fn curve(method: &str, events: Events, points: Vec<(f64, f64)>) -> Series {
    let label = format!("{method}, {events}");
    let color = number(method);
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

#[cfg(test)]
mod tests {
    use deltazero_plots::PALETTE_LEN;
    use deltazero_solvers::Method;

    use super::*;

    /// Steps of a millisecond, of which the fourth lands on an event at once.
    fn history(n: u32) -> StepHistory {
        let row = |i: u32| StepRow {
            t_s: 1e-3 * f64::from(i),
            h_s: if i == 3 { 1e-21 } else { 1e-3 },
            mode: 1,
            mode_number: 0,
            since_restart: 1,
            n_rejected: 0,
            lands: i == 3,
        };
        StepHistory {
            method: "bdf".into(),
            setting: String::new(),
            e: 0.0,
            part: 1,
            name: String::new(),
            n_sites: 1,
            modes: Vec::new(),
            steps: (0..n).map(row).collect(),
            events: Vec::new(),
            n_rhs: 0,
            n_rhs_restart: 0,
            n_rhs_location: 0,
        }
    }

    #[test]
    fn a_step_that_lands_at_once_does_not_stretch_the_axis_of_step_sizes() {
        let range = size_axis(&[history(10)]).range;
        assert_eq!(range, Some((1e-3 / SIZE_ROOM.0, 1e-3 * SIZE_ROOM.1)));
    }

    #[test]
    fn times_are_told_in_milliseconds_where_these_have_few_digits() {
        assert_eq!(duration(1112.25635, 2), "1112.26 s");
        assert_eq!(duration(1.5, 2), "1500.00 ms");
        assert_eq!(duration(2e-3, 2), "2.00 ms");
        assert_eq!(duration(4e-6, 1), "4.0 µs");
        assert_eq!([3e-12, 0.0].map(|t| duration(t, 1)), ["3e-12 s", "0 s"]);
    }

    #[test]
    fn one_step_is_told_as_one() {
        let told = |n| step_size::whole(&[history(n)]).caption;
        assert!(told(1).contains("bdf, : 1 step, nine"), "{}", told(1));
        assert!(told(2).contains("bdf, : 2 steps, nine"), "{}", told(2));
    }

    #[test]
    fn every_method_has_a_look_of_its_own() {
        // A colour each; beyond that indices of the palette wrap around.
        assert!(METHODS.len() <= PALETTE_LEN, "{} methods, {PALETTE_LEN} colours", METHODS.len());
        let look = |method: &Method| curve(method.name, Events::Located, Vec::new()).color;
        let looks: Vec<usize> = METHODS.iter().map(look).collect();
        for (i, look) in looks.iter().enumerate() {
            assert!(!looks[..i].contains(look), "{}", METHODS[i].name);
        }
    }
}

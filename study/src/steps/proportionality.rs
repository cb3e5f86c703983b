//! Does the error track the tolerance, and where does a tighter one stop helping?

use serde::{Deserialize, Serialize};

use crate::errors::log_log_slope;
use crate::setting::Events;
use crate::work_precision::{Row, WorkPrecision};

/// Errors above this are far from the limit of small tolerances.
const LARGEST: f64 = 1e-2;
/// A tolerance helps if some tighter one has less than this part of its error.
const HELPS: f64 = 0.5;

/// How the error of one method follows its tolerance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToleranceRow {
    /// Method.
    pub method: String,
    /// What it does with events.
    pub events: Events,
    /// Runs that the line is fitted to: those with `e` below 1e-2 and above the reference's own error,
    /// down to the floor.
    pub n_fitted: usize,
    /// Slope of log e over log rtol by least squares; ideal is 1.
    pub slope: Option<f64>,
    /// `e` over rtol in the middle of the fitted runs.
    pub e_over_rtol: Option<f64>,
    /// Largest distance of a fitted run from the line, in powers of ten.
    pub scatter_decades: Option<f64>,
    /// The loosest tolerance that no tighter one improves by half, and the least error there.
    pub floor: Option<Floor>,
}

/// Where a tighter tolerance stops helping.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Floor {
    /// The tolerance from which on nothing is gained.
    pub rtol: f64,
    /// The least error from there on.
    pub e: f64,
}

/// One row for each adaptive method and treatment of events, in the order of the table.
pub fn proportionality(table: &WorkPrecision) -> Vec<ToleranceRow> {
    let groups = table.rows.chunk_by(|a, b| a.method == b.method && a.events == b.events);
    let row = |group: &[Row]| {
        let points: Vec<(f64, f64)> = group.iter().filter_map(|row| row.rtol.zip(row.e)).collect();
        let first = group.first().filter(|_| !points.is_empty())?;
        Some(tolerance_row(&first.method, first.events, points, table.reference.agreement))
    };
    groups.filter_map(row).collect()
}

/// The row of a method's runs `(rtol, e)`, measured to an error of `good`.
fn tolerance_row(
    method: &str,
    events: Events,
    mut points: Vec<(f64, f64)>,
    good: f64,
) -> ToleranceRow {
    // An error of zero is exact, and has no logarithm.
    points.retain(|(_, e)| *e >= good && *e > 0.0);
    points.sort_by(|a, b| b.0.total_cmp(&a.0));
    let floor = floor(&points);
    let helps = |rtol: f64| floor.is_none_or(|floor| rtol >= floor.rtol);
    points.retain(|(rtol, e)| *e < LARGEST && helps(*rtol));
    let slope = log_log_slope(&points);
    let logs = || points.iter().map(|(rtol, e)| (libm::log10(*rtol), libm::log10(*e)));
    let n = points.len() as f64;
    let mean = |of: fn((f64, f64)) -> f64| logs().map(of).sum::<f64>() / n;
    let (log_rtol, log_e) = (mean(|point| point.0), mean(|point| point.1));
    let distance = |slope: f64| {
        let off = |(x, y): (f64, f64)| libm::fabs(y - log_e - slope * (x - log_rtol));
        logs().map(off).fold(0.0, f64::max)
    };
    ToleranceRow {
        method: method.to_owned(),
        events,
        n_fitted: points.len(),
        slope,
        e_over_rtol: slope.map(|_| libm::exp10(log_e - log_rtol)),
        scatter_decades: slope.map(distance),
        floor,
    }
}

/// The floor of runs by falling tolerance; none where the tightest still helps.
fn floor(points: &[(f64, f64)]) -> Option<Floor> {
    points.iter().enumerate().find_map(|(i, (rtol, e))| {
        let tighter = points[i + 1..].iter().map(|point| point.1).reduce(f64::min)?;
        (tighter > HELPS * e).then_some(Floor { rtol: *rtol, e: tighter.min(*e) })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_goes_with_a_power_of_the_tolerance_has_that_slope_down_to_its_floor() {
        let rtol = |k: i32| libm::exp10(f64::from(-k));
        let e = |k: i32| (3.0 * libm::pow(rtol(k), 0.8)).max(2e-8);
        // One run above the range of the fit, one below the error of the reference.
        let mut points: Vec<(f64, f64)> = (2..14).map(|k| (rtol(k), e(k))).collect();
        points.push((1e-14, 1e-9));
        let row = tolerance_row("any", Events::Located, points, 5e-9);
        assert_eq!(row.floor.map(|floor| (floor.rtol, floor.e)), Some((rtol(10), 2e-8)));
        let slope = row.slope.unwrap_or(f64::NAN);
        assert!((slope - 0.8).abs() < 1e-12 && row.scatter_decades < Some(1e-12), "{row:?}");
        assert_eq!(row.n_fitted, 7);
    }

    #[test]
    fn the_floor_is_where_no_tighter_tolerance_halves_the_error() {
        let falling = [(1e-3, 1e-2), (1e-4, 8e-3), (1e-5, 1e-4), (1e-6, 1e-5)];
        assert_eq!(floor(&falling), None);
        let flat = [(1e-3, 1e-2), (1e-4, 1e-3), (1e-5, 1.5e-3), (1e-6, 9e-4)];
        assert_eq!(floor(&flat), Some(Floor { rtol: 1e-4, e: 9e-4 }));
        assert_eq!(floor(&[]), None);
    }

    #[test]
    fn runs_without_an_error_have_no_slope() {
        let row = tolerance_row("any", Events::Located, vec![(1e-3, 0.0), (1e-6, 0.0)], 0.0);
        assert_eq!((row.n_fitted, row.slope, row.scatter_decades), (0, None, None));
    }
}

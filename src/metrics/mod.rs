//! How far a run is from the reference, in states, events and contacts; and where its work went.

pub mod contact_summary;
pub mod contacts;
pub mod dense;
pub mod work;

use serde::{Deserialize, Serialize};

use crate::model::{Block, State};
use crate::run::ModeChange;

/// Two events further apart than this are not the same event, in units of the mechanism's time.
const EVENT_WINDOW: f64 = 1e-3;

/// The scales that errors are measured in.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorScale {
    /// Clearance of the joint [m], or 1e-4 m where it has none.
    pub clearance: f64,
    /// Largest |θ| of the reference over all samples and joints [rad].
    pub theta: f64,
    /// Two events further apart than this are not the same event [s]: a millisecond, of a slider-crank the
    /// thousandth of a turn.
    pub event_window: f64,
}

impl ErrorScale {
    /// Of `block`, where θ reaches `theta` [rad].
    pub fn of(block: &Block, theta: f64) -> Self {
        Self {
            clearance: if block.clearance > 0.0 { block.clearance } else { 1e-4 },
            theta,
            event_window: EVENT_WINDOW * block.unit_of_time(),
        }
    }
}

/// `e` of one sample: the larger of `|Δpin|/c` (Euclidean) and `|Δθ|/θ_s`; in any order of X and Y.
pub fn sample_error(y: &State<f64>, reference: &State<f64>, scale: ErrorScale) -> f64 {
    let pin = libm::hypot(y[0] - reference[0], y[1] - reference[1]) / scale.clearance;
    let theta = (y[2] - reference[2]).abs() / scale.theta;
    worse(pin, theta)
}

/// The larger of two errors; not a number where either is not, which `f64::max` would drop.
pub fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// A run's events against the reference's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EventMatch {
    /// Pairs.
    pub paired: usize,
    /// Events of the reference without a partner.
    pub missed: usize,
    /// Events of the run without a partner.
    pub spurious: usize,
    /// Largest difference in time within a pair [s].
    pub time_error: f64,
}

/// Pairs the events of one joint in order: the longest common subsequence of equal modes within
/// the window of `scale`, and of those the one with the smallest time error.
pub fn match_events(run: &[ModeChange], reference: &[ModeChange], scale: ErrorScale) -> EventMatch {
    // row[j]: most pairs of the events so far with the first j of the reference, and their error.
    let mut row = vec![(0_usize, 0.0_f64); reference.len() + 1];
    let better = |a: (usize, f64), b: (usize, f64)| {
        if a.0 > b.0 || (a.0 == b.0 && a.1 <= b.1) { a } else { b }
    };
    for event in run {
        let mut diagonal = row[0];
        for (j, other) in reference.iter().enumerate() {
            let above = row[j + 1];
            let apart = (event.t - other.t).abs();
            let same = (event.before, event.after) == (other.before, other.after);
            let skip = better(above, row[j]);
            row[j + 1] = if same && apart <= scale.event_window {
                better((diagonal.0 + 1, diagonal.1.max(apart)), skip)
            } else {
                skip
            };
            diagonal = above;
        }
    }
    let (paired, time_error) = row[reference.len()];
    EventMatch {
        paired,
        missed: reference.len() - paired,
        spurious: run.len() - paired,
        time_error,
    }
}

/// Slope of `log₁₀ y` over `log₁₀ x` by least squares; none for fewer than two points.
pub fn log_log_slope(points: &[(f64, f64)]) -> Option<f64> {
    if points.len() < 2 {
        return None;
    }
    let logs: Vec<(f64, f64)> =
        points.iter().map(|(x, y)| (libm::log10(*x), libm::log10(*y))).collect();
    let n = logs.len() as f64;
    let (mean_x, mean_y) =
        (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
    let covariance: f64 = logs.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    let variance: f64 = logs.iter().map(|p| (p.0 - mean_x) * (p.0 - mean_x)).sum();
    (variance > 0.0).then_some(covariance / variance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;
    use crate::model::Mechanism;

    const SCALE: ErrorScale = ErrorScale { clearance: 1e-4, theta: 0.02, event_window: 1e-3 };

    fn events(list: &[(f64, i8, i8)]) -> Vec<ModeChange> {
        list.iter().map(|&(t, before, after)| ModeChange { t, before, after }).collect()
    }

    #[test]
    fn equal_sequences_pair_whole_and_show_their_worst_time() {
        let reference = events(&[(0.1, 0, 1), (0.2, 1, 0)]);
        let run = events(&[(0.1 + 1e-9, 0, 1), (0.2 - 3e-9, 1, 0)]);
        let found = match_events(&run, &reference, SCALE);
        assert_eq!((found.paired, found.missed, found.spurious), (2, 0, 0));
        assert!((found.time_error - 3e-9).abs() < 1e-15);
    }

    #[test]
    fn a_flight_that_was_missed_is_two_missed_events() {
        let reference = events(&[(0.1, 1, 0), (0.1001, 0, 1), (0.2, 1, -1)]);
        let found = match_events(&events(&[(0.2, 1, -1)]), &reference, SCALE);
        assert_eq!((found.paired, found.missed, found.spurious), (1, 2, 0));
    }

    #[test]
    fn chatter_is_spurious_and_the_nearest_of_its_events_is_the_pair() {
        let reference = events(&[(0.1, 1, 0)]);
        let run = events(&[(0.0995, 1, 0), (0.0998, 0, 1), (0.1, 1, 0)]);
        let found = match_events(&run, &reference, SCALE);
        assert_eq!((found.paired, found.missed, found.spurious), (1, 0, 2));
        assert_eq!(found.time_error, 0.0);
    }

    #[test]
    fn events_beyond_the_window_are_not_the_same() {
        let found = match_events(&events(&[(0.1, 1, 0)]), &events(&[(0.102, 1, 0)]), SCALE);
        assert_eq!((found.paired, found.missed, found.spurious), (0, 1, 1));
    }

    #[test]
    fn events_are_the_same_within_a_thousandth_of_a_second_or_of_a_turn() {
        for (mechanism, window) in [("strut", 1e-3), ("slider-crank", 1.2e-5)] {
            let config = Config::load(None, &[format!("mechanism={mechanism}")]).unwrap();
            let scale = ErrorScale::of(Mechanism::new(&config).blocks()[0], 1.0);
            assert!((scale.event_window / window - 1.0).abs() < 1e-15, "{scale:?}");
        }
    }

    #[test]
    fn a_sample_that_is_not_a_number_has_no_small_error() {
        for i in 0..3 {
            let mut y = [0.0; 6];
            y[i] = f64::NAN;
            assert!(sample_error(&y, &[0.0; 6], SCALE).is_nan());
        }
    }

    #[test]
    fn the_slope_of_a_power_is_its_exponent() {
        let points: Vec<(f64, f64)> =
            (1..5).map(|k| (f64::from(k), f64::from(k).powi(4))).collect();
        assert!((log_log_slope(&points).unwrap() - 4.0).abs() < 1e-14);
    }
}

//! How far a run is from the reference, in states, events and contacts; and where its work went.
//!
//! The error `e` of one state is [`ErrorScale::error`]; that of a run is the largest over its samples within the horizon,
//! [`PartReference::error`](crate::reference::PartReference::error).

pub mod contact_summary;
pub mod contacts;
pub mod dense;
pub mod work;

use serde::{Deserialize, Serialize};

use crate::problem::{Group, GroupScale};
use crate::run::ModeChange;

/// Two events further apart than this are not the same event, in units of the problem's time.
const EVENT_WINDOW: f64 = 1e-3;
/// The least scale of a group measured by its largest magnitude, in natural sizes of its states: one that rests is
/// not measured by its rounding.
const LEAST_SCALE: f64 = 1e-12;

/// A group of states, and what its error is divided by.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScaledGroup {
    /// Indices of its states.
    pub states: Vec<usize>,
    /// Its scale, in the states' unit.
    pub scale: f64,
    /// The site that it belongs to.
    pub site: usize,
}

/// The scales that the errors of one problem are measured in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorScale {
    /// The groups of its states.
    pub groups: Vec<ScaledGroup>,
    /// Two events further apart than this are not the same event [s].
    pub event_window: f64,
}

impl ErrorScale {
    /// The scales of `groups`. `largest` holds the scale of each [`GroupScale::Largest`] group by name; the event window is
    /// 1e-3 `unit_of_time` [s].
    pub fn new(groups: &[Group], unit_of_time: f64, largest: &Largest) -> Self {
        let scaled = |group: &Group| ScaledGroup {
            states: group.states.clone(),
            scale: match group.scale {
                GroupScale::Fixed(scale) => scale,
                GroupScale::Largest => largest.of(&group.name),
            },
            site: group.site,
        };
        let groups = groups.iter().map(scaled).collect();
        Self { groups, event_window: EVENT_WINDOW * unit_of_time }
    }

    /// `e` of one state against the reference: the largest, over groups, of the Euclidean error over its scale.
    pub fn error(&self, y: &[f64], reference: &[f64]) -> f64 {
        self.groups.iter().map(|group| group.error(y, reference)).fold(0.0, worse)
    }

    /// `e` of one state by the groups of one site alone.
    pub fn error_of_site(&self, site: usize, y: &[f64], reference: &[f64]) -> f64 {
        let own = self.groups.iter().filter(|group| group.site == site);
        own.map(|group| group.error(y, reference)).fold(0.0, worse)
    }
}

impl ScaledGroup {
    fn error(&self, y: &[f64], reference: &[f64]) -> f64 {
        length(self.states.iter().map(|&i| y[i] - reference[i])) / self.scale
    }
}

/// Euclidean length.
fn length(each: impl Iterator<Item = f64>) -> f64 {
    each.fold(0.0, |sum: f64, x| if sum == 0.0 { x.abs() } else { libm::hypot(sum, x) })
}

/// The largest lengths that groups take, by their names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Largest(Vec<(String, f64)>);

impl Largest {
    /// Begins with `groups`, of which no state was seen yet; `scales` are the natural sizes of the states.
    pub fn begin(&mut self, groups: &[Group], scales: &[f64]) {
        for group in groups.iter().filter(|group| group.scale == GroupScale::Largest) {
            let natural = group.states.iter().map(|&i| scales[i]).fold(0.0, f64::max);
            self.take(&group.name, (LEAST_SCALE * natural).max(f64::MIN_POSITIVE));
        }
    }

    /// Enters the lengths that the groups have in the state `y`.
    pub fn see(&mut self, groups: &[Group], y: &[f64]) {
        for group in groups.iter().filter(|group| group.scale == GroupScale::Largest) {
            self.take(&group.name, length(group.states.iter().map(|&i| y[i])));
        }
    }

    fn take(&mut self, name: &str, length: f64) {
        match self.0.iter_mut().find(|known| known.0 == name) {
            Some(known) => known.1 = known.1.max(length),
            None => self.0.push((name.to_owned(), length)),
        }
    }

    /// The lengths that were found before, by the names of their groups.
    pub fn known(all: impl IntoIterator<Item = (String, f64)>) -> Self {
        Self(all.into_iter().collect())
    }

    /// The largest length of the groups of this name.
    pub fn of(&self, name: &str) -> f64 {
        self.0.iter().find(|known| known.0 == name).map_or(f64::MIN_POSITIVE, |known| known.1)
    }
}

/// The larger of two errors; not a number where either is not, which `f64::max` would drop.
pub fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// The larger of two errors that may not be there.
pub(crate) fn worst(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(worse(a, b)),
        (a, b) => a.or(b),
    }
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

/// Pairs the events of one site in order: the longest common subsequence of equal modes within `window` [s], and of
/// those the one with the smallest time error.
pub fn match_events(run: &[ModeChange], reference: &[ModeChange], window: f64) -> EventMatch {
    pair_up(run, reference, window, |_| {})
}

/// How near to the `end` [s] of two runs an event may have its partner beyond it: within the `window`, and in the last thousandth of
/// a short run.
pub(crate) fn near_end(window: f64, end: f64) -> f64 {
    window.min(1e-3 * end)
}

/// As [`match_events`], of sequences that both go to `end` [s]: where one alone has events [near](near_end) it that the other
/// lacks, these do not count, for the other may have them a moment later.
pub(crate) fn match_to_end(
    run: &[ModeChange],
    reference: &[ModeChange],
    (window, end): (f64, f64),
) -> EventMatch {
    let all = match_events(run, reference, window);
    let late = |own: &[ModeChange], other: &[ModeChange]| {
        let is_near = |event: &&ModeChange| event.t >= end - near_end(window, end);
        let n_near = own.iter().rev().take_while(is_near).count();
        if n_near == 0 { 0 } else { n_near.min(own.len() - n_needed(own, other, window)) }
    };
    match (late(run, reference), late(reference, run)) {
        (spurious, 0) => EventMatch { spurious: all.spurious - spurious, ..all },
        (0, missed) => EventMatch { missed: all.missed - missed, ..all },
        _ => all,
    }
}

/// How many of the first events of `own` suffice for as many pairs with those of `other` as there are.
fn n_needed(own: &[ModeChange], other: &[ModeChange], window: f64) -> usize {
    let mut paired = vec![0];
    let all = pair_up(own, other, window, |so_far| paired.push(so_far));
    paired.partition_point(|so_far| *so_far < all.paired)
}

/// Pairs events, which are sorted by time; `so_far` hears how many of the events up to each of the run's have partners.
fn pair_up(
    run: &[ModeChange],
    reference: &[ModeChange],
    window: f64,
    mut so_far: impl FnMut(usize),
) -> EventMatch {
    // row[j]: most pairs of the events so far with the first j of the reference, and their error. Those of the reference beyond the
    // window of the last event have no partner yet, and no number in the row.
    let mut row = vec![(0_usize, 0.0_f64)];
    row.reserve(reference.len());
    let better = |a: (usize, f64), b: (usize, f64)| {
        if a.0 > b.0 || (a.0 == b.0 && a.1 <= b.1) { a } else { b }
    };
    for event in run {
        let first = reference.partition_point(|other| event.t - other.t > window);
        let end = reference.partition_point(|other| other.t - event.t <= window);
        row.resize((end + 1).max(row.len()), row[row.len() - 1]);
        let mut diagonal = row[first];
        for (j, other) in reference.iter().enumerate().take(row.len() - 1).skip(first) {
            let above = row[j + 1];
            let apart = (event.t - other.t).abs();
            let same = event.is_like(other);
            let skip = better(above, row[j]);
            row[j + 1] = if same && apart <= window {
                better((diagonal.0 + 1, diagonal.1.max(apart)), skip)
            } else {
                skip
            };
            diagonal = above;
        }
        so_far(row[row.len() - 1].0);
    }
    let (paired, time_error) = row[row.len() - 1];
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
    const WINDOW: f64 = 1e-3;

    fn events(list: &[(f64, i8, i8)]) -> Vec<ModeChange> {
        list.iter().map(|&(t, before, after)| ModeChange::new(t, before, after)).collect()
    }

    #[test]
    fn equal_sequences_pair_whole_and_show_their_worst_time() {
        let reference = events(&[(0.1, 0, 1), (0.2, 1, 0)]);
        let run = events(&[(0.1 + 1e-9, 0, 1), (0.2 - 3e-9, 1, 0)]);
        let found = match_events(&run, &reference, WINDOW);
        assert_eq!((found.paired, found.missed, found.spurious), (2, 0, 0));
        assert!((found.time_error - 3e-9).abs() < 1e-15);
    }

    #[test]
    fn a_flight_that_was_missed_is_two_missed_events() {
        let reference = events(&[(0.1, 1, 0), (0.1001, 0, 1), (0.2, 1, -1)]);
        let found = match_events(&events(&[(0.2, 1, -1)]), &reference, WINDOW);
        assert_eq!((found.paired, found.missed, found.spurious), (1, 2, 0));
    }

    #[test]
    fn chatter_is_spurious_and_the_nearest_of_its_events_is_the_pair() {
        let reference = events(&[(0.1, 1, 0)]);
        let run = events(&[(0.0995, 1, 0), (0.0998, 0, 1), (0.1, 1, 0)]);
        let found = match_events(&run, &reference, WINDOW);
        assert_eq!((found.paired, found.missed, found.spurious), (1, 0, 2));
        assert_eq!(found.time_error, 0.0);
    }

    /// Pairs found by going through all of them.
    fn all_pairs(run: &[ModeChange], reference: &[ModeChange], window: f64) -> usize {
        let mut row = vec![0; reference.len() + 1];
        for event in run {
            let before = row.clone();
            for (j, other) in reference.iter().enumerate() {
                let pairs = event.is_like(other) && (event.t - other.t).abs() <= window;
                row[j + 1] = before[j + 1].max(row[j]).max(before[j] + usize::from(pairs));
            }
        }
        row[reference.len()]
    }

    #[test]
    fn as_many_pairs_are_found_within_the_window_as_among_all_events() {
        // Times and modes by a linear congruence.
        let mut state = 1_u64;
        let mut next = |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) % below
        };
        for n in 0..200_usize {
            let mut draw = |n: usize| {
                let mut t = 0.0;
                let mut one = || {
                    t += 1e-4 * next(20) as f64;
                    ModeChange::new(t, next(2) as i8, next(3) as i8)
                };
                (0..n).map(|_| one()).collect::<Vec<_>>()
            };
            let (run, reference) = (draw(n / 3), draw((n * 7) % 60));
            let found = match_events(&run, &reference, WINDOW);
            assert_eq!(found.paired, all_pairs(&run, &reference, WINDOW), "{n}");
            assert_eq!(found.missed + found.paired, reference.len());
        }
    }

    #[test]
    fn events_beyond_the_window_are_not_the_same() {
        let found = match_events(&events(&[(0.1, 1, 0)]), &events(&[(0.102, 1, 0)]), WINDOW);
        assert_eq!((found.paired, found.missed, found.spurious), (0, 1, 1));
    }

    #[test]
    fn an_event_that_the_other_may_have_beyond_the_end_does_not_count() {
        let (early, both) = (events(&[(0.1, 0, 1)]), events(&[(0.1, 0, 1), (0.9999, 1, 0)]));
        let at = (WINDOW, 1.0);
        for (run, reference) in [(&early, &both), (&both, &early)] {
            let found = match_to_end(run, reference, at);
            assert_eq!((found.paired, found.missed, found.spurious), (1, 0, 0));
        }
        // Of a short run the last thousandth is near its end.
        let found = match_to_end(&early, &both, (1.0, 1.0));
        assert_eq!((found.missed, found.spurious), (0, 0));
        let found = match_to_end(&early, &events(&[(0.1, 0, 1), (0.9, 1, 0)]), (1.0, 1.0));
        assert_eq!((found.missed, found.spurious), (1, 0));
        // Long before the end it counts, and so does one in place of another.
        let found = match_to_end(&early, &both, (WINDOW, 1.1));
        assert_eq!((found.missed, found.spurious), (1, 0));
        let other = events(&[(0.1, 0, 1), (0.9999, 1, -1)]);
        let found = match_to_end(&other, &both, at);
        assert_eq!((found.paired, found.missed, found.spurious), (1, 1, 1));
        // A fault long before does not make it count.
        let found = match_to_end(&both, &events(&[(0.1, 0, 1), (0.5, 1, 0)]), at);
        assert_eq!((found.paired, found.missed, found.spurious), (1, 1, 0));
        // Of several equal ones before the end those without a partner are the last.
        let three = events(&[(0.9995, 1, 0), (0.9996, 1, 0), (0.9997, 1, 0)]);
        let found = match_to_end(&three, &three[..1], at);
        assert_eq!((found.paired, found.missed, found.spurious), (1, 0, 0));
    }

    fn group(name: &'static str, states: Vec<usize>, scale: GroupScale) -> Group {
        Group { name: name.into(), unit: "".into(), states, scale, site: 0 }
    }

    #[test]
    fn the_error_is_that_of_the_worst_group_over_its_scale() {
        let groups = [
            group("pin", vec![0, 1], GroupScale::Fixed(1e-4)),
            group("angle", vec![2], GroupScale::Largest),
        ];
        let mut largest = Largest::default();
        largest.begin(&groups, &[1.0; 3]);
        for y in [[0.0, 0.0, -0.5], [0.0, 0.0, 0.25]] {
            largest.see(&groups, &y);
        }
        let scale = ErrorScale::new(&groups, 1.0, &largest);
        assert_eq!(scale.groups[1].scale, 0.5);
        assert_eq!(scale.error(&[3e-4, 4e-4, 0.0], &[0.0; 3]), 5.0);
        assert_eq!(scale.error(&[3e-4, 4e-4, 4.0], &[0.0; 3]), 8.0);
    }

    #[test]
    fn a_state_that_rests_is_not_measured_by_its_rounding() {
        let groups = [group("y", vec![0], GroupScale::Largest)];
        let mut largest = Largest::default();
        largest.begin(&groups, &[2.0]);
        largest.see(&groups, &[1e-30]);
        assert_eq!(largest.of("y"), 2e-12);
    }

    #[test]
    fn a_sample_that_is_not_a_number_has_no_small_error() {
        let groups = [
            group("pin", vec![0, 1], GroupScale::Fixed(1e-4)),
            group("angle", vec![2], GroupScale::Fixed(1.0)),
        ];
        let scale = ErrorScale::new(&groups, 1.0, &Largest::default());
        for i in 0..3 {
            let mut y = [0.0; 3];
            y[i] = f64::NAN;
            assert!(scale.error(&y, &[0.0; 3]).is_nan());
        }
    }

    #[test]
    fn the_slope_of_a_power_is_its_exponent() {
        let points: Vec<(f64, f64)> =
            (1..5).map(|k| (f64::from(k), f64::from(k).powi(4))).collect();
        assert!((log_log_slope(&points).unwrap() - 4.0).abs() < 1e-14);
    }
}

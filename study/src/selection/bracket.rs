//! Between which settings of a method the loosest one lies that meets the accuracy, and which to look at next.

use std::ops::RangeInclusive;

use super::MARGIN;
use super::settings::A_DECADE;

/// Longest move between two settings that are looked at: two decades. Where they do not halve the error, tighter settings are
/// held not to help.
pub(super) const LONGEST: i32 = 2 * A_DECADE;
/// Errors above this tell nothing: the run has lost the motion.
const LOST: f64 = 0.1;

/// What the settings looked at say, by their indices.
pub(super) struct Bracket {
    loosest: i32,
    tightest: i32,
    /// Below it no setting is looked at any more.
    misses: Option<i32>,
    /// Above it none is …
    meets: Option<i32>,
    /// … and where none meets, none above this one, which needs too much work.
    cut: Option<i32>,
    /// The last setting that halved the error, …
    halved: i32,
    /// … its error, …
    least_e: f64,
    /// … and the moves since then.
    moves: i32,
    /// How often a setting reached the error with events that were not accepted.
    times_wrong: i32,
}

/// Where the search goes.
pub(super) enum Move {
    /// To the setting with this index.
    At(i32),
    /// To a setting between one that misses and one that meets or is cut.
    Between(i32, i32),
    /// It has found this setting.
    Found(i32),
    /// It needs more work than its limit.
    Cut,
    /// No setting reaches the accuracy; this one was the last.
    NoneReaches(i32),
}

impl Bracket {
    /// Before `first`, one of `indices`, is looked at.
    pub(super) fn new(indices: RangeInclusive<i32>, first: i32) -> Self {
        Self {
            loosest: *indices.start(),
            tightest: *indices.end(),
            misses: None,
            meets: None,
            cut: None,
            halved: first,
            least_e: f64::INFINITY,
            moves: 0,
            times_wrong: 0,
        }
    }

    /// Notes that the setting with this index meets the accuracy.
    pub(super) fn note_meets(&mut self, index: i32) {
        self.meets = Some(index);
    }

    /// Notes that the setting with this index misses the `accuracy` with an error `e`, and that one `to_go` settings tighter
    /// may meet it. Returns how far to go.
    pub(super) fn note_misses(&mut self, index: i32, to_go: i32, (e, accuracy): (f64, f64)) -> i32 {
        self.misses = Some(index);
        let mut away = to_go.max(1);
        if e < LOST && e > accuracy && e > 0.5 * self.least_e {
            self.moves += 1;
            away = (away << self.moves).min(LONGEST);
        } else if e < LOST {
            (self.halved, self.least_e, self.moves) = (index, e, 0);
        }
        if e <= MARGIN * accuracy {
            self.times_wrong += 1;
            away *= self.times_wrong;
        }
        away
    }

    /// Notes that the setting with this index needs more work than the limit, and if it `is_hopeless` so does any looser one
    /// that is well behaved. Returns how far to go, or none where all are too dear.
    pub(super) fn note_cut(&mut self, index: i32, is_hopeless: bool) -> Option<i32> {
        if self.meets.is_some() {
            // Looser than one that was affordable: it cost more for being too loose.
            self.misses = Some(index);
            return Some(1);
        }
        match (is_hopeless, self.misses) {
            (true, Some(_)) => return None,
            // Too loose a setting may cost more than a tighter one: it rejects, or chatters.
            (true, None) => self.misses = Some(index),
            (false, _) => self.cut = Some(index),
        }
        Some(LONGEST)
    }

    /// Where to go, `away` from the last setting. Where one misses and one meets, no further apart than their `fineness`, the
    /// latter is taken.
    pub(super) fn next(&self, away: i32, fineness: impl Fn(i32, Option<i32>) -> i32) -> Move {
        let found = || self.meets.map_or(Move::Cut, Move::Found);
        match (self.misses, self.meets.or(self.cut)) {
            (Some(low), Some(high)) if high - low <= fineness(low, self.meets) => found(),
            (Some(low), Some(high)) => Move::Between(low, high),
            (None, Some(high)) if high == self.loosest => found(),
            (None, Some(high)) => Move::At((high - away).max(self.loosest)),
            (Some(low), None) if low == self.tightest || self.stays(low) => Move::NoneReaches(low),
            (Some(low), None) => Move::At((low + away).min(self.tightest)),
            (None, None) => Move::Cut,
        }
    }

    /// Whether tighter settings up to this one have not halved the error.
    fn stays(&self, index: i32) -> bool {
        self.moves > 0 && index - self.halved >= LONGEST
    }
}

//! The nearest key or word to a misspelt one.

use strsim::normalized_damerau_levenshtein as similarity;

use crate::mechanisms::MECHANISMS;

use super::all_keys::{keys, tables};
use crate::keys::{JOINT_TABLES, JOINTS, Key, one_joint};

/// Similarity below which a suggestion would only confuse.
const SIMILAR: f64 = 0.5;

/// Weight of a likeness of the last segments alone: `stiffness` for `contact.stiffness`.
const LAST_SEGMENT: f64 = 0.95;

/// The key most like `path`, or the table if `table`.
pub(super) fn nearest_key(path: &str, table: bool) -> Option<String> {
    let candidates: Vec<String> = match (one_joint(path), table) {
        (Some((joint, _)), true) => JOINT_TABLES.map(|name| format!("{joint}.{name}")).to_vec(),
        (Some((joint, _)), false) => {
            let per_joint = keys().filter(|key| key.per_joint());
            per_joint.map(|key| format!("{joint}.{}", key.path)).collect()
        }
        (None, true) => tables().into_iter().chain(JOINTS).map(str::to_owned).collect(),
        (None, false) => {
            // Of two that are as near, that which no mechanism has for itself.
            let mut all: Vec<_> = keys().collect();
            let is_own = |key: &Key| MECHANISMS.iter().any(|entry| entry.keys.contains(key));
            all.sort_by_key(|key| is_own(key));
            all.into_iter().map(|key| key.path.to_owned()).collect()
        }
    };
    nearest_of(path, candidates)
}

/// The path most like `path`, or whose last segment is most like its own.
pub(super) fn nearest_of(path: &str, candidates: Vec<String>) -> Option<String> {
    let given = path.to_lowercase();
    let score = |candidate: &String| {
        let last = similarity(last_segment(&given), last_segment(candidate));
        similarity(&given, candidate).max(LAST_SEGMENT * last)
    };
    nearest(candidates, score)
}

/// The word most like `word`, as it is given or in small letters.
pub fn nearest_word<'a>(word: &str, words: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let given = [word, &word.to_lowercase()];
    let score = |candidate: &&str| given.map(|given| similarity(given, candidate));
    nearest(words, |candidate| score(candidate).into_iter().fold(0.0, f64::max))
}

/// The first of the best.
fn nearest<T>(candidates: impl IntoIterator<Item = T>, score: impl Fn(&T) -> f64) -> Option<T> {
    let mut best = None;
    let mut best_score = 0.0;
    for candidate in candidates {
        let score = score(&candidate);
        if score >= SIMILAR && score > best_score {
            best_score = score;
            best = Some(candidate);
        }
    }
    best
}

fn last_segment(path: &str) -> &str {
    path.rsplit_once('.').map_or(path, |(_, last)| last)
}

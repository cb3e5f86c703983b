//! Where the polynomial of a guard falls.

use super::super::polynomial::Polynomial;
use super::PRECISION;

/// A fall of a polynomial on [0, 1].
#[derive(Clone, Copy, Debug)]
pub(super) struct Fall {
    /// Where it falls below −bound/2.
    pub(super) at: f64,
    /// Where it is least before it rises, or the end.
    pub(super) deepest: f64,
    /// Whether it rises above −bound/2 again.
    pub(super) rises: bool,
}

/// The fall of `p` on [0, 1] after which it is below `−bound` for the first time.
pub(super) fn fall_of(p: &Polynomial, bound: f64) -> Option<Fall> {
    // If the start lies between −bound and −bound/2, the fall is located at −bound instead.
    let is_below = p.at(0.0) <= -0.5 * bound;
    let violated = p.raised(bound);
    let located = if is_below { violated } else { p.raised(0.5 * bound) };
    let turns = p.derivative().negated();
    // Beside a root the sign of a polynomial is rounded. So the search goes on from minima, and by a stride that doubles
    // where these are roots, too.
    let (mut from, mut stride) = (0.0_f64, PRECISION);
    while from < 1.0 {
        let below = violated.first_fall(from, PRECISION)?;
        let deepest = turns.first_fall(below, PRECISION).unwrap_or(1.0);
        if violated.at(deepest) < 0.0 {
            let rises = located.negated().first_fall(deepest, PRECISION).is_some();
            return Some(Fall { at: last_fall(&located, below), deepest, rises });
        }
        from = deepest.max(from + stride);
        stride *= 2.0;
    }
    None
}

/// The last place up to `until` at which `p` falls below zero; `until` where it does not.
pub(super) fn last_fall(p: &Polynomial, until: f64) -> f64 {
    let (mut last, mut from, mut stride) = (until, 0.0_f64, PRECISION);
    while from < until {
        let Some(fall) = p.first_fall(from, PRECISION).filter(|fall| *fall <= until) else { break };
        last = fall;
        from = fall + stride;
        stride *= 2.0;
    }
    last
}

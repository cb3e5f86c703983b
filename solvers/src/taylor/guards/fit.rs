//! How well the polynomial of a guard describes it on a step.

use super::super::polynomial::Polynomial;
use super::{NOISE, PRECISION};
use crate::event_location::GuardWatch;
use crate::system::System;

/// Largest error of a guard's polynomial, as a fraction of the guard's size, with which falls are read off it.
const MOST_ERROR: f64 = 1e-2;
/// What a polynomial shows is in doubt where it would fall if it were lower by this many of its errors.
const DOUBT: f64 = 4.0;
/// Fraction that is used of the estimated range of a polynomial, and the least that a step is shortened to at once.
const SAFETY: f64 = 0.9;
const SHORTER: f64 = 0.01;

/// How well the polynomial of a guard describes it on a step.
pub(super) enum Fit {
    /// On the whole step, with this largest error seen.
    Whole { error: f64 },
    /// On this fraction of the step, by an estimate.
    Part(f64),
}

/// How well the polynomial `p` of guard `i` on a step describes it. `None` where a coefficient is not finite. The guard is
/// to be evaluated at the middle and at the end.
pub(super) fn fit<P: System>(p: &Polynomial, i: usize, watch: &GuardWatch<P>) -> Option<Fit> {
    let c = p.coefficients();
    if c.iter().any(|c| !c.is_finite()) {
        return None;
    }
    let degree = c.len() - 1;
    let (middle, end) = (watch.middle(i), watch.value(i));
    if !middle.is_finite() {
        return Some(Fit::Part(0.5 * SAFETY));
    }
    // The error may happen to vanish at the middle and at the end; the last terms are of its size.
    let last = c[degree].abs().max(c[(degree - 1).max(1)].abs());
    let error = (p.at(0.5) - middle).abs().max((p.at(1.0) - end).abs()).max(last);
    let size = c[..2].iter().fold(middle.abs().max(end.abs()), |a, c| a.max(c.abs()));
    let allowed = watch.bound(i).max(MOST_ERROR * size);
    // A series whose terms grow ends before the step does.
    let before = c[degree.saturating_sub(2)..degree].iter().fold(0.0, |a: f64, c| a.max(c.abs()));
    if c[degree].abs() > before + watch.bound(i).max(NOISE * size) {
        return Some(Fit::Part((SAFETY * before / c[degree].abs()).max(SHORTER)));
    }
    if error <= allowed {
        return Some(Fit::Whole { error });
    }
    // An error of the next term would fall like this power of the step.
    let range = SAFETY * libm::pow(allowed / error, 1.0 / (degree + 1) as f64);
    Some(Fit::Part(range.max(SHORTER)))
}

/// Whether the polynomial `p` of a guard would fall if it were wrong by [more than](DOUBT) its `error`.
pub(super) fn may_fall(p: &Polynomial, error: f64) -> bool {
    let lowered = p.raised(-DOUBT * error);
    let [g_0, g_1] = [0, 1].map(|k| lowered.coefficients()[k]);
    g_0 < 0.0 && g_1 < 0.0 || lowered.first_fall(0.0, PRECISION).is_some()
}

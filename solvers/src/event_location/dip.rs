//! Dips of a guard that follows its cubic, by a polynomial through more of its values, and those that prove to be none.

use super::GuardWatch;
use super::shape::{N_NODES, sextic};
use crate::error::Error;
use crate::root::minimum;
use crate::step::Step;
use crate::system::System;

/// A minimum among the nodes of the polynomial is searched for on the dense output where it lies below this fraction
/// of the range. For the sine of three quarters of a period, the minimum may lie lower between two nodes by 0.7 % of
/// the range, and the error of the polynomial is 0.6 % of it.
const MISFIT: f64 = 0.02;
/// A dense output that has shown this many dips which retaken steps do not show is taken to be useless. In a step far beyond
/// the stability limit there may be millions.
const MOST_VAIN: usize = 100;

/// The dips on the dense output of the present step that retaken steps do not show.
pub(super) struct Disproved {
    /// Fraction of the step at which the dip of each guard that was found last is deepest.
    deepest: Vec<f64>,
    /// Fraction of the step up to which dips of each guard do not count.
    up_to: Vec<f64>,
    /// Number of such dips of all guards.
    n: usize,
}

impl Disproved {
    /// None of `n` guards.
    pub(super) fn new(n: usize) -> Self {
        Self { deepest: vec![0.0; n], up_to: vec![0.0; n], n: 0 }
    }

    /// Forgets those of a step that is over.
    pub(super) fn forget(&mut self) {
        if std::mem::take(&mut self.n) > 0 {
            self.up_to.fill(0.0);
        }
    }

    /// Notes that the dip of guard `i` found last is deepest at the fraction `theta` of the step.
    pub(super) fn found(&mut self, i: usize, theta: f64) {
        self.deepest[i] = theta;
    }

    /// Fraction of the step up to which dips of guard `i` do not count; zero where all do.
    pub(super) fn up_to(&self, i: usize) -> f64 {
        self.up_to[i]
    }

    /// Discards the dip of guard `i` found last, and returns the number of dips discarded so far.
    fn discard(&mut self, i: usize) -> usize {
        self.up_to[i] = self.deepest[i];
        self.n += 1;
        self.n
    }
}

impl<P: System> GuardWatch<P> {
    /// The same as [`first_dip`](Self::first_dip) by the polynomial of degree six; a dip is given by its deepest point.
    pub(super) fn dip(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        i: usize,
    ) -> (f64, Option<f64>) {
        let (t0, h) = (step.t0(), step.t1() - step.t0());
        let limit = self.touches.limits().as_ref()[i];
        let (g0, g1) = (self.start.as_ref()[i], self.end.as_ref()[i]);
        let quarters: [f64; 3] = std::array::from_fn(|k| self.quarters[k].as_ref()[i]);
        // A rate may be infinite where the guard is finite. The slope of the chord to the next quarter then replaces
        // it.
        let slope = |rate: f64, chord: f64| if rate.is_finite() { rate * h } else { 4.0 * chord };
        let slopes = [slope(g0.eps, quarters[0] - g0.re), slope(g1.eps, g1.re - quarters[2])];
        let nodes = sextic([g0.re, g1.re], slopes, quarters);
        let least = nodes.iter().fold(f64::INFINITY, |a, b| a.min(*b));
        let range = nodes.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b)) - least;
        let margin = 0.5 * self.bounds.as_ref()[i] + self.doubts.as_ref()[i];
        let at = |node: usize| node as f64 / N_NODES as f64;
        let mut top = 0;
        for k in 0..=N_NODES {
            if nodes[k] > nodes[top] {
                top = k;
            }
            let falls_to = if k == 0 { slopes[0] < 0.0 } else { nodes[k] <= nodes[k - 1] };
            let rises_from = if k == N_NODES { slopes[1] > 0.0 } else { nodes[k] < nodes[k + 1] };
            if !(falls_to && rises_from) {
                continue;
            }
            if nodes[k] < MISFIT * range {
                let (a, b) = (at(k.max(1) - 1), at((k + 1).min(N_NODES)));
                let above = |theta: f64| {
                    self.clearance_on(problem, mode.clone(), step, i, t0 + theta * h) + margin
                };
                let (theta, least) = minimum(above, [a, 0.5 * (a + b), b]);
                if least < 0.0 && theta > self.disproved.up_to(i) {
                    self.disproved.found(i, theta);
                    return (at(top), Some(theta));
                }
                if least >= 0.0 {
                    let height = least - margin - 0.5 * self.bounds.as_ref()[i];
                    self.touches.note(i, t0 + theta * h, height);
                }
            } else if nodes[k] < limit {
                self.touches.note(i, t0 + at(k) * h, nodes[k]);
            }
            top = k;
        }
        (at(top), None)
    }

    /// Discards the dip of guard `i` that the search found last: it and earlier ones on the dense output of the
    /// present step, of size `h` from `t`, do not count any more.
    ///
    /// # Errors
    /// [`Error::UnresolvedGuard`] where the dense output of the step shows one dip after another that is none.
    pub fn disprove_dip(
        &mut self,
        i: usize,
        (t, h): (f64, f64),
        mode: &P::Mode,
    ) -> Result<(), Error> {
        if self.disproved.discard(i) < MOST_VAIN {
            return Ok(());
        }
        Err(Error::UnresolvedGuard { t, h, mode: format!("{mode:?}"), guard: i })
    }

    /// Notes that a dip of guard `i` was found by other means than this search. Should it be disproved, then this search
    /// looks at the whole step.
    pub(crate) fn note_dip(&mut self, i: usize) {
        self.disproved.found(i, f64::MIN_POSITIVE);
    }

    /// Whether a dip of guard `i` in the present step was discarded.
    pub(crate) fn is_disproved(&self, i: usize) -> bool {
        self.disproved.up_to(i) > 0.0
    }
}

//! One step: the set of states at its end, and the guards on the way.

use super::expand::{Field, Jet, horner};
use super::interval::Interval;
use super::polynomial::Polynomial;
use super::set::Set;
use super::tube::Tube;
use crate::doubt::Doubt;
use crate::system::System;
use crate::tolerance::Tolerance;

/// Order of the polynomial of a step; the remainder is of the next order.
pub(super) const ORDER: usize = 15;
/// Safety factor of a step size.
const SAFETY: f64 = 0.9;
/// Factor of a step for which no box is found.
const WITHOUT_BOX: f64 = 0.5;

/// What holds over one span of time from a set of states.
pub(super) struct Step {
    t: f64,
    span: Interval,
    /// The coefficients of order `ORDER + 1` over the span.
    remainder: Vec<Interval>,
    /// The guards.
    pub(super) guards: Vec<Polynomial>,
    factor: f64,
}

/// A step, or why there is none of this length.
pub(super) enum Tried {
    Step(Step),
    /// It should be shorter by this factor.
    TooLong(f64),
}

impl Step {
    /// A step from `set` at `t` over `span`, which contains zero: solutions may have begun a little before `t`.
    pub(super) fn attempt<P: System>(
        field: &Field<'_, P>,
        t: f64,
        set: &Set,
        span: Interval,
        tolerance: &Tolerance,
    ) -> Result<Tried, Doubt> {
        let start = set.hull();
        let Tube::Box(tube) = field.tube(t, &start, span)? else {
            return Ok(Tried::TooLong(WITHOUT_BOX));
        };
        let over = Interval::from(t) + span;
        let Jet { mut y, g: mut last } = field.jet(over, &tube, ORDER + 1);
        let (remainder, last) = (y.swap_remove(ORDER + 1), last.swap_remove(ORDER + 1));
        let h = span.hi();
        let ratio = (0..start.len()).map(|i| {
            let allowed = tolerance.atol[i] + tolerance.rtol * start[i].mag();
            remainder[i].width() * libm::pow(h, (ORDER + 1) as f64) / allowed
        });
        let ratio = ratio.fold(f64::MIN_POSITIVE, f64::max);
        let factor = SAFETY * libm::pow(ratio, -1.0 / (ORDER + 1) as f64);
        if ratio.is_nan() || ratio > 1.0 {
            return Ok(Tried::TooLong(factor));
        }
        let jet = field.jet(Interval::from(t), &start, ORDER);
        let guard = |i: usize| {
            let coefficients = jet.g.iter().map(|g: &Vec<Interval>| g[i]).chain([last[i]]);
            Polynomial::new(coefficients.collect())
        };
        let guards = (0..last.len()).map(guard).collect();
        Ok(Tried::Step(Self { t, span, remainder, guards, factor }))
    }

    /// The span that it holds for, from its start.
    pub(super) fn span(&self) -> Interval {
        self.span
    }

    /// The factor by which another step from here should be longer or shorter.
    pub(super) fn factor(&self) -> f64 {
        self.factor
    }

    /// The set of states at the time `to` of the span, as if no guard fell before.
    ///
    /// ```text
    /// y(h) ∈ Σ_(k≤N) y_k(c) hᵏ + y_(N+1)(B) h^(N+1) + Σ_j r_j Σ_(k≤N) (∂y_k/∂a_j)(S) hᵏ
    /// ```
    ///
    /// with the middle `c`, the axes `a_j` and the hull `S` of the set, and the box `B` of the span.
    pub(super) fn end<P: System>(&self, field: &Field<'_, P>, set: &Set, to: f64) -> Option<Set> {
        let (t, h) = (Interval::from(self.t), Interval::from(to) - self.t);
        let mut of_center = field.jet(t, &set.center(), ORDER).y;
        of_center.push(self.remainder.clone());
        let hull = set.hull();
        let column = |axis: &Vec<f64>| horner(&field.derivative(t, &hull, axis, ORDER), h);
        let columns: Vec<_> = set.axes.iter().map(column).collect();
        set.image(&horner(&of_center, h), &columns)
    }
}

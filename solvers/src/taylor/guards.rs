//! Guards along a step as polynomials, and the time at which the first of them falls.

mod fall;
mod fit;
#[cfg(test)]
mod tests;

use fall::{Fall, fall_of, last_fall};
use fit::{Fit, fit, may_fall};

use super::coefficient::Coefficient;
use super::expand::{FIRST_LOOK, GuardsRun, Run, SeriesField};
use super::method::TaylorStep;
use super::polynomial::Polynomial;
use super::rows::Rows;
use super::trace::Trace;
use super::unrolled::OfOrder;
use crate::erk::InMode;
use crate::error::Error;
use crate::event_location::{GuardCrossing, GuardWatch};
use crate::real::{Ordered, Real};
use crate::root::minimum;
use crate::step::Step;
use crate::system::{System, Vector};

/// Terms that grow are of no account below this fraction of the guard.
const NOISE: f64 = 1e-9;
/// Precision of the roots of the polynomials, as a fraction of the step.
const PRECISION: f64 = 1e-14;
/// A step is not shortened further for the sake of a guard where it is below this fraction of its size, or below this
/// fraction of the time, within which its middle and its end are rounded.
const LEAST_RANGE: f64 = 1e-3;
const LEAST_STEP: f64 = 1e3 * f64::EPSILON;

/// Parts of a step in each of which a guard that is not clear is taken to turn once at most. By four parts four of 40 000 random
/// runs of `tests/grazing` lost a touch, with a maximum right after it; by sixteen none.
const TURNS: usize = 16;

/// A step whose guards are searched.
pub struct StepSeries<'a, P: System, B: Real> {
    /// The step in plain precision.
    pub step: &'a dyn Step<P::State<f64>>,
    /// The series of its states, in the precision of the run.
    pub series: &'a TaylorStep<P::State<B>, B>,
    /// Its size before it was [shortened](Look::Within) for the sake of a guard.
    pub whole: f64,
}

impl<P: System, B: Real> StepSeries<'_, P, B> {
    /// Time at the start, and size.
    fn start_and_size(&self) -> (f64, f64) {
        let start = self.step.t0();
        (start, self.step.t1() - start)
    }

    /// Whether it is long enough to be shortened for the sake of a guard.
    fn may_be_shortened(&self) -> bool {
        let (start, h) = self.start_and_size();
        let time = self.step.t1().abs().max(start.abs());
        h.abs() > (LEAST_RANGE * self.whole.abs()).max(LEAST_STEP * time)
    }
}

/// What the guards of a step show.
#[derive(Clone, Copy, Debug)]
pub enum Look {
    /// No guard falls.
    Clear,
    /// The guard that falls first.
    Falls(GuardCrossing),
    /// The polynomial of a guard describes it on this fraction of the step only. The step is to be shortened to it.
    Within(f64),
}

impl Look {
    fn of(crossing: Option<GuardCrossing>) -> Self {
        crossing.map_or(Self::Clear, Self::Falls)
    }
}

/// The Taylor coefficients of the guards about the start of a step.
///
/// The coefficients of low orders are computed together with the series of the solution. Where they do not suffice to
/// show that the guards stay above zero, the guards alone are expanded to the full degree.
#[derive(Debug)]
pub struct GuardSeries<G, B: Copy> {
    g: Vec<G>,
    /// Values at the end of the step.
    pub(crate) end: G,
    /// The table of an expansion of the guards alone.
    rows: Rows<B>,
    /// The same of a system that is traced.
    trace: Trace<B>,
    /// Number of orders known from that expansion.
    n_alone: usize,
}

impl<G: Vector<B::Rounded>, B: Coefficient> GuardSeries<G, B> {
    /// Workspace for `n` guards to `order`, which must be at least one.
    pub fn new(n: usize, order: usize) -> Self {
        let zeros = || G::from_fn(n, |_| B::Rounded::cst(0.0));
        let g = (0..=order).map(|_| zeros()).collect();
        Self { g, end: zeros(), rows: Rows::new(), trace: Trace::default(), n_alone: 0 }
    }

    /// The values at the start, for the caller to write.
    pub(crate) fn start(&mut self) -> &mut G {
        &mut self.g[0]
    }

    /// All coefficients by order.
    #[cfg(test)]
    pub(super) fn coefficients(&self) -> &[G] {
        &self.g
    }

    /// Makes the end of the last step the start of the next one.
    #[inline(always)]
    pub(crate) fn advance(&mut self) {
        std::mem::swap(&mut self.g[0], &mut self.end);
    }

    /// The coefficients of low orders, for the caller to write from order one on.
    #[inline(always)]
    pub(crate) fn low(&mut self) -> &mut [G] {
        self.n_alone = 0;
        let highest = self.highest_low();
        &mut self.g[..=highest]
    }

    /// The highest of the low orders: one less than that of the series where this is low. The last coefficients of the
    /// states come from slopes of one order less, and the guards are evaluated with these.
    #[inline(always)]
    pub(crate) fn highest_low(&self) -> usize {
        (self.g.len() - 2).min(FIRST_LOOK)
    }

    /// Copies the low orders and the end from the series of several runs; `pick` selects this run.
    pub(crate) fn take<L: Vector<C::Rounded>, C: Coefficient>(
        &mut self,
        all: &GuardSeries<L, C>,
        pick: impl Fn(&L, &mut G),
    ) {
        all.g.iter().zip(self.low()).for_each(|(all, own)| pick(all, own));
        pick(&all.end, &mut self.end);
    }

    /// Computes all coefficients up to `order` from the coefficients `y` of the solution.
    pub(super) fn expand<P: System<Guards<B::Rounded> = G>, F: SeriesField<P, B>>(
        &mut self,
        field: &F,
        t0: B,
        y: &[P::State<B>],
        order: usize,
    ) {
        if const { F::IS_TRACED } {
            if let Some(field) = field.in_mode() {
                self.expand_traced(field, t0, y, order);
            }
            return;
        }
        while self.n_alone <= order {
            let k = self.n_alone;
            let run = Run { rows: &self.rows, t0, field };
            let n = GuardsRun::<P, B, _> { run, y: &y[k], g: &mut self.g[k] }.unrolled(k);
            let is_short = self.rows.grow(n);
            self.n_alone = if is_short { 0 } else { k + 1 };
        }
    }

    /// The same by a trace.
    fn expand_traced<P: System<Guards<B::Rounded> = G>>(
        &mut self,
        field: &InMode<'_, P>,
        t0: B,
        y: &[P::State<B>],
        order: usize,
    ) {
        for k in self.n_alone..=order {
            if k == 0 {
                self.trace.begin_guards(field, (t0, &y[0]), &mut self.g[0]);
            } else {
                self.trace.advance(k, y[k].as_ref(), true);
                self.trace.write_guards(self.g[k].as_mut());
            }
        }
        self.n_alone = self.n_alone.max(order + 1);
    }

    /// Whether guard `i`, whose value at the end of a step of size `h` is `end`, stays above zero on the step by more
    /// than its last two terms and the error of the polynomial at the end, and whether its last term, without what is
    /// `explained` of that coefficient by the states, is no larger than those before: a series whose terms grow tells nothing of
    /// a guard that moves faster than the states. Besides, a number that is zero or more where such
    /// a guard does not turn below `limit`: it does not fall at the start, or falls at the end by more than its last two terms,
    /// or is above `limit`.
    #[inline]
    pub(crate) fn look(
        &self,
        i: usize,
        h: B::Rounded,
        degree: usize,
        (end, limit): (B::Rounded, B::Rounded),
        explained: B::Rounded,
    ) -> (<B::Rounded as Ordered>::Mask, B::Rounded) {
        let zero = B::Rounded::cst(0.0);
        let g_0 = self.g[0].as_ref()[i];
        let (mut sum, mut least, mut power) = (g_0, g_0, B::Rounded::cst(1.0));
        let (mut last, mut sums) = ([zero; 3], zero);
        for g in &self.g[1..=degree] {
            power = power * h;
            let term = g.as_ref()[i] * power;
            sums = sums + sum;
            sum = sum + term;
            least = least + term.lesser(zero);
            last = [last[1], last[2], term];
        }
        let own = (last[2] - explained * power).abs();
        let [before, last_but_one, last] = last.map(Real::abs);
        let of_last = last_but_one + last;
        // With s_j the sum to order j, Σ_k≤N k g_k hᵏ = N s_N − Σ_j<N s_j. What the sum lacks at the end is taken for a
        // term of the next order.
        let falls_at_end = sums + sum - end * (degree + 1) as f64 - of_last;
        let no_turn = (self.g[1].as_ref()[i] * h).larger(falls_at_end).larger(least - limit);
        let falls_off = (before.larger(last_but_one) + g_0 * NOISE).is_above(own);
        // False where a value is NaN.
        (least.is_above(of_last + (sum - end).abs() * 2.0) & falls_off, no_turn)
    }

    /// Notes the turns of guards that are all clear on a step of size `h` from `t0`. One of them turns once at most: else its
    /// terms would not show it clear. `pick` selects a run.
    #[cold]
    #[inline(never)]
    pub(crate) fn note_turns_of_clear<P: System>(
        &self,
        of_step: (f64, f64),
        pick: impl Fn(&B::Rounded) -> f64,
        watch: &mut GuardWatch<P>,
    ) {
        let low = &self.g[..=self.highest_low()];
        for i in 0..self.end.as_ref().len() {
            if pick(&self.g[1].as_ref()[i]) * of_step.1 < 0.0 {
                let p = polynomial_of(low.iter().map(|g| pick(&g.as_ref()[i])), of_step.1);
                note_turns::<P, 1>(p, pick(&self.end.as_ref()[i]), i, of_step, watch);
            }
        }
    }
}

impl<G: Vector<f64>, B: Coefficient<Rounded = f64>> GuardSeries<G, B> {
    /// Guard `i` over a step of size `h` as a polynomial of `degree`.
    fn polynomial(&self, i: usize, h: f64, degree: usize) -> Polynomial {
        polynomial_of(self.g[..=degree].iter().map(|g| g.as_ref()[i]), h)
    }

    /// Looks for the guard that falls first on the step `of` a series. Where no guard falls, the end then becomes the start of
    /// the next step.
    ///
    /// To the order of the method a guard is a polynomial on the step. The guard is clear where
    ///
    /// ```text
    /// g_0 + Σ min(0, g_k hᵏ) > |g_N hᴺ| + |g_(N−1) hᴺ⁻¹| + 2 |Σ g_k hᵏ − g(t_1, y_1)|
    /// ```
    ///
    /// with N the least of 5, the degree, and the order less one. Otherwise the [first fall](Polynomial::first_fall)
    /// of its polynomial below `−bound/2` counts, if a violation follows it. No fall of the polynomial is missed,
    /// except a dip that is made by terms beyond the fifth alone and that has vanished at the end.
    ///
    /// The series of a guard may converge on less than the step: the distance of a pin from the centre of its bush has
    /// a series that ends where the pin passes the centre, whatever the series of the pin. Where the polynomial differs
    /// from its guard, at the middle or at the end of the step or by its last two terms, by more than 1 % of the largest of
    /// `|g_0|`, `|g_1 h|` and the guard there, and by more than its rounding bound, the step is to be
    /// [shortened](Look::Within). A step shorter than a thousandth of the whole one or some ulps of the time is not,
    /// nor one where a coefficient is not finite: the [search](GuardWatch) on values and rates is then used for all guards. It is
    /// also used where a polynomial does not fall, but would if it were wrong by a few of the errors seen, and after a dip of
    /// the polynomial that the retaken step did not show.
    ///
    /// # Errors
    /// [`Error::NonFiniteGuard`] for a guard that is not finite at the end of the step, [`Error::UnresolvedGuard`] for one
    /// that cannot be followed.
    pub fn first_to_fall<P: System<Guards<f64> = G>>(
        &mut self,
        problem: &P,
        mode: P::Mode,
        of: &StepSeries<'_, P, B>,
        watch: &mut GuardWatch<P>,
    ) -> Result<Look, Error> {
        let StepSeries { step, series: TaylorStep { y, degree, .. }, .. } = of;
        let ((start, h), t1) = (of.start_and_size(), step.t1());
        let low = self.highest_low().min(*degree);
        watch.touches.begin_search();
        let nothing = |_: &GuardWatch<P>, _: usize| 0.0;
        if self.are_clear((start, h), low, nothing, watch) {
            return Ok(Look::Clear);
        }
        // Where states swing a little, and a step is most of a turn, their terms grow at first, too. What they make of the
        // term of a guard is followed as well as they are.
        let of_states = P::State::from_fn(y[0].as_ref().len(), |i| y[low].as_ref()[i].rounded());
        watch.look_along(problem, mode.clone(), (start, step.y0()), &of_states);
        if self.are_clear((start, h), low, GuardWatch::slope_along, watch) {
            return Ok(Look::Clear);
        }
        watch.violated(problem, mode.clone(), t1, step.y1())?;
        watch.look_at_middle(problem, mode.clone(), *step);
        let field = InMode { problem, mode: &mode };
        // Of guards that fall at the same time to rounding, the one with the lowest index comes first.
        let tie = 4.0 * f64::EPSILON * t1.abs().max(start.abs());
        let is_before =
            |t: f64, other: GuardCrossing| (t - start).abs() < (other.t - start).abs() - tie;
        let mut first: Option<GuardCrossing> = None;
        for guard in 0..self.g[0].as_ref().len() {
            match self.look_at(guard, &field, of, watch) {
                Some(Look::Clear) => {}
                Some(Look::Falls(crossing)) => {
                    if first.is_none_or(|other| is_before(crossing.t, other)) {
                        first = Some(crossing);
                    }
                }
                Some(Look::Within(range)) => return Ok(Look::Within(range)),
                None => return self.by_values(problem, mode, *step, watch),
            }
        }
        if first.is_none() {
            watch.advance();
        }
        Ok(Look::of(first))
    }

    /// What `guard` shows on the step `of` a series, if its polynomial tells it; `None` where all guards are to be searched by
    /// values and rates. It is to be evaluated at the middle and at the end, and along the last of the low orders.
    fn look_at<P: System<Guards<f64> = G>>(
        &mut self,
        guard: usize,
        field: &InMode<'_, P>,
        of: &StepSeries<'_, P, B>,
        watch: &mut GuardWatch<P>,
    ) -> Option<Look> {
        let StepSeries { step, series: TaylorStep { t0, y, degree, .. }, .. } = of;
        let (start, h) = of.start_and_size();
        let low = self.highest_low().min(*degree);
        let (at_end, end) = (watch.is_violated(guard), watch.value(guard));
        let explained = watch.slope_along(guard);
        if !at_end && self.look(guard, h, low, (end, f64::INFINITY), explained).0 {
            if self.g[1].as_ref()[guard] * h < 0.0 {
                let p = self.polynomial(guard, h, low);
                note_turns::<P, 1>(p, end, guard, (start, h), watch);
            }
            return Some(Look::Clear);
        }
        self.expand(field, *t0, y, *degree);
        let p = self.polynomial(guard, h, *degree);
        let error = match fit(&p, guard, watch)? {
            Fit::Whole { error } => error,
            Fit::Part(range) => return of.may_be_shortened().then_some(Look::Within(range)),
        };
        note_turns::<P, TURNS>(p, end, guard, (start, h), watch);
        if !at_end && self.look(guard, h, *degree, (end, f64::INFINITY), 0.0).0 {
            return Some(Look::Clear);
        }
        if watch.is_disproved(guard) {
            return None;
        }
        let Some((s, violated)) = fall_on_step(&p, guard, watch) else {
            let is_in_doubt = error > watch.bound(guard) && may_fall(&p, error);
            return (!is_in_doubt).then_some(Look::Clear);
        };
        let inside = violated.map(|part| start + part * h);
        let inside = inside.filter(|t| (t - start).abs() < h.abs());
        let violated_at = inside.or(at_end.then_some(step.t1()));
        let t = start + s * h;
        Some(Look::of(violated_at.map(|violated_at| GuardCrossing { guard, t, violated_at })))
    }

    /// Whether all guards are clear on a step of size `h` from `start`, by their terms to the order `low`, of the last of which
    /// so much is `explained` by the states.
    #[inline(always)]
    fn are_clear<P: System<Guards<f64> = G>>(
        &mut self,
        (start, h): (f64, f64),
        low: usize,
        explained: impl Fn(&GuardWatch<P>, usize) -> f64,
        watch: &mut GuardWatch<P>,
    ) -> bool {
        let ends = self.end.as_ref().iter().zip(watch.touches.limits().as_ref()).enumerate();
        // All guards are tested without a branch between them. Where all are clear, none is violated at the end.
        let (all, high) = ends.fold((true, true), |(all, high), (guard, (end, limit))| {
            let explained = explained(watch, guard);
            let (is_clear, no_turn) = self.look(guard, h, low, (*end, *limit), explained);
            (all & is_clear, high & (no_turn >= 0.0))
        });
        if all {
            if !high {
                self.note_turns_of_clear((start, h), |x| *x, watch);
            }
            watch.advance();
        }
        all
    }

    /// The guard that falls first by the search on values and rates, where no polynomial describes a guard.
    fn by_values<P: System<Guards<f64> = G>>(
        &self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        watch: &mut GuardWatch<P>,
    ) -> Result<Look, Error> {
        watch.start_at(problem, mode.clone(), step.t0(), step.y0(), step.slope0());
        if watch.is_clear(problem, mode.clone(), step) {
            return Ok(Look::Clear);
        }
        watch.first_to_fall(problem, mode, step, PRECISION, None).map(Look::of)
    }

    /// The rate of guard `i` at the time `s` after the start of the step, from its polynomial of `degree`.
    #[cfg(feature = "extended")]
    pub(super) fn rate(&self, i: usize, s: f64, degree: usize) -> f64 {
        let terms = self.g[1..=degree].iter().enumerate().rev();
        terms.fold(0.0, |sum, (k, g)| sum * s + (k + 1) as f64 * g.as_ref()[i])
    }
}

/// The polynomial on [0, 1] of a guard with these Taylor coefficients over a step of size `h`.
#[inline(always)]
fn polynomial_of(coefficients: impl ExactSizeIterator<Item = f64>, h: f64) -> Polynomial {
    let mut power = 1.0;
    Polynomial::new(coefficients.map(|c| {
        let term = c * power;
        power *= h;
        term
    }))
}

/// Notes the turns of guard `i` on a step of size `h` from `t0`, one in each of `N` equal parts at most, by its polynomial
/// `p` on the step. What that lacks at the `end` is taken for a term of the next order.
fn note_turns<P: System, const N: usize>(
    mut p: Polynomial,
    end: f64,
    i: usize,
    (t0, h): (f64, f64),
    watch: &mut GuardWatch<P>,
) {
    let limit = watch.touches.limits().as_ref()[i];
    // False where no touches are to be noted.
    if p.lower_bound() < limit {
        p.extend_to(end);
        p.minima::<N>(limit, |s, least| watch.touches.note(i, t0 + s * h, least));
    }
}

/// The fall of guard `i` by its polynomial `p` on a step, as a fraction of the step, and the fraction at which it is then
/// violated, `None` for the end of the step. The guard is to be evaluated at the end.
fn fall_on_step<P: System>(
    p: &Polynomial,
    i: usize,
    watch: &mut GuardWatch<P>,
) -> Option<(f64, Option<f64>)> {
    let (at_end, raised) = (watch.is_violated(i), p.raised(0.5 * watch.bound(i)));
    if at_end && let Some(at) = raised.only_fall(PRECISION) {
        return Some((at, None));
    }
    match fall_of(p, watch.bound(i)) {
        Some(Fall { at, rises: false, .. }) if at_end => Some((at, None)),
        Some(Fall { at, mut deepest, .. }) => {
            if deepest == 1.0 {
                // The polynomial does not rise before the end, but the guard does.
                deepest = minimum(|s| p.at(s), [at, 0.5 * (at + 1.0), 1.0]).0;
            }
            watch.note_dip(i);
            Some((at, Some(deepest)))
        }
        None => at_end.then(|| (last_fall(&raised, 1.0), None)),
    }
}

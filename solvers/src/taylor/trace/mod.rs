//! The evaluation trace of a right-hand side, and the Taylor series that follows from it without a further evaluation.
//!
//! One evaluation at the start of a step notes its operations. For orders `k ≥ 1`, the coefficient of a result is a linear
//! function of those of its operands, and a sum over lower orders:
//!
//! ```text
//! c_k = α a_k + β b_k + s_k
//! ```
//!
//! | | α | β | s_k |
//! |---|---|---|---|
//! | `c = a b` | b_0 | a_0 | Σ a_j b_(k−j) |
//! | `c = a/b` | 1/b_0 | −c_0/b_0 | −Σ c_j b_(k−j)/b_0 |
//! | `c = √a` | 1/(2 c_0) | | −Σ c_j c_(k−j)/(2 c_0) |
//! | `c = sin a`, and cos in its turn | cos a_0 | | Σ j a_j (cos a)_(k−j)/k |
//!
//! over `j = 1 … k − 1`, and so on. A multiple of a result, and a result plus a constant, are kept as such and need no
//! operation. What has another result as its derivative, as a [length](crate::real::Shortcuts::length) has, follows from it: `c_k = a_(k−1)/k`.
//! An order is computed in three steps: first what has a derivative; then all sums, one kind after the other; then one pass
//! through the operations. The right-hand side is not called, and what it decides it decides once a step, on values.
//!
//! A. Griewank, A. Walther, *Evaluating Derivatives*, 2nd ed., SIAM (2008), chapter 2 and section 13.2.

mod notes;
mod number;
mod operators;
mod sums;

use std::cell::RefCell;

use super::coefficient::Coefficient;
use super::recurrence::reciprocal;
use super::unrolled::OfOrder;
use crate::erk::InMode;
use crate::real::Real;
use crate::system::{System, Vector};
use notes::{Derivative, Notes, Operation, Place, STATES, TIME, Written};
pub use number::Noted;
use sums::Sums;

/// The operations of one evaluation, noted through shared references by the [numbers](Noted) that it computes with.
#[derive(Debug)]
pub struct Trace<B: Copy> {
    notes: RefCell<Notes<B>>,
}

impl<B: Coefficient> Default for Trace<B> {
    fn default() -> Self {
        Self { notes: RefCell::new(Notes::default()) }
    }
}

impl<B: Coefficient> Trace<B> {
    /// Notes the operations of the right-hand side and the guards at `(t, y)`, and writes their values.
    ///
    /// # Panics
    /// In a build with debug assertions, where a [curve](crate::real::Shortcuts::turning) was not ended.
    pub(crate) fn begin<P: System>(
        &mut self,
        field: &InMode<'_, P>,
        (t, y): (B, &P::State<B>),
        slope: &mut P::State<B>,
        guards: &mut P::Guards<B::Rounded>,
    ) {
        self.clear();
        let (t, y) = self.start::<P::State<_>>(t, y.as_ref());
        let mut dydt = zeros::<B, P::State<_>>(slope.as_ref().len());
        let mut g = zeros::<B, P::Guards<_>>(guards.as_ref().len());
        let InMode { problem, mode } = field;
        if !problem.rhs_with_guards((*mode).clone(), t, &y, &mut dydt, &mut g) {
            problem.rhs((*mode).clone(), t, &y, &mut dydt);
            problem.guards((*mode).clone(), t, &y, &mut g);
        }
        for (slope, traced) in slope.as_mut().iter_mut().zip(dydt.as_ref()) {
            *slope = traced.number();
        }
        self.end(dydt.as_ref(), g.as_ref(), guards.as_mut());
    }

    /// The same of the guards alone.
    pub(crate) fn begin_guards<P: System>(
        &mut self,
        field: &InMode<'_, P>,
        (t, y): (B, &P::State<B>),
        guards: &mut P::Guards<B::Rounded>,
    ) {
        self.clear();
        let (t, y) = self.start::<P::State<_>>(t, y.as_ref());
        let mut g = zeros::<B, P::Guards<_>>(guards.as_ref().len());
        field.problem.guards(field.mode.clone(), t, &y, &mut g);
        self.end(&[], g.as_ref(), guards.as_mut());
    }

    fn clear(&mut self) {
        self.notes.get_mut().clear();
    }

    /// Time and states, as numbers that note what is computed with them.
    fn start<'s, Y: Vector<Noted<'s, B>>>(&'s self, t: B, y: &[B]) -> (Noted<'s, B>, Y) {
        let mut notes = self.notes.borrow_mut();
        for value in [B::cst(0.0), t].iter().chain(y) {
            notes.place(*value);
        }
        let state = |i| Noted::at(self, STATES + i as Place, y[i]);
        (Noted::at(self, TIME, t), Y::from_fn(y.len(), state))
    }

    fn end(&self, slopes: &[Noted<'_, B>], g: &[Noted<'_, B>], guards: &mut [B::Rounded]) {
        let mut notes = self.notes.borrow_mut();
        debug_assert_eq!(notes.open_curves, 0, "a curve that turns was not ended");
        notes.slopes.extend(slopes.iter().map(|slope| slope.term()));
        notes.guards.extend(g.iter().map(|guard| guard.term()));
        for (guard, traced) in guards.iter_mut().zip(g) {
            *guard = traced.number().rounded();
        }
        notes.of_slopes = notes.extent_to(notes.last_of_slopes());
        let n_sums = notes.n_sums as usize;
        notes.sums_of_order.resize(n_sums, B::cst(0.0));
    }

    /// Number of results, time and states among them.
    pub(crate) fn n_results(&self) -> usize {
        self.notes.borrow().coefficients.len() - 1
    }

    /// Computes the coefficients of order `k`, after those of the order before; `y` are those of the states. Without
    /// `guards`, those of the slopes alone.
    pub(crate) fn advance(&mut self, k: usize, y: &[B], guards: bool) {
        let notes = self.notes.get_mut();
        let extent = if guards { notes.all() } else { notes.of_slopes };
        let share = reciprocal::<B>(k);
        // In the order in which they were noted: the derivative of a derivative comes later.
        for Derivative { to, of } in &notes.derivatives {
            notes.coefficients[*to as usize] = notes.coefficients[*of as usize] * share;
        }
        notes.coefficients[TIME as usize] = B::cst(if k == 1 { 1.0 } else { 0.0 });
        let first = STATES as usize;
        notes.coefficients[first..first + y.len()].copy_from_slice(y);
        notes.write(k, Written::Early);
        Sums { notes, extent }.unrolled(k);
        let sums = &notes.sums_of_order;
        let c = &mut notes.coefficients;
        for Operation { to, of, factors: [alpha, beta], sum } in
            &notes.operations[..extent.operations]
        {
            let [a, b] = of.map(|place| c[place as usize]);
            c[*to as usize] = B::fma(*beta, b, B::fma(*alpha, a, sums[*sum as usize]));
        }
        notes.write(k, Written::Plainly);
        notes.write(k, Written::Weighed);
    }

    /// Writes what the coefficients of the slopes, of the order `k` that was computed last, give for the states of the next
    /// order.
    pub(crate) fn write_next(&mut self, k: usize, next: &mut [B]) {
        let notes = self.notes.get_mut();
        let share = reciprocal::<B>(k + 1);
        for (next, (place, factor)) in next.iter_mut().zip(&notes.slopes) {
            *next = notes.coefficients[*place as usize] * *factor * share;
        }
    }

    /// Writes the coefficients of the guards, of the order that was computed last.
    pub(crate) fn write_guards(&mut self, g: &mut [B::Rounded]) {
        let notes = self.notes.get_mut();
        for (g, (place, factor)) in g.iter_mut().zip(&notes.guards) {
            *g = (notes.coefficients[*place as usize] * *factor).rounded();
        }
    }
}

fn zeros<'s, B: Coefficient + 's, Y: Vector<Noted<'s, B>>>(n: usize) -> Y {
    Y::from_fn(n, |_| Noted::cst(0.0))
}

#[cfg(test)]
mod tests;

//! A method that decides by itself: explicit where its step is bound by accuracy, implicit where it is
//! bound by stability.
//!
//! An explicit pair and [`RADAU_IIA_5`](crate::methods::RADAU_IIA_5) take turns; either hands over at the
//! end of an accepted step, where the other begins as at the start of a phase. Events are those of the
//! half whose step they lie on. The pair is chosen by the tolerance, measured on the contact of
//! `deltazero`: [`DORMAND_PRINCE_5`](crate::methods::DORMAND_PRINCE_5) for
//! `rtol ≥ 1e-4`, [`DORMAND_PRINCE_853`](crate::methods::DORMAND_PRINCE_853) below. The implicit
//! half is held to 0.1 of the tolerance, where its error is about that of the explicit one (0.01 to 0.1 there,
//! measured): a few of its steps do not spoil a run.
//!
//! # The rule
//!
//! Work is counted in right-hand sides; an attempt of an implicit step is taken for 40 of them. With ρ, the
//! spectral radius of the Jacobian, by power iteration:
//!
//! - A phase begins explicit. Every 512 right-hand sides, those of earlier phases with them, where `hρ > 1`
//!   with the mean step h, that may be bound by stability, and implicit steps are tried: one *pays* where it
//!   is as long as what the explicit half comes forward with the same work.
//! - A trial begins with 0.4 of that and is kept if its step pays after eight attempts.
//! - Implicit goes on while its equations can be solved and eight attempts together pay; what pays is
//!   measured anew after them: an explicit step that is bound by stability is as long as 1/ρ.
//! - Then the explicit half goes on. A turn that ends doubles the 512 until the next trial, up to 8192; after
//!   steps that paid they are 128, in the next phase too, for one that is stiff is seldom alone.
//!
//! So a trial that fails costs some 300 right-hand sides, and all of them together a small part of a run.
//! A system whose `hρ` stays below one is integrated by the explicit pair, bit for bit; the only price is one
//! Jacobian for 512 right-hand sides. No decision looks at a clock: a run repeats.
//!
//! What was chosen: [`Stats::n_implicit`] counts the implicit ones among the accepted steps.

mod pilot;
mod spectrum;

use crate::control::Control;
use crate::error::Error;
use crate::one_step::{OneStep, OneStepSolver};
use crate::phase::{PhaseEnd, PhaseSolver, Point};
use crate::radau::RadauMethod;
use crate::record::Record;
use crate::stats::Stats;
use crate::system::System;
use crate::tolerance::Tolerance;
use pilot::{Leg, Pilot, Turn};

/// Least relative tolerance at which the fifth-order pair is the explicit half.
pub(crate) const LOOSE: f64 = 1e-4;

/// Part of the tolerance that the implicit half is held to.
const IMPLICIT_SHARE: f64 = 0.1;

/// Both halves at work on one system.
pub(crate) struct AutoSolver<P: System, E> {
    explicit: OneStepSolver<P, E>,
    implicit: OneStepSolver<P, RadauMethod<P::State<f64>>>,
    pilot: Pilot,
}

impl<P: System, E: OneStep<P>> AutoSolver<P, E> {
    /// `explicit` and what `implicit` makes of its control on `problem`, to `tolerance`.
    pub(crate) fn new(
        problem: &P,
        explicit: E,
        implicit: impl FnOnce(&Control) -> RadauMethod<P::State<f64>>,
        tolerance: Tolerance,
    ) -> Self {
        let held = Control::Adaptive(Tolerance {
            rtol: IMPLICIT_SHARE * tolerance.rtol,
            atol: tolerance.atol.iter().map(|atol| IMPLICIT_SHARE * atol).collect(),
        });
        let implicit = implicit(&held);
        Self {
            explicit: OneStepSolver::new(problem, explicit, Control::Adaptive(tolerance)),
            implicit: OneStepSolver::new(problem, implicit, held),
            pilot: Pilot::new(problem.dim()),
        }
    }
}

impl<P: System, E: OneStep<P>> PhaseSolver<P> for AutoSolver<P, E> {
    fn solve_phase(
        &mut self,
        problem: &P,
        point: &mut Point<P>,
        t_end: f64,
        stats: &mut Stats,
        record: &mut dyn Record<P>,
    ) -> Result<PhaseEnd, Error> {
        let mut next = self.pilot.begin_phase(problem, point, stats);
        loop {
            let is_explicit = !matches!(next, Some(Turn::Implicit { .. }));
            match next {
                None => {}
                Some(Turn::Explicit { h }) => self.explicit.begin_with(h),
                Some(Turn::Implicit { h }) => self.implicit.begin_with(h),
            }
            let half: &mut dyn PhaseSolver<P> =
                if is_explicit { &mut self.explicit } else { &mut self.implicit };
            let mut leg = Leg::new(&mut self.pilot, problem, record, point.t, stats);
            let end = half.solve_phase(problem, point, t_end, stats, &mut leg);
            next = leg.over(stats);
            match end {
                Err(Error::NoConvergence { .. }) if !is_explicit => self.pilot.give_up(),
                Ok(PhaseEnd::Interrupted) if next.is_some() => {}
                end => return end,
            }
        }
    }
}

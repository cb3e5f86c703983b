//! A method that decides by itself: explicit where its step is bound by accuracy, implicit where it is
//! bound by stability.
//!
//! An explicit pair and [`RADAU_IIA_5`](crate::methods::RADAU_IIA_5) take turns; either hands over at the
//! end of an accepted step, where the other begins as at the start of a phase. Events are those of the
//! half whose step they lie on. The pair is chosen by the tolerance, measured on the contact of
//! `deltazero`: [`KUTTA_43`](crate::methods::KUTTA_43) for
//! `rtol ≥ 1e-4`, [`DORMAND_PRINCE_853`](crate::methods::DORMAND_PRINCE_853) below. The implicit
//! half is held to 0.1 of the tolerance, where its error is about that of the explicit one (0.01 to 0.1 there,
//! measured): a few of its steps do not spoil a run.
//!
//! # The rule
//!
//! Work is counted in right-hand sides; an attempt of an implicit step is taken for 40 of them. With ρ, the
//! spectral radius of the Jacobian at the start of the phase, by power iteration:
//!
//! - An explicit step is not longer than `2.5/ρ`, inside its bound of stability there; a look at ρ that finds
//!   it halved lets steps grow, one that finds it grown is no bound before the next turn.
//!   At the bound, error control would keep errors of the size of the tolerance alive: a contact stiffer than
//!   the tolerance resolves then opens and closes by noise, and every second step is rejected.
//! - A run begins explicit. Every 2048 right-hand sides, those of earlier phases with them, where `hρ > 1.5`
//!   with the mean step h, that may be bound by stability, and implicit steps are tried: one *pays* where it
//!   is as long as what the explicit half comes forward with the same work.
//! - A trial begins with 0.4 of that and is kept if its step pays after eight attempts.
//! - Implicit goes on while its equations can be solved and eight attempts together pay; what pays is
//!   measured anew after them: an explicit step that is bound by stability is as long as 1/ρ. Phases that
//!   follow begin implicit where their ρ is at least half of that.
//! - Then the explicit half goes on. A turn that ends doubles the 2048 until the next trial, up to 8192; after
//!   steps that paid they are 128.
//!
//! So a trial that fails costs some 300 right-hand sides, and all of them together a small part of a run.
//! A system whose `hρ` stays below 1.5, ρ that of the phase's start, is integrated by the explicit pair, bit for
//! bit; the only price is one Jacobian a phase, and one for 2048 right-hand sides. No decision looks at a clock:
//! a run repeats.
//!
//! What was chosen: [`Stats::n_implicit`] counts the implicit ones among the accepted steps.

mod pilot;
mod spectrum;

use crate::control::Control;
use crate::error::Error;
use crate::one_step::Paced;
use crate::phase::{PhaseEnd, PhaseSolver, Point};
use crate::record::Record;
use crate::stats::Stats;
use crate::system::System;
use crate::tolerance::Tolerance;
use pilot::{Leg, Pilot, Turn};

/// Least relative tolerance at which the fourth-order pair is the explicit half.
pub(crate) const LOOSE: f64 = 1e-4;

/// `hρ` of the longest explicit step: both pairs are stable there for decay and, the fourth-order one, for
/// oscillation too. Of 2 to 2.6 (fourth order) and 1 to 3 (eighth), measured on contacts at e ≤ 1e-3 and 1e-6,
/// about the least work, with room for what ρ is off by.
const REACH: f64 = 2.5;

/// Part of the tolerance that the implicit half is held to.
const IMPLICIT_SHARE: f64 = 0.1;

/// The control of the implicit half of a run to `tolerance`.
pub(crate) fn held(tolerance: &Tolerance) -> Control {
    Control::Adaptive(Tolerance {
        rtol: IMPLICIT_SHARE * tolerance.rtol,
        atol: tolerance.atol.iter().map(|atol| IMPLICIT_SHARE * atol).collect(),
    })
}

/// Both halves at work on one system.
pub(crate) struct AutoSolver<'p, P: System> {
    explicit: Box<dyn Paced<P> + 'p>,
    implicit: Box<dyn Paced<P> + 'p>,
    pilot: Pilot,
}

impl<'p, P: System> AutoSolver<'p, P> {
    /// Both halves on `problem`.
    pub(crate) fn new(
        problem: &P,
        explicit: Box<dyn Paced<P> + 'p>,
        implicit: Box<dyn Paced<P> + 'p>,
    ) -> Self {
        Self { explicit, implicit, pilot: Pilot::new(problem.dim()) }
    }
}

impl<P: System> PhaseSolver<P> for AutoSolver<'_, P> {
    fn solve_phase(
        &mut self,
        problem: &P,
        point: &mut Point<P>,
        t_end: f64,
        stats: &mut Stats,
        record: &mut dyn Record<P>,
    ) -> Result<PhaseEnd, Error> {
        let mut turn = self.pilot.begin_phase(problem, point, stats);
        loop {
            let (half, is_implicit, h) = match turn {
                Turn::Explicit { h } => (&mut self.explicit, false, h),
                Turn::Implicit { h } => (&mut self.implicit, true, h),
            };
            if let Some(h) = h {
                half.begin_with(h);
            }
            if !is_implicit {
                half.keep_below(REACH / self.pilot.radius());
            }
            let mut leg = Leg::new(&mut self.pilot, problem, record, is_implicit, stats);
            let end = half.solve_phase(problem, point, t_end, stats, &mut leg);
            let next = leg.over(stats);
            turn = match (end, next) {
                (Err(Error::NoConvergence { .. }), _) if is_implicit => {
                    self.pilot.give_up();
                    Turn::Explicit { h: None }
                }
                (Ok(PhaseEnd::Interrupted), Some(next)) => next,
                (end, _) => return end,
            };
        }
    }
}

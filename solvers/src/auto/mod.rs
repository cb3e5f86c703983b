//! A method that switches by itself between an explicit method, where accuracy limits the step, and an implicit one,
//! where stability does.
//!
//! An explicit pair and [`RADAU_IIA_5`](crate::methods::RADAU_IIA_5) take turns. Either hands over at the end of an
//! accepted step, and the other begins there as at the start of a phase. An event is located by the method in whose
//! step it lies. The pair is chosen by the tolerance, as measured on the contact of `deltazero`:
//! [`KUTTA_43`](crate::methods::KUTTA_43) for `rtol ≥ 1e-4`,
//! [`DORMAND_PRINCE_853`](crate::methods::DORMAND_PRINCE_853) below. The implicit method works to 0.1 of the
//! tolerance, where its error is about that of the explicit one (measured: at 0.01 to 0.1). So a few implicit steps
//! do not spoil a run.
//!
//! # The rule
//!
//! Work is counted in evaluations of the right-hand side; an attempt of an implicit step counts as 40 of them. Let ρ
//! be the spectral radius of the Jacobian at the start of the phase, computed by power iteration:
//!
//! - An explicit step is at most `2.5/ρ`, inside the stability bound. If a later evaluation finds ρ halved, steps may
//!   grow; if it finds ρ larger, the bound does not change before the next turn. The reason for the limit: at the
//!   stability bound, error control keeps errors of the size of the tolerance alive, so that a contact stiffer than
//!   the tolerance resolves opens and closes by noise, and every second step is rejected.
//! - A run begins explicit. After every 2048 right-hand sides, counted across phases, the mean step h is looked at.
//!   Where `hρ > 1.5`, stability may be what limits the step, and implicit steps are tried. An implicit step *pays*
//!   where it is at least as long as the distance that the explicit method covers with the same work.
//! - A trial begins with a step of 0.4 of that distance, and is kept if its step pays after eight attempts.
//! - Implicit steps continue while their equations can be solved and eight attempts together pay. The distance that
//!   pays is then computed anew from ρ, because an explicit step limited by stability is proportional to 1/ρ. Later
//!   phases begin implicit where their ρ is at least half of the value at that time.
//! - Otherwise the explicit method continues. Each turn that ends so doubles the 2048 right-hand sides until the next
//!   trial, up to 8192; after steps that paid, the number is 128.
//!
//! So a trial that fails costs about 300 right-hand sides, and all trials together a small part of a run. A system
//! whose `hρ` stays below 1.5, with ρ at the start of the phase, is integrated by the explicit pair, bit for bit; the
//! only price is one Jacobian per phase and one per 2048 right-hand sides. No decision depends on a clock, so a run
//! is repeatable.
//!
//! [`Stats::n_implicit`] counts the implicit steps among the accepted ones.

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

/// Smallest relative tolerance at which the explicit method is the fourth-order pair.
pub(crate) const LOOSE: f64 = 1e-4;

/// `hρ` of the longest explicit step. Both pairs are stable there for decay, and the fourth-order pair for
/// oscillation too. On contacts, 2 to 2.6 (fourth order, e ≤ 1e-3) and 1 to 3 (eighth order, e ≤ 1e-6) gave about the
/// least work; 2.5 leaves room for the error of ρ.
const REACH: f64 = 2.5;

/// Fraction of the tolerance that the implicit method works to.
const IMPLICIT_SHARE: f64 = 0.1;

/// The control of the implicit method in a run to `tolerance`.
pub(crate) fn held(tolerance: &Tolerance) -> Control {
    Control::Adaptive(Tolerance {
        rtol: IMPLICIT_SHARE * tolerance.rtol,
        atol: tolerance.atol.iter().map(|atol| IMPLICIT_SHARE * atol).collect(),
    })
}

/// Both methods applied to one system.
pub(crate) struct AutoSolver<'p, P: System> {
    explicit: Box<dyn Paced<P> + 'p>,
    implicit: Box<dyn Paced<P> + 'p>,
    pilot: Pilot,
}

impl<'p, P: System> AutoSolver<'p, P> {
    /// Both methods on `problem`.
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

//! A method that switches by itself between an explicit method, where accuracy limits the step, and an implicit one,
//! where stability does.
//!
//! An explicit method and [`RADAU_IIA_5`] take turns. Either hands over at the end of an
//! accepted step, and the other begins there as at the start of a phase. An event is located by the method in whose
//! step it lies. The explicit method is chosen by the tolerance and the size of the system, as measured on the
//! mechanisms of `deltazero`: [`KUTTA_43`](crate::methods::KUTTA_43) for `rtol ≥ 1e-4`; below,
//! [`taylor`](crate::taylor) where states and operations are few,
//! [`DORMAND_PRINCE_853`](crate::methods::DORMAND_PRINCE_853) elsewhere. Operations are counted in the mode in which the
//! first run of a solver begins, and where one of the next seven modes begins. One with too many ends the series for
//! good: the pair takes over, and the rule begins anew. The implicit method works to 0.1 of the tolerance, where its
//! error is about that of the explicit one (measured: at 0.01 to 0.1). So a few implicit steps do not spoil a run.
//!
//! # The rule
//!
//! Work is counted in evaluations of the right-hand side; an attempt of an implicit step counts as 20 of them, a series
//! of order N as 0.75 N. Let ρ be the spectral radius of the Jacobian, computed by power iteration, and r the reach of
//! the explicit method: 2.5 for a pair, 0.5 + 0.3 N for a series.
//!
//! - An explicit step is at most `r/ρ`, inside the stability bound, with ρ as last computed: at the start of each phase,
//!   and after every 2048 right-hand sides within it where it has changed by a factor of two. The reason for the limit: at the
//!   stability bound, error control keeps errors of the size of the tolerance alive, so that a contact stiffer than the
//!   tolerance resolves opens and closes by noise, and every second step is rejected.
//! - An explicit step is *held back* where the step control, which sees the error alone, proposes at least that bound:
//!   the fast motion has died below the tolerance. After 128 right-hand sides in such steps, one after the other,
//!   implicit steps are tried. An implicit step *pays* where it is at least as long as the distance that the explicit
//!   method covers with the same work.
//! - A trial begins with a step of 0.02 of that distance, and is kept if its step pays after twelve attempts.
//! - Implicit steps continue while their equations can be solved and twelve attempts together pay. The distance that
//!   pays is then computed anew from ρ, because an explicit step limited by stability is proportional to 1/ρ. The next
//!   phase begins implicit where its ρ is at least half of the value at that time. Each other phase, and the first of a
//!   new solver, begins explicit: after an impact, the fast motion is above the tolerance again.
//! - Otherwise the explicit method continues. Each turn that ends so doubles the 128 right-hand sides until the next
//!   trial, up to 8192; steps that pay reset them. A trial that an event cuts short is not judged: where each of many
//!   phases is as short as that, trials are most of the work.
//!
//! So a trial that fails costs some 240 right-hand sides, and those of a long phase together are a small part of it. A
//! system whose steps are never held back is integrated by the explicit method, bit for bit; the only price is one
//! Jacobian per phase, one per 2048 right-hand sides, and the counts of operations. No decision depends on a clock, so
//! a run is repeatable.
//!
//! [`Stats::n_implicit`] counts the implicit steps among the accepted ones.

mod explicit;
mod pilot;
mod spectrum;
mod turns;

use crate::control::{Control, StepLimits};
use crate::error::Error;
use crate::one_step::Paced;
use crate::phase::{PhaseEnd, PhaseSolver};
use crate::point::Point;
use crate::record::Record;
use crate::system::System;
use crate::tolerance::Tolerance;
use crate::work::Stats;
pub(crate) use explicit::Explicit;
pub(crate) use pilot::Turn;
pub(crate) use turns::Turns;

/// Smallest relative tolerance at which the explicit method is the fourth-order pair.
pub(crate) const LOOSE: f64 = 1e-4;

/// Both methods applied to one system.
pub(crate) struct AutoSolver<'p, P: System> {
    tolerance: Tolerance,
    /// Limits of the steps; that of the first one until a run has begun.
    limits: StepLimits,
    /// Chosen where the first run begins, and anew where a mode has too many operations for a series.
    methods: Option<(Box<dyn Paced<P> + 'p>, Turns<'p, P>)>,
}

impl<'p, P: System + 'p> AutoSolver<'p, P> {
    /// Both methods on a system, with steps within `limits`.
    pub(crate) fn new(tolerance: Tolerance, limits: StepLimits) -> Self {
        Self { tolerance, limits, methods: None }
    }

    /// These methods, to go on with where a phase begins.
    pub(crate) fn of(
        tolerance: Tolerance,
        explicit: Box<dyn Paced<P> + 'p>,
        turns: Turns<'p, P>,
    ) -> Self {
        Self { tolerance, limits: StepLimits::NONE, methods: Some((explicit, turns)) }
    }
}

impl<'p, P: System + 'p> PhaseSolver<P> for AutoSolver<'p, P>
where
    P::Mode: 'p,
{
    fn solve_phase(
        &mut self,
        problem: &P,
        point: &mut Point<P>,
        t_end: f64,
        stats: &mut Stats,
        record: &mut dyn Record<P>,
    ) -> Result<PhaseEnd, Error> {
        let Self { tolerance, limits, methods } = self;
        methods.take_if(|(_, turns)| turns.explicit_is_outgrown_at(problem, point));
        let (explicit, turns) = methods.get_or_insert_with(|| {
            let explicit = Explicit::of(problem, point, tolerance.rtol);
            let control = Control::Adaptive(tolerance.clone());
            let of_explicit = StepLimits { first: limits.first.take(), ..*limits };
            let steps = of_explicit.with(control);
            let turns = Turns::new(problem, tolerance, limits.longest, explicit);
            (explicit.solver(problem, steps), turns)
        });
        turns.with(&mut **explicit).solve_phase(problem, point, t_end, stats, record)
    }
}

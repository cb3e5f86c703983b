//! The turns of both methods within a phase.

use std::ops::ControlFlow;

use super::explicit::Explicit;
use super::pilot::{Leg, Pilot, Turn};
use crate::control::{Control, Steps};
use crate::error::Error;
use crate::one_step::{OneStepSolver, Paced, PhaseContext};
use crate::phase::{PhaseEnd, PhaseSolver};
use crate::point::Point;
use crate::radau::RadauMethod;
use crate::record::Record;
use crate::system::System;
use crate::tableaux::RADAU_IIA_5;
use crate::taylor::Operations;
use crate::tolerance::Tolerance;
use crate::work::Stats;

/// Fraction of the tolerance that the implicit method works to.
const IMPLICIT_SHARE: f64 = 0.1;

/// Modes of a run, one after the other, whose operations are counted: a rattling pin is in all of its modes by then.
const COUNTED: u32 = 8;

/// The implicit method, and the rule by which it and an explicit one take turns.
pub(crate) struct Turns<'p, P: System> {
    implicit: Box<dyn Paced<P> + 'p>,
    pilot: Pilot,
    explicit: Explicit,
    operations: Operations,
    /// The last mode that a phase began in, and the number of modes one after the other so far.
    mode: Option<P::Mode>,
    n_modes: u32,
}

impl<'p, P: System + 'p> Turns<'p, P>
where
    P::Mode: 'p,
{
    /// Turns with steps of at most `longest`, for `problem`.
    pub(crate) fn new(
        problem: &P,
        tolerance: &Tolerance,
        longest: f64,
        explicit: Explicit,
    ) -> Self {
        let n = problem.dim();
        let held = Control::Adaptive(Tolerance {
            rtol: IMPLICIT_SHARE * tolerance.rtol,
            atol: tolerance.atol.iter().map(|atol| IMPLICIT_SHARE * atol).collect(),
        });
        let radau = RadauMethod::new(&RADAU_IIA_5, n, &held).on_slow_solutions();
        let steps = Steps { longest, ..held.into() };
        let implicit = Box::new(OneStepSolver::new(problem, radau, steps));
        let pilot = Pilot::new(n, explicit.pace(), longest);
        let operations = Operations::default();
        Self { implicit, pilot, explicit, operations, mode: None, n_modes: 0 }
    }

    /// Whether the explicit method is to be chosen anew for the phase that begins at `point`. It was chosen for the
    /// first.
    pub(crate) fn explicit_is_outgrown_at(&mut self, problem: &P, point: &Point<P>) -> bool {
        (1..COUNTED).contains(&self.n_modes)
            && self.mode.as_ref() != Some(&point.mode)
            && self.explicit.is_outgrown_at(problem, point, &mut self.operations)
    }

    /// The turn that begins a phase at `point`.
    pub(crate) fn begin(&mut self, problem: &P, point: &Point<P>, stats: &mut Stats) -> Turn {
        if self.mode.as_ref() != Some(&point.mode) {
            self.mode = Some(point.mode.clone());
            self.n_modes = self.n_modes.saturating_add(1);
        }
        self.pilot.begin_phase(problem, point, stats)
    }

    /// Takes implicit turns, from `turn` to the next explicit one, and makes `explicit` ready for that. Breaks with the
    /// end of the phase where that comes first.
    pub(crate) fn until_explicit(
        &mut self,
        mut turn: Turn,
        explicit: &mut dyn Paced<P>,
        context: &mut PhaseContext<'_, P>,
        t_end: f64,
    ) -> Result<ControlFlow<PhaseEnd>, Error> {
        let PhaseContext { problem, point, stats, record } = context;
        loop {
            let h = match turn {
                Turn::Explicit { h } => {
                    if let Some(h) = h {
                        explicit.begin_with(h);
                    }
                    explicit.keep_below(self.pilot.longest());
                    return Ok(ControlFlow::Continue(()));
                }
                Turn::Implicit { h } => h,
            };
            if let Some(h) = h {
                self.implicit.begin_with(h);
            }
            let mut leg = Leg::new(&mut self.pilot, *problem, *record, true, stats);
            let end = self.implicit.solve_phase(problem, point, t_end, stats, &mut leg);
            turn = match (end, leg.over(stats)) {
                (Err(Error::NoConvergence { .. }), _) => {
                    self.pilot.give_up();
                    Turn::Explicit { h: None }
                }
                (Ok(PhaseEnd::Interrupted { .. }), Some(next)) => next,
                (end, _) => return end.map(ControlFlow::Break),
            };
        }
    }

    /// A part of an explicit turn, whose steps are shown to `record`.
    pub(crate) fn explicit_leg<'a>(
        &'a mut self,
        problem: &'a P,
        record: &'a mut dyn Record<P>,
        stats: &Stats,
    ) -> Leg<'a, P> {
        Leg::new(&mut self.pilot, problem, record, false, stats)
    }

    /// Turns of these and of `explicit`.
    pub(crate) fn with<'s>(&'s mut self, explicit: &'s mut dyn Paced<P>) -> BothTurns<'s, 'p, P> {
        BothTurns { explicit, turns: self }
    }
}

/// An explicit method that takes turns with an implicit one.
pub(crate) struct BothTurns<'s, 'p, P: System> {
    explicit: &'s mut dyn Paced<P>,
    turns: &'s mut Turns<'p, P>,
}

impl<'p, P: System + 'p> BothTurns<'_, 'p, P>
where
    P::Mode: 'p,
{
    /// Integrates from `turn` to the end of the phase.
    pub(crate) fn go_on(
        &mut self,
        mut turn: Turn,
        context: &mut PhaseContext<'_, P>,
        t_end: f64,
    ) -> Result<PhaseEnd, Error> {
        loop {
            let until = self.turns.until_explicit(turn, self.explicit, context, t_end)?;
            if let ControlFlow::Break(end) = until {
                return Ok(end);
            }
            let PhaseContext { problem, point, stats, record } = context;
            let mut leg = self.turns.explicit_leg(*problem, *record, stats);
            let end = self.explicit.solve_phase(problem, point, t_end, stats, &mut leg);
            turn = match (end, leg.over(stats)) {
                (Ok(PhaseEnd::Interrupted { .. }), Some(next)) => next,
                (end, _) => return end,
            };
        }
    }
}

impl<'p, P: System + 'p> PhaseSolver<P> for BothTurns<'_, 'p, P>
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
        if point.t == t_end {
            return Ok(PhaseEnd::EndOfTime);
        }
        let turn = self.turns.begin(problem, point, stats);
        self.go_on(turn, &mut PhaseContext { problem, point, stats, record }, t_end)
    }
}

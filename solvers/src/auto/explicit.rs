//! The explicit one of the two methods.

use super::LOOSE;
use crate::control::{Control, Steps};
use crate::erk::ExplicitRk;
use crate::methods::{DORMAND_PRINCE_853, KUTTA_43};
use crate::one_step::{OneStepSolver, Paced};
use crate::phase::Point;
use crate::system::System;
use crate::taylor::{TaylorMethod, n_operations, order_for};
use crate::tolerance::Tolerance;

/// Most operations of a right-hand side and its guards, and most states, for which a series is cheaper than the
/// stages of a pair.
const MOST_OPERATIONS: usize = 48;
const MOST_STATES: usize = 8;

/// An explicit method, with what the rule of switching must know of it.
pub(super) struct Explicit<'p, P: System> {
    pub(super) solver: Box<dyn Paced<P> + 'p>,
    pub(super) pace: Pace,
}

/// What the rule of switching must know of an explicit method.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// `hρ` of the longest step.
    pub(super) reach: f64,
    /// Cost of one that is counted as a right-hand side, in right-hand sides.
    pub(super) cost: u64,
}

impl Pace {
    /// That of both pairs.
    ///
    /// They are stable at this reach for decay, and the fourth-order pair for oscillation too. On contacts, 2 to 2.6
    /// (fourth order, e ≤ 1e-3) and 1 to 3 (eighth order, e ≤ 1e-6) gave about the least work; 2.5 leaves room for the
    /// error of ρ.
    pub(super) const OF_PAIRS: Self = Self { reach: 2.5, cost: 1 };

    /// That of series of `order`.
    ///
    /// The reach lies inside the stability region `|Σ zᵏ/k!| ≤ 1` of every order from 8 to 25 for decay and for
    /// oscillation with a damping ratio of 0.02 and more, by a sixth at least. The cost was measured on Table 1: 390 ns a
    /// step of order 10 and 790 ns of order 20, beside 48 ns a right-hand side.
    fn of_series(order: usize) -> Self {
        Self { reach: 0.5 + 0.3 * order as f64, cost: (3 * order / 4) as u64 }
    }
}

impl<'p, P: System + 'p> Explicit<'p, P>
where
    P::Mode: 'p,
{
    /// The one for `problem` at `tolerance`, by the operations of the mode at `point`.
    pub(super) fn new(
        problem: &P,
        point: &Point<P>,
        tolerance: &Tolerance,
        (first, longest): (Option<f64>, f64),
    ) -> Self {
        let n = problem.dim();
        let steps = Steps { control: Control::Adaptive(tolerance.clone()), first, longest };
        if tolerance.rtol >= LOOSE {
            let pair = ExplicitRk::new(&KUTTA_43, n);
            let solver = Box::new(OneStepSolver::new(problem, pair, steps));
            return Self { solver, pace: Pace::OF_PAIRS };
        }
        let is_small = n <= MOST_STATES
            && n_operations(problem, &point.mode, point.t, &point.y) <= MOST_OPERATIONS;
        if is_small {
            let order = order_for(tolerance.rtol);
            let series = TaylorMethod::new(n, problem.n_guards(), order);
            let solver = Box::new(OneStepSolver::new(problem, series, steps));
            return Self { solver, pace: Pace::of_series(order) };
        }
        let pair = ExplicitRk::new(&DORMAND_PRINCE_853, n);
        Self { solver: Box::new(OneStepSolver::new(problem, pair, steps)), pace: Pace::OF_PAIRS }
    }
}

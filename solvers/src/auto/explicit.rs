//! The explicit one of the two methods.

use super::LOOSE;
use crate::control::Steps;
use crate::erk::ExplicitRk;
use crate::one_step::{OneStepSolver, Paced};
use crate::point::Point;
use crate::system::System;
use crate::tableaux::{DORMAND_PRINCE_853, KUTTA_43};
use crate::taylor::{Operations, TaylorMethod, order_for};

/// Most operations of a right-hand side and its guards, and most states, for which a series is cheaper than the
/// stages of a pair. A pin in its contact has 55 (reading `pin`), where a series takes 0.7 times as long, and 72 (`full`),
/// where it takes 1.6 times as long. Of a system that is traced fewer are counted, and the same limit serves: the pin as a text
/// model takes as long at `rtol` 1e-6 and 0.45 times as long at 1e-9.
const MOST_OPERATIONS: usize = 64;
const MOST_STATES: usize = 8;

/// The explicit method that is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Explicit {
    /// [`KUTTA_43`].
    FourthOrder,
    /// [`DORMAND_PRINCE_853`].
    EighthOrder,
    /// Series of this order.
    Series(usize),
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

impl Explicit {
    /// The one for `problem` at `rtol`, by the operations of the mode at `point`.
    pub(crate) fn of<P: System>(problem: &P, point: &Point<P>, rtol: f64) -> Self {
        if rtol >= LOOSE {
            return Self::FourthOrder;
        }
        if is_small(problem, point, &mut Operations::default()) {
            Self::Series(order_for(rtol))
        } else {
            Self::EighthOrder
        }
    }

    /// Whether it is a series, and the mode at `point` has more operations than a series is for.
    pub(super) fn is_outgrown_at<P: System>(
        self,
        problem: &P,
        point: &Point<P>,
        operations: &mut Operations,
    ) -> bool {
        matches!(self, Self::Series(_)) && !is_small(problem, point, operations)
    }

    pub(super) fn pace(self) -> Pace {
        match self {
            Self::FourthOrder | Self::EighthOrder => Pace::OF_PAIRS,
            Self::Series(order) => Pace::of_series(order),
        }
    }

    /// Applies the method to `problem`.
    pub(super) fn solver<'p, P: System + 'p>(
        self,
        problem: &P,
        steps: Steps,
    ) -> Box<dyn Paced<P> + 'p>
    where
        P::Mode: 'p,
    {
        let n = problem.dim();
        match self {
            Self::FourthOrder => {
                Box::new(OneStepSolver::new(problem, ExplicitRk::new(&KUTTA_43, n), steps))
            }
            Self::EighthOrder => {
                let method = ExplicitRk::new(&DORMAND_PRINCE_853, n);
                Box::new(OneStepSolver::new(problem, method, steps))
            }
            Self::Series(order) => {
                let method = TaylorMethod::new(n, problem.n_guards(), order);
                Box::new(OneStepSolver::new(problem, method, steps))
            }
        }
    }
}

/// Whether a series is cheaper than a pair, by the operations of the mode at `point`.
fn is_small<P: System>(problem: &P, point: &Point<P>, operations: &mut Operations) -> bool {
    problem.dim() <= MOST_STATES
        && operations.count(problem, &point.mode, point.t, &point.y) <= MOST_OPERATIONS
}

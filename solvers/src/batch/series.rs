//! Steps of the Taylor method of several runs at once.

use super::parameters::{ByParameters, pick, set};
use super::steps::{Judgement, Steps};
use crate::event_location::GuardWatch;
use crate::lanes::dual::DualLanes;
use crate::lanes::{Lanes, Simd};
use crate::real::{Ordered, Over, Real};
use crate::system::{Alike, System, Vector};
use crate::taylor::TaylorMethod;
use crate::taylor::coefficient::Coefficient;
use crate::taylor::order::reach_by;
use crate::tolerance::{norm_sq, weigh, weighed_sq};

/// The Taylor method of systems like `P` over the numbers `B`.
type Taylor<P, B> = TaylorMethod<<P as System>::State<B>, <P as System>::Guards<B>, B>;

/// Steps by series of one order. A run whose series is to be cut, or proposes no size, takes that step alone.
pub(super) struct SeriesSteps<P: Alike, V: Simd>
where
    Lanes<V>: Coefficient<Rounded = Lanes<V>>,
{
    method: Taylor<P, Lanes<V>>,
    judgement: Judgement<V>,
    /// Heights below which a turn of a guard is noted.
    turn_limits: P::Guards<Lanes<V>>,
    /// The guards along the last term of the states that theirs are looked at to.
    along: P::Guards<DualLanes<V>>,
    /// Whether the series are begun at the present starts.
    is_begun: bool,
}

impl<P: Alike, V: Simd> SeriesSteps<P, V>
where
    Lanes<V>: Coefficient<Rounded = Lanes<V>>,
{
    /// By series of `order`, for systems like `problem`.
    pub(super) fn new(problem: &P, order: usize) -> Self {
        let n = problem.dim();
        Self {
            method: TaylorMethod::new(n, problem.n_guards(), order),
            judgement: Judgement::new(n),
            turn_limits: Vector::from_fn(problem.n_guards(), |_| Lanes::cst(f64::INFINITY)),
            along: Vector::from_fn(problem.n_guards(), |_| DualLanes::cst(0.0)),
            is_begun: false,
        }
    }

    fn order(&self) -> usize {
        self.method.step.y.len() - 1
    }

    /// A bit for each lane in which all guards are clear on the step of size `h`, where so much of the last term of each is
    /// `explained` by the states; and the least [`no_turn`](crate::event_location::no_turn) of all guards.
    #[inline(always)]
    fn look(&self, h: Lanes<V>, explained: impl Fn(usize) -> Lanes<V>) -> (u32, Lanes<V>) {
        let guards = &self.method.guards;
        let ends = guards.end.as_ref().iter().zip(self.turn_limits.as_ref()).enumerate();
        let all = (every_lane::<V>(), Lanes::cst(f64::INFINITY));
        ends.fold(all, |(all, least): (u32, Lanes<V>), (i, (end, limit))| {
            let highest = guards.highest_low();
            let (is_clear, no_turn) = guards.look(i, h, highest, (*end, *limit), explained(i));
            (all & is_clear, least.lesser(no_turn))
        })
    }
}

/// A bit for each lane.
const fn every_lane<V: Simd>() -> u32 {
    (1 << V::N) - 1
}

impl<P: Alike, V: Simd> Steps<P, V> for SeriesSteps<P, V>
where
    Lanes<V>: Coefficient<Rounded = Lanes<V>>,
{
    type Method = Taylor<P, f64>;

    // One run is faster than alone, because this code has no modes to tell apart.
    const LEAST: usize = 1;

    const N_RHS: u64 = 0;
    const TESTS_ENDS: bool = false;

    fn n_rhs_of_end(_method: &Self::Method) -> u64 {
        0
    }

    fn judgement(&self) -> &Judgement<V> {
        &self.judgement
    }

    fn judgement_mut(&mut self) -> &mut Judgement<V> {
        &mut self.judgement
    }

    fn load(&mut self, lane: usize, method: &Self::Method, turn_limits: &P::Guards<f64>) {
        let (all, one) = (&mut self.method.step, &method.step);
        all.t0.set(lane, one.t0);
        set(&mut all.y[0], lane, &one.y[0]);
        set(&mut self.turn_limits, lane, turn_limits);
        self.is_begun = false;
    }

    #[inline(always)]
    fn prepare(&mut self, field: &ByParameters<P, V>) {
        if !std::mem::replace(&mut self.is_begun, true) {
            self.method.begin(field);
        }
        self.method.finish(field);
        if let Some(tolerances) = self.judgement.tolerances() {
            let step = &mut self.method.step;
            weigh(tolerances, step.y[0].as_ref(), step.weights.as_mut());
        }
    }

    #[inline(always)]
    fn propose(&self, lane: usize, method: &mut Self::Method) -> Option<f64> {
        let step = &self.method.step;
        let weights = step.weights.as_ref();
        let norm_sq = |k: usize| weighed_sq(step.y[k].as_ref(), weights).lane(lane);
        let weighed = |k: usize| {
            step.y[k].as_ref().iter().zip(weights).map(|(y, weight)| (*y * *weight).lane(lane))
        };
        method.reaches(reach_by(self.order(), norm_sq, weighed))
    }

    #[inline(always)]
    fn serves(&self, method: &Self::Method) -> bool {
        method.degree == Some(self.order())
    }

    #[inline(always)]
    fn t0(&self) -> Lanes<V> {
        self.method.step.t0
    }

    #[inline(always)]
    fn take(&mut self, field: &ByParameters<P, V>, t1: Lanes<V>, h: Lanes<V>) {
        self.method.take(field, t1, h);
        let step = &self.method.step;
        let (y0, y1) = (step.y[0].as_ref(), step.y1.as_ref());
        if let Some(tolerances) = self.judgement.tolerances() {
            self.judgement.error_sq = norm_sq(tolerances, self.method.error.as_ref(), y0, y1);
        }
        self.judgement.look_at_ends(y1, step.slope1.as_ref());
        let (mut are_clear, least) = self.look(h, |_| Lanes::cst(0.0));
        if are_clear != every_lane::<V>() {
            // As a run alone does: what the states make of a term is followed as well as they are.
            let t0 = DualLanes::of(step.t0);
            let last = step.y[self.method.guards.highest_low()].as_ref();
            field.guards_along(t0, (y0, last), &mut self.along);
            are_clear |= self.look(h, |i| self.along.as_ref()[i].eps).0;
        }
        self.judgement.is_clear &= are_clear;
        self.judgement.end_with(least);
    }

    fn guard_at_end(&self, i: usize) -> Lanes<V> {
        self.method.guards.end.as_ref()[i]
    }

    fn note_turns(&self, lane: usize, of_step: (f64, f64), watch: &mut GuardWatch<P>) {
        self.method.guards.note_turns_of_clear(of_step, |x| x.lane(lane), watch);
    }

    #[inline(always)]
    fn advance(&mut self) {
        self.method.go_on();
    }

    fn unload_start(&self, lane: usize, t0: f64, method: &mut Self::Method) {
        method.step.t0 = t0;
        for (all, y) in self.method.step.y.iter().zip(&mut method.step.y).take(2) {
            pick(all, lane, y);
        }
    }

    #[inline(always)]
    fn unload_end(&self, lane: usize, t1: f64, _h: f64, method: &mut Self::Method) {
        let (all, one) = (&self.method.step, &mut method.step);
        (one.t1, one.degree) = (t1, all.degree);
        pick(&all.y1, lane, &mut one.y1);
        pick(&all.slope1, lane, &mut one.slope1);
    }

    fn unload_dense(&self, lane: usize, method: &mut Self::Method) {
        for (all, y) in self.method.step.y.iter().zip(&mut method.step.y) {
            pick(all, lane, y);
        }
        method.is_expanded = true;
    }

    fn unload_within(&self, lane: usize, method: &mut Self::Method) {
        self.unload_dense(lane, method);
        method.guards.take(&self.method.guards, |all, own| pick(all, lane, own));
        pick(&self.method.error, lane, &mut method.error);
    }
}

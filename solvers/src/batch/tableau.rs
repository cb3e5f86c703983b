//! Steps of an explicit tableau method of several runs at once.

use num_dual::Dual64;

use super::parameters::{ByParameters, pick, set};
use super::steps::{Judgement, Steps};
use crate::erk::{ExplicitRk, sharpened};
use crate::event_location::{GuardWatch, is_far, no_turn};
use crate::lanes::dual::DualLanes;
use crate::lanes::{Lanes, Simd};
use crate::real::{Ordered, Real};
use crate::system::{Alike, Vector};
use crate::tableau::Tableau;

/// Steps by a tableau of `S` stages.
pub(super) struct TableauSteps<P: Alike, V: Simd, const S: usize> {
    method: ExplicitRk<P::State<Lanes<V>>, S, Lanes<V>>,
    judgement: Judgement<V>,
    /// Values and rates of the guards at the starts and at the ends.
    start: P::Guards<DualLanes<V>>,
    end: P::Guards<DualLanes<V>>,
    /// Heights below which a turn of a guard is noted.
    turn_limits: P::Guards<Lanes<V>>,
    /// Whether those at the starts are known.
    is_prepared: bool,
}

impl<P: Alike, V: Simd, const S: usize> TableauSteps<P, V, S> {
    /// By `tableau`, for systems like `problem`.
    pub(super) fn new(problem: &P, tableau: &'static Tableau<S>) -> Self {
        let (n, n_guards) = (problem.dim(), problem.n_guards());
        let guards = || Vector::from_fn(n_guards, |_| DualLanes::cst(0.0));
        Self {
            method: ExplicitRk::new(tableau, n),
            judgement: Judgement::new(n),
            start: guards(),
            end: guards(),
            turn_limits: Vector::from_fn(n_guards, |_| Lanes::cst(f64::INFINITY)),
            is_prepared: false,
        }
    }
}

impl<P: Alike, V: Simd, const S: usize> Steps<P, V> for TableauSteps<P, V, S> {
    type Method = ExplicitRk<P::State<f64>, S>;

    const LEAST: usize = 2;

    const N_RHS: u64 = Self::Method::N_RHS;
    const TESTS_ENDS: bool = true;

    fn n_rhs_of_end(method: &Self::Method) -> u64 {
        method.n_rhs_of_end()
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
        set(&mut all.y0, lane, &one.y0);
        set(&mut all.k[0], lane, &one.k[0]);
        set(&mut self.turn_limits, lane, turn_limits);
        self.is_prepared = false;
    }

    #[inline(always)]
    fn prepare(&mut self, field: &ByParameters<P, V>) {
        if !std::mem::replace(&mut self.is_prepared, true) {
            let step = &self.method.step;
            let start = (step.y0.as_ref(), step.k[0].as_ref());
            field.guards_along(DualLanes::new(step.t0, Lanes::cst(1.0)), start, &mut self.start);
        }
    }

    fn propose(&self, _lane: usize, _method: &mut Self::Method) -> Option<f64> {
        None
    }

    #[inline(always)]
    fn serves(&self, _method: &Self::Method) -> bool {
        true
    }

    #[inline(always)]
    fn t0(&self) -> Lanes<V> {
        self.method.step.t0
    }

    #[inline(always)]
    fn take(&mut self, field: &ByParameters<P, V>, t1: Lanes<V>, h: Lanes<V>) {
        self.method.take(t1, h, field);
        self.method.end_slope(field);
        if let Some(tolerances) = self.judgement.tolerances() {
            let (error_sq, low_sq) = self.method.norms_sq(tolerances);
            let error_sq = match low_sq.map(|low_sq| low_sq()) {
                None => error_sq,
                Some(low_sq) => {
                    Lanes::from_fn(|lane| sharpened(error_sq.lane(lane), || low_sq.lane(lane)))
                }
            };
            self.judgement.error_sq = error_sq;
        }
        let step = &self.method.step;
        let end = (step.y1.as_ref(), step.slope1.as_ref());
        self.judgement.look_at_ends(end.0, end.1);
        field.guards_along(DualLanes::new(t1, Lanes::cst(1.0)), end, &mut self.end);
        let h = t1 - step.t0;
        let ends = self.start.as_ref().iter().zip(self.end.as_ref()).zip(self.turn_limits.as_ref());
        let mut high: Lanes<V> = Lanes::cst(f64::INFINITY);
        for ((g0, g1), limit) in ends {
            let (from, to) = ([g0.re, g0.eps], [g1.re, g1.eps]);
            self.judgement.is_clear &= is_far(from, to, h);
            high = high.lesser(no_turn(from, to, h, *limit));
        }
        self.judgement.end_with(high);
    }

    fn guard_at_end(&self, i: usize) -> Lanes<V> {
        self.end.as_ref()[i].re
    }

    fn note_turns(&self, lane: usize, of_step: (f64, f64), watch: &mut GuardWatch<P>) {
        let of_lane = |g: &DualLanes<V>| Dual64::new(g.re.lane(lane), g.eps.lane(lane));
        for (i, (g0, g1)) in self.start.as_ref().iter().zip(self.end.as_ref()).enumerate() {
            watch.note_turn_between(i, of_step, of_lane(g0), of_lane(g1));
        }
    }

    #[inline(always)]
    fn advance(&mut self) {
        let step = &mut self.method.step;
        step.t0 = step.t1;
        step.y0.clone_from(&step.y1);
        step.k[0].clone_from(&step.slope1);
        self.start.clone_from(&self.end);
    }

    fn unload_start(&self, lane: usize, t0: f64, method: &mut Self::Method) {
        let (all, one) = (&self.method.step, &mut method.step);
        one.t0 = t0;
        pick(&all.y0, lane, &mut one.y0);
        pick(&all.k[0], lane, &mut one.k[0]);
    }

    #[inline(always)]
    fn unload_end(&self, lane: usize, t1: f64, h: f64, method: &mut Self::Method) {
        let (all, one) = (&self.method.step, &mut method.step);
        (one.t1, one.h) = (t1, h);
        pick(&all.y1, lane, &mut one.y1);
        pick(&all.slope1, lane, &mut one.slope1);
        method.is_dense = false;
    }

    fn unload_dense(&self, lane: usize, method: &mut Self::Method) {
        for (all, k) in self.method.step.k.iter().zip(&mut method.step.k) {
            pick(all, lane, k);
        }
    }

    fn unload_within(&self, lane: usize, method: &mut Self::Method) {
        self.unload_dense(lane, method);
        pick(&self.method.step.error, lane, &mut method.step.error);
        pick(&self.method.low_error, lane, &mut method.low_error);
    }
}

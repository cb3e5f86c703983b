//! What a method must offer so that several runs take their steps at once.

use super::parameters::ByParameters;
use crate::control::Control;
use crate::event_location::GuardWatch;
use crate::lanes::{Lanes, Simd};
use crate::one_step::OneStep;
use crate::real::{Ordered, Real};
use crate::system::Alike;

/// The steps of several runs at once, one in each lane.
///
/// Lanes are [loaded](Self::load) with the starts of steps, which are [taken](Self::take) at once. Then either the
/// [end is made the next start](Self::advance), or the step of a lane is unloaded to the method by which its run steps
/// alone.
pub(super) trait Steps<P: Alike, V: Simd> {
    /// The method by which a run steps alone.
    type Method: OneStep<P>;

    /// Smallest number of runs that are faster at once than one after the other.
    const LEAST: usize;

    /// Evaluations of the right-hand side in one attempt, beside those for a [proposal](Self::propose) of its size.
    const N_RHS: u64;

    /// Whether the guards are tested by values and rates at the ends of a step alone, which says nothing of guards that
    /// move faster than the states.
    const TESTS_ENDS: bool;

    /// Evaluations of the right-hand side for the slope at the end of an accepted step.
    fn n_rhs_of_end(method: &Self::Method) -> u64;

    /// The judgement on the last steps.
    fn judgement(&self) -> &Judgement<V>;

    /// The same, to change it.
    fn judgement_mut(&mut self) -> &mut Judgement<V>;

    /// Writes the start of the next step of `method` to `lane`, with the heights below which turns of guards are noted.
    fn load(&mut self, lane: usize, method: &Self::Method, turn_limits: &P::Guards<f64>);

    /// Computes what steps of any size from the present starts have in common.
    fn prepare(&mut self, field: &ByParameters<P, V>);

    /// Has `method` propose the size of the step in `lane`, if it [does](OneStep::PROPOSES).
    fn propose(&self, lane: usize, method: &mut Self::Method) -> Option<f64>;

    /// Whether the step that `method` is to take is one of those at once.
    fn serves(&self, method: &Self::Method) -> bool;

    /// The start times.
    fn t0(&self) -> Lanes<V>;

    /// Takes steps of sizes `h` to `t1`, and judges them.
    fn take(&mut self, field: &ByParameters<P, V>, t1: Lanes<V>, h: Lanes<V>);

    /// Guard `i` at the ends of the steps.
    fn guard_at_end(&self, i: usize) -> Lanes<V>;

    /// Notes in `watch` the turns of guards on the step in `lane`, of size `h` from `t0`, on which all are far from falling.
    fn note_turns(&self, lane: usize, of_step: (f64, f64), watch: &mut GuardWatch<P>);

    /// Makes the ends of the steps the starts of the next ones.
    fn advance(&mut self);

    /// Copies the start in `lane`, which is at the time `t0`, to `method`.
    fn unload_start(&self, lane: usize, t0: f64, method: &mut Self::Method);

    /// Copies the end of the step of size `h` to `t1` in `lane` to `method`.
    fn unload_end(&self, lane: usize, t1: f64, h: f64, method: &mut Self::Method);

    /// Copies what dense output needs of the step in `lane`, beside its ends, to `method`.
    fn unload_dense(&self, lane: usize, method: &mut Self::Method);

    /// Copies all that is known of the step in `lane`, beside its ends, to `method`.
    fn unload_within(&self, lane: usize, method: &mut Self::Method);
}

/// The tolerances of several runs, and the judgement on their last steps.
pub(super) struct Judgement<V> {
    rtol: Lanes<V>,
    atol: Vec<Lanes<V>>,
    /// Whether any run has a tolerance.
    is_adaptive: bool,
    /// Squares of the norms of the errors.
    pub(super) error_sq: Lanes<V>,
    /// A bit for each lane, set where the end of the step is finite and its guards are far from falling.
    pub(super) is_clear: u32,
    /// A bit for each lane, set where besides no guard turns low.
    pub(super) is_plain: u32,
}

impl<V: Simd> Judgement<V> {
    /// For runs of `n` states.
    pub(super) fn new(n: usize) -> Self {
        let one = Lanes::cst(1.0);
        Self {
            rtol: one,
            atol: vec![one; n],
            is_adaptive: false,
            error_sq: one,
            is_clear: 0,
            is_plain: 0,
        }
    }

    /// Sets the tolerance of the run in `lane`, if its `control` has one. Otherwise its error is never looked at.
    pub(super) fn tolerate(&mut self, lane: usize, control: &Control) {
        if let Control::Adaptive(tolerance) = control {
            self.is_adaptive = true;
            self.rtol.set(lane, tolerance.rtol);
            for (all, atol) in self.atol.iter_mut().zip(&tolerance.atol) {
                all.set(lane, *atol);
            }
        }
    }

    /// The tolerances, if there are any.
    #[inline(always)]
    pub(super) fn tolerances(&self) -> Option<(Lanes<V>, &[Lanes<V>])> {
        self.is_adaptive.then_some((self.rtol, &self.atol))
    }

    /// Ends with lanes without turns, where the least
    /// [`no_turn`](crate::event_location::no_turn) of all guards is zero or more.
    #[inline(always)]
    pub(super) fn end_with(&mut self, least: Lanes<V>) {
        self.is_plain = self.is_clear & least.is_above(Lanes::cst(-f64::MIN_POSITIVE));
    }

    /// Begins with lanes whose ends are finite, by the states and slopes there.
    #[inline(always)]
    pub(super) fn look_at_ends(&mut self, y1: &[Lanes<V>], slope1: &[Lanes<V>]) {
        // The sum is finite only where all of them are; one that overflows costs a look at its step.
        let ends = y1.iter().chain(slope1);
        let sum = ends.fold(Lanes::cst(0.0), |sum: Lanes<V>, x| sum + *x);
        self.is_clear = Lanes::cst(f64::INFINITY).is_above(sum.abs());
    }
}

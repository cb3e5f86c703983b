//! The hybrid system: all that the integrators ask of a model.

use std::fmt::Debug;

use num_dual::Dual64;

use crate::real::{Over, Real};
use crate::{rounding, sparsity};

/// A vector of scalars of one length: `[S; N]` where it is small and known, `Vec<S>` otherwise.
///
/// ```
/// use deltazero_solvers::Vector;
///
/// let squares: Vec<f64> = Vector::from_fn(3, |i| (i * i) as f64);
/// assert_eq!(squares, [0.0, 1.0, 4.0]);
/// ```
pub trait Vector<S>: Clone + Debug + AsRef<[S]> + AsMut<[S]> {
    /// Whether the length is part of the type, and small. Such vectors get code specialised to their length, and
    /// dense matrices.
    const IS_SHORT: bool = false;

    /// The length, where it is part of the type; zero where it is not.
    const LENGTH: usize = 0;

    /// The vector of length `n` with the entries `entry(0) … entry(n − 1)`.
    ///
    /// # Panics
    /// Where the length is part of the type and `n` is another.
    fn from_fn(n: usize, entry: impl FnMut(usize) -> S) -> Self;

    /// Moves the vector out of its place, to be put back later. A short vector is copied, so that the compiler can
    /// keep it in registers; a long one is moved without copying its entries and leaves an empty vector behind.
    fn take(&mut self) -> Self;
}

impl<S: Copy + Debug, const N: usize> Vector<S> for [S; N] {
    const IS_SHORT: bool = true;

    const LENGTH: usize = N;

    // Up to eight entries are set one by one at constant places, so that the compiler can keep those of a series in registers once
    // this is inlined. `std::array::from_fn`, a loop over a guarded array, is some ten times as many lines of LLVM code.
    #[inline(always)]
    #[rustfmt::skip]
    fn from_fn(n: usize, mut entry: impl FnMut(usize) -> S) -> Self {
        assert_eq!(n, N, "a vector of {N} entries was asked to hold {n}");
        if const { N == 0 } {
            return std::array::from_fn(entry);
        }
        let mut vector = [entry(0); N];
        if const { N > 8 } {
            // A range would be more code in each of some hundred instances.
            let mut i = 1;
            while i < N {
                vector[i] = entry(i);
                i += 1;
            }
            return vector;
        }
        if const { N > 1 } { vector[1] = entry(1); }
        if const { N > 2 } { vector[2] = entry(2); }
        if const { N > 3 } { vector[3] = entry(3); }
        if const { N > 4 } { vector[4] = entry(4); }
        if const { N > 5 } { vector[5] = entry(5); }
        if const { N > 6 } { vector[6] = entry(6); }
        if const { N > 7 } { vector[7] = entry(7); }
        vector
    }

    #[inline(always)]
    fn take(&mut self) -> Self {
        *self
    }
}

impl<S: Clone + Debug> Vector<S> for Vec<S> {
    // The vector that `collect` gives, by a quarter as many lines of LLVM code.
    fn from_fn(n: usize, mut entry: impl FnMut(usize) -> S) -> Self {
        let mut vector = Vec::with_capacity(n);
        for i in 0..n {
            vector.push(entry(i));
        }
        vector
    }

    fn take(&mut self) -> Self {
        std::mem::take(self)
    }
}

/// What follows an event.
///
/// ```
/// use deltazero_solvers::Next;
///
/// /// A ball flies on from its first two bounces, and the run ends at the third.
/// fn after(bounces: u32) -> Next<u32> {
///     if bounces < 2 { Next::Mode(bounces + 1) } else { Next::Stop }
/// }
/// assert_eq!((after(1), after(2)), (Next::Mode(2), Next::Stop));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Next<M> {
    /// The system continues in this mode, which may be the same one after a reset of the state.
    Mode(M),
    /// The event is terminal: the run ends here.
    Stop,
}

/// A hybrid system: smooth dynamics in each of several modes, and surfaces between them.
///
/// ```text
/// ẏ = f_mode(t, y)    while every guard g_i(t, y) ≥ 0;
/// where g_i falls below zero:  (mode, y) ← transition(mode, i, t, y).
/// ```
///
/// The model evaluates functions and contains no loop: the driver chooses the times and step sizes and locates the
/// events. Within a mode, `rhs` and `guards` must be smooth functions of time and state, and they must be defined a
/// little beyond the mode's surfaces too, because a step is taken in one mode and cut afterwards.
pub trait System {
    /// The discrete state. It may carry data, such as the speed of the last impact. It is cloned often, so a long
    /// mode should be a cheap handle to shared data, such as an `Arc<[T]>`.
    type Mode: Clone + PartialEq + Debug;
    /// The continuous state, of length [`dim`](Self::dim).
    type State<S: Real>: Vector<S>;
    /// The values of the guards, of length [`n_guards`](Self::n_guards).
    type Guards<S: Real>: Vector<S>;

    /// Whether the Taylor method [traces](crate::taylor::trace) an evaluation once a step, and follows the trace for each
    /// order. Where it does not, it evaluates once an order, by code specialised to the order, and runs of a kind in lanes. That is
    /// faster where the compiler sees every operation, and the default for states in a short array. A model that interprets its formulas is
    /// better traced. With double-double numbers every system is.
    const IS_TRACED: bool = !<Self::State<f64> as Vector<f64>>::IS_SHORT;

    /// Whether the right-hand side reads its mode off the state, as that of a [`Blind`](crate::Blind) system. A step goes over its
    /// switches, so it has no [sensitivities](crate::Sensitive).
    const IS_BLIND: bool = false;

    /// Number of continuous states, at least one: by default the length of [`State`](Self::State), which an array has in
    /// its type. A model whose states are in a `Vec` must tell it.
    fn dim(&self) -> usize {
        <Self::State<f64> as Vector<f64>>::LENGTH
    }

    /// Number of guards, the same in all modes; by default as [`dim`](Self::dim). A guard that a mode does not use is a
    /// positive constant there.
    fn n_guards(&self) -> usize {
        <Self::Guards<f64> as Vector<f64>>::LENGTH
    }

    /// The mode of a run that starts at `(t, y)`.
    fn initial_mode(&self, t: f64, y: &Self::State<f64>) -> Self::Mode;

    /// Writes `f_mode(t, y)` to `dydt`.
    fn rhs<S: Real>(&self, mode: Self::Mode, t: S, y: &Self::State<S>, dydt: &mut Self::State<S>);

    /// Writes the guards of `mode` to `g`. They are positive inside the mode.
    fn guards<S: Real>(&self, mode: Self::Mode, t: S, y: &Self::State<S>, g: &mut Self::Guards<S>);

    /// Where [`rhs`](Self::rhs) and [`guards`](Self::guards) have terms in common in `mode`, writes both, with the bits
    /// that the two functions give alone, and returns true. Elsewhere it returns false without an operation, as the
    /// default always does; the caller then evaluates the two. The answer depends on the mode alone.
    ///
    /// Where it writes, it must first make all operations of `rhs` on numbers, in the order of `rhs`. The reason: a
    /// Taylor series is begun with this function and, unless it is [traced](Self::IS_TRACED), continued with `rhs`; both address the stored coefficients
    /// by the position of the operation. A breach gives wrong series: steps to a tolerance are rejected until the run
    /// ends in [`StepUnderflow`](crate::Error::StepUnderflow), and fixed steps are accepted with wrong results. A
    /// model with an own implementation should test it with [`contracts::check`](crate::contracts::check).
    #[inline(always)]
    fn rhs_with_guards<S: Real>(
        &self,
        _mode: Self::Mode,
        _t: S,
        _y: &Self::State<S>,
        _dydt: &mut Self::State<S>,
        _g: &mut Self::Guards<S>,
    ) -> bool {
        false
    }

    /// Writes bounds of the rounding errors of [`guards`](Self::guards) to `bounds`, in the units of the guards and
    /// above zero. A guard is *violated* when it is below minus its bound.
    ///
    /// The default follows the rounding of each operation of the guards ([`rounding`]). It takes a state for as exact as its own
    /// last digits. A model knows better where a state comes from terms that cancel, as a gap does that is a difference of two
    /// positions, or where it wants to save the evaluations.
    fn guard_bounds(
        &self,
        mode: Self::Mode,
        t: f64,
        y: &Self::State<f64>,
        bounds: &mut Self::Guards<f64>,
    ) where
        Self: Sized,
    {
        rounding::guard_bounds(self, mode, t, y, |_| 0.0, bounds);
    }

    /// A span such that no guard depends on two states whose indices differ by a multiple of it. States this far
    /// apart never enter the same guard, so one evaluation with dual numbers differentiates the guards by all of them
    /// at once. A system of many similar parts overrides this to save evaluations; the default, the number of states,
    /// differentiates by one state at a time.
    fn guard_span(&self) -> usize {
        self.dim()
    }

    /// What happens when guard number `guard` of `mode` has fallen below zero at `(t, y)`: returns the next mode, and
    /// changes `y` where the event resets it.
    ///
    /// Every guard of the new mode must be at or above zero at the new state, up to rounding; otherwise it switches
    /// too, at the same t. So the transition projects the state onto what the event *means*: a height of zero after a
    /// bounce, a velocity of zero when sticking begins.
    fn transition<S: Real>(
        &self,
        mode: Self::Mode,
        guard: usize,
        t: S,
        y: &mut Self::State<S>,
    ) -> Next<Self::Mode>;

    /// What follows where events accumulate (a Zeno point: a ball bounces ever lower and comes to rest): returns the
    /// limiting mode and sets `y` to the limiting state. Returns `None` where the model knows no limit, as the
    /// default does; the run then ends in [`EventStorm`](crate::Error::EventStorm).
    ///
    /// It is called after the transition of the last of these events: `mode` and `y` are those after that transition,
    /// and `guard` is the guard that fell, numbered in the mode before it. The change to the limiting mode counts as
    /// one more event, of the same guard.
    fn accumulation(
        &self,
        _mode: Self::Mode,
        _guard: usize,
        _t: f64,
        _y: &mut Self::State<f64>,
    ) -> Option<Self::Mode> {
        None
    }

    /// Calls `entry(i, j, ∂f_i/∂y_j)` for every entry of the Jacobian that can be nonzero in some mode. Entries that
    /// vanish in this mode alone should be given, as zeros. A mode that couples more states may give further entries;
    /// each new sparsity pattern costs a new symbolic analysis.
    ///
    /// The default differentiates [`rhs`](Self::rhs) with dual numbers, exact to rounding. For a short state it
    /// evaluates them once for each column. For others it first finds which states each slope depends on at this state,
    /// by one evaluation for each 64 states. It then gives these entries alone, and evaluates columns without a common
    /// row together.
    ///
    /// Each entry is given once: entries given twice are not added.
    ///
    /// # Panics
    /// A run panics where `i` or `j` is not that of a state; [`contracts::check`](crate::contracts::check) tells of it.
    fn jacobian(
        &self,
        mode: Self::Mode,
        t: f64,
        y: &Self::State<f64>,
        entry: impl FnMut(usize, usize, f64),
    ) where
        Self: Sized,
    {
        differentiated(self, mode, t, y, entry);
    }

    /// Writes the derivative `∂f_mode/∂t` at a fixed state to `dfdt`.
    ///
    /// The default differentiates [`rhs`](Self::rhs) with a dual number; an autonomous system may
    /// write zeros.
    fn time_derivative(
        &self,
        mode: Self::Mode,
        t: f64,
        y: &Self::State<f64>,
        dfdt: &mut Self::State<f64>,
    ) where
        Self: Sized,
    {
        let dydt = differentiated_by_time(self, mode, t, y);
        for (dfdt, d) in dfdt.as_mut().iter_mut().zip(dydt.as_ref()) {
            *dfdt = d.eps;
        }
    }
}

/// [`System::jacobian`] by its default: of [`System::rhs`], by dual numbers.
pub(crate) fn differentiated<P: System>(
    problem: &P,
    mode: P::Mode,
    t: f64,
    y: &P::State<f64>,
    mut entry: impl FnMut(usize, usize, f64),
) {
    let (n, y) = (problem.dim(), y.as_ref());
    if const { !<P::State<f64> as Vector<f64>>::IS_SHORT } {
        return sparsity::jacobian(problem, &mode, t, y, &mut entry);
    }
    let mut dydt = P::State::<Dual64>::from_fn(n, |_| Dual64::from_re(0.0));
    for j in 0..n {
        let seeded =
            P::State::<Dual64>::from_fn(n, |i| Dual64::new(y[i], if i == j { 1.0 } else { 0.0 }));
        problem.rhs(mode.clone(), Dual64::from_re(t), &seeded, &mut dydt);
        for (i, d) in dydt.as_ref().iter().enumerate() {
            entry(i, j, d.eps);
        }
    }
}

/// [`System::rhs`] at a fixed state, with its derivative by time, by a dual number.
pub(crate) fn differentiated_by_time<P: System>(
    problem: &P,
    mode: P::Mode,
    t: f64,
    y: &P::State<f64>,
) -> P::State<Dual64> {
    let y = y.as_ref();
    let y = P::State::<Dual64>::from_fn(y.len(), |i| Dual64::from_re(y[i]));
    let mut dydt = y.clone();
    problem.rhs(mode, Dual64::new(t, 1.0), &y, &mut dydt);
    dydt
}

/// Systems of one kind that differ, in some of their modes, only in numerical parameters.
/// [`Method::run_batch`](crate::Method::run_batch) then computes several runs in such modes at once, each of a system
/// of its own.
///
/// Where `parameters(mode)` is `Some`, the functions `rhs_of` and `guards_of` applied to these parameters must give
/// the same bits as [`rhs`](System::rhs) and [`guards`](System::guards) of that mode, except for the sign of a zero.
/// The first step of each such phase is compared with them, and a difference ends the run in
/// [`UnlikeParameters`](crate::Error::UnlikeParameters). They must not branch on the [value](Real::value) of a number,
/// not even inside [outlined](crate::real::Shortcuts::outlined) functions, because several runs are computed by one sequence of
/// operations. Bounds of rounding, transitions and accumulation are asked of each system separately.
///
/// The operations are generic over the type `C` of the parameters: `f64` for one system, a vector type for several.
/// The parameters enter as in `y * c`, `y + c` and `y - c`, or by `<S as Over<C>>::of(c)`. They are not combined with
/// each other: a product of two constants is a parameter of its own, computed in the order in which `rhs` computes it.
///
/// ```
/// use deltazero_solvers::problems::{BouncingBall, BouncingMode};
/// use deltazero_solvers::{Alike, System};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// assert_eq!(ball.parameters(&BouncingMode::Flight), Some([-9.8]));
/// assert_eq!(ball.parameters(&BouncingMode::Rest), None);
/// let (y, mut own, mut of_kind) = ([1.0, 2.0], [0.0; 2], [0.0; 2]);
/// ball.rhs(BouncingMode::Flight, 0.0, &y, &mut own);
/// BouncingBall::rhs_of(&[-9.8], 0.0, &y, &mut of_kind);
/// assert_eq!((own, of_kind), ([2.0, -9.8], [2.0, -9.8]));
/// ```
pub trait Alike: System {
    /// The numerical parameters of one system in one mode.
    type Parameters<C: Copy + Debug>: Vector<C>;

    /// The parameters of this system in `mode`, as many as of any system of the kind; `None` where the mode cannot be
    /// expressed by `rhs_of` and `guards_of`.
    fn parameters(&self, mode: &Self::Mode) -> Option<Self::Parameters<f64>>;

    /// Writes `f_mode(t, y)` to `dydt`.
    fn rhs_of<S: Over<C>, C: Copy + Debug>(
        parameters: &Self::Parameters<C>,
        t: S,
        y: &Self::State<S>,
        dydt: &mut Self::State<S>,
    );

    /// Writes the guards of the mode to `g`.
    fn guards_of<S: Over<C>, C: Copy + Debug>(
        parameters: &Self::Parameters<C>,
        t: S,
        y: &Self::State<S>,
        g: &mut Self::Guards<S>,
    );

    /// Writes both, with the bits that the two give alone; it must first make all operations of `rhs_of`, in their order.
    #[inline(always)]
    fn rhs_with_guards_of<S: Over<C>, C: Copy + Debug>(
        parameters: &Self::Parameters<C>,
        t: S,
        y: &Self::State<S>,
        dydt: &mut Self::State<S>,
        g: &mut Self::Guards<S>,
    ) {
        Self::rhs_of(parameters, t, y, dydt);
        Self::guards_of(parameters, t, y, g);
    }
}

/// A [`System`] whose mode can be read off its state, which an event-blind integration needs.
///
/// ```
/// use deltazero_solvers::ModeOfState;
/// use deltazero_solvers::problems::{HertzBall, StopMode};
///
/// let ball = HertzBall { mass: 1.0, stiffness: 1e4, exponent: 1.5, start: [-0.1, 1.0] };
/// assert_eq!(ball.mode_of_state(0.0, &[-1e-3, 1.0]), StopMode::Free);
/// assert_eq!(ball.mode_of_state(0.0, &[1e-3, 1.0]), StopMode::Contact);
/// // On the surface the velocity decides.
/// assert_eq!(ball.mode_of_state(0.0, &[0.0, 1.0]), StopMode::Contact);
/// assert_eq!(ball.mode_of_state(0.0, &[0.0, -1.0]), StopMode::Free);
/// ```
pub trait ModeOfState: System {
    /// The mode at `(t, y)`, from the signs of the quantities that the guards are made of.
    fn mode_of_state<S: Real>(&self, t: S, y: &Self::State<S>) -> Self::Mode;

    /// A guard that ends a run in any mode, positive until then. It is the only guard that an event-blind run keeps.
    /// The default never falls below zero.
    fn end<S: Real>(&self, _t: S, _y: &Self::State<S>) -> S {
        S::cst(1.0)
    }

    /// A bound of the rounding error of [`end`](Self::end), above zero.
    fn end_bound(&self) -> f64 {
        f64::EPSILON
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The indices that a vector of length `n` asks for must be its entries.
    fn is_in_order<V: Vector<usize>>(n: usize) {
        let mut asked = Vec::new();
        let vector = V::from_fn(n, |i| {
            asked.push(i);
            i
        });
        assert!(asked.iter().copied().eq(0..n), "{n}: {asked:?}");
        assert_eq!(vector.as_ref(), asked);
    }

    #[test]
    fn entries_are_made_once_and_in_order() {
        is_in_order::<[usize; 0]>(0);
        is_in_order::<[usize; 1]>(1);
        is_in_order::<[usize; 2]>(2);
        is_in_order::<[usize; 7]>(7);
        is_in_order::<[usize; 8]>(8);
        is_in_order::<[usize; 9]>(9);
        is_in_order::<[usize; 20]>(20);
        for n in [0, 1, 9] {
            is_in_order::<Vec<usize>>(n);
        }
    }
}

//! The hybrid system: what a model tells the integrators, and nothing about how they ask.

use std::fmt::Debug;

use num_dual::Dual64;

use crate::real::{Over, Real};

/// A vector of scalars of one length: `[S; N]` where it is small and known, `Vec<S>` otherwise.
pub trait Vector<S>: Clone + Debug + AsRef<[S]> + AsMut<[S]> {
    /// Whether its length is part of its type, and small: what is worth code of its own, and dense matrices.
    const IS_SHORT: bool = false;

    /// The vector of length `n` with the entries `entry(0) … entry(n − 1)`.
    ///
    /// # Panics
    /// Where the length is part of the type and `n` is another.
    fn from_fn(n: usize, entry: impl FnMut(usize) -> S) -> Self;

    /// Moves it out, to be put back later: a short one into registers, a long one without a copy of its
    /// entries, whose place then holds none.
    fn take(&mut self) -> Self;
}

impl<S: Copy + Debug, const N: usize> Vector<S> for [S; N] {
    const IS_SHORT: bool = true;

    // Up to eight entries without a loop or a call: those of a series are then registers.
    #[inline(always)]
    fn from_fn(n: usize, mut entry: impl FnMut(usize) -> S) -> Self {
        assert_eq!(n, N, "a vector of {N} entries was asked to hold {n}");
        if N == 0 || N > 8 {
            return std::array::from_fn(entry);
        }
        let first = entry(0);
        let mut at = |i: usize| if i < N { entry(i) } else { first };
        let eight = [first, at(1), at(2), at(3), at(4), at(5), at(6), at(7)];
        match <[S; N]>::try_from(&eight[..N]) {
            Ok(vector) => vector,
            Err(_) => std::array::from_fn(|i| eight[i]),
        }
    }

    #[inline(always)]
    fn take(&mut self) -> Self {
        *self
    }
}

impl<S: Clone + Debug> Vector<S> for Vec<S> {
    fn from_fn(n: usize, entry: impl FnMut(usize) -> S) -> Self {
        (0..n).map(entry).collect()
    }

    fn take(&mut self) -> Self {
        std::mem::take(self)
    }
}

/// What follows an event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Next<M> {
    /// The system goes on in this mode (the same one after a reset of the state).
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
/// The model answers questions and owns no loop: time, step size and the location of events are
/// the driver's. `rhs` and `guards` must be smooth functions *of their mode*, defined a little
/// past its surfaces too: a step is taken whole in one mode and then cut.
pub trait System {
    /// The discrete state. It may carry data, such as the speed of the last impact. It is handed on by
    /// value, often: a long one is a handle to its parts, as an `Arc<[T]>` is.
    type Mode: Clone + PartialEq + Debug;
    /// The continuous state, [`dim`](Self::dim) long.
    type State<S: Real>: Vector<S>;
    /// The values of the guards, [`n_guards`](Self::n_guards) long.
    type Guards<S: Real>: Vector<S>;

    /// Whether [`rhs`](Self::rhs) and [`guards`](Self::guards) of a mode take no decision on the
    /// [value](Real::value) of a number, unless [outlined](Real::outlined): several runs are then computed at once,
    /// in [`lanes`](crate::lanes).
    const IN_LANES: bool = false;

    /// Number of continuous states.
    fn dim(&self) -> usize;

    /// Number of guards, the same in all modes; one that a mode does not use is a positive
    /// constant there.
    fn n_guards(&self) -> usize;

    /// The mode of a run that starts at `(t, y)`.
    fn initial_mode(&self, t: f64, y: &Self::State<f64>) -> Self::Mode;

    /// Writes `f_mode(t, y)` to `dydt`.
    fn rhs<S: Real>(&self, mode: Self::Mode, t: S, y: &Self::State<S>, dydt: &mut Self::State<S>);

    /// Writes the guards of `mode` to `g`: positive inside the mode.
    fn guards<S: Real>(&self, mode: Self::Mode, t: S, y: &Self::State<S>, g: &mut Self::Guards<S>);

    /// Writes both [`rhs`](Self::rhs) and [`guards`](Self::guards) at `(t, y)`, each to the bit. Where the two have
    /// terms in common, a model may compute those once; the default calls one after the other.
    ///
    /// Its operations on numbers begin with those of `rhs`, in the order of `rhs`: a series is begun by the
    /// one and gone on with by the other. Where they do not, series are wrong: steps to a tolerance are rejected
    /// until a run ends in [`StepUnderflow`](crate::Error::StepUnderflow), fixed ones are not. A model that
    /// has its own is tested by [`begins_with_rhs`](crate::taylor::expand::begins_with_rhs).
    #[inline(always)]
    fn rhs_with_guards<S: Real>(
        &self,
        mode: Self::Mode,
        t: S,
        y: &Self::State<S>,
        dydt: &mut Self::State<S>,
        g: &mut Self::Guards<S>,
    ) {
        self.rhs(mode.clone(), t, y, dydt);
        self.guards(mode, t, y, g);
    }

    /// Writes bounds of the rounding errors of [`guards`](Self::guards) to `bounds`, in the
    /// guards' units and above zero: a guard is *violated* when it is below minus its bound.
    fn guard_bounds(
        &self,
        mode: Self::Mode,
        t: f64,
        y: &Self::State<f64>,
        bounds: &mut Self::Guards<f64>,
    );

    /// A distance of states at whose multiples no two of them, by index, are in one guard: what a system of
    /// many like parts tells for the sake of its cost. The default tells nothing.
    fn guard_span(&self) -> usize {
        self.dim()
    }

    /// What happens when guard number `guard` of `mode` fell below zero at `(t, y)`: the next
    /// mode, with `y` changed where the event resets it.
    ///
    /// Every guard of the new mode must be at or above zero at the new state, up to rounding, or it
    /// switches too, at the same t: what the event *means* is projected (a height of zero after a bounce, a velocity of zero
    /// when sticking begins).
    fn transition<S: Real>(
        &self,
        mode: Self::Mode,
        guard: usize,
        t: S,
        y: &mut Self::State<S>,
    ) -> Next<Self::Mode>;

    /// What follows where events accumulate (a Zeno point: a ball bounces ever lower and comes to
    /// rest): the limiting mode, with `y` put on its state. None where the model knows of none, and
    /// the run ends in [`EventStorm`](crate::Error::EventStorm); so does the default.
    ///
    /// It is asked after the transition of the last of these events: `mode` and `y` are what that
    /// transition made, `guard` is the guard that fell, numbered in the mode before it. The handover is
    /// an event of its own, of the same guard.
    fn accumulation(
        &self,
        _mode: Self::Mode,
        _guard: usize,
        _t: f64,
        _y: &mut Self::State<f64>,
    ) -> Option<Self::Mode> {
        None
    }

    /// Calls `entry(i, j, ∂f_i/∂y_j)` for every entry of the Jacobian that is not zero in all
    /// modes; entries that vanish in this mode alone are given as zero. A mode that couples more states
    /// than the usual ones may give more: each new pattern is analysed anew.
    ///
    /// The default differentiates [`rhs`](Self::rhs) with dual numbers, one column a call: exact
    /// to rounding, and `dim` evaluations in cost.
    fn jacobian(
        &self,
        mode: Self::Mode,
        t: f64,
        y: &Self::State<f64>,
        mut entry: impl FnMut(usize, usize, f64),
    ) where
        Self: Sized,
    {
        let n = self.dim();
        let y = y.as_ref();
        let mut dydt = Self::State::<Dual64>::from_fn(n, |_| Dual64::from_re(0.0));
        for j in 0..n {
            let seeded = Self::State::<Dual64>::from_fn(n, |i| {
                Dual64::new(y[i], if i == j { 1.0 } else { 0.0 })
            });
            self.rhs(mode.clone(), Dual64::from_re(t), &seeded, &mut dydt);
            for (i, d) in dydt.as_ref().iter().enumerate() {
                entry(i, j, d.eps);
            }
        }
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
        let n = self.dim();
        let y = Self::State::<Dual64>::from_fn(n, |i| Dual64::from_re(y.as_ref()[i]));
        let mut dydt = Self::State::<Dual64>::from_fn(n, |_| Dual64::from_re(0.0));
        self.rhs(mode, Dual64::new(t, 1.0), &y, &mut dydt);
        for (dfdt, d) in dfdt.as_mut().iter_mut().zip(dydt.as_ref()) {
            *dfdt = d.eps;
        }
    }
}

/// Systems of a kind, of which some modes differ in numbers alone: two runs in such modes, each of a system of
/// its own, are then computed at once, by [`Method::run_pair`](crate::Method::run_pair).
///
/// Where `numbers(mode)` are some, [`rhs`](System::rhs) and [`guards`](System::guards) of that mode are `rhs_of` and
/// `guards_of` them to the bit (but for the sign of a zero), and neither takes a decision on the
/// [value](Real::value) of a number, not even [outlined](Real::outlined): a series of two runs has one course. Bounds of rounding, transitions and accumulation stay each system's own.
///
/// The operations are written over the numbers of one system, `C = f64`, or of several. Those enter as in
/// `y * c`, `y + c` and `y - c`, or by `<S as Over<C>>::of(c)`; with each other they are not computed with, so a
/// product of two constants is a number of its own, made in the order in which `rhs` does. For an example see
/// [`BouncingBall`](crate::problems::BouncingBall), whose number is gravity.
pub trait Alike: System {
    /// What tells one system in one mode from another.
    type Numbers<C: Copy + Debug>: Vector<C>;

    /// The numbers of this system in `mode`, as many as of any system of the kind; none where it is computed in
    /// another way.
    fn numbers(&self, mode: &Self::Mode) -> Option<Self::Numbers<f64>>;

    /// Writes `f_mode(t, y)` to `dydt`.
    fn rhs_of<S: Over<C>, C: Copy + Debug>(
        numbers: &Self::Numbers<C>,
        t: S,
        y: &Self::State<S>,
        dydt: &mut Self::State<S>,
    );

    /// Writes the guards of the mode to `g`.
    fn guards_of<S: Over<C>, C: Copy + Debug>(
        numbers: &Self::Numbers<C>,
        t: S,
        y: &Self::State<S>,
        g: &mut Self::Guards<S>,
    );

    /// Writes both; as [`System::rhs_with_guards`].
    #[inline(always)]
    fn rhs_with_guards_of<S: Over<C>, C: Copy + Debug>(
        numbers: &Self::Numbers<C>,
        t: S,
        y: &Self::State<S>,
        dydt: &mut Self::State<S>,
        g: &mut Self::Guards<S>,
    ) {
        Self::rhs_of(numbers, t, y, dydt);
        Self::guards_of(numbers, t, y, g);
    }
}

/// A [`System`] whose mode can be read off its state, as an event-blind integration needs it.
pub trait ModeOfState: System {
    /// The mode that the signs of `(t, y)` name.
    fn mode_of_state<S: Real>(&self, t: S, y: &Self::State<S>) -> Self::Mode;

    /// A guard that ends a run in whatever mode, positive until then; a blind run keeps it alone.
    /// The default never falls.
    fn end<S: Real>(&self, _t: S, _y: &Self::State<S>) -> S {
        S::cst(1.0)
    }

    /// A bound of the rounding error of [`end`](Self::end), above zero.
    fn end_bound(&self) -> f64 {
        f64::EPSILON
    }
}

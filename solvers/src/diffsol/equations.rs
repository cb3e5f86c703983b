//! A [`System`] in one mode, as `diffsol` wants its equations.

use std::cell::{Cell, RefCell};

use diffsol::{
    ConstantOp, Matrix as _, NalgebraContext, NalgebraMat, NalgebraVec, NonLinearOp,
    NonLinearOpJacobian, OdeEquations, OdeEquationsRef, Op, UnitCallable, Vector as _,
    VectorCommon,
};

use crate::system::{System, Vector};

pub(crate) type M = NalgebraMat<f64>;
pub(crate) type V = NalgebraVec<f64>;

/// `ẏ = f_mode(t, y)` from `y0`.
pub(crate) struct Equations<'p, P: System> {
    pub(crate) problem: &'p P,
    pub(crate) mode: P::Mode,
    pub(crate) y0: P::State<f64>,
    /// The slope last evaluated.
    pub(crate) slope: RefCell<P::State<f64>>,
    pub(crate) n_rhs: Cell<u64>,
    pub(crate) n_jac: Cell<u64>,
    /// The state whose slope was not finite when last evaluated.
    pub(crate) non_finite: Cell<Option<usize>>,
    /// The row of a Jacobian that had an entry which was not.
    pub(crate) non_finite_row: Cell<Option<usize>>,
    context: NalgebraContext,
}

impl<'p, P: System> Equations<'p, P> {
    pub(crate) fn new(problem: &'p P, mode: P::Mode, y0: P::State<f64>) -> Self {
        let (n_rhs, n_jac) = (Cell::new(0), Cell::new(0));
        Self {
            problem,
            mode,
            slope: RefCell::new(y0.clone()),
            y0,
            n_rhs,
            n_jac,
            non_finite: Cell::new(None),
            non_finite_row: Cell::new(None),
            context: NalgebraContext::default(),
        }
    }
}

/// The state in `x`.
#[inline]
pub(crate) fn state<P: System>(problem: &P, x: &V) -> P::State<f64> {
    let n = problem.dim();
    let x = &x.inner().as_slice()[..n];
    P::State::from_fn(n, |i| x[i])
}

impl<P: System> Op for Equations<'_, P> {
    type T = f64;
    type V = V;
    type M = M;
    type C = NalgebraContext;

    fn context(&self) -> &Self::C {
        &self.context
    }

    fn nstates(&self) -> usize {
        self.problem.dim()
    }

    fn nout(&self) -> usize {
        self.problem.dim()
    }

    fn nparams(&self) -> usize {
        0
    }
}

impl<'a, P: System> OdeEquationsRef<'a> for Equations<'_, P> {
    type Mass = UnitCallable<M>;
    type Rhs = &'a Self;
    type Root = UnitCallable<M>;
    type Init = &'a Self;
    type Out = UnitCallable<M>;
    type Reset = UnitCallable<M>;
}

impl<P: System> OdeEquations for Equations<'_, P> {
    fn rhs(&self) -> &Self {
        self
    }

    fn mass(&self) -> Option<UnitCallable<M>> {
        None
    }

    fn init(&self) -> &Self {
        self
    }

    fn set_params(&mut self, _p: &V) {}

    fn get_params(&self, _p: &mut V) {}
}

impl<P: System> ConstantOp for &Equations<'_, P> {
    fn call_inplace(&self, _t: f64, y: &mut V) {
        y.inner_mut().as_mut_slice().copy_from_slice(self.y0.as_ref());
    }
}

impl<P: System> NonLinearOp for &Equations<'_, P> {
    fn call_inplace(&self, x: &V, t: f64, y: &mut V) {
        self.n_rhs.set(self.n_rhs.get() + 1);
        let slope = &mut *self.slope.borrow_mut();
        self.problem.rhs(self.mode, t, &state(self.problem, x), slope);
        self.non_finite.set(slope.as_ref().iter().position(|d| !d.is_finite()));
        y.inner_mut().as_mut_slice().copy_from_slice(slope.as_ref());
    }
}

impl<P: System> NonLinearOpJacobian for &Equations<'_, P> {
    fn jac_mul_inplace(&self, x: &V, t: f64, v: &V, y: &mut V) {
        let (v, y) = (v.inner(), y.inner_mut());
        y.fill(0.0);
        let x = state(self.problem, x);
        self.problem.jacobian(self.mode, t, &x, |i, j, entry| y[i] += entry * v[j]);
    }

    fn jacobian_inplace(&self, x: &V, t: f64, jac: &mut M) {
        self.n_jac.set(self.n_jac.get() + 1);
        let jac = jac.inner_mut();
        let x = state(self.problem, x);
        self.problem.jacobian(self.mode, t, &x, |i, j, entry| {
            if !entry.is_finite() {
                self.non_finite_row.set(Some(i));
            }
            jac[(i, j)] = entry;
        });
    }
}

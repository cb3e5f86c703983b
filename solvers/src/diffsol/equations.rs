//! A [`System`] in one mode, in the form of equations that `diffsol` takes.

use std::cell::{Cell, RefCell};

use diffsol::{
    ConstantOp, NonLinearOp, NonLinearOpJacobian, OdeEquations, OdeEquationsRef, Op, UnitCallable,
};
use diffsol_la::Matrix;

use super::algebra::Algebra;
use crate::system::{System, Vector};

/// `ẏ = f_mode(t, y)` from `y0`.
pub(crate) struct Equations<'p, P: System, A: Algebra> {
    pub(crate) problem: &'p P,
    pub(crate) mode: P::Mode,
    pub(crate) y0: P::State<f64>,
    /// The slope last evaluated.
    pub(crate) slope: RefCell<P::State<f64>>,
    pub(crate) n_rhs: Cell<u64>,
    pub(crate) n_jac: Cell<u64>,
    /// The state whose slope was not finite in the last evaluation, if there was one.
    pub(crate) non_finite: Cell<Option<usize>>,
    /// The row of a Jacobian entry that was not finite, if there was one.
    pub(crate) non_finite_row: Cell<Option<usize>>,
    context: A::C,
}

impl<'p, P: System, A: Algebra> Equations<'p, P, A> {
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
            context: A::C::default(),
        }
    }
}

/// The state that the vector `x` holds.
#[inline]
pub(crate) fn state<P: System, A: Algebra>(problem: &P, x: &A::V) -> P::State<f64> {
    let n = problem.dim();
    let x = &A::components(x)[..n];
    P::State::from_fn(n, |i| x[i])
}

impl<P: System, A: Algebra> Op for Equations<'_, P, A> {
    type T = f64;
    type V = A::V;
    type M = A::M;
    type C = A::C;

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

impl<'a, P: System, A: Algebra> OdeEquationsRef<'a> for Equations<'_, P, A> {
    type Mass = UnitCallable<A::M>;
    type Rhs = &'a Self;
    type Root = UnitCallable<A::M>;
    type Init = &'a Self;
    type Out = UnitCallable<A::M>;
    type Reset = UnitCallable<A::M>;
}

impl<P: System, A: Algebra> OdeEquations for Equations<'_, P, A> {
    fn rhs(&self) -> &Self {
        self
    }

    fn mass(&self) -> Option<UnitCallable<A::M>> {
        None
    }

    fn init(&self) -> &Self {
        self
    }

    fn set_params(&mut self, _p: &A::V) {}

    fn get_params(&self, _p: &mut A::V) {}
}

impl<P: System, A: Algebra> ConstantOp for &Equations<'_, P, A> {
    fn call_inplace(&self, _t: f64, y: &mut A::V) {
        A::components_mut(y).copy_from_slice(self.y0.as_ref());
    }
}

impl<P: System, A: Algebra> NonLinearOp for &Equations<'_, P, A> {
    fn call_inplace(&self, x: &A::V, t: f64, y: &mut A::V) {
        self.n_rhs.set(self.n_rhs.get() + 1);
        let slope = &mut *self.slope.borrow_mut();
        self.problem.rhs(self.mode.clone(), t, &state::<P, A>(self.problem, x), slope);
        self.non_finite.set(slope.as_ref().iter().position(|d| !d.is_finite()));
        A::components_mut(y).copy_from_slice(slope.as_ref());
    }
}

impl<P: System, A: Algebra> NonLinearOpJacobian for &Equations<'_, P, A> {
    fn jac_mul_inplace(&self, x: &A::V, t: f64, v: &A::V, y: &mut A::V) {
        let (v, y) = (A::components(v), A::components_mut(y));
        y.fill(0.0);
        let x = state::<P, A>(self.problem, x);
        self.problem.jacobian(self.mode.clone(), t, &x, |i, j, entry| y[i] += entry * v[j]);
    }

    fn jacobian_inplace(&self, x: &A::V, t: f64, jac: &mut A::M) {
        self.n_jac.set(self.n_jac.get() + 1);
        let x = state::<P, A>(self.problem, x);
        A::clear(jac);
        self.problem.jacobian(self.mode.clone(), t, &x, |i, j, entry| {
            if !entry.is_finite() {
                self.non_finite_row.set(Some(i));
            }
            A::set(jac, i, j, entry);
        });
    }

    /// All entries that the Jacobian of the mode may have.
    fn jacobian_sparsity(&self) -> Option<<A::M as Matrix>::Sparsity> {
        let n = self.problem.dim();
        A::pattern(n, || {
            let mut entries: Vec<_> = (0..n).map(|i| (i, i)).collect();
            let mode = self.mode.clone();
            self.problem.jacobian(mode, 0.0, &self.y0, |i, j, _| entries.push((i, j)));
            entries
        })
    }
}

//! A [`Field`] in the form of equations that `diffsol` takes.

use std::cell::{Cell, RefCell};

use diffsol::{
    ConstantOp, NonLinearOp, NonLinearOpJacobian, OdeEquations, OdeEquationsRef, Op, UnitCallable,
};
use diffsol_la::Matrix;

use super::algebra::Algebra;
use super::field::Field;

/// Rows and columns of entries of a Jacobian.
pub(super) type Places = RefCell<Vec<(usize, usize)>>;

/// `ẏ = f(t, y)` from `y0` at `t0`.
pub(super) struct Equations<'f, A: Algebra> {
    field: &'f dyn Field,
    t0: f64,
    y0: &'f [f64],
    /// Places of entries that the Jacobian at the start does not have, and others had.
    further: &'f Places,
    /// Whether a Jacobian had one that the matrices have no place for.
    pub(super) is_outgrown: Cell<bool>,
    pub(super) n_rhs: Cell<u64>,
    pub(super) n_jac: Cell<u64>,
    /// The state whose slope was not finite in the last evaluation, if there was one.
    pub(super) non_finite: Cell<Option<usize>>,
    /// The row of a Jacobian entry that was not finite, if there was one.
    pub(super) non_finite_row: Cell<Option<usize>>,
    context: A::C,
}

impl<'f, A: Algebra> Equations<'f, A> {
    pub(super) fn new(
        field: &'f dyn Field,
        (t0, y0): (f64, &'f [f64]),
        further: &'f Places,
    ) -> Self {
        let (n_rhs, n_jac) = (Cell::new(0), Cell::new(0));
        Self {
            field,
            t0,
            y0,
            further,
            is_outgrown: Cell::new(false),
            n_rhs,
            n_jac,
            non_finite: Cell::new(None),
            non_finite_row: Cell::new(None),
            context: A::C::default(),
        }
    }
}

impl<A: Algebra> Op for Equations<'_, A> {
    type T = f64;
    type V = A::V;
    type M = A::M;
    type C = A::C;

    fn context(&self) -> &Self::C {
        &self.context
    }

    fn nstates(&self) -> usize {
        self.field.dim()
    }

    fn nout(&self) -> usize {
        self.field.dim()
    }

    fn nparams(&self) -> usize {
        0
    }
}

impl<'a, A: Algebra> OdeEquationsRef<'a> for Equations<'_, A> {
    type Mass = UnitCallable<A::M>;
    type Rhs = &'a Self;
    type Root = UnitCallable<A::M>;
    type Init = &'a Self;
    type Out = UnitCallable<A::M>;
    type Reset = UnitCallable<A::M>;
}

impl<A: Algebra> OdeEquations for Equations<'_, A> {
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

impl<A: Algebra> ConstantOp for &Equations<'_, A> {
    fn call_inplace(&self, _t: f64, y: &mut A::V) {
        A::components_mut(y).copy_from_slice(self.y0);
    }
}

impl<A: Algebra> NonLinearOp for &Equations<'_, A> {
    fn call_inplace(&self, x: &A::V, t: f64, y: &mut A::V) {
        self.n_rhs.set(self.n_rhs.get() + 1);
        self.non_finite.set(self.field.rhs(t, A::components(x), A::components_mut(y)));
    }
}

impl<A: Algebra> NonLinearOpJacobian for &Equations<'_, A> {
    fn jac_mul_inplace(&self, x: &A::V, t: f64, v: &A::V, y: &mut A::V) {
        let (v, y) = (A::components(v), A::components_mut(y));
        y.fill(0.0);
        self.field.jacobian(t, A::components(x), &mut |i, j, entry| y[i] += entry * v[j]);
    }

    fn jacobian_inplace(&self, x: &A::V, t: f64, jac: &mut A::M) {
        self.n_jac.set(self.n_jac.get() + 1);
        A::clear(jac);
        self.field.jacobian(t, A::components(x), &mut |i, j, entry| {
            if !entry.is_finite() {
                self.non_finite_row.set(Some(i));
            }
            if !A::set(jac, i, j, entry) && entry != 0.0 {
                self.further.borrow_mut().push((i, j));
                self.is_outgrown.set(true);
            }
        });
    }

    /// The entries of the Jacobian at the start, and those that others had.
    fn jacobian_sparsity(&self) -> Option<<A::M as Matrix>::Sparsity> {
        let n = self.field.dim();
        A::pattern(n, || {
            let mut entries: Vec<_> = (0..n).map(|i| (i, i)).collect();
            self.field.jacobian(self.t0, self.y0, &mut |i, j, _| entries.push((i, j)));
            entries.extend(self.further.borrow().iter());
            entries
        })
    }
}

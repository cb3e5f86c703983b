//! What the methods of `diffsol` know of a system. They are compiled once with this crate, and not for each system.

use std::cell::RefCell;

use crate::system::{System, Vector};

/// A [`System`] in one mode, on slices: `ẏ = f_mode(t, y)`.
pub(super) trait Field {
    /// Number of states.
    fn dim(&self) -> usize;

    /// Writes the slope at `(t, y)` to `dydt`.
    fn rhs(&self, t: f64, y: &[f64], dydt: &mut [f64]);

    /// Calls `entry` as [`System::jacobian`] does.
    fn jacobian(&self, t: f64, y: &[f64], entry: &mut dyn FnMut(usize, usize, f64));
}

/// A system in one mode, with memory for a state and a slope.
pub(super) struct OfSystem<'p, P: System> {
    problem: &'p P,
    mode: P::Mode,
    y: RefCell<P::State<f64>>,
    dydt: RefCell<P::State<f64>>,
}

impl<'p, P: System> OfSystem<'p, P> {
    pub(super) fn new(problem: &'p P, mode: P::Mode) -> Self {
        let zeros = || RefCell::new(Vector::from_fn(problem.dim(), |_| 0.0));
        Self { problem, mode, y: zeros(), dydt: zeros() }
    }
}

impl<P: System> Field for OfSystem<'_, P> {
    fn dim(&self) -> usize {
        self.problem.dim()
    }

    fn rhs(&self, t: f64, y: &[f64], dydt: &mut [f64]) {
        let (mut own_y, mut own_dydt) = (self.y.borrow_mut(), self.dydt.borrow_mut());
        own_y.as_mut().copy_from_slice(y);
        self.problem.rhs(self.mode.clone(), t, &own_y, &mut own_dydt);
        dydt.copy_from_slice((*own_dydt).as_ref());
    }

    fn jacobian(&self, t: f64, y: &[f64], entry: &mut dyn FnMut(usize, usize, f64)) {
        let mut own_y = self.y.borrow_mut();
        own_y.as_mut().copy_from_slice(y);
        self.problem.jacobian(self.mode.clone(), t, &own_y, entry);
    }
}

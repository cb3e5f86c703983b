//! What the methods of `diffsol` know of a system. They are compiled once with this crate, and not for each system.

use std::cell::RefCell;

use crate::system::{System, Vector};

/// A [`System`] in one mode, on slices: `ẏ = f_mode(t, y)`.
pub(super) trait Field {
    /// Number of states.
    fn dim(&self) -> usize;

    /// Writes the slope at `(t, y)` to `dydt`, and returns the state whose slope is not finite, if there is one.
    fn rhs(&self, t: f64, y: &[f64], dydt: &mut [f64]) -> Option<usize>;

    /// Calls `entry` as [`System::jacobian`] does.
    fn jacobian(&self, t: f64, y: &[f64], entry: &mut dyn FnMut(usize, usize, f64));
}

/// A system in one mode, with the slope that was evaluated last.
pub(super) struct OfSystem<'p, P: System> {
    problem: &'p P,
    mode: P::Mode,
    dydt: RefCell<P::State<f64>>,
}

impl<'p, P: System> OfSystem<'p, P> {
    pub(super) fn new(problem: &'p P, mode: P::Mode) -> Self {
        Self { problem, mode, dydt: RefCell::new(Vector::from_fn(problem.dim(), |_| 0.0)) }
    }

    /// The slope that was evaluated last.
    pub(super) fn last_slope(&self) -> P::State<f64> {
        self.dydt.borrow().clone()
    }

    fn state(&self, y: &[f64]) -> P::State<f64> {
        let n = self.problem.dim();
        let y = &y[..n];
        P::State::from_fn(n, |i| y[i])
    }
}

impl<P: System> Field for OfSystem<'_, P> {
    fn dim(&self) -> usize {
        self.problem.dim()
    }

    fn rhs(&self, t: f64, y: &[f64], dydt: &mut [f64]) -> Option<usize> {
        // A copy of its own stays in registers where it is short.
        let mut slope = self.dydt.borrow_mut().take();
        self.problem.rhs(self.mode.clone(), t, &self.state(y), &mut slope);
        let own = slope.as_ref();
        dydt[..own.len()].copy_from_slice(own);
        let non_finite = own.iter().position(|d| !d.is_finite());
        self.dydt.replace(slope);
        non_finite
    }

    fn jacobian(&self, t: f64, y: &[f64], entry: &mut dyn FnMut(usize, usize, f64)) {
        self.problem.jacobian(self.mode.clone(), t, &self.state(y), entry);
    }
}

//! Derivatives of guards along a direction.

use num_dual::Dual64;

use crate::system::{System, Vector};

/// Writes the values of the guards at `(t, y)`, and their rates along `dydt`, to `g`.
#[inline(never)]
pub(super) fn along_flow<P: System>(
    problem: &P,
    mode: P::Mode,
    t: f64,
    y: &P::State<f64>,
    dydt: &P::State<f64>,
    g: &mut P::Guards<Dual64>,
) {
    along(problem, mode, (Dual64::new(t, 1.0), y), dydt, g);
}

/// Writes the values of the guards at `(t, y)`, and their derivatives where `y` changes by `direction`, to `g`.
#[inline(always)]
pub(super) fn along<P: System>(
    problem: &P,
    mode: P::Mode,
    (t, y): (Dual64, &P::State<f64>),
    direction: &P::State<f64>,
    g: &mut P::Guards<Dual64>,
) {
    let (y, direction) = (y.as_ref(), direction.as_ref());
    let along = P::State::<Dual64>::from_fn(y.len(), |i| Dual64::new(y[i], direction[i]));
    problem.guards(mode, t, &along, g);
}

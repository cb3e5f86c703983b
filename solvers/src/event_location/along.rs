//! Derivatives of guards along a direction.

use num_dual::Dual64;

use crate::system::System;

/// Writes the values of the guards at `(t, y)`, and their rates along `dydt`, to `g`. `seeded` is workspace.
#[inline(never)]
pub(super) fn along_flow<P: System>(
    problem: &P,
    mode: P::Mode,
    (t, y): (f64, &P::State<f64>),
    dydt: &P::State<f64>,
    seeded: &mut P::State<Dual64>,
    g: &mut P::Guards<Dual64>,
) {
    along(problem, mode, (Dual64::new(t, 1.0), y), dydt, seeded, g);
}

/// Writes the values of the guards at `(t, y)`, and their derivatives where `y` changes by `direction`, to `g`.
#[inline(always)]
pub(super) fn along<P: System>(
    problem: &P,
    mode: P::Mode,
    (t, y): (Dual64, &P::State<f64>),
    direction: &P::State<f64>,
    seeded: &mut P::State<Dual64>,
    g: &mut P::Guards<Dual64>,
) {
    let each = seeded.as_mut().iter_mut().zip(y.as_ref()).zip(direction.as_ref());
    each.for_each(|((seeded, y), direction)| *seeded = Dual64::new(*y, *direction));
    problem.guards(mode, t, seeded, g);
}

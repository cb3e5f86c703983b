//! Perturbed start states, from which the predictability horizon is measured; and how a motion sets out.

use deltazero_solvers::Vector;

use crate::problem::{Problem, scales};

/// A time [s], the state there, and its rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment<Y> {
    /// Time [s].
    pub t: f64,
    /// State.
    pub y: Y,
    /// Its rates.
    pub slope: Y,
}

/// The start of a problem in its first `mode`, and √ε of its unit of time later, along the rates: what a force that begins at zero
/// moves has no rate at the start, and a guard that is zero there may rise or fall without one.
pub fn setting_out<P: Problem>(problem: &P, mode: &P::Mode) -> [Moment<P::State<f64>>; 2] {
    let at = |t: f64, y: P::State<f64>| {
        let mut slope = y.clone();
        problem.rhs(mode.clone(), t, &y, &mut slope);
        Moment { t, y, slope }
    };
    let now = at(0.0, problem.start());
    let t = f64::EPSILON.sqrt() * problem.unit_of_time();
    let (y, slope) = (now.y.as_ref(), now.slope.as_ref());
    let later = P::State::from_fn(y.len(), |i| y[i] + t * slope[i]);
    [now, at(t, later)]
}

/// A move of this part of [`f64::EPSILON`], in natural sizes, is as large as what a run rounds by.
const FELT: f64 = 0.25;
/// Roundings of the natural sizes by which a start is moved where its last bit is not felt: what a run of some steps rounds by.
const FAR: f64 = 64.0;

/// The start with each of its numbers but zeros moved by `nudge`: by its last bit, to see what that does. Where that is nothing
/// beside the natural sizes, as of a start at zero, it is moved [far].
pub(crate) fn nudged<P: Problem>(problem: &P, nudge: fn(f64) -> f64) -> P::State<f64> {
    let (start, scales) = (problem.start(), scales(problem));
    let mut moved = start.clone();
    for y in moved.as_mut().iter_mut().filter(|y| **y != 0.0) {
        *y = nudge(*y);
    }
    let pairs = start.as_ref().iter().zip(moved.as_ref()).zip(&scales);
    let largest = pairs.map(|((a, b), scale)| ((b - a) / scale).abs()).fold(0.0, f64::max);
    if largest >= FELT * f64::EPSILON { moved } else { far(problem, nudge(1.0) > 1.0) }
}

/// The start with each number that begins to change moved up, or down, by [some](FAR) roundings of its natural size, if the mode
/// stays and no guard falls by it.
pub(crate) fn far<P: Problem>(problem: &P, up: bool) -> P::State<f64> {
    let (start, scales) = (problem.start(), scales(problem));
    let mode = problem.initial_mode(0.0, &start);
    let guards = |y: &P::State<f64>| {
        let mut g = P::Guards::from_fn(problem.n_guards(), |_| 0.0);
        problem.guards(mode.clone(), 0.0, y, &mut g);
        g
    };
    let (before, [now, then]) = (guards(&start), setting_out(problem, &mode));
    let begins = |i: &usize| now.slope.as_ref()[*i] != 0.0 || then.slope.as_ref()[*i] != 0.0;
    let by = if up { FAR * f64::EPSILON } else { -FAR * f64::EPSILON };
    let mut moved = start.clone();
    for i in (0..scales.len()).filter(begins) {
        let own = moved.as_ref()[i];
        moved.as_mut()[i] = own + by * scales[i];
        let after = guards(&moved);
        let mut pairs = before.as_ref().iter().zip(after.as_ref());
        let holds = pairs.all(|(before, after)| *after > 0.0 || after >= before);
        if !(holds && problem.initial_mode(0.0, &moved) == mode) {
            moved.as_mut()[i] = own;
        }
    }
    moved
}

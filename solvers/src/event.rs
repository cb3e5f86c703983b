//! Guards over a step: which falls below zero, which falls first, and when.
//!
//! A guard `g` is *violated* where `g < −bound`, its rounding bound. Events are located as roots
//! of `g + bound/2`: the landing then lies past the surface, and within rounding of it.
//!
//! # What is found within one step
//!
//! A guard that is violated at the end of a step is always found. One that is violated inside and
//! recovers before the end is looked for: values and rates at both ends give the cubic through
//! them, and where its minimum comes near zero, the minimum on the dense output is searched. That
//! finds a guard that falls and rises once in a step that resolves it; it is a search and not a
//! guarantee, and a guard that does so twice within one step may show one event only.

use num_dual::Dual64;

use crate::error::Error;
use crate::root::{Bracket, find_root, minimum};
use crate::step::Step;
use crate::system::{System, Vector};

/// A minimum of the cubic is searched for on the dense output where it lies below this fraction
/// of its depth: the cubic's error there, for a sine of three quarters of a period in one step.
const NEAR: f64 = 0.25;

/// A guard that falls within a step.
#[derive(Clone, Copy, Debug)]
pub struct Fall {
    /// Which guard.
    pub guard: usize,
    /// When it falls, on the step's dense output.
    pub t: f64,
    /// When it is violated after that: the end of the step, or a time inside from which it
    /// recovers before the end.
    pub violated_at: f64,
}

/// The guards of one system, looked at along a run.
pub struct GuardWatch<P: System> {
    /// Values and rates at the start of a step.
    start: P::Guards<Dual64>,
    /// Values and rates at its end.
    end: P::Guards<Dual64>,
    values: P::Guards<f64>,
    bounds: P::Guards<f64>,
    y: P::State<f64>,
    /// Guards whose dip inside the present step was the interpolant's alone.
    disproved: Vec<bool>,
}

impl<P: System> GuardWatch<P> {
    /// Memory for the guards of `problem`.
    pub fn new(problem: &P) -> Self {
        let n = problem.n_guards();
        let duals = || Vector::from_fn(n, |_| Dual64::from_re(0.0));
        Self {
            start: duals(),
            end: duals(),
            values: Vector::from_fn(n, |_| 0.0),
            bounds: Vector::from_fn(n, |_| 0.0),
            y: Vector::from_fn(problem.dim(), |_| 0.0),
            disproved: vec![false; n],
        }
    }

    /// Evaluates all guards of `mode` at `(t, y)`; the first violated one.
    ///
    /// # Errors
    /// [`Error::NonFiniteGuard`] for a guard or bound that is infinite or not a number.
    pub fn violated(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
    ) -> Result<Option<usize>, Error> {
        problem.guards(mode, t, y, &mut self.values);
        problem.guard_bounds(mode, t, y, &mut self.bounds);
        let mut first = None;
        for (i, (g, bound)) in self.values.as_ref().iter().zip(self.bounds.as_ref()).enumerate() {
            let margin = g + bound;
            if !margin.is_finite() {
                let mode = format!("{mode:?}");
                return Err(Error::NonFiniteGuard { t, mode, guard: i });
            }
            if margin < 0.0 && first.is_none() {
                first = Some(i);
            }
        }
        Ok(first)
    }

    /// Whether guard `i`, as last evaluated, is violated.
    pub fn is_violated(&self, i: usize) -> bool {
        self.values.as_ref()[i] < -self.bounds.as_ref()[i]
    }

    /// Whether guard `i`, as last evaluated, is at or past its surface.
    pub fn is_past(&self, i: usize) -> bool {
        self.values.as_ref()[i] <= 0.0
    }

    /// How far guard `i`, as last evaluated, is above the value that events are located at.
    pub fn clearance(&self, i: usize) -> f64 {
        self.values.as_ref()[i] + 0.5 * self.bounds.as_ref()[i]
    }

    /// Begins to watch a phase at `(t, y)` with the slope `dydt` there.
    pub fn begin(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
        dydt: &P::State<f64>,
    ) {
        along_flow(problem, mode, t, y, dydt, &mut self.start);
        self.disproved.fill(false);
    }

    /// Evaluates the rates `dg_i/dt` of all guards along the flow.
    pub fn rates(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
        dydt: &P::State<f64>,
    ) {
        along_flow(problem, mode, t, y, dydt, &mut self.end);
    }

    /// The rate of guard `i`, as last evaluated.
    pub fn rate(&self, i: usize) -> f64 {
        self.end.as_ref()[i].eps
    }

    /// Whether a look at both ends of a completed step is enough to see that no guard falls on it;
    /// the next step then begins where it ends.
    pub fn is_clear(&mut self, problem: &P, mode: P::Mode, step: &dyn Step<P::State<f64>>) -> bool {
        self.rates(problem, mode, step.t1(), step.y1(), step.slope1());
        let h = step.t1() - step.t0();
        let is_clear = (0..self.end.as_ref().len()).all(|i| self.is_far(i, h));
        if is_clear {
            self.keep();
        }
        is_clear
    }

    /// The guard that falls first on the step that [`is_clear`](Self::is_clear) found not to be, its
    /// time to within `precision` steps or the spacing of `f64`; none where all hold, and the next
    /// step then begins where this one ends. A dip is taken for one if it is deeper than `noise`, as
    /// a fraction of its height.
    ///
    /// # Errors
    /// [`Error::NonFiniteGuard`].
    pub fn first_to_fall(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        precision: f64,
        noise: f64,
    ) -> Result<Option<Fall>, Error> {
        let (t0, t1) = (step.t0(), step.t1());
        self.violated(problem, mode, t1, step.y1())?;
        let mut first: Option<Fall> = None;
        for guard in 0..self.end.as_ref().len() {
            let violated_at = match self.dip(problem, mode, step, noise, guard) {
                Some(t) => t,
                None if self.end.as_ref()[guard].re < -self.bounds.as_ref()[guard] => t1,
                None => continue,
            };
            let clearance = |t| self.clearance_on(problem, mode, step, guard, t);
            let bracket = Bracket { above: t0, below: violated_at };
            let t = find_root(clearance, bracket, precision * (t1 - t0).abs());
            if first.is_none_or(|other| (t - t0).abs() < (other.t - t0).abs()) {
                first = Some(Fall { guard, t, violated_at });
            }
        }
        if first.is_none() {
            self.keep();
        }
        Ok(first)
    }

    /// Whether guard `i` is above zero at both ends of a step of size `h`, and so far above that its
    /// cubic is too: the cubic is off the chord by at most 4/27 of the slopes' differences from it.
    fn is_far(&self, i: usize, h: f64) -> bool {
        let (g0, g1) = (self.start.as_ref()[i], self.end.as_ref()[i]);
        let rise = g1.re - g0.re;
        let bend = (g0.eps * h - rise).abs() + (g1.eps * h - rise).abs();
        let least = g0.re.min(g1.re);
        // With the part of its depth that makes a minimum worth a search.
        least > (1.0 + NEAR) * 4.0 / 27.0 * bend + NEAR * rise.abs()
    }

    /// Takes note that guard `i` does not dip inside the present step, whatever its dense output says.
    pub fn disprove_dip(&mut self, i: usize) {
        self.disproved[i] = true;
    }

    /// Keeps the step last looked at: the next one begins where it ends.
    pub fn keep(&mut self) {
        std::mem::swap(&mut self.start, &mut self.end);
        self.disproved.fill(false);
    }

    /// A time inside the step at which guard `i` is violated, where one is found.
    fn dip(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        noise: f64,
        i: usize,
    ) -> Option<f64> {
        if self.disproved[i] {
            return None;
        }
        let (g0, g1) = (self.start.as_ref()[i], self.end.as_ref()[i]);
        let (t0, h) = (step.t0(), step.t1() - step.t0());
        let (theta, least) = cubic_minimum([g0.re, g1.re], [g0.eps * h, g1.eps * h])?;
        let depth = g0.re.max(g1.re) - least;
        let bound = self.bounds.as_ref()[i];
        if least > NEAR * depth {
            return None;
        }
        let margin = 0.5 * bound + noise * depth;
        let above = |theta: f64| self.clearance_on(problem, mode, step, i, t0 + theta * h) + margin;
        let (theta, least) = minimum(above, [0.0, theta, 1.0]);
        (least < 0.0).then_some(t0 + theta * h)
    }

    /// [`clearance`](Self::clearance) of guard `i` at `t` on the step's dense output.
    fn clearance_on(
        &mut self,
        problem: &P,
        mode: P::Mode,
        step: &dyn Step<P::State<f64>>,
        i: usize,
        t: f64,
    ) -> f64 {
        step.interpolate(t, &mut self.y);
        problem.guards(mode, t, &self.y, &mut self.values);
        self.clearance(i)
    }
}

/// Values and rates of the guards at `(t, y)` along `dydt`.
fn along_flow<P: System>(
    problem: &P,
    mode: P::Mode,
    t: f64,
    y: &P::State<f64>,
    dydt: &P::State<f64>,
    g: &mut P::Guards<Dual64>,
) {
    let (y, dydt) = (y.as_ref(), dydt.as_ref());
    let along = P::State::<Dual64>::from_fn(y.len(), |i| Dual64::new(y[i], dydt[i]));
    problem.guards(mode, Dual64::new(t, 1.0), &along, g);
}

/// Where in (0, 1) the cubic with these values and slopes at 0 and 1 is least, and its value
/// there; none where it has no minimum inside.
fn cubic_minimum([g0, g1]: [f64; 2], [s0, s1]: [f64; 2]) -> Option<(f64, f64)> {
    // g(θ) = g0 + s0 θ + c2 θ² + c3 θ³
    let rise = g1 - g0;
    let (c2, c3) = (3.0 * rise - 2.0 * s0 - s1, s0 + s1 - 2.0 * rise);
    let discriminant = c2 * c2 - 3.0 * c3 * s0;
    if discriminant <= 0.0 {
        return None;
    }
    // The root of g' = 0 with g'' = 2 (c2 + 3 c3 θ) = 2 √discriminant above zero.
    let root = discriminant.sqrt();
    let theta = if c2 > 0.0 { -s0 / (c2 + root) } else { (root - c2) / (3.0 * c3) };
    let inside = theta > 0.0 && theta < 1.0;
    inside.then_some((theta, g0 + theta * (s0 + theta * (c2 + theta * c3))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_minimum_of_a_cubic_is_found_where_it_is_inside() {
        // (θ − ¼)² and (θ − ¼)²(θ + 2), then a cubic that only rises, and one with a maximum only.
        let cases = [
            ([1.0 / 16.0, 9.0 / 16.0], [-0.5, 1.5], Some((0.25, 0.0))),
            ([2.0 / 16.0, 27.0 / 16.0], [-15.0 / 16.0, 81.0 / 16.0], Some((0.25, 0.0))),
            ([0.0, 1.0], [1.0, 1.0], None),
            ([0.0, 0.0], [1.0, -1.0], None),
        ];
        for (values, slopes, expected) in cases {
            match (cubic_minimum(values, slopes), expected) {
                (None, None) => {}
                (Some((theta, least)), Some((at, value))) => {
                    assert!((theta - at).abs() < 1e-14 && (least - value).abs() < 1e-14);
                }
                other => panic!("{other:?}"),
            }
        }
    }
}

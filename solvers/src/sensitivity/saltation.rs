//! Derivatives across an event, and the events that have none.

use super::tangent::Tangent;
use super::{Lost, Sensitive, Traced, along, moved};
use crate::real::Real;
use crate::system::{Next, System, Vector};

/// Largest relative change of the rate of a guard by errors of the guard within the tolerance, with which a crossing
/// is told from a touch.
const TOUCH: f64 = 0.1;

/// A state that a change within the tolerance moves so many times as far as its derivative and the tolerance say is on another
/// branch of the transition.
const BRANCH: f64 = 10.0;

/// How the time of an event changes with the state.
#[derive(Clone, Copy)]
enum Timing {
    /// With the time at which the guard crosses its surface.
    Crossing,
    /// With the time of the event before, whose transition left the guard below zero; not at all at the start.
    Jump,
}

/// An event, before its transition.
struct Instant<'p, P: System, S: Real> {
    problem: &'p P,
    mode: &'p P::Mode,
    guard: usize,
    t: S,
    y: P::State<S>,
    /// Slope f⁻ of the state.
    slope: P::State<S>,
    /// Rate ġ of the guard.
    rate: S,
}

impl<'p, P: System, S: Real> Instant<'p, P, S> {
    fn new(problem: &'p P, mode: &'p P::Mode, guard: usize, t: S, y: P::State<S>) -> Self {
        let slope = slope(problem, mode, t, &y);
        let mut event = Self { problem, mode, guard, t, y, slope, rate: S::cst(0.0) };
        event.rate = event.guard_along(S::cst(1.0), event.slope.as_ref());
        event
    }

    /// The derivative of the guard along `(dt, dy)`.
    fn guard_along(&self, dt: S, dy: &[S]) -> S {
        self.guards_along(dt, dy).as_ref()[self.guard].eps
    }

    /// All guards, with their derivatives along `(dt, dy)`.
    fn guards_along(&self, dt: S, dy: &[S]) -> P::Guards<Tangent<S>> {
        let y = along::<P, S>(self.y.as_ref(), dy);
        guards(self.problem, self.mode, Tangent::new(self.t, dt), &y)
    }

    /// The changes of the time and of the state of the event, `δt` and `δy⁻ + f⁻ δt`, by those before it.
    fn moved(&self, timing: Timing, before: &[S]) -> (S, P::State<S>) {
        let n = self.y.as_ref().len();
        let dt = match timing {
            Timing::Crossing => -self.guard_along(S::cst(0.0), &before[..n]) / self.rate,
            Timing::Jump => before[n],
        };
        (dt, Vector::from_fn(n, |i| before[i] + self.slope.as_ref()[i] * dt))
    }

    /// The state after the transition, with its derivative along `(dt, dy)`.
    fn after(&self, dt: S, dy: &P::State<S>) -> P::State<Tangent<S>> {
        let mut y = along::<P, S>(self.y.as_ref(), dy.as_ref());
        let t = Tangent::new(self.t, dt);
        self.problem.transition(self.mode.clone(), self.guard, t, &mut y);
        y
    }
}

impl<P: System> Instant<'_, P, f64> {
    /// The second derivative g̈ of the guard along the solution.
    fn bend(&self) -> f64 {
        let y = along::<P, f64>(self.y.as_ref(), self.slope.as_ref());
        let slope = slope(self.problem, self.mode, Tangent::new(self.t, 1.0), &y);
        let y = along::<P, Tangent<f64>>(y.as_ref(), slope.as_ref());
        let t = Tangent::new(Tangent::new(self.t, 1.0), Tangent::constant(1.0));
        guards(self.problem, self.mode, t, &y).as_ref()[self.guard].eps.eps
    }

    /// Whether errors of the guard up to `error` leave its rate what it is.
    fn crosses(&self, error: f64) -> bool {
        self.bend().abs() * error < TOUCH * self.rate * self.rate
    }

    fn values(&self) -> P::Guards<f64> {
        guards(self.problem, self.mode, self.t, &self.y)
    }

    fn rounding_bounds(&self) -> P::Guards<f64> {
        let mut bounds = Vector::from_fn(self.problem.n_guards(), |_| 0.0);
        self.problem.guard_bounds(self.mode.clone(), self.t, &self.y, &mut bounds);
        bounds
    }

    /// What follows an event at another time and state, and the state then.
    fn next(&self, t: f64, mut y: P::State<f64>) -> (Next<P::Mode>, P::State<f64>) {
        (self.problem.transition(self.mode.clone(), self.guard, t, &mut y), y)
    }
}

fn slope<P: System, S: Real>(problem: &P, mode: &P::Mode, t: S, y: &P::State<S>) -> P::State<S> {
    let mut slope = y.clone();
    problem.rhs(mode.clone(), t, y, &mut slope);
    slope
}

fn guards<P: System, S: Real>(problem: &P, mode: &P::Mode, t: S, y: &P::State<S>) -> P::Guards<S> {
    let mut g = Vector::from_fn(problem.n_guards(), |_| S::cst(0.0));
    problem.guards(mode.clone(), t, y, &mut g);
    g
}

impl<P: System> Sensitive<'_, P> {
    /// The transition of the model and of the derivatives.
    pub(super) fn saltate<S: Real>(
        &self,
        traced: Traced<P::Mode>,
        guard: usize,
        t: S,
        y: &mut [S],
    ) -> Next<Traced<P::Mode>> {
        let (problem, mode, since) = (self.problem, &traced.mode, t.value());
        let before = self.model_state(y);
        let mut after = before.clone();
        let next = problem.transition(mode.clone(), guard, t, &mut after);
        match self.timing(&traced, guard, since, &values(y), &next) {
            Err(lost) => {
                self.lose(&after, y);
                let mode = if let Next::Mode(next) = next { next } else { traced.mode };
                Next::Mode(Traced { mode, since, lost: Some(lost) })
            }
            Ok(timing) => {
                let event = Instant::new(problem, mode, guard, t, before);
                self.carry(&event, timing, &next, &after, y);
                match next {
                    Next::Mode(mode) => Next::Mode(Traced { mode, since, lost: None }),
                    Next::Stop => Next::Stop,
                }
            }
        }
    }

    /// Carries the derivatives across an event, to the state `after` its transition.
    fn carry<S: Real>(
        &self,
        event: &Instant<'_, P, S>,
        timing: Timing,
        next: &Next<P::Mode>,
        after: &P::State<S>,
        y: &mut [S],
    ) {
        let (state, changes) = y.split_at_mut(self.problem.dim());
        let slope_after = match next {
            Next::Mode(mode) => slope(self.problem, mode, event.t, after),
            Next::Stop => Vector::from_fn(state.len(), |_| S::cst(0.0)),
        };
        for change in changes.chunks_exact_mut(state.len() + 1) {
            let (dt, dy) = event.moved(timing, change);
            let moved = event.after(dt, &dy);
            for (i, (moved, slope)) in moved.as_ref().iter().zip(slope_after.as_ref()).enumerate() {
                change[i] = moved.eps - *slope * dt;
            }
            change[state.len()] = dt;
        }
        state.copy_from_slice(after.as_ref());
    }

    /// How the time of an event at `(t, y)` changes with the state, or why it has no derivative.
    fn timing(
        &self,
        traced: &Traced<P::Mode>,
        guard: usize,
        t: f64,
        y: &[f64],
        next: &Next<P::Mode>,
    ) -> Result<Timing, Lost> {
        let event = Instant::new(self.problem, &traced.mode, guard, t, self.model_state(y));
        let errors = self.errors_of_guards(&event);
        let error = errors.as_ref()[guard];
        let timing = if t == traced.since {
            if event.values().as_ref()[guard] >= -error {
                return Err(Lost::Together { guard });
            }
            Timing::Jump
        } else {
            let rate = event.rate;
            if !event.crosses(error) {
                return Err(Lost::Touch { guard, rate });
            }
            if (t - traced.since).abs() * rate.abs() <= error {
                return Err(Lost::Together { guard });
            }
            if let Some(guard) = self.falls_beside(&event, &errors) {
                return Err(Lost::Together { guard });
            }
            Timing::Crossing
        };
        let n = event.y.as_ref().len();
        let is_same = |change: &[f64]| {
            let (dt, dy) = event.moved(timing, change);
            let scale = self.scale_at(&event, change, (dt, &dy));
            let after = event.after(dt, &dy);
            let is_near = |y: &[f64]| {
                (0..n).zip(after.as_ref()).all(|(i, after)| {
                    let moved = scale * after.eps.abs() + self.tolerance.allowed(i, y);
                    (y[i] - after.re).abs() <= BRANCH * moved
                })
            };
            [-scale, scale].into_iter().all(|scale| {
                let (same, y) = event.next(t + scale * dt, moved(&event.y, &dy, scale));
                same == *next && is_near(y.as_ref())
            })
        };
        if y[n..].chunks_exact(n + 1).all(is_same) { Ok(timing) } else { Err(Lost::Mode { guard }) }
    }

    /// The largest multiple of a `change` of the state before an event that is within the tolerance there, and at the event,
    /// whose time and state it changes by `(dt, dy)`. Where it changes the time alone, the multiple that does so by rounding.
    fn scale_at(
        &self,
        event: &Instant<'_, P, f64>,
        change: &[f64],
        (dt, dy): (f64, &P::State<f64>),
    ) -> f64 {
        let y = event.y.as_ref();
        let scale = self.scale(y, &change[..y.len()]).min(self.scale(y, dy.as_ref()));
        let of_time = if dt == 0.0 { 0.0 } else { f64::EPSILON * (event.t / dt).abs() };
        if scale.is_finite() { scale } else { of_time }
    }

    /// Another guard that falls within its error of the surface, and would be the event of a solution beside this one.
    fn falls_beside(&self, event: &Instant<'_, P, f64>, errors: &P::Guards<f64>) -> Option<usize> {
        let (g, errors) = (event.values(), errors.as_ref());
        let is_near = |&j: &usize| j != event.guard && g.as_ref()[j].abs() <= errors[j];
        (0..errors.len()).filter(is_near).find(|&j| {
            let other = Instant::new(self.problem, event.mode, j, event.t, event.y.clone());
            other.rate * event.rate > 0.0 && other.crosses(errors[j])
        })
    }

    /// The errors of the guards that the tolerance of the states allows, and their rounding:
    /// `bound + Σ_i |∂g/∂y_i| (atol_i + rtol |y_i|)`.
    fn errors_of_guards(&self, event: &Instant<'_, P, f64>) -> P::Guards<f64> {
        let (n, span) = (event.y.as_ref().len(), self.problem.guard_span());
        let mut errors = event.rounding_bounds();
        for j in 0..span.min(n) {
            let error =
                |i| if i % span == j { self.tolerance.allowed(i, event.y.as_ref()) } else { 0.0 };
            let g = event.guards_along(0.0, &(0..n).map(error).collect::<Vec<_>>());
            errors.as_mut().iter_mut().zip(g.as_ref()).for_each(|(sum, g)| *sum += g.eps.abs());
        }
        errors
    }
}

fn values<S: Real>(y: &[S]) -> Vec<f64> {
    y.iter().map(|y| y.value()).collect()
}

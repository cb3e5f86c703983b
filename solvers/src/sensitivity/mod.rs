//! Sensitivities through events: derivatives of states and of event times by start values and parameters.
//!
//! A change `ε δy` of the start, with a direction `δy(t₀)`, changes the solution by `ε δy(t)`, and the time of an event
//! by `ε δt`, to first order in ε. Between events, and across one at `t` from mode − to mode +:
//!
//! ```text
//! δẏ = ∂f/∂y δy
//!
//! δt  = −(∂g/∂y δy⁻) / ġ,               ġ = ∂g/∂t + ∂g/∂y f⁻      g is the guard that falls
//! δy⁺ = ∂R/∂y (δy⁻ + f⁻ δt) + ∂R/∂t δt − f⁺ δt                    y⁺ = R(t, y⁻) by the transition
//! ```
//!
//! The changed solution meets the surface at another time, `t + ε δt`, in the state `y⁻ + ε (δy⁻ + f⁻ δt)`. The
//! transition moves that state, and `−f⁺ δt` leads from there back to the time t. Without a change of state or slope
//! δy⁺ = δy⁻. In the notation of a matrix this is the saltation matrix.
//!
//! I. A. Hiskens, M. A. Pai, "Trajectory sensitivity analysis of hybrid systems", IEEE Trans. Circuits Syst. I 47(2),
//! 204–220 (2000). N. J. Kong, J. J. Payne, J. Zhu, A. M. Johnson, "Saltation matrices: the essential tool for
//! linearizing hybrid dynamical systems", arXiv:2306.06862 (2023).
//!
//! A [`Sensitive`] system is a [`System`] whose state contains these derivatives beside the states of a model. So every
//! method computes them, under its error control, with the events of the model. All derivatives of the model are by
//! dual numbers, exact to rounding.
//!
//! # Parameters
//!
//! A parameter is a state that does not change: its rate is zero, transitions leave it alone, and its direction is a
//! start value of one. A start value that depends on the parameter has that derivative in the same direction. Below,
//! the restitution of a bouncing ball is a state, and the time of bounce n is `t₀ (1 + 2e + … + 2eⁿ)`:
//!
//! ```
#![doc = include_str!("../../examples/sensitivity.rs")]
//! ```
//!
//! # Where there are none
//!
//! The derivatives exist where each event crosses its surface at a rate, and alone. They do not exist at the events
//! that [`Lost`] lists; all of them are judged by a tolerance, because a solution that is known to a tolerance cannot
//! tell a touch from a crossing within it. A run ends there in [`Error::NonFinite`], whose message has the reason, which
//! is also in [`Traced::lost`] of the mode of the [`Integration`](crate::Integration). Its states are then those after
//! the event, without derivatives.
//!
//! *Not found* are events that a changed start would add, such as those of a guard that comes near zero and does not
//! reach it.

mod saltation;
mod tangent;

use std::fmt;

use num_dual::Dual64;

use crate::error::Error;
use crate::integrate::check_length;
use crate::real::Real;
use crate::system::{Next, System, Vector};
use crate::tolerance::Tolerance;
pub(crate) use tangent::Tangent;

/// Why a solution has no derivatives from an event on.
///
/// ```
/// use deltazero_solvers::problems::{BouncingBall, TwoBalls};
/// use deltazero_solvers::sensitivity::Lost;
/// use deltazero_solvers::{Control, Error, Integration, Method, Sensitive, Tolerance};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let balls = TwoBalls { balls: [ball, ball] };
/// let tolerance = Tolerance { rtol: 1e-9, atol: vec![1e-9; 4] };
/// let system = Sensitive::new(&balls, vec![[1.0, 0.0, 0.0, 0.0]], tolerance)?;
/// let method = Method::named("dop853").ok_or("no such method")?;
/// let mut solver = method.solver(&system, Control::Adaptive(system.tolerance()))?;
/// let mut run = Integration::new(&system, 0.0, system.start(0.0, &balls.start())?);
/// let ended = run.run(1.0, &mut *solver, &mut ());
/// assert!(matches!(ended, Err(Error::NonFinite { .. })));
/// // Equal balls land together, and the higher one would land later.
/// assert_eq!(run.point.mode.lost, Some(Lost::Together { guard: 1 }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Lost {
    /// The guard touches its surface, or crosses it so slowly that errors within the tolerance change its rate by a
    /// tenth: `ġ² < 10 |g̈| error(g)`. The derivative of its time is infinite at a touch.
    #[error("guard {guard} only touches its surface, with the rate {rate:e}")]
    Touch {
        /// Index of the guard.
        guard: usize,
        /// Its rate ġ.
        rate: f64,
    },
    /// The guard fell together with another one, or right after an event or the start: their order may change within
    /// the tolerance, and with it the solution, also where the transition of one cancels the other. A guard that a
    /// transition leaves far below zero is no such case; it switches at the time of that transition.
    #[error("guard {guard} falls together with another event or the start")]
    Together {
        /// Index of the guard that fell last, or would have.
        guard: usize,
    },
    /// A change within the tolerance leads to another mode, or to a state far off. Either the transition branches there, or the
    /// mode carries numbers that depend on the state or the time; these numbers should be states.
    #[error(
        "what follows guard {guard} branches there, or the mode depends on the state continuously"
    )]
    Mode {
        /// Index of the guard.
        guard: usize,
    },
    /// Events accumulate. The model gives the [limit](System::accumulation), but not its derivatives.
    #[error("events of guard {guard} accumulate")]
    Accumulation {
        /// Index of the guard.
        guard: usize,
    },
}

/// A mode of a model with what its sensitivities need.
///
/// ```
/// use deltazero_solvers::problems::{BouncingBall, BouncingMode};
/// use deltazero_solvers::{Run, Sensitive, Tolerance};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let tolerance = Tolerance { rtol: 1e-9, atol: vec![1e-9; 2] };
/// let system = Sensitive::new(&ball, vec![[1.0, 0.0]], tolerance)?;
/// let run = Run::of(&system, system.start(0.0, &ball.start())?).method("dop853");
/// let mode = run.tolerances(system.tolerance()).to(1.0)?.end.mode;
/// assert_eq!((mode.mode, mode.lost), (BouncingMode::Flight, None));
/// assert!((mode.since - ball.bounce_time(1)).abs() < 1e-9);
/// # Ok::<(), deltazero_solvers::Error>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct Traced<M> {
    /// The mode of the model.
    pub mode: M,
    /// Time of the last event, or of the start.
    pub since: f64,
    /// Why there are no derivatives from that event on; `None` where there are.
    pub lost: Option<Lost>,
}

impl<M: fmt::Debug> fmt::Debug for Traced<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.lost {
            None => self.mode.fmt(f),
            Some(lost) => write!(f, "{:?} (without sensitivities: {lost})", self.mode),
        }
    }
}

/// A model with derivatives of its solution along some directions.
///
/// With n states and the directions 1 … k, the state has `n + k (n + 1)` entries:
///
/// ```text
/// y,   δy₁, δt₁,   …,   δy_k, δt_k
/// ```
///
/// `δy` is the derivative of the state at a fixed time, and `δt` that of the time of the last event, zero before the
/// first one. After a [terminal](Next::Stop) event `δy` is the derivative of the state where the run ends, at the time
/// that changes with it. The units of a direction are those of the states if it is a change of the start, and δy has
/// the units of the states then; they are divided by the unit of a parameter if it is the derivative by that parameter.
///
/// The guards, their rounding bounds and the events are those of the model, and its states follow the same slopes as
/// without derivatives. Steps differ, because they are chosen for the derivatives too.
///
/// ```
/// use deltazero_solvers::problems::BouncingBall;
/// use deltazero_solvers::{Run, Sensitive, Tolerance};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let tolerance = Tolerance { rtol: 1e-9, atol: vec![1e-9; 2] };
/// let by_height = Sensitive::new(&ball, vec![[1.0, 0.0]], tolerance)?;
/// let run = Run::of(&by_height, by_height.start(0.0, &ball.start())?).method("dop853");
/// let end = run.tolerances(by_height.tolerance()).to(1.0)?.end;
/// // Every bounce is at a multiple of √y₀: dt_n/dy₀ = t_n/(2 y₀).
/// assert!((by_height.event_time(0, &end.y) - 0.5 * ball.bounce_time(1)).abs() < 1e-8);
/// // On an arc at the speed v, from the bounce at t_n on: dv/dy₀ = dv_n/dy₀ + g dt_n/dy₀.
/// let by_speed = 0.5 * (ball.bounce_speed(1) + 9.8 * ball.bounce_time(1));
/// assert!((by_height.derivative(0, &end.y)[1] - by_speed).abs() < 1e-7);
/// # Ok::<(), deltazero_solvers::Error>(())
/// ```
#[derive(Debug)]
pub struct Sensitive<'a, P: System> {
    problem: &'a P,
    directions: Vec<P::State<f64>>,
    tolerance: Tolerance,
}

impl<'a, P: System> Sensitive<'a, P> {
    /// The model `problem` with derivatives along `directions`, each a change of the start. `tolerance` is the accuracy
    /// of the model's states, by which events without derivatives are [told](Lost) from others.
    ///
    /// # Errors
    /// [`Error::BadTolerance`]; [`Error::BadArgument`] where there is no direction, or one has another number of
    /// entries than there are states; [`Error::BlindSensitivities`] of a [`Blind`](crate::Blind) system.
    pub fn new(
        problem: &'a P,
        directions: Vec<P::State<f64>>,
        tolerance: Tolerance,
    ) -> Result<Self, Error> {
        if P::IS_BLIND {
            return Err(Error::BlindSensitivities);
        }
        let n = problem.dim();
        tolerance.check(n)?;
        let lengths = directions.iter().map(|direction| direction.as_ref().len());
        if let Some(length) = lengths.chain(directions.is_empty().then_some(0)).find(|&l| l != n) {
            let allowed = "there must be a direction, and each must have one entry a state";
            return Err(Error::BadArgument { name: "direction", value: length as f64, allowed });
        }
        Ok(Self { problem, directions, tolerance })
    }

    /// The start of a run at `t` from the state `y` of the model.
    ///
    /// # Errors
    /// [`Error::BadArgument`] for more or fewer states than the model has, and with the index of a direction along which the
    /// run starts in another mode.
    pub fn start(&self, t: f64, y: &P::State<f64>) -> Result<Vec<f64>, Error> {
        check_length(self.problem, y)?;
        let mode = self.problem.initial_mode(t, y);
        let mut all = y.as_ref().to_vec();
        for (index, direction) in self.directions.iter().enumerate() {
            let scale = self.scale(y.as_ref(), direction.as_ref());
            let mode_of = |scale| self.problem.initial_mode(t, &moved(y, direction, scale));
            if [-scale, scale].into_iter().any(|scale| mode_of(scale) != mode) {
                let allowed = "the modes of starts within the tolerance along it must be equal";
                return Err(Error::BadArgument { name: "direction", value: index as f64, allowed });
            }
            all.extend(direction.as_ref());
            all.push(0.0);
        }
        Ok(all)
    }

    /// The tolerance of a run: that of the model for its states, and the same again for their derivatives along each
    /// direction. So the `atol` of a state suits its derivative where the direction is a change of the usual size, as
    /// `p` itself for a parameter p: the result is then `p ∂y/∂p`, which has the size of y.
    pub fn tolerance(&self) -> Tolerance {
        let Tolerance { rtol, atol } = &self.tolerance;
        let mut all = atol.clone();
        for _ in &self.directions {
            all.extend(atol);
            // The derivative of an event time does not change between events, so its error is zero.
            all.push(1.0);
        }
        Tolerance { rtol: *rtol, atol: all }
    }

    /// The states of the model in a state `y` of this system.
    ///
    /// # Panics
    /// Where `y` is shorter.
    pub fn state<'y>(&self, y: &'y [f64]) -> &'y [f64] {
        &y[..self.problem.dim()]
    }

    /// The derivatives δy of these states along the direction with this index.
    ///
    /// # Panics
    /// Where `y` is shorter, as where there is no such direction.
    pub fn derivative<'y>(&self, direction: usize, y: &'y [f64]) -> &'y [f64] {
        let n = self.problem.dim();
        &y[n + direction * (n + 1)..][..n]
    }

    /// The derivative δt of the time of the last event along the direction with this index.
    ///
    /// # Panics
    /// Where `y` is shorter, as where there is no such direction.
    pub fn event_time(&self, direction: usize, y: &[f64]) -> f64 {
        let n = self.problem.dim();
        y[n + direction * (n + 1) + n]
    }

    /// The largest multiple of `change` that is within the tolerance at `y`; infinite where there is no change.
    fn scale(&self, y: &[f64], change: &[f64]) -> f64 {
        let changes = change.iter().enumerate().filter(|(_, change)| **change != 0.0);
        changes.fold(f64::INFINITY, |scale, (i, change)| {
            scale.min(self.tolerance.allowed(i, y) / change.abs())
        })
    }
}

/// The state `y + scale change`, which is `y` where there is no change.
fn moved<Y: Vector<f64>>(y: &Y, change: &Y, scale: f64) -> Y {
    let (y, change) = (y.as_ref(), change.as_ref());
    Vector::from_fn(y.len(), |i| if change[i] == 0.0 { y[i] } else { y[i] + scale * change[i] })
}

/// The states of a model with derivatives: `y + ε dy`.
fn along<P: System, S: Real>(y: &[S], dy: &[S]) -> P::State<Tangent<S>> {
    Vector::from_fn(y.len(), |i| Tangent::new(y[i], dy[i]))
}

impl<P: System> System for Sensitive<'_, P> {
    type Mode = Traced<P::Mode>;
    type State<S: Real> = Vec<S>;
    type Guards<S: Real> = P::Guards<S>;

    fn dim(&self) -> usize {
        let n = self.problem.dim();
        n + self.directions.len() * (n + 1)
    }

    fn n_guards(&self) -> usize {
        self.problem.n_guards()
    }

    fn initial_mode(&self, t: f64, y: &Vec<f64>) -> Self::Mode {
        let mode = self.problem.initial_mode(t, &self.model_state(y));
        Traced { mode, since: t, lost: None }
    }

    fn rhs<S: Real>(&self, mode: Self::Mode, t: S, y: &Vec<S>, dydt: &mut Vec<S>) {
        let n = self.problem.dim();
        let (y, changes) = y.split_at(n);
        let (slope, slopes) = dydt.split_at_mut(n);
        let mut rate = Vector::from_fn(n, |_| Tangent::cst(0.0));
        for (change, out) in changes.chunks_exact(n + 1).zip(slopes.chunks_exact_mut(n + 1)) {
            let y = along::<P, S>(y, &change[..n]);
            self.problem.rhs(mode.mode.clone(), Tangent::constant(t), &y, &mut rate);
            for (i, rate) in rate.as_ref().iter().enumerate() {
                (slope[i], out[i]) = (rate.re, rate.eps);
            }
            out[n] = S::cst(0.0);
        }
    }

    fn guards<S: Real>(&self, mode: Self::Mode, t: S, y: &Vec<S>, g: &mut P::Guards<S>) {
        self.problem.guards(mode.mode, t, &self.model_state(y), g);
    }

    fn guard_bounds(&self, mode: Self::Mode, t: f64, y: &Vec<f64>, bounds: &mut P::Guards<f64>) {
        self.problem.guard_bounds(mode.mode, t, &self.model_state(y), bounds);
    }

    // No guard depends on a derivative.
    fn guard_span(&self) -> usize {
        self.problem.guard_span()
    }

    fn transition<S: Real>(
        &self,
        mode: Self::Mode,
        guard: usize,
        t: S,
        y: &mut Vec<S>,
    ) -> Next<Self::Mode> {
        self.saltate(mode, guard, t, y)
    }

    fn accumulation(
        &self,
        mode: Self::Mode,
        guard: usize,
        t: f64,
        y: &mut Vec<f64>,
    ) -> Option<Self::Mode> {
        let mut state = self.model_state(y);
        let mode = self.problem.accumulation(mode.mode, guard, t, &mut state)?;
        self.lose(&state, y);
        Some(Traced { mode, since: t, lost: Some(Lost::Accumulation { guard }) })
    }

    /// By dual numbers, one evaluation for each state of the model: all derivatives have the Jacobian of the model by
    /// themselves.
    fn jacobian(
        &self,
        mode: Self::Mode,
        t: f64,
        y: &Vec<f64>,
        mut entry: impl FnMut(usize, usize, f64),
    ) {
        let n = self.problem.dim();
        let mut seeded: Vec<_> = y.iter().map(|y| Dual64::from_re(*y)).collect();
        let mut dydt = seeded.clone();
        for j in 0..n {
            seeded[j].eps = 1.0;
            self.rhs(mode.clone(), Dual64::from_re(t), &seeded, &mut dydt);
            seeded[j].eps = 0.0;
            for i in 0..n {
                entry(i, j, dydt[i].eps);
                for block in (n..y.len()).step_by(n + 1) {
                    entry(block + i, j, dydt[block + i].eps);
                    entry(block + i, block + j, dydt[i].eps);
                }
            }
        }
    }
}

impl<P: System> Sensitive<'_, P> {
    /// The state of the model.
    fn model_state<S: Real>(&self, y: &[S]) -> P::State<S> {
        Vector::from_fn(self.problem.dim(), |i| y[i])
    }

    /// Sets the state of the model, and all derivatives to not a number.
    fn lose<S: Real>(&self, state: &P::State<S>, y: &mut [S]) {
        let (own, derivatives) = y.split_at_mut(self.problem.dim());
        own.copy_from_slice(state.as_ref());
        derivatives.fill(S::cst(f64::NAN));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sparsity;

    /// A pendulum in air: `[θ, ω, p]` with `ω̇ = −p sin θ − ω³/4 + cos t`.
    struct Pendulum;

    impl System for Pendulum {
        type Mode = ();
        type State<S: Real> = [S; 3];
        type Guards<S: Real> = [S; 0];

        fn initial_mode(&self, _t: f64, _y: &[f64; 3]) {}

        fn rhs<S: Real>(&self, (): (), t: S, &[theta, omega, p]: &[S; 3], dydt: &mut [S; 3]) {
            let drag = omega.powi(3) / 4.0;
            *dydt = [omega, t.cos() - p * theta.sin() - drag, S::cst(0.0)];
        }

        fn guards<S: Real>(&self, (): (), _t: S, _y: &[S; 3], _g: &mut [S; 0]) {}

        fn guard_bounds(&self, (): (), _t: f64, _y: &[f64; 3], _bounds: &mut [f64; 0]) {}

        fn transition<S: Real>(&self, (): (), _: usize, _t: S, _y: &mut [S; 3]) -> Next<()> {
            Next::Stop
        }
    }

    #[test]
    fn the_jacobian_is_that_of_all_states() {
        let tolerance = Tolerance { rtol: 1e-8, atol: vec![1e-8; 3] };
        let directions = vec![[1.0, 0.0, 0.2], [0.3, -0.7, 1.0]];
        let system = Sensitive::new(&Pendulum, directions, tolerance).unwrap();
        let y = system.start(0.0, &[0.4, -1.1, 2.0]).unwrap();
        let mode = system.initial_mode(0.0, &y);
        let n = system.dim();
        let (mut found, mut expected) = (vec![0.0; n * n], vec![0.0; n * n]);
        system.jacobian(mode.clone(), 0.3, &y, |i, j, entry| found[i * n + j] = entry);
        sparsity::jacobian(&system, &mode, 0.3, &y, &mut |i, j, entry| expected[i * n + j] = entry);
        // δω̇ along (δθ, δω, δp) by θ.
        let (theta, [d_theta, _, d_p]) = (0.4_f64, [0.3, -0.7, 1.0]);
        let by_theta = 2.0 * theta.sin() * d_theta - theta.cos() * d_p;
        assert!((expected[8 * n] - by_theta).abs() < 1e-15, "{}", expected[8 * n]);
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-15, "{found} for {expected}");
        }
    }
}

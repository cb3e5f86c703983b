//! Systems drawn at random whose guard touches its surface, or nearly so, and the exact course of that guard.

use std::f64::consts::TAU;

use deltazero_solvers::{Next, Real, System};
use fastrand::Rng;

/// Length of the longest runs, and of the shortest in periods of the fastest part of the guard.
const T_END: f64 = 12.0;
const PERIODS: f64 = 60.0;
/// Points at which the exact guard is looked at, in its fastest period.
const LOOKS: f64 = 40.0;

/// A state that turns, a third that decays, and one guard of them and of time:
///
/// ```text
/// ẏ₀ = −ζ y₀ − ω y₁,   ẏ₁ = ω y₀ − ζ y₁,   ẏ₂ = −λ y₂
/// G = c + n·y + a sin(Ω t + φ)
/// ```
///
/// The modes are the sides of G: the guard is G above zero and −G below, and nothing else changes.
#[derive(Clone, Debug)]
pub(crate) struct Drawn {
    omega: f64,
    zeta: f64,
    lambda: f64,
    pub(crate) start: [f64; 3],
    level: f64,
    normal: [f64; 3],
    hum: f64,
    hum_omega: f64,
    hum_phase: f64,
    pub(crate) t_end: f64,
}

impl Drawn {
    /// System number `index` of `seed`. One least value of its guard is within 1e-12 to 1e-3 of zero, or zero.
    pub(crate) fn number(index: u64, seed: u64) -> Self {
        let mut rng = Rng::with_seed(seed.wrapping_add(index));
        loop {
            if let Some(drawn) = Self::draw(&mut rng) {
                return drawn;
            }
        }
    }

    fn draw(rng: &mut Rng) -> Option<Self> {
        let mut uniform = |a: f64, b: f64| a + (b - a) * rng.f64();
        let omega = 0.5 * 8.0_f64.powf(uniform(0.0, 1.0));
        let turned = uniform(0.0, TAU);
        let kind = uniform(0.0, 4.0) as u8;
        let zeta = if kind == 1 { uniform(0.0, 0.1) } else { 0.0 };
        let along = uniform(0.0, TAU);
        let of_third = if kind == 2 { uniform(-0.5, 0.5) } else { 0.0 };
        let mut drawn = Self {
            omega,
            zeta,
            lambda: uniform(0.1, 1.0),
            start: [turned.cos(), turned.sin(), 1.0],
            level: 0.0,
            normal: [along.cos(), along.sin(), of_third],
            hum: if kind == 3 { uniform(0.05, 1.0) } else { 0.0 },
            hum_omega: omega * 1000.0_f64.powf(uniform(0.0, 1.0)),
            hum_phase: uniform(0.0, TAU),
            t_end: T_END,
        };
        drawn.t_end = T_END.min(PERIODS * TAU / drawn.fastest());
        let depth = if uniform(0.0, 1.0) < 0.1 { 0.0 } else { 10.0_f64.powf(-uniform(3.0, 12.0)) };
        let sign = if uniform(0.0, 1.0) < 0.5 { 1.0 } else { -1.0 };
        let least: Vec<_> = drawn.extrema().into_iter().filter(|t| drawn.bend(*t) > 0.05).collect();
        let &t = least.get((uniform(0.0, 1.0) * least.len() as f64) as usize)?;
        drawn.level = -drawn.exact(t) - sign * depth;
        let is_far = |t: f64| drawn.exact(t).abs() > 0.02;
        (is_far(0.0) && is_far(drawn.t_end)).then_some(drawn)
    }

    /// The largest angular frequency.
    fn fastest(&self) -> f64 {
        if self.hum > 0.0 { self.hum_omega } else { self.omega }
    }

    /// The state at `t`.
    pub(crate) fn state(&self, t: f64) -> [f64; 3] {
        let [x, y, z] = self.start;
        let ((sin, cos), decay) = ((self.omega * t).sin_cos(), (-self.zeta * t).exp());
        let turned = [decay * (cos * x - sin * y), decay * (sin * x + cos * y)];
        [turned[0], turned[1], z * (-self.lambda * t).exp()]
    }

    /// G at `t`.
    pub(crate) fn exact(&self, t: f64) -> f64 {
        self.value(t, &self.state(t))
    }

    /// dG/dt at `t`.
    pub(crate) fn rate(&self, t: f64) -> f64 {
        let slope = self.slope(&self.state(t));
        let along: f64 = slope.iter().zip(self.normal).map(|(slope, n)| slope * n).sum();
        along + self.hum * self.hum_omega * (self.hum_omega * t + self.hum_phase).cos()
    }

    /// d²G/dt² at `t`.
    fn bend(&self, t: f64) -> f64 {
        let h = 1e-4 / self.hum_omega;
        (self.rate(t + h) - self.rate(t - h)) / (2.0 * h)
    }

    /// The times at which G is least or greatest, in order.
    pub(crate) fn extrema(&self) -> Vec<f64> {
        let n = (self.t_end * self.fastest() / TAU * LOOKS).ceil() as usize;
        let at = |k: usize| self.t_end * k as f64 / n as f64;
        let turns = |k: &usize| (self.rate(at(*k)) > 0.0) != (self.rate(at(k + 1)) > 0.0);
        let root = |k: usize| {
            let (mut a, mut b) = (at(k), at(k + 1));
            let is_rising = self.rate(a) > 0.0;
            while 0.5 * (a + b) > a && 0.5 * (a + b) < b {
                let middle = 0.5 * (a + b);
                if (self.rate(middle) > 0.0) == is_rising { a = middle } else { b = middle }
            }
            b
        };
        (0..n).filter(turns).map(root).collect()
    }

    /// Error of G at the state `y` at `t`, in what the tolerance `rtol` allows in a step.
    pub(crate) fn off(&self, t: f64, y: &[f64; 3], rtol: f64) -> f64 {
        let allowed: f64 =
            y.iter().zip(self.normal).map(|(y, n)| n.abs() * rtol * (1.0 + y.abs())).sum();
        (self.value(t, y) - self.exact(t)).abs() / allowed
    }

    fn slope<S: Real>(&self, &[x, y, z]: &[S; 3]) -> [S; 3] {
        let (omega, zeta) = (self.omega, self.zeta);
        [x * -zeta - y * omega, x * omega - y * zeta, z * -self.lambda]
    }

    fn value<S: Real>(&self, t: S, y: &[S; 3]) -> S {
        let planes = y[0] * self.normal[0] + y[1] * self.normal[1] + y[2] * self.normal[2];
        let hum = if self.hum > 0.0 {
            (t * self.hum_omega + self.hum_phase).sin() * self.hum
        } else {
            S::cst(0.0)
        };
        planes + hum + self.level
    }
}

impl System for Drawn {
    /// Whether G is above zero.
    type Mode = bool;
    type State<S: Real> = [S; 3];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, t: f64, y: &[f64; 3]) -> bool {
        self.value(t, y) >= 0.0
    }

    fn rhs<S: Real>(&self, _: bool, _t: S, y: &[S; 3], dydt: &mut [S; 3]) {
        *dydt = self.slope(y);
    }

    fn guards<S: Real>(&self, is_above: bool, t: S, y: &[S; 3], g: &mut [S; 1]) {
        let value = self.value(t, y);
        *g = [if is_above { value } else { -value }];
    }

    fn guard_bounds(&self, _: bool, t: f64, _y: &[f64; 3], bounds: &mut [f64; 1]) {
        let size = self.level.abs() + 3.0 + self.hum * (2.0 + self.hum_omega * t.abs());
        *bounds = [4.0 * f64::EPSILON * size];
    }

    fn transition<S: Real>(&self, is_above: bool, _: usize, _t: S, _: &mut [S; 3]) -> Next<bool> {
        Next::Mode(!is_above)
    }
}

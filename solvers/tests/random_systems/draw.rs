//! Systems drawn at random: modes that are linear, guards that are planes, resets that are affine.

use std::f64::consts::TAU;

use deltazero_solvers::{Next, Real, System};
use fastrand::Rng;

use crate::oracle;

/// Length of a run.
pub(crate) const T_END: f64 = 6.0;
/// Guards that a mode has room for.
const N_GUARDS: usize = 4;

/// How the state moves in one mode.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Flow {
    /// `ẏ = [−ζ −ω; ω −ζ] (y − centre)`: turns at ω [rad/s] and comes nearer at ζ [1/s].
    Spiral { centre: [f64; 2], omega: f64, zeta: f64 },
    /// `ẏ_i = −rates_i (y_i − centre_i)`.
    Node { centre: [f64; 2], rates: [f64; 2] },
    /// `ẏ = slope`.
    Drift { slope: [f64; 2] },
}

/// A guard `normal · y − level`, and what follows where it falls.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guard {
    /// A unit vector.
    pub(crate) normal: [f64; 2],
    pub(crate) level: f64,
    pub(crate) next: usize,
    reset: Reset,
}

/// `y_i ← factor_i y_i + shift_i`, of the state as it is or put on the surface first.
#[derive(Clone, Copy, Debug)]
struct Reset {
    projects: bool,
    factor: [f64; 2],
    shift: [f64; 2],
}

/// One mode.
#[derive(Clone, Debug)]
pub(crate) struct Mode {
    pub(crate) flow: Flow,
    pub(crate) guards: Vec<Guard>,
}

/// A hybrid system whose every arc has a closed form, and a start in mode 0.
#[derive(Clone, Debug)]
pub(crate) struct Drawn {
    pub(crate) modes: Vec<Mode>,
    pub(crate) start: [f64; 2],
}

impl Flow {
    /// `ẏ` at `y`.
    pub(crate) fn slope<S: Real>(&self, &[x, y]: &[S; 2]) -> [S; 2] {
        match *self {
            Self::Spiral { centre, omega, zeta } => {
                let (x, y) = (x - centre[0], y - centre[1]);
                [x * -zeta - y * omega, x * omega - y * zeta]
            }
            Self::Node { centre, rates } => {
                [(x - centre[0]) * -rates[0], (y - centre[1]) * -rates[1]]
            }
            Self::Drift { slope } => slope.map(S::cst),
        }
    }

    fn draw(rng: &mut Rng) -> Self {
        let centre = [uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0)];
        match rng.u8(0..10) {
            0 => Self::Drift { slope: [uniform(rng, -2.0, 2.0), uniform(rng, -2.0, 2.0)] },
            1 => Self::Node { centre, rates: [uniform(rng, -0.2, 2.0), uniform(rng, -0.2, 2.0)] },
            _ => {
                let omega = log_uniform(rng, 0.5, 20.0);
                let ratio = if rng.u8(0..4) == 0 { 0.6 } else { 0.05 };
                Self::Spiral { centre, omega, zeta: omega * uniform(rng, -0.003, ratio) }
            }
        }
    }

    /// The fastest rate in it.
    pub(crate) fn rate(&self) -> f64 {
        match *self {
            Self::Spiral { omega, .. } => omega,
            Self::Node { rates, .. } => rates[0].abs().max(rates[1].abs()),
            Self::Drift { .. } => 0.0,
        }
    }
}

impl Guard {
    /// A guard that is followed by mode `next` and resets nothing.
    pub(crate) fn new(normal: [f64; 2], level: f64, next: usize) -> Self {
        let reset = Reset { projects: false, factor: [1.0; 2], shift: [0.0; 2] };
        Self { normal, level, next, reset }
    }

    /// Its value at `y`.
    pub(crate) fn value<S: Real>(&self, y: &[S; 2]) -> S {
        y[0] * self.normal[0] + y[1] * self.normal[1] - self.level
    }

    /// The state after its event at `y`.
    pub(crate) fn after<S: Real>(&self, y: &[S; 2]) -> [S; 2] {
        let Reset { projects, factor, shift } = self.reset;
        let mut y = *y;
        // Twice, because the first one is only as exact as the distance is short.
        for _ in 0..if projects { 2 } else { 0 } {
            let off = self.value(&y);
            y = std::array::from_fn(|i| y[i] - off * self.normal[i]);
        }
        std::array::from_fn(|i| y[i] * factor[i] + shift[i])
    }

    /// A guard of a mode that is entered at `y`: its level is chosen by where the flow from there
    /// takes it, half of the time so that it dips below zero, or just not, for a short while.
    fn draw(rng: &mut Rng, flow: &Flow, y: &[f64; 2], mode: usize, n_modes: usize) -> Option<Self> {
        let axis = (rng.u8(0..4) == 0).then(|| rng.usize(0..2));
        let mut normal = match axis {
            Some(axis) => [0, 1].map(|i| f64::from(u8::from(i == axis))),
            None => {
                let (sin, cos) = uniform(rng, 0.0, TAU).sin_cos();
                [cos, sin]
            }
        };
        if rng.bool() {
            normal = normal.map(|n| -n);
        }
        let projects = rng.bool();
        let mut guard = Self::new(normal, 0.0, rng.usize(0..n_modes));
        guard.reset.projects = projects;
        let horizon = if flow.rate() > 0.0 { (TAU / flow.rate()).min(T_END) } else { T_END };
        let arc = oracle::Arc { flow, guard: &guard, start: *y };
        let least = arc.knots(horizon).map(|t| arc.value(t)).fold(f64::INFINITY, f64::min);
        let height = guard.value(y) - least;
        let depth = match rng.u8(0..10) {
            0..5 => log_uniform(rng, 3e-4, 0.3),
            5..7 => -log_uniform(rng, 3e-4, 0.3),
            _ => uniform(rng, 0.1, 0.9),
        };
        if height < 0.05 {
            return None;
        }
        guard.level = least + depth * height;
        match (rng.u8(0..4), axis, flow) {
            // A bounce: the state put on the surface, the other component reversed about the centre.
            (0, Some(axis), Flow::Spiral { centre, .. }) => {
                let (other, kept) = (1 - axis, uniform(rng, 0.6, 1.0));
                guard.next = mode;
                guard.reset.projects = true;
                guard.reset.factor[other] = -kept;
                guard.reset.shift[other] = (1.0 + kept) * centre[other];
            }
            (0 | 1, ..) => guard.reset.factor = [0; 2].map(|_| uniform(rng, 0.6, 1.2)),
            (2, ..) => guard.reset.factor[rng.usize(0..2)] *= -uniform(rng, 0.6, 1.0),
            _ if guard.next == mode => guard.next = (mode + 1) % n_modes,
            _ => {}
        }
        Some(guard)
    }

    /// Whether its event leaves the state at or above zero of `other`, where that has the same surface:
    /// the other side of it, or the state is put on it.
    pub(crate) fn puts_at_or_above(&self, other: &Self) -> bool {
        let is_same = self.normal == other.normal && self.level == other.level;
        let is_opposite = self.normal == other.normal.map(|n| -n) && self.level == -other.level;
        is_same && self.reset.projects || is_opposite
    }

    /// Whether its event leaves the state on its surface.
    fn stays(&self) -> bool {
        self.reset.factor == [1.0; 2]
    }

    /// A guard of the mode just entered at `y` through this one, on the same surface and rising from
    /// it: the way back where the flow goes on through the surface, the same one again where it turns.
    fn at_its_own_surface(
        mut self,
        flow: &Flow,
        y: &[f64; 2],
        mode: usize,
        n_modes: usize,
    ) -> Option<Self> {
        let slope = flow.slope(y);
        let rate = self.normal[0] * slope[0] + self.normal[1] * slope[1];
        if rate < 0.0 {
            self.normal = self.normal.map(|n| -n);
            self.level = -self.level;
        } else if !self.reset.projects {
            return None;
        }
        self.next = (mode + 1) % n_modes;
        Some(self)
    }
}

impl Drawn {
    /// The system number `index`: guards are drawn where a run first enters their mode.
    pub(crate) fn number(index: u64, seed: u64) -> Self {
        let rng = &mut Rng::with_seed(seed.wrapping_add(index));
        let n_modes = rng.usize(2..=4);
        let draw = |_| Mode { flow: Flow::draw(rng), guards: Vec::new() };
        let modes: Vec<Mode> = (0..n_modes).map(draw).collect();
        let start = [uniform(rng, -2.0, 2.0), uniform(rng, -2.0, 2.0)];
        let mut system = Self { modes, start };
        let (mut t, mut y, mut mode) = (0.0, start, 0);
        let mut entered_by: Option<Guard> = None;
        for _ in 0..4 * n_modes {
            if system.modes[mode].guards.is_empty() {
                let flow = system.modes[mode].flow;
                let n = rng.usize(1..=N_GUARDS);
                let mut guards: Vec<Guard> =
                    (0..n).filter_map(|_| Guard::draw(rng, &flow, &y, mode, n_modes)).collect();
                if let (Some(way_back), true) = (entered_by, rng.bool()) {
                    guards.truncate(N_GUARDS - 1);
                    guards.extend(way_back.at_its_own_surface(&flow, &y, mode, n_modes));
                }
                system.modes[mode].guards = guards;
            }
            let Some((dt, guard)) = oracle::first_fall(&system.modes[mode], &y, T_END - t) else {
                break;
            };
            y = guard.after(&system.modes[mode].flow.at(dt, &y));
            (t, mode, entered_by) = (t + dt, guard.next, guard.stays().then_some(*guard));
        }
        system
    }
}

impl System for Drawn {
    type Mode = usize;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; N_GUARDS];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> usize {
        0
    }

    fn rhs<S: Real>(&self, mode: usize, _t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = self.modes[mode].flow.slope(y);
    }

    fn guards<S: Real>(&self, mode: usize, _t: S, y: &[S; 2], g: &mut [S; N_GUARDS]) {
        *g = [S::cst(1.0); N_GUARDS];
        for (g, guard) in g.iter_mut().zip(&self.modes[mode].guards) {
            *g = guard.value(y);
        }
    }

    fn guard_bounds(&self, mode: usize, _t: f64, y: &[f64; 2], bounds: &mut [f64; N_GUARDS]) {
        *bounds = [f64::EPSILON; N_GUARDS];
        for (bound, guard) in bounds.iter_mut().zip(&self.modes[mode].guards) {
            let size = y[0].abs() + y[1].abs() + guard.level.abs();
            *bound = 8.0 * f64::EPSILON * size + f64::MIN_POSITIVE;
        }
    }

    fn transition<S: Real>(&self, mode: usize, guard: usize, _t: S, y: &mut [S; 2]) -> Next<usize> {
        let guard = &self.modes[mode].guards[guard];
        *y = guard.after(y);
        Next::Mode(guard.next)
    }
}

fn uniform(rng: &mut Rng, a: f64, b: f64) -> f64 {
    a + (b - a) * rng.f64()
}

fn log_uniform(rng: &mut Rng, a: f64, b: f64) -> f64 {
    a * (b / a).powf(rng.f64())
}

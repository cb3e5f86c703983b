//! A spring-mass oscillator on a moving belt: the stick–slip limit cycle.

use super::{Piece, ROUNDING, pieces};
use crate::real::Real;
use crate::system::{ModeOfState, Next, System};

/// How the mass moves against the belt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BeltMode {
    /// Moves with the belt.
    Stick,
    /// Faster than the belt.
    SlipPlus,
    /// Slower than the belt.
    SlipMinus,
}

/// A mass on a spring, dragged along by a belt of constant speed until the spring tears it off.
///
/// ```text
/// stick    ẋ = v_b                        while k x ≤ F_s
/// slip∓    m ẍ + k x = ±F_k               while ẋ ≶ v_b
/// at ẋ = v_b: slip− for k x > F_s, slip+ for k x < −F_s, else stick
///
/// x − c = R/ω sin(ω τ + ψ),   ẋ = R cos(ω τ + ψ),   ω = √(k/m),   c = ±F_k/k
///
/// cycle    stick  τ_1 = 2 (F_s − F_k)/(k v_b),         from x = (2 F_k − F_s)/k to F_s/k
///          slip−  τ_2 = 2 (π − β)/ω,                   tan β = ω (F_s − F_k)/(k v_b)
/// ```
///
/// `x` is the displacement [m], `m` the mass [kg], `k` the stiffness [N/m], `v_b` the speed of the
/// belt [m/s], `F_s` and `F_k` the static and kinetic friction [N], `τ` the time since slip began
/// [s], `R` [m/s] and `ψ` [rad] its amplitude and phase, `τ_1` and `τ_2` the durations on the cycle.
///
/// Valid for v_b > 0, F_s > F_k > 0 and any start. Slip− ends where ω τ + ψ = 2π − β, slip+ where it
/// is β, cos β = v_b/R: at the mirror image about c of where a slip at belt speed began. From one such
/// end to the next |x| falls by 2 F_k/k, until the mass sticks; it is on the cycle once it slips
/// again. A slip− with R ≤ v_b never meets the speed of the belt and goes on for ever.
///
/// Blind runs read the mode off the sign of ẋ − v_b. No step ends on ẋ = v_b exactly, so they do not
/// stick again and never feel F_s: they chatter along the belt up to k x = F_k and then swing with
/// the amplitude v_b/ω, however small the step.
///
/// Derived here: the first integral of slip, (ẋ/ω)² + (x − c)², ends at ẋ = v_b as it began.
/// The oscillator, with kinetic friction that depends on speed: R. I. Leine, D. H. van Campen, A. de
/// Kraker, L. van den Steen, "Stick-slip vibrations induced by alternate friction models", Nonlinear
/// Dynamics 16, 41–54 (1998).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeltOscillator {
    /// Mass m [kg].
    pub mass: f64,
    /// Stiffness k [N/m].
    pub stiffness: f64,
    /// Speed of the belt v_b [m/s].
    pub belt_speed: f64,
    /// Static friction F_s [N].
    pub static_friction: f64,
    /// Kinetic friction F_k [N].
    pub kinetic_friction: f64,
    /// State at t = 0: displacement [m] and velocity [m/s].
    pub start: [f64; 2],
}

impl BeltOscillator {
    /// Angular frequency ω [rad/s].
    pub fn omega(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    /// State on the cycle where stick begins.
    pub fn cycle_start(&self) -> [f64; 2] {
        let x = (2.0 * self.kinetic_friction - self.static_friction) / self.stiffness;
        [x, self.belt_speed]
    }

    /// Duration τ_1 of stick on the cycle [s].
    pub fn stick_time(&self) -> f64 {
        2.0 * self.drop() / self.belt_speed
    }

    /// Duration τ_2 of slip on the cycle [s].
    pub fn slip_time(&self) -> f64 {
        let beta = libm::atan2(self.omega() * self.drop(), self.belt_speed);
        2.0 * (std::f64::consts::PI - beta) / self.omega()
    }

    /// Period of the cycle [s].
    pub fn period(&self) -> f64 {
        self.stick_time() + self.slip_time()
    }

    /// State at `t ≥ 0`.
    pub fn state(&self, t: f64) -> [f64; 2] {
        let last = |piece: &Piece<_, _>| self.flow(piece.mode, piece.y, t - piece.t);
        self.pieces(t).last().map_or(self.start, last)
    }

    /// The pieces of the solution that begin by `t_end`: one from the start, one from each event.
    pub fn pieces(&self, t_end: f64) -> Vec<Piece<BeltMode, [f64; 2]>> {
        let start = Piece { t: 0.0, mode: self.initial_mode(0.0, &self.start), y: self.start };
        pieces(start, t_end, |piece| self.next(piece))
    }

    /// State `tau` after `y` in `mode` [s], past its surfaces too.
    pub fn flow(&self, mode: BeltMode, [x, v]: [f64; 2], tau: f64) -> [f64; 2] {
        let Some(centre) = self.centre(mode) else {
            return [x + self.belt_speed * tau, self.belt_speed];
        };
        let omega = self.omega();
        let (sin, cos) = libm::sincos(omega * tau);
        let d = x - centre;
        [centre + d * cos + v / omega * sin, v * cos - omega * d * sin]
    }

    /// How far the spring's force drops when slip begins, as a displacement (F_s − F_k)/k [m].
    fn drop(&self) -> f64 {
        (self.static_friction - self.kinetic_friction) / self.stiffness
    }

    /// Displacement c that a slip swings about [m].
    fn centre(&self, mode: BeltMode) -> Option<f64> {
        match mode {
            BeltMode::Stick => None,
            BeltMode::SlipPlus => Some(-self.kinetic_friction / self.stiffness),
            BeltMode::SlipMinus => Some(self.kinetic_friction / self.stiffness),
        }
    }

    /// The piece that follows; never, where slip does not end.
    fn next(
        &self,
        Piece { t, mode, y: [x, v] }: Piece<BeltMode, [f64; 2]>,
    ) -> Piece<BeltMode, [f64; 2]> {
        let v_b = self.belt_speed;
        let Some(centre) = self.centre(mode) else {
            let torn = self.static_friction / self.stiffness;
            return Piece { t: t + (torn - x) / v_b, mode: BeltMode::SlipMinus, y: [torn, v_b] };
        };
        let (omega, d) = (self.omega(), x - centre);
        let square = (v - v_b) * (v + v_b) + omega * d * omega * d;
        if square <= 0.0 {
            return Piece { t: f64::INFINITY, mode, y: [x, v] };
        }
        // R sin β, and the phases at both ends.
        let rise = square.sqrt();
        let beta = libm::atan2(rise, v_b);
        let psi = libm::atan2(omega * d, v);
        let two_pi = 2.0 * std::f64::consts::PI;
        let (turned, x) = match mode {
            BeltMode::SlipPlus => (beta - psi, centre + rise / omega),
            _ if psi < 0.0 => (-beta - psi, centre - rise / omega),
            _ => (two_pi - beta - psi, centre - rise / omega),
        };
        Piece { t: t + turned / omega, mode: self.mode_at_belt_speed(x), y: [x, v_b] }
    }

    /// The mode of a mass at the speed of the belt.
    fn mode_at_belt_speed(&self, x: f64) -> BeltMode {
        let pull = self.stiffness * x;
        if pull > self.static_friction {
            BeltMode::SlipMinus
        } else if pull < -self.static_friction {
            BeltMode::SlipPlus
        } else {
            BeltMode::Stick
        }
    }
}

impl System for BeltOscillator {
    type Mode = BeltMode;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, t: f64, y: &[f64; 2]) -> BeltMode {
        self.mode_of_state(t, y)
    }

    fn rhs<S: Real>(&self, mode: BeltMode, _t: S, &[x, v]: &[S; 2], dydt: &mut [S; 2]) {
        let friction = match mode {
            BeltMode::Stick => {
                *dydt = [S::cst(self.belt_speed), S::cst(0.0)];
                return;
            }
            BeltMode::SlipPlus => -self.kinetic_friction,
            BeltMode::SlipMinus => self.kinetic_friction,
        };
        *dydt = [v, (-x * self.stiffness + friction) / self.mass];
    }

    fn guards<S: Real>(&self, mode: BeltMode, _t: S, &[x, v]: &[S; 2], g: &mut [S; 1]) {
        *g = match mode {
            BeltMode::Stick => [-x * self.stiffness + self.static_friction],
            BeltMode::SlipPlus => [v - self.belt_speed],
            BeltMode::SlipMinus => [-v + self.belt_speed],
        };
    }

    fn guard_bounds(&self, mode: BeltMode, _t: f64, &[x, v]: &[f64; 2], bounds: &mut [f64; 1]) {
        let size = match mode {
            BeltMode::Stick => self.stiffness * x.abs() + self.static_friction,
            _ => v.abs() + self.belt_speed + self.omega() * x.abs(),
        };
        *bounds = [ROUNDING * size];
    }

    fn transition<S: Real>(
        &self,
        mode: BeltMode,
        _guard: usize,
        _t: S,
        y: &mut [S; 2],
    ) -> Next<BeltMode> {
        y[1] = S::cst(self.belt_speed);
        Next::Mode(match mode {
            BeltMode::Stick => BeltMode::SlipMinus,
            _ => self.mode_at_belt_speed(y[0].value()),
        })
    }
}

impl ModeOfState for BeltOscillator {
    fn mode_of_state<S: Real>(&self, _t: S, y: &[S; 2]) -> BeltMode {
        let (x, v) = (y[0].value(), y[1].value());
        if v > self.belt_speed {
            BeltMode::SlipPlus
        } else if v < self.belt_speed {
            BeltMode::SlipMinus
        } else {
            self.mode_at_belt_speed(x)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn oscillator(start: [f64; 2]) -> BeltOscillator {
        BeltOscillator {
            mass: 2.0,
            stiffness: 50.0,
            belt_speed: 0.3,
            static_friction: 8.0,
            kinetic_friction: 3.0,
            start,
        }
    }

    /// Kinetic energy and that of the spring [J].
    fn energy(oscillator: &BeltOscillator, [x, v]: [f64; 2]) -> f64 {
        0.5 * oscillator.mass * v * v + 0.5 * oscillator.stiffness * x * x
    }

    #[test]
    fn friction_does_the_work_that_the_energy_shows() {
        // Slip of all kinds: both signs, from one to the other, into stick, and for ever.
        for start in [[0.9, 0.1], [-0.2, 2.5], [0.05, 0.3], [0.04, 0.1], [-0.9, 0.3]] {
            let oscillator = oscillator(start);
            let pieces = oscillator.pieces(6.0);
            for pair in pieces.windows(2) {
                let end = oscillator.flow(pair[0].mode, pair[0].y, pair[1].t - pair[0].t);
                // Continuous. Measured: 2.2e-16 m and 4.3e-15 m/s.
                let [x, v] = pair[1].y;
                assert!((end[0] - x).abs() < 2e-15 && (end[1] - v).abs() < 3e-14, "{end:?} {x}");
                let push = match pair[0].mode {
                    BeltMode::Stick => 0.5 * oscillator.stiffness * (x + pair[0].y[0]),
                    BeltMode::SlipPlus => -oscillator.kinetic_friction,
                    BeltMode::SlipMinus => oscillator.kinetic_friction,
                };
                let gain = energy(&oscillator, pair[1].y) - energy(&oscillator, pair[0].y);
                let work = push * (x - pair[0].y[0]);
                // Measured: 4.4e-15 J of 5 J.
                assert!((gain - work).abs() < 3e-14, "{gain} {work}");
            }
        }
    }

    #[test]
    fn every_start_that_sticks_is_on_the_cycle_from_then_on() {
        for (start, sticks_after) in [([0.9, 0.1], 7), ([-0.2, 2.5], 4), ([0.05, 0.3], 0)] {
            let oscillator = oscillator(start);
            let pieces = oscillator.pieces(20.0);
            let first = pieces.iter().position(|piece| piece.mode == BeltMode::Stick);
            assert_eq!(first, Some(sticks_after), "{pieces:?}");
            // The first stick begins off the cycle, its end is on it.
            let cycle = &pieces[sticks_after + 1..];
            for (n, piece) in cycle.iter().enumerate() {
                let (periods, sticks) = ((n / 2) as f64, n % 2 == 1);
                let rest = if sticks { oscillator.slip_time() } else { 0.0 };
                let t = cycle[0].t + periods * oscillator.period() + rest;
                // Measured: 3.6e-15 s.
                assert!((piece.t - t).abs() < 3e-14, "{} {t}", piece.t);
                assert_eq!(piece.mode == BeltMode::Stick, sticks);
                let [x, _] = oscillator.cycle_start();
                // Measured: 6.9e-18 m.
                assert!(!sticks || (piece.y[0] - x).abs() < 6e-17, "{} {x}", piece.y[0]);
            }
        }
    }

    #[test]
    fn a_small_swing_never_sticks() {
        let oscillator = oscillator([0.07, 0.1]);
        assert_eq!(oscillator.pieces(100.0).len(), 1);
        let radius = |[x, v]: [f64; 2]| libm::hypot(x - 0.06, v / oscillator.omega());
        // Measured: 0.
        assert!((radius(oscillator.state(50.0)) - radius(oscillator.start)).abs() < 1e-16);
    }
}

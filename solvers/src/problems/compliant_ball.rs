//! A mass that flies between two compliant walls: every contact is a linear oscillation.

use super::ROUNDING;
use crate::real::Real;
use crate::system::{ModeOfState, Next, System};

/// One of the two walls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wall {
    /// The wall at x = 0.
    Left,
    /// The wall at x = L.
    Right,
}

/// When a contact ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// At δ = 0; the wall may pull just before.
    Penetration,
    /// At F_N = 0; the mass leaves while the wall is still dented.
    Force,
}

/// What the mass does, and with which wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BallMode {
    /// Flies towards this wall.
    Flight(Wall),
    /// Touches this wall.
    Contact(Wall),
}

/// A mass without gravity between two walls, each a spring and a dashpot.
///
/// ```text
/// m ẍ = 0          in flight
/// m δ̈ = −F_N       in contact,   F_N = K δ + D δ̇,   ζ = D / (2 √(K m)) < 1
///
/// left wall: δ = −x,   right wall: δ = x − L
///
/// δ(τ) = u/ω_d e^(−ζωτ) sin(ω_d τ),   ω = √(K/m),   ω_d = ω √(1 − ζ²)
///
/// exit at δ = 0:    φ = π,              exit at F_N = 0:   φ = π − 2 asin ζ
/// restitution       exp(−φ ζ/√(1 − ζ²))  after  τ = φ/ω_d
/// ```
///
/// `x` is the position [m], `m` the mass [kg], `K` the stiffness [N/m], `D` the damping [N s/m],
/// `L` the distance of the walls [m], `δ` the penetration [m], `u` the speed of approach [m/s],
/// `τ` the time since contact began [s], `φ` the phase ω_d τ of the exit [rad].
///
/// T. Schwager, T. Pöschel, "Coefficient of restitution and linear–dashpot model revisited",
/// Granular Matter 9, 465–469 (2007), (11) for the exit at δ = 0 and (20) for F_N = 0.
///
/// Valid for 0 ≤ ζ < 1, a start between the walls with a velocity that is not zero, and contacts
/// that end before the mass reaches the other wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompliantBall {
    /// Mass m [kg].
    pub mass: f64,
    /// Stiffness K [N/m].
    pub stiffness: f64,
    /// Damping D [N s/m].
    pub damping: f64,
    /// When contacts end.
    pub exit: Exit,
    /// Distance of the walls L [m].
    pub gap: f64,
    /// State at t = 0: position [m] and velocity [m/s].
    pub start: [f64; 2],
}

impl CompliantBall {
    /// Undamped angular frequency ω of a contact [rad/s].
    fn omega(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    /// Damping ratio ζ.
    pub fn zeta(&self) -> f64 {
        0.5 * self.damping / (self.stiffness * self.mass).sqrt()
    }

    /// Phase φ at which a contact ends [rad].
    fn exit_phase(&self) -> f64 {
        let pi = std::f64::consts::PI;
        match self.exit {
            Exit::Penetration => pi,
            Exit::Force => pi - 2.0 * libm::asin(self.zeta()),
        }
    }

    /// Duration of a contact [s], the same for all speeds.
    pub fn contact_time(&self) -> f64 {
        let zeta = self.zeta();
        self.exit_phase() / (self.omega() * (1.0 - zeta * zeta).sqrt())
    }

    /// Speed after a contact over the speed before it.
    pub fn restitution(&self) -> f64 {
        let zeta = self.zeta();
        libm::exp(-zeta / (1.0 - zeta * zeta).sqrt() * self.exit_phase())
    }

    /// Penetration [m] and its rate [m/s], `tau` after a contact began at speed `u`.
    fn contact(&self, u: f64, tau: f64) -> [f64; 2] {
        let (zeta, omega) = (self.zeta(), self.omega());
        let root = (1.0 - zeta * zeta).sqrt();
        let (sin, cos) = libm::sincos(omega * root * tau);
        let envelope = u * libm::exp(-zeta * omega * tau);
        [envelope * sin / (omega * root), envelope * (cos - zeta / root * sin)]
    }

    /// State at `t ≥ 0`, and the times of all events up to then [s]: entries and exits in turn.
    pub fn solution(&self, t: f64) -> ([f64; 2], Vec<f64>) {
        let mut events = Vec::new();
        let (mut t0, [mut x, mut v]) = (0.0, self.start);
        loop {
            let wall = if v < 0.0 { Wall::Left } else { Wall::Right };
            let entry = t0 + -self.depth(wall, x) / v.abs();
            if t <= entry {
                return ([x + v * (t - t0), v], events);
            }
            let exit = entry + self.contact_time();
            events.push(entry);
            let [delta, delta_dot] = self.contact(v.abs(), exit.min(t) - entry);
            let outward = v.signum();
            let surface = self.gap * f64::from(u8::from(wall == Wall::Right));
            (x, v) = (surface + outward * delta, outward * delta_dot);
            if t <= exit {
                return ([x, v], events);
            }
            events.push(exit);
            t0 = exit;
        }
    }

    /// Penetration δ of `wall` [m]; below zero it is minus the clearance.
    fn depth<S: Real>(&self, wall: Wall, x: S) -> S {
        match wall {
            Wall::Left => -x,
            Wall::Right => x - self.gap,
        }
    }

    /// Normal force K δ + D δ̇ of `wall` [N].
    fn force<S: Real>(&self, wall: Wall, &[x, v]: &[S; 2]) -> S {
        self.depth(wall, x) * self.stiffness + towards(wall, v) * self.damping
    }
}

/// The velocity `v` counted towards `wall`.
fn towards<S: Real>(wall: Wall, v: S) -> S {
    match wall {
        Wall::Left => -v,
        Wall::Right => v,
    }
}

impl System for CompliantBall {
    type Mode = BallMode;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, t: f64, y: &[f64; 2]) -> BallMode {
        self.mode_of_state(t, y)
    }

    fn rhs<S: Real>(&self, mode: BallMode, _t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        let push = match mode {
            BallMode::Flight(_) => S::cst(0.0),
            BallMode::Contact(wall) => -towards(wall, self.force(wall, y)),
        };
        *dydt = [y[1], push / self.mass];
    }

    fn guards<S: Real>(&self, mode: BallMode, _t: S, y: &[S; 2], g: &mut [S; 1]) {
        *g = match (mode, self.exit) {
            (BallMode::Flight(wall), _) => [-self.depth(wall, y[0])],
            (BallMode::Contact(wall), Exit::Penetration) => [self.depth(wall, y[0])],
            (BallMode::Contact(wall), Exit::Force) => [self.force(wall, y)],
        };
    }

    fn guard_bounds(&self, mode: BallMode, _t: f64, y: &[f64; 2], bounds: &mut [f64; 1]) {
        let length = y[0].abs() + self.gap;
        *bounds = match (mode, self.exit) {
            (BallMode::Contact(_), Exit::Force) => {
                [ROUNDING * (self.stiffness * length + self.damping * y[1].abs())]
            }
            _ => [ROUNDING * length],
        };
    }

    fn transition<S: Real>(
        &self,
        mode: BallMode,
        _guard: usize,
        _t: S,
        _y: &mut [S; 2],
    ) -> Next<BallMode> {
        Next::Mode(match mode {
            BallMode::Flight(wall) => BallMode::Contact(wall),
            BallMode::Contact(Wall::Left) => BallMode::Flight(Wall::Right),
            BallMode::Contact(Wall::Right) => BallMode::Flight(Wall::Left),
        })
    }
}

impl ModeOfState for CompliantBall {
    fn mode_of_state<S: Real>(&self, _t: S, y: &[S; 2]) -> BallMode {
        let y = [y[0].value(), y[1].value()];
        let touches = |wall| {
            self.depth(wall, y[0]) > 0.0
                && (self.exit == Exit::Penetration || self.force(wall, &y) > 0.0)
        };
        let ahead = if y[1] < 0.0 { Wall::Left } else { Wall::Right };
        match [Wall::Left, Wall::Right].into_iter().find(|&wall| touches(wall)) {
            Some(wall) => BallMode::Contact(wall),
            None => BallMode::Flight(ahead),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contact_ends_where_its_exit_rule_says_with_its_restitution() {
        for exit in [Exit::Penetration, Exit::Force] {
            let ball = CompliantBall {
                mass: 1.5,
                stiffness: 40.0,
                damping: 4.0,
                exit,
                gap: 1.0,
                start: [0.5, 2.0],
            };
            let [delta, delta_dot] = ball.contact(2.0, ball.contact_time());
            let residual = match exit {
                Exit::Penetration => delta,
                Exit::Force => ball.stiffness * delta + ball.damping * delta_dot,
            };
            // Measured: 4e-16 of a force of 10 N, and 1.1e-16.
            assert!(residual.abs() < 4e-15, "{residual}");
            assert!((-delta_dot / 2.0 - ball.restitution()).abs() < 1e-15);
        }
    }
}

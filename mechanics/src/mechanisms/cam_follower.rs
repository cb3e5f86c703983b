//! A cam with a flat-faced follower that may lift off: valve float.

mod entry;

use std::fmt;

use deltazero_solvers::root::{Bracket, find_root};
use deltazero_solvers::rounding::ROUNDING;
use deltazero_solvers::{Error, Next, Outcome, Real, Record, System};
use deltazero_study::problem::{
    Energy, Group, Laws, Power, Problem, Quantity, Role, Touch, each_a_group,
};
use deltazero_study::run::{OwnRun, extended};

use crate::laws::elastic::Elastic;
use crate::model::contact::{NormalLaw, Onset, Rounding};

pub(super) use entry::CAM_FOLLOWER;

/// What the follower does, with what its contact keeps of its beginning.
#[derive(Clone, Copy, PartialEq)]
pub enum Mode {
    /// Flies: δ < 0.
    Free,
    /// Flies, cam and follower still dented: δ > 0 but F_N ≤ 0 without adhesion.
    Relaxing(Onset),
    /// Follows the cam.
    Contact(Onset),
}

impl Mode {
    /// What its contact keeps of its beginning, relaxing too.
    fn onset(self) -> Option<Onset> {
        match self {
            Self::Free => None,
            Self::Relaxing(onset) | Self::Contact(onset) => Some(onset),
        }
    }
}

impl fmt::Debug for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Free => "free",
            Self::Relaxing(_) => "free (relaxing)",
            Self::Contact(_) => "contact",
        })
    }
}

/// Guard: on this side of the contact surface, as that of a [joint](crate::model::mode::GUARD_CONTACT).
const GUARD_CONTACT: usize = 0;
/// Guard: relaxing, δ > 0.
const GUARD_SURFACE: usize = 1;
/// Guard: in contact within the range of its law, as that of a [joint](crate::model::mode::GUARD_RANGE).
const GUARD_RANGE: usize = 2;

/// A cam that turns at a constant speed under a flat-faced follower on a preloaded spring.
///
/// ```text
/// m ẍ = F_N − F_0 − k x − c ẋ,   s = (h/2)(1 − cos φ),   φ̇ = Ω
/// δ = s − x,   F_N by the normal law in contact, zero in flight
/// ```
///
/// `x` is the lift of the follower and `s` that of the cam [m], `φ` the angle of the cam [rad], its speed `Ω` [rad/s],
/// its greatest lift `h` [m]; `m` is the mass of the follower [kg], `k` the stiffness of the spring [N/m], `F_0` its
/// preload at x = 0 [N], which carries the weight too, `c` the damping [N s/m], `δ` the penetration [m]. The angle is
/// a state because the contact depends on it. The contact is any [`NormalLaw`].
///
/// A follower that a rigid contact held to the cam would be pressed on it by
///
/// ```text
/// N(φ) = F_0 + k s + c ṡ + m s̈ = F_0 + k h/2 + (h/2) ((m Ω² − k) cos φ + c Ω sin φ)
/// ```
///
/// so it separates above the [speed](Self::separation_speed) at which the least N is zero,
///
/// ```text
/// (m Ω² − k)² + c² Ω² = (k + 2 F_0/h)²,       without damping  Ω² = 2 (F_0 + k h)/(m h), at the top of the lift
/// ```
///
/// Under `F_N = K δ + D δ̇` the contact is in series with the follower: with `Z = k − m Ω² + i c Ω` and
/// `Z_c = K + i D Ω` the steady force has the mean `(F_0 + k h/2) K/(K + k)` and the amplitude `(h/2) |Z Z_c/(Z + Z_c)|`,
/// equal at the speed of separation, for which the tests solve; it is lower than the rigid one by
/// the part `(k + 2 F_0/h)/(2K)`, to first order in 1/K and without damping.
///
/// The follower starts as if the cam had always turned: at φ = 0, at rest, at the δ_0 with
/// `F(δ_0) = F_0 − k δ_0 + m s̈(0)`. A contact that nothing began has no speed of impact, and a law with hysteresis is
/// given the greatest speed of the cam, h Ω/2, for it.
///
/// Derived here; on separation see F. Y. Chen, *Mechanics and Design of Cam Mechanisms*, Pergamon (1982), and
/// R. L. Norton, *Cam Design and Manufacturing Handbook*, 2nd ed., Industrial Press (2009), which were not at hand.
///
/// Valid for m, k, h > 0 and penetrations that are small beside the lift.
///
/// | key | default | unit | |
/// |---|---|---|---|
/// | `mass` | 0.2 | kg | m, with a third of the spring's |
/// | `stiffness` | 1e4 | N/m | k |
/// | `preload` | 100 | N | F_0 |
/// | `damping` | 5 | N s/m | c; 0.056 of the critical one |
/// | `lift` | 0.01 | m | h |
/// | `speed` | 480 | rad/s | Ω; separation begins at 447 |
/// | `contact.law`, `contact.exponent` | `power`, 1 | | |
/// | `contact.stiffness` | 1e8 | N/m | K, hard steel on steel along a line of some millimetres |
/// | `contact.damping` | 900 | N s/m | D; restitution 0.75 of a free impact |
/// | `contact.adhesion` | false | | |
///
/// All values are our choice, of the size of a small engine's valve train.
#[derive(Clone, Debug, PartialEq)]
pub struct CamFollower {
    /// Mass m [kg].
    pub mass: f64,
    /// Stiffness k of the spring [N/m].
    pub stiffness: f64,
    /// Preload F_0 of the spring [N].
    pub preload: f64,
    /// Damping c [N s/m].
    pub damping: f64,
    /// Greatest lift h [m].
    pub lift: f64,
    /// Speed Ω of the cam [rad/s].
    pub speed: f64,
    /// Normal force law.
    pub normal: NormalLaw,
}

impl Default for CamFollower {
    fn default() -> Self {
        Self {
            mass: 0.2,
            stiffness: 1e4,
            preload: 100.0,
            damping: 5.0,
            lift: 0.01,
            speed: 480.0,
            normal: NormalLaw {
                elastic: Elastic::power(1e8, 1.0),
                damping: 900.0,
                hysteresis: 0.0,
                impact_speed_floor: 1e-6,
                adhesion: false,
            },
        }
    }
}

impl CamFollower {
    /// Lift s [m] and its rate ṡ [m/s] at the angle `phi`.
    fn cam<S: Real>(&self, phi: S) -> [S; 2] {
        let (sin, cos) = phi.sin_cos();
        let half = 0.5 * self.lift;
        [-(cos * half) + half, sin * (half * self.speed)]
    }

    /// δ and δ̇.
    fn penetration<S: Real>(&self, &[x, v, phi]: &[S; 3]) -> [S; 2] {
        let [s, s_dot] = self.cam(phi);
        [s - x, s_dot - v]
    }

    /// F_N in `mode` [N].
    fn force<S: Real>(&self, mode: Mode, y: &[S; 3]) -> S {
        match mode {
            Mode::Contact(onset) => {
                let [delta, delta_dot] = self.penetration(y);
                self.normal.force(delta, delta_dot, onset)
            }
            _ => S::cst(0.0),
        }
    }

    /// The speed Ω above which a follower on a rigid contact separates [rad/s].
    pub fn separation_speed(&self) -> f64 {
        // m² W² + (c² − 2 m k) W + k² − (k + 2 F_0/h)² = 0,  W = Ω²
        let (m, k, c) = (self.mass, self.stiffness, self.damping);
        let most = k + 2.0 * self.preload / self.lift;
        let b = 0.5 * c * c - m * k;
        let square = (-b + (b * b + m * m * (most - k) * (most + k)).sqrt()) / (m * m);
        square.sqrt()
    }

    /// Period of the cam [s].
    pub fn period(&self) -> f64 {
        2.0 * std::f64::consts::PI / self.speed
    }

    /// Greatest speed of the cam [m/s].
    fn top_speed(&self) -> f64 {
        0.5 * self.lift * self.speed
    }

    /// What presses on the cam at φ = 0 [N]: `F_0 + m s̈`.
    fn first_load(&self) -> f64 {
        self.preload + self.mass * self.top_speed() * self.speed
    }

    /// Penetration at the start, δ_0 [m].
    fn first_penetration(&self) -> f64 {
        let load = self.first_load();
        let excess = |delta: f64| load - self.stiffness * delta - self.normal.elastic.force(delta);
        let bracket = Bracket { above: 0.0, below: load / self.stiffness };
        find_root(excess, bracket, f64::EPSILON * f64::EPSILON)
    }

    /// The mode that a contact falls back to when its guard is violated at `y`.
    fn left<S: Real>(&self, y: &[S; 3], onset: Onset) -> Mode {
        let [delta, _] = self.penetration(y);
        if self.normal.leaves_dent(delta) { Mode::Relaxing(onset) } else { Mode::Free }
    }
}

impl System for CamFollower {
    type Mode = Mode;
    /// x [m], ẋ [m/s], φ [rad].
    type State<S: Real> = [S; 3];
    type Guards<S: Real> = [S; 3];

    fn initial_mode(&self, _t: f64, y: &[f64; 3]) -> Mode {
        let [delta, delta_dot] = self.penetration(y);
        let onset = self.normal.onset(self.top_speed());
        if delta <= 0.0 {
            Mode::Free
        } else if self.normal.touches(delta, delta_dot, onset) {
            Mode::Contact(onset)
        } else {
            Mode::Relaxing(onset)
        }
    }

    fn rhs<S: Real>(&self, mode: Mode, _t: S, y: &[S; 3], dydt: &mut [S; 3]) {
        let spring = y[0] * self.stiffness + y[1] * self.damping + self.preload;
        let force = self.force(mode, y) - spring;
        *dydt = [y[1], force / self.mass, S::cst(self.speed)];
    }

    fn guards<S: Real>(&self, mode: Mode, _t: S, y: &[S; 3], g: &mut [S; 3]) {
        *g = [S::cst(1.0); 3];
        let ([delta, delta_dot], normal) = (self.penetration(y), &self.normal);
        match mode {
            Mode::Free => g[GUARD_CONTACT] = -delta,
            Mode::Relaxing(onset) => {
                g[GUARD_CONTACT] = normal.relaxing_guard(delta, delta_dot, onset);
                g[GUARD_SURFACE] = delta;
            }
            Mode::Contact(onset) => {
                g[GUARD_CONTACT] = normal.contact_guard(delta, delta_dot, onset);
                if let Some(left) = normal.range_guard(delta, delta_dot, onset) {
                    g[GUARD_RANGE] = left;
                }
            }
        }
    }

    fn guard_bounds(&self, mode: Mode, _t: f64, y: &[f64; 3], bounds: &mut [f64; 3]) {
        // The angle's rounding moves the cam.
        let delta_bound = ROUNDING * (self.lift * (1.0 + y[2].abs()) + y[0].abs());
        *bounds = [delta_bound, delta_bound, ROUNDING];
        let Some(onset) = mode.onset() else { return };
        let rounding = Rounding {
            delta: delta_bound,
            speed: y[1].abs() + self.top_speed() * (1.0 + y[2].abs()),
            least_force: 1e-6 * self.first_load(),
        };
        let own = self.normal.guard_bounds(self.penetration(y), onset, rounding);
        let is_relaxing = matches!(mode, Mode::Relaxing(_));
        bounds[GUARD_CONTACT] = if is_relaxing { own.relaxing } else { own.contact };
        bounds[GUARD_RANGE] = own.range;
    }

    fn transition<S: Real>(&self, mode: Mode, guard: usize, _t: S, y: &mut [S; 3]) -> Next<Mode> {
        Next::Mode(match (mode, guard) {
            (Mode::Free, _) => {
                let [_, delta_dot] = self.penetration(y);
                Mode::Contact(self.normal.onset(delta_dot.value()))
            }
            // The dent is that of the same contact.
            (Mode::Relaxing(onset), GUARD_CONTACT) => Mode::Contact(onset),
            (Mode::Relaxing(_), _) => Mode::Free,
            (Mode::Contact(_), GUARD_RANGE) if !self.normal.releases_by_factor() => {
                return Next::Stop;
            }
            (Mode::Contact(onset), _) => self.left(y, onset),
        })
    }
}

impl Problem for CamFollower {
    /// Whether the law can carry the start.
    fn check(&self) -> Result<(), Error> {
        let (most, load) = (self.normal.elastic.strongest(), self.first_load());
        if most > load {
            return Ok(());
        }
        let reason = format!(
            "the contact law carries at most {most:.3e} N, the cam presses with {load:.3e} N at the start; take a \
             longer contact or a stiffer material"
        );
        Err(Error::Refused { reason })
    }

    fn start(&self) -> [f64; 3] {
        [-self.first_penetration(), 0.0, 0.0]
    }

    fn states(&self) -> Vec<Quantity> {
        vec![
            Quantity::new("x", "m", self.lift),
            Quantity::new("v", "m/s", self.top_speed()),
            Quantity::new("phi", "rad", 2.0 * std::f64::consts::PI),
        ]
    }

    /// Lift and speed; the angle has no error.
    fn groups(&self) -> Vec<Group> {
        each_a_group(self.states().into_iter().take(2))
    }

    fn role(&self, mode: &Mode, _site: usize) -> Role {
        if matches!(mode, Mode::Contact(_)) { Role::Contact } else { Role::Free }
    }

    /// Free apart and free relaxing are one mode.
    fn is_counted(&self, before: &Mode, after: &Mode, _site: usize) -> bool {
        self.role(before, 0) != self.role(after, 0)
    }

    fn unit_of_time(&self) -> f64 {
        self.period()
    }

    fn touch<S: Real>(&self, mode: &Mode, _t: S, y: &[S; 3], _: usize) -> Option<Touch<S>> {
        let [depth, rate] = self.penetration(y);
        Some(Touch { depth, rate, force: self.force(*mode, y) })
    }

    /// The spring's counts as kinetic.
    fn energies(&self, mode: &Mode, _t: f64, y: &[f64; 3]) -> Option<Energy> {
        let [x, v, _] = *y;
        let kinetic = 0.5 * (self.mass * v * v + self.stiffness * x * x) + self.preload * x;
        let [delta, _] = self.penetration(y);
        let is_contact = matches!(mode, Mode::Contact(_));
        let elastic = if is_contact { self.normal.elastic.energy(delta) } else { 0.0 };
        Some(Energy { kinetic, elastic })
    }

    /// Damping is that of the contact and of the damper.
    fn powers(&self, mode: &Mode, _t: f64, y: &[f64; 3]) -> Option<Power> {
        let ([delta, delta_dot], [_, s_dot]) = (self.penetration(y), self.cam(y[2]));
        let lost = match mode {
            Mode::Contact(onset) => self.normal.loss(delta, delta_dot, *onset),
            _ => 0.0,
        };
        let damping = lost + self.damping * y[1] * y[1];
        Some(Power { drive: self.force(*mode, y) * s_dot, damping, friction: 0.0 })
    }

    fn takes_energy(&self, before: &Mode, after: &Mode) -> bool {
        [before, after].iter().any(|mode| matches!(mode, Mode::Relaxing(_)))
    }

    /// The states, the gap and the force.
    fn columns(&self, _site: usize) -> Vec<Quantity> {
        let more =
            [("delta", "m"), ("f_n", "N")].map(|(name, unit)| Quantity::new(name, unit, 1.0));
        self.states().into_iter().chain(more).collect()
    }

    fn rows(&self, mode: &Mode, _t: f64, y: &[f64; 3], row: &mut dyn FnMut(usize, &[f64])) {
        let [delta, _] = self.penetration(y);
        row(0, &[y[0], y[1], y[2], delta, self.force(*mode, y)]);
    }

    fn begins_at_speed_floor(&self, before: &Mode, after: &Mode) -> bool {
        let floor = self.normal.impact_speed_floor;
        *before == Mode::Free && after.onset().is_some_and(|onset| onset.impact_speed <= floor)
    }

    fn laws(&self) -> Laws {
        let deepest = Some(self.lift);
        Laws { balances: true, damping_takes: true, friction_takes: true, deepest }
    }

    fn judged(
        &self,
        outcome: Result<Outcome, Error>,
        t: f64,
        mode: &Mode,
        y: &[f64; 3],
    ) -> Result<Outcome, Error> {
        if outcome != Ok(Outcome::Stopped) {
            return outcome;
        }
        let reason = format!(
            "penetration δ = {:.6e} m is where the contact law ends, at {:.3e} N; take a longer contact, a stiffer \
             material or a slower cam",
            self.penetration(y)[0],
            self.normal.elastic.strongest()
        );
        Err(Error::OutsideModel { t, mode: format!("{mode:?}"), reason })
    }

    fn integrate_extended(
        &self,
        rtol: f64,
        y0: [f64; 3],
        t_end: f64,
        record: &mut dyn Record<Self>,
    ) -> OwnRun<Self> {
        extended(self, rtol, y0, t_end, record)
    }
}

#[cfg(test)]
mod tests;

//! Free, slip+, slip−, stick: the discrete states of a joint, their guards and transitions.

use std::f64::consts::FRAC_PI_2;
use std::fmt;

use deltazero_solvers::real::{Length, Over};
use deltazero_solvers::rounding::ROUNDING;
use deltazero_solvers::{Next, Real};

use super::block::Block;
use super::body::{Body, Held};
use super::contact::{Onset, Rounding};
use super::friction::Extra;
use super::linkage::Linkage as _;
use super::sliding::Shape;
use super::state::State;

/// Guard: θ short of the 90° to which the drive turns, where the struts line up.
pub const GUARD_END: usize = 0;
/// Guard: on this side of the contact surface. Without adhesion a contact ends where it no longer presses: a law
/// with damping at F_N = 0, one with hysteresis at δ = 0 or at [`GUARD_RANGE`].
pub const GUARD_CONTACT: usize = 1;
/// Guard: slipping, v_T keeps its sign, or |v_T| above where its piece of friction begins; sticking, v̇_T under slip−
/// above zero, `s (μ F_N − F_T)` with s the sign of `∂v̇_T/∂F_T`; relaxing, δ > 0.
pub const GUARD_UPPER: usize = 2;
/// Guard: slipping, |v_T| below where its piece of friction ends; sticking, v̇_T under slip+ below zero,
/// `s (μ F_N + F_T)`.
pub const GUARD_LOWER: usize = 3;
/// Guard: in contact within the range of its law. Of a law with hysteresis and no adhesion `1 + χ δ̇/δ̇₋ > 0`,
/// the second factor of F_N; of a law that ends at a penetration `δ < δ_max`.
pub const GUARD_RANGE: usize = 4;
/// Number of guards of a joint.
///
/// No guard is a product of two quantities that may fall below zero within one step: the product would be positive
/// again, and the fall unseen.
pub const N_GUARDS: usize = 5;

/// Mode of a joint, with what its contact keeps of its beginning.
#[derive(Clone, Copy, PartialEq)]
pub enum Mode {
    /// No clearance: the pin is held at the centre of its bush.
    Pinned,
    /// Free, pin and bush apart: δ < 0.
    Apart,
    /// Free, the bush still dented: δ > 0 but F_N ≤ 0 without adhesion.
    Relaxing(Onset),
    /// Contact, v_T > 0.
    SlipPlus(Onset),
    /// Contact, v_T < 0.
    SlipMinus(Onset),
    /// Contact, v_T = 0.
    Stick(Onset),
}

impl Mode {
    /// As the files write it: 0 free, 1 and −1 the sign of v_T while slipping, 2 stick.
    pub fn code(self) -> i8 {
        match self {
            Self::Pinned | Self::Apart | Self::Relaxing(_) => 0,
            Self::SlipPlus(_) => 1,
            Self::SlipMinus(_) => -1,
            Self::Stick(_) => 2,
        }
    }

    /// Whether a contact force acts.
    pub fn is_contact(self) -> bool {
        matches!(self, Self::SlipPlus(_) | Self::SlipMinus(_) | Self::Stick(_))
    }

    /// Whether the pin sticks.
    pub fn sticks(self) -> bool {
        matches!(self, Self::Stick(_))
    }

    /// σ, the sign of v_T while slipping.
    pub fn sigma(self) -> Option<f64> {
        match self {
            Self::SlipPlus(_) => Some(1.0),
            Self::SlipMinus(_) => Some(-1.0),
            _ => None,
        }
    }

    /// What its contact keeps of its beginning, relaxing too.
    pub fn onset(self) -> Option<Onset> {
        match self {
            Self::Pinned | Self::Apart => None,
            Self::Relaxing(onset)
            | Self::SlipPlus(onset)
            | Self::SlipMinus(onset)
            | Self::Stick(onset) => Some(onset),
        }
    }

    /// The slipping mode with the sign of `v_t`.
    pub fn slip(v_t: f64, onset: Onset) -> Self {
        if v_t < 0.0 { Self::SlipMinus(onset) } else { Self::SlipPlus(onset) }
    }
}

impl fmt::Debug for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Pinned => "pinned",
            Self::Apart => "free",
            Self::Relaxing(_) => "free (relaxing)",
            Self::SlipPlus(_) => "slip+",
            Self::SlipMinus(_) => "slip-",
            Self::Stick(_) => "stick",
        })
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self, f)
    }
}

impl Block {
    /// The guards of `mode`: positive inside it, one where it does not use them.
    #[inline(always)]
    pub(super) fn guards_among<S: Real>(
        &self,
        held: Held<'_>,
        mode: Mode,
        y: &State<S>,
        extra: Extra<S>,
    ) -> [S; N_GUARDS] {
        let mut g = [S::cst(1.0); N_GUARDS];
        g[GUARD_END] = self.below_90(y);
        match mode {
            Mode::Pinned => {}
            // (ρ + c)(c − ρ): smooth at the bush's centre too.
            Mode::Apart => {
                let rho_sq = y[0] * y[0] + y[1] * y[1];
                g[GUARD_CONTACT] = -(rho_sq - self.clearance * self.clearance);
            }
            Mode::SlipPlus(_) | Mode::SlipMinus(_) if self.has_product(held) => {
                let rho = distance(y).rho.value;
                let along = rho_v_t(y, rho, self.pin_radius);
                g[GUARD_CONTACT] = rho - self.clearance;
                if let Some(left) = self.normal.elastic.before_deepest(rho - self.clearance) {
                    g[GUARD_RANGE] = left;
                }
                g[GUARD_UPPER] = if matches!(mode, Mode::SlipPlus(_)) { along } else { -along };
            }
            Mode::Relaxing(onset) => {
                let pose = self.pose(y);
                g[GUARD_CONTACT] = self.normal.relaxing_guard(pose.delta, pose.delta_dot, onset);
                g[GUARD_UPPER] = pose.delta;
            }
            Mode::SlipPlus(onset) | Mode::SlipMinus(onset) | Mode::Stick(onset) => {
                let pose = self.pose(y);
                g[GUARD_CONTACT] = self.normal.contact_guard(pose.delta, pose.delta_dot, onset);
                if let Some(left) = self.normal.range_guard(pose.delta, pose.delta_dot, onset) {
                    g[GUARD_RANGE] = left;
                }
                if let Some(sigma) = mode.sigma() {
                    let s = self.v_t_of(held, &pose, y) * sigma;
                    let [low, high] = self.sliding.span(onset.piece);
                    g[GUARD_UPPER] = s - low;
                    if high < f64::INFINITY {
                        g[GUARD_LOWER] = -(s - high);
                    }
                } else {
                    let normal = self.normal.force(pose.delta, pose.delta_dot, onset);
                    let (holding, per_force) = self.holding(held, y, &pose, onset, extra);
                    let sign = per_force.value().signum();
                    let most = normal * (sign * self.sliding.at_rest(self.mu));
                    g[GUARD_UPPER] = most - holding * sign;
                    g[GUARD_LOWER] = most + holding * sign;
                }
            }
        }
        g
    }

    /// Whether the guards of slipping are `δ` and `ρ v_T`, without a piece of friction that ends.
    #[inline(always)]
    pub(super) fn has_product(&self, held: Held<'_>) -> bool {
        self.normal.adhesion && matches!((self.sliding, held), (Shape::Constant, Held::Struts(_)))
    }

    /// `π/2 − sgn(M) θ` [rad] where the block ends at 90°. Under −M the motion is that under M with X and θ negated.
    #[inline(always)]
    fn below_90<S: Real>(&self, y: &State<S>) -> S {
        if self.stop_at_90 { -(y[2] * self.turns() - FRAC_PI_2) } else { S::cst(1.0) }
    }

    /// The sign of the drive torque, by which θ turns; 1 without one.
    #[inline(always)]
    pub(super) fn turns(&self) -> f64 {
        if self.torque < 0.0 { -1.0 } else { 1.0 }
    }

    /// How near the end of a run is: the smaller of [`below_90`](Self::below_90) and, in a contact whose law ends at a
    /// penetration, `1 − δ/δ_max`.
    #[inline(always)]
    pub(super) fn before_end<S: Real>(&self, mode: Mode, y: &State<S>) -> S {
        let below_90 = self.below_90(y);
        match self.normal.elastic.deepest() {
            Some(deepest) if mode.is_contact() => {
                let left = -(self.pose(y).delta / deepest) + 1.0;
                if left.value() < below_90.value() { left } else { below_90 }
            }
            _ => below_90,
        }
    }

    /// The penetration at `y` [m], where that is what ends a run there and not the angle.
    pub fn too_deep(&self, y: &State<f64>) -> Option<f64> {
        let delta = self.pose(y).delta;
        (self.normal.elastic.before_deepest(delta)? < self.below_90(y)).then_some(delta)
    }

    /// The sizes of the terms that make the pin's turning, added [rad/s].
    fn spin_bound(&self, y: &State<f64>) -> f64 {
        match &self.body {
            Body::Struts(_) => y[5].abs(),
            Body::Linkage(linkage) => linkage.spin_bound(y),
        }
    }

    /// Bounds of the guards' rounding errors.
    pub(super) fn guard_bounds_of(&self, mode: Mode, y: &State<f64>) -> [f64; N_GUARDS] {
        // Above zero without clearance and at rest too: a bound of zero would have an event sought to the last bit.
        let delta = delta_bound(self.clearance).max(f64::MIN_POSITIVE);
        let least = self.rounding_floor();
        let speed =
            (y[3].abs() + y[4].abs() + self.spin_bound(y) * self.pin_radius).max(least.speed);
        let area = (2.0 * self.clearance * delta).max(f64::MIN_POSITIVE);
        let mut bounds = [END_BOUND, area, delta, delta, ROUNDING];
        if let Some(onset) = mode.onset() {
            let (pose, has_product) = (self.pose(y), self.has_product(self.body.held()));
            let rounding = Rounding { delta, speed, least_force: least.force };
            let own = self.normal.guard_bounds([pose.delta, pose.delta_dot], onset, rounding);
            let is_relaxing = matches!(mode, Mode::Relaxing(_));
            bounds[GUARD_CONTACT] = if is_relaxing { own.relaxing } else { own.contact };
            bounds[GUARD_RANGE] = own.range;
            if mode.sigma().is_some() {
                let arm = if has_product { pose.rho } else { 1.0 };
                bounds[GUARD_UPPER] = arm * ROUNDING * speed;
                bounds[GUARD_LOWER] = ROUNDING * speed;
            } else if mode.sticks() {
                let drive = self.drive_force();
                let load = self.normal.force(pose.delta, pose.delta_dot, onset).abs() + drive;
                let friction =
                    own.force * (1.0 + self.sliding.at_rest(self.mu)) + 4.0 * ROUNDING * load;
                bounds[GUARD_UPPER] = friction;
                bounds[GUARD_LOWER] = friction;
            }
        }
        bounds
    }

    /// What follows when a guard of `mode` falls at `y`.
    pub(super) fn after<S: Real>(
        &self,
        mode: Mode,
        guard: usize,
        y: &mut State<S>,
        extra: Extra<S>,
    ) -> Next<Mode> {
        if guard == GUARD_END {
            return Next::Stop;
        }
        Next::Mode(match (mode, guard) {
            (Mode::Pinned, _) => Mode::Pinned,
            (Mode::Apart, _) => self.entered(y, extra),
            // The dent is that of the same contact.
            (Mode::Relaxing(onset), GUARD_CONTACT) => self.slipping(y, onset, extra),
            (Mode::Relaxing(_), _) => Mode::Apart,
            (
                Mode::SlipPlus(onset) | Mode::SlipMinus(onset) | Mode::Stick(onset),
                GUARD_CONTACT,
            ) => self.left(y, onset),
            (Mode::SlipPlus(onset) | Mode::SlipMinus(onset) | Mode::Stick(onset), GUARD_RANGE) => {
                if !self.normal.releases_by_factor() {
                    return Next::Stop;
                }
                self.left(y, onset)
            }
            (Mode::SlipPlus(onset), upper_or_lower) if self.is_between(onset, upper_or_lower) => {
                Mode::SlipPlus(neighbour(onset, upper_or_lower))
            }
            (Mode::SlipMinus(onset), upper_or_lower) if self.is_between(onset, upper_or_lower) => {
                Mode::SlipMinus(neighbour(onset, upper_or_lower))
            }
            (Mode::SlipPlus(onset) | Mode::SlipMinus(onset), _) => {
                self.reversed(mode, onset, y, extra)
            }
            (Mode::Stick(onset), upper_or_lower) => {
                self.project_v_t(y);
                Mode::slip(if upper_or_lower == GUARD_UPPER { -1.0 } else { 1.0 }, onset)
            }
        })
    }

    /// Whether the guard of a slip stands between two pieces of its friction, and not at v_T = 0.
    fn is_between(&self, onset: Onset, guard: usize) -> bool {
        guard == GUARD_LOWER || onset.piece > 0
    }

    /// The mode in which contact begins at `y`, with its speed of impact.
    pub(super) fn entered<S: Real>(&self, y: &State<S>, extra: Extra<S>) -> Mode {
        self.slipping(y, self.normal.onset(self.pose(y).delta_dot.value()), extra)
    }

    /// The slipping mode at `y`: the sign of v_T; where that is zero, the sign of the frictionless v̇_T.
    fn slipping<S: Real>(&self, y: &State<S>, onset: Onset, extra: Extra<S>) -> Mode {
        let pose = self.pose(y);
        let v_t = self.v_t(&pose, y).value();
        let onset = self.sliding.begun_at(v_t.abs(), onset);
        if v_t != 0.0 {
            return Mode::slip(v_t, onset);
        }
        let posture = self.body.held().at(y);
        Mode::slip(self.frictionless_v_t_dot(y, &posture, &pose, onset, extra).value(), onset)
    }

    /// The mode that a contact falls back to when its guard is violated at `y`.
    fn left<S: Real>(&self, y: &State<S>, onset: Onset) -> Mode {
        let leaves_dent = self.normal.leaves_dent(self.pose(y).delta);
        if leaves_dent { Mode::Relaxing(onset) } else { Mode::Apart }
    }

    /// What follows when v_T reaches zero at `y` while slipping in `mode`.
    ///
    /// With v̇⁺ and v̇⁻ the accelerations under slip+ and slip−: stick where `v̇⁺ ≤ 0 ≤ v̇⁻`, both
    /// leading back to zero; else, and where the law does not stick, on to the other sign. A. F. Filippov, *Differential Equations
    /// with Discontinuous Righthand Sides* (1988), §4.
    fn reversed<S: Real>(
        &self,
        mode: Mode,
        onset: Onset,
        y: &mut State<S>,
        extra: Extra<S>,
    ) -> Mode {
        if self.sliding.sticks() {
            let pose = self.pose(y);
            let plus = self.v_t_dot_in(Mode::SlipPlus(onset), y, &pose, extra);
            let minus = self.v_t_dot_in(Mode::SlipMinus(onset), y, &pose, extra);
            if plus <= 0.0 && 0.0 <= minus {
                self.project_v_t(y);
                return Mode::Stick(onset);
            }
        }
        match mode {
            Mode::SlipPlus(_) => Mode::SlipMinus(onset),
            _ => Mode::SlipPlus(onset),
        }
    }
}

/// Distance ρ [m] of the pin from the bush's centre, and δ̇ [m/s].
#[inline(always)]
pub(super) fn distance<S: Real>(y: &State<S>) -> Length<S> {
    S::length([y[0], y[1]], [y[3], y[4]])
}

/// `ρ v_T`: guards are evaluated at every step, and quotients are dear.
#[inline(always)]
pub(super) fn rho_v_t<S: Over<C>, C>(y: &State<S>, rho: S, pin_radius: C) -> S {
    y[1] * y[3] - y[0] * y[4] + rho * y[5] * pin_radius
}

/// `onset` in the next piece down or up.
fn neighbour(onset: Onset, guard: usize) -> Onset {
    let piece = if guard == GUARD_LOWER { onset.piece + 1 } else { onset.piece - 1 };
    Onset { piece, ..onset }
}

/// Rounding error of `π/2 − sgn(M) θ` near 90° [rad].
pub(super) const END_BOUND: f64 = ROUNDING * FRAC_PI_2;

/// Rounding error of `ρ − c` for ρ near c [m].
pub(super) fn delta_bound(clearance: f64) -> f64 {
    ROUNDING * clearance
}

#[cfg(test)]
mod tests;

//! One joint with what hangs on it: a hybrid system of six states.

use deltazero_solvers::real::Functions;
use deltazero_solvers::{Error, ModeOfState, Next, Outcome, Real, System};

use super::body::{Body, Held, Posture};
use super::contact::{NormalLaw, PinPose};
use super::inertia::{Arrow, BlockInertia};
use super::linkage::Linkage as _;
use super::linkages::AnyLinkage;
use super::mode::{END_BOUND, Mode, N_GUARDS, delta_bound, distance};
use super::plain_slip::PlainSlip;
use super::reading::Reading;
use super::sliding::Shape;
use super::state::State;

/// Penetration, in radii of the pin, from which on the run is taken to have diverged; a contact that is only too soft lets it
/// through by less.
const RUN_AWAY: f64 = 1e3;

/// A joint and what hangs on it.
///
/// Joint 1 and joint 2 of the struts differ in constants alone: with X = z02, Y = y02 the equations of joint 2
/// are those of joint 1.
#[derive(Clone, Debug)]
pub struct Block {
    /// Number of the joint, 1 or 2.
    pub joint: usize,
    /// Masses, and how they move.
    pub body: Body,
    /// Length `l` of a strut, or of the rod [m].
    pub strut_length: f64,
    /// Drive torque `M` on θ [N m]; zero where the drive holds a speed.
    pub torque: f64,
    /// Clearance `c` [m]; zero holds the pin.
    pub clearance: f64,
    /// Radius `r` of the pin, the arm of friction [m].
    pub pin_radius: f64,
    /// Normal force law.
    pub normal: NormalLaw,
    /// Coefficient `μ` of friction.
    pub mu: f64,
    /// How friction goes with the speed of sliding.
    pub sliding: Shape,
    /// Where the contact forces enter.
    pub reading: Reading,
    /// Whether the block ends at θ = 90°.
    pub stop_at_90: bool,
    /// `K`, where the law is `K δ + D δ̇` with Coulomb's friction and all of it acts at the pin, but for a
    /// torque of friction. It follows from the laws and the reading, and is settled where a block is made of
    /// them: every right-hand side would ask it anew.
    pub(super) plain_stiffness: Option<f64>,
}

/// Forces of one contact.
#[derive(Clone, Copy, Debug)]
pub struct ContactForces<S> {
    /// Normal force `F_N` [N].
    pub normal: S,
    /// Friction `F_T` [N], along `t = (n_Y, −n_X)` on the pin.
    pub tangential: S,
}

impl<S: Real> ContactForces<S> {
    /// A normal force without friction.
    pub(super) fn frictionless(normal: S) -> Self {
        Self { normal, tangential: S::cst(0.0) }
    }
}

impl Block {
    /// Pin displacement, velocity and their polar form.
    #[inline(always)]
    pub fn pose<S: Real>(&self, y: &State<S>) -> PinPose<S> {
        PinPose::new([y[0], y[1]], [y[3], y[4]], self.clearance)
    }

    /// Accelerations (Ẍ, Ÿ, and that of the turning pin) under a normal force and friction in the direction
    /// of `pose`.
    #[inline(always)]
    pub(super) fn accelerations<S: Real>(
        &self,
        y: &State<S>,
        posture: &Posture<'_, S>,
        pose: &PinPose<S>,
        forces: ContactForces<S>,
    ) -> [S; 3] {
        match posture {
            Posture::Struts(inertia, arrow) => {
                let loads = self.loads(inertia, y, arrow, pose, forces);
                inertia.accelerations(arrow, y[5] * y[5], loads)
            }
            Posture::Linkage(linkage, at) => {
                linkage.accelerations(at, Some(self.pin_load(pose, forces)))
            }
        }
    }

    /// (Ẍ, Ÿ, θ̈) of struts without contact.
    #[inline(always)]
    pub(super) fn free_accelerations<S: Real>(
        &self,
        inertia: &BlockInertia,
        y: &State<S>,
        arrow: &Arrow<S>,
    ) -> [S; 3] {
        let zero = S::cst(0.0);
        let along_x = if self.reading.centrifugal == 1.0 {
            zero
        } else {
            self.centrifugal_misprint(inertia, y, arrow)
        };
        inertia.accelerations(arrow, y[5] * y[5], [along_x, zero, S::cst(self.torque)])
    }

    /// Writes the rates of `y` where struts hang on the joint.
    #[inline(always)]
    fn strut_rates<S: Real>(
        &self,
        inertia: &BlockInertia,
        mode: Mode,
        y: &State<S>,
        dydt: &mut State<S>,
    ) {
        let zero = S::cst(0.0);
        *dydt = match mode {
            Mode::Pinned => {
                let (sin, cos) = y[2].sin_cos();
                let i_c = inertia.about_pin(0.0, 1.0) - inertia.about_pin(1.0, 0.0);
                let moment = sin * cos * y[5] * y[5] * i_c + self.torque;
                let about_pin = inertia.about_pin(sin, cos);
                [zero, zero, y[5], zero, zero, moment / about_pin]
            }
            Mode::Apart | Mode::Relaxing(_) if self.reading.centrifugal == 1.0 => {
                let turning = inertia.turning([y[2], y[5]]);
                let moment = inertia.turning_moment(&turning) + self.torque;
                let a = inertia.motion(turning, [zero; 2], moment);
                [y[3], y[4], y[5], a[0], a[1], a[2]]
            }
            Mode::Apart | Mode::Relaxing(_) => {
                let a = self.free_accelerations(inertia, y, &inertia.at(y[2]));
                [y[3], y[4], y[5], a[0], a[1], a[2]]
            }
            Mode::SlipPlus(_) | Mode::SlipMinus(_) | Mode::Stick(_) => {
                if let (Some(stiffness), Some(sigma)) = (self.plain_stiffness, mode.sigma()) {
                    let slip = PlainSlip::new(self, inertia, stiffness, sigma);
                    return slip.rates(y, &distance(y), dydt);
                }
                let posture = Posture::Struts(inertia, inertia.at(y[2]));
                let pose = self.pose(y);
                let forces = self.forces_among(Held::Struts(inertia), mode, y, &pose, None);
                let a = self.accelerations(y, &posture, &pose, forces);
                [y[3], y[4], y[5], a[0], a[1], a[2]]
            }
        };
    }

    /// (Ẍ, Ÿ) where a linkage hangs on the joint.
    fn linkage_accelerations<S: Real>(
        &self,
        linkage: &AnyLinkage,
        mode: Mode,
        y: &State<S>,
    ) -> [S; 2] {
        let zero = S::cst(0.0);
        let [a_x, a_y, _] = match mode {
            Mode::Pinned => [zero; 3],
            Mode::Apart | Mode::Relaxing(_) => linkage.accelerations(&linkage.at(y), None),
            Mode::SlipPlus(_) | Mode::SlipMinus(_) | Mode::Stick(_) => {
                let (pose, held) = (self.pose(y), Held::Linkage(linkage));
                let load = self.pin_load(&pose, self.forces_among(held, mode, y, &pose, None));
                linkage.accelerations(&linkage.at(y), Some(load))
            }
        };
        [a_x, a_y]
    }

    /// The rates of `y` where a linkage hangs on the joint: the crank keeps its speed.
    #[inline(always)]
    pub(super) fn linkage_rates<S: Real>(
        &self,
        linkage: &AnyLinkage,
        mode: Mode,
        y: &State<S>,
    ) -> State<S> {
        // Apart: beside the struts' it would slow their series.
        let [a_x, a_y] = S::all_outlined(*y, &OfLinkage { block: self, linkage, mode });
        [y[3], y[4], y[5], a_x, a_y, S::cst(0.0)]
    }

    /// In the order of the paper's coordinates: joint 1 (x01, y01, θ1, …), joint 2 (y02, z02, θ2, …).
    pub fn in_paper_order(&self, y: &State<f64>) -> State<f64> {
        let [x, y_, theta, v_x, v_y, omega] = *y;
        if self.joint == 1 { *y } else { [y_, x, theta, v_y, v_x, omega] }
    }

    /// Whether the contact can carry what the drive alone asks of it, `M/l`.
    ///
    /// # Errors
    /// [`Error::Refused`]: the law never has that force.
    pub fn check_load(&self) -> Result<(), Error> {
        let (most, least) =
            (self.normal.elastic.strongest(), self.torque.abs() / self.strut_length);
        if self.clearance == 0.0 || most > least {
            return Ok(());
        }
        let reason = format!(
            "contact.law carries at most {most:.3e} N, the drive presses with {least:.3e} N; take a longer \
             contact, a stiffer material, or a larger clearance"
        );
        Err(Error::Refused { reason })
    }

    /// `outcome` of a run that ended at `(t, y)`; an error where what stopped it was not 90° but the range of
    /// the contact law, and another one where a run fails with the pin deep in its bush.
    pub fn range_judged(
        &self,
        outcome: Result<Outcome, Error>,
        t: f64,
        mode: Mode,
        y: &State<f64>,
    ) -> Result<Outcome, Error> {
        match (&outcome, self.too_deep(y)) {
            (Ok(Outcome::Stopped), Some(delta)) => {
                let most = self.normal.elastic.strongest();
                let reason = format!(
                    "penetration δ = {delta:.6e} m is where contact.law ends, at {most:.3e} N; take a longer \
                     contact, a stiffer material, or a larger clearance"
                );
                Err(Error::OutsideModel { t, mode: mode.to_string(), reason })
            }
            (Err(error), None) if mode.is_contact() && self.pose(y).delta > self.pin_radius => {
                let delta = self.pose(y).delta;
                // A contact that is too soft lets the pin through; a run without bound is the method's.
                let way_out = if delta < RUN_AWAY * self.pin_radius {
                    "take a stiffer contact"
                } else {
                    "take a shorter step or a tighter tolerance, and if that does not help a stiffer contact"
                };
                let reason = format!(
                    "penetration δ = {delta:.6e} m is deeper than the pin's radius of {} m, where no law of contact means \
                     anything ({error}); {way_out}",
                    self.pin_radius
                );
                Err(Error::OutsideModel { t, mode: mode.to_string(), reason })
            }
            _ => outcome,
        }
    }

    /// Whether a contact begins between these modes at the floor of the impact speed or below it.
    pub fn begins_at_floor(&self, before: Mode, after: Mode) -> bool {
        let floor = self.normal.impact_speed_floor;
        before == Mode::Apart && after.onset().is_some_and(|onset| onset.impact_speed <= floor)
    }

    /// Whether it starts on δ = 0, where the first event's time has no digits.
    pub fn starts_in_contact(&self) -> bool {
        matches!(self.body, Body::Struts(_)) && self.clearance > 0.0
    }

    /// The start. Of struts that of the paper: X = 0, Y = −c, θ = 0, at rest. Of a linkage that of the
    /// mechanism without clearance: the pin in the middle of the bush, moving with it.
    pub fn initial_state(&self) -> State<f64> {
        match &self.body {
            Body::Struts(_) => [0.0, -self.clearance, 0.0, 0.0, 0.0, 0.0],
            Body::Linkage(linkage) => [0.0, 0.0, linkage.start(), 0.0, 0.0, linkage.speed()],
        }
    }
}

/// Functions of a state where a linkage hangs on the joint; not inlined, for the sake of the struts'.
struct OfLinkage<'a> {
    block: &'a Block,
    linkage: &'a AnyLinkage,
    mode: Mode,
}

/// (Ẍ, Ÿ).
impl Functions<6, 2> for OfLinkage<'_> {
    #[inline(never)]
    fn of<S: Real>(&self, y: State<S>) -> [S; 2] {
        self.block.linkage_accelerations(self.linkage, self.mode, &y)
    }
}

/// The guards.
impl Functions<6, N_GUARDS> for OfLinkage<'_> {
    #[inline(never)]
    fn of<S: Real>(&self, y: State<S>) -> [S; N_GUARDS] {
        self.block.guards_among(Held::Linkage(self.linkage), self.mode, &y, None)
    }
}

impl ModeOfState for Block {
    fn mode_of_state<S: Real>(&self, _t: S, y: &State<S>) -> Mode {
        if self.clearance == 0.0 {
            return Mode::Pinned;
        }
        let pose = self.pose(y);
        // A pin at the very centre has no direction, and is apart.
        if pose.delta.value() > 0.0 {
            let onset = self.normal.onset(pose.delta_dot.value());
            if self.normal.touches(pose.delta, pose.delta_dot, onset) {
                self.entered(y, None)
            } else {
                Mode::Relaxing(onset)
            }
        } else {
            Mode::Apart
        }
    }

    fn end<S: Real>(&self, t: S, y: &State<S>) -> S {
        self.before_end(self.mode_of_state(t, y), y)
    }

    fn end_bound(&self) -> f64 {
        END_BOUND
    }
}

impl System for Block {
    type Mode = Mode;
    type State<S: Real> = State<S>;
    type Guards<S: Real> = [S; N_GUARDS];

    /// As [`mode_of_state`](ModeOfState::mode_of_state); a start on the surface, to rounding, is free.
    fn initial_mode(&self, t: f64, y: &State<f64>) -> Mode {
        let on_surface = self.pose(y).delta.abs() <= delta_bound(self.clearance);
        if on_surface && self.clearance > 0.0 { Mode::Apart } else { self.mode_of_state(t, y) }
    }

    #[inline(always)]
    fn rhs<S: Real>(&self, mode: Mode, _t: S, y: &State<S>, dydt: &mut State<S>) {
        match &self.body {
            Body::Struts(inertia) => self.strut_rates(inertia, mode, y, dydt),
            Body::Linkage(linkage) => *dydt = self.linkage_rates(linkage, mode, y),
        }
    }

    #[inline(always)]
    fn guards<S: Real>(&self, mode: Mode, _t: S, y: &State<S>, g: &mut [S; N_GUARDS]) {
        match &self.body {
            Body::Struts(inertia) => *g = self.guards_among(Held::Struts(inertia), mode, y, None),
            Body::Linkage(linkage) => {
                *g = S::all_outlined(*y, &OfLinkage { block: self, linkage, mode });
            }
        }
    }

    /// Rates and guards of a plain slip share its distance.
    #[inline(always)]
    fn rhs_with_guards<S: Real>(
        &self,
        mode: Mode,
        _t: S,
        y: &State<S>,
        dydt: &mut State<S>,
        g: &mut [S; N_GUARDS],
    ) -> bool {
        let Some(slip) = self.plain_slip(mode) else { return false };
        slip.rates_with_guards(y, dydt, g);
        true
    }

    fn guard_bounds(&self, mode: Mode, _t: f64, y: &State<f64>, bounds: &mut [f64; N_GUARDS]) {
        *bounds = self.guard_bounds_of(mode, y);
    }

    fn transition<S: Real>(&self, mode: Mode, guard: usize, _t: S, y: &mut State<S>) -> Next<Mode> {
        self.after(mode, guard, y, None)
    }

    fn jacobian(
        &self,
        mode: Mode,
        _t: f64,
        y: &State<f64>,
        mut entry: impl FnMut(usize, usize, f64),
    ) {
        for (i, row) in self.jacobian_rows(mode, y).iter().enumerate() {
            for (j, value) in row.iter().enumerate() {
                entry(i, j, *value);
            }
        }
    }

    fn time_derivative(&self, _mode: Mode, _t: f64, _y: &State<f64>, dfdt: &mut State<f64>) {
        *dfdt = [0.0; 6];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keys::test_defaults::table1;
    use crate::model::contact::Onset;
    use crate::model::struts::struts;

    #[test]
    fn guard_bounds_are_above_zero_at_rest_in_every_mode() {
        let mut config = table1();
        for exponent in [1.0, 1.5] {
            for adhesion in [true, false] {
                for joint in &mut config.joints {
                    joint.contact.exponent = exponent;
                    joint.contact.adhesion = adhesion;
                    joint.contact.damping = 0.0;
                }
                config.drive.m1 = 0.0;
                for block in &struts(&config) {
                    use Mode::{Apart, Relaxing, SlipMinus, SlipPlus, Stick};
                    let in_contact = [Relaxing, SlipPlus, SlipMinus, Stick];
                    let in_contact = in_contact.map(|mode| mode(Onset::PLAIN));
                    for mode in [Apart].into_iter().chain(in_contact) {
                        let bounds = block.guard_bounds_of(mode, &block.initial_state());
                        assert!(bounds.iter().all(|bound| *bound > 0.0), "{mode}: {bounds:?}");
                    }
                }
            }
        }
    }
}

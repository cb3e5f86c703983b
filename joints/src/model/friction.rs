//! Tangential velocity, friction, and the force that sticking takes.

use deltazero_solvers::Real;

use super::block::{Block, ContactForces};
use super::body::{Body, Held, Posture};
use super::contact::{Onset, PinPose};
use super::linkage::Linkage as _;
use super::mode::Mode;
use super::sliding::Shape;
use super::state::State;

/// Accelerations (Ẍ, Ÿ, θ̈) that neighbours in a chain add to a block's own; none where it has none.
pub(super) type Extra<S> = Option<[S; 3]>;

#[inline(always)]
fn with<S: Real>(extra: Extra<S>, [x, y, theta]: [S; 3]) -> [S; 3] {
    match extra {
        Some(extra) => [x + extra[0], y + extra[1], theta + extra[2]],
        None => [x, y, theta],
    }
}

impl Block {
    /// `v_T = t·v + θ̇ r` [m/s], of a linkage its [spin](super::linkage::Linkage::spin) for θ̇: tangential velocity of the
    /// pin's surface against that of the bush at the contact point.
    #[inline(always)]
    pub fn v_t<S: Real>(&self, pose: &PinPose<S>, y: &State<S>) -> S {
        self.v_t_of(self.body.held(), pose, y)
    }

    #[inline(always)]
    pub(super) fn v_t_of<S: Real>(&self, held: Held<'_>, pose: &PinPose<S>, y: &State<S>) -> S {
        pose.w([y[3], y[4]]) + held.spin(y) * self.pin_radius
    }

    /// The forces of a contact in `mode`: `F_N` of the normal law, and `F_T = −σ m F_N` slipping,
    /// `F_T` of `v̇_T = 0` sticking; none where the mode is no contact.
    #[inline(always)]
    pub fn forces<S: Real>(&self, mode: Mode, y: &State<S>, pose: &PinPose<S>) -> ContactForces<S> {
        self.forces_among(self.body.held(), mode, y, pose, None)
    }

    /// As [`forces`](Self::forces) where neighbours add the accelerations `extra`.
    #[inline(always)]
    pub(super) fn forces_among<S: Real>(
        &self,
        held: Held<'_>,
        mode: Mode,
        y: &State<S>,
        pose: &PinPose<S>,
        extra: Extra<S>,
    ) -> ContactForces<S> {
        let (Some(onset), true) = (mode.onset(), mode.is_contact()) else {
            return ContactForces::frictionless(S::cst(0.0));
        };
        let normal = self.normal.force(pose.delta, pose.delta_dot, onset);
        let tangential = match mode.sigma() {
            Some(sigma) if matches!(self.sliding, Shape::Constant) => normal * (-sigma * self.mu),
            Some(sigma) => {
                let s = self.v_t_of(held, pose, y) * sigma;
                normal * self.sliding.ratio(self.mu, onset.piece, s) * -sigma
            }
            None => self.holding(held, y, pose, onset, extra).0,
        };
        ContactForces { normal, tangential }
    }

    /// `F_T` that keeps `v̇_T = 0` [N], and `∂v̇_T/∂F_T` [1/kg], which is below zero where a torque of friction moves the
    /// pin more than it turns it.
    #[inline(always)]
    pub(super) fn holding<S: Real>(
        &self,
        held: Held<'_>,
        y: &State<S>,
        pose: &PinPose<S>,
        onset: Onset,
        extra: Extra<S>,
    ) -> (S, S) {
        let posture = held.at(y);
        let (per_force, _) = self.friction_response(&posture, pose);
        (-(self.frictionless_v_t_dot(y, &posture, pose, onset, extra) / per_force), per_force)
    }

    /// `v̇_T` under the accelerations `a` [m/s²], the third that of the turning pin.
    ///
    /// ```text
    /// v̇_T = t·(Ẍ, Ÿ) − (t·v) δ̇/ρ + θ̈ r
    /// ```
    #[inline(always)]
    fn v_t_dot<S: Real>(&self, y: &State<S>, pose: &PinPose<S>, a: [S; 3]) -> S {
        let w = pose.w([y[3], y[4]]);
        pose.n[1] * a[0] - pose.n[0] * a[1] - w * pose.delta_dot / pose.rho + a[2] * self.pin_radius
    }

    /// `v̇_T` under the normal force alone.
    #[inline(always)]
    pub(super) fn frictionless_v_t_dot<S: Real>(
        &self,
        y: &State<S>,
        posture: &Posture<'_, S>,
        pose: &PinPose<S>,
        onset: Onset,
        extra: Extra<S>,
    ) -> S {
        let normal = self.normal.force(pose.delta, pose.delta_dot, onset);
        let forces = ContactForces::frictionless(normal);
        self.v_t_dot(y, pose, with(extra, self.accelerations(y, posture, pose, forces)))
    }

    /// `∂v̇_T/∂F_T` [1/kg], and the accelerations that a unit of `F_T` adds.
    #[inline(always)]
    pub(super) fn friction_response<S: Real>(
        &self,
        posture: &Posture<'_, S>,
        pose: &PinPose<S>,
    ) -> (S, [S; 3]) {
        let on_pin = self.reading.tangential_force;
        let load = [pose.n[1] * on_pin, -(pose.n[0] * on_pin), S::cst(self.pin_radius)];
        let a = match posture {
            Posture::Struts(inertia, arrow) => inertia.accelerations(arrow, S::cst(0.0), load),
            Posture::Linkage(linkage, at) => linkage.response(at, load),
        };
        (pose.n[1] * a[0] - pose.n[0] * a[1] + a[2] * self.pin_radius, a)
    }

    /// `v̇_T` in the contact mode `mode`.
    pub(super) fn v_t_dot_in<S: Real>(
        &self,
        mode: Mode,
        y: &State<S>,
        pose: &PinPose<S>,
        extra: Extra<S>,
    ) -> f64 {
        let held = self.body.held();
        let forces = self.forces_among(held, mode, y, pose, extra);
        let a = self.accelerations(y, &held.at(y), pose, forces);
        self.v_t_dot(y, pose, with(extra, a)).value()
    }

    /// Makes v_T zero, to rounding, by changing the velocity of the pin's centre along t.
    pub(super) fn project_v_t<S: Real>(&self, y: &mut State<S>) {
        let pose = self.pose(y);
        let v_t = self.v_t(&pose, y);
        let along_t = match &self.body {
            Body::Struts(_) => v_t,
            // What hangs on the pin turns with its velocity.
            Body::Linkage(linkage) => {
                let t = [pose.n[1], -pose.n[0]];
                v_t / (linkage.turned_along(&linkage.at(y), t, self.pin_radius) + 1.0)
            }
        };
        y[3] = y[3] - pose.n[1] * along_t;
        y[4] = y[4] + pose.n[0] * along_t;
    }
}

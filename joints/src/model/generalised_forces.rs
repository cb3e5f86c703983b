//! Generalised forces, Eqs. (9) and (12) to (17) of the paper as a [`Reading`](super::reading::Reading) has them; its
//! equations stand there.

use deltazero_solvers::Real;

use super::block::{Block, ContactForces};
use super::contact::PinPose;
use super::inertia::{Arrow, BlockInertia};
use super::state::State;

impl Block {
    /// The force on the pin and the torque of friction.
    #[inline(always)]
    pub(super) fn pin_load<S: Real>(&self, pose: &PinPose<S>, forces: ContactForces<S>) -> [S; 3] {
        let ([n_x, n_y], ContactForces { normal, tangential }) = (pose.n, forces);
        [
            n_y * tangential - n_x * normal,
            -(n_y * normal) - n_x * tangential,
            tangential * self.pin_radius,
        ]
    }

    /// (Q_X, Q_Y, Q_θ) on struts, as their [`Reading`](super::reading::Reading) has them.
    #[inline(always)]
    pub(super) fn loads<S: Real>(
        &self,
        inertia: &BlockInertia,
        y: &State<S>,
        arrow: &Arrow<S>,
        pose: &PinPose<S>,
        forces: ContactForces<S>,
    ) -> [S; 3] {
        let ContactForces { normal, tangential } = forces;
        let [n_x, n_y] = pose.n;
        let on_pin = tangential * self.reading.tangential_force;
        let [along_cos, along_sin] = self.reading.normal_moment;
        let mut q = [
            n_y * on_pin - n_x * normal + self.centrifugal_misprint(inertia, y, arrow),
            -(n_y * normal) - n_x * on_pin,
            tangential * self.pin_radius + self.torque,
        ];
        if self.reading.normal_moment != [0.0, 0.0] {
            let arm = arrow.cos * n_x * along_cos + arrow.sin * n_y * along_sin;
            q[2] = q[2] + arm * normal * (0.5 * self.strut_length);
        }
        q
    }

    /// `(κ − 1) S_x sin θ θ̇²` [N]: zero where the centrifugal term is as derived.
    #[inline(always)]
    pub(super) fn centrifugal_misprint<S: Real>(
        &self,
        inertia: &BlockInertia,
        y: &State<S>,
        arrow: &Arrow<S>,
    ) -> S {
        let s_x = inertia.m_x * inertia.p;
        arrow.sin * y[5] * y[5] * (s_x * (self.reading.centrifugal - 1.0))
    }
}

//! The Jacobian of a block: of struts in closed form, of a linkage by dual numbers.

use num_dual::Dual64;

use super::block::{Block, ContactForces};
use super::body::{Body, Posture};
use super::contact::{Onset, PinPose};
use super::inertia::BlockInertia;
use super::linkages::AnyLinkage;
use super::mode::Mode;
use super::state::State;

/// A gradient with respect to the six states.
pub(super) type Gradient = [f64; 6];

pub(super) fn gradient(entry: impl FnMut(usize) -> f64) -> Gradient {
    std::array::from_fn(entry)
}

/// Gradients of a pin's polar form; see [`PinPose`].
pub(super) struct PoseGradient {
    pub(super) n: [Gradient; 2],
    delta: Gradient,
    delta_dot: Gradient,
    w: Gradient,
}

/// Gradients of a contact whose F_T, where it sticks, is held.
pub(super) struct FrozenContact {
    /// `t·v` [m/s].
    w: f64,
    pub(super) pose: PoseGradient,
    /// `∇F_N`.
    pub(super) normal: Gradient,
    /// `∇(Ẍ, Ÿ, θ̈)`.
    pub(super) accelerations: [Gradient; 3],
}

impl PoseGradient {
    /// With `t = (n_Y, −n_X)`: `∂n/∂d = t tᵀ/ρ`, `∂t/∂d = −n tᵀ/ρ`, and so
    ///
    /// ```text
    /// ∂δ/∂d = n,   ∂δ̇/∂d = (w/ρ) t,   ∂δ̇/∂v = n,   ∂w/∂d = −(δ̇/ρ) t,   ∂w/∂v = t
    /// ```
    fn new(pose: &PinPose<f64>, w: f64) -> Self {
        let PinPose { n, rho, delta_dot, .. } = *pose;
        let t = [n[1], -n[0]];
        let turned = |i: usize, scale: f64| [t[0] * t[i] / rho * scale, t[1] * t[i] / rho * scale];
        let on = |d: [f64; 2], v: [f64; 2]| [d[0], d[1], 0.0, v[0], v[1], 0.0];
        let nothing = [0.0, 0.0];
        Self {
            n: [on(turned(0, 1.0), nothing), on(turned(1, 1.0), nothing)],
            delta: on(n, nothing),
            delta_dot: on([t[0] * w / rho, t[1] * w / rho], n),
            w: on([-t[0] * delta_dot / rho, -t[1] * delta_dot / rho], t),
        }
    }
}

impl Block {
    /// `∂(ẏ_i)/∂(y_j)` in `mode`, row by row.
    pub(super) fn jacobian_rows(&self, mode: Mode, y: &State<f64>) -> [[f64; 6]; 6] {
        match &self.body {
            Body::Struts(inertia) => self.strut_jacobian(inertia, mode, y),
            Body::Linkage(linkage) => self.linkage_jacobian(linkage, mode, y),
        }
    }

    /// Six evaluations of the rates, exact to rounding.
    fn linkage_jacobian(&self, linkage: &AnyLinkage, mode: Mode, y: &State<f64>) -> [[f64; 6]; 6] {
        let mut rows = [[0.0; 6]; 6];
        for j in 0..6 {
            let seeded = std::array::from_fn(|i| Dual64::new(y[i], if i == j { 1.0 } else { 0.0 }));
            let rates = self.linkage_rates(linkage, mode, &seeded);
            for (row, rate) in rows.iter_mut().zip(rates) {
                row[j] = rate.eps;
            }
        }
        rows
    }

    pub(super) fn strut_jacobian(
        &self,
        inertia: &BlockInertia,
        mode: Mode,
        y: &State<f64>,
    ) -> [[f64; 6]; 6] {
        let unit = |i: usize| gradient(|j| if i == j { 1.0 } else { 0.0 });
        let [a_x, a_y, a_theta] = match mode {
            Mode::Pinned => {
                let nothing = [0.0; 6];
                let pinned = self.pinned_gradient(inertia, y);
                return [nothing, nothing, unit(5), nothing, nothing, pinned];
            }
            Mode::Apart | Mode::Relaxing(_) => {
                let none = ContactForces { normal: 0.0, tangential: 0.0 };
                // Without force any direction serves; the pin may be at the centre.
                let pose = PinPose::new([0.0, -self.clearance], [0.0, 0.0], self.clearance);
                let still = PoseGradient::new(&pose, 0.0);
                self.gradients(inertia, y, &pose, &still, none, [[0.0; 6]; 2])
            }
            Mode::SlipPlus(onset) | Mode::SlipMinus(onset) | Mode::Stick(onset) => {
                self.contact_gradients(inertia, mode, onset, y)
            }
        };
        [unit(3), unit(4), unit(5), a_x, a_y, a_theta]
    }

    /// `∇θ̈` with the pin held: `θ̈ = (M + I_c sin θ cos θ θ̇²)/(I_0 + I_c cos²θ)`.
    fn pinned_gradient(&self, inertia: &BlockInertia, y: &State<f64>) -> Gradient {
        let (sin, cos) = libm::sincos(y[2]);
        let i_c = inertia.about_pin(0.0, 1.0) - inertia.about_pin(1.0, 0.0);
        let about_pin = inertia.about_pin(sin, cos);
        let theta_dd = (self.torque + i_c * sin * cos * y[5] * y[5]) / about_pin;
        let by_theta =
            i_c * (cos * cos - sin * sin) * y[5] * y[5] + 2.0 * i_c * sin * cos * theta_dd;
        [0.0, 0.0, by_theta / about_pin, 0.0, 0.0, 2.0 * i_c * sin * cos * y[5] / about_pin]
    }

    fn contact_gradients(
        &self,
        inertia: &BlockInertia,
        mode: Mode,
        onset: Onset,
        y: &State<f64>,
    ) -> [Gradient; 3] {
        let pose = self.pose(y);
        let forces = self.forces(mode, y, &pose);
        let contact = self.frozen_contact(inertia, (mode, onset), y, &pose, forces);
        if mode.sigma().is_some() {
            return contact.accelerations;
        }
        let posture = Posture::Struts(inertia, inertia.at(y[2]));
        let a = self.accelerations(y, &posture, &pose, forces);
        let v_t_dot = self.v_t_dot_gradient(&pose, &contact, a, &contact.accelerations);
        let by = self.stuck_response(&posture, &pose, v_t_dot);
        std::array::from_fn(|i| gradient(|j| contact.accelerations[i][j] - by[i][j]))
    }

    /// The gradients of a contact, F_T held where it sticks.
    pub(super) fn frozen_contact(
        &self,
        inertia: &BlockInertia,
        (mode, onset): (Mode, Onset),
        y: &State<f64>,
        pose: &PinPose<f64>,
        forces: ContactForces<f64>,
    ) -> FrozenContact {
        let w = pose.w([y[3], y[4]]);
        let d = PoseGradient::new(pose, w);
        let [slope, damping] = self.normal.gradient(pose.delta, pose.delta_dot, onset);
        let normal = gradient(|j| slope * d.delta[j] + damping * d.delta_dot[j]);
        let tangential = mode.sigma().map_or([0.0; 6], |sigma| {
            let s = sigma * self.v_t(pose, y);
            let ratio = self.sliding.ratio(self.mu, onset.piece, s);
            let slope = self.sliding.slope(self.mu, onset.piece, s);
            // s = σ v_T and F_T = −σ m(s) F_N: ∇F_T = −σ m ∇F_N − m' F_N ∇v_T.
            gradient(|j| {
                let v_t = d.w[j] + if j == 5 { self.pin_radius } else { 0.0 };
                -sigma * ratio * normal[j] - slope * forces.normal * v_t
            })
        });
        let accelerations = self.gradients(inertia, y, pose, &d, forces, [normal, tangential]);
        FrozenContact { w, pose: d, normal, accelerations }
    }

    /// `∇v̇_T` at the accelerations `a` with the gradients `by`.
    pub(super) fn v_t_dot_gradient(
        &self,
        pose: &PinPose<f64>,
        contact: &FrozenContact,
        a: [f64; 3],
        by: &[Gradient; 3],
    ) -> Gradient {
        let (w, d) = (contact.w, &contact.pose);
        gradient(|j| {
            let along_t = pose.n[1] * by[0][j] - pose.n[0] * by[1][j];
            let turning = d.n[1][j] * a[0] - d.n[0][j] * a[1];
            let curving = (d.w[j] * pose.delta_dot + w * d.delta_dot[j]
                - w * pose.delta_dot / pose.rho * d.delta[j])
                / pose.rho;
            along_t + turning - curving + self.pin_radius * by[2][j]
        })
    }

    /// What sticking takes from the gradients of the accelerations: F_T follows from v̇_T = 0, so
    /// `∇F_T = −∇v̇_T|F_T / (∂v̇_T/∂F_T)`.
    pub(super) fn stuck_response(
        &self,
        posture: &Posture<'_, f64>,
        pose: &PinPose<f64>,
        v_t_dot: Gradient,
    ) -> [Gradient; 3] {
        let (by_force, response) = self.friction_response(posture, pose);
        std::array::from_fn(|i| gradient(|j| response[i] * v_t_dot[j] / by_force))
    }

    /// `∇(Ẍ, Ÿ, θ̈)` given those of pose, F_N and F_T: the closed-form solution of
    /// [`BlockInertia::accelerations`](super::inertia::BlockInertia::accelerations),
    /// differentiated term by term.
    fn gradients(
        &self,
        inertia: &BlockInertia,
        y: &State<f64>,
        pose: &PinPose<f64>,
        d: &PoseGradient,
        forces: ContactForces<f64>,
        [normal, tangential]: [Gradient; 2],
    ) -> [Gradient; 3] {
        let reading = &self.reading;
        let arrow = inertia.at(y[2]);
        let (sin, cos) = (arrow.sin, arrow.cos);
        let (omega, omega_sq) = (y[5], y[5] * y[5]);
        let q = self.loads(inertia, y, &arrow, pose, forces);
        let [_, _, theta_dd] = inertia.accelerations(&arrow, omega_sq, q);
        let schur = inertia.schur(cos);

        let phi = reading.tangential_force;
        let half = 0.5 * self.strut_length;
        let [along_cos, along_sin] = reading.normal_moment;
        let arm = half * (along_cos * cos * pose.n[0] + along_sin * sin * pose.n[1]);
        let printed = inertia.m_x * inertia.p * (reading.centrifugal - 1.0);

        let columns: [[f64; 3]; 6] = std::array::from_fn(|j| {
            let d_sin = if j == 2 { cos } else { 0.0 };
            let d_cos = if j == 2 { -sin } else { 0.0 };
            let d_omega_sq = if j == 5 { 2.0 * omega } else { 0.0 };
            let [d_nx, d_ny] = [d.n[0][j], d.n[1][j]];
            let d_q_x = phi * (tangential[j] * pose.n[1] + forces.tangential * d_ny)
                - normal[j] * pose.n[0]
                - forces.normal * d_nx
                + printed * (d_sin * omega_sq + sin * d_omega_sq);
            let d_q_y = -normal[j] * pose.n[1]
                - forces.normal * d_ny
                - phi * (tangential[j] * pose.n[0] + forces.tangential * d_nx);
            let d_arm = half
                * (along_cos * (d_cos * pose.n[0] + cos * d_nx)
                    + along_sin * (d_sin * pose.n[1] + sin * d_ny));
            let d_q_theta =
                d_arm * forces.normal + arm * normal[j] + tangential[j] * self.pin_radius;
            let d_moment = d_q_theta
                + inertia.j_c * ((d_sin * cos + sin * d_cos) * omega_sq + sin * cos * d_omega_sq)
                - inertia.p * (d_cos * q[0] + cos * d_q_x)
                + inertia.q * (d_sin * q[1] + sin * d_q_y);
            let d_theta = (d_moment - theta_dd * 2.0 * inertia.j_c * cos * d_cos) / schur;
            let d_x = inertia.p
                * (d_sin * omega_sq + sin * d_omega_sq - d_cos * theta_dd - cos * d_theta);
            let d_y = inertia.q
                * (d_cos * omega_sq + cos * d_omega_sq + d_sin * theta_dd + sin * d_theta);
            [d_x + d_q_x / inertia.m_x, d_y + d_q_y / inertia.m_y, d_theta]
        });
        std::array::from_fn(|i| gradient(|j| columns[j][i]))
    }
}

#[cfg(test)]
mod tests {
    use deltazero_solvers::System;
    use num_dual::Dual64;

    use super::*;
    use crate::keys::test_defaults::table1;
    use crate::keys::{FrictionLaw, ReadingName, Shared};
    use crate::laws::ContactLaw;
    use crate::model::struts::struts;

    fn modes(onset: Onset) -> [Mode; 5] {
        use Mode::{Apart, Pinned, SlipMinus, SlipPlus, Stick};
        [Pinned, Apart, SlipPlus(onset), SlipMinus(onset), Stick(onset)]
    }

    /// The column of dual numbers, from the generic right-hand side.
    fn dual_column(block: &Block, mode: Mode, y: &State<f64>, j: usize) -> [f64; 6] {
        let seeded = std::array::from_fn(|i| Dual64::new(y[i], if i == j { 1.0 } else { 0.0 }));
        let mut dydt = [Dual64::from_re(0.0); 6];
        block.rhs(mode, Dual64::from_re(0.0), &seeded, &mut dydt);
        dydt.map(|d| d.eps)
    }

    /// Every entry in every mode of both joints, at states of slight and deep contact.
    fn agrees(config: &Shared) {
        let states = [
            [2e-5, -9.9e-5, 0.01, 2e-3, 1e-3, 0.02],
            [-9e-5, -5e-5, 0.7, -1e-3, 3e-3, 0.3],
            [6e-5, 8.1e-5, 1.5, 1e-3, -2e-3, -0.4],
        ];
        let (reading, law) = (config.reading, config.joints[0].contact.law);
        for block in &struts(config) {
            let onset = block.normal.onset(2e-3);
            let pieces = (0..2).map(|piece| Onset { piece, ..onset });
            let modes: Vec<Mode> = pieces.flat_map(modes).collect();
            for (mode, y) in modes.iter().flat_map(|m| states.iter().map(move |y| (*m, y))) {
                let rows = block.jacobian_rows(mode, y);
                for j in 0..6 {
                    let column = dual_column(block, mode, y, j);
                    for i in 0..6 {
                        let size = rows[i].iter().fold(1e-9, |m: f64, x| m.max(x.abs()));
                        let difference = (rows[i][j] - column[i]).abs() / size;
                        // Measured: at most 3.1e-13.
                        assert!(
                            difference < 1e-12,
                            "{reading} {law} {mode} ({i}, {j}): {} against {}",
                            rows[i][j],
                            column[i]
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn the_analytic_jacobian_is_that_of_dual_numbers_in_every_mode_and_reading() {
        let mut config = table1();
        for &reading in ReadingName::ALL {
            for exponent in [1.0, 1.5] {
                config.reading = reading;
                for joint in &mut config.joints {
                    joint.contact.exponent = exponent;
                }
                agrees(&config);
            }
        }
    }

    #[test]
    fn the_analytic_jacobian_is_that_of_dual_numbers_for_every_law_of_friction() {
        let mut config = table1();
        for reading in [ReadingName::Pin, ReadingName::Full] {
            config.reading = reading;
            for &law in FrictionLaw::ALL {
                for joint in &mut config.joints {
                    joint.friction.law = law;
                    joint.friction.regularisation_speed = 5e-3;
                }
                agrees(&config);
            }
        }
    }

    #[test]
    fn the_analytic_jacobian_is_that_of_dual_numbers_for_every_law() {
        let mut config = table1();
        config.reading = ReadingName::Full;
        for law in ContactLaw::ALL {
            for joint in &mut config.joints {
                let contact = &mut joint.contact;
                (contact.law, contact.stiffness, contact.exponent) = (law, 1e10, 1.5);
                contact.restitution = 0.7;
            }
            agrees(&config);
        }
    }
}

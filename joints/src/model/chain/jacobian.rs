//! The analytic Jacobian of a chain, block-tridiagonal where no joint sticks.

use deltazero_solvers::System as _;
use num_dual::Dual64;

use super::{Chain, Modes, Motion, STATES};
use crate::model::block::ContactForces;
use crate::model::body::Posture;
use crate::model::contact::PinPose;
use crate::model::inertia::BlockInertia;
use crate::model::jacobian::{FrozenContact, Gradient, gradient};
use crate::model::mode::Mode;
use crate::model::state::State;

/// Gradients of `R` quantities with respect to the states of neighbouring bays.
struct Band<const R: usize> {
    /// The first of these bays.
    first: usize,
    /// One block a bay.
    blocks: Vec<[Gradient; R]>,
}

impl<const R: usize> Band<R> {
    /// The block of bay `b`, zero outside the band.
    fn of(&self, b: usize) -> [Gradient; R] {
        let inside = b.checked_sub(self.first).and_then(|i| self.blocks.get(i));
        inside.copied().unwrap_or([[0.0; STATES]; R])
    }
}

impl Chain {
    /// Calls `entry` for every entry of the Jacobian.
    ///
    /// The accelerations of bay k go with its own state, with the contact after it, and, relative to its
    /// bush, with bay k − 1. A joint that sticks takes a torque which goes with the acceleration of its
    /// bush, and hands the bay before on to the bay after it: its rows reach back as far as bays stick.
    pub(super) fn jacobian_entries(
        &self,
        inertia: &BlockInertia,
        modes: &[Mode],
        y: &[f64],
        mut entry: impl FnMut(usize, usize, f64),
    ) {
        let mut bush = Band::<2> { first: 0, blocks: Vec::new() };
        self.along(modes, y, 0..self.bays, |k, motion| {
            for i in 0..3 {
                entry(STATES * k + i, STATES * k + 3 + i, 1.0);
            }
            let next = self.push_gradient(inertia, modes, y, k + 1);
            let (relative, end) = self.bay_gradients(inertia, modes[k], k, motion, next, &bush);
            let last = (k + 1).min(self.bays - 1);
            for b in relative.first.min(k.saturating_sub(1))..=last {
                for (i, row) in relative.of(b).iter().enumerate() {
                    // Of the bay before, θ̈ knows by sticking alone.
                    if i == 2 && b < k && !modes[k].sticks() {
                        continue;
                    }
                    for (j, value) in row.iter().enumerate() {
                        entry(STATES * k + 3 + i, STATES * b + j, *value);
                    }
                }
            }
            bush = end;
        });
    }

    /// The same where friction has bristles: the rates of a bay go with its own states and those of its
    /// neighbours alone, so one dual number serves every third bay.
    pub(super) fn dual_jacobian(
        &self,
        modes: &Modes,
        y: &[f64],
        mut entry: impl FnMut(usize, usize, f64),
    ) {
        let stride = self.stride();
        for (third, j) in
            (0..self.bays.min(3)).flat_map(|third| (0..stride).map(move |j| (third, j)))
        {
            let is_seeded = |i: usize| i / stride % 3 == third && i % stride == j;
            let seed = |(i, y): (usize, &f64)| Dual64::new(*y, f64::from(is_seeded(i)));
            let seeded: Vec<_> = y.iter().enumerate().map(seed).collect();
            let mut dydt = seeded.clone();
            self.rhs(modes.clone(), Dual64::from_re(0.0), &seeded, &mut dydt);
            for b in (third..self.bays).step_by(3) {
                for k in b.saturating_sub(1)..=(b + 1).min(self.bays - 1) {
                    for (i, rate) in (stride * k..).zip(&dydt[stride * k..stride * (k + 1)]) {
                        entry(i, stride * b + j, rate.eps);
                    }
                }
            }
        }
    }

    /// The force of joint `k` on its bush, and its gradient by the state of bay `k`.
    fn push_gradient(
        &self,
        inertia: &BlockInertia,
        modes: &[Mode],
        y: &[f64],
        k: usize,
    ) -> Option<([f64; 2], [Gradient; 2])> {
        let (pose, onset) = self.contact(modes, y, k)?;
        let y = self.state_of(y, k);
        let normal = self.bay.normal.force(pose.delta, pose.delta_dot, onset);
        let forces = ContactForces::frictionless(normal);
        let by = self.bay.frozen_contact(inertia, (modes[k], onset), &y, &pose, forces);
        let turned = |i: usize| gradient(|j| by.normal[j] * pose.n[i] + normal * by.pose.n[i][j]);
        Some((self.push(&pose, onset), [turned(0), turned(1)]))
    }

    /// Gradients of the relative accelerations of bay `k` and of the acceleration of its end.
    fn bay_gradients(
        &self,
        inertia: &BlockInertia,
        mode: Mode,
        k: usize,
        motion: &Motion<f64>,
        next: Option<([f64; 2], [Gradient; 2])>,
        bush: &Band<2>,
    ) -> (Band<3>, Band<2>) {
        let contact = motion.contact.as_ref().map(|(pose, forces, onset)| {
            (*pose, self.bay.frozen_contact(inertia, (mode, *onset), &motion.y, pose, *forces))
        });
        let mut absolute =
            Band { first: k, blocks: vec![self.own_gradients(inertia, mode, motion, &contact)] };
        if let Some((push, by)) = next {
            let [by_angle, by_x, by_y] = self.response_gradient(inertia, &motion.y, push);
            for (row, by_angle) in absolute.blocks[0].iter_mut().zip(by_angle) {
                row[2] += by_angle;
            }
            let by_push = |i: usize| gradient(|j| by_x[i] * by[0][j] + by_y[i] * by[1][j]);
            absolute.blocks.push(std::array::from_fn(by_push));
        }
        let first = if bush.blocks.is_empty() { k } else { bush.first };
        let last = k + absolute.blocks.len() - 1;
        let minus_bush = |b: usize| {
            let ([x, y, theta], [bush_x, bush_y]) = (absolute.of(b), bush.of(b));
            [gradient(|j| x[j] - bush_x[j]), gradient(|j| y[j] - bush_y[j]), theta]
        };
        let mut relative = Band { first, blocks: (first..=last).map(minus_bush).collect() };
        if let (Mode::Stick(_), Some((pose, contact))) = (mode, &contact) {
            let posture = Posture::Struts(inertia, inertia.at(motion.y[2]));
            let mut stuck = Vec::new();
            for (b, block) in (first..).zip(&mut relative.blocks) {
                let v_t_dot = if b == k {
                    self.bay.v_t_dot_gradient(pose, contact, motion.relative, block)
                } else {
                    let along_t = |j| pose.n[1] * block[0][j] - pose.n[0] * block[1][j];
                    gradient(|j| along_t(j) + self.bay.pin_radius * block[2][j])
                };
                let taken = self.bay.stuck_response(&posture, pose, v_t_dot);
                let before = absolute.of(b);
                stuck.push(std::array::from_fn(|i| gradient(|j| before[i][j] - taken[i][j])));
                *block = std::array::from_fn(|i| gradient(|j| block[i][j] - taken[i][j]));
            }
            absolute = Band { first, blocks: stuck };
        }
        let end = self.end_gradient(k, motion, &absolute);
        (relative, end)
    }

    /// `∇(Ẍ, Ÿ, θ̈)` of a bay by its own state and forces.
    fn own_gradients(
        &self,
        inertia: &BlockInertia,
        mode: Mode,
        motion: &Motion<f64>,
        contact: &Option<(PinPose<f64>, FrozenContact)>,
    ) -> [Gradient; 3] {
        match contact {
            Some((_, contact)) => contact.accelerations,
            None => {
                let [.., x, y, theta] = self.bay.strut_jacobian(inertia, mode, &motion.y);
                [x, y, theta]
            }
        }
    }

    /// Derivatives of [`response`](Chain::response) by the angle and by both components of the force.
    ///
    /// ```text
    /// θ̈ = ((l1 + l2 − p̄) cos θ P_X + q̄ sin θ P_Y)/(j_0 + j_c cos²θ)
    /// Ẍ = P_X/M_x − p̄ cos θ θ̈,   Ÿ = P_Y/M_y + q̄ sin θ θ̈
    /// ```
    fn response_gradient(
        &self,
        inertia: &BlockInertia,
        y: &State<f64>,
        push: [f64; 2],
    ) -> [[f64; 3]; 3] {
        let arrow = inertia.at(y[2]);
        let (sin, cos) = (arrow.sin, arrow.cos);
        let (p, q) = (inertia.p, inertia.q);
        let [_, _, theta] = self.response(inertia, &arrow, push);
        let d_moment = q * cos * push[1] - (self.reach() - p) * sin * push[0];
        let d_theta = (d_moment + 2.0 * inertia.j_c * sin * cos * theta) / inertia.schur(cos);
        let by_angle =
            [p * (sin * theta - cos * d_theta), q * (cos * theta + sin * d_theta), d_theta];
        let by_force = |force| self.response(inertia, &arrow, force);
        [by_angle, by_force([1.0, 0.0]), by_force([0.0, 1.0])]
    }

    /// `∇C̈` of bay `k`, given those of its accelerations.
    fn end_gradient(&self, k: usize, motion: &Motion<f64>, absolute: &Band<3>) -> Band<2> {
        let ([.., theta, _, _, omega], theta_dd) = (motion.y, motion.relative[2]);
        let (sin, cos) = libm::sincos(theta);
        let end = |(b, [x, y, theta]): (usize, &[Gradient; 3])| {
            let mut end_x = gradient(|j| x[j] + self.reach() * cos * theta[j]);
            if b == k {
                end_x[2] -= self.reach() * (sin * theta_dd + cos * omega * omega);
                end_x[5] -= self.reach() * 2.0 * sin * omega;
            }
            [end_x, *y]
        };
        let blocks = (absolute.first..).zip(&absolute.blocks).map(end).collect();
        Band { first: absolute.first, blocks }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keys::FrictionLaw;
    use crate::keys::test_defaults::table1;
    use crate::model::contact::Onset;
    use crate::model::struts::chain_of;

    const BAYS: usize = 5;

    fn chain(exponent: f64) -> Chain {
        let mut config = table1();
        config.bays = BAYS as u32;
        config.joints[0].contact.exponent = exponent;
        chain_of(&config)
    }

    /// Relaxing, slip+, slip− and stick of a contact without memory.
    fn in_contact() -> [Mode; 4] {
        [Mode::Relaxing, Mode::SlipPlus, Mode::SlipMinus, Mode::Stick]
            .map(|mode| mode(Onset::PLAIN))
    }

    fn state() -> Vec<f64> {
        let bay = |k: usize| {
            let turn = 0.3 + 1.3 * k as f64;
            let (sin, cos) = turn.sin_cos();
            let k = k as f64;
            [1.02e-4 * sin, 1.01e-4 * cos, 0.1 + 0.25 * k, 2e-3 * cos, 1e-3 * sin, 0.3 - 0.1 * k]
        };
        (0..BAYS).flat_map(bay).collect()
    }

    fn analytic(chain: &Chain, modes: &Modes, y: &Vec<f64>) -> (Vec<Vec<f64>>, Vec<Vec<bool>>) {
        let n = chain.dim();
        let (mut rows, mut pattern) = (vec![vec![0.0; n]; n], vec![vec![false; n]; n]);
        chain.jacobian(modes.clone(), 0.0, y, |i, j, entry| {
            assert!(!pattern[i][j], "({i}, {j}) is given twice");
            (rows[i][j], pattern[i][j]) = (entry, true);
        });
        (rows, pattern)
    }

    /// The rates with their derivatives by state `j`, by dual numbers.
    fn column(chain: &Chain, modes: &Modes, y: &[f64], j: usize) -> Vec<Dual64> {
        let seed = |i| Dual64::new(y[i], if i == j { 1.0 } else { 0.0 });
        let seeded: Vec<Dual64> = (0..y.len()).map(seed).collect();
        let mut dydt = seeded.clone();
        chain.rhs(modes.clone(), Dual64::from_re(0.0), &seeded, &mut dydt);
        dydt
    }

    #[test]
    fn the_analytic_jacobian_is_that_of_dual_numbers_in_every_mode() {
        use Mode::Apart;
        let [relaxing, plus, minus, stick] = in_contact();
        let y = state();
        for modes in [
            [plus, minus, Apart, plus, plus],
            [Apart, plus, Apart, relaxing, minus],
            [stick, stick, stick, plus, stick],
            [Apart, stick, stick, Apart, stick],
            [minus, Apart, stick, stick, stick],
        ] {
            for exponent in [1.0, 1.5] {
                let (chain, modes) = (chain(exponent), Modes::from(modes.to_vec()));
                let (rows, _) = analytic(&chain, &modes, &y);
                for j in 0..y.len() {
                    let dydt = column(&chain, &modes, &y, j);
                    for (i, row) in rows.iter().enumerate() {
                        let size = row.iter().fold(1e-9, |m: f64, x| m.max(x.abs()));
                        let difference = (row[j] - dydt[i].eps).abs() / size;
                        // Measured: at most 1.1e-14.
                        assert!(
                            difference < 1e-13,
                            "{modes:?} ({i}, {j}): {} against {}",
                            row[j],
                            dydt[i].eps
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn the_jacobian_of_bristles_is_that_of_each_column() {
        use Mode::Apart;
        let [_, plus, minus, _] = in_contact();
        let mut config = table1();
        (config.bays, config.joints[0].friction.law) = (BAYS as u32, FrictionLaw::Lugre);
        let (chain, modes) = (chain_of(&config), Modes::from(vec![plus, minus, Apart, plus, plus]));
        let bent = |(k, bay): (usize, &[f64])| [bay, &[1e-7 * k as f64]].concat();
        let y: Vec<f64> = state().chunks(STATES).enumerate().flat_map(bent).collect();
        let (rows, _) = analytic(&chain, &modes, &y);
        for j in 0..y.len() {
            let dydt = column(&chain, &modes, &y, j);
            for (i, row) in rows.iter().enumerate() {
                assert_eq!(row[j], dydt[i].eps, "({i}, {j})");
            }
        }
    }

    #[test]
    fn the_pattern_is_block_tridiagonal_and_one_for_all_modes_without_stick() {
        use Mode::Apart;
        let [_, plus, minus, _] = in_contact();
        let (chain, y) = (chain(1.0), state());
        let pattern = |modes: [Mode; BAYS]| analytic(&chain, &modes.to_vec().into(), &y).1;
        let free = pattern([Apart; BAYS]);
        assert_eq!(pattern([plus, Apart, minus, minus, Apart]), free);
        assert_eq!(pattern([minus; BAYS]), free);
        for (i, row) in free.iter().enumerate() {
            for (j, given) in row.iter().enumerate() {
                assert!(!given || (i / STATES).abs_diff(j / STATES) <= 1, "({i}, {j})");
            }
        }
    }
}

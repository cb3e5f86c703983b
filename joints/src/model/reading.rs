//! The readings of the paper: constants of one struct. Forces are computed from them in `generalised_forces`.

use crate::keys::ReadingName;

/// Where contact and friction forces enter the equations of motion of a block.
///
/// ```text
/// Q_X = −F_N n_X + φ F_T t_X + (κ − 1) S_x sin θ θ̇²,   Q_Y = −F_N n_Y + φ F_T t_Y,
/// Q_θ = (l/2) F_N (α_c cos θ n_X + α_s sin θ n_Y) + F_T r
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// `α_c`, `α_s`: the moment of the normal force about the pin, in half struts.
    pub normal_moment: [f64; 2],
    /// `φ`: 1 where friction also acts as a force on the pin, 0 where as a torque only.
    pub tangential_force: f64,
    /// `κ`: sign of the centrifugal term in the equation of X; −1 as printed in Eq. (17).
    pub centrifugal: f64,
}

impl Reading {
    /// Whether energy is conserved: the normal force acts where the pin is, and signs are as derived.
    pub fn is_consistent(&self) -> bool {
        self.normal_moment == [0.0, 0.0] && self.centrifugal == 1.0
    }

    /// The contact force acts at the pin, friction is a torque only, signs are as derived.
    pub const AT_PIN: Self =
        Self { normal_moment: [0.0, 0.0], tangential_force: 0.0, centrifugal: 1.0 };

    /// The reading called `name` of joint 1 (`joint = 0`) or 2 (`joint = 1`).
    ///
    /// - `pin`: the contact force acts at the pin, whose partial velocity has no part in θ;
    ///   friction is a torque only, as Eq. (9) has it.
    /// - `full`: the same with the friction force on the pin: Newton's third law complete.
    /// - `centroid`: Eq. (9) literally, the contact force at the strut's centroid, signs as derived.
    /// - `printed`: Eqs. (12), (14) and (17) verbatim. Against the derivation the sign of the
    ///   sin θ term is wrong in (12), that of the cos θ term in (14), and the centrifugal term
    ///   in (17).
    /// - `cosine`: as `centroid` without its sin θ terms, friction as torque and force: it
    ///   reproduces the paper's 9 s for strut AF.
    pub fn of(name: ReadingName, joint: usize) -> Self {
        let at_pin = Self::AT_PIN;
        match (name, joint) {
            (ReadingName::Pin, _) => at_pin,
            (ReadingName::Full, _) => Self { tangential_force: 1.0, ..at_pin },
            (ReadingName::Centroid, _) => Self { normal_moment: [-1.0, 1.0], ..at_pin },
            (ReadingName::Printed, 0) => Self { normal_moment: [-1.0, -1.0], ..at_pin },
            (ReadingName::Printed, _) => {
                Self { normal_moment: [1.0, 1.0], centrifugal: -1.0, ..at_pin }
            }
            (ReadingName::Cosine, _) => {
                Self { normal_moment: [-1.0, 0.0], tangential_force: 1.0, ..at_pin }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use deltazero_solvers::System as _;
    use num_dual::{Dual2_64, Dual64, DualNum};

    use super::*;
    use crate::keys::Strut;
    use crate::keys::test_defaults::table1;
    use crate::model::Mode;
    use crate::model::contact::Onset;
    use crate::model::inertia::{strut_inertia, strut_mass};
    use crate::model::struts::struts;

    /// x01, y01, θ1, y02, z02, θ2, or what belongs to them.
    type Coordinates<S = f64> = [S; 6];
    /// Positions in e1, e2, e3.
    type Places<S, const N: usize> = [[S; 3]; N];

    /// Strut length [m].
    const L: f64 = 2.5;

    /// The paper's displacement table, L3 and L6 mended: centroids of struts 1 to 6.
    fn centroids<S: DualNum<Primitive = f64> + Copy>(q: &Coordinates<S>) -> Places<S, 6> {
        let [x, y, t1, y2, z2, t2] = *q;
        let ((s1, c1), (s2, c2)) = (t1.sin_cos(), t2.sin_cos());
        let (h, zero) = (L / 2.0, S::from(0.0));
        [
            [x + s1 * h, y + c1 * h, zero],
            [x + s1 * (3.0 * h), y + c1 * h, zero],
            [x + s1 * (4.0 * h), y2 + c2 * h, z2 + s2 * h],
            [zero, y2 + c2 * h, z2 + s2 * h],
            [x + s1 * h, y + c1 * h, z2 + s2 * L],
            [x + s1 * (3.0 * h), y + c1 * h, z2 + s2 * L],
        ]
    }

    fn pins<S: DualNum<Primitive = f64> + Copy>(q: &Coordinates<S>) -> Places<S, 2> {
        [[q[0], q[1], S::from(0.0)], [S::from(0.0), q[3], q[4]]]
    }

    fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    /// `q` with a derivative of one along `q_r`.
    fn along(q: &Coordinates, r: usize) -> Coordinates<Dual64> {
        std::array::from_fn(|i| Dual64::new(q[i], if i == r { 1.0 } else { 0.0 }))
    }

    /// Kane's generalised inertia forces, Eqs. (8) and (10), with the sign of `Σ m (∂V/∂u_r)·a + Σ J ε`.
    fn inertia(strut: &Strut, q: &Coordinates, u: &Coordinates, a: &Coordinates) -> Coordinates {
        let in_time: Coordinates<Dual2_64> =
            std::array::from_fn(|i| Dual2_64::new(q[i], u[i], a[i]));
        let accelerations = centroids(&in_time).map(|place| place.map(|component| component.v2));
        let (m, j) = (strut_mass(strut), strut_inertia(strut));
        let turning = [0.0, 0.0, 4.0 * j * a[2], 0.0, 0.0, 2.0 * j * a[5]];
        std::array::from_fn(|r| {
            let partials =
                centroids(&along(q, r)).map(|place| place.map(|component| component.eps));
            let struts = partials.iter().zip(accelerations);
            turning[r] + m * struts.map(|(partial, a)| dot(*partial, a)).sum::<f64>()
        })
    }

    /// A state in contact without friction, and what is left of each equation of motion: inertia forces
    /// less torques less the normal forces, where those act at the pins or at the centroids of 1 and 4.
    fn left(name: ReadingName, at_pins: bool) -> (Coordinates, Coordinates, [f64; 2], Coordinates) {
        let mut config = table1();
        config.reading = name;
        for joint in &mut config.joints {
            joint.friction.coefficient = 0.0;
        }
        let q = [8e-5, -7e-5, 0.7, -6e-5, 9e-5, 0.9];
        let u = [2e-3, -1e-3, 0.4, 1e-3, 3e-3, 0.6];
        let (mut a, mut forces) = ([0.0; 6], [0.0; 2]);
        for (i, block) in struts(&config).iter().enumerate() {
            let at = 3 * i;
            let y =
                block.in_paper_order(&[q[at], q[at + 1], q[at + 2], u[at], u[at + 1], u[at + 2]]);
            let mut dydt = [0.0; 6];
            let slip = Mode::SlipPlus(Onset::PLAIN);
            block.rhs(slip, 0.0, &y, &mut dydt);
            let [.., a_1, a_2, a_3] = block.in_paper_order(&dydt);
            a[at..at + 3].copy_from_slice(&[a_1, a_2, a_3]);
            forces[i] = block.forces(slip, &y, &block.pose(&y)).normal;
        }
        let mut left = inertia(&config.strut, &q, &u, &a);
        left[2] -= config.drive.m1;
        left[5] -= config.drive.m4;
        for (r, left) in left.iter_mut().enumerate() {
            for (joint, force) in forces.iter().enumerate() {
                let pin = pins(&q)[joint];
                let rho = dot(pin, pin).sqrt();
                let push = pin.map(|component| -force * component / rho);
                let moved = along(&q, r);
                let place =
                    if at_pins { pins(&moved)[joint] } else { centroids(&moved)[[0, 3][joint]] };
                *left -= dot(place.map(|component| component.eps), push);
            }
        }
        (q, u, forces, left)
    }

    /// Whether equations hold to rounding; forces here are some 100 N.
    fn assert_equal(left: Coordinates, expected: Coordinates) {
        for (r, (left, expected)) in left.iter().zip(expected).enumerate() {
            // Measured: 3.3e-13.
            assert!((left - expected).abs() < 1e-12, "equation {r}: {left} for {expected}");
        }
    }

    #[test]
    fn with_the_force_at_the_pin_all_six_equations_follow_from_the_displacement_table() {
        for name in [ReadingName::Pin, ReadingName::Full] {
            assert_equal(left(name, true).3, [0.0; 6]);
        }
    }

    #[test]
    fn eq_9_literally_is_the_reading_centroid() {
        assert_equal(left(ReadingName::Centroid, false).3, [0.0; 6]);
    }

    #[test]
    fn eqs_12_14_and_17_as_printed_differ_from_eq_9_by_one_sign_each() {
        let (q, u, [f1, f2], left) = left(ReadingName::Printed, false);
        let (n_y, n_z) = (q[1] / q[0].hypot(q[1]), q[4] / q[3].hypot(q[4]));
        let config = table1();
        // S_z = m3 l/2 + m4 l/2 + m5 l + m6 l.
        let s_z = 3.0 * strut_mass(&config.strut) * L;
        let mut expected = [0.0; 6];
        // Q_θ of (12) is −(l/2) F_N1 (cos θ1 n_x + sin θ1 n_y), derived −(l/2) F_N1 (cos θ1 n_x − sin θ1 n_y).
        expected[2] = -L * f1 * q[2].sin() * n_y;
        // Q_θ of (14) is (l/2) F_N2 (sin θ2 n_y + cos θ2 n_z), derived (l/2) F_N2 (sin θ2 n_y − cos θ2 n_z).
        expected[5] = L * f2 * q[5].cos() * n_z;
        // (17) has −S_z (θ̈2 cos θ2 + θ̇2² sin θ2), derived −S_z (θ̈2 cos θ2 − θ̇2² sin θ2).
        expected[4] = -2.0 * s_z * q[5].sin() * u[5] * u[5];
        assert_equal(left, expected);
        assert!(expected.iter().filter(|x| x.abs() > 1.0).count() == 3, "{expected:?}");
    }

    #[test]
    fn without_friction_the_reading_cosine_lacks_the_sine_terms_of_eq_9() {
        let (q, _, [f1, f2], left) = left(ReadingName::Cosine, false);
        let (n_y1, n_y2) = (q[1] / q[0].hypot(q[1]), q[3] / q[3].hypot(q[4]));
        let half = L / 2.0;
        let lacking = [-half * f1 * q[2].sin() * n_y1, -half * f2 * q[5].sin() * n_y2];
        assert_equal(left, [0.0, 0.0, lacking[0], 0.0, 0.0, lacking[1]]);
    }
}

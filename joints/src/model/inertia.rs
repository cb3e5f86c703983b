//! Mass sums of a block, and its arrow-shaped mass matrix solved in closed form.

use deltazero_solvers::Real;
use deltazero_solvers::real::{Divisor, Over, Turning};

use crate::keys::{Inertia, Strut};

/// Mass of a strut, `m = ρ π r'² l` [kg].
pub fn strut_mass(strut: &Strut) -> f64 {
    strut.density * std::f64::consts::PI * strut.radius * strut.radius * strut.length
}

/// Inertia of a strut about its centroid [kg m²]: `m r'²/2` about its own axis (as the paper
/// has it), `m l²/12` about the axis that it turns about, or the number given.
pub fn strut_inertia(strut: &Strut) -> f64 {
    let m = strut_mass(strut);
    match strut.inertia {
        Inertia::Axial => m * strut.radius * strut.radius / 2.0,
        Inertia::Transverse => m * strut.length * strut.length / 12.0,
        Inertia::Value(inertia) => inertia,
    }
}

/// One strut's row of the paper's displacement table, as far as it concerns one block: its
/// centroid is at `(X + p l sin θ, Y + q l cos θ)`, or at `X + p l sin θ` alone.
struct Row {
    /// Arm along X, in strut lengths.
    p: f64,
    /// Arm along Y, in strut lengths; none where the block does not move the strut along Y.
    q: Option<f64>,
}

/// Struts 1, 2, 3, 5, 6 as moved by (x01, y01, θ1).
const JOINT_1: [Row; 5] = [
    Row { p: 0.5, q: Some(0.5) },
    Row { p: 1.5, q: Some(0.5) },
    Row { p: 2.0, q: None },
    Row { p: 0.5, q: Some(0.5) },
    Row { p: 1.5, q: Some(0.5) },
];

/// Struts 3, 4, 5, 6 as moved by (z02, y02, θ2).
const JOINT_2: [Row; 4] = [
    Row { p: 0.5, q: Some(0.5) },
    Row { p: 0.5, q: Some(0.5) },
    Row { p: 1.0, q: None },
    Row { p: 1.0, q: None },
];

/// The mass matrix of a block in the coordinates (X, Y, θ):
///
/// ```text
/// | M_x         0           S_x cos θ      |
/// | 0           M_y        −S_y sin θ      |
/// | S_x cos θ  −S_y sin θ   I_0 + I_c cos²θ |
/// ```
///
/// With the struts' means `p̄ = S_x/M_x`, `q̄ = S_y/M_y` and variances, the Schur complement of θ is
/// `j_0 + j_c cos²θ`, `j_0 = ΣJ + Σm(q − q̄)²`, `j_c = Σm(p − p̄)² − Σm(q − q̄)²`: a sum of positive
/// terms, where I_0 + I_c cos²θ − (S_x cos θ)²/M_x − (S_y sin θ)²/M_y would lose five digits near 90°.
///
/// `C` are the constants of one block, or of several at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockInertia<C = f64> {
    /// `M_x` [kg].
    pub m_x: C,
    /// `M_y` [kg].
    pub m_y: C,
    /// `1/M_x`, `1/M_y` [1/kg]: a right-hand side multiplies rather than divides.
    pub(super) per_mass: [C; 2],
    /// `p̄ = S_x/M_x` [m].
    pub p: C,
    /// `q̄ = S_y/M_y` [m].
    pub q: C,
    /// `j_0` [kg m²].
    pub j_0: C,
    /// `j_c` [kg m²].
    pub j_c: C,
}

impl BlockInertia {
    /// The block of joint 1: (x01, y01, θ1), struts 1, 2, 3, 5, 6; strut 3 does not turn with θ1.
    pub fn joint_1(strut: &Strut) -> Self {
        Self::from_rows(strut, &JOINT_1, 4)
    }

    /// The block of joint 2: (z02, y02, θ2), struts 3, 4, 5, 6; struts 5 and 6 do not turn with θ2.
    pub fn joint_2(strut: &Strut) -> Self {
        Self::from_rows(strut, &JOINT_2, 2)
    }

    /// Sums over `rows`; `n_turning` struts turn with θ.
    fn from_rows(strut: &Strut, rows: &[Row], n_turning: usize) -> Self {
        let (m, l) = (strut_mass(strut), strut.length);
        let arms_x: Vec<f64> = rows.iter().map(|row| row.p * l).collect();
        let arms_y: Vec<f64> = rows.iter().filter_map(|row| row.q).map(|q| q * l).collect();
        let mean = |arms: &[f64]| arms.iter().sum::<f64>() / arms.len() as f64;
        let variance = |arms: &[f64], mean: f64| {
            m * arms.iter().map(|arm| (arm - mean) * (arm - mean)).sum::<f64>()
        };
        let (p, q) = (mean(&arms_x), mean(&arms_y));
        let (v_x, v_y) = (variance(&arms_x, p), variance(&arms_y, q));
        let (m_x, m_y) = (m * arms_x.len() as f64, m * arms_y.len() as f64);
        Self {
            m_x,
            m_y,
            per_mass: [1.0 / m_x, 1.0 / m_y],
            p,
            q,
            j_0: n_turning as f64 * strut_inertia(strut) + v_y,
            j_c: v_x - v_y,
        }
    }

    /// `I_0 + I_c cos²θ` [kg m²]: the inertia about a pin that is held.
    #[inline(always)]
    pub fn about_pin<S: Real>(&self, sin: S, cos: S) -> S {
        let along_x = cos * cos * (self.m_x * self.p * self.p);
        let along_y = sin * sin * (self.m_y * self.q * self.q);
        self.schur(cos) + along_x + along_y
    }
}

impl<C: Copy> BlockInertia<C> {
    /// `j_0 + j_c cos²θ` [kg m²].
    #[inline(always)]
    pub fn schur<S: Over<C>>(&self, cos: S) -> S {
        cos * cos * self.j_c + self.j_0
    }

    /// The mass matrix at the angle `theta` [rad].
    #[inline(always)]
    pub fn at<S: Over<C>>(&self, theta: S) -> Arrow<S> {
        let (sin, cos) = theta.sin_cos();
        Arrow {
            sin,
            cos,
            p_cos: cos * self.p,
            q_sin: sin * self.q,
            schur: self.schur(cos).divisor(),
        }
    }

    /// Accelerations (Ẍ, Ÿ, θ̈) [m/s², m/s², rad/s²] under the generalised forces (Q_X, Q_Y, Q_θ)
    /// [N, N, N m] at an angle, turning at `omega_sq = θ̇²`.
    ///
    /// ```text
    /// θ̈ = (Q_θ + j_c sin θ cos θ θ̇² − p̄ cos θ Q_X + q̄ sin θ Q_Y) / (j_0 + j_c cos²θ)
    /// Ẍ = p̄ sin θ θ̇² + Q_X/M_x − p̄ cos θ θ̈,   Ÿ = q̄ cos θ θ̇² + Q_Y/M_y + q̄ sin θ θ̈
    /// ```
    #[inline(always)]
    pub fn accelerations<S: Over<C>>(&self, arrow: &Arrow<S>, omega_sq: S, q: [S; 3]) -> [S; 3] {
        let swing = [arrow.sin * omega_sq, arrow.cos * omega_sq];
        let by_forces = arrow.p_cos * q[0] - arrow.q_sin * q[1];
        let moment = swing[0] * arrow.cos * self.j_c + q[2] - by_forces;
        let theta = moment.over(&arrow.schur);
        let x = swing[0] * self.p - arrow.p_cos * theta + q[0] * self.per_mass[0];
        let y = swing[1] * self.q + arrow.q_sin * theta + q[1] * self.per_mass[1];
        [x, y, theta]
    }

    /// How `r = (p̄ sin θ, q̄ cos θ)`, from the pin to the mean of the struts along X and Y each, turns at
    /// `turn = (θ, θ̇)` [rad, rad/s]; for [`motion`](Self::motion).
    #[inline(always)]
    pub fn turning<S: Over<C>>(&self, turn: [S; 2]) -> Turning<S> {
        S::turning([S::of(self.p), S::of(self.q)], turn)
    }

    /// `j_c sin θ cos θ θ̇²` [N m]: what turning adds to the moment that θ̈ is made of.
    #[inline(always)]
    pub fn turning_moment<S: Over<C>>(&self, turning: &Turning<S>) -> S {
        turning.rates[0] * -turning.rates[1] * self.j_c
    }

    /// [`accelerations`](Self::accelerations) (Ẍ, Ÿ, θ̈) of a motion, the rates of what `turning` was made of, under
    /// `q = (Q_X, Q_Y)` [N] and the moment [N m]
    ///
    /// ```text
    /// Q_θ + j_c sin θ cos θ θ̇² − (∂r/∂θ)·q
    /// ```
    #[inline(always)]
    pub fn motion<S: Over<C>>(&self, turning: Turning<S>, q: [S; 2], moment: S) -> [S; 3] {
        let theta = moment.over(&self.schur(turning.cos).divisor());
        let a = [q[0] * self.per_mass[0], q[1] * self.per_mass[1]];
        let [x, y] = S::less_turning(a, turning, theta);
        [x, y, theta]
    }
}

/// The mass matrix at one angle: all of its solution that does not wait for forces.
#[derive(Clone, Copy, Debug)]
pub struct Arrow<S> {
    /// `sin θ`.
    pub sin: S,
    /// `cos θ`.
    pub cos: S,
    /// `p̄ cos θ` [m].
    p_cos: S,
    /// `q̄ sin θ` [m].
    q_sin: S,
    /// `j_0 + j_c cos²θ` [kg m²].
    schur: Divisor<S>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keys::test_defaults::table1;

    /// The matrix as model sums have it, term by term.
    fn mass_matrix(inertia: &BlockInertia, theta: f64) -> [[f64; 3]; 3] {
        let (sin, cos) = theta.sin_cos();
        let (x, y) = (inertia.m_x * inertia.p * cos, -inertia.m_y * inertia.q * sin);
        [[inertia.m_x, 0.0, x], [0.0, inertia.m_y, y], [x, y, inertia.about_pin(sin, cos)]]
    }

    #[test]
    fn sums_of_equal_struts_are_those_of_the_paper() {
        let strut = table1().strut;
        let (m, l, j) = (strut_mass(&strut), strut.length, strut_inertia(&strut));
        assert!((m - 1.5315264186).abs() < 1e-10 && (j - 1.91440802e-5).abs() < 1e-13);
        let one = BlockInertia::joint_1(&strut);
        // S_x = m1 l/2 + m2 3l/2 + m3 2l + m5 l/2 + m6 3l/2, S_y = 2 m l.
        assert!((one.m_x * one.p - 6.0 * m * l).abs() < 1e-13);
        assert!((one.m_y * one.q - 2.0 * m * l).abs() < 1e-13);
        // I_0 = m l² + 4 J; I_c = 2 + 4 + 2 m l².
        assert!((one.about_pin(1.0, 0.0) - (m * l * l + 4.0 * j)).abs() < 1e-13);
        assert!((one.about_pin(0.0, 1.0) - (9.0 * m * l * l + 4.0 * j)).abs() < 1e-12);
        assert!((one.j_0 - 4.0 * j).abs() < 1e-18 && (one.j_c - 1.8 * m * l * l).abs() < 1e-13);
        let two = BlockInertia::joint_2(&strut);
        assert!((two.about_pin(1.0, 0.0) - (0.5 * m * l * l + 2.0 * j)).abs() < 1e-13);
        assert!((two.about_pin(0.0, 1.0) - (2.5 * m * l * l + 2.0 * j)).abs() < 1e-13);
        assert!((two.j_0 - 2.0 * j).abs() < 1e-18 && (two.j_c - 0.25 * m * l * l).abs() < 1e-13);
    }

    #[test]
    fn accelerations_solve_the_equations_of_motion() {
        let strut = table1().strut;
        for inertia in [BlockInertia::joint_1(&strut), BlockInertia::joint_2(&strut)] {
            for theta in [0.0, 0.4, 1.2] {
                let (omega, q): (f64, _) = (0.7, [0.3, -0.8, 0.5]);
                let arrow = inertia.at(theta);
                let turning = inertia.turning([theta, omega]);
                let lever = turning.along[0] * q[0] + turning.along[1] * q[1];
                let moment = inertia.turning_moment(&turning) + q[2] - lever;
                let moving = inertia.motion(turning, [q[0], q[1]], moment);
                let any = inertia.accelerations(&arrow, omega * omega, q);
                let Arrow { sin, cos, .. } = arrow;
                let i_c = inertia.about_pin(0.0, 1.0) - inertia.about_pin(1.0, 0.0);
                let forces = [
                    inertia.m_x * inertia.p * sin * omega * omega + q[0],
                    inertia.m_y * inertia.q * cos * omega * omega + q[1],
                    i_c * sin * cos * omega * omega + q[2],
                ];
                let rows = mass_matrix(&inertia, theta);
                for (a, (row, force)) in [any, moving]
                    .iter()
                    .flat_map(|a| rows.iter().zip(forces).map(move |row| (a, row)))
                {
                    let product: f64 = row.iter().zip(a).map(|(m, a)| m * a).sum();
                    assert!((product - force).abs() < 1e-12, "{product} against {force}");
                }
            }
        }
    }
}

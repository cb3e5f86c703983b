//! One joint under the reading `pin` of Table 1 (n = 1, adhesion): its equations and guards.

use deltazero::model::{Block, Body};

/// X, Y [m], θ [rad] and their rates.
pub(crate) type Y = [f64; 6];

/// Constants of one joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Joint {
    per_m_x: f64,
    per_m_y: f64,
    p: f64,
    q: f64,
    j_0: f64,
    j_c: f64,
    torque: f64,
    c: f64,
    stiffness: f64,
    damping: f64,
    /// `μ r`, the arm of `F_N` in the friction torque [m].
    mu_r: f64,
    r: f64,
}

/// Free, or in contact with the sign σ of v_T.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Mode {
    /// δ < 0.
    Free,
    /// δ > 0, slipping in the direction σ.
    Contact(f64),
}

impl Mode {
    /// As the files write it.
    pub(crate) fn code(self) -> i8 {
        match self {
            Self::Free => 0,
            Self::Contact(sigma) => sigma as i8,
        }
    }
}

impl Joint {
    /// The constants of `block`.
    ///
    /// # Panics
    /// Where no struts hang on it.
    pub(crate) fn new(block: &Block) -> Self {
        let Body::Struts(inertia) = &block.body else { panic!("a joint with struts") };
        Self {
            per_m_x: 1.0 / inertia.m_x,
            per_m_y: 1.0 / inertia.m_y,
            p: inertia.p,
            q: inertia.q,
            j_0: inertia.j_0,
            j_c: inertia.j_c,
            torque: block.torque,
            c: block.clearance,
            stiffness: block.normal.elastic.slope(0.0),
            damping: block.normal.damping,
            mu_r: block.mu * block.pin_radius,
            r: block.pin_radius,
        }
    }

    /// The slope.
    #[inline(always)]
    pub(crate) fn rhs(&self, mode: Mode, y: &Y) -> Y {
        let (sin, cos) = y[2].sin_cos();
        let omega_sq = y[5] * y[5];
        let per_schur = 1.0 / (self.j_0 + self.j_c * cos * cos);
        let (p_cos, q_sin) = (self.p * cos, self.q * sin);
        let centrifugal = self.j_c * sin * cos * omega_sq;
        let (q_x, q_y, moment) = match mode {
            Mode::Free => (0.0, 0.0, self.torque + centrifugal),
            Mode::Contact(sigma) => {
                let rho = (y[0] * y[0] + y[1] * y[1]).sqrt();
                let per_rho = 1.0 / rho;
                let delta_dot = (y[0] * y[3] + y[1] * y[4]) * per_rho;
                let normal = self.stiffness * (rho - self.c) + self.damping * delta_dot;
                let along = -normal * per_rho;
                let friction = -sigma * self.mu_r * normal;
                (along * y[0], along * y[1], self.torque + friction + centrifugal)
            }
        };
        let theta = (moment - p_cos * q_x + q_sin * q_y) * per_schur;
        [
            y[3],
            y[4],
            y[5],
            self.p * sin * omega_sq + q_x * self.per_m_x - p_cos * theta,
            self.q * cos * omega_sq + q_y * self.per_m_y + q_sin * theta,
            theta,
        ]
    }

    /// Both guards, positive inside the mode, and their rates along `slope`: the surface δ = 0 and,
    /// in contact, σ v_T.
    #[inline(always)]
    pub(crate) fn guards(&self, mode: Mode, y: &Y, slope: &Y) -> [[f64; 2]; 2] {
        let radial = y[0] * y[3] + y[1] * y[4];
        match mode {
            Mode::Free => {
                let per_2c = 0.5 / self.c;
                let rho_sq = y[0] * y[0] + y[1] * y[1];
                [[(self.c * self.c - rho_sq) * per_2c, 1.0], [-2.0 * radial * per_2c, 0.0]]
            }
            Mode::Contact(sigma) => {
                let rho = (y[0] * y[0] + y[1] * y[1]).sqrt();
                let per_rho = 1.0 / rho;
                let delta_dot = radial * per_rho;
                let w = (y[1] * y[3] - y[0] * y[4]) * per_rho;
                let w_dot = (y[1] * slope[3] - y[0] * slope[4]) * per_rho - w * delta_dot * per_rho;
                let v_t = w + y[5] * self.r;
                [[rho - self.c, sigma * v_t], [delta_dot, sigma * (w_dot + slope[5] * self.r)]]
            }
        }
    }

    /// Bounds of their rounding errors.
    #[inline(always)]
    pub(crate) fn bounds(&self, y: &Y) -> [f64; 2] {
        let speed = y[3].abs() + y[4].abs() + self.r * y[5].abs();
        [4.0 * f64::EPSILON * self.c, 4.0 * f64::EPSILON * speed.max(1e-9)]
    }

    /// The mode after guard number `guard` of `mode` fell. The reading `pin` never sticks in this
    /// run: its friction is a torque alone, and v_T passes through zero.
    pub(crate) fn after(&self, mode: Mode, guard: usize, y: &Y) -> Mode {
        match (mode, guard) {
            (Mode::Free, _) => {
                let v_t = (y[1] * y[3] - y[0] * y[4]) / (y[0] * y[0] + y[1] * y[1]).sqrt()
                    + y[5] * self.r;
                Mode::Contact(1_f64.copysign(v_t))
            }
            (Mode::Contact(_), 0) => Mode::Free,
            (Mode::Contact(sigma), _) => Mode::Contact(-sigma),
        }
    }

    /// The mode in which the start, on the surface and at rest, goes on: the sign of the
    /// frictionless `v̇_T`, which is `n_Y Ẍ + θ̈ r` there.
    pub(crate) fn first_mode(&self, start: &Y) -> Mode {
        let slope = self.rhs(Mode::Free, start);
        let n_y = 1_f64.copysign(start[1]);
        Mode::Contact(1_f64.copysign(n_y * slope[3] + slope[5] * self.r))
    }
}

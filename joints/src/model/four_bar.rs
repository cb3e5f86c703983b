//! The four-bar linkage that may hang on a joint: a crank at constant speed, a coupler, and a rocker, with clearance
//! between the coupler's pin and the rocker's bush.
//!
//! The crank of length r turns about the origin by θ, `θ̇ = ω`; the coupler of length l leads from its end A to the pin B;
//! the rocker of length b turns about the pivot O = (g, 0) and holds the bush Q. With `e(φ) = (cos φ, sin φ)` and
//! `n(φ) = (−sin φ, cos φ)`:
//!
//! ```text
//! A = r e(θ),   B = A + l e(φ),   Q = O + b e(ψ),   (X, Y) = B − Q
//! ```
//!
//! The displacement (X, Y) of the pin in its bush and θ tell all. With `w = O + (X, Y) − A` and its length D, B − (X, Y) is
//! where two circles meet:
//!
//! ```text
//! l e(φ) = (a w + s h Jw)/D,   b e(ψ) = l e(φ) − w,   a = (l² − b² + D²)/(2D),   h = √(l² − a²)
//! ```
//!
//! J the turn by 90° and `s = 1`: of the two ways to assemble it that with B left of the way from A to O. Of `u = (Ẋ, Ẏ) − Ȧ = l φ̇ n(φ) − b ψ̇ n(ψ)`, with `S = sin(ψ − φ)`
//! and × the plane cross product,
//!
//! ```text
//! φ̇ = u × n(ψ)/(l S),   ψ̇ = u × n(φ)/(b S)
//! ```
//!
//! The contact gives the force P on the pin and −P on the bush. Friction acts at one point, at the distance r_p from the
//! pin's centre and `ρ + r_p` from that of the bush, ρ = |(X, Y)|: with `t = (n_Y, −n_X)` the torques on coupler and rocker are
//! `−F_T r_p` and `F_T (ρ + r_p)`, the surfaces slide by
//!
//! ```text
//! v_T = t·(Ẋ, Ẏ) + σ̇ r_p,   σ̇ = −φ̇ + κ ψ̇,   κ = 1 + ρ/r_p
//! ```
//!
//! and the power of friction is `F_T v_T`. The moments about A, which the crank pulls, and about O are
//!
//! ```text
//! (J_c + m_c l_c²) φ̈ = l n(φ)·P − F_T r_p + m_c l_c r ω² sin(θ − φ)
//! (J_r + m_r l_r²) ψ̈ = −b n(ψ)·P + F_T (ρ + r_p)
//! ```
//!
//! l_c and l_r the distances of the centroids from A and from O, and `(Ẍ, Ÿ) = Ä + l (φ̈ n(φ) − φ̇² e(φ)) − b (ψ̈ n(ψ) − ψ̇²
//! e(ψ))`. What holds θ̇ is the torque `τ = R·∂A/∂θ`, `R = m_c G̈ − P` the force on the coupler at A and G its centroid. There is
//! no gravity, and no friction but that of the pin. It is valid while the circles meet: `|l − b| < D < l + b`.

use deltazero_solvers::Real;

use super::linkage::{Linkage, Outputs};
use super::state::State;

/// Crank, coupler and rocker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FourBar {
    /// Length `r` of the crank [m].
    pub crank: f64,
    /// Length `l` of the coupler [m].
    pub coupler: f64,
    /// Length `b` of the rocker [m].
    pub rocker: f64,
    /// Distance `g` of the pivots of crank and rocker [m].
    pub ground: f64,
    /// Mass `m_c` of the coupler, its centroid in its middle [kg].
    pub coupler_mass: f64,
    /// Inertia `J_c` of the coupler about its centroid [kg m²].
    pub coupler_inertia: f64,
    /// Mass `m_r` of the rocker, its centroid in its middle [kg].
    pub rocker_mass: f64,
    /// Inertia `J_r` of the rocker about its centroid [kg m²].
    pub rocker_inertia: f64,
    /// Speed `ω` of the crank [rad/s].
    pub speed: f64,
    /// Angle of the crank at the start [rad].
    pub start: f64,
    /// Radius `r_p` of the pin [m].
    pub pin_radius: f64,
}

/// Where coupler and rocker are.
#[derive(Clone, Copy, Debug)]
pub struct Bars<S> {
    /// `sin θ`, `cos θ`.
    theta: [S; 2],
    /// `e(φ)` and `e(ψ)`.
    phi: [S; 2],
    psi: [S; 2],
    /// `S = sin(ψ − φ)`.
    sin_between: S,
    /// `φ̇` and `ψ̇` [rad/s].
    rates: [S; 2],
    /// `ω²` [rad²/s²].
    omega_sq: S,
    /// `(X, Y)` and its rate.
    pin: [S; 2],
    pin_rate: [S; 2],
}

fn cross<S: Real>(a: [S; 2], b: [S; 2]) -> S {
    a[0] * b[1] - a[1] * b[0]
}

fn dot<S: Real>(a: [S; 2], b: [S; 2]) -> S {
    a[0] * b[0] + a[1] * b[1]
}

/// `n` of an angle whose `e` this is.
fn normal<S: Real>(e: [S; 2]) -> [S; 2] {
    [-e[1], e[0]]
}

impl FourBar {
    /// `J_c + m_c l_c²` [kg m²].
    fn about_crank_pin(&self) -> f64 {
        self.coupler_inertia + 0.25 * self.coupler_mass * self.coupler * self.coupler
    }

    /// `J_r + m_r l_r²` [kg m²].
    fn about_pivot(&self) -> f64 {
        self.rocker_inertia + 0.25 * self.rocker_mass * self.rocker * self.rocker
    }

    /// `κ = 1 + ρ/r_p` and ρ̇/r_p; not a number at the very centre of the bush.
    fn arms<S: Real>(&self, at: &Bars<S>) -> [S; 2] {
        let rho = dot(at.pin, at.pin).sqrt();
        let rho_dot = dot(at.pin, at.pin_rate) / rho;
        [rho / self.pin_radius + 1.0, rho_dot / self.pin_radius]
    }

    /// φ̈ and ψ̈ [rad/s²] that a load gives.
    fn turns<S: Real>(&self, at: &Bars<S>, load: [S; 3]) -> [S; 2] {
        let (force, [kappa, _]) = ([load[0], load[1]], self.arms(at));
        let on_coupler = dot(normal(at.phi), force) * self.coupler - load[2];
        let on_rocker = load[2] * kappa - dot(normal(at.psi), force) * self.rocker;
        [on_coupler / self.about_crank_pin(), on_rocker / self.about_pivot()]
    }

    /// (Ẍ, Ÿ) that φ̈ and ψ̈ give.
    fn moved<S: Real>(&self, at: &Bars<S>, [phi, psi]: [S; 2]) -> [S; 2] {
        let (of_coupler, of_rocker) = (phi * self.coupler, psi * self.rocker);
        let (n_phi, n_psi) = (normal(at.phi), normal(at.psi));
        [n_phi[0] * of_coupler - n_psi[0] * of_rocker, n_phi[1] * of_coupler - n_psi[1] * of_rocker]
    }

    /// φ̈, ψ̈ and Ä under a load, or none.
    fn turns_and_pull<S: Real>(&self, at: &Bars<S>, load: Option<[S; 3]>) -> ([S; 2], [S; 2]) {
        let [sin, cos] = at.theta;
        let pull = [-(cos * at.omega_sq * self.crank), -(sin * at.omega_sq * self.crank)];
        // m_c l_c r ω² sin(θ − φ) = −m_c l_c e(φ) × Ä.
        let swing = cross(at.phi, pull) * (-0.5 * self.coupler_mass * self.coupler);
        let zero = S::cst(0.0);
        let [phi, psi] = load.map_or([zero; 2], |load| self.turns(at, load));
        ([phi + swing / self.about_crank_pin(), psi], pull)
    }

    /// Angle, speed and acceleration of the rocker of the linkage without clearance, the crank at `theta`.
    pub fn ideal_rocker(&self, theta: f64) -> [f64; 3] {
        let y = [0.0, 0.0, theta, 0.0, 0.0, self.speed];
        let at = self.at(&y);
        let [phi_dot, psi_dot] = at.rates;
        // l φ̈ n(φ) − b ψ̈ n(ψ) = −Ä + l φ̇² e(φ) − b ψ̇² e(ψ), crossed with n(φ).
        let (l, b) = (self.coupler * phi_dot * phi_dot, self.rocker * psi_dot * psi_dot);
        let pull = self.crank * at.omega_sq;
        let [sin, cos] = at.theta;
        let right = [
            cos * pull + l * at.phi[0] - b * at.psi[0],
            sin * pull + l * at.phi[1] - b * at.psi[1],
        ];
        let psi_ddot = cross(right, normal(at.phi)) / (self.rocker * at.sin_between);
        [libm::atan2(at.psi[1], at.psi[0]), psi_dot, psi_ddot]
    }
}

impl Linkage for FourBar {
    type At<S: Real> = Bars<S>;

    fn at<S: Real>(&self, y: &State<S>) -> Bars<S> {
        let (sin, cos) = y[2].sin_cos();
        let w = [y[0] - cos * self.crank + self.ground, y[1] - sin * self.crank];
        let length_sq = dot(w, w);
        // a/D and h/D.
        let along = (length_sq + (self.coupler * self.coupler - self.rocker * self.rocker))
            / (length_sq * 2.0);
        let across = (S::cst(self.coupler * self.coupler) / length_sq - along * along).sqrt();
        // s = 1.
        let coupler = [along * w[0] - across * w[1], along * w[1] + across * w[0]];
        let phi = [coupler[0] / self.coupler, coupler[1] / self.coupler];
        let psi = [(coupler[0] - w[0]) / self.rocker, (coupler[1] - w[1]) / self.rocker];
        let sin_between = cross(phi, psi);
        let turning = y[5] * self.crank;
        let u = [y[3] + sin * turning, y[4] - cos * turning];
        let rates = [
            cross(u, normal(psi)) / (sin_between * self.coupler),
            cross(u, normal(phi)) / (sin_between * self.rocker),
        ];
        Bars {
            theta: [sin, cos],
            phi,
            psi,
            sin_between,
            rates,
            omega_sq: y[5] * y[5],
            pin: [y[0], y[1]],
            pin_rate: [y[3], y[4]],
        }
    }

    fn spin<S: Real>(&self, at: &Bars<S>) -> S {
        let [kappa, _] = self.arms(at);
        kappa * at.rates[1] - at.rates[0]
    }

    fn accelerations<S: Real>(&self, at: &Bars<S>, load: Option<[S; 3]>) -> [S; 3] {
        let (turns, pull) = self.turns_and_pull(at, load);
        let [x, y] = self.moved(at, turns);
        let [phi_dot, psi_dot] = at.rates;
        let along = [phi_dot * phi_dot * self.coupler, psi_dot * psi_dot * self.rocker];
        let part = |i: usize| pull[i] - at.phi[i] * along[0] + at.psi[i] * along[1];
        let spin = load.map_or(S::cst(0.0), |_| {
            let [kappa, kappa_dot] = self.arms(at);
            kappa * turns[1] - turns[0] + kappa_dot * psi_dot
        });
        [x + part(0), y + part(1), spin]
    }

    fn response<S: Real>(&self, at: &Bars<S>, load: [S; 3]) -> [S; 3] {
        let (turns, [kappa, _]) = (self.turns(at, load), self.arms(at));
        let [x, y] = self.moved(at, turns);
        [x, y, kappa * turns[1] - turns[0]]
    }

    fn turned_along<S: Real>(&self, at: &Bars<S>, t: [S; 2], pin_radius: f64) -> S {
        let [kappa, _] = self.arms(at);
        let phi = cross(t, normal(at.psi)) / (at.sin_between * self.coupler);
        let psi = cross(t, normal(at.phi)) / (at.sin_between * self.rocker);
        (kappa * psi - phi) * pin_radius
    }

    fn speed(&self) -> f64 {
        self.speed
    }

    fn start(&self) -> f64 {
        self.start
    }

    fn acceleration_scale(&self) -> f64 {
        self.crank * self.speed * self.speed
    }

    fn force_scale(&self) -> f64 {
        (self.coupler_mass + self.rocker_mass) * self.acceleration_scale()
    }

    fn spin_bound(&self, y: &State<f64>) -> f64 {
        let at = self.at(y);
        let speed = self.crank * y[5].abs() + y[3].abs() + y[4].abs();
        let kappa = 1.0 + y[0].hypot(y[1]) / self.pin_radius;
        let of = |length: f64| speed / (length * at.sin_between.abs());
        of(self.coupler) + kappa * of(self.rocker)
    }

    /// ```text
    /// T = ½ m_c |Ġ|² + ½ J_c φ̇² + ½ (J_r + m_r l_r²) ψ̇²,   Ġ = r θ̇ n(θ) + ½ l φ̇ n(φ)
    /// ```
    fn kinetic(&self, y: &State<f64>) -> f64 {
        let at = self.at(y);
        let ([sin, cos], [phi_dot, psi_dot]) = (at.theta, at.rates);
        let (turning, half) = (self.crank * y[5], 0.5 * self.coupler * phi_dot);
        let g = [-turning * sin - half * at.phi[1], turning * cos + half * at.phi[0]];
        0.5 * (self.coupler_mass * dot(g, g)
            + self.coupler_inertia * phi_dot * phi_dot
            + self.about_pivot() * psi_dot * psi_dot)
    }

    fn torque(&self, y: &State<f64>, load: [f64; 3]) -> f64 {
        let at = self.at(y);
        let has_load = load != [0.0; 3];
        let ([phi, _], pull) = self.turns_and_pull(&at, has_load.then_some(load));
        let half = 0.5 * self.coupler;
        let (along, n_phi) = (at.rates[0] * at.rates[0], normal(at.phi));
        let g = [0, 1].map(|i| pull[i] + half * (phi * n_phi[i] - along * at.phi[i]));
        let force = [0, 1].map(|i| self.coupler_mass * g[i] - load[i]);
        let [sin, cos] = at.theta;
        self.crank * (cos * force[1] - sin * force[0])
    }

    fn outputs(&self) -> Outputs {
        Outputs {
            places: &[("coupler", "rad"), ("rocker", "rad")],
            rates: &[("coupler", "rad/s"), ("rocker", "rad/s")],
            accelerations: &[("rocker", "rad/s2"), ("ideal_rocker", "rad/s2")],
        }
    }

    fn output(&self, y: &State<f64>, load: [f64; 3]) -> Vec<f64> {
        let at = self.at(y);
        let has_load = load != [0.0; 3];
        let ([_, psi], _) = self.turns_and_pull(&at, has_load.then_some(load));
        let angle = |e: [f64; 2]| libm::atan2(e[1], e[0]);
        let [_, _, ideal] = self.ideal_rocker(y[2]);
        vec![angle(at.phi), angle(at.psi), at.rates[0], at.rates[1], psi, ideal]
    }
}

#[cfg(test)]
mod tests {
    use num_dual::{Dual2_64, Dual64, DualNum};

    use super::*;

    const BARS: FourBar = FourBar {
        crank: 1.0,
        coupler: 4.0,
        rocker: 2.5,
        ground: 3.0,
        coupler_mass: 1.2,
        coupler_inertia: 1.4,
        rocker_mass: 0.8,
        rocker_inertia: 0.5,
        speed: 6.0,
        start: 0.0,
        pin_radius: 0.059,
    };

    const STATES: [State<f64>; 4] = [
        [2e-3, -3e-3, 0.4, 0.3, -0.8, 6.0],
        [-4e-3, 1e-3, 2.0, -0.1, 0.6, 6.0],
        [1e-3, 4e-3, 4.4, 0.2, 1.1, 6.0],
        [3e-3, 0.0, 6.0, 0.0, 0.0, 6.0],
    ];

    /// The coupler's centroid and angle and the rocker's angle at (X, Y, θ): the closed loop, nothing else.
    fn places<S: DualNum<Primitive = f64> + Copy>([x, y, theta]: [S; 3]) -> [S; 4] {
        let (sin, cos) = theta.sin_cos();
        let w = [x - cos * BARS.crank + BARS.ground, y - sin * BARS.crank];
        let length = (w[0] * w[0] + w[1] * w[1]).sqrt();
        let (l, b) = (BARS.coupler, BARS.rocker);
        // The law of cosines at A.
        let at_a = ((length * length + (l * l - b * b)) / (length * (2.0 * l))).acos();
        let phi = w[1].atan2(w[0]) + at_a;
        let rocker = [phi.cos() * l - w[0], phi.sin() * l - w[1]];
        let g =
            [cos * BARS.crank + phi.cos() * (0.5 * l), sin * BARS.crank + phi.sin() * (0.5 * l)];
        [g[0], g[1], phi, rocker[1].atan2(rocker[0])]
    }

    /// What the virtual work of masses, load and drive leaves along X, Y and θ [N, N, N m].
    fn left(y: &State<f64>, force: [f64; 2], friction: f64) -> [f64; 3] {
        let load = [force[0], force[1], friction * BARS.pin_radius];
        let [a_x, a_y, _] = BARS.accelerations(&BARS.at(y), Some(load));
        let accelerations = [a_x, a_y, 0.0];
        let moving =
            places(std::array::from_fn(|i| Dual2_64::new(y[i], y[3 + i], accelerations[i])));
        let [g_x, g_y, phi, psi] = moving.map(|place| place.v2);
        let arm = y[0].hypot(y[1]) + BARS.pin_radius;
        std::array::from_fn(|r| {
            let seeded = std::array::from_fn(|i| Dual64::new(y[i], if i == r { 1.0 } else { 0.0 }));
            let [by_gx, by_gy, by_phi, by_psi] = places(seeded).map(|place| place.eps);
            let inertia = BARS.coupler_mass * (by_gx * g_x + by_gy * g_y)
                + BARS.coupler_inertia * by_phi * phi
                + BARS.about_pivot() * by_psi * psi;
            // The force acts on (X, Y) itself, friction by torques on both bodies.
            let pin = if r < 2 { force[r] } else { 0.0 };
            let torques = friction * (arm * by_psi - BARS.pin_radius * by_phi);
            let drive = if r == 2 { BARS.torque(y, load) } else { 0.0 };
            inertia - pin - torques - drive
        })
    }

    #[test]
    fn accelerations_and_drive_torque_follow_from_the_places_of_the_masses_by_virtual_work() {
        for y in &STATES {
            for (force, friction) in
                [([0.0; 2], 0.0), ([300.0, -200.0], 40.0), ([-50.0, 900.0], -9.0)]
            {
                for left in left(y, force, friction) {
                    // Against forces of 1e3 N; measured 2.5e-12.
                    assert!(left.abs() < 2e-11, "{left:e} at {y:?}");
                }
            }
        }
    }

    #[test]
    fn rates_and_kinetic_energy_are_those_of_the_places() {
        for y in &STATES {
            let moving = places(std::array::from_fn(|i| Dual64::new(y[i], y[3 + i])));
            let [g_x, g_y, phi, psi] = moving.map(|place| place.eps);
            let at = BARS.at(y);
            // Measured: 1.8e-15 rad/s, and 5.6e-16.
            assert!((at.rates[0] - phi).abs() < 1e-14 && (at.rates[1] - psi).abs() < 1e-14);
            let kinetic = 0.5
                * (BARS.coupler_mass * (g_x * g_x + g_y * g_y)
                    + BARS.coupler_inertia * phi * phi
                    + BARS.about_pivot() * psi * psi);
            assert!((BARS.kinetic(y) / kinetic - 1.0).abs() < 5e-15);
        }
    }

    #[test]
    fn the_spin_has_its_rate_and_its_share_along_a_direction() {
        // Along a motion with these accelerations, by differences in time.
        let (y, load) = (STATES[0], [300.0, -200.0, 2.0]);
        let [a_x, a_y, rate] = BARS.accelerations(&BARS.at(&y), Some(load));
        let spin = |h: f64| {
            let [x, y_, theta, v_x, v_y, omega] = y;
            let moved = [
                x + h * v_x + 0.5 * h * h * a_x,
                y_ + h * v_y + 0.5 * h * h * a_y,
                theta + h * omega,
                v_x + h * a_x,
                v_y + h * a_y,
                omega,
            ];
            BARS.spin(&BARS.at(&moved))
        };
        let difference = (spin(1e-6) - spin(-1e-6)) / 2e-6;
        // Measured: 1.2e-8, of the difference quotient.
        assert!((difference / rate - 1.0).abs() < 1e-7, "{difference} against {rate}");
        let t = [0.6, -0.8];
        let faster = [y[0], y[1], y[2], y[3] + t[0], y[4] + t[1], y[5]];
        let added = BARS.spin(&BARS.at(&faster)) - BARS.spin(&BARS.at(&y));
        let along = BARS.turned_along(&BARS.at(&y), t, BARS.pin_radius);
        // Measured: 2.2e-16.
        assert!((along / (added * BARS.pin_radius) - 1.0).abs() < 2e-15, "{along}");
    }

    #[test]
    fn an_ideal_joint_keeps_its_pin_and_moves_the_rocker_as_in_closed_form() {
        for theta in [0.0, 0.7, 2.0, 4.4, 6.0] {
            let y = [0.0, 0.0, theta, 0.0, 0.0, BARS.speed];
            let load = BARS.ideal_load(&y);
            let [a_x, a_y, _] = BARS.accelerations(&BARS.at(&y), Some(load));
            // Against 36 m/s²; measured 3.6e-14.
            assert!(a_x.abs().max(a_y.abs()) < 3e-13, "{a_x:e}, {a_y:e}");
            let ([_, psi], _) = BARS.turns_and_pull(&BARS.at(&y), Some(load));
            let [angle, speed, ideal] = BARS.ideal_rocker(theta);
            // Measured: 2.8e-14 rad/s².
            assert!((psi - ideal).abs() < 2e-13, "{psi} against {ideal}");
            // Freudenstein: K1 cos ψ − K2 cos θ + K3 = cos(θ − ψ).
            let (r, l, b, g) = (BARS.crank, BARS.coupler, BARS.rocker, BARS.ground);
            let k = [g / r, g / b, (r * r - l * l + b * b + g * g) / (2.0 * r * b)];
            let closure =
                k[0] * libm::cos(angle) - k[1] * libm::cos(theta) + k[2] - libm::cos(theta - angle);
            assert!(closure.abs() < 1e-14, "{closure:e}");
            let [ahead, behind] = [1e-4, -1e-4].map(|h| BARS.ideal_rocker(theta + h));
            let slope = BARS.speed * (ahead[0] - behind[0]) / 2e-4;
            // Measured: 3.2e-8, and 2.8e-8 of the torque, of the difference quotients.
            assert!((slope - speed).abs() < 3e-7, "{slope} against {speed}");
            let torque = BARS.torque(&y, load);
            let energy = |h: f64| BARS.kinetic(&[0.0, 0.0, theta + h, 0.0, 0.0, BARS.speed]);
            let slope = (energy(1e-4) - energy(-1e-4)) / 2e-4;
            assert!((torque - slope).abs() < 2e-7 * slope.abs().max(1.0), "{torque} for {slope}");
        }
    }

    /// By the closed loop, solved with 30 digits from the equations of the docs alone.
    #[test]
    fn the_bars_have_the_numbers_of_the_equations() {
        let bars = FourBar {
            crank: 0.3,
            coupler: 0.9,
            rocker: 0.7,
            ground: 0.8,
            coupler_mass: 1.1,
            coupler_inertia: 0.08,
            rocker_mass: 0.6,
            rocker_inertia: 0.03,
            speed: 7.0,
            start: 0.0,
            pin_radius: 0.01,
        };
        let y = [1e-3, -5e-4, 0.8, 0.02, -0.03, 7.0];
        let at = bars.at(&y);
        let [phi, psi] = [at.phi, at.psi].map(|[cos, sin]| libm::atan2(sin, cos));
        for (found, expected) in [
            (phi, 0.536_990_060_117_246_5),
            (psi, 1.308_751_774_337_639_4),
            (at.rates[0], -1.667_590_902_039_545),
            (at.rates[1], 1.122_156_733_933_627),
            (bars.spin(&at), 2.915_208_572_897_408_6),
            (bars.spin_bound(&y), 8.321_942_465_571_122),
            (bars.acceleration_scale(), 14.7),
            (bars.force_scale(), 24.99),
            (bars.kinetic(&y), 1.237_767_887_423_791_6),
        ] {
            // Measured: 4.4e-16.
            assert!((found / expected - 1.0).abs() < 4e-15, "{found} for {expected}");
        }
    }
}

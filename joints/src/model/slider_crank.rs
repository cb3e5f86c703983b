//! The slider-crank that may hang on a joint: a crank at constant speed, a rod, and a slider, with
//! clearance between the rod's pin and the slider's bush.
//!
//! The crank of length r turns about the origin by θ, `θ̇ = ω`; the rod of length l leads from its end A to
//! the pin B, φ below the line of the slider, which moves along x:
//!
//! ```text
//! A = r (cos θ, sin θ),   B = A + l (cos φ, −sin φ),   slider and bush at (s, 0)
//! ```
//!
//! The pin's displacement in the bush is `(X, Y) = B − (s, 0)`, and with the crank's angle it tells all:
//!
//! ```text
//! sin φ = (r sin θ − Y)/l,   φ̇ = (r θ̇ cos θ − Ẏ)/(l cos φ),   s = r cos θ + l cos φ − X
//! ```
//!
//! The rod, of mass m_r, centroid in its middle and inertia J, is pulled along by A; the contact gives the
//! force P on the pin, −P on the slider of mass m_s, and by friction the torque `F_T r_p` on φ, r_p the
//! pin's radius. With `Ä = −r θ̇² (cos θ, sin θ)`, the moments about A and the slider's equation are
//!
//! ```text
//! (J + m_r l²/4) φ̈ = F_T r_p − l (sin φ P_X + cos φ P_Y) − ½ m_r l r θ̇² sin(θ + φ),   m_s s̈ = −P_X
//! ```
//!
//! and two derivatives of (X, Y) give
//!
//! ```text
//! Ÿ = −r θ̇² sin θ − l cos φ φ̈ + l sin φ φ̇²
//! Ẍ = −r θ̇² cos θ − l sin φ φ̈ − l cos φ φ̇² + P_X/m_s
//! ```
//!
//! with the centrifugal terms of the rod in φ̇². The rod turns in the bush, which does
//! not turn: the surface of the pin slides by `v_T = t·(Ẋ, Ẏ) + φ̇ r_p`. What holds θ̇ is a torque τ on the
//! crank, `τ = R·∂A/∂θ` with `R = m_r G̈ − P` the force on the rod at A and G its centroid; its power `τ ω` is
//! all the work that goes in. The crank's own inertia does none. There is no gravity, and no friction but
//! that of the pin. It is valid while `r |sin θ| + |Y| < l`.

use deltazero_solvers::Real;

use super::linkage::{Linkage, Outputs};
use super::state::State;

/// Crank, rod and slider.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SliderCrank {
    /// Length `r` of the crank [m].
    pub crank: f64,
    /// Length `l` of the rod [m].
    pub rod: f64,
    /// Mass `m_r` of the rod [kg].
    pub rod_mass: f64,
    /// Inertia `J` of the rod about its centroid [kg m²].
    pub rod_inertia: f64,
    /// Mass `m_s` of the slider [kg].
    pub slider_mass: f64,
    /// Speed `ω` of the crank [rad/s].
    pub speed: f64,
    /// Angle of the crank at the start [rad].
    pub start: f64,
}

/// Where crank and rod are.
#[derive(Clone, Copy, Debug)]
pub struct Rods<S> {
    /// `sin θ`, `cos θ`.
    theta: [S; 2],
    /// `sin φ`, `cos φ`.
    phi: [S; 2],
    /// `φ̇` [rad/s].
    pub phi_dot: S,
    /// `θ̇²` [rad²/s²].
    omega_sq: S,
}

/// The slider at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slider {
    /// Angle `φ` of the rod [rad].
    pub phi: f64,
    /// `φ̇` [rad/s].
    pub phi_dot: f64,
    /// `s` [m].
    pub place: f64,
    /// `ṡ` [m/s].
    pub velocity: f64,
    /// `s̈` [m/s²].
    pub acceleration: f64,
    /// `s̈` of the mechanism without clearance at the same θ [m/s²].
    pub ideal_acceleration: f64,
    /// Torque `τ` that holds the crank's speed [N m].
    pub torque: f64,
}

impl SliderCrank {
    /// `J + m_r l²/4` [kg m²].
    fn about_crank_pin(&self) -> f64 {
        self.rod_inertia + 0.25 * self.rod_mass * self.rod * self.rod
    }

    /// `s̈` without clearance [m/s²].
    ///
    /// ```text
    /// φ̈ = (φ̇² sin φ − (r/l) ω² sin θ)/cos φ,   s̈ = −r ω² cos θ − l (φ̈ sin φ + φ̇² cos φ)
    /// ```
    pub fn ideal_acceleration(&self, theta: f64) -> f64 {
        let (sin, cos) = libm::sincos(theta);
        let (omega_sq, ratio) = (self.speed * self.speed, self.crank / self.rod);
        let sin_phi = ratio * sin;
        let cos_phi = (1.0 - sin_phi * sin_phi).sqrt();
        let phi_dot_sq = omega_sq * (ratio * cos / cos_phi) * (ratio * cos / cos_phi);
        let phi_ddot = (phi_dot_sq * sin_phi - ratio * omega_sq * sin) / cos_phi;
        -self.crank * omega_sq * cos - self.rod * (phi_ddot * sin_phi + phi_dot_sq * cos_phi)
    }

    /// The slider at `y` under a load on the pin.
    pub fn slider(&self, y: &State<f64>, load: [f64; 3]) -> Slider {
        let at = self.at(y);
        let [sin_phi, cos_phi] = at.phi;
        Slider {
            phi: libm::asin(sin_phi),
            phi_dot: at.phi_dot,
            place: self.crank * at.theta[1] + self.rod * cos_phi - y[0],
            velocity: self.velocity(&at, y),
            acceleration: -load[0] / self.slider_mass,
            ideal_acceleration: self.ideal_acceleration(y[2]),
            torque: self.torque_at(&at, load),
        }
    }

    /// `τ = ∂A/∂θ·(m_r G̈ − P)` [N m].
    fn torque_at(&self, at: &Rods<f64>, load: [f64; 3]) -> f64 {
        let Rods { theta: [sin_theta, cos_theta], phi: [sin_phi, cos_phi], phi_dot, omega_sq } =
            *at;
        let [_, _, phi_ddot] = self.accelerations(at, Some(load));
        let (pull, half, phi_dot_sq) = (self.crank * omega_sq, 0.5 * self.rod, phi_dot * phi_dot);
        let g_x = -pull * cos_theta - half * (sin_phi * phi_ddot + cos_phi * phi_dot_sq);
        let g_y = -pull * sin_theta - half * (cos_phi * phi_ddot - sin_phi * phi_dot_sq);
        let force = [self.rod_mass * g_x - load[0], self.rod_mass * g_y - load[1]];
        self.crank * (cos_theta * force[1] - sin_theta * force[0])
    }

    /// `ṡ` [m/s].
    fn velocity(&self, at: &Rods<f64>, y: &State<f64>) -> f64 {
        -self.crank * at.theta[0] * y[5] - self.rod * at.phi[0] * at.phi_dot - y[3]
    }
}

impl Linkage for SliderCrank {
    type At<S: Real> = Rods<S>;

    fn at<S: Real>(&self, y: &State<S>) -> Rods<S> {
        let (sin_theta, cos_theta) = y[2].sin_cos();
        let sin_phi = (sin_theta * self.crank - y[1]) / self.rod;
        let cos_phi = (-(sin_phi * sin_phi) + 1.0).sqrt();
        Rods {
            theta: [sin_theta, cos_theta],
            phi: [sin_phi, cos_phi],
            phi_dot: (cos_theta * y[5] * self.crank - y[4]) / (cos_phi * self.rod),
            omega_sq: y[5] * y[5],
        }
    }

    fn spin<S: Real>(&self, at: &Rods<S>) -> S {
        at.phi_dot
    }

    /// (Ẍ, Ÿ, φ̈).
    fn accelerations<S: Real>(&self, at: &Rods<S>, load: Option<[S; 3]>) -> [S; 3] {
        let load = load.unwrap_or([S::cst(0.0); 3]);
        let Rods { theta: [sin_theta, cos_theta], phi: [sin_phi, cos_phi], .. } = *at;
        let pull = at.omega_sq * self.crank;
        let swing = (sin_theta * cos_phi + cos_theta * sin_phi) * pull;
        let along = at.phi_dot * at.phi_dot * self.rod;
        let [x, y, phi] = self
            .response(at, [load[0], load[1], load[2] - swing * (0.5 * self.rod_mass * self.rod)]);
        [x - cos_theta * pull - cos_phi * along, y - sin_theta * pull + sin_phi * along, phi]
    }

    fn response<S: Real>(&self, at: &Rods<S>, load: [S; 3]) -> [S; 3] {
        let [sin_phi, cos_phi] = at.phi;
        let moment = load[2] - (sin_phi * load[0] + cos_phi * load[1]) * self.rod;
        let phi = moment / self.about_crank_pin();
        [load[0] / self.slider_mass - sin_phi * phi * self.rod, -(cos_phi * phi * self.rod), phi]
    }

    fn turned_along<S: Real>(&self, at: &Rods<S>, t: [S; 2], pin_radius: f64) -> S {
        S::cst(-pin_radius) / (at.phi[1] * self.rod) * t[1]
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
        (self.rod_mass + self.slider_mass) * self.acceleration_scale()
    }

    fn spin_bound(&self, y: &State<f64>) -> f64 {
        let [_, cos_phi] = self.at(y).phi;
        (self.crank * y[5].abs() + y[4].abs()) / (self.rod * cos_phi)
    }

    /// ```text
    /// T = ½ m_r |Ġ|² + ½ J φ̇² + ½ m_s ṡ²,   Ġ = r θ̇ (−sin θ, cos θ) − ½ l φ̇ (sin φ, cos φ)
    /// ```
    fn kinetic(&self, y: &State<f64>) -> f64 {
        let at = self.at(y);
        let (turning, half) = (self.crank * y[5], 0.5 * self.rod * at.phi_dot);
        let g_x = -turning * at.theta[0] - half * at.phi[0];
        let g_y = turning * at.theta[1] - half * at.phi[1];
        let s_dot = self.velocity(&at, y);
        0.5 * (self.rod_mass * (g_x * g_x + g_y * g_y)
            + self.rod_inertia * at.phi_dot * at.phi_dot
            + self.slider_mass * s_dot * s_dot)
    }

    fn torque(&self, y: &State<f64>, load: [f64; 3]) -> f64 {
        self.torque_at(&self.at(y), load)
    }

    fn outputs(&self) -> Outputs {
        Outputs {
            places: &[("rod", "rad"), ("slider", "m")],
            rates: &[("rod", "rad/s"), ("slider", "m/s")],
            accelerations: &[("slider", "m/s2"), ("ideal_slider", "m/s2")],
        }
    }

    fn output(&self, y: &State<f64>, load: [f64; 3]) -> Vec<f64> {
        let Slider { phi, phi_dot, place, velocity, acceleration, ideal_acceleration, .. } =
            self.slider(y, load);
        vec![phi, place, phi_dot, velocity, acceleration, ideal_acceleration]
    }
}

#[cfg(test)]
mod tests {
    use num_dual::{Dual2_64, Dual64, DualNum};

    use super::*;

    const CRANK: SliderCrank = SliderCrank {
        crank: 0.05,
        rod: 0.12,
        rod_mass: 0.21,
        rod_inertia: 2.5e-4,
        slider_mass: 0.14,
        speed: 523.6,
        start: 0.0,
    };

    /// The rod's centroid and pin, the slider, the rod's angle, at (X, Y, θ): the drawing, nothing else.
    fn places<S: DualNum<Primitive = f64> + Copy>([x, y, theta]: [S; 3]) -> [S; 6] {
        let (sin, cos) = theta.sin_cos();
        let phi = ((sin * CRANK.crank - y) / CRANK.rod).asin();
        let a = [cos * CRANK.crank, sin * CRANK.crank];
        let along = [phi.cos() * CRANK.rod, -phi.sin() * CRANK.rod];
        let pin = [a[0] + along[0], a[1] + along[1]];
        [a[0] + along[0] * 0.5, a[1] + along[1] * 0.5, pin[0], pin[1], pin[0] - x, phi]
    }

    const STATES: [State<f64>; 4] = [
        [2e-4, -3e-4, 0.4, 1.3, -0.8, 523.6],
        [-4e-4, 1e-4, 2.0, -2.1, 0.6, 523.6],
        [1e-4, 4e-4, 4.4, 0.2, 3.1, 523.6],
        [0.0, 0.0, 6.0, 0.0, 0.0, 523.6],
    ];

    /// What the virtual work of masses, load and drive leaves along X, Y and θ [N, N, N m].
    fn left(y: &State<f64>, load: [f64; 3]) -> [f64; 3] {
        let [a_x, a_y, _] = CRANK.accelerations(&CRANK.at(y), Some(load));
        let accelerations = [a_x, a_y, 0.0];
        let moving =
            places(std::array::from_fn(|i| Dual2_64::new(y[i], y[3 + i], accelerations[i])));
        let [g_x, g_y, _, _, s, phi] = moving.map(|place| place.v2);
        std::array::from_fn(|r| {
            let seeded = std::array::from_fn(|i| Dual64::new(y[i], if i == r { 1.0 } else { 0.0 }));
            let [by_gx, by_gy, by_bx, by_by, by_s, by_phi] = places(seeded).map(|place| place.eps);
            let inertia = CRANK.rod_mass * (by_gx * g_x + by_gy * g_y)
                + CRANK.rod_inertia * by_phi * phi
                + CRANK.slider_mass * by_s * s;
            let drive = if r == 2 { CRANK.slider(y, load).torque } else { 0.0 };
            inertia - load[0] * (by_bx - by_s) - load[1] * by_by - load[2] * by_phi - drive
        })
    }

    #[test]
    fn accelerations_and_drive_torque_follow_from_the_places_of_the_masses_by_virtual_work() {
        for y in &STATES {
            for load in [[0.0; 3], [3000.0, -2000.0, 4.0], [-500.0, 9000.0, -1.0]] {
                for left in left(y, load) {
                    // Against forces of 1e3 to 1e4 N; measured 1.8e-12.
                    assert!(left.abs() < 1e-11, "{left:e} at {y:?}");
                }
            }
        }
    }

    #[test]
    fn kinetic_energy_and_the_slider_are_those_of_the_places() {
        for y in &STATES {
            let moving = places(std::array::from_fn(|i| Dual64::new(y[i], y[3 + i])));
            let [g_x, g_y, _, _, s, phi] = moving.map(|place| place.eps);
            let kinetic = 0.5
                * (CRANK.rod_mass * (g_x * g_x + g_y * g_y)
                    + CRANK.rod_inertia * phi * phi
                    + CRANK.slider_mass * s * s);
            // Measured: 4.4e-16; 0 m, 1.8e-15 m/s and 2.8e-14 rad/s.
            assert!((CRANK.kinetic(y) / kinetic - 1.0).abs() < 4e-15);
            let slider = CRANK.slider(y, [0.0; 3]);
            assert!((slider.place - moving[4].re).abs() < 1e-16);
            assert!((slider.velocity - s).abs() < 1e-14);
            assert!((slider.phi_dot - phi).abs() < 2e-13);
        }
    }

    #[test]
    fn the_torque_of_an_ideal_joint_is_the_slope_of_its_kinetic_energy() {
        let at = |theta: f64| [0.0, 0.0, theta, 0.0, 0.0, CRANK.speed];
        for theta in [0.3, 1.0, 2.5, 4.0] {
            let torque = CRANK.slider(&at(theta), CRANK.ideal_load(&at(theta))).torque;
            let [above, below] = [1e-4, -1e-4].map(|h| CRANK.kinetic(&at(theta + h)));
            let slope = (above - below) / 2e-4;
            // Measured: 8.4e-9, of the difference quotient.
            assert!((torque / slope - 1.0).abs() < 8e-8, "{torque} for {slope}");
        }
    }

    #[test]
    fn without_clearance_the_slider_moves_as_in_closed_form() {
        for theta in [0.0, 0.4, 2.0, 4.4, 6.0] {
            let y = [0.0, 0.0, theta, 0.0, 0.0, CRANK.speed];
            let load = CRANK.ideal_load(&y);
            let slider = CRANK.slider(&y, load);
            let off = slider.acceleration / slider.ideal_acceleration - 1.0;
            // Measured: 2.2e-16.
            assert!(off.abs() < 2e-15, "{off:e} at {theta}");
            let [a_x, a_y, _] = CRANK.accelerations(&CRANK.at(&y), Some(load));
            // Against 1.4e4 m/s²; measured 3.5e-12.
            assert!(a_x.abs().max(a_y.abs()) < 3e-11, "{a_x:e}, {a_y:e}");
        }
        // In line: −r ω² (1 + r/l) at the far end, r ω² (1 − r/l) at the near one.
        let (r_omega_sq, ratio) = (CRANK.acceleration_scale(), CRANK.crank / CRANK.rod);
        let ends = [0.0, std::f64::consts::PI].map(|theta| CRANK.ideal_acceleration(theta));
        assert!((ends[0] / (-r_omega_sq * (1.0 + ratio)) - 1.0).abs() < 1e-14);
        assert!((ends[1] / (r_omega_sq * (1.0 - ratio)) - 1.0).abs() < 1e-14);
    }

    /// By the closed loop, solved with 30 digits from the equations of the docs alone.
    #[test]
    fn the_rods_have_the_numbers_of_the_equations() {
        let crank = SliderCrank {
            crank: 0.06,
            rod: 0.15,
            rod_mass: 0.25,
            rod_inertia: 3e-4,
            slider_mass: 0.4,
            speed: 90.0,
            start: 0.0,
        };
        let y = [1e-3, -5e-4, 0.8, 0.02, -0.03, 90.0];
        let at = crank.at(&y);
        for (found, expected) in [
            (crank.spin(&at), 26.418_961_775_942_997),
            (crank.spin_bound(&y), 37.828_792_907_574_63),
            (crank.acceleration_scale(), 486.0),
            (crank.force_scale(), 315.9),
            (crank.kinetic(&y), 8.102_526_779_638_291),
            (crank.velocity(&at, &y), -5.044_040_560_458_257),
        ] {
            // Measured: 2.2e-16.
            assert!((found / expected - 1.0).abs() < 2e-15, "{found} for {expected}");
        }
    }
}

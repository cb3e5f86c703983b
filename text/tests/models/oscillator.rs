//! The motion of a linear oscillator under a harmonic force, in closed form.

/// `m q̈ + c q̇ + k q = f + a cos ωt + b sin ωt`, underdamped.
///
/// ```text
/// q = f/k + Re(Z e^(iωt)) + e^(−σs) (A cos ω_d s + B sin ω_d s),   s = t − t_0
/// Z = (a − ib)/(k − mω² + icω),   σ = c/2m,   ω_d² = k/m − σ²
/// ```
#[derive(Clone, Copy, Debug)]
pub(crate) struct Oscillator {
    pub(crate) mass: f64,
    pub(crate) damping: f64,
    pub(crate) stiffness: f64,
    /// f, a, b.
    pub(crate) force: [f64; 3],
    /// ω.
    pub(crate) frequency: f64,
}

impl Oscillator {
    /// q and q̇ of the steady motion.
    fn steady(&self, t: f64) -> [f64; 2] {
        let ([f, a, b], omega) = (self.force, self.frequency);
        let [re, im] = [self.stiffness - self.mass * omega * omega, self.damping * omega];
        let square = re * re + im * im;
        // (a − ib)(re − i im)/square
        let [z_re, z_im] = [(a * re - b * im) / square, -(a * im + b * re) / square];
        let (sin, cos) = libm::sincos(omega * t);
        let q = f / self.stiffness + z_re * cos - z_im * sin;
        [q, -omega * (z_re * sin + z_im * cos)]
    }

    /// State at `t` of the motion that is at `y` at `t_0`.
    pub(crate) fn flow(&self, t_0: f64, y: [f64; 2], t: f64) -> [f64; 2] {
        let sigma = 0.5 * self.damping / self.mass;
        let omega = (self.stiffness / self.mass - sigma * sigma).sqrt();
        let ([q_0, v_0], [q, v]) = (self.steady(t_0), self.steady(t));
        let a = y[0] - q_0;
        let b = (y[1] - v_0 + sigma * a) / omega;
        let ((sin, cos), decay) = (libm::sincos(omega * (t - t_0)), libm::exp(sigma * (t_0 - t)));
        let (own, other) = (a * cos + b * sin, b * cos - a * sin);
        [q + decay * own, v + decay * (omega * other - sigma * own)]
    }
}

#[test]
fn the_closed_form_solves_the_equation() {
    let own = Oscillator {
        mass: 2.0,
        damping: 0.7,
        stiffness: 50.0,
        force: [3.0, -2.0, 5.0],
        frequency: 4.0,
    };
    let at = |t: f64| own.flow(0.3, [0.2, -1.0], t);
    assert!((at(0.3)[0] - 0.2).abs() < 1e-15 && (at(0.3)[1] + 1.0).abs() < 1e-15);
    for k in 0..50 {
        let (t, h) = (0.3 + 0.1 * f64::from(k), 1e-4);
        let ([q, v], [before, after]) = (at(t), [at(t - h), at(t + h)]);
        let rate = [0, 1].map(|i| (after[i] - before[i]) / (2.0 * h));
        let (sin, cos) = libm::sincos(own.frequency * t);
        let force = own.force[0] + own.force[1] * cos + own.force[2] * sin;
        let left = own.mass * rate[1] + own.damping * v + own.stiffness * q - force;
        // Measured: 1.0e-6, of the difference quotient.
        assert!((rate[0] - v).abs() < 1e-5 && left.abs() < 1e-5, "{t}: {left:e}");
    }
}

//! Five text models as a user of diffsol would state them: parameters are those of `text/models`, modes those of `../../models.py`; the
//! block rests below 1e-10 of the largest speed.
//!
//! Guards are positive inside a mode, and never zero: there diffsol is blind for a step. An instant that is known beforehand is the
//! end of a mode, [`Model::until`].

use std::f64::consts::FRAC_PI_4;

use crate::parameters::{block, carts, converter, neuron, van_der_pol};

/// A system of modes. What a mode remembers is in the implementor.
pub(crate) trait Model: Clone + Default {
    const NAME: &'static str;
    const T_END: f64;
    const N_GUARDS: usize = 1;

    /// The states at the start.
    fn start(&self) -> Vec<f64>;
    /// The size of each state, which allowed errors are a share of.
    fn scale(&self) -> Vec<f64>;
    fn rates(&self, y: &[f64], dydt: &mut [f64]);
    /// The Jacobian times `v`.
    fn jacobian_times(&self, y: &[f64], v: &[f64], jv: &mut [f64]);
    fn guards(&self, _y: &[f64], _g: &mut [f64]) {}
    /// When a mode ends [s], where it is known.
    fn until(&self) -> f64 {
        f64::INFINITY
    }
    /// After a guard fell, or at the end of a mode; an error where the model does not go on.
    fn jump(&mut self, _: Option<usize>, _t: f64, _y: &mut [f64]) -> Result<(), &'static str> {
        Ok(())
    }
}

#[derive(Clone, Default)]
pub(crate) struct VanDerPol;

impl Model for VanDerPol {
    const NAME: &'static str = "van_der_pol";
    const T_END: f64 = van_der_pol::T_END;
    const N_GUARDS: usize = 0;

    fn start(&self) -> Vec<f64> {
        vec![2.0, 0.0]
    }

    fn scale(&self) -> Vec<f64> {
        vec![2.0, 1e-3]
    }

    fn rates(&self, y: &[f64], dydt: &mut [f64]) {
        dydt[0] = y[1];
        dydt[1] = van_der_pol::MU * (1.0 - y[0] * y[0]) * y[1] - y[0];
    }

    fn jacobian_times(&self, y: &[f64], v: &[f64], jv: &mut [f64]) {
        jv[0] = v[1];
        jv[1] = (-2.0 * van_der_pol::MU * y[0] * y[1] - 1.0) * v[0]
            + van_der_pol::MU * (1.0 - y[0] * y[0]) * v[1];
    }
}

#[derive(Clone, Default)]
pub(crate) struct IntegrateAndFire {
    /// The last spike [s], within the refractory time.
    spike: Option<f64>,
}

impl Model for IntegrateAndFire {
    const NAME: &'static str = "integrate_and_fire";
    const T_END: f64 = neuron::T_END;

    fn start(&self) -> Vec<f64> {
        vec![neuron::E_L]
    }

    fn scale(&self) -> Vec<f64> {
        vec![neuron::V_TH - neuron::V_R]
    }

    fn rates(&self, y: &[f64], dydt: &mut [f64]) {
        dydt[0] = if self.spike.is_none() {
            (neuron::E_L - y[0] + neuron::RI) / neuron::TAU
        } else {
            0.0
        };
    }

    fn jacobian_times(&self, _y: &[f64], v: &[f64], jv: &mut [f64]) {
        jv[0] = if self.spike.is_none() { -v[0] / neuron::TAU } else { 0.0 };
    }

    fn guards(&self, y: &[f64], g: &mut [f64]) {
        g[0] = if self.spike.is_none() { neuron::V_TH - y[0] } else { 1.0 };
    }

    fn until(&self) -> f64 {
        self.spike.map_or(f64::INFINITY, |spike| spike + neuron::T_REF)
    }

    fn jump(&mut self, fallen: Option<usize>, t: f64, y: &mut [f64]) -> Result<(), &'static str> {
        self.spike = fallen.map(|_| t);
        if fallen.is_some() {
            y[0] = neuron::V_R;
        }
        Ok(())
    }
}

#[derive(Clone, Copy, Default, PartialEq)]
enum Conduction {
    #[default]
    On,
    Diode,
    Idle,
}

#[derive(Clone, Default)]
pub(crate) struct BuckConverter {
    conduction: Conduction,
    /// Periods that are over.
    k: f64,
}

impl Model for BuckConverter {
    const NAME: &'static str = "buck_converter";
    const T_END: f64 = converter::T_END;

    fn start(&self) -> Vec<f64> {
        vec![0.0, 0.0]
    }

    fn scale(&self) -> Vec<f64> {
        vec![converter::V_IN * converter::T / converter::L, converter::V_IN]
    }

    fn rates(&self, y: &[f64], dydt: &mut [f64]) {
        dydt[0] = match self.conduction {
            Conduction::On => (converter::V_IN - y[1]) / converter::L,
            Conduction::Diode => -y[1] / converter::L,
            Conduction::Idle => 0.0,
        };
        dydt[1] = (y[0] - y[1] / converter::R) / converter::C;
    }

    fn jacobian_times(&self, _y: &[f64], v: &[f64], jv: &mut [f64]) {
        jv[0] = if self.conduction == Conduction::Idle { 0.0 } else { -v[1] / converter::L };
        jv[1] = (v[0] - v[1] / converter::R) / converter::C;
    }

    fn guards(&self, y: &[f64], g: &mut [f64]) {
        g[0] = if self.conduction == Conduction::Diode { y[0] } else { 1.0 };
    }

    fn until(&self) -> f64 {
        let on = self.conduction == Conduction::On;
        (self.k + if on { converter::DUTY } else { 1.0 }) * converter::T
    }

    fn jump(&mut self, fallen: Option<usize>, _t: f64, y: &mut [f64]) -> Result<(), &'static str> {
        self.conduction = match (self.conduction, fallen) {
            (Conduction::On, _) => Conduction::Diode,
            (_, Some(_)) => {
                y[0] = 0.0;
                Conduction::Idle
            }
            (_, None) => {
                self.k += 1.0;
                Conduction::On
            }
        };
        Ok(())
    }
}

#[derive(Clone)]
pub(crate) struct RockingBlock {
    /// The angle of the diagonal [rad], the square of the frequency [1/s²].
    alpha: f64,
    p2: f64,
    /// The corner that it stands on, 1 to the right and -1 to the left; 0 at rest.
    corner: f64,
    /// The largest angle [rad] and angular velocity [rad/s], and those of this flight where they are less.
    largest: [f64; 2],
    scale: [f64; 2],
}

impl RockingBlock {
    /// An impact leaves the angle at zero: there the guard is inside.
    const INSIDE: f64 = 1e-100;
}

impl Default for RockingBlock {
    fn default() -> Self {
        let (alpha, p2) = (f64::atan2(0.2, 0.8), 3.0 * 9.81 / (4.0 * f64::hypot(0.2, 0.8)));
        let largest = [alpha, p2.sqrt() * alpha];
        Self { alpha, p2, corner: 1.0, largest, scale: largest }
    }
}

impl Model for RockingBlock {
    const NAME: &'static str = "rocking_block";
    const T_END: f64 = block::T_END;
    const N_GUARDS: usize = 3;

    fn start(&self) -> Vec<f64> {
        vec![0.15, 0.0]
    }

    fn scale(&self) -> Vec<f64> {
        self.scale.to_vec()
    }

    fn rates(&self, y: &[f64], dydt: &mut [f64]) {
        if self.corner == 0.0 {
            dydt.fill(0.0);
            return;
        }
        dydt[0] = y[1];
        dydt[1] = -self.corner * self.p2 * (self.alpha - self.corner * y[0]).sin();
    }

    fn jacobian_times(&self, y: &[f64], v: &[f64], jv: &mut [f64]) {
        if self.corner == 0.0 {
            jv.fill(0.0);
            return;
        }
        jv[0] = v[1];
        jv[1] = self.p2 * (self.alpha - self.corner * y[0]).cos() * v[0];
    }

    // The angle, what it lacks to overturn, what the corner carries.
    fn guards(&self, y: &[f64], g: &mut [f64]) {
        g.fill(1.0);
        if self.corner == 0.0 {
            return;
        }
        let angle = self.corner * y[0];
        let (sin, cos) = (self.alpha - angle).sin_cos();
        g[0] = if angle == 0.0 { Self::INSIDE } else { angle };
        g[1] = self.alpha + FRAC_PI_4 - angle;
        g[2] = 1.0 - 0.75 * (sin * sin + cos * y[1] * y[1] / self.p2);
    }

    fn jump(&mut self, fallen: Option<usize>, _t: f64, y: &mut [f64]) -> Result<(), &'static str> {
        if fallen != Some(0) {
            return Err("it overturns or lifts off");
        }
        let Self { alpha, p2, largest, .. } = *self;
        let omega = (1.0 - 1.5 * alpha.sin().powi(2)) * y[1];
        y.fill(0.0);
        if omega.abs() < block::LEAST * largest[1] {
            self.corner = 0.0;
            return Ok(());
        }
        self.corner = -self.corner;
        y[1] = omega;
        // Small flights are lost in an error that is allowed of the first.
        let height = omega * omega / (2.0 * p2 * alpha.sin());
        self.scale = [largest[0].min(height), largest[1].min(omega.abs())];
        Ok(())
    }
}

#[derive(Clone, Default)]
pub(crate) struct Carts;

impl Carts {
    /// An impact leaves a gap at zero to rounding, where its guard is to be inside.
    const SHIFT: f64 = 1e-16;
}

impl Model for Carts {
    const NAME: &'static str = "carts";
    const T_END: f64 = carts::T_END;
    const N_GUARDS: usize = carts::N - 1;

    fn start(&self) -> Vec<f64> {
        carts::start()
    }

    fn scale(&self) -> Vec<f64> {
        carts::scale()
    }

    fn rates(&self, y: &[f64], dydt: &mut [f64]) {
        let (x, v) = y.split_at(carts::N);
        let (dx, dv) = dydt.split_at_mut(carts::N);
        dx.copy_from_slice(v);
        for (dv, x) in dv.iter_mut().zip(x) {
            *dv = -carts::K * x;
        }
    }

    fn jacobian_times(&self, _y: &[f64], v: &[f64], jv: &mut [f64]) {
        self.rates(v, jv);
    }

    fn guards(&self, y: &[f64], g: &mut [f64]) {
        for (g, pair) in g.iter_mut().zip(y[..carts::N].windows(2)) {
            *g = carts::GAP - (pair[0] - pair[1]) + Self::SHIFT;
        }
    }

    fn jump(&mut self, fallen: Option<usize>, _t: f64, y: &mut [f64]) -> Result<(), &'static str> {
        let Some(i) = fallen else {
            return Ok(());
        };
        let (x, v) = y.split_at_mut(carts::N);
        let (middle, [a, b]) = ((x[i] + x[i + 1]) / 2.0, [v[i], v[i + 1]]);
        x[i] = middle + carts::GAP / 2.0;
        x[i + 1] = middle - carts::GAP / 2.0;
        v[i] = ((1.0 - carts::E) * a + (1.0 + carts::E) * b) / 2.0;
        v[i + 1] = ((1.0 + carts::E) * a + (1.0 - carts::E) * b) / 2.0;
        Ok(())
    }
}

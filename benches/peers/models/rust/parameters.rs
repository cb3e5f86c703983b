//! Parameters of the five models, which are those of `text/models`, in SI units.

pub(crate) mod van_der_pol {
    pub(crate) const MU: f64 = 1000.0;
    pub(crate) const T_END: f64 = 2000.0;
}

pub(crate) mod neuron {
    pub(crate) const TAU: f64 = 0.01;
    pub(crate) const E_L: f64 = -0.070;
    pub(crate) const RI: f64 = 1e8 * 2e-10;
    pub(crate) const V_TH: f64 = -0.054;
    pub(crate) const V_R: f64 = -0.080;
    pub(crate) const T_REF: f64 = 0.002;
    pub(crate) const T_END: f64 = 0.5;
}

pub(crate) mod converter {
    pub(crate) const V_IN: f64 = 24.0;
    pub(crate) const L: f64 = 2e-5;
    pub(crate) const C: f64 = 1e-4;
    pub(crate) const R: f64 = 20.0;
    pub(crate) const T: f64 = 1e-5;
    pub(crate) const DUTY: f64 = 0.4;
    pub(crate) const T_END: f64 = 4e-3;
}

pub(crate) mod block {
    /// The share of the largest speed below which it is at rest.
    pub(crate) const LEAST: f64 = 1e-10;
    pub(crate) const T_END: f64 = 10.0;
}

pub(crate) mod carts {
    pub(crate) const N: usize = 50;
    pub(crate) const K: f64 = 40.0;
    pub(crate) const GAP: f64 = 0.1;
    pub(crate) const E: f64 = 0.9;
    pub(crate) const T_END: f64 = 1.5;

    /// Places, then velocities.
    pub(crate) fn start() -> Vec<f64> {
        let speeds = (1..=N).map(|i| ((i * i) as f64).sin());
        std::iter::repeat_n(0.0, N).chain(speeds).collect()
    }

    /// Their sizes, which allowed errors are a share of.
    pub(crate) fn scale() -> Vec<f64> {
        [GAP, 1.0].into_iter().flat_map(|scale| std::iter::repeat_n(scale, N)).collect()
    }
}

//! Linkages that a crank at constant speed drives, with clearance in one joint: what a joint asks of each.
//!
//! The state of a joint tells all of such a linkage: the pin's displacement (X, Y) in its bush, the angle θ of the crank,
//! and their rates. Where both bodies of the joint turn, the surfaces slide by what the one turns against the other.

use std::fmt::Debug;

use deltazero_solvers::Real;

use super::state::State;

/// A linkage as its joint sees it. `load` is the force on the pin (P_X, P_Y) [N] and the torque of friction `F_T r_p`
/// [N m], r_p the radius of the pin.
pub trait Linkage {
    /// Where its bodies are, and how fast they turn.
    type At<S: Real>: Copy + Debug;

    /// The bodies at `y`.
    fn at<S: Real>(&self, y: &State<S>) -> Self::At<S>;

    /// How fast the pin turns in its bush, as the surfaces feel it [rad/s]: `v_T = t·(Ẋ, Ẏ) + spin r_p`.
    fn spin<S: Real>(&self, at: &Self::At<S>) -> S;

    /// Ẍ and Ÿ [m/s²], and the rate of the spin [rad/s²]; without contact where there is no load.
    fn accelerations<S: Real>(&self, at: &Self::At<S>, load: Option<[S; 3]>) -> [S; 3];

    /// What a load adds to them.
    fn response<S: Real>(&self, at: &Self::At<S>, load: [S; 3]) -> [S; 3];

    /// What a unit of speed of the pin along `t` adds to the sliding by turning, `r_p ∂spin/∂v·t`.
    fn turned_along<S: Real>(&self, at: &Self::At<S>, t: [S; 2], pin_radius: f64) -> S;

    /// Speed of the crank [rad/s].
    fn speed(&self) -> f64;

    /// Angle of the crank at the start [rad].
    fn start(&self) -> f64;

    /// The acceleration that the crank imposes on the joint [m/s²].
    fn acceleration_scale(&self) -> f64;

    /// What the bodies ask of the pin at that acceleration [N].
    fn force_scale(&self) -> f64;

    /// The sizes of the terms of the spin, added [rad/s].
    fn spin_bound(&self, y: &State<f64>) -> f64;

    /// Kinetic energy of what does not turn at the crank's constant speed [J].
    fn kinetic(&self, y: &State<f64>) -> f64;

    /// Torque that holds the speed of the crank [N m].
    fn torque(&self, y: &State<f64>, load: [f64; 3]) -> f64;

    /// Names and units of what moves with it.
    fn outputs(&self) -> Outputs;

    /// Their values at `y` under a load, in that order.
    fn output(&self, y: &State<f64>, load: [f64; 3]) -> Vec<f64>;

    /// The load on the pin of an ideal joint: that which keeps `Ẍ = Ÿ = 0`.
    fn ideal_load(&self, y: &State<f64>) -> [f64; 3] {
        let at = self.at(y);
        let [a_x, a_y, _] = self.accelerations(&at, None);
        let [x_x, y_x, _] = self.response(&at, [1.0, 0.0, 0.0]);
        let [x_y, y_y, _] = self.response(&at, [0.0, 1.0, 0.0]);
        let determinant = x_x * y_y - x_y * y_x;
        [(x_y * a_y - y_y * a_x) / determinant, (y_x * a_x - x_x * a_y) / determinant, 0.0]
    }
}

/// Names and units of what moves with a linkage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outputs {
    /// Angles and places.
    pub places: &'static [(&'static str, &'static str)],
    /// Their rates.
    pub rates: &'static [(&'static str, &'static str)],
    /// Accelerations, each followed by the same without clearance, called `ideal_` and its name.
    pub accelerations: &'static [(&'static str, &'static str)],
}

//! Where an integration is.

use crate::system::System;

/// Time, state and mode of an integration.
///
/// ```
/// use deltazero_solvers::problems::{BouncingBall, BouncingMode};
/// use deltazero_solvers::{Integration, Point};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let rest = Point { t: 0.0, y: [0.0; 2], mode: BouncingMode::Rest };
/// assert_eq!(Integration::at(&ball, rest).point.mode, BouncingMode::Rest);
/// ```
#[derive(Clone, Debug)]
pub struct Point<P: System> {
    /// Time.
    pub t: f64,
    /// State.
    pub y: P::State<f64>,
    /// Mode.
    pub mode: P::Mode,
}

//! The state of a joint.

/// State of a block: X, Y [m], θ [rad] and their rates. Of struts X is the pin displacement whose arm goes
/// with sin θ (x01, z02), Y the one with cos θ (y01, y02); of a linkage θ is the angle of the crank.
pub type State<S> = [S; 6];

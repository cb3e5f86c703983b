//! Event-aware integrators for hybrid initial value problems.

pub mod blind;
pub mod control;
pub mod dense;
pub mod diffsol;
pub mod erk;
pub mod error;
pub mod event;
pub mod integrate;
pub mod methods;
pub mod one_step;
pub mod phase;
pub mod real;
pub mod record;
pub mod root;
pub mod stats;
pub mod step;
pub mod system;
pub mod tableau;
pub mod tolerance;
pub mod trajectory;

pub use blind::{Blind, Unblind};
pub use control::Control;
pub use error::{Error, Outcome};
pub use integrate::Integration;
pub use methods::{METHODS, Method};
pub use phase::{PhaseSolver, Point};
pub use real::Real;
pub use record::{Accepted, Event, Record};
pub use stats::Stats;
pub use step::Step;
pub use system::{ModeOfState, Next, System, Vector};
pub use tolerance::Tolerance;
pub use trajectory::{Grid, Sample, Switch, Trajectory};

//! Which integrator, at which setting, for this contact?

pub mod config;
pub mod model;
pub mod run;

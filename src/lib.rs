//! Which integrator, at which setting, for this contact?

pub mod config;
pub mod energy_balance;
pub mod figures;
pub mod metrics;
pub mod model;
pub mod reference;
pub mod report;
pub mod run;
pub mod study;

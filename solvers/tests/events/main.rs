//! Every event rule under its own name, with every method.
//!
//! The rules are told in the crate's page [`rules`](deltazero_solvers::rules).

#[path = "../common/mod.rs"]
mod common;
mod log;
mod script;

mod accumulation;
mod backward;
mod batch;
mod crossings;
mod dips;
mod fast;
mod modes;
mod not_finite;
mod observing;
mod outgrown;
mod recorder;
mod refused;
mod rejecting;
mod resets;
mod runs;
mod simultaneous;
mod start;
mod sticking;

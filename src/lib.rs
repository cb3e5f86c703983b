//! Which integrator, at which setting, for this contact?
//!
//! A pin rattles in a bush with clearance c: free flight, then contact through a stiff spring with
//! damping and friction, some seven contacts a second, each begun and ended at the zero crossing δ = 0.
//! The equations are in [`model`]; [`deltazero_solvers`] integrates them with the modes frozen within each
//! step and every event located; [`deltazero_study`] compares methods and settings by error and work against a reference.
//! This crate is the program that runs all that and reports.
//!
//! ```
//! use deltazero::config::Config;
//! use deltazero::model::Joints;
//! use deltazero::run::{Run, setting};
//! use deltazero_solvers::Grid;
//! use deltazero_study::run::Limits;
//!
//! let config = Config::load(None, &["solver.rtol=1e-9".into(), "run.t_end=0.2".into()])?;
//! let setting = setting(&config).ok_or("no such method")?;
//! let limits = Limits { max_rhs: 1_000_000, max_seconds: 10.0, stop: &false.into() };
//! let grid = Grid::uniform(0.01, config.run.t_end);
//! let run = Run::new(&Joints::from(&config), &setting, config.run.t_end, &grid, limits);
//! assert_eq!(run.trajectories[0].samples.len(), 20);
//! assert_eq!(run.error(), None);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The modules in the order in which data flow through them:
//!
//! | module | what it is |
//! |---|---|
//! | [`keys`], [`laws`], [`model`], [`mechanisms`], [`config`] | what is integrated, of [`deltazero_mechanics`] |
//! | [`run`] | one run of a mechanism, joint by joint |
//! | [`study`] | what a configuration asks of the study, and the experiments on the mechanisms |
//! | [`paper`] | the claims of the paper, and what comes out of its equations |
//! | [`chunks`] | many runs, in parallel, kept on disk as they are made |
//! | [`sweep`] | the runs of a plan |
//! | [`figures`] | the figures, each a function from a table to a chart |
//! | [`report`] | tables to CSV, Markdown and an HTML page |
//! | [`studied`] | a study of any subject, with all its files |
//! | [`atomic_file`] | files that are there whole or not at all |

pub mod atomic_file;
pub mod chunks;
mod csv;
pub mod figures;
pub mod paper;
pub mod report;
pub mod run;
pub mod studied;
pub mod study;
pub mod sweep;

pub use deltazero_mechanics::{config, keys, laws, mechanisms, model};

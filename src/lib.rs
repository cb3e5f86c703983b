//! Which integrator, at which setting, for this contact?
//!
//! A pin rattles in a bush with clearance c: free flight, then contact through a stiff spring with
//! damping and friction, some fifteen times a second, each change at the zero crossing δ = 0. The
//! mechanism is a deployable strut bay with two such joints; joint 1 carries (x01, y01, θ1),
//! joint 2 (y02, z02, θ2), and the two share no term. In the coordinates (X, Y, θ) of one of them
//!
//! ```text
//! | M_x         0           S_x cos θ       | |Ẍ|   | S_x sin θ θ̇²           + Q_X |
//! | 0           M_y        −S_y sin θ       | |Ÿ| = | S_y cos θ θ̇²           + Q_Y |
//! | S_x cos θ  −S_y sin θ   I_0 + I_c cos²θ | |θ̈|   | I_c sin θ cos θ θ̇² + M + Q_θ |
//!
//! δ = √(X² + Y²) − c,   F_N = K δⁿ + D δ̇ in contact,   F_T = −sign(v_T) μ F_N or what v_T = 0 takes
//! ```
//!
//! with modes free, slip+, slip− and stick. [`model`] is these equations, [`deltazero_solvers`]
//! integrates them with the modes frozen within each step and every event located, and [`deltazero_study`]
//! compares methods and settings by error and work against a reference.
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
//! | [`keys`] | parameters with units and sources, the paper's Table 1 as the default |
//! | [`model`] | pins in bushes as hybrid systems, each a block, or a chain where there are several bays or bristles, with their laws; no time, no loop |
//! | [`mechanisms`] | the mechanisms, one a file: keys, problem, words |
//! | [`config`] | the configuration: keys and mechanism, read and checked |
//! | [`run`] | one run of a mechanism, joint by joint |
//! | [`study`] | what a configuration asks of the study, and the experiments on the paper's mechanism |
//! | [`chunks`] | many runs, in parallel, kept on disk as they are made |
//! | [`sweep`] | the runs of a plan |
//! | [`figures`] | the figures, each a function from a table to a chart |
//! | [`report`] | tables to CSV, Markdown and an HTML page |
//! | [`studied`] | a study of any subject, with all its files |
//! | [`whole`] | files that are there whole or not at all |

pub mod chunks;
pub mod config;
mod csv;
pub mod figures;
pub mod keys;
pub mod mechanisms;
pub mod model;
pub mod report;
pub mod run;
pub mod studied;
pub mod study;
pub mod sweep;
pub mod whole;

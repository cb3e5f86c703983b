//! A hybrid system from a text file that reads like the equations in a paper.
//!
//! ```text
//! ẏ = f_mode(t, y)  until an event;  an event sets states and leads to a mode
//! ```
//!
//! A file gives parameters, states, modes with their rates, and events. [`ModelFile::parse`] checks it, and
//! [`ModelFile::models`] compiles it with values of its parameters to a [`TextModel`], which is a
//! [`System`](deltazero_solvers::System) and a [`Problem`](deltazero_study::Problem):
//!
//! ```
//! use deltazero_solvers::{Control, Integration, Method, Tolerance};
//! use deltazero_study::Problem;
//! use deltazero_text::ModelFile;
//!
//! let text = r#"
//!     [parameters]
//!     g = { value = 9.81, unit = "m/s^2" }
//!     e = { value = 0.75, min = 0, max = 1 }
//!     [states]
//!     y = { start = 1.3, unit = "m" }
//!     v = { start = 0, unit = "m/s" }
//!     [modes.flight]
//!     rates = { y = "v", v = "-g" }
//!     events = [{ when = "y < 0", set = { y = "0", v = "-e*v" } }]
//! "#;
//! let ball = ModelFile::parse("ball.toml", text)?.models(&[("e".to_owned(), 0.5)])?.remove(0);
//! let tolerance = Tolerance { rtol: 1e-9, atol: vec![1e-9; 2] };
//! let method = Method::named("dop853").ok_or("no such method")?;
//! let mut solver = method.solver(&ball, Control::Adaptive(tolerance))?;
//! let mut run = Integration::new(&ball, 0.0, ball.start());
//! run.run(1.0, &mut *solver, &mut ())?;
//! assert_eq!(run.stats.n_events, 1);
//!
//! let report = ModelFile::parse("ball.toml", &text.replace("-g\"", "-G\"")).unwrap_err();
//! assert_eq!(report.to_string(), "\
//! error: nothing here is called `G`
//!  --> ball.toml:9:30
//!   |
//! 9 |     rates = { y = \"v\", v = \"-G\" }
//!   |                              ^
//!   |
//!   = help: did you mean `g`?");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! This crate reads no file, writes nothing and prints nothing: text in, values out. From a text to a model:
//!
//! | step | modules |
//! |---|---|
//! | read | `document` (TOML with places), `token` and `expression` (formulas), `declarations` (the file as it stands) |
//! | check | `names` (what they mean), `columns` of tables, `groups` of states, `units` and `dimensions`; complaints are `report`s |
//! | expand | `layout` (where states are, `shape`: what that follows from), `expand` (indices, sums, definitions) into one `graph`; `derivative`, `sparsity`, `jacobian` |
//! | compile | `compile`, mode by mode, to a `tape` of operations |
//! | run | a `program`: `evaluate` its tape with any number, or by `machine` code with `f64`; `functions` |
//! | tell | `mode`, `system`, `problem` |
//!
//! What formulas mean where a paper leaves it open: `xⁿ` of a whole number is a product; with an exponent above one that is
//! not whole it is continued past zero as an odd function, as a law of contact `K δⁿ` must be; a product with zero is zero.

mod columns;
mod compile;
mod declarations;
mod derivative;
mod dimensions;
mod document;
mod evaluate;
mod expand;
mod expression;
mod file;
mod functions;
mod graph;
mod groups;
mod jacobian;
mod layout;
mod leftovers;
#[cfg(feature = "machine-code")]
mod machine;
#[cfg(not(feature = "machine-code"))]
#[path = "machine_off.rs"]
mod machine;
mod mode;
pub mod models;
mod names;
mod problem;
mod program;
mod report;
mod shape;
mod sparsity;
mod system;
mod tape;
mod token;
mod units;
mod vector;

pub use declarations::SETTINGS;
pub use file::{ModelFile, Parameter, Range};
pub use mode::Mode;
pub use report::Report;
pub use system::TextModel;
pub use vector::{Any, Family, Few};

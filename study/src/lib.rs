//! Which integrator, at which setting, for this problem? The study of any hybrid system.
//!
//! A [`Problem`] is a [`System`](deltazero_solvers::System) that also tells where it starts and what its states are.
//! A [`Plan`] lists the runs. [`work_precision()`] makes a reference, tells its error, and compares every run with it:
//!
//! ```text
//! e = max over samples t_i and groups g of  ‖y_g(t_i) − y_g,ref(t_i)‖₂ / scale_g
//! ```
//!
//! | module | what it is |
//! |---|---|
//! | [`problem`], [`problems`] | what a study must know of a system, and what it may know; those with closed forms |
//! | [`part`] | a subject: one problem or several, whatever their types |
//! | [`setting`], [`plan`] | a method with its tolerance or step; the runs of a study |
//! | [`run`] | one run, timed, within limits |
//! | [`simulation`], [`motion`], [`brief`] | one run, and all that it tells; what a figure shows of it; its end in numbers |
//! | [`mod@reference`] | the run that errors are measured against, and its own error and horizon |
//! | [`errors`] | errors of states, events and contacts; where the work went |
//! | [`energy_balance`], [`self_check`], [`horizon`] | what a run tells of itself |
//! | [`mod@work_precision`], [`steps`] | the tables of a study |
//! | [`selection`], [`map`] | which method reaches an accuracy at the least cost; over two parameters of a model |

mod accepted;
mod account;
mod balance;
pub mod brief;
pub mod check;
pub mod columns;
pub mod digits;
pub mod energy_balance;
pub mod errors;
pub mod forecast;
pub mod horizon;
pub mod json_number;
mod kinds;
pub mod map;
pub mod measured;
pub mod motion;
pub mod nudge;
pub mod parallel;
pub mod part;
pub mod plan;
mod points;
pub mod problem;
pub mod problems;
pub mod quadrature;
pub mod quantile;
pub mod recommend;
pub mod reference;
pub mod run;
pub mod selection;
pub mod self_check;
pub mod setting;
pub mod simulation;
pub mod steps;
pub mod stiffness;
pub mod trace;
pub mod warning;
pub mod work_precision;

pub use part::{Part, Subject};
pub use plan::Plan;
pub use problem::Problem;
pub use work_precision::work_precision;

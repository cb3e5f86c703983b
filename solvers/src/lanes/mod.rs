//! Several runs of one model, or of models of a kind, computed with at once, each with its own step size, mode
//! and events, and the bits that it has alone.
//!
//! A right-hand side is a chain of operations that wait for each other: a root, a division, a force, an
//! acceleration. Vector instructions do as many of it as there are [lanes](scalar::LANES) in the time of
//! one. Runs in the same mode are put together, whatever their times and steps:
//!
//! ```text
//! starts, slopes, t, h of each run  →  a number of all runs, [`Lanes`](scalar::Lanes)
//! stages, end, slope there, norms of the errors, guards and their rates: at once
//! verdict, record, the next step; where a guard may have fallen, its search, landing, transition: of each
//! ```
//!
//! The code of a step is the one of [`erk`](crate::erk) or [`taylor`](crate::taylor) over another scalar, that of
//! events is the one of each run. A vector instruction rounds as the scalar one does, elementary functions are those of `libm`
//! operation by operation or run by run, so nothing that comes out depends on the company: states, times,
//! events and counts of work. Runs that leave a mode wait for others in their next one.
//!
//! [`Method::run_many`](crate::Method::run_many) is the way in. It asks two things:
//!
//! - The method has an explicit tableau. Others, and models of another kind, run one after the other.
//! - The model says that it is [for lanes](crate::System::IN_LANES): no decision on a number inside a mode.
//!   One that says so and decides is stopped by a panic, not wrong.
//!
//! All runs share the model with its parameters. Those of a sweep over a parameter have a model each and
//! run one after the other; so do, in effect, runs whose modes carry data of their own.
//!
//! [`Method::run_pair`](crate::Method::run_pair) is the way in for two runs of models that are
//! [alike](crate::Alike): constants of model and mode are then [numbers of each run](scalar::Own), so that two joints,
//! or slips to either side, share a vector of two. A run whose mode is of another form goes on alone meanwhile.
//! A step leaves the vectors only where an event is near or a recorder [needs](crate::Needs) it; of others, time, size and
//! counts alone go on.
//! Two [series](crate::taylor) of one order, to tolerances, are expanded at once too, and those of the guards with
//! them; a run whose series is to be cut takes that step alone.

mod attempt;
pub mod dual;
mod field;
mod lane;
pub(crate) mod pair;
pub(crate) mod pool;
pub mod scalar;
mod series;
mod sin_cos;

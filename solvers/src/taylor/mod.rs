//! The Taylor method: it expands the solution in a Taylor series through the generic right-hand side, to any order.
//!
//! ```text
//! y(t₀ + s) = Σ y_k sᵏ,   y_(k+1) = f_k/(k + 1),   k = 0 … N − 1
//! ```
//!
//! The coefficients of one order follow from those of the lower ones, by the [`recurrence`] of each operation. There are two ways
//! through the operations of [`System::rhs`](crate::System::rhs):
//!
//! - It is evaluated once per order, with a [scalar](series) that computes one coefficient at a time; the lower ones are in
//!   a [table](rows). With code for each order, in which the compiler sees every operation, nothing is faster.
//! - It is evaluated once per step, with a scalar that [notes](trace) the operations, and every order follows the notes. So it is for
//!   [many states](crate::Vector::IS_SHORT), for systems that [ask for it](crate::System::IS_TRACED), and for double-double numbers.
//!
//! A model needs nothing special for either, but [`length`](crate::real::Shortcuts::length), [`over`](crate::real::Shortcuts::over) and
//! [`turning`](crate::real::Shortcuts::turning) save sums where they apply. Up to order five the guards are expanded with the
//! slope: in the same evaluation where they [share](crate::System::rhs_with_guards) terms with it, else in one of their own.
//!
//! A step [is its polynomial](method): its size follows from the [last terms](order), its dense
//! output is the polynomial itself, and cutting it short needs no new series. The order follows from the tolerance;
//! fixed steps have order 8.
//!
//! At a singular point of the right-hand side, such as δ^1.5 at δ = 0, the coefficients from some order on are
//! not finite or grow without bound. The series is then cut below that order, and the step is judged by its defect.
//!
//! À. Jorba, M. Zou, "A software package for the numerical integration of ODEs by means of high-order
//! Taylor methods", Exp. Math. 14(1), 99–117 (2005).

pub mod coefficient;
mod constants;
pub mod expand;
#[cfg(feature = "extended")]
pub mod extended;
pub mod guards;
pub mod method;
pub mod order;
pub mod polynomial;
pub mod recurrence;
pub mod rows;
pub mod series;
pub mod trace;
mod unrolled;

pub(crate) use expand::Operations;
#[cfg(feature = "extended")]
pub use extended::ExtendedIntegration;
pub use method::{TaylorMethod, TaylorStep};
pub use order::{FIXED_STEP_ORDER, order_for};
pub use rows::MAX_ORDER;

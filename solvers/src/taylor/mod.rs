//! The Taylor method: it expands the solution in a Taylor series through the generic right-hand side, to any order.
//!
//! ```text
//! y(t₀ + s) = Σ y_k sᵏ,   y_(k+1) = f_k/(k + 1),   k = 0 … N − 1
//! ```
//!
//! [`System::rhs`](crate::System::rhs) is evaluated once per order with a [scalar](series) that knows the
//! [`recurrence`] of each operation and computes one coefficient at a time; the lower coefficients are in a
//! [table](rows). A model needs nothing special for this, but [`length`](crate::Real::length),
//! [`over`](crate::Real::over) and [`turning`](crate::Real::turning) save sums where they apply. Up to order five the
//! guards are expanded in the same evaluation, and may [share](crate::System::rhs_with_guards) terms with the
//! right-hand side. A step [is its polynomial](method): its size follows from the [last terms](order), its dense
//! output is the polynomial itself, and cutting it short needs no new series. The order follows from the tolerance;
//! fixed steps have order 8.
//!
//! At a singular point of the right-hand side, such as δ^1.5 at δ = 0, the coefficients from some order on are
//! infinite or grow without bound. The series is then cut below that order, and the step is judged by its defect.
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
mod unrolled;

pub(crate) use expand::Operations;
#[cfg(feature = "extended")]
pub use extended::ExtendedIntegration;
pub use method::{TaylorMethod, TaylorStep};
pub use order::{FIXED_STEP_ORDER, order_for};
pub use rows::MAX_ORDER;

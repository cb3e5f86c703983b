//! Event-aware integrators for hybrid initial value problems.
//!
//! A hybrid system is smooth in each of several modes. It switches to another mode where a guard of its present mode
//! falls below zero:
//!
//! ```text
//! ẏ = f_mode(t, y)                          while every guard g_i(t, y) of the mode is ≥ 0
//! (mode, y) ← transition(mode, i, t, y)     where guard g_i falls below zero
//! y(t₀) = y₀,  mode(t₀) = initial_mode(t₀, y₀)
//! ```
//!
//! A step is taken in one mode, cut where the first guard falls below zero, and the next step begins in the next
//! mode. So a method keeps its order through impacts and sticking. A method that meets an `if` in its right-hand side
//! falls to first order there. Times, states and guards have the units of the model.
//!
//! A ball dropped from 1 m, which keeps half its speed at each bounce:
//!
//! ```
//! use deltazero_solvers::problems::BouncingBall;
//! use deltazero_solvers::{Error, METHODS, Run};
//!
//! let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
//! for method in METHODS.iter().filter(|method| !method.is_fixed_step()) {
//!     let run = Run::of(&ball, ball.start()).method(method.name).tolerance(1e-9, 1e-9).to(1.3)?;
//!     assert_eq!(run.trajectory.events.len(), 5);
//!     for (n, bounce) in run.trajectory.events.iter().enumerate() {
//!         assert!((bounce.t - ball.bounce_time(n)).abs() < 1e-7);
//!     }
//! }
//! # Ok::<(), Error>(())
//! ```
//!
//! A model implements [`System`]. The model above, in full, is `examples/own_model.rs`:
//!
//! ```
#![doc = include_str!("../examples/own_model.rs")]
//! ```
//!
//! # Methods
//!
//! | name | method | order | step |
//! |---|---|---|---|
//! | `rk4` | [classical Runge–Kutta](methods::CLASSICAL_4) | 4 | fixed |
//! | `rk43` | [Kutta's 3/8 rule](methods::KUTTA_43) with an error estimate | 4 | fixed or adaptive |
//! | `bs32` | [Bogacki–Shampine 3(2)](methods::BOGACKI_SHAMPINE_3) | 3 | fixed or adaptive |
//! | `rk45` | [Dormand–Prince 5(4)](methods::DORMAND_PRINCE_5) | 5 | fixed or adaptive |
//! | `dop853` | [Dormand–Prince 8(5,3)](methods::DORMAND_PRINCE_853) | 8 | fixed or adaptive |
//! | `vern98` | [Verner 9(8)](methods::VERNER_98) | 9 | fixed or adaptive |
//! | `taylor` | [Taylor series](taylor) | 8, or by the tolerance | fixed or adaptive |
//! | `rodas5p` | [Rodas5P](methods::RODAS_5P), implicit | 5 | fixed or adaptive |
//! | `radau5` | [Radau IIA](methods::RADAU_IIA_5), implicit | 5 | fixed or adaptive |
//! | `bdf` | [BDF of the library `diffsol`](diffsol) | 1 to 5 | adaptive |
//! | `tr_bdf2` | TR-BDF2 of `diffsol` | 2 | adaptive |
//! | `esdirk34` | ESDIRK 3(4) of `diffsol` | 3 | adaptive |
//! | `tsit45` | Tsitouras 5(4) of `diffsol` | 5 | adaptive |
//! | `auto` | [switches](auto) between an explicit and an implicit method | 4, 8 or by the tolerance, implicit 5 | adaptive |
//!
//! A Butcher tableau that is not in this list is used as [`tableau`] shows.
//!
//! # Choosing a method
//!
//! 1. You do not know, or the stiffness changes during the run: `auto`.
//! 2. Nothing is stiff, and some three digits are enough: `rk45`, or `rk4` with a step that you know.
//! 3. Six digits: `dop853`; `taylor`, where the states are few and in an array.
//! 4. Nine digits and more: `taylor`, or `vern98`.
//! 5. Stiff: a fast motion dies out, as in a contact with a damping ratio of one and more: `radau5`. To three digits `rodas5p` or
//!    `bdf` may be faster.
//! 6. A fast motion that does not die out (a stiff spring without damping) must be followed, and an explicit method does it best; where
//!    its swings no longer count, `radau5` steps over them.
//! 7. Many states that are stiff: `radau5`, whose linear systems are sparse from 32 states on.
//! 8. `bdf` begins at order one after each event, so events make it slow. The methods of `diffsol` have no limit of the step.
//! 9. Run twice, the second time at a hundredth of the tolerance: the difference is the error of the first run, and an event that
//!    one of them lacks is uncertain.
//! 10. `deltazero recommend` measures it on your model.
//!
//! # Features
//!
//! | feature | default | adds |
//! |---|---|---|
//! | `diffsol` | yes | the methods `bdf`, `tr_bdf2`, `esdirk34` and `tsit45` of the library `diffsol`; includes `sparse` |
//! | `sparse` | yes | sparse linear systems of implicit methods from 32 states on, by the library `faer` |
//! | `extended` | yes | [runs with twice the digits](taylor::ExtendedIntegration) of an `f64` |
//! | `serde` | no | results and settings that `serde` writes and reads |
//!
//! A result does not depend on the features, except that dense and sparse linear systems round differently.
//!
//! # Modules, in the order in which data flow
//!
//! - The problem: [`system`], the scalar type that it is generic over ([`real`], [`lanes`] of several runs), [`problems`] with closed forms, and
//!   the event-blind baseline ([`blind`]).
//! - The methods: their list ([`methods`]); [`tableau`]s and their stage loop ([`erk`]); implicit methods without
//!   iteration ([`rosenbrock`]) and with it ([`radau`]). The coefficients of all of these are checked by
//!   [`order_conditions`]. Methods without a tableau are [`taylor`] series; the library [`diffsol`](mod@diffsol); and
//!   the method that chooses between others ([`auto`]).
//! - One step: [`step`] with its [`dense`] output, accepted or rejected by [`control`] to a [`tolerance`].
//! - Events: [`event_location`] finds guards that fall within a step, and when, by the root finders of [`root`].
//!   What counts as rounding there is found in [`rounding`].
//! - One smooth phase: [`phase`] defines the contract, [`one_step`] fulfils it for methods that hand on a step.
//! - The run: [`run`] has its options with their defaults; [`integrate`] joins phases and transitions and counts work in [`stats`]; it ends in an outcome or an
//!   [`error`]. Runs of systems of a kind are computed several at once by [`Method::run_batch`], in a [`batch`].
//! - Derivatives by start values and parameters, through events: [`sensitivity`].
//! - What a model promises so that it is faster, and whether it keeps it: [`contracts`].
//! - Proofs: intervals that contain the exact solution and the times of its events ([`enclosure`]).
//! - Results: a recorder ([`record`]) sees each event, and each step that it needs; [`trajectory`] keeps them.
//!   Functions are [observed](observe) along a run without a change of it.
//!
//! [`rules`] states case by case what is promised of events, and what is not.

pub mod auto;
pub mod batch;
pub mod blind;
pub mod contracts;
pub mod control;
pub mod dense;
#[cfg(feature = "diffsol")]
pub mod diffsol;
#[cfg(not(feature = "diffsol"))]
#[path = "never_diffsol.rs"]
mod diffsol;
#[cfg(feature = "extended")]
pub mod double_double;
mod doubt;
pub mod enclosure;
pub mod erk;
pub mod error;
pub mod event_location;
pub mod integrate;
pub mod lanes;
mod linear;
mod magnitude;
pub mod methods;
pub mod observe;
pub mod one_step;
pub mod order_conditions;
pub mod phase;
mod point;
pub mod problems;
pub mod radau;
pub mod real;
pub mod record;
pub mod root;
pub mod rosenbrock;
pub mod rounding;
pub mod rules;
pub mod run;
pub mod sensitivity;
mod sparsity;
pub mod stats;
pub mod step;
pub mod system;
pub mod tableau;
mod tableaux;
pub mod taylor;
pub mod tolerance;
pub mod trajectory;
mod work;

pub use blind::{Blind, Unblind};
pub use control::{Control, Steps};
pub use error::{Error, Outcome};
pub use integrate::Integration;
pub use methods::{METHODS, Method};
pub use phase::PhaseSolver;
pub use point::Point;
pub use real::{Over, Real};
pub use record::{Accepted, Event, Grazing, Needs, Record, Watch};
pub use run::{Run, Solution};
pub use sensitivity::Sensitive;
pub use stats::WorkByKind;
pub use step::Step;
pub use system::{Alike, ModeOfState, Next, System, Vector};
pub use tolerance::Tolerance;
pub use trajectory::{Grid, Sample, Switch, Trajectory};
pub use work::{Stats, Work};

//! Straight-line formulas as machine code for the processor that runs the program.
//!
//! A [`Routine`] is made of a function that is described operation by operation, and is called with slices:
//!
//! ```
//! use deltazero_machine::{Routine, Shape};
//!
//! // ẋ = v, v̇ = −k x, with k held by the mode
//! let shape = Shape { n_states: 2, n_held: 1, n_first: 2, n_second: 0 };
//! let rates = Routine::new(shape, |f| {
//!     let (x, v, k) = (f.state(0), f.state(1), f.held(0));
//!     let force = f.multiply(k, x);
//!     let rate = f.negative(force);
//!     f.write_first(0, v);
//!     f.write_first(1, rate);
//! })?;
//! let mut dydt = [0.0; 2];
//! rates.call(0.0, &[0.5, 2.0], &[4.0], &mut dydt, &mut []);
//! assert_eq!(dydt, [2.0, -2.0]);
//! # Ok::<(), deltazero_machine::Error>(())
//! ```
//!
//! Each operation is the one of IEEE 754 that Rust has for `f64`, in the order of the description, none fused with
//! another: the results have the bits of the same formulas in Rust, but for sign and payload of what is no number. Other functions are [called](Function::call) where they
//! are.
//!
//! This is the one crate of the workspace with `unsafe` code, in `routine.rs`: the memory that holds the code is called, and
//! released when its routine is dropped (on Windows it is kept). There is no branch and no loop in the code, and it reads and writes within
//! the lengths of its [`Shape`], which [`Routine::call`] holds its slices to.

mod function;
mod routine;

pub use function::{Function, Number, Shape};
pub use routine::Routine;

/// Why there is no code.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A list of states, held values or results is too long.
    #[error("a list is too long for machine code")]
    TooLong,
    /// Code cannot be made for this processor.
    #[error("no machine code can be made for this processor: {0}")]
    Processor(String),
    /// The code generator refused a function, or no memory may be made executable.
    #[error("no machine code was made: {0}")]
    Generator(Box<cranelift_module::ModuleError>),
}

impl From<cranelift_module::ModuleError> for Error {
    fn from(error: cranelift_module::ModuleError) -> Self {
        Self::Generator(Box::new(error))
    }
}

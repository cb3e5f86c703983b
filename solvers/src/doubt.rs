//! Why something is not proven.

/// Why a solution cannot be enclosed further. It need not mean that the solution is special: a wider set of states
/// makes each of these more likely.
///
/// ```
/// use deltazero_solvers::enclosure::{Doubt, Enclosure};
/// use deltazero_solvers::problems::{BouncingBall, TwoBalls};
/// use deltazero_solvers::{Error, System, Tolerance};
///
/// let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
/// let balls = TwoBalls { balls: [ball, ball] };
/// let mode = balls.initial_mode(0.0, &balls.start());
/// let tolerance = Tolerance { rtol: 1e-16, atol: vec![1e-16; 4] };
/// let mut enclosure = Enclosure::new(&balls, mode, 0.0, &balls.start(), tolerance)?;
/// // Equal balls land at one instant.
/// let found = enclosure.advance(1.0).err();
/// let doubt = Doubt::Order { guards: [0, 1] };
/// assert!(matches!(found, Some(Error::NotProven { doubt: found, .. }) if found == doubt));
/// # Ok::<(), Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Doubt {
    /// No box was found that the solution stays in.
    #[error(
        "no box is found that the states stay in for a step of any size; the right-hand side may use a function that has no bounds here"
    )]
    NoBox,
    /// The right-hand side or the guards decide by a number that is not known to a point.
    #[error(
        "the right-hand side or the guards branch on a number that differs among the states that are possible"
    )]
    Branch,
    /// The mode may begin before or after the time asked for.
    #[error(
        "the mode begins with an event that may be before or after the time asked for; a later one may be reached"
    )]
    Begin,
    /// A guard that is zero at the start of a phase is not shown to rise.
    #[error("guard {guard} is about zero where the mode begins, and is not shown to rise")]
    Rise {
        /// Index of the guard.
        guard: usize,
    },
    /// A guard is near zero, and may fall or not.
    #[error("guard {guard} comes so near to zero that it may fall below it or not")]
    Touch {
        /// Index of the guard.
        guard: usize,
    },
    /// Two guards may fall in either order.
    #[error("guards {guards:?} may fall in either order")]
    Order {
        /// Indices of the guards.
        guards: [usize; 2],
    },
    /// What follows an event differs among the states that are possible.
    #[error("what follows when guard {guard} falls differs among the states that are possible")]
    Transition {
        /// Index of the guard.
        guard: usize,
    },
    /// An event may be before or after the time asked for.
    #[error("guard {guard} may fall before or after the end of the step")]
    End {
        /// Index of the guard.
        guard: usize,
    },
}

//! The tools written in Rust, one a file: each offers its entries.

mod differential_equations;
mod diffsol;
mod hand;
mod ode_solvers;
mod ours;
mod russell;

use crate::entry::Entry;
use crate::problem::Problem;

/// Ours and the hand-written code: what is measured in a plain build too.
pub(crate) fn own(problem: &Problem) -> Vec<Entry<'_>> {
    let mut entries = ours::entries(problem);
    entries.extend(hand::entries(problem));
    entries
}

/// The other crates.
pub(crate) fn crates(problem: &Problem) -> Vec<Entry<'_>> {
    let mut entries = diffsol::entries(problem);
    entries.extend(ode_solvers::entries(problem));
    entries.extend(differential_equations::entries(problem));
    entries.extend(russell::entries(problem));
    entries
}

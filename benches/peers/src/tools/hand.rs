//! The hand-written integrators.

use crate::entry::{Entry, Handling, atol, ladder};
use crate::hand::{Dop853, Dopri5, Joint, run};
use crate::problem::Problem;

/// Name and version of the tool.
const TOOL: (&str, &str) = ("hand-written", env!("CARGO_PKG_VERSION"));

/// Both methods, under the names that ours have.
pub(super) fn entries(problem: &Problem) -> Vec<Entry<'_>> {
    let times = &problem.times;
    let dopri5 = ladder().map(|rtol| {
        let run = move || {
            problem.both(|block| {
                let start = block.initial_state();
                Ok(run::<Dopri5>(&Joint::new(block), start, times, rtol, &atol(block, rtol))?)
            })
        };
        Entry::new(TOOL, ("rk45", Handling::Located), rtol, run)
    });
    let dop853 = ladder().map(|rtol| {
        let run = move || {
            problem.both(|block| {
                let start = block.initial_state();
                Ok(run::<Dop853>(&Joint::new(block), start, times, rtol, &atol(block, rtol))?)
            })
        };
        Entry::new(TOOL, ("dop853", Handling::Located), rtol, run)
    });
    dopri5.chain(dop853).collect()
}

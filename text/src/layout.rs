//! Where the states and the values that a mode holds are in their vectors.

use crate::declarations::Declarations;
use crate::report::{Checked, Complaint};

/// States of a model, at most.
pub(crate) const MOST_STATES: usize = 100_000;
/// Modes of a model, at most.
pub(crate) const MOST_MODES: usize = 1000;
/// Events of all modes, at most.
pub(crate) const MOST_EVENTS: usize = 100_000;
/// Values that a mode holds, at most.
pub(crate) const MOST_HELD: usize = 8;

/// Where each declared state begins, and how many it is.
#[derive(Clone, Debug, Default)]
pub(crate) struct Layout {
    /// First index of each declared state.
    pub(crate) first: Vec<usize>,
    /// Length of each vector; none of what is one state.
    pub(crate) length: Vec<Option<usize>>,
    /// Number of all states.
    pub(crate) n: usize,
    /// Number of discrete values, which are held first.
    pub(crate) n_discrete: usize,
}

impl Layout {
    /// The layout of states of these lengths.
    pub(crate) fn new(file: &Declarations, length: Vec<Option<usize>>) -> Checked<Self> {
        let (mut first, mut n) = (Vec::new(), 0);
        for (state, length) in file.states.iter().zip(&length) {
            first.push(n);
            n += length.unwrap_or(1);
            if n > MOST_STATES {
                let message = format!("a model has {MOST_STATES} states at most");
                return Err(Complaint::new(state.name.span, message).help("make `length` smaller"));
            }
        }
        if let Some(mode) = file.modes.get(MOST_MODES) {
            let message = format!("a model has {MOST_MODES} modes at most");
            return Err(Complaint::new(mode.name.span, message)
                .help("what differs between modes by numbers alone may be a discrete value"));
        }
        let n_discrete = file.discrete.len();
        let most_kept = file.modes.iter().max_by_key(|mode| mode.keep.len());
        let n_held = n_discrete + most_kept.map_or(0, |mode| mode.keep.len());
        if n_held > MOST_HELD {
            let place = most_kept.and_then(|mode| mode.keep.last()).or(file.discrete.last());
            let span = place.map_or(file.states[0].name.span, |named| named.name.span);
            let message =
                format!("{n_held} values are kept or discrete; a mode holds {MOST_HELD} at most");
            return Err(
                Complaint::new(span, message).help("make some of them states with the rate 0")
            );
        }
        Ok(Self { first, length, n, n_discrete })
    }

    /// The indices of a declared state.
    pub(crate) fn range(&self, state: usize) -> std::ops::Range<usize> {
        let first = self.first[state];
        first..first + self.length[state].unwrap_or(1)
    }

    /// Names of all states, `x` or `x[3]`.
    pub(crate) fn names(&self, file: &Declarations) -> Vec<String> {
        let names = file.states.iter().zip(&self.length).flat_map(|(state, length)| {
            let name = &state.name.value;
            match length {
                None => vec![name.clone()],
                Some(n) => (1..=*n).map(|i| format!("{name}[{i}]")).collect(),
            }
        });
        names.collect()
    }
}

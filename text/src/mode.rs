//! The mode of a run.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::{Mutex, PoisonError};

use crate::layout::MOST_HELD;

/// Names of modes, each once, kept as long as the program runs: a mode carries its name for messages wherever it goes, and a sweep
/// compiles one file again and again.
static NAMES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());

/// This name, as it is kept.
pub(crate) fn kept_name(name: &str) -> &'static str {
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = names.get(name) {
        return known;
    }
    let own = Box::leak(Box::<str>::from(name));
    names.insert(own);
    own
}

/// The mode of a run: which one it is, and the values that it holds, discrete ones and those kept on entry.
///
/// It is copied at every evaluation, so it holds only these and a reference to its name.
#[derive(Clone, Copy)]
pub struct Mode {
    pub(crate) held: [f64; MOST_HELD],
    pub(crate) number: u16,
    /// The mode before the last event. It is no part of what the mode is.
    pub(crate) before: u16,
    name: &'static str,
}

impl Mode {
    /// The mode of this number and name, entered from `before`.
    pub(crate) fn new(
        number: usize,
        name: &'static str,
        held: [f64; MOST_HELD],
        before: u16,
    ) -> Self {
        Self { held, number: number as u16, before, name }
    }
}

/// Two modes are equal whose numbers and values are.
impl PartialEq for Mode {
    fn eq(&self, other: &Self) -> bool {
        self.number == other.number && self.held == other.held
    }
}

impl fmt::Debug for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

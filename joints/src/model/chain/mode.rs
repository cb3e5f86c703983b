//! The mode of a chain: one for each joint.

use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

use crate::model::Mode;

/// Runs of equal modes that a message shows.
const MOST_RUNS: usize = 8;

/// The modes of all joints of a chain, from the root. A copy is another handle to the same list.
#[derive(Clone, PartialEq)]
pub struct Modes(Arc<[Mode]>);

impl Modes {
    /// The same but for joint `k`.
    pub(super) fn with(mut self, k: usize, mode: Mode) -> Self {
        Arc::make_mut(&mut self.0)[k] = mode;
        self
    }
}

impl From<Vec<Mode>> for Modes {
    fn from(modes: Vec<Mode>) -> Self {
        Self(modes.into())
    }
}

impl Deref for Modes {
    type Target = [Mode];

    fn deref(&self) -> &[Mode] {
        &self.0
    }
}

impl fmt::Debug for Modes {
    /// The first runs of equal modes: `slip+, free ×12, slip-`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, run) in self.chunk_by(Mode::eq).enumerate() {
            let comma = if i > 0 { ", " } else { "" };
            if i == MOST_RUNS {
                return write!(f, "{comma}…");
            }
            write!(f, "{comma}{}", run[0])?;
            if run.len() > 1 {
                write!(f, " ×{}", run.len())?;
            }
        }
        Ok(())
    }
}

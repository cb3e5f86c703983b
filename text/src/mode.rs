//! The mode of a run.

use std::fmt;

use crate::layout::MOST_HELD;

/// Bytes of a name that a mode carries.
const NAME: usize = 19;

/// The mode of a run: which one it is, and the values that it holds, discrete ones and those kept on entry.
///
/// It is copied at every evaluation, so it holds no more than that. It carries the beginning of its name for messages.
#[derive(Clone, Copy)]
pub struct Mode {
    pub(crate) held: [f64; MOST_HELD],
    pub(crate) number: u16,
    /// The mode before the last event. It is no part of what the mode is.
    pub(crate) before: u16,
    length: u8,
    name: [u8; NAME],
}

impl Mode {
    /// The mode of this number and name, entered from `before`.
    pub(crate) fn new(number: usize, name: &str, held: [f64; MOST_HELD], before: u16) -> Self {
        let ends = name.char_indices().map(|(at, c)| at + c.len_utf8());
        let length = ends.take_while(|end| *end <= NAME).last().unwrap_or(0);
        let mut bytes = [0; NAME];
        bytes[..length].copy_from_slice(&name.as_bytes()[..length]);
        Self { held, number: number as u16, before, length: length as u8, name: bytes }
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
        let name = &self.name[..usize::from(self.length)];
        f.write_str(std::str::from_utf8(name).unwrap_or_default())
    }
}

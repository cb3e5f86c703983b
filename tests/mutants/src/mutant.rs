//! A change, as `cargo mutants --list --json` tells it.

use std::path::Path;

use serde::Deserialize;

use crate::Failure;

/// A change of one place.
#[derive(Deserialize)]
pub struct Mutant {
    /// The file, from the root of the workspace.
    pub file: String,
    /// Place and change in words.
    pub name: String,
    /// What is changed: an operator, the value of a function, an arm.
    pub genre: String,
    /// What stands there instead.
    pub replacement: String,
    /// Where it stands.
    pub span: Span,
}

/// From where to where.
#[derive(Deserialize)]
pub struct Span {
    /// Its first character.
    pub start: Place,
}

/// Line and column, both from 1.
#[derive(Deserialize)]
pub struct Place {
    pub line: usize,
    pub column: usize,
}

impl Mutant {
    /// The changes in a file of `cargo mutants`, whose index is their number.
    pub fn listed(path: &Path) -> Result<Vec<Self>, Failure> {
        Ok(serde_json::from_slice(&std::fs::read(path)?)?)
    }
}

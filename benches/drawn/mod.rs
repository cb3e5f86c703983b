//! Configurations drawn at random, run by methods of different kind, and judged: shared by the bench `random` and by
//! tests.
#![allow(dead_code, reason = "each target uses its part")]

pub(crate) mod audit;
pub(crate) mod draw;
pub(crate) mod ran;
pub(crate) mod random;
pub(crate) mod verdict;
mod whatever;

use audit::Budget;
use draw::Draw;
use verdict::{Class, Verdict};

/// A draw and what came of it.
pub(crate) struct Judged {
    pub(crate) i: u64,
    pub(crate) draw: Draw,
    pub(crate) verdict: Verdict,
}

impl Judged {
    /// A draw, number `i`.
    pub(crate) fn new(draw: Draw, i: u64, budget: Budget) -> Self {
        let verdict = match draw.config() {
            Ok(config) => Verdict::of(&config, budget),
            Err(error) => Verdict::refused(error.to_string()),
        };
        Self { i, draw, verdict }
    }

    /// The file of it, what happened on top.
    pub(crate) fn toml(&self) -> String {
        let Verdict { class, lines, .. } = &self.verdict;
        self.draw.toml(&format!("{class}\n{}", lines.join("\n")))
    }

    /// Whether it is of this class.
    pub(crate) fn is(&self, class: Class) -> bool {
        self.verdict.class == class
    }
}

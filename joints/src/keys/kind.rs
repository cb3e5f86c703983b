//! What kind of value a key takes, and the words for it.

use super::range::Range;

/// The values a key takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number; an integer is accepted as well.
    Number(Range),
    /// An integer between two bounds, both included; `1e6` and `3.0` are accepted as well.
    Integer(i64, i64),
    /// `true` or `false`.
    Boolean,
    /// One of these words.
    Word(&'static [&'static str]),
    /// A list of such values, not empty.
    List(&'static Kind),
    /// A list of such values that differ, not empty.
    Set(&'static Kind),
    /// A value of any of these kinds.
    OneOf(&'static [Kind]),
}

impl Kind {
    /// The limits in words, with the unit: `N s/m, at least 0`; empty for booleans.
    pub fn limits(&self, unit: &str) -> String {
        let limits = match self {
            Self::Number(range) => range.to_string(),
            Self::Integer(low, high) => format!("from {low} to {high}"),
            Self::Boolean => String::new(),
            Self::Word(words) => listing(words),
            Self::List(of) | Self::Set(of) => format!("each {}", of.limits("")),
            Self::OneOf(kinds) => {
                let limits: Vec<_> = kinds.iter().map(|kind| kind.limits("")).collect();
                limits.join(", or ")
            }
        };
        match (unit, limits.as_str()) {
            ("", _) => limits,
            (_, "") => unit.to_owned(),
            _ => format!("{unit}, {limits}"),
        }
    }

    /// The kind in words: `a number (N s/m, at least 0)`.
    pub fn expected(&self, unit: &str) -> String {
        match self {
            Self::Number(_) => format!("a number ({})", self.limits(unit)),
            Self::Integer(..) => format!("an integer ({})", self.limits(unit)),
            Self::Boolean => "true or false".to_owned(),
            Self::Word(words) => format!("a word ({})", listing(words)),
            Self::List(of) | Self::Set(of) => {
                format!("a list, at least one entry, each {}", of.expected(unit))
            }
            Self::OneOf(kinds) => {
                let kinds: Vec<_> = kinds.iter().map(|kind| kind.expected(unit)).collect();
                kinds.join(", or ")
            }
        }
    }
}

/// Words as a sentence has them: `pin, full or centroid`.
pub fn listing(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [word] => (*word).to_owned(),
        [first @ .., last] => format!("{} or {last}", first.join(", ")),
    }
}

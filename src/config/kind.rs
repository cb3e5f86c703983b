//! What kind of value a key takes: one description, from which the check of a value and the wording
//! of its refusal follow.

use serde_json::Value;

use super::error::ConfigError;
use super::given::{Datum, Given};
use super::nearest::nearest_word;
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
    /// A list of such values: not empty, or of a fixed length.
    List(&'static Kind, Option<usize>),
    /// A value of any of these kinds.
    OneOf(&'static [Kind]),
}

/// Largest integer up to which every integer is an f64: 2⁵³.
const EXACT: f64 = 9_007_199_254_740_992.0;

impl Kind {
    /// The value in its normal form: a number as f64, an integer as i64, −0 as 0.
    ///
    /// `key` and `unit` are for the message. Of the entries of a list, the first wrong one is
    /// named, counted from 0.
    ///
    /// # Errors
    /// A wrong type, a number out of range, an unknown word, a list of the wrong length.
    pub(crate) fn check(&self, key: &str, unit: &str, given: &Given) -> Result<Value, ConfigError> {
        match (self, &given.datum) {
            (Self::Number(range), Datum::Integer(_) | Datum::Number(_)) => {
                let x = given.number().unwrap_or(f64::NAN);
                if range.contains(x) {
                    Ok(Value::from(x + 0.0))
                } else {
                    Err(self.out_of_range(key, unit, given))
                }
            }
            (Self::Integer(low, high), Datum::Integer(i)) => {
                if (low..=high).contains(&i) {
                    Ok(Value::from(*i))
                } else {
                    Err(self.out_of_range(key, unit, given))
                }
            }
            (Self::Integer(..), Datum::Number(x)) if !x.is_finite() || x.abs() > EXACT => {
                Err(self.out_of_range(key, unit, given))
            }
            (Self::Integer(..), Datum::Number(x)) if x.trunc() == *x => {
                let whole = Given { datum: Datum::Integer(*x as i64), ..given.clone() };
                self.check(key, unit, &whole)
            }
            (Self::Boolean, Datum::Boolean(b)) => Ok(Value::from(*b)),
            (Self::Word(words), Datum::Word(word)) => {
                if words.contains(&word.as_str()) {
                    Ok(Value::from(word.as_str()))
                } else {
                    Err(ConfigError::UnknownWord {
                        place: given.place.clone(),
                        key: key.into(),
                        value: given.text.as_str().into(),
                        allowed: listing(words).into(),
                        nearest: nearest_word(word, words.iter().copied()),
                    })
                }
            }
            (Self::List(of, length), Datum::List(entries)) => {
                if length.map_or(entries.is_empty(), |n| entries.len() != n) {
                    return Err(ConfigError::WrongLength {
                        place: given.place.clone(),
                        key: key.into(),
                        value: given.text.as_str().into(),
                        found: entries.len(),
                        expected: self.expected(unit).into(),
                    });
                }
                let entry = |(i, entry)| of.check(&format!("{key}[{i}]"), unit, entry);
                entries.iter().enumerate().map(entry).collect()
            }
            (Self::OneOf(kinds), _) => self.check_one_of(kinds, key, unit, given),
            _ => Err(given.wrong_type(key, &self.expected(unit))),
        }
    }

    /// The first kind that accepts the value; failing that the complaint of the one whose type
    /// fits, or that none does.
    fn check_one_of(
        &self,
        kinds: &[Self],
        key: &str,
        unit: &str,
        given: &Given,
    ) -> Result<Value, ConfigError> {
        let mut complaint = None;
        for kind in kinds {
            match kind.check(key, unit, given) {
                Ok(value) => return Ok(value),
                // A wrong type of an entry is a complaint of its own: it names the entry.
                Err(ConfigError::WrongType { key: at, .. }) if *at == *key => {}
                Err(other) => complaint = complaint.or(Some(other)),
            }
        }
        Err(complaint.unwrap_or_else(|| given.wrong_type(key, &self.expected(unit))))
    }

    fn out_of_range(&self, key: &str, unit: &str, given: &Given) -> ConfigError {
        ConfigError::OutOfRange {
            place: given.place.clone(),
            key: key.into(),
            value: given.text.as_str().into(),
            allowed: self.limits(unit).into(),
        }
    }

    /// The limits in words, with the unit: `N s/m, at least 0`; empty for booleans.
    pub fn limits(&self, unit: &str) -> String {
        let limits = match self {
            Self::Number(range) => range.to_string(),
            Self::Integer(low, high) => format!("from {low} to {high}"),
            Self::Boolean => String::new(),
            Self::Word(words) => listing(words),
            Self::List(of, None) => format!("each {}", of.limits("")),
            Self::List(of, Some(n)) => format!("{n} in a list, each {}", of.limits("")),
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
            Self::List(of, None) => {
                format!("a list, at least one entry, each {}", of.expected(unit))
            }
            Self::List(of, Some(n)) => format!("a list of {n} entries, each {}", of.expected(unit)),
            Self::OneOf(kinds) => {
                let kinds: Vec<_> = kinds.iter().map(|kind| kind.expected(unit)).collect();
                kinds.join(", or ")
            }
        }
    }
}

/// Words as a sentence has them: `pin, full or centroid`.
fn listing(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [word] => (*word).to_owned(),
        [first @ .., last] => format!("{} or {last}", first.join(", ")),
    }
}

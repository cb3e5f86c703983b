//! The check of a value by the kind of its key.

use serde_json::Value;

use super::error::ConfigError;
use super::nearest::nearest_word;
use super::raw_value::{Datum, Given};
use crate::keys::{Kind, listing};

/// Largest integer up to which every integer is an f64: 2⁵³.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// The value of a key of this kind in its normal form: a number as f64, an integer as i64, −0 as 0.
///
/// `key` and `unit` are for the message. Of the entries of a list, the first wrong one is
/// named, counted from 0.
///
/// # Errors
/// A wrong type, a number out of range, an unknown word, an empty list, a set that has an entry twice.
pub(super) fn check(
    kind: &Kind,
    key: &str,
    unit: &str,
    given: &Given,
) -> Result<Value, ConfigError> {
    match (kind, &given.datum) {
        (Kind::Number(range), Datum::Integer(_) | Datum::Number(_)) => {
            let x = given.number().unwrap_or(f64::NAN);
            if range.contains(x) {
                Ok(Value::from(x + 0.0))
            } else {
                Err(out_of_range(kind, key, unit, given))
            }
        }
        (Kind::Integer(low, high), Datum::Integer(i)) => {
            if (low..=high).contains(&i) {
                Ok(Value::from(*i))
            } else {
                Err(out_of_range(kind, key, unit, given))
            }
        }
        (Kind::Integer(..), Datum::Number(x)) if !x.is_finite() || x.abs() > EXACT => {
            Err(out_of_range(kind, key, unit, given))
        }
        (Kind::Integer(..), Datum::Number(x)) if x.trunc() == *x => {
            let whole = Given { datum: Datum::Integer(*x as i64), ..given.clone() };
            check(kind, key, unit, &whole)
        }
        (Kind::Boolean, Datum::Boolean(b)) => Ok(Value::from(*b)),
        (Kind::Word(words), Datum::Word(word)) => {
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
        (Kind::List(of) | Kind::Set(of), Datum::List(entries)) => {
            if entries.is_empty() {
                return Err(ConfigError::WrongLength {
                    place: given.place.clone(),
                    key: key.into(),
                    value: given.text.as_str().into(),
                    found: entries.len(),
                    expected: kind.expected(unit).into(),
                });
            }
            let entry = |(i, entry)| check(of, &format!("{key}[{i}]"), unit, entry);
            let values: Vec<Value> =
                entries.iter().enumerate().map(entry).collect::<Result<_, _>>()?;
            let twice = (1..values.len()).find(|i| values[..*i].contains(&values[*i]));
            match twice.filter(|_| matches!(kind, Kind::Set(_))) {
                None => Ok(values.into()),
                Some(i) => Err(ConfigError::Repeated {
                    place: given.place.clone(),
                    key: key.into(),
                    value: given.text.as_str().into(),
                    entry: entries[i].text.as_str().into(),
                }),
            }
        }
        (Kind::OneOf(kinds), _) => check_one_of(kind, kinds, key, unit, given),
        _ => Err(given.wrong_type(key, &kind.expected(unit))),
    }
}

/// The first kind that accepts the value; failing that the complaint of the one whose type
/// fits, or that none does.
fn check_one_of(
    kind: &Kind,
    kinds: &[Kind],
    key: &str,
    unit: &str,
    given: &Given,
) -> Result<Value, ConfigError> {
    let mut complaint = None;
    for one in kinds {
        match check(one, key, unit, given) {
            Ok(value) => return Ok(value),
            // A wrong type of an entry is a complaint of its own: it names the entry.
            Err(ConfigError::WrongType { key: at, .. }) if *at == *key => {}
            Err(other) => complaint = complaint.or(Some(other)),
        }
    }
    Err(complaint.unwrap_or_else(|| given.wrong_type(key, &kind.expected(unit))))
}

fn out_of_range(kind: &Kind, key: &str, unit: &str, given: &Given) -> ConfigError {
    ConfigError::OutOfRange {
        place: given.place.clone(),
        key: key.into(),
        value: given.text.as_str().into(),
        allowed: kind.limits(unit).into(),
    }
}

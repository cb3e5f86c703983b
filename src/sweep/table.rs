//! A table of a plan's file, with the places of what is in it.

use super::SweepError;
use crate::config::{Datum, Given, Place, nearest_word};

/// A table of a plan.
pub(super) struct Table<'a> {
    /// As messages call it.
    pub(super) name: &'static str,
    pub(super) place: &'a Place,
    entries: &'a [(String, Given)],
}

impl<'a> Table<'a> {
    /// The table that `given` is, in which only `known` keys may stand.
    ///
    /// # Errors
    /// No table, or a key that is not known.
    pub(super) fn new(
        name: &'static str,
        given: &'a Given,
        known: &[&str],
    ) -> Result<Self, SweepError> {
        let Datum::Table(entries) = &given.datum else {
            return Err(given.wrong_type(name, "a table").into());
        };
        if let Some((key, value)) = entries.iter().find(|(key, _)| !known.contains(&key.as_str())) {
            return Err(SweepError::UnknownKey {
                place: value.place.clone(),
                table: name,
                key: key.clone(),
                known: known.join(", "),
                nearest: nearest_word(key, known.iter().copied()).map(str::to_owned),
            });
        }
        Ok(Self { name, place: &given.place, entries })
    }

    /// What `key` is given as.
    pub(super) fn get(&self, key: &str) -> Option<&'a Given> {
        self.entries.iter().find(|(own, _)| own == key).map(|(_, given)| given)
    }

    /// The complaint about what is not in it.
    pub(super) fn incomplete(&self, what: &'static str) -> SweepError {
        SweepError::Incomplete { place: self.place.clone(), table: self.name, what }
    }

    /// The word that `key` is given as.
    ///
    /// # Errors
    /// None, with `what` to give, or no word.
    pub(super) fn word(
        &self,
        key: &str,
        what: &'static str,
    ) -> Result<(&'a str, &'a Given), SweepError> {
        let given = self.get(key).ok_or_else(|| self.incomplete(what))?;
        match &given.datum {
            Datum::Word(word) => Ok((word, given)),
            _ => Err(given.wrong_type(key, "a string").into()),
        }
    }

    /// Whether `key` is given as true.
    ///
    /// # Errors
    /// Neither true nor false.
    pub(super) fn truth(&self, key: &str) -> Result<Option<bool>, SweepError> {
        match self.get(key).map(|given| (&given.datum, given)) {
            None => Ok(None),
            Some((Datum::Boolean(is_true), _)) => Ok(Some(*is_true)),
            Some((_, given)) => Err(given.wrong_type(key, "true or false").into()),
        }
    }

    /// The number from zero to one that `key` is given as.
    ///
    /// # Errors
    /// Anything else.
    pub(super) fn part(&self, key: &str) -> Result<Option<f64>, SweepError> {
        let Some(given) = self.get(key) else { return Ok(None) };
        match given.number() {
            Some(x) if (0.0..=1.0).contains(&x) => Ok(Some(x)),
            _ => Err(refused(key, given, "a part of the runs is wanted, from 0 to 1")),
        }
    }

    /// The whole number that `key` is given as, from `low` to `high`.
    ///
    /// # Errors
    /// Anything else.
    pub(super) fn whole(&self, key: &str, low: u64, high: u64) -> Result<Option<u64>, SweepError> {
        let Some(given) = self.get(key) else { return Ok(None) };
        let n = match given.datum {
            Datum::Integer(n) => u64::try_from(n).ok(),
            Datum::Number(x) if x.fract() == 0.0 && (0.0..9e15).contains(&x) => Some(x as u64),
            Datum::Number(_) => None,
            _ => return Err(given.wrong_type(key, "a whole number").into()),
        };
        match n {
            Some(n) if (low..=high).contains(&n) => Ok(Some(n)),
            _ => Err(refused(key, given, format!("a whole number from {low} to {high} is wanted"))),
        }
    }
}

/// The complaint about a value.
pub(super) fn refused(key: &str, given: &Given, reason: impl Into<String>) -> SweepError {
    let (place, value) = (given.place.clone(), given.text.clone());
    SweepError::Value { place, key: key.to_owned(), value, reason: reason.into() }
}

/// The two numbers that `key` is given as.
///
/// # Errors
/// Anything else.
pub(super) fn pair<'a>(
    key: &str,
    given: &'a Given,
    what: &'static str,
) -> Result<([f64; 2], &'a [Given]), SweepError> {
    if let Datum::List(entries) = &given.datum
        && let [a, b] = &entries[..]
        && let (Some(a), Some(b)) = (a.number(), b.number())
        && a.is_finite()
        && b.is_finite()
    {
        return Ok(([a, b], entries));
    }
    Err(refused(key, given, format!("two numbers are wanted, {what}")))
}

/// The entries of a list of tables.
///
/// # Errors
/// No list.
pub(super) fn tables<'a>(name: &str, given: Option<&'a Given>) -> Result<&'a [Given], SweepError> {
    match given.map(|given| (&given.datum, given)) {
        None => Ok(&[]),
        Some((Datum::List(entries), _)) => Ok(entries),
        Some((_, given)) => {
            Err(given.wrong_type(name, "a list of tables, each with its header").into())
        }
    }
}

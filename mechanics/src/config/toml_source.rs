//! Reading of TOML: a file, one value, one argument of `--set`.

use std::path::Path;
use std::{fs, iter};

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{ConfigError, Place};
use super::raw_value::{DEPTH, Datum, Given, excerpt, is_bare_key, key_text};

/// A text, and what places in it are called.
struct Source<'a> {
    text: &'a str,
    /// The place of the first line.
    origin: Place,
    /// Byte at which each line starts.
    starts: Vec<usize>,
}

/// The text of a file.
///
/// # Errors
/// The file is missing, a directory, not to be read, or not UTF-8.
pub fn read(path: &Path) -> Result<String, ConfigError> {
    let bytes = fs::read(path).map_err(|error| ConfigError::Unreadable {
        path: path.to_owned(),
        reason: error.to_string().into(),
    })?;
    String::from_utf8(bytes).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + valid.iter().filter(|&&byte| byte == b'\n').count();
        let (offset, wrong) = (valid.len(), error.as_bytes()[valid.len()]);
        let message = format!(
            "byte {offset} is 0x{wrong:02x}: not UTF-8 text; save the file as UTF-8, or convert it: iconv -f latin1 -t utf-8"
        );
        ConfigError::Syntax {
            place: Place::Line { file: path.display().to_string().into(), line },
            message: message.into(),
        }
    })
}

/// A document as one table; `file` is its name in messages.
///
/// # Errors
/// The text is not TOML.
pub fn document(file: &str, text: &str) -> Result<Given, ConfigError> {
    let source = Source::new(text, Place::Line { file: file.into(), line: 1 });
    let table = DeTable::parse(text).map_err(|error| source.syntax(&error))?;
    Ok(Given {
        place: source.origin.clone(),
        text: "{…}".to_owned(),
        datum: source.table(table.get_ref(), DEPTH),
    })
}

/// A single value.
///
/// # Errors
/// The text is not one TOML value.
pub(super) fn value(text: &str, place: Place) -> Result<Given, ConfigError> {
    let source = Source::new(text, place);
    let value = DeValue::parse(text).map_err(|error| source.syntax(&error))?;
    Ok(source.given(&value, source.origin.clone(), DEPTH))
}

/// The key and the value of `key=value`; a bare word is a string.
///
/// # Errors
/// No `=`, no key, no value, or a value that is neither TOML nor a bare word.
pub(super) fn assignment(argument: &str) -> Result<(String, Given), ConfigError> {
    let place = Place::Set(excerpt(argument).into());
    let (key, text) = match argument.split_once('=') {
        Some((key, text)) if !key.trim().is_empty() && !text.trim().is_empty() => {
            (key.trim(), text.trim())
        }
        _ => {
            return Err(ConfigError::NoAssignment { argument: excerpt(argument).into() });
        }
    };
    let segments: Vec<_> = key.split('.').map(|segment| key_text(segment.trim())).collect();
    let given = match value(text, place.clone()) {
        Err(_) if is_bare_word(text) => {
            Given { place, text: format!("\"{text}\""), datum: Datum::Word(text.to_owned()) }
        }
        other => other?,
    };
    Ok((segments.join("."), given))
}

/// A word that needs no quotes on the command line: `slider-crank`, `bs32`.
fn is_bare_word(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic()) && is_bare_key(text)
}

impl<'a> Source<'a> {
    fn new(text: &'a str, origin: Place) -> Self {
        let ends = text.match_indices('\n').map(|(end, _)| end + 1);
        Self { text, origin, starts: iter::once(0).chain(ends).collect() }
    }

    /// Where a byte is.
    fn place(&self, byte: usize) -> Place {
        match &self.origin {
            Place::Line { file, .. } => Place::Line {
                file: file.clone(),
                line: self.starts.partition_point(|&start| start <= byte),
            },
            other => other.clone(),
        }
    }

    fn syntax(&self, error: &toml::de::Error) -> ConfigError {
        let span = error.span().unwrap_or_default();
        let message = error.message().trim_end_matches(", expected nothing");
        let mut message = message.split_whitespace().collect::<Vec<_>>().join(" ");
        if message == "duplicate key" {
            let key = excerpt(self.text.get(span.clone()).unwrap_or_default());
            message = format!("{key} stands here a second time; leave one of the two out");
        } else if message.starts_with("string values must be quoted")
            || message.starts_with("invalid float")
            || message.starts_with("invalid exponent")
        {
            message += "; a number has no unit beside it, as in 1.5e8, and a word stands in quotes";
        }
        ConfigError::Syntax { place: self.place(span.start), message: message.into() }
    }

    /// The entries in the order of the text.
    fn table(&self, table: &DeTable<'_>, depth: usize) -> Datum {
        let mut entries: Vec<_> = table.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        let named = entries.into_iter().map(|(key, value)| {
            let place = self.place(key.span().start);
            (key_text(key.get_ref()), self.given(value, place, depth))
        });
        Datum::Table(named.collect())
    }

    /// The value with its place; what lies deeper than `depth` is not looked into.
    fn given(&self, value: &Spanned<DeValue<'_>>, place: Place, depth: usize) -> Given {
        let inner = depth.checked_sub(1);
        let datum = match (value.get_ref(), inner) {
            (DeValue::Boolean(b), _) => Datum::Boolean(*b),
            (DeValue::Integer(digits), _) => {
                let (text, radix) = (digits.as_str(), digits.radix());
                i64::from_str_radix(text, radix)
                    .map_or_else(|_| Datum::Number(beyond_64_bits(text, radix)), Datum::Integer)
            }
            (DeValue::Float(digits), _) => Datum::Number(parse(digits.as_str())),
            (DeValue::String(s), _) => Datum::Word(s.to_string()),
            (DeValue::Datetime(_), _) => Datum::Other("a date or time"),
            (DeValue::Array(entries), Some(inner)) => {
                let placed = entries.iter().map(|v| {
                    let place = self.place(v.span().start);
                    self.given(v, place, inner)
                });
                Datum::List(placed.collect())
            }
            (DeValue::Table(table), Some(inner)) => self.table(table, inner),
            (DeValue::Array(_) | DeValue::Table(_), None) => Datum::Other("nested too deeply"),
        };
        let text = match datum {
            Datum::Table(_) => "{…}".to_owned(),
            // The text of tables in a list ([[…]]) would be their header.
            Datum::List(ref entries)
                if matches!(entries[..], [Given { datum: Datum::Table(_), .. }, ..]) =>
            {
                "[…]".to_owned()
            }
            _ => excerpt(self.text.get(value.span()).unwrap_or("…")),
        };
        Given { place, text, datum }
    }
}

/// A TOML number; one too large for f64 is infinite, one that is none is NaN.
fn parse(digits: &str) -> f64 {
    digits.parse().unwrap_or(f64::NAN)
}

/// An integer as a number like any other; NaN, which every range refuses, beyond 128 bits where it is not decimal.
fn beyond_64_bits(digits: &str, radix: u32) -> f64 {
    match radix {
        10 => parse(digits),
        _ => u128::from_str_radix(digits, radix).map_or(f64::NAN, |integer| integer as f64),
    }
}

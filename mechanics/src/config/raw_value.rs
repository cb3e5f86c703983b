//! A value as the user gave it, with its place: what TOML, `--set` and JSON have in common.

use serde_json::Value;

use super::error::{ConfigError, Place};

/// Depth beyond which a value is not looked into; no key is deeper than three tables and a list.
pub(super) const DEPTH: usize = 8;

/// Longest piece of a value that a message repeats, in characters.
const EXCERPT: usize = 60;

/// A value with its place.
#[derive(Clone, Debug)]
pub struct Given {
    /// Line of its key, or of itself inside a list.
    pub place: Place,
    /// As written, on one line, shortened.
    pub text: String,
    /// What it is.
    pub datum: Datum,
}

/// What a value is.
#[derive(Clone, Debug)]
pub enum Datum {
    /// `true` or `false`.
    Boolean(bool),
    /// An integer.
    Integer(i64),
    /// A decimal number.
    Number(f64),
    /// A text.
    Word(String),
    /// Several.
    List(Vec<Given>),
    /// Entries by name, in their order.
    Table(Vec<(String, Given)>),
    /// Nothing that a key takes: its type, with article.
    Other(&'static str),
}

impl Datum {
    /// The type, with article.
    pub(crate) fn type_name(&self) -> &'static str {
        match self {
            Self::Boolean(_) => "a boolean",
            Self::Integer(_) => "an integer",
            Self::Number(_) => "a decimal number",
            Self::Word(_) => "a string",
            Self::List(_) => "a list",
            Self::Table(_) => "a table",
            Self::Other(name) => name,
        }
    }
}

impl Given {
    /// The number that it is, from an integer as well.
    pub fn number(&self) -> Option<f64> {
        match self.datum {
            Datum::Integer(i) => Some(i as f64),
            Datum::Number(x) => Some(x),
            _ => None,
        }
    }

    /// The entry of this name, where it is a table that has it.
    pub(super) fn entry(&self, name: &str) -> Option<&Self> {
        let Datum::Table(entries) = &self.datum else { return None };
        entries.iter().find(|(own, _)| own == name).map(|(_, given)| given)
    }

    /// The complaint that it is of the wrong type.
    pub fn wrong_type(&self, key: &str, expected: &str) -> ConfigError {
        ConfigError::WrongType {
            place: self.place.clone(),
            key: key.into(),
            value: self.text.as_str().into(),
            found: self.datum.type_name(),
            expected: expected.into(),
        }
    }

    /// A value of a JSON document.
    pub(super) fn from_json(value: &Value) -> Self {
        Self::from_json_at(value, DEPTH)
    }

    fn from_json_at(value: &Value, depth: usize) -> Self {
        let inner = depth.checked_sub(1);
        let datum = match (value, inner) {
            (Value::Null, _) => Datum::Other("null"),
            (Value::Bool(b), _) => Datum::Boolean(*b),
            (Value::Number(n), _) => match (n.as_i64(), n.as_f64()) {
                (Some(i), _) => Datum::Integer(i),
                (None, x) => Datum::Number(x.unwrap_or(f64::NAN)),
            },
            (Value::String(s), _) => Datum::Word(s.clone()),
            (Value::Array(entries), Some(inner)) => {
                Datum::List(entries.iter().map(|v| Self::from_json_at(v, inner)).collect())
            }
            (Value::Object(entries), Some(inner)) => {
                let entry = |(k, v): (&String, _)| (key_text(k), Self::from_json_at(v, inner));
                Datum::Table(entries.iter().map(entry).collect())
            }
            (Value::Array(_) | Value::Object(_), None) => Datum::Other("nested too deeply"),
        };
        let text = match value {
            Value::Object(_) => "{…}".to_owned(),
            _ if inner.is_none() => "…".to_owned(),
            _ => excerpt(&value.to_string()),
        };
        Self { place: Place::Json, text, datum }
    }
}

/// `text` on one line, without control characters, at most [`EXCERPT`] characters long.
pub(super) fn excerpt(text: &str) -> String {
    let spaced = text.chars().map(|c| if c.is_whitespace() || c.is_control() { ' ' } else { c });
    let mut out = String::new();
    for (length, c) in spaced.enumerate() {
        if length == EXCERPT {
            out.push('…');
            break;
        }
        if !(c == ' ' && out.ends_with(' ')) {
            out.push(c);
        }
    }
    out
}

/// Whether TOML lets a segment of a key stand without quotes.
pub(super) fn is_bare_key(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || "_-".contains(c))
}

/// One segment of a key as it enters a path: quoted where TOML needs quotes, so that `"a.b"` is not taken for `a.b`, and
/// shortened there, which makes no key of it that is none. A bare one is whole: a parameter may have a long name.
pub(super) fn key_text(segment: &str) -> String {
    if is_bare_key(segment) {
        segment.to_owned()
    } else {
        excerpt(&format!("'{}'", segment.escape_debug()))
    }
}

//! The TOML of a file: tables and values with their places.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::expression::{Comparison, Expression, Indices, Kind, condition, expression, indices};
use crate::report::{Checked, Complaint, Span};
use crate::token::Place;

/// A value with its place.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct At<T> {
    pub(crate) value: T,
    pub(crate) span: Span,
}

/// A value of the file with its key.
#[derive(Clone, Copy)]
pub(crate) struct Entry<'a> {
    /// The text of the whole file.
    text: &'a str,
    pub(crate) key: &'a str,
    pub(crate) key_span: Span,
    value: &'a DeValue<'a>,
    pub(crate) span: Span,
}

/// The entries of a table in the order of the file.
pub(crate) struct Entries<'a> {
    all: Vec<Entry<'a>>,
    span: Span,
}

impl<'a> Entries<'a> {
    pub(crate) fn new(text: &'a str, table: &'a DeTable<'a>, span: Span) -> Self {
        let entry = |(key, value): (&'a Spanned<_>, &'a Spanned<DeValue<'a>>)| {
            let key_name: &'a std::borrow::Cow<'a, str> = key.get_ref();
            Entry {
                text,
                key: key_name,
                key_span: key.span().into(),
                value: value.get_ref(),
                span: value.span().into(),
            }
        };
        let mut all: Vec<_> = table.iter().map(entry).collect();
        // The key of a table has the place of its own header, which may stand behind that of a table in it.
        all.sort_by_cached_key(|entry| entry.key_span.start.min(first_key(entry.value)));
        Self { all, span }
    }

    /// The same, where no key but the known ones stands in the table.
    pub(crate) fn only(self, known: &[&str]) -> Checked<Self> {
        match self.all.iter().find(|entry| !known.contains(&entry.key)) {
            None => Ok(self),
            Some(entry) => {
                let complaint =
                    Complaint::new(entry.key_span, format!("no key `{}` is known here", entry.key));
                Err(complaint.nearest(entry.key, known.iter().copied()))
            }
        }
    }

    pub(crate) fn get(&self, key: &str) -> Option<Entry<'a>> {
        self.all.iter().find(|entry| entry.key == key).copied()
    }

    /// The entry that must be there, of what `what` says.
    pub(crate) fn need(&self, key: &str, what: &str) -> Checked<Entry<'a>> {
        let missing = || {
            Complaint::new(self.span, format!("{what} needs the key `{key}`"))
                .help(format!("add `{key} = …`"))
        };
        self.get(key).ok_or_else(missing)
    }

    /// The entry read by `read`, if it is there.
    pub(crate) fn read<T>(
        &self,
        key: &str,
        read: impl FnOnce(Entry<'a>) -> Checked<T>,
    ) -> Checked<Option<T>> {
        self.get(key).map(read).transpose()
    }

    /// The entries of the table at `key`; none where it is not there.
    pub(crate) fn table(&self, key: &str) -> Checked<Vec<Entry<'a>>> {
        Ok(self.read(key, |entry| entry.entries())?.map_or(Vec::new(), |entries| entries.all))
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = Entry<'a>> + '_ {
        self.all.iter().copied()
    }
}

/// Where the first key within a table stands; behind everything for what is no table.
fn first_key(value: &DeValue<'_>) -> usize {
    let DeValue::Table(table) = value else { return usize::MAX };
    let keys = table.iter().map(|(key, value)| key.span().start.min(first_key(value.get_ref())));
    keys.min().unwrap_or(usize::MAX)
}

impl<'a> Entry<'a> {
    /// A complaint that the value is something else than expected.
    fn not(&self, expected: &str) -> Complaint {
        let message = format!("`{}` must be {expected}, not {}", self.key, self.kind());
        Complaint::new(self.span, message).help(match expected {
            "a table" => format!("write `{0} = {{ … }}`, or the table `[{0}]`", self.key),
            "a list of tables" => format!("write `{} = [{{ … }}, {{ … }}]`", self.key),
            "true or false" => format!("write `{} = true`, without quotes", self.key),
            "a number" | "a finite number" => {
                format!(
                    "write `{} = 1.5` or `1e-3`, without quotes; a formula is a definition",
                    self.key
                )
            }
            _ => format!("write `{} = \"…\"`, in quotes", self.key),
        })
    }

    fn kind(&self) -> &'static str {
        match self.value {
            DeValue::String(_) => "a string",
            DeValue::Float(x) if finite(x.as_str(), 10).is_none() => {
                "infinite, NaN or beyond 1.8e308"
            }
            DeValue::Integer(_) | DeValue::Float(_) => "a number",
            DeValue::Boolean(_) => "true or false",
            DeValue::Datetime(_) => "a date",
            DeValue::Array(_) => "a list",
            DeValue::Table(_) => "a table",
        }
    }

    pub(crate) fn is_table(&self) -> bool {
        matches!(self.value, DeValue::Table(_))
    }

    /// The key as a name with its place.
    pub(crate) fn name(&self) -> At<String> {
        At { value: self.key.to_owned(), span: self.key_span }
    }

    pub(crate) fn entries(self) -> Checked<Entries<'a>> {
        match self.value {
            DeValue::Table(table) => Ok(Entries::new(self.text, table, self.key_span)),
            _ => Err(self.not("a table")),
        }
    }

    /// The tables of a list of tables.
    pub(crate) fn tables(self) -> Checked<Vec<(Entries<'a>, Span)>> {
        let DeValue::Array(all) = self.value else { return Err(self.not("a list of tables")) };
        let table = |value: &'a Spanned<DeValue<'a>>| {
            let span = value.span().into();
            let entry = Self { value: value.get_ref(), span, key_span: span, ..self };
            Ok((entry.entries()?, span))
        };
        all.iter().map(table).collect()
    }

    pub(crate) fn text(self) -> Checked<At<String>> {
        match self.value {
            DeValue::String(text) => Ok(At { value: text.to_string(), span: self.span }),
            _ => Err(self.not("a string")),
        }
    }

    /// A list of strings, or one string.
    pub(crate) fn texts(self) -> Checked<Vec<At<String>>> {
        let DeValue::Array(all) = self.value else {
            return Ok(vec![self.text()?]);
        };
        let text = |value: &'a Spanned<DeValue<'a>>| {
            Self { value: value.get_ref(), span: value.span().into(), ..self }.text()
        };
        all.iter().map(text).collect()
    }

    pub(crate) fn flag(self) -> Checked<bool> {
        match self.value {
            DeValue::Boolean(flag) => Ok(*flag),
            _ => Err(self.not("true or false")),
        }
    }

    /// A finite number.
    pub(crate) fn number(self) -> Checked<f64> {
        match self.value {
            DeValue::Float(x) => finite(x.as_str(), 10),
            DeValue::Integer(x) => finite(x.as_str(), x.radix()),
            _ => return Err(self.not("a number")),
        }
        .ok_or_else(|| self.not("a finite number"))
    }

    /// A formula, or a number.
    pub(crate) fn expression(self) -> Checked<Expression> {
        match self.value {
            DeValue::String(text) => expression(text, self.place(text)),
            DeValue::Integer(_) | DeValue::Float(_) => {
                let number = self.number()?;
                Ok(Expression { kind: Kind::Number(number), span: self.span })
            }
            _ => Err(self.not("a formula in quotes or a number")),
        }
    }

    pub(crate) fn condition(self) -> Checked<Comparison> {
        let text = self.inner("a comparison in quotes")?;
        condition(text, self.place(text))
    }

    pub(crate) fn indices(self) -> Checked<Indices> {
        let text = self.inner("an index with its bounds, as \"i in 1..n\"")?;
        indices(text, self.place(text))
    }

    fn inner(self, expected: &str) -> Checked<&'a str> {
        match self.value {
            DeValue::String(text) => Ok(text),
            _ => Err(self.not(expected)),
        }
    }

    /// The key read as a formula: `x` or `x[i]`.
    pub(crate) fn target(self) -> Checked<Expression> {
        let place = place_in(self.text, self.key_span, self.key);
        expression(self.key, place)
    }

    fn place(self, inner: &str) -> Place {
        place_in(self.text, self.span, inner)
    }
}

/// Where the bytes of the string `inner`, which stands at `span`, are in the file.
fn place_in(text: &str, span: Span, inner: &str) -> Place {
    let raw = text.get(span.start..span.end).unwrap_or_default();
    match raw.find(inner) {
        // Quotes before it, one or three, and perhaps the end of a line.
        Some(at) if at <= 5 && raw.len() - at - inner.len() <= 3 => Place::From(span.start + at),
        _ => Place::Within(span),
    }
}

fn finite(text: &str, radix: u32) -> Option<f64> {
    let digits = text.replace('_', "");
    let number = match radix {
        10 => digits.parse().ok()?,
        _ => i64::from_str_radix(&digits, radix).ok()? as f64,
    };
    number.is_finite().then_some(number)
}

/// The complaint about a text that is no TOML.
pub(crate) fn not_toml(text: &str, error: &toml::de::Error) -> Complaint {
    let span = error.span().map_or(Span { start: 0, end: 0 }, Span::from);
    let here = text.get(span.start..span.end).unwrap_or_default();
    let message = error.message().trim_end_matches(", expected nothing");
    if message == "duplicate key" {
        let complaint = Complaint::new(span, format!("`{here}` stands here a second time"));
        let complaint = complaint.help(
            "a key stands once in its table, and a table once in a file: join both, or rename one",
        );
        return match first_of(text, span, here) {
            Some(first) => complaint.and(first, "first here"),
            None => complaint,
        };
    }
    let begins = |start: &str| message.starts_with(start);
    let help = if begins("string values must be quoted") {
        format!("names and formulas stand in quotes: `\"{}\"`", here.trim())
    } else if begins("invalid unquoted key") {
        format!("a key of other letters stands in quotes: `\"{here}…\" = …`")
    } else if begins("invalid mantissa") || begins("invalid fraction") {
        "a number has digits on both sides of its point: `0.5`, `5.0`".to_owned()
    } else if begins("missing escaped value") {
        "`\\` has a meaning in \"…\"; what stands in '…' is taken as it is".to_owned()
    } else {
        "an entry is `key = value` on a line of its own, a table `[name]`, a table on one line `{ a = 1, b = 2 }`, a list `[a, b]`; names and formulas stand in quotes".to_owned()
    };
    Complaint::new(span, message).help(help)
}

/// Where a key or the header of a table, which stands at `second` once more, stands first; none where that is not certain.
fn first_of(text: &str, second: Span, key: &str) -> Option<Span> {
    let begins = text[..second.start].rfind('\n').map_or(0, |at| at + 1);
    let (before, lead) = (&text[..begins], &text[begins..second.start]);
    let is_header = lead.trim_start().starts_with('[');
    if !is_header && !lead.trim().is_empty() {
        // Within one line: the key follows the brace or a comma of its own table.
        let of_table = lead.rfind('{').map_or(0, |at| at + 1);
        let mut at = of_table;
        for entry in lead[of_table..].split(',') {
            let indent = entry.len() - entry.trim_start().len();
            let rest = entry.trim_start().strip_prefix(key).map(str::trim_start);
            if rest.is_some_and(|rest| rest.starts_with('=')) {
                let start = begins + at + indent;
                return Some(Span { start, end: start + key.len() });
            }
            at += entry.len() + 1;
        }
        return None;
    }
    let mut start = before.len();
    for line in before.split_inclusive('\n').rev() {
        start -= line.len();
        let indent = line.len() - line.trim_start().len();
        let own = &line[indent..];
        let lead = if is_header { lead.trim_start() } else { "" };
        let rest = own.strip_prefix(lead).and_then(|rest| rest.strip_prefix(key));
        if rest.is_some_and(|rest| rest.trim_start().starts_with(if is_header { ']' } else { '=' }))
        {
            let start = start + indent + lead.len();
            return Some(Span { start, end: start + key.len() });
        }
        if !is_header && own.starts_with('[') {
            return None;
        }
    }
    None
}

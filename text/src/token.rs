//! The words of an expression.

use crate::report::{Checked, Complaint, Span};

/// A word of an expression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Token<'a> {
    /// A number, at least zero.
    Number(f64),
    /// A name.
    Name(&'a str),
    /// One of [`SYMBOLS`].
    Symbol(&'static str),
}

/// All symbols, those of two characters first.
const SYMBOLS: &[&str] = &[
    "..", ">=", "<=", "==", "!=", "&&", "||", "**", "+", "-", "*", "/", "^", "(", ")", "[", "]",
    ",", ">", "<", "=", "!",
];

/// Characters that are no part of the language, and what stands for them.
const STRANGE: &[(char, &str)] = &[
    ('·', "a product is written with `*`"),
    ('×', "a product is written with `*`"),
    ('−', "a difference is written with `-`"),
    ('–', "a difference is written with `-`"),
    ('²', "a square is written `x^2`"),
    ('³', "a cube is written `x^3`"),
    ('√', "a square root is written `sqrt(x)`"),
    ('|', "an absolute value is written `abs(x)`"),
    ('\'', "a derivative is a state of its own: x = \"v\" stands in the rates"),
    ('{', "an expression has round parentheses"),
    ('≥', "write `>=`"),
    ('≤', "write `<=`"),
    (';', "an expression is one formula; give other formulas names in [definitions]"),
];

/// Where the bytes of an expression are in its file.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Place {
    /// One after the other from here.
    From(usize),
    /// Somewhere here, because the string has escapes.
    Within(Span),
}

impl Place {
    /// The span in the file of these bytes of the expression.
    pub(crate) fn span(self, start: usize, end: usize) -> Span {
        match self {
            Self::From(first) => Span { start: first + start, end: first + end },
            Self::Within(span) => span,
        }
    }
}

/// The tokens of an expression, each with its place.
pub(crate) fn tokens(text: &str, place: Place) -> Checked<Vec<(Token<'_>, Span)>> {
    let (mut all, mut at) = (Vec::new(), 0);
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        let (token, length) = if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        } else if first.is_ascii_digit() || (first == '.' && starts_fraction(rest)) {
            let length = number_length(rest);
            let span = place.span(at, at + length);
            (Token::Number(number(&rest[..length], span)?), length)
        } else if begins_name(first) {
            let length = rest.find(|c| !is_of_name(c)).unwrap_or(rest.len());
            (Token::Name(&rest[..length]), length)
        } else if let Some(symbol) = SYMBOLS.iter().find(|symbol| rest.starts_with(**symbol)) {
            (Token::Symbol(symbol), symbol.len())
        } else {
            return Err(strange(first, place.span(at, at + first.len_utf8())));
        };
        all.push((token, place.span(at, at + length)));
        at += length;
    }
    Ok(all)
}

/// Whether a name may begin with this character.
pub(crate) fn begins_name(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

/// Whether this character may stand in a name: a letter, a digit from 0 to 9 or `_`, and no digit as small as in `x²`.
pub(crate) fn is_of_name(c: char) -> bool {
    begins_name(c) || c.is_ascii_digit()
}

fn strange(c: char, span: Span) -> Complaint {
    let complaint = Complaint::new(span, format!("`{c}` has no meaning in an expression"));
    match STRANGE.iter().find(|(strange, _)| *strange == c) {
        Some((_, help)) => complaint.help(*help),
        None => complaint.help(
            "names have letters, the digits 0 to 9 and `_`, as in `x_1`; operators are `+ - * / ^`",
        ),
    }
}

/// Whether a text that begins with a point is a number.
fn starts_fraction(text: &str) -> bool {
    text.as_bytes().get(1).is_some_and(u8::is_ascii_digit)
}

/// Length of the number that the text begins with. The two points of a range are no part of it.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|c| c.is_ascii_digit()).count();
    let mut end = digits(0);
    if bytes.get(end) == Some(&b'.') && bytes.get(end + 1) != Some(&b'.') {
        end += 1 + digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits((end + 1 + sign).min(bytes.len()));
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}

fn number(text: &str, span: Span) -> Checked<f64> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(Complaint::new(span, format!("`{text}` is beyond the largest number"))
            .help("numbers go up to 1.8e308; choose a larger unit")),
    }
}

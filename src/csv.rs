//! Fields and headers of CSV files.

use std::borrow::Cow;

/// A number as it reads back to the same bits; empty for none.
pub(crate) fn exact(x: Option<f64>) -> String {
    x.map_or_else(String::new, |x| format!("{x:e}"))
}

/// Text as a field of a CSV file.
pub(crate) fn field(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// The fields of a line, quotes taken off.
pub(crate) fn fields(line: &str) -> impl Iterator<Item = Cow<'_, str>> {
    let mut rest = Some(line);
    std::iter::from_fn(move || {
        let text = rest?;
        let end = text.find(',').unwrap_or(text.len());
        if !text[..end].contains('"') {
            rest = text.get(end + 1..);
            return Some(Cow::Borrowed(&text[..end]));
        }
        let (field, end) = quoted(text);
        rest = text.get(end + 1..);
        Some(Cow::Owned(field))
    })
}

/// The first field of a text that has quotes in it, and where it ends.
fn quoted(text: &str) -> (String, usize) {
    let (mut field, mut is_quoted) = (String::new(), false);
    let mut chars = text.char_indices().peekable();
    while let Some((at, c)) = chars.next() {
        match c {
            '"' if is_quoted && chars.peek().is_some_and(|(_, next)| *next == '"') => {
                field.push('"');
                chars.next();
            }
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted => return (field, at),
            c => field.push(c),
        }
    }
    (field, text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_may_be_empty_or_quoted() {
        assert_eq!(fields("a,,b,").collect::<Vec<_>>(), ["a", "", "b", ""]);
        assert_eq!(
            fields("1,\"a,b\",\"x \"\"y\"\"\"").collect::<Vec<_>>(),
            ["1", "a,b", "x \"y\""]
        );
        assert_eq!(fields("").collect::<Vec<_>>(), [""]);
    }
}

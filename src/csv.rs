//! CSV files: tables by their columns, and fields.

use std::borrow::Cow;

/// A column of a table: its name, and what a row has in it, as it is to stand there.
pub(crate) type Column<R> = (&'static str, fn(&R) -> String);

/// A table with the names of its columns above: one line a row.
pub(crate) fn table<R>(rows: impl IntoIterator<Item = R>, columns: &[Column<R>]) -> String {
    let mut csv = header(columns) + "\n";
    for row in rows {
        csv += &(line(&row, columns) + "\n");
    }
    csv
}

/// The names of columns.
pub(crate) fn header<R>(columns: &[Column<R>]) -> String {
    columns.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(",")
}

/// The fields of a row.
pub(crate) fn line<R>(row: &R, columns: &[Column<R>]) -> String {
    columns.iter().map(|(_, of)| of(row)).collect::<Vec<_>>().join(",")
}

/// A number as it reads back to the same bits.
pub(crate) fn number(x: f64) -> String {
    format!("{x:e}")
}

/// A number as [`number`] writes it; empty for none.
pub(crate) fn exact(x: Option<f64>) -> String {
    x.map_or_else(String::new, number)
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

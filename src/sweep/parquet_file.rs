//! `runs.parquet`: the rows of `runs.csv` by column, each with its type.
//!
//! Numbers are `DOUBLE`, whole ones `INT64`, truths `BOOLEAN`, words `STRING`, each optional: what a row does not have is
//! null. The key `deltazero` of the file's metadata has what `sweep.json` has of the plan, the configuration, the version and the units.

use std::io::{self, BufRead, Write};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{ConvertedType, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;

use super::columns::{CellKind, Head};
use crate::atomic_file::{self, FileError};
use crate::csv::fields;

/// Rows of a group, which is in memory as a whole.
const GROUP: usize = 50_000;

/// The values of a column that are there, and of each row whether it has one.
struct Column {
    values: Values,
    is_there: Vec<i16>,
}

enum Values {
    Numbers(Vec<f64>),
    Counts(Vec<i64>),
    Truths(Vec<bool>),
    Words(Vec<ByteArray>),
}

impl Column {
    fn new(kind: CellKind) -> Self {
        let values = match kind {
            CellKind::Number => Values::Numbers(Vec::new()),
            CellKind::Count => Values::Counts(Vec::new()),
            CellKind::Truth => Values::Truths(Vec::new()),
            CellKind::Text => Values::Words(Vec::new()),
        };
        Self { values, is_there: Vec::new() }
    }

    /// Adds the field of a row; empty, there is none. None where it is not of the column's type.
    fn add(&mut self, field: &str) -> Option<()> {
        self.is_there.push((!field.is_empty()).into());
        if field.is_empty() {
            return Some(());
        }
        match &mut self.values {
            Values::Numbers(all) => all.push(field.parse().ok()?),
            Values::Counts(all) => all.push(field.parse().ok()?),
            Values::Truths(all) => all.push(field.parse().ok()?),
            Values::Words(all) => all.push(field.into()),
        }
        Some(())
    }

    /// Writes what was added, and forgets it.
    fn write(&mut self, mut column: SerializedColumnWriter<'_>) -> Result<()> {
        let is_there = Some(&self.is_there[..]);
        match &mut self.values {
            Values::Numbers(all) => {
                column.typed::<DoubleType>().write_batch(all, is_there, None)?;
                all.clear();
            }
            Values::Counts(all) => {
                column.typed::<Int64Type>().write_batch(all, is_there, None)?;
                all.clear();
            }
            Values::Truths(all) => {
                column.typed::<BoolType>().write_batch(all, is_there, None)?;
                all.clear();
            }
            Values::Words(all) => {
                column.typed::<ByteArrayType>().write_batch(all, is_there, None)?;
                all.clear();
            }
        }
        self.is_there.clear();
        column.close()
    }
}

/// Why there is no file.
#[derive(Debug, thiserror::Error)]
pub(super) enum Refused {
    /// A line with more or fewer fields than columns, with a field that is not of its column's kind, or that is no text.
    #[error("line {line}{why}")]
    Row {
        /// Its number, from 1.
        line: usize,
        /// What is wrong with it.
        why: String,
    },
    /// The rows cannot be read.
    #[error(transparent)]
    Unread(io::Error),
    /// The file system.
    #[error(transparent)]
    File(#[from] FileError),
}

/// Writes the rows of `csv`, whose columns have these heads, to `path` with this metadata.
///
/// # Errors
/// [`Refused`].
pub(super) fn write(
    csv: impl BufRead,
    heads: &[Head],
    metadata: String,
    path: &Path,
) -> std::result::Result<(), Refused> {
    let mut refused = None;
    let written = atomic_file::write_by(path, |out| {
        to(out, csv, heads, metadata, &mut refused).map_err(io::Error::other)
    });
    match (written, refused) {
        (Err(_), Some(refused)) => Err(refused),
        (written, _) => Ok(written?),
    }
}

/// The same to `out`; what of the rows ends it is told in `refused`.
fn to(
    out: impl Write + Send,
    csv: impl BufRead,
    heads: &[Head],
    metadata: String,
    refused: &mut Option<Refused>,
) -> Result<()> {
    let schema = schema(heads)?;
    let metadata = Some(vec![KeyValue::new("deltazero".to_owned(), metadata)]);
    let properties = WriterProperties::builder().set_key_value_metadata(metadata).build();
    let mut writer = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))?;
    let mut columns: Vec<Column> = heads.iter().map(|head| Column::new(head.kind)).collect();
    let mut n = 0;
    // The first line is the header.
    for (line, text) in csv.lines().enumerate().skip(1) {
        let row = |why| Refused::Row { line: line + 1, why };
        let added = match text {
            Ok(text) => add(&text, heads, &mut columns).map_err(row),
            // A row that is no text; else the file cannot be read.
            Err(error) if error.kind() == io::ErrorKind::InvalidData => {
                Err(row(format!(": {error}")))
            }
            Err(error) => Err(Refused::Unread(error)),
        };
        if let Err(why) = added {
            *refused = Some(why);
            return Err(ParquetError::General("the rows cannot be told by column".to_owned()));
        }
        n += 1;
        if n == GROUP {
            group(&mut writer, &mut columns)?;
            n = 0;
        }
    }
    if n > 0 {
        group(&mut writer, &mut columns)?;
    }
    writer.close()?;
    Ok(())
}

/// Adds the fields of a row; what is wrong with it.
fn add(row: &str, heads: &[Head], columns: &mut [Column]) -> std::result::Result<(), String> {
    let n = fields(row).count();
    if n != columns.len() {
        return Err(format!(" has {n} fields of {} columns", columns.len()));
    }
    for ((field, head), column) in fields(row).zip(heads).zip(columns) {
        let name = &head.name;
        column.add(&field).ok_or_else(|| format!(", {name}: {field:?} is no {}", head.kind))?;
    }
    Ok(())
}

fn schema(heads: &[Head]) -> Result<Type> {
    let field = |head: &Head| {
        let physical = match head.kind {
            CellKind::Number => Physical::DOUBLE,
            CellKind::Count => Physical::INT64,
            CellKind::Truth => Physical::BOOLEAN,
            CellKind::Text => Physical::BYTE_ARRAY,
        };
        let field = Type::primitive_type_builder(&head.name, physical)
            .with_repetition(Repetition::OPTIONAL);
        let field = match head.kind {
            CellKind::Text => field
                .with_logical_type(Some(LogicalType::String))
                .with_converted_type(ConvertedType::UTF8),
            _ => field,
        };
        field.build().map(Arc::new)
    };
    let fields = heads.iter().map(field).collect::<Result<_>>()?;
    Type::group_type_builder("runs").with_fields(fields).build()
}

/// Writes a group of rows.
fn group<W: Write + Send>(
    writer: &mut SerializedFileWriter<W>,
    columns: &mut [Column],
) -> Result<()> {
    let mut group = writer.next_row_group()?;
    for column in columns {
        let own = group.next_column()?;
        column.write(own.ok_or_else(|| ParquetError::General("a column too many".to_owned()))?)?;
    }
    group.close()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::io::{BufReader, Read as _};

    use parquet::file::reader::{FileReader as _, SerializedFileReader};
    use parquet::record::RowAccessor as _;

    use super::*;

    /// A disk that cannot be read.
    struct Broken;

    impl io::Read for Broken {
        fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
            Err(io::Error::from(io::ErrorKind::TimedOut))
        }
    }

    fn head(name: &str, kind: CellKind) -> Head {
        Head { name: name.to_owned(), unit: String::new(), kind }
    }

    #[test]
    fn rows_come_back_with_their_types() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("runs.parquet");
        let csv = "run,K,law,peak,stops\n0,1e7,\"a,b\",0.1,true\n1,2.5,\"say \"\"c\"\"\",,false\n";
        let heads = [
            head("run", CellKind::Count),
            head("K", CellKind::Number),
            head("law", CellKind::Text),
            head("peak", CellKind::Number),
            head("stops", CellKind::Truth),
        ];
        write(csv.as_bytes(), &heads, "{}".to_owned(), &path).unwrap();
        let reader = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        let metadata = reader.metadata().file_metadata();
        assert_eq!(metadata.key_value_metadata().unwrap()[0].value.as_deref(), Some("{}"));
        let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 2);
        assert_eq!(rows[0].get_long(0).unwrap(), 0);
        assert_eq!(rows[1].get_double(1).unwrap(), 2.5);
        assert_eq!(rows[0].get_string(2).unwrap(), "a,b");
        assert_eq!(rows[1].get_string(2).unwrap(), "say \"c\"");
        assert_eq!(rows[0].get_double(3).unwrap(), 0.1);
        assert!(rows[1].get_double(3).is_err());
        assert_eq!([0, 1].map(|i| rows[i].get_bool(4).unwrap()), [true, false]);
        let heads = [head("n", CellKind::Count), head("x", CellKind::Number)];
        for (row, why) in [
            ("1,y", "line 3, x: \"y\" is no number"),
            ("x,1", "line 3, n: \"x\" is no whole number"),
            ("1", "line 3 has 1 fields of 2 columns"),
            ("1,2,3", "line 3 has 3 fields of 2 columns"),
        ] {
            let csv = format!("n,x\n0,1\n{row}\n");
            let refused = write(csv.as_bytes(), &heads, String::new(), &path).unwrap_err();
            assert!(refused.to_string().contains(why), "{refused}");
        }
        let refused = write(&b"n,x\n0,1\n\xff,1\n"[..], &heads, String::new(), &path).unwrap_err();
        assert!(refused.to_string().starts_with("line 3: "), "{refused}");
        let unread = "n,x\n0,1\n".as_bytes().chain(BufReader::new(Broken));
        let refused = write(unread, &heads, String::new(), &path).unwrap_err();
        assert!(matches!(refused, Refused::Unread(_)), "{refused}");
        // What was there before is still there.
        assert!(SerializedFileReader::new(std::fs::File::open(&path).unwrap()).is_ok());
    }
}

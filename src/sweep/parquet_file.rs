//! `runs.parquet`: the rows of `runs.csv` by column, each with its type.
//!
//! Numbers are `DOUBLE`, whole ones `INT64`, words `STRING`, each optional: what a row does not have is null. The key
//! `deltazero` of the file's metadata has what `sweep.json` has of the plan, the configuration, the version and the units.

use std::borrow::Cow;
use std::io::{self, BufRead, Write};
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{ConvertedType, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;

use super::columns::CellKind;
use super::csv::fields;
use super::whole;

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
    Words(Vec<ByteArray>),
}

impl Column {
    fn new(kind: CellKind) -> Self {
        let values = match kind {
            CellKind::Number => Values::Numbers(Vec::new()),
            CellKind::Count => Values::Counts(Vec::new()),
            CellKind::Text => Values::Words(Vec::new()),
        };
        Self { values, is_there: Vec::new() }
    }

    /// Adds the field of a row; empty, there is none.
    fn add(&mut self, field: &str) -> Result<()> {
        self.is_there.push((!field.is_empty()).into());
        if field.is_empty() {
            return Ok(());
        }
        let refused = || ParquetError::General(format!("{field:?} is not of its column's type"));
        match &mut self.values {
            Values::Numbers(all) => all.push(field.parse().map_err(|_| refused())?),
            Values::Counts(all) => all.push(field.parse().map_err(|_| refused())?),
            Values::Words(all) => all.push(field.into()),
        }
        Ok(())
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
            Values::Words(all) => {
                column.typed::<ByteArrayType>().write_batch(all, is_there, None)?;
                all.clear();
            }
        }
        self.is_there.clear();
        column.close()
    }
}

/// Writes the rows of `csv`, whose columns have these kinds, to `path` with this metadata.
///
/// # Errors
/// Those of the file system, and a field that is not of its column's kind.
pub(super) fn write(
    csv: impl BufRead,
    kinds: &[CellKind],
    metadata: String,
    path: &Path,
) -> io::Result<()> {
    whole::write_by(path, |out| to(out, csv, kinds, metadata).map_err(io::Error::other))
}

fn to(
    out: impl Write + Send,
    csv: impl BufRead,
    kinds: &[CellKind],
    metadata: String,
) -> Result<()> {
    let mut lines = csv.lines();
    let header = lines.next().unwrap_or_else(|| Ok(String::new()))?;
    let schema = schema(fields(&header), kinds)?;
    let metadata = Some(vec![KeyValue::new("deltazero".to_owned(), metadata)]);
    let properties = WriterProperties::builder().set_key_value_metadata(metadata).build();
    let mut writer = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))?;
    let mut columns: Vec<Column> = kinds.iter().map(|kind| Column::new(*kind)).collect();
    let mut n = 0;
    for line in lines {
        let line = line?;
        for (column, field) in columns.iter_mut().zip(fields(&line)) {
            column.add(&field)?;
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

fn schema<'a>(names: impl Iterator<Item = Cow<'a, str>>, kinds: &[CellKind]) -> Result<Type> {
    let field = |(name, kind): (Cow<'_, str>, &CellKind)| {
        let physical = match kind {
            CellKind::Number => Physical::DOUBLE,
            CellKind::Count => Physical::INT64,
            CellKind::Text => Physical::BYTE_ARRAY,
        };
        let field =
            Type::primitive_type_builder(&name, physical).with_repetition(Repetition::OPTIONAL);
        let field = match kind {
            CellKind::Text => field
                .with_logical_type(Some(LogicalType::String))
                .with_converted_type(ConvertedType::UTF8),
            _ => field,
        };
        field.build().map(Arc::new)
    };
    let fields = names.zip(kinds).map(field).collect::<Result<_>>()?;
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
    use parquet::file::reader::{FileReader as _, SerializedFileReader};
    use parquet::record::RowAccessor as _;

    use super::*;

    #[test]
    fn rows_come_back_with_their_types() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("runs.parquet");
        let csv = "run,K,law,peak\n0,1e7,\"a,b\",0.1\n1,2.5,\"say \"\"c\"\"\",\n";
        let kinds = [CellKind::Count, CellKind::Number, CellKind::Text, CellKind::Number];
        write(csv.as_bytes(), &kinds, "{}".to_owned(), &path).unwrap();
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
        let refused = write("n\nx\n".as_bytes(), &[CellKind::Count], String::new(), &path);
        assert!(refused.unwrap_err().to_string().contains("\"x\""));
        // What was there before is still there.
        assert!(SerializedFileReader::new(std::fs::File::open(&path).unwrap()).is_ok());
    }
}

//! The columns of a finished sweep: of a million rows only what is asked for is in memory.

use std::borrow::Cow;
use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{self, BufRead as _, BufReader};
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::columns::CellKind;
use super::plan::Plan;
use super::reasons::Reasons;
use super::runner::OK;
use super::{RECORD, ROWS};
use crate::config::nearest_word;
use crate::csv::fields;

pub use super::reasons::Reason;
pub use super::results_error::ResultsError;

/// Different words that a column may have.
const MOST_WORDS: usize = 1000;

/// A finished sweep on disk.
pub struct Results {
    /// What was run.
    pub plan: Plan,
    /// The names of the columns.
    pub columns: Vec<String>,
    units: HashMap<String, String>,
    kinds: HashMap<String, String>,
    /// All that the sweep tells of itself.
    pub(super) record: Value,
    path: PathBuf,
}

/// What the runs have that came to their end, column by column.
#[derive(Debug, PartialEq)]
pub struct Table {
    /// With their names, in the order in which they were asked for.
    pub columns: Vec<(String, Column)>,
    /// Runs that did not come to their end, which have no row here.
    pub failed: u64,
    /// Why they did not, the commonest reason first.
    pub reasons: Vec<Reason>,
}

impl Table {
    /// The column of this name.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|(own, _)| own == name).map(|(_, column)| column)
    }

    /// Runs that came to their end.
    pub fn n_rows(&self) -> usize {
        self.columns.first().map_or(0, |(_, column)| column.len())
    }
}

/// A column.
#[derive(Clone, Debug, PartialEq)]
pub enum Column {
    /// Numbers; one that a run does not have is not a number.
    Numbers(Vec<f64>),
    /// Words.
    Words {
        /// Each word once, in the order of the rows.
        words: Vec<String>,
        /// Which of them each row has.
        of_row: Vec<u32>,
    },
}

impl Column {
    /// Runs that it is of.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Words { of_row, .. } => of_row.len(),
        }
    }

    /// Whether it is of no run.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Results {
    /// The sweep that `dir` holds.
    ///
    /// # Errors
    /// None there, or one that is not finished.
    pub fn open(dir: &Path) -> Result<Self, ResultsError> {
        let record = dir.join(RECORD);
        let text = fs::read(&record)
            .map_err(|source| ResultsError::Missing { path: record.clone(), source })?;
        let of_record = || {
            let value: Value = serde_json::from_slice(&text).ok()?;
            let plan: Plan = serde_json::from_value(value["plan"].clone()).ok()?;
            plan.n_runs().filter(|n| *n > 0)?;
            Some((value["finished"] == true, plan, value))
        };
        let Some((is_finished, plan, record)) = of_record() else {
            return Err(ResultsError::Record { path: record });
        };
        if !is_finished {
            return Err(ResultsError::Unfinished { dir: dir.to_owned() });
        }
        // A sweep of an earlier build told no kinds.
        let texts = |name: &str| {
            let all = record[name].as_array().into_iter().flatten();
            all.map(|text| text.as_str().unwrap_or_default().to_owned()).collect::<Vec<_>>()
        };
        let of_columns = |name| texts("columns").into_iter().zip(texts(name)).collect();
        let (units, kinds) = (of_columns("units"), of_columns("kinds"));
        let (columns, path) = (Vec::new(), dir.join(ROWS));
        let mut results = Self { plan, columns, units, kinds, record, path };
        let mut line = String::new();
        results.file()?.read_line(&mut line).map_err(|source| results.missing(source))?;
        let bytes = fs::metadata(&results.path).map_err(|source| results.missing(source))?.len();
        if results.record["bytes"].as_u64().is_some_and(|written| bytes < written) {
            return Err(ResultsError::Length { path: results.path });
        }
        results.columns = fields(line.trim_end_matches('\n')).map(Cow::into_owned).collect();
        Ok(results)
    }

    /// The unit of a column, empty for none.
    pub fn unit(&self, column: &str) -> &str {
        self.units.get(column).map_or("", String::as_str)
    }

    /// A column with its unit, as an axis has it.
    pub fn label(&self, column: &str) -> String {
        match self.unit(column) {
            "" => column.to_owned(),
            unit => format!("{column} [{unit}]"),
        }
    }

    /// The columns of the keys that the plan sets, in the order of [`Plan::keys`]: they stand after the number of the run.
    pub fn key_columns(&self) -> &[String] {
        self.columns.get(1..=self.plan.keys().len()).unwrap_or_default()
    }

    /// These columns of all runs that came to their end.
    ///
    /// # Errors
    /// A column that is not there or has too many words, or a file that cannot be read.
    pub fn table(&self, names: &[&str]) -> Result<Table, ResultsError> {
        let mut readers: Vec<Reader> = names.iter().map(|name| self.reader(name)).collect();
        let mut reasons = Reasons::default();
        self.rows(names, |status, row| {
            if status != OK {
                reasons.add(status);
                return Ok(());
            }
            let mut columns = readers.iter_mut().zip(row).zip(names);
            columns.try_for_each(|((reader, text), name)| reader.add(text, name))
        })?;
        let reasons = reasons.sorted();
        let columns = names.iter().zip(readers);
        Ok(Table {
            columns: columns.map(|(name, own)| ((*name).to_owned(), own.column())).collect(),
            failed: reasons.iter().map(|reason| reason.n).sum(),
            reasons,
        })
    }

    fn reader(&self, column: &str) -> Reader {
        let is_of_words =
            self.kinds.get(column).is_some_and(|kind| *kind == CellKind::Text.to_string());
        Reader { numbers: (!is_of_words).then(Vec::new), words: Some(Words::default()) }
    }

    /// Calls `each` with every row, one after the other: the status of the run, and its fields in `names`.
    ///
    /// # Errors
    /// A column that is not there, a file that cannot be read, or what `each` says.
    pub fn rows(
        &self,
        names: &[&str],
        mut each: impl FnMut(&str, &[Cow<'_, str>]) -> Result<(), ResultsError>,
    ) -> Result<(), ResultsError> {
        let of_status = self.position("status")?;
        let places = names.iter().map(|name| self.position(name));
        let places: Vec<usize> = places.collect::<Result<_, _>>()?;
        let mut file = self.file()?;
        let mut text = String::new();
        for line in 1.. {
            text.clear();
            if file.read_line(&mut text).map_err(|source| self.missing(source))? == 0 {
                break;
            }
            if line == 1 {
                continue;
            }
            let mut row = vec![Cow::Borrowed(""); names.len()];
            let (mut status, mut n) = (Cow::Borrowed(""), 0);
            for (at, field) in fields(text.trim_end_matches('\n')).enumerate() {
                n += 1;
                for (_, own) in places.iter().zip(&mut row).filter(|(place, _)| **place == at) {
                    own.clone_from(&field);
                }
                if at == 0 && field.parse() != Ok(line - 2) {
                    let (path, wanted) = (self.path.clone(), line - 2);
                    return Err(ResultsError::Order { path, line, wanted });
                }
                if at == of_status {
                    status = field;
                }
            }
            if n != self.columns.len() {
                return Err(ResultsError::Row { path: self.path.clone(), line });
            }
            each(&status, &row)?;
        }
        Ok(())
    }

    /// The place of a column.
    ///
    /// # Errors
    /// It is not there: which is the nearest, and all that are.
    pub(super) fn position(&self, name: &str) -> Result<usize, ResultsError> {
        self.columns.iter().position(|own| own == name).ok_or_else(|| {
            let nearest = nearest_word(name, self.columns.iter().map(String::as_str));
            ResultsError::Column {
                path: self.path.clone(),
                name: name.to_owned(),
                nearest: nearest.map(str::to_owned),
                known: self.columns.join(", "),
            }
        })
    }

    fn file(&self) -> Result<BufReader<File>, ResultsError> {
        let file = File::open(&self.path).map_err(|source| self.missing(source))?;
        Ok(BufReader::with_capacity(1 << 16, file))
    }

    fn missing(&self, source: io::Error) -> ResultsError {
        ResultsError::Missing { path: self.path.clone(), source }
    }
}

/// A column as far as it is read.
#[derive(Clone)]
struct Reader {
    /// Its numbers; none of a column of words, and once there is a word.
    numbers: Option<Vec<f64>>,
    /// Its texts as they are written; none once there are too many.
    words: Option<Words>,
}

/// Texts, each once.
#[derive(Clone, Default)]
struct Words {
    all: Vec<String>,
    known: HashMap<String, u32>,
    of_row: Vec<u32>,
}

impl Reader {
    /// Adds a field. Numbers stay numbers as long as there is no word; then all are words, each as it is written.
    fn add(&mut self, text: &str, name: &str) -> Result<(), ResultsError> {
        let number = if text.is_empty() { Some(f64::NAN) } else { text.parse().ok() };
        match (&mut self.numbers, number) {
            // The zero below zero is the same number.
            (Some(numbers), Some(number)) => numbers.push(number + 0.0),
            _ => self.numbers = None,
        }
        if !self.words.as_mut().is_some_and(|words| words.add(text)) {
            self.words = None;
        }
        if self.numbers.is_none() && self.words.is_none() {
            return Err(ResultsError::Words { name: name.to_owned(), most: MOST_WORDS });
        }
        Ok(())
    }

    fn column(self) -> Column {
        if let Some(numbers) = self.numbers {
            return Column::Numbers(numbers);
        }
        let Words { all, of_row, .. } = self.words.unwrap_or_default();
        Column::Words { words: all, of_row }
    }
}

impl Words {
    /// Adds the text of a row; whether there is a place for it.
    fn add(&mut self, text: &str) -> bool {
        if let Some(known) = self.known.get(text) {
            self.of_row.push(*known);
            return true;
        }
        if self.all.len() == MOST_WORDS {
            return false;
        }
        let new = self.all.len() as u32;
        self.known.insert(text.to_owned(), new);
        self.of_row.push(new);
        self.all.push(text.to_owned());
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECORD: &str = r#"{"finished": true, "columns": ["run", "a.b", "status", "w", "x_m"],
        "units": ["", "N/m", "", "", "m"], "plan": {"axes": [], "random": null, "chunk": 1}}"#;

    fn results(dir: &Path, rows: &str) -> Results {
        fs::write(dir.join("sweep.json"), RECORD).unwrap();
        fs::write(dir.join("runs.csv"), format!("run,a.b,status,w,x_m\n{rows}")).unwrap();
        Results::open(dir).unwrap()
    }

    #[test]
    fn columns_are_numbers_or_words_and_failed_runs_have_no_row() {
        let dir = tempfile::tempdir().unwrap();
        let rows = "0,1e3,ok,free,1\n1,2e3,\"no, none\",,\n2,none,ok,,\n3,1e3,ok,free,3\n";
        let results = results(dir.path(), rows);
        let table = results.table(&["x_m", "w", "a.b", "x_m"]).unwrap();
        assert_eq!((table.failed, table.n_rows()), (1, 3));
        assert_eq!(table.reasons[0].first, "no, none");
        let Column::Numbers(x) = &table.columns[0].1 else { panic!("{table:?}") };
        assert!(x[0] == 1.0 && x[1].is_nan() && x[2] == 3.0);
        let words = |words: &[&str], of_row: &[u32]| Column::Words {
            words: words.iter().map(|word| (*word).to_owned()).collect(),
            of_row: of_row.to_vec(),
        };
        assert_eq!(table.columns[1].1, words(&["free", ""], &[0, 1, 0]));
        assert_eq!(*table.column("a.b").unwrap(), words(&["1e3", "none"], &[0, 1, 0]));
        assert_eq!((results.label("a.b"), results.label("w")), ("a.b [N/m]".into(), "w".into()));
    }

    #[test]
    fn a_word_that_reads_as_a_number_is_one_word_before_and_after_the_first_other() {
        let dir = tempfile::tempdir().unwrap();
        let rows = "0,1,ok,1,1\n1,2,ok,free,2\n2,3,ok,1,3\n3,4,ok,,4\n";
        let table = results(dir.path(), rows).table(&["w"]).unwrap();
        let words = ["1", "free", ""].map(str::to_owned).to_vec();
        let expected = Column::Words { words, of_row: vec![0, 1, 0, 2] };
        assert_eq!(table.columns[0].1, expected);
    }

    #[test]
    fn words_that_read_as_numbers_are_words_where_the_record_says_so() {
        let dir = tempfile::tempdir().unwrap();
        let rows = "0,1,ok,inf,inf\n1,2,ok,nan,2\n2,3,ok,1e3,3\n";
        results(dir.path(), rows);
        let kinds = r#""kinds": ["whole number", "number", "word", "word", "number"], "units""#;
        fs::write(dir.path().join("sweep.json"), RECORD.replacen(r#""units""#, kinds, 1)).unwrap();
        let table = Results::open(dir.path()).unwrap().table(&["w", "x_m"]).unwrap();
        let words = ["inf", "nan", "1e3"].map(str::to_owned).to_vec();
        assert_eq!(table.columns[0].1, Column::Words { words, of_row: vec![0, 1, 2] });
        assert_eq!(table.columns[1].1, Column::Numbers(vec![f64::INFINITY, 2.0, 3.0]));
    }

    #[test]
    fn numbers_may_be_many_and_words_may_not() {
        let dir = tempfile::tempdir().unwrap();
        let row = |i: usize| format!("{i},{i},ok,{i},1\n");
        let rows: String = (0..=MOST_WORDS).map(row).collect();
        let column = |rows: &str| results(dir.path(), rows).table(&["w"]);
        let table = column(&rows).unwrap();
        assert!(matches!(table.columns[0].1, Column::Numbers(_)) && table.n_rows() == 1001);
        let error = column(&(rows + "1001,1,ok,free,1\n")).unwrap_err();
        assert!(matches!(error, ResultsError::Words { .. }), "{error}");
    }

    #[test]
    fn what_is_wrong_is_named() {
        let dir = tempfile::tempdir().unwrap();
        let results = results(dir.path(), "0,1,ok,free,1\n1,1,ok\n");
        let error = |names: &[&str]| results.table(names).unwrap_err().to_string();
        assert!(
            error(&["x_mm"]).contains("no column \"x_mm\", did you mean \"x_m\"?; it has run, a.b")
        );
        assert!(error(&["x_m"]).contains("runs.csv:3: not as it was written"));
        let error = self::results(dir.path(), "1,1,ok,free,1\n0,1,ok,free,1\n").table(&["x_m"]);
        assert!(error.unwrap_err().to_string().contains("runs.csv:2: run 0 is wanted here"));
        fs::write(dir.path().join("sweep.json"), RECORD.replace("true", "false")).unwrap();
        let error = Results::open(dir.path()).err().unwrap().to_string();
        assert!(error.contains("is not finished"), "{error}");
    }

    #[test]
    fn a_record_whose_plan_has_no_runs_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        results(dir.path(), "0,1,ok,free,1\n");
        for values in
            [r#"{"list": []}"#, r#"{"log": {"ends": [1, 2], "points": 0, "whole": false}}"#]
        {
            let axes = format!(r#""axes": [{{"key": "a.b", "values": {values}}}]"#);
            let record = RECORD.replace(r#""axes": []"#, &axes);
            fs::write(dir.path().join("sweep.json"), record).unwrap();
            let error = Results::open(dir.path()).err();
            assert!(matches!(error, Some(ResultsError::Record { .. })), "{values}");
        }
    }
}

//! What the runs of a finished sweep say in a few numbers, and which key each of them follows most.

use deltazero_study::quantile::quantile;

use super::ranks::{Correlation, spearman};
use super::results::{Column, Results, ResultsError, Table};

/// The parts below which a column is told, from the least to the largest.
pub const PARTS: [f64; 5] = [0.0, 0.05, 0.5, 0.95, 1.0];

/// Numbers that differ by no more than this part of the largest are one but for rounding.
const ALIKE: f64 = 1e-11;

/// Whether numbers between these two are one but for rounding.
pub fn are_alike(least: f64, largest: f64) -> bool {
    largest - least <= ALIKE * least.abs().max(largest.abs())
}

/// Words that tell of every run, where the runs have them.
const WORDS: [&str; 2] = ["outcome", "warnings"];
/// What the estimate of a run's error tells, and the number of the run.
const CHECKED: [&str; 4] = ["run", "horizon_s", "estimated_e", "events_right"];
/// The word for a run that has the right events.
const YES: &str = "yes";

/// What the runs of a sweep say.
pub struct Summary {
    /// The columns that it is of, in the order in which they were asked for, then words of every run.
    pub columns: Vec<(String, Said)>,
    /// The rank correlations of each varied key with each column, the strongest first.
    pub follows: Vec<Follows>,
    /// Keys of words, which have no ranks.
    pub unranked: Vec<String>,
    /// What is known of the errors of runs; none where the plan checks none.
    pub checked: Option<Checked>,
}

/// What the runs say in a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Said {
    /// Numbers: how many runs have one, and what a part [`PARTS`] of these lies below, if there are any.
    Numbers(u64, Option<[f64; PARTS.len()]>),
    /// Each word with the number of runs that have it, the commonest first.
    Words(Vec<(String, u64)>),
}

impl Said {
    /// Whether it is not the same in all runs, but for rounding.
    pub fn varies(&self) -> bool {
        match self {
            Self::Numbers(_, None) => false,
            Self::Numbers(_, Some([least, .., largest])) => !are_alike(*least, *largest),
            Self::Words(words) => words.len() > 1,
        }
    }
}

/// How a column follows a key.
#[derive(Clone, Debug, PartialEq)]
pub struct Follows {
    /// The column.
    pub column: String,
    /// The column of the key.
    pub key: String,
    /// How it does.
    pub correlation: Correlation,
}

/// Runs whose errors are estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checked {
    /// Runs that tight ones were made for.
    pub n: u64,
    /// Those of them whose events can be judged.
    pub judged: u64,
    /// Those that have the right events.
    pub right: u64,
    /// The largest estimated error e, and the number of its run.
    pub worst: Option<(f64, u64)>,
}

impl Summary {
    /// The columns that [`of`](Self::of) needs of a sweep, each once: keys, `columns`, words of every run, estimates.
    ///
    /// # Errors
    /// One of `columns` that is not there, or is a key of the plan.
    pub fn needs<'a>(
        results: &'a Results,
        columns: &[&'a str],
    ) -> Result<Vec<&'a str>, ResultsError> {
        let keys = results.key_columns();
        for column in columns {
            results.position(column)?;
            if keys.iter().any(|key| key == column) {
                let known = results.columns.iter().filter(|own| !keys.contains(own));
                let known: Vec<&str> = known.map(String::as_str).collect();
                return Err(ResultsError::Key {
                    name: (*column).to_owned(),
                    known: known.join(", "),
                });
            }
        }
        let estimates = if results.plan.check > 0.0 { &CHECKED[..] } else { &[] };
        let keys = keys.iter().map(String::as_str);
        let more = WORDS.iter().chain(estimates).copied();
        let more = more.filter(|name| results.position(name).is_ok());
        let mut needed: Vec<&str> = Vec::new();
        for name in keys.chain(columns.iter().copied()).chain(more) {
            if !needed.contains(&name) {
                needed.push(name);
            }
        }
        Ok(needed)
    }

    /// The summary of `columns` from a table that has all that it [needs](Self::needs).
    pub fn of(results: &Results, table: &Table, columns: &[&str]) -> Self {
        let words = WORDS.iter().filter(|word| !columns.contains(word));
        let words =
            words.filter_map(|name| Some(((*name).to_owned(), words_of(table.column(name)?))));
        let own =
            columns.iter().filter_map(|name| Some(((*name).to_owned(), said(table.column(name)?))));
        let keys = results.key_columns();
        let has_words = |key: &&String| matches!(table.column(key), Some(Column::Words { .. }));
        Self {
            columns: own.chain(words).collect(),
            follows: follows(table, keys, columns),
            unranked: keys.iter().filter(has_words).cloned().collect(),
            checked: (results.plan.check > 0.0).then(|| checked(table)),
        }
    }

    /// Whether a column is not the same in all runs.
    pub fn varies(&self, column: &str) -> bool {
        self.columns.iter().any(|(own, said)| own == column && said.varies())
    }

    /// How a column follows the key that it follows most.
    pub fn strongest(&self, column: &str) -> Option<&Follows> {
        self.follows.iter().find(|own| own.column == column)
    }
}

/// What is said in words: a column in which no run has one is read as one of numbers that are not there.
fn words_of(column: &Column) -> Said {
    match said(column) {
        Said::Numbers(0, None) => {
            let none = (String::new(), column.len() as u64);
            Said::Words(if column.is_empty() { Vec::new() } else { vec![none] })
        }
        own => own,
    }
}

fn said(column: &Column) -> Said {
    match column {
        Column::Numbers(numbers) => {
            let mut own: Vec<f64> = numbers.iter().copied().filter(|x| x.is_finite()).collect();
            let n = own.len() as u64;
            let at = PARTS.map(|part| quantile(&mut own, part).unwrap_or(f64::NAN));
            Said::Numbers(n, (n > 0).then_some(at))
        }
        Column::Words { words, of_row } => {
            let mut counts: Vec<(String, u64)> =
                words.iter().map(|word| (word.clone(), 0)).collect();
            of_row.iter().for_each(|word| counts[*word as usize].1 += 1);
            counts.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
            Said::Words(counts)
        }
    }
}

fn numbers<'a>(table: &'a Table, name: &str) -> Option<&'a [f64]> {
    match table.column(name)? {
        Column::Numbers(numbers) => Some(numbers),
        Column::Words { .. } => None,
    }
}

fn follows(table: &Table, keys: &[String], columns: &[&str]) -> Vec<Follows> {
    let mut all = Vec::new();
    for column in columns {
        let Some(y) = numbers(table, column) else { continue };
        if !table.column(column).is_some_and(|column| said(column).varies()) {
            continue;
        }
        for key in keys {
            let correlation = numbers(table, key).and_then(|x| spearman(x, y));
            let (column, key) = ((*column).to_owned(), key.clone());
            all.extend(correlation.map(|correlation| Follows { column, key, correlation }));
        }
    }
    all.sort_by(|a, b| b.correlation.rho.abs().total_cmp(&a.correlation.rho.abs()));
    all
}

fn checked(table: &Table) -> Checked {
    let [runs, horizons, errors] =
        ["run", "horizon_s", "estimated_e"].map(|name| numbers(table, name).unwrap_or_default());
    let words = match table.column("events_right").map(said) {
        Some(Said::Words(words)) => words,
        _ => Vec::new(),
    };
    let of = |is: fn(&str) -> bool| {
        words.iter().filter(|(word, _)| is(word)).map(|(_, n)| n).sum::<u64>()
    };
    let known = errors.iter().zip(runs).filter(|(e, _)| e.is_finite());
    let worst = known.max_by(|(a, _), (b, _)| a.total_cmp(b));
    Checked {
        n: horizons.iter().filter(|t| t.is_finite()).count() as u64,
        judged: of(|word| !word.is_empty()),
        right: of(|word| word == YES),
        worst: worst.map(|(e, run)| (*e, *run as u64)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(columns: &[(&str, Column)]) -> Table {
        let columns = columns.iter().map(|(name, own)| ((*name).to_owned(), own.clone()));
        Table { columns: columns.collect(), failed: 0, reasons: Vec::new() }
    }

    fn words(words: &[&str], of_row: &[u32]) -> Column {
        let words = words.iter().map(|word| (*word).to_owned()).collect();
        Column::Words { words, of_row: of_row.to_vec() }
    }

    #[test]
    fn numbers_are_told_by_their_quantiles_and_words_by_their_counts() {
        let told = said(&Column::Numbers((0..=20).rev().map(f64::from).collect()));
        assert_eq!(told, Said::Numbers(21, Some([0.0, 1.0, 10.0, 19.0, 20.0])));
        assert!(told.varies() && !said(&Column::Numbers(vec![2.0; 3])).varies());
        let empty = Column::Numbers(vec![f64::NAN]);
        assert_eq!(said(&empty), Said::Numbers(0, None));
        assert_eq!(words_of(&empty), Said::Words(vec![(String::new(), 1)]));
        assert_eq!(words_of(&Column::Numbers(Vec::new())), Said::Words(Vec::new()));
        let told = said(&words(&["a", "", "b"], &[0, 2, 2, 1, 2]));
        let counts = [("b", 3), ("a", 1), ("", 1)].map(|(word, n)| (word.to_owned(), n));
        assert_eq!(told, Said::Words(counts.to_vec()));
    }

    #[test]
    fn the_key_that_a_column_follows_most_is_first_and_words_have_no_rank() {
        let numbers = |x: &[f64]| Column::Numbers(x.to_vec());
        let table = table(&[
            ("a", numbers(&[1.0, 2.0, 3.0, 4.0])),
            ("law", words(&["x", "y"], &[0, 1, 0, 1])),
            ("same", numbers(&[1.0; 4])),
            ("b", numbers(&[4.0, 3.0, 1.0, 2.0])),
            ("y", numbers(&[9.0, 8.0, 6.0, 7.0])),
        ]);
        let keys = ["a", "law", "same", "b"].map(str::to_owned);
        let found = follows(&table, &keys, &["y"]);
        let names: Vec<&str> = found.iter().map(|own| own.key.as_str()).collect();
        assert_eq!(names, ["b", "a"]);
        assert_eq!(found[0].correlation.rho, 1.0);
        // Ranks of y: 4, 3, 1, 2; Σd² = 9 + 1 + 4 + 4 = 18; 1 − 6·18/60 = −0.8.
        assert!((found[1].correlation.rho + 0.8).abs() < 1e-15);
    }

    #[test]
    fn checked_runs_are_counted_and_the_worst_is_named() {
        let nan = f64::NAN;
        let table = table(&[
            ("run", Column::Numbers(vec![0.0, 3.0, 7.0, 9.0])),
            ("horizon_s", Column::Numbers(vec![1.0, nan, 0.4, 1.0])),
            ("estimated_e", Column::Numbers(vec![1e-7, nan, 1e-3, nan])),
            ("events_right", words(&["yes", "", "no"], &[0, 1, 2, 1])),
        ]);
        let expected = Checked { n: 3, judged: 2, right: 1, worst: Some((1e-3, 7)) };
        assert_eq!(checked(&table), expected);
    }
}

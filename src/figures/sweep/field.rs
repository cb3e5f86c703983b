//! A column of a sweep with what a figure has to know of it: label, scale, role in the plan, levels, classes.

use deltazero_plots::{Axis, Scale};
use deltazero_study::digits::{in_short, rounded_to};

use crate::sweep::draw::Law;
use crate::sweep::plan::Values;
use crate::sweep::results::{Column, Results, ResultsError};

/// Positive values that span more than so many decades are drawn on a logarithmic axis.
const DECADES: f64 = 2.0;
/// Most classes that a figure tells apart.
pub(super) const MOST_CLASSES: usize = 8;

/// The column of words whose empty word says something.
const WARNINGS: &str = "warnings";

/// Largest number that may be a code or a count to tell apart.
const LARGEST_CODE: f64 = 1000.0;

/// What a column is in its plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// An axis of the grid.
    Axis,
    /// A key that is drawn, or what a run tells.
    Value,
}

/// A column that is drawn.
pub(super) struct Field<'a> {
    pub(super) name: String,
    pub(super) label: String,
    pub(super) role: Role,
    pub(super) column: &'a Column,
    scale: Scale,
}

impl<'a> Field<'a> {
    pub(super) fn new(results: &Results, name: &str, column: &'a Column) -> Self {
        let own = |key: &&String| *key == name;
        let keys = results.key_columns();
        let axis =
            results.plan.axes.iter().zip(keys).find(|(_, key)| own(key)).map(|(axis, _)| axis);
        let drawn = results.plan.random.iter().flat_map(|random| &random.keys);
        let drawn = drawn.zip(keys.iter().skip(results.plan.axes.len()));
        let law = drawn.filter(|(_, key)| own(key)).map(|(draw, _)| draw.law).next();
        let of_plan = match (axis.map(|axis| &axis.values), law) {
            (Some(Values::Log { .. }), _) | (_, Some(Law::LogUniform(_))) => Some(Scale::Log),
            (Some(Values::Linear { .. }), _) | (_, Some(_)) => Some(Scale::Linear),
            _ => None,
        };
        let scale = of_plan.unwrap_or_else(|| scale_of(column));
        let role = if axis.is_some() { Role::Axis } else { Role::Value };
        Self { name: name.to_owned(), label: results.label(name), role, column, scale }
    }

    /// Its axis: with numbers, or with the words as places.
    pub(super) fn axis(&self) -> Axis {
        match self.column {
            Column::Words { .. } => Axis::named(&self.label, self.levels().names),
            Column::Numbers(_) => {
                Axis { label: self.label.clone(), scale: self.scale, ..Axis::default() }
            }
        }
    }

    /// Whether its axis has a place for a value.
    pub(super) fn shows(&self, value: f64) -> bool {
        self.scale.shows(value)
    }

    pub(super) fn is_log(&self) -> bool {
        self.scale == Scale::Log
    }

    pub(super) fn has_words(&self) -> bool {
        matches!(self.column, Column::Words { .. })
    }

    /// Where each row stands on its axis; not a number for one without a value.
    pub(super) fn places(&self) -> Vec<f64> {
        match self.column {
            Column::Numbers(numbers) => numbers.clone(),
            Column::Words { .. } => {
                let of_row = self.levels().of_row.into_iter();
                of_row.map(|word| word.map_or(f64::NAN, |word| word as f64)).collect()
            }
        }
    }

    /// Its numbers.
    pub(super) fn numbers(&self) -> Result<&'a [f64], ResultsError> {
        match self.column {
            Column::Numbers(numbers) => Ok(numbers),
            Column::Words { .. } => Err(ResultsError::NotNumbers { column: self.name.clone() }),
        }
    }

    /// Its different values in order.
    pub(super) fn levels(&self) -> Levels {
        match self.column {
            Column::Words { words, of_row } => self.word_levels(words, of_row),
            Column::Numbers(numbers) => {
                let mut places: Vec<f64> =
                    numbers.iter().copied().filter(|x| !x.is_nan()).collect();
                places.sort_unstable_by(f64::total_cmp);
                places.dedup();
                let of = |x: &f64| places.binary_search_by(|own| own.total_cmp(x)).ok();
                let of_row = numbers.iter().map(of).collect();
                Levels { names: told_apart(&places), places, of_row }
            }
        }
    }

    /// Its words in the order of the rows. An empty one is no value, but that of warnings says that there is none.
    fn word_levels(&self, words: &[String], of_row: &[u32]) -> Levels {
        let empty = if self.name == WARNINGS { Some("none") } else { None };
        let mut names = Vec::new();
        let mut level = |word: &String| {
            let name = if word.is_empty() { empty? } else { word };
            names.push(name.to_owned());
            Some(names.len() - 1)
        };
        let of_word: Vec<Option<usize>> = words.iter().map(&mut level).collect();
        Levels {
            places: (0..names.len()).map(|place| place as f64).collect(),
            of_row: of_row.iter().map(|word| of_word[*word as usize]).collect(),
            names,
        }
    }

    /// Whether it holds words, or few whole numbers: codes and counts.
    pub(super) fn is_discrete(&self) -> bool {
        let Column::Numbers(numbers) = self.column else { return true };
        let mut seen: Vec<f64> = Vec::new();
        for x in numbers.iter().filter(|x| !x.is_nan()) {
            if x.fract() != 0.0 || x.abs() > LARGEST_CODE {
                return false;
            }
            if !seen.contains(x) {
                seen.push(*x);
            }
            if seen.len() > MOST_CLASSES {
                return false;
            }
        }
        true
    }

    /// What it tells apart, if that is few: words, codes, or the values of an axis. Words beyond the first are together.
    pub(super) fn classes(&self) -> Option<Levels> {
        if !self.is_discrete() && self.role != Role::Axis {
            return None;
        }
        let mut levels = self.levels();
        if levels.names.len() <= MOST_CLASSES {
            return Some(levels);
        }
        if !self.has_words() {
            return None;
        }
        levels.names.truncate(MOST_CLASSES - 1);
        levels.places.truncate(MOST_CLASSES - 1);
        levels.names.push("others".to_owned());
        levels.places.push((MOST_CLASSES - 1) as f64);
        levels
            .of_row
            .iter_mut()
            .flatten()
            .for_each(|class| *class = (*class).min(MOST_CLASSES - 1));
        Some(levels)
    }
}

/// The different values of a column.
pub(super) struct Levels {
    /// As a label has them.
    pub(super) names: Vec<String>,
    /// Where they stand on an axis.
    pub(super) places: Vec<f64>,
    /// Which of them each row has.
    pub(super) of_row: Vec<Option<usize>>,
}

impl Levels {
    /// The one level of all `n` rows.
    pub(super) fn one(n: usize) -> Self {
        Self { names: vec![String::new()], places: vec![0.0], of_row: vec![Some(0); n] }
    }
}

/// A value to four digits.
pub(super) fn short(x: f64) -> String {
    in_short(rounded_to(x, 4))
}

/// Different numbers in order, to four digits or as many as tell them apart.
fn told_apart(numbers: &[f64]) -> Vec<String> {
    let differ = |digits: &usize| {
        let mut pairs = numbers.windows(2);
        pairs.all(|pair| rounded_to(pair[0], *digits) != rounded_to(pair[1], *digits))
    };
    let digits = (4..17).find(differ).unwrap_or(17);
    numbers.iter().map(|x| in_short(rounded_to(*x, digits))).collect()
}

fn scale_of(column: &Column) -> Scale {
    let Column::Numbers(numbers) = column else { return Scale::Linear };
    let finite = numbers.iter().copied().filter(|x| x.is_finite());
    let (least, most) =
        finite.fold((f64::INFINITY, 0.0_f64), |(least, most), x| (least.min(x), most.max(x)));
    let spans = least > 0.0 && most / least > libm::exp10(DECADES);
    if spans && most > 0.0 { Scale::Log } else { Scale::Linear }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_the_digits_that_tell_them_apart() {
        assert_eq!(told_apart(&[1.0, 2.00001]), ["1", "2"]);
        assert_eq!(told_apart(&[-1.0, 1.00001, 1.00002]), ["-1", "1.00001", "1.00002"]);
        let next = 1.0 + f64::EPSILON;
        assert_eq!(told_apart(&[1.0, next]), ["1".to_owned(), next.to_string()]);
    }
}

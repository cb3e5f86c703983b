//! The figures that show a column best, by what the plan varies.

use super::Asked;
use super::field::MOST_CLASSES;
use crate::sweep::plan::{Axis, Values};
use crate::sweep::results::Results;

/// An axis of the grid with the column of its key.
type Column<'a> = (&'a str, &'a Axis);

/// The figures of the column `y`, which has words or not; `strongest` is the key of the strongest rank correlation with it.
///
/// | the plan varies | figures |
/// |---|---|
/// | axes | lines over the axis of numbers with most values, one a word of the axis of words with most; without numbers over that |
/// | two axes of numbers or more | a heat map over the two with most values, too |
/// | draws alone | distribution, and a scatter over `strongest` |
///
/// Of words there is a distribution in the place of lines and scatter, in classes by the axis.
pub fn chosen<'a>(
    results: &'a Results,
    y: &'a str,
    has_words: bool,
    strongest: Option<&'a str>,
) -> Vec<Asked<'a>> {
    let [numbers, words] = axes(results);
    let mut asked = Vec::new();
    let distribution = |color| Asked { x: y, y: None, color };
    match numbers.first().or(words.first()) {
        None => {
            asked.push(distribution(None));
            let scatter = |x| Asked { x, y: Some(y), color: None };
            asked.extend(strongest.filter(|_| !has_words).map(scatter));
        }
        Some((x, axis)) if has_words => {
            let is_few = axis.values.len() <= MOST_CLASSES as u64 || numbers.is_empty();
            asked.push(distribution(is_few.then_some(*x)));
        }
        Some((x, _)) => {
            let color = words.iter().map(|(word, _)| *word).find(|word| word != x);
            asked.push(Asked { x, y: Some(y), color });
        }
    }
    if let [(x, _), (up, _), ..] = numbers[..] {
        asked.push(Asked { x, y: Some(up), color: Some(y) });
    }
    asked
}

/// The axes that vary, those of numbers and those of words, each with the most values first.
fn axes(results: &Results) -> [Vec<Column<'_>>; 2] {
    let axes = results.key_columns().iter().map(String::as_str).zip(&results.plan.axes);
    let mut varied: Vec<_> = axes.filter(|(_, axis)| axis.values.len() > 1).collect();
    varied.sort_by_key(|(_, axis)| std::cmp::Reverse(axis.values.len()));
    let (numbers, words) = varied.into_iter().partition(|(_, axis)| has_numbers(&axis.values));
    [numbers, words]
}

fn has_numbers(values: &Values) -> bool {
    match values {
        Values::List(all) => all.iter().all(serde_json::Value::is_number),
        Values::Linear { .. } | Values::Log { .. } => true,
    }
}

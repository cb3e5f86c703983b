//! The Sobol indices of a column of a finished sweep, at each point of its grid.

use serde::Serialize;

use super::draw::Sampling;
use super::plan::{Plan, Random};
use super::results::{Results, ResultsError};
use super::runner::OK;
use super::saltelli;
use super::sensitivity::{Index, LEAST_SAMPLES, indices};

/// The indices of a column.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sobol {
    /// The column.
    pub column: String,
    /// The points of the grid that have indices.
    pub points: Vec<Point>,
    /// Those that have none.
    pub without: Vec<Without>,
    /// Runs that did not come to their end.
    pub failed: u64,
}

/// The indices at a point of the grid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Each axis with its value there; empty where the plan has none.
    pub at: Vec<(String, serde_json::Value)>,
    /// Samples that they are from.
    pub samples: u64,
    /// Samples that are left out, because one of their runs lacks the value.
    pub left_out: u64,
    /// What each key explains.
    pub keys: Vec<OfKey>,
}

/// A point of the grid without indices: of fewer samples than [`LEAST_SAMPLES`], or of a column that does not vary there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Without {
    /// Each axis with its value there.
    pub at: Vec<(String, serde_json::Value)>,
    /// Samples that have the value in all their runs.
    pub samples: u64,
    /// Samples that lack it in one.
    pub left_out: u64,
}

/// The indices of a key.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OfKey {
    /// The key.
    pub key: String,
    /// Main, or first-order, index.
    pub main: Index,
    /// Total index.
    pub total: Index,
}

impl Sobol {
    /// The indices of `column`.
    ///
    /// # Errors
    /// A sweep without the design for them, a column that is not there or not of numbers, or one that has no indices at any point.
    pub fn of(results: &Results, column: &str) -> Result<Self, ResultsError> {
        let all = Self::of_each(results, &[column])?;
        let failed = all.first().map_or(0, |own| own.failed);
        let has_points = |own: &Self| !own.points.is_empty();
        let column = column.to_owned();
        let none = ResultsError::NoIndices { column, least: LEAST_SAMPLES, failed };
        all.into_iter().find(has_points).ok_or(none)
    }

    /// The indices of each of `columns`, read together; those of one may be at no point.
    ///
    /// # Errors
    /// A sweep without the design for them, or a column that is not there or not of numbers.
    pub fn of_each(results: &Results, columns: &[&str]) -> Result<Vec<Self>, ResultsError> {
        let random = design(&results.plan).ok_or(ResultsError::NoDesign)?;
        let empty = |column: &&str| Self {
            column: (*column).to_owned(),
            points: Vec::new(),
            without: Vec::new(),
            failed: 0,
        };
        let mut all: Vec<Self> = columns.iter().map(empty).collect();
        let (mut values, n) = (vec![Vec::new(); columns.len()], random.n_runs() as usize);
        let mut run = 0;
        results.rows(columns, |status, row| {
            for ((sobol, values), text) in all.iter_mut().zip(&mut values).zip(row) {
                sobol.failed += u64::from(status != OK);
                values.push(number(&sobol.column, text)?.filter(|_| status == OK));
                if values.len() == n {
                    match self::point(results, random, run / n as u64, values) {
                        Ok(point) => sobol.points.push(point),
                        Err(without) => sobol.without.push(without),
                    }
                    values.clear();
                }
            }
            run += 1;
            Ok(())
        })?;
        Ok(all)
    }
}

/// The draws of a plan that is designed for Sobol indices.
pub fn design(plan: &Plan) -> Option<&Random> {
    plan.random.as_ref().filter(|random| random.sampling == Sampling::Saltelli)
}

/// The number of a field, if it has one.
fn number(column: &str, text: &str) -> Result<Option<f64>, ResultsError> {
    if text.is_empty() {
        return Ok(None);
    }
    let number: Option<f64> = text.parse().ok();
    number.map(Some).ok_or_else(|| ResultsError::NotNumbers { column: column.to_owned() })
}

/// The indices at the grid point number `point`, if there are any.
fn point(
    results: &Results,
    random: &Random,
    point: u64,
    values: &[Option<f64>],
) -> Result<Point, Without> {
    let n_keys = random.keys.len();
    let of_sample = values.chunks(saltelli::runs(n_keys) as usize);
    let whole = of_sample.filter_map(|sample| sample.iter().copied().collect::<Option<Vec<f64>>>());
    let whole: Vec<f64> = whole.flatten().collect();
    let samples = whole.len() as u64 / saltelli::runs(n_keys);
    let left_out = random.samples - samples;
    let mut places = Vec::new();
    results.plan.indices(point * random.n_runs(), &mut places);
    let axes = results.plan.axes.iter().zip(places);
    let at = axes.map(|(axis, i)| (axis.key.clone(), axis.values.at(i))).collect();
    let Some(indices) = indices(&whole, n_keys) else {
        return Err(Without { at, samples, left_out });
    };
    let of_key = |(draw, own): (&super::plan::Draw, super::sensitivity::Indices)| OfKey {
        key: draw.key.clone(),
        main: own.main,
        total: own.total,
    };
    let keys = random.keys.iter().zip(indices).map(of_key).collect();
    Ok(Point { at, samples, left_out, keys })
}

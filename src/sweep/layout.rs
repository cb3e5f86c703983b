//! Which columns the runs of a plan have, and where each run has its own.
//!
//! A key may change what a run tells of: several bays have more joints, an ideal joint has no contact. So the columns
//! are looked up before the first run, for each combination of such values; a number that is not zero changes nothing.

use std::collections::HashMap;

use serde_json::Value;

use super::SweepError;
use super::columns::{Head, Shape, heads_of_estimate};
use super::plan::{Axis, Plan, Values};
use crate::config::{ConfigError, Variants, Varied, is_of_runs};
use crate::keys::Kind;

/// Combinations for which columns are looked up.
const MOST_SHAPES: u64 = 4096;

/// The columns of a plan.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// The heads of all, without those before the status.
    pub(super) heads: Vec<Head>,
    /// Of each axis, how its values fall into classes.
    classes: Vec<Class>,
    /// Of each combination of classes. Without an entry: no run of it can be made.
    cells: HashMap<u64, Places>,
}

/// Where the cells of a run go.
#[derive(Clone, Debug)]
struct Places {
    /// How many it has.
    n: usize,
    /// Which of them each column has.
    of_column: Vec<Option<usize>>,
}

/// How the values of an axis fall into classes of runs with the same columns.
#[derive(Clone, Debug)]
enum Class {
    /// All are one.
    One,
    /// Zero is one, all others another.
    Zero,
    /// Each is its own.
    Each,
}

impl Class {
    fn of(varied: &Varied) -> Self {
        match (varied.key, varied.kind) {
            (None, _) if varied.is_of_shape => Self::Each,
            // Settings of runs change no column.
            (Some(key), _) if is_of_runs(key) => Self::One,
            (_, Kind::Number(_)) => Self::Zero,
            _ => Self::Each,
        }
    }

    /// The class of the value number `i` of `axis`.
    fn at(&self, axis: &Axis, i: u64) -> u64 {
        match self {
            Self::One => 0,
            Self::Zero => u64::from(axis.values.at(i).as_f64() == Some(0.0)),
            Self::Each => i,
        }
    }

    /// One value of each class, by its number; not many more than are looked up.
    fn examples(&self, axis: &Axis) -> Vec<u64> {
        let n = axis.values.len();
        match self {
            Self::One => vec![0],
            Self::Each => (0..n.min(MOST_SHAPES + 1)).collect(),
            Self::Zero => {
                // Of two that follow each other at equal distances one is not zero, or none is.
                let some = if matches!(axis.values, Values::List(_)) { n } else { n.min(2) };
                let first = |class| (0..some).find(|i| self.at(axis, *i) == class);
                let zero = match axis.values {
                    Values::List(_) => first(1),
                    Values::Log { .. } => None,
                    Values::Linear { ends: [a, b], .. } => {
                        let nearest = libm::round(-a / (b - a) * (n - 1) as f64) as u64;
                        Some(nearest.min(n - 1)).filter(|i| self.at(axis, *i) == 1)
                    }
                };
                first(0).into_iter().chain(zero).collect()
            }
        }
    }

    fn n(&self, axis: &Axis) -> u64 {
        match self {
            Self::One => 1,
            Self::Zero => 2,
            Self::Each => axis.values.len(),
        }
    }
}

impl Layout {
    /// The columns of the runs of `plan`, in the file of this name.
    ///
    /// # Errors
    /// Too many combinations, or none of which a run can be made: why not the first.
    pub(super) fn new(
        file: &str,
        plan: &Plan,
        variants: &mut Variants,
    ) -> Result<Self, SweepError> {
        let axes = variants.varied().iter().take(plan.axes.len());
        let classes: Vec<Class> = axes.map(Class::of).collect();
        let all = classes.iter().zip(&plan.axes);
        let examples: Vec<_> = all.map(|(class, axis)| class.examples(axis)).collect();
        let n = examples.iter().try_fold(1_u64, |n, own| n.checked_mul(own.len() as u64));
        if n.is_none_or(|n| n > MOST_SHAPES) {
            return Err(SweepError::TooManyShapes { file: file.to_owned(), most: MOST_SHAPES });
        }
        let mut layout = Self { heads: Vec::new(), classes, cells: HashMap::new() };
        let (mut shapes, mut refusal) = (Vec::new(), None);
        for indices in product(&examples) {
            match heads(plan, &indices, variants) {
                Ok(heads) => shapes.push((layout.class_of(plan, &indices), heads)),
                Err(error) => drop(refusal.get_or_insert(error)),
            }
        }
        if let (true, Some(error)) = (shapes.is_empty(), refusal) {
            return Err(error.into());
        }
        for (_, heads) in &shapes {
            merge(&mut layout.heads, heads);
        }
        for (class, heads) in shapes {
            let place = |column: &Head| heads.iter().position(|head| head.name == column.name);
            let of_column = layout.heads.iter().map(place).collect();
            layout.cells.insert(class, Places { n: heads.len(), of_column });
        }
        Ok(layout)
    }

    /// Which cell of a run that stands at `indices` on the axes each column has.
    pub(super) fn cells(&self, plan: &Plan, indices: &[u64]) -> Option<&[Option<usize>]> {
        self.cells.get(&self.class_of(plan, indices)).map(|places| &places.of_column[..])
    }

    /// How many cells such a run has.
    pub(super) fn n_cells(&self, plan: &Plan, indices: &[u64]) -> Option<usize> {
        self.cells.get(&self.class_of(plan, indices)).map(|places| places.n)
    }

    fn class_of(&self, plan: &Plan, indices: &[u64]) -> u64 {
        let all = self.classes.iter().zip(&plan.axes).zip(indices);
        all.fold(0, |class, ((own, axis), i)| class * own.n(axis) + own.at(axis, *i))
    }
}

/// Every choice of one number from each list.
fn product(lists: &[Vec<u64>]) -> Vec<Vec<u64>> {
    lists.iter().fold(vec![Vec::new()], |all, list| {
        let longer = |start: &Vec<u64>| {
            let start = start.clone();
            list.iter().map(move |i| [&start[..], &[*i]].concat())
        };
        all.iter().flat_map(longer).collect()
    })
}

/// The heads of what a run at `indices` tells of, each draw in its middle.
fn heads(plan: &Plan, indices: &[u64], variants: &mut Variants) -> Result<Vec<Head>, ConfigError> {
    let axes = plan.axes.iter().zip(indices).map(|(axis, i)| axis.values.at(*i));
    let drawn = plan.random.iter().flat_map(|random| &random.keys);
    let drawn = drawn.map(|draw| Value::from(draw.law.at(0.5)));
    let values: Vec<Value> = axes.chain(drawn).collect();
    let config = variants.set(&values)?;
    let mut heads = Shape::of(&config.mechanism.subject(config), plan.audit).heads();
    if plan.check > 0.0 {
        heads.extend(heads_of_estimate());
    }
    Ok(heads)
}

/// Adds those of `own` that are not in `all`, each behind what stands before it in `own`.
fn merge(all: &mut Vec<Head>, own: &[Head]) {
    let mut end = 0;
    for head in own {
        match all.iter().position(|known| known.name == head.name) {
            Some(at) => end = at + 1,
            None => {
                all.insert(end, head.clone());
                end += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_several_shapes_come_in_the_order_of_each() {
        let mut all = Vec::new();
        let head = |name: &&str| Head::text(*name);
        let own = |names: &[&str]| names.iter().map(head).collect::<Vec<_>>();
        merge(&mut all, &own(&["t", "x", "n"]));
        merge(&mut all, &own(&["t", "x", "z", "n", "w"]));
        merge(&mut all, &own(&["t", "n"]));
        let names: Vec<&str> = all.iter().map(|head| &head.name[..]).collect();
        assert_eq!(names, ["t", "x", "z", "n", "w"]);
    }

    #[test]
    fn a_product_has_the_last_list_fastest() {
        assert_eq!(product(&[vec![0, 1], vec![5, 7]]), [[0, 5], [0, 7], [1, 5], [1, 7]]);
        assert_eq!(product(&[]), [[0; 0]]);
    }
}

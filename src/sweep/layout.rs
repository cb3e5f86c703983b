//! Which columns the runs of a plan have, and where each run has its own.
//!
//! A key may change what a run tells of: several bays have more joints, an ideal joint has no contact. So the columns
//! are looked up before the first run, for each combination of such values; a number that is not zero changes nothing.
//! Values may not go together, so several examples of a combination are tried until one is a configuration.

use std::collections::HashMap;

use serde_json::Value;

use super::SweepError;
use super::columns::{Head, heads_of_run};
use super::plan::{Axis, Plan, Values};
use crate::config::{ConfigError, Variants, Varied, is_of_runs};
use crate::keys::Kind;

/// Combinations for which columns are looked up.
const MOST_SHAPES: u64 = 4096;
/// Fewest and most examples of a combination that are tried.
const TRIES: [u64; 2] = [8, 128];
/// Examples of a class of an axis that has more values than these.
const PARTS: u64 = 8;
/// Which of them: both ends, the middle, and between.
const PLACES: [u64; 9] = [0, 8, 4, 2, 6, 1, 3, 5, 7];
/// Where every draw stands in its distribution: the middle first.
const DRAWS: [f64; 3] = [0.5, 0.01, 0.99];

/// The columns of a plan.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// The heads of all, without those before the status.
    pub(super) heads: Vec<Head>,
    /// Of each axis, how its values fall into classes.
    classes: Vec<Class>,
    /// Of each combination of classes. Without an entry: no example of it is a configuration.
    cells: HashMap<u64, Places>,
}

/// Where the cells of a run go.
#[derive(Clone, Debug)]
pub(super) struct Places {
    /// How many it has.
    pub(super) n: usize,
    /// Which of them each column has.
    pub(super) of_column: Vec<Option<usize>>,
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

    /// Some values of each class, by their numbers; of not many more classes than are looked up.
    fn examples(&self, axis: &Axis) -> Vec<Vec<u64>> {
        let n = axis.values.len();
        match self {
            Self::One => vec![spread(n)],
            Self::Each => (0..n.min(MOST_SHAPES + 1)).map(|i| vec![i]).collect(),
            Self::Zero => {
                let of = |class| move |i: &u64| self.at(axis, *i) == class;
                let (others, zero) = match axis.values {
                    Values::List(_) => {
                        let others: Vec<u64> = (0..n).filter(of(0)).collect();
                        let some = spread(others.len() as u64).into_iter();
                        (some.map(|i| others[i as usize]).collect(), (0..n).find(of(1)))
                    }
                    // Of several at equal distances one at most is zero, or all are.
                    Values::Linear { ends: [a, b], .. } => {
                        let nearest = libm::round(-a / (b - a) * (n - 1) as f64) as u64;
                        let others = spread(n).into_iter().filter(of(0)).collect();
                        (others, Some(nearest.min(n - 1)).filter(of(1)))
                    }
                    Values::Log { .. } => (spread(n), None),
                };
                let all: [Vec<u64>; 2] = [others, zero.into_iter().collect()];
                all.into_iter().filter(|some| !some.is_empty()).collect()
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
        let tries = n.map_or(1, |n| MOST_SHAPES / n.max(1)).clamp(TRIES[0], TRIES[1]);
        let mut layout = Self { heads: Vec::new(), classes, cells: HashMap::new() };
        let (mut shapes, mut refusal) = (Vec::new(), None);
        for own in product(&examples) {
            match heads(plan, &own, tries, variants) {
                Ok(heads) => shapes.push((layout.class_of(plan, &firsts(&own)), heads)),
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
            layout.cells.insert(class, layout.places_of(&heads));
        }
        Ok(layout)
    }

    /// Where the cells of a run go that stands at `indices` on the axes.
    pub(super) fn places(&self, plan: &Plan, indices: &[u64]) -> Option<&Places> {
        self.cells.get(&self.class_of(plan, indices))
    }

    /// Where the cells of a run go that has these heads.
    fn places_of(&self, heads: &[Head]) -> Places {
        let place = |column: &Head| heads.iter().position(|head| head.name == column.name);
        Places { n: heads.len(), of_column: self.heads.iter().map(place).collect() }
    }

    /// The same for a run of a combination that was not looked up; none where the plan lacks one of its columns.
    pub(super) fn places_of_run(&self, heads: &[Head]) -> Option<Places> {
        heads.iter().all(|head| self.heads.contains(head)).then(|| self.places_of(heads))
    }

    /// As if no example of any combination had been a configuration.
    #[cfg(test)]
    pub(super) fn forget_combinations(&mut self) {
        self.cells.clear();
    }

    fn class_of(&self, plan: &Plan, indices: &[u64]) -> u64 {
        let all = self.classes.iter().zip(&plan.axes).zip(indices);
        all.fold(0, |class, ((own, axis), i)| class * own.n(axis) + own.at(axis, *i))
    }
}

/// At most nine of `n` numbers from zero: all of a few, else both ends, the middle and some between.
fn spread(n: u64) -> Vec<u64> {
    if n <= PARTS + 1 { (0..n).collect() } else { PLACES.map(|k| k * (n - 1) / PARTS).to_vec() }
}

/// Every choice of one entry from each list.
fn product<T>(lists: &[Vec<T>]) -> Vec<Vec<&T>> {
    lists.iter().fold(vec![Vec::new()], |all, list| {
        let longer = |start: Vec<_>| {
            list.iter().map(move |entry| start.iter().copied().chain([entry]).collect())
        };
        all.into_iter().flat_map(longer).collect()
    })
}

/// The first example on each axis.
fn firsts(examples: &[&Vec<u64>]) -> Vec<u64> {
    examples.iter().filter_map(|own| own.first().copied()).collect()
}

/// The heads of what runs of these examples on each axis tell of: of the first that is a configuration. Of more choices
/// than `tries` some from all over are tried; the first is that of all first examples with each draw in its middle.
fn heads(
    plan: &Plan,
    examples: &[&Vec<u64>],
    tries: u64,
    variants: &mut Variants,
) -> Result<Vec<Head>, ConfigError> {
    let draws = if plan.random.is_some() { &DRAWS[..] } else { &DRAWS[..1] };
    let lengths = examples.iter().map(|own| own.len() as u64);
    let all = lengths.fold(draws.len() as u64, u64::saturating_mul);
    let choice = |k: u64| {
        // Multiples of the golden ratio are spread evenly over the circle.
        let part = (k as f64 / 1.618_033_988_749_895).fract();
        if all <= tries { k } else { (part * all as f64) as u64 }
    };
    let mut at = |mut rest: u64| {
        let draw = draws[(rest % draws.len() as u64) as usize];
        rest /= draws.len() as u64;
        let mut indices = firsts(examples);
        for (index, own) in indices.iter_mut().zip(examples).rev() {
            *index = own[(rest % own.len() as u64) as usize];
            rest /= own.len() as u64;
        }
        heads_at(plan, &indices, draw, variants)
    };
    let first = at(0);
    (1..all.min(tries)).fold(first, |told, k| told.or_else(|first| at(choice(k)).or(Err(first))))
}

/// The heads of what a run at `indices` tells of, each draw at this part of its distribution.
fn heads_at(
    plan: &Plan,
    indices: &[u64],
    part: f64,
    variants: &mut Variants,
) -> Result<Vec<Head>, ConfigError> {
    let axes = plan.axes.iter().zip(indices).map(|(axis, i)| axis.values.at(*i));
    let drawn = plan.random.iter().flat_map(|random| &random.keys);
    let drawn = drawn.map(|draw| Value::from(draw.law.at(part)));
    let values: Vec<Value> = axes.chain(drawn).collect();
    let config = variants.set(&values)?;
    Ok(heads_of_run(config.mechanism.subject(config).parts.iter(), plan))
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
        let lists = [vec![0, 1], vec![5, 7]];
        assert_eq!(product(&lists), [[&0, &5], [&0, &7], [&1, &5], [&1, &7]]);
        assert_eq!(product::<u64>(&[]), [[&0; 0]]);
    }

    #[test]
    fn a_long_axis_is_tried_at_both_ends_its_middle_and_between() {
        assert_eq!(spread(3), [0, 1, 2]);
        assert_eq!(spread(1001), [0, 1000, 500, 250, 750, 125, 375, 625, 875]);
    }
}

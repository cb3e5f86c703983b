//! Parts of one type together.

use crate::part::{Part, Runs};
use crate::run::Brake;

/// Sorts `parts` by their types, calls `work` once for each type, and returns what it makes of each part in the order of
/// `parts`. `work` is given the first part of the type, all parts of it with that one among them, and their brakes.
///
/// # Panics
/// Where there are fewer brakes than parts.
pub(crate) fn by_kind<T, B: Brake>(
    parts: &[&Part],
    brakes: &mut [B],
    mut work: impl FnMut(&dyn Runs, &[&dyn Runs], &mut [&mut dyn Brake]) -> Vec<T>,
) -> Vec<T> {
    assert!(brakes.len() >= parts.len(), "a part needs a brake");
    let mut left: Vec<(usize, &dyn Runs, &mut dyn Brake)> = Vec::with_capacity(parts.len());
    for (i, (part, brake)) in parts.iter().zip(brakes).enumerate() {
        left.push((i, &*part.runs, brake));
    }
    let mut made = Vec::with_capacity(parts.len());
    while let Some(first) = left.first().map(|(_, runs, _)| *runs) {
        let is_alike = |(_, runs, _): &(usize, &dyn Runs, _)| runs.kind() == first.kind();
        let (same, others): (Vec<_>, Vec<_>) = left.into_iter().partition(is_alike);
        left = others;
        let places: Vec<usize> = same.iter().map(|(i, _, _)| *i).collect();
        let (all, mut brakes): (Vec<_>, Vec<_>) =
            same.into_iter().map(|(_, runs, brake)| (runs, brake)).unzip();
        made.extend(places.into_iter().zip(work(first, &all, &mut brakes)));
    }
    made.sort_by_key(|(i, _)| *i);
    made.into_iter().map(|(_, made)| made).collect()
}

/// Those of `all` that are of this type.
pub(crate) fn of_type<'a, P: 'static>(all: &[&'a dyn Runs]) -> Vec<&'a P> {
    all.iter().filter_map(|runs| runs.as_any().downcast_ref()).collect()
}

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

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use deltazero_solvers::problems::BouncingBall;
    use deltazero_solvers::{Grid, Method};

    use super::*;
    use crate::part::Subject;
    use crate::problems::balls::HEAVY_BALL;
    use crate::run::{Accuracy, Events, Limits, Price, Setting};

    /// Two balls of a kind, with one of another between them.
    fn subject() -> Subject {
        let ball = |gravity| Part::new(BouncingBall { restitution: 0.5, gravity, height: 1.0 });
        Subject { parts: vec![ball(9.8), Part::new(HEAVY_BALL), ball(1.6)] }
    }

    #[test]
    fn parts_of_a_kind_come_together_and_what_is_made_of_them_in_their_places() {
        let (subject, stop) = (subject(), AtomicBool::new(false));
        let parts: Vec<&Part> = subject.parts.iter().collect();
        let mut watches = [Limits::none(&stop).watch(Price::PLAIN); 3];
        let mut calls = 0;
        let made = by_kind(&parts, &mut watches, |_, all, brakes| {
            assert_eq!(all.len(), brakes.len());
            calls += 1;
            (0..all.len()).map(|i| (calls, i)).collect()
        });
        assert_eq!(made, [(1, 0), (2, 0), (1, 1)]);
    }

    #[test]
    fn a_time_says_how_many_parts_were_at_once() {
        let (subject, stop) = (subject(), AtomicBool::new(false));
        let timing = |name: &str, accuracy| {
            let method = Method::named(name).unwrap();
            let setting = Setting { method, events: Events::Located, accuracy };
            subject.took(&setting, 0.1, &Grid::Times(vec![0.1]), Limits::none(&stop)).unwrap()
        };
        for (name, accuracy, batch) in [
            ("rk45", Accuracy::Rtol(1e-8, None), 2),
            ("taylor", Accuracy::Rtol(1e-8, None), 2),
            ("taylor", Accuracy::Step(1e-4), 1),
            ("radau5", Accuracy::Rtol(1e-8, None), 1),
        ] {
            assert_eq!(timing(name, accuracy).batch, batch, "{name}");
        }
    }
}

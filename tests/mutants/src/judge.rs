//! Which changes do the tests see?

use std::collections::{BTreeMap, HashMap, HashSet};
use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::Duration;

use crate::Failure;
use crate::mutant::Mutant;
use crate::tests::{BUDGET, Ended, Test, on_all_processors};

/// Judges the changes of these numbers, and adds each to the part's outcomes.txt as it comes out; what stands there is not judged again.
pub fn judge(
    mutants: &[Mutant],
    chosen: &[usize],
    tests: &[Test],
    part: &Path,
) -> Result<(), Failure> {
    let path = part.join("outcomes.txt");
    let before = std::fs::read_to_string(&path).unwrap_or_default();
    let known: HashSet<&str> =
        before.lines().filter_map(|line| Some(line.split_once(' ')?.1)).collect();
    let todo: Vec<usize> =
        chosen.iter().copied().filter(|id| !known.contains(mutants[*id].name.as_str())).collect();
    let file = Mutex::new(OpenOptions::new().create(true).append(true).open(&path)?);
    let (next, seen_by) = (AtomicUsize::new(0), Mutex::new(HashMap::<&str, Vec<usize>>::new()));
    on_all_processors(|_| {
        while let Some(&id) = todo.get(next.fetch_add(1, Relaxed)) {
            let mutant = &mutants[id];
            let first = seen_by
                .lock()
                .map_err(|_| "a thread failed")?
                .get(mutant.file.as_str())
                .cloned()
                .unwrap_or_default();
            let (outcome, by) = outcome(id, tests, &first)?;
            if let Some(test) = by {
                let mut seen_by = seen_by.lock().map_err(|_| "a thread failed")?;
                let tests = seen_by.entry(&mutant.file).or_default();
                tests.retain(|other| *other != test);
                tests.insert(0, test);
            }
            writeln!(file.lock().map_err(|_| "a thread failed")?, "{outcome} {}", mutant.name)?;
        }
        Ok(())
    })?;
    summary(&path)
}

/// How a change comes out, and by which test it is seen. The tests in `first` are asked first: they saw other changes of the file.
fn outcome(
    id: usize,
    tests: &[Test],
    first: &[usize],
) -> Result<(&'static str, Option<usize>), Failure> {
    let (mut spent, mut reached) = (Duration::ZERO, false);
    let rest = (0..tests.len()).filter(|test| !first.contains(test));
    for index in first.iter().copied().chain(rest) {
        let test = &tests[index];
        if !test.reaches(id) || spent + test.time > BUDGET {
            continue;
        }
        (spent, reached) = (spent + test.time, true);
        match test.judge(id)? {
            Ended::Passed => {}
            Ended::Failed => return Ok(("caught", Some(index))),
            Ended::Late => return Ok(("endless", Some(index))),
        }
    }
    Ok((if reached { "missed" } else { "unreached" }, None))
}

/// Says how many there are of each outcome, in each package and in all.
fn summary(path: &Path) -> Result<(), Failure> {
    let mut counts = BTreeMap::<String, BTreeMap<String, usize>>::new();
    for line in std::fs::read_to_string(path)?.lines() {
        let mut words = line.split([' ', '/']).map(str::to_owned);
        let (outcome, package) =
            (words.next().unwrap_or_default(), words.next().unwrap_or_default());
        for whose in [package, "all".to_owned()] {
            *counts.entry(whose).or_default().entry(outcome.clone()).or_default() += 1;
        }
    }
    for (whose, counts) in counts {
        let all: usize = counts.values().sum();
        let seen = counts.get("caught").unwrap_or(&0) + counts.get("endless").unwrap_or(&0);
        let share = 100.0 * seen as f64 / all as f64;
        println!("{whose}: {counts:?}: {seen} of {all} seen, {share:.1} %");
    }
    println!("{}", path.display());
    Ok(())
}

//! Which changes of the code do its tests see? `mutants K/N DIR`, called by `run`, which makes DIR/tree, a copy of the workspace, and
//! DIR/places.json, the changes that `cargo mutants` would make.
//!
//! All changes of a part are built into that copy, each behind a switch that a test's environment sets: `a + b` becomes
//! `if on(17) { a - b } else { a + b }`. So it is built once and not 10 000 times, and a change is judged by the tests that
//! reach it alone, the shortest first, up to the first that fails.

mod build;
mod judge;
mod mutant;
mod switch;
mod tests;

use std::collections::BTreeSet;
use std::error::Error;
use std::path::Path;

use mutant::Mutant;

/// What ends the program.
type Failure = Box<dyn Error + Send + Sync>;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [shard, dir] = arguments.as_slice() else { return Err("mutants K/N DIR".into()) };
    let (k, n) = shard.split_once('/').ok_or("K/N: the part, and the number of parts")?;
    let (k, n): (usize, usize) = (k.parse()?, n.parse()?);
    if k >= n {
        return Err("K/N: K is from 0 to N − 1".into());
    }
    let dir = Path::new(dir);
    let part = dir.join(format!("{k}-of-{n}"));
    std::fs::create_dir_all(&part)?;

    let mutants = Mutant::listed(&dir.join("places.json"))?;
    let chosen: BTreeSet<usize> = (k..mutants.len()).step_by(n).collect();
    let built = build::build(&mutants, &chosen, dir)?;
    let tests = tests::recorded(&built.programs, &part)?;
    println!(
        "{} changes; {} do not compile behind a switch, {} have none; {} tests reach {} of the rest",
        chosen.len(),
        built.refused,
        chosen.len() - built.refused - built.switched.len(),
        tests.len(),
        built.switched.iter().filter(|&&id| tests.iter().any(|test| test.reaches(id))).count(),
    );
    judge::judge(&mutants, &built.switched, &tests, &part)
}

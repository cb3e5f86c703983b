//! Which changes of a package do its tests see? `mutants TREE PACKAGE K/N DIR [ARGUMENT OF CARGO…]`, called by `run`, which makes TREE, a copy of the
//! workspace, and DIR/places.json, the changes that `cargo mutants` would make.
//!
//! All changes are built into one copy of the package, each behind a switch that a test's environment sets: `a + b` becomes
//! `if on(17) { a - b } else { a + b }`. So the package is built once and not 10 000 times, and a change is judged by the tests that
//! reach it alone, the shortest first, up to the first that fails.

mod build;
mod judge;
mod mutant;
mod switch;
mod tests;

use std::error::Error;
use std::path::{Path, PathBuf};

use mutant::Mutant;

/// What ends the program.
type Failure = Box<dyn Error + Send + Sync>;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [tree, package, shard, dir, cargo @ ..] = arguments.as_slice() else {
        return Err("mutants TREE PACKAGE K/N DIR [ARGUMENT OF CARGO…]".into());
    };
    let (k, n) = shard.split_once('/').ok_or("K/N: the part, and the number of parts")?;
    let (k, n): (usize, usize) = (k.parse()?, n.parse()?);
    let (tree, dir) = (PathBuf::from(tree), Path::new(dir));

    let mutants = Mutant::listed(&dir.join("places.json"))?;
    let built = build::build(&tree, package, cargo, &mutants, dir)?;
    let tests = tests::recorded(&built.programs, dir)?;
    let chosen: Vec<usize> = built.switched.iter().copied().filter(|id| id % n == k).collect();
    println!(
        "{} changes, {} of them can be switched; {} tests reach {}; {} to judge",
        mutants.len(),
        built.switched.len(),
        tests.len(),
        built.switched.iter().filter(|&&id| tests.iter().any(|test| test.reaches(id))).count(),
        chosen.len()
    );
    judge::judge(&mutants, &chosen, &tests, dir)
}

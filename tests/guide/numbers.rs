//! What pages say of other files: quotations, counts, names of tests.

use std::collections::BTreeMap;

use deltazero_solvers::Method;
use deltazero_study::reference::settings;
use deltazero_study::run::Accuracy;

use crate::{Page, file, pages};

/// Words with one space between them.
fn plain(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn what_is_quoted_stands_in_the_file_that_it_is_from() {
    let mut n_quotations = 0;
    for page in pages() {
        for (source, body) in page.marked("from") {
            let there = plain(&file(source));
            let quoted = Page { path: page.path.clone(), text: body.to_owned() };
            let (blocks, prose) = quoted.parts();
            // Code is quoted in one piece, prose and tables line by line.
            let pieces = blocks.iter().map(|block| block.text.as_str());
            let lines = prose.iter().map(|line| line.trim_start_matches("> "));
            for piece in pieces.chain(lines).map(plain).filter(|piece| !piece.is_empty()) {
                assert!(there.contains(&piece), "{}: not in {source}: {piece}", page.path);
                n_quotations += 1;
            }
        }
    }
    assert!(n_quotations >= 8, "{n_quotations}");
}

#[test]
fn all_rust_is_quoted_from_files_that_are_compiled() {
    for page in pages() {
        let quoted = page.marked("from").into_iter();
        let quoted =
            quoted.filter(|(source, body)| source.ends_with(".rs") && body.contains("```rust"));
        assert_eq!(page.blocks("rust").len(), quoted.count(), "{}", page.path);
    }
}

/// A cell of the map that has a winner.
struct Cell {
    reading: String,
    stiffness: f64,
    damping_ratio: f64,
    accuracy: String,
    winner: &'static Method,
}

/// Those of the committed map. Its first columns hold no commas and no quotes.
fn cells() -> Vec<Cell> {
    let text = file("docs/regimes/regimes.csv");
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let cell = |line: &str| {
        let row: BTreeMap<&str, &str> = header.iter().copied().zip(line.split(',')).collect();
        Some(Cell {
            reading: row["reading"].to_owned(),
            stiffness: row["stiffness"].parse().unwrap(),
            damping_ratio: row["damping_ratio"].parse().unwrap(),
            accuracy: row["accuracy"].to_owned(),
            winner: Method::named(row["method"])?,
        })
    };
    lines.filter_map(cell).collect()
}

/// A part of the map.
type Part = (&'static str, fn(&Cell) -> bool);

/// Lightly damped and stiff.
fn is_stiff(cell: &Cell) -> bool {
    cell.damping_ratio <= 0.1 && cell.stiffness >= 1e9
}

/// The parts of the map of which `which.md` speaks.
const PARTS: [Part; 4] = [
    ("ζ ≤ 0.1, K ≤ 1e8", |cell| cell.damping_ratio <= 0.1 && cell.stiffness <= 1e8),
    ("ζ ≤ 0.1, K ≥ 1e9, `pin`", |cell| is_stiff(cell) && cell.reading == "pin"),
    ("ζ ≤ 0.1, K ≥ 1e9, `full`", |cell| is_stiff(cell) && cell.reading == "full"),
    ("ζ ≥ 1", |cell| cell.damping_ratio >= 1.0),
];

#[test]
fn the_rules_of_thumb_are_counted_in_the_committed_map() {
    let cells = cells();
    let mut rows = Vec::new();
    for (part, is_in) in PARTS {
        for accuracy in ["1e-3", "1e-6"] {
            let here = cells.iter().filter(|cell| is_in(cell) && cell.accuracy == accuracy);
            let winners: Vec<&Method> = here.map(|cell| cell.winner).collect();
            let n_implicit = winners.iter().filter(|method| method.is_implicit()).count();
            let n_either = winners.iter().filter(|method| method.chooses()).count();
            let (n, n_explicit) = (winners.len(), winners.len() - n_implicit - n_either);
            let mut wins = BTreeMap::new();
            winners.iter().for_each(|method| *wins.entry(method.name).or_insert(0) += 1);
            let (most, n_most) = wins.into_iter().max_by_key(|(_, n)| *n).unwrap();
            rows.push(format!(
                "| {part} | {accuracy} | {n_explicit} of {n} | {n_implicit} of {n} | `{most}` {n_most} |"
            ));
        }
    }
    let page = file("docs/which.md");
    for row in &rows {
        assert!(page.contains(row), "docs/which.md should have\n{}", rows.join("\n"));
    }
}

#[test]
fn the_pairs_that_make_a_reference_are_those_of_the_code() {
    let page = file("docs/reference.md");
    for (i, setting) in settings().enumerate() {
        let Accuracy::Rtol(rtol, _) = setting.accuracy else { panic!("{setting:?}") };
        let row = format!("| {} | `{}`, rtol {rtol:e} |", i + 1, setting.method.name);
        assert!(page.contains(&row), "{row}");
    }
    assert!(!page.contains(&format!("| {} | `", settings().count() + 1)));
}

#[test]
fn the_tests_that_the_page_of_events_names_are_there() {
    let (mut n_tests, rules) = (0, file("solvers/src/rules.rs"));
    for name in file("docs/events.md").split('`').skip(1).step_by(2) {
        let Some((module, test)) = name.split_once("::") else { continue };
        let there = file(&format!("solvers/tests/events/{module}.rs"));
        assert!(there.contains(&format!("fn {test}(")), "{name}");
        assert!(rules.contains(name), "{name} is not among the rules");
        n_tests += 1;
    }
    assert!(n_tests > 20, "{n_tests}");
}

#[test]
fn citation_and_changelog_are_of_the_version_that_is_built() {
    let version = env!("CARGO_PKG_VERSION");
    assert!(file("CITATION.cff").lines().any(|line| line == format!("version: {version}")));
    assert!(file("CHANGELOG.md").contains(version));
}

//! Commands, models, configurations.

use std::fs;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

use crate::{Page, file, pages, root};

/// The page whose transcripts are run, and the name of the configuration on it.
const FIRST_RUN: (&str, &str) = ("docs/first_run.md", "my.toml");

/// Pages that tests of their own run: `text/tests/own_model.rs`, `tests/cli/sweep.rs`, `tests/cli/sweep_models.rs`.
const HELD_ELSEWHERE: [&str; 2] = ["docs/own_model.md", "docs/sweep.md"];

/// `deltazero` with `args` in a folder.
fn deltazero(folder: &TempDir, args: &[String]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_deltazero"));
    command.args(args).current_dir(folder.path()).output().unwrap()
}

/// The arguments that a line gives to `deltazero`, if it runs it: up to a redirection, a pipe or a comment.
fn arguments(line: &str) -> Option<Vec<String>> {
    let starts = ["deltazero ", "cargo run --release -- ", "cargo run --release "];
    let rest = starts.iter().find_map(|start| line.strip_prefix(start))?;
    let (mut words, mut quote) = (vec![String::new()], None);
    for c in rest.chars() {
        match c {
            '\'' | '"' if quote.is_none() => quote = Some(c),
            c if quote == Some(c) => quote = None,
            ' ' if quote.is_none() => words.push(String::new()),
            '#' if quote.is_none() && words.last().unwrap().is_empty() => break,
            c => words.last_mut().unwrap().push(c),
        }
    }
    let words = words.into_iter().filter(|word| !word.is_empty());
    Some(words.take_while(|word| !["|", ">", "&&"].contains(&word.as_str())).collect())
}

/// What a page gives to `deltazero`: in blocks of commands, and between words.
fn shown(page: &Page) -> Vec<Vec<String>> {
    let blocks = page.blocks("sh").join("").replace("\\\n", " ");
    let (_, prose) = page.parts();
    let prose = prose.join("\n");
    let spans = prose.split('`').skip(1).step_by(2).filter(|span| span.starts_with("deltazero "));
    let spans = spans.map(|span| span.replace('\n', " "));
    let lines = blocks.lines().map(str::to_owned).chain(spans);
    // An example and a bench are programs of their own.
    let is_own =
        |words: &[String]| !words.iter().any(|word| word == "--example" || word == "--bench");
    lines.filter_map(|line| arguments(&line)).filter(|words| is_own(words)).collect()
}

/// Each `--set` with what is set, but for words that stand for a key or a value, as KEY=VALUE.
fn sets(args: &[String]) -> Vec<String> {
    let is_one = |set: &str| set.split('=').all(|word| word.chars().any(|c| !c.is_uppercase()));
    let given = args.windows(2).filter(|pair| pair[0] == "--set" && is_one(&pair[1]));
    given.flatten().cloned().collect()
}

#[test]
fn every_command_that_is_shown_is_one() {
    let folder = tempfile::tempdir().unwrap();
    let mut n_commands = 0;
    for page in pages() {
        for args in shown(&page) {
            // What stands before --help is read first, and refused if it is wrong.
            let ran = deltazero(&folder, &[&args[..], &["--help".to_owned()]].concat());
            let said = String::from_utf8_lossy(&ran.stderr);
            assert!(ran.status.success(), "{}: {args:?}: {said}", page.path);
            // The first word may else be the name of a configuration.
            let command = args.first().filter(|word| !word.starts_with('-'));
            let usage = format!("Usage: deltazero {}", command.map_or("", String::as_str));
            let help = String::from_utf8_lossy(&ran.stdout);
            assert!(help.contains(&usage), "{}: {args:?}: {help}", page.path);
            n_commands += 1;
            if !args.iter().any(|arg| arg == "--model") {
                let ran = deltazero(&folder, &[&["config".to_owned()][..], &sets(&args)].concat());
                let said = String::from_utf8_lossy(&ran.stderr);
                assert!(ran.status.success(), "{}: {args:?}: {said}", page.path);
            }
        }
    }
    assert!(n_commands > 60, "{n_commands}");
}

#[test]
fn every_model_and_every_configuration_that_is_shown_is_accepted() {
    let folder = tempfile::tempdir().unwrap();
    let mut n_files = 0;
    for page in pages().iter().filter(|page| !HELD_ELSEWHERE.contains(&page.path.as_str())) {
        for text in page.blocks("toml") {
            fs::write(folder.path().join("shown.toml"), &text).unwrap();
            let command = if text.contains("[states]") { "model check" } else { "config" };
            let args = format!("{command} shown.toml");
            let ran = deltazero(&folder, &args.split(' ').map(str::to_owned).collect::<Vec<_>>());
            let said = String::from_utf8_lossy(&ran.stderr);
            assert!(ran.status.success() && said.is_empty(), "{}: {said}\n{text}", page.path);
            n_files += 1;
        }
    }
    assert!(n_files >= 2, "{n_files}");
}

#[test]
fn the_page_of_results_names_every_column_and_every_key() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["simulate", "--no-horizon", "--set", "run.t_end=0.01", "--out", "."];
    assert!(deltazero(&folder, &args.map(str::to_owned)).status.success());
    let text = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let page = file("docs/results.md");
    for name in ["trajectory.csv", "events.csv"] {
        let header = text(name).lines().next().unwrap().replace(',', ", ");
        assert!(page.contains(&format!("`{header}`")), "{name}: {header}");
    }
    let run: Value = serde_json::from_str(&text("run.json")).unwrap();
    for key in run.as_object().unwrap().keys() {
        assert!(page.contains(&format!("`{key}`")), "{key}");
    }
}

#[test]
fn the_page_of_results_names_every_column_behind_a_figure() {
    let folder = tempfile::tempdir().unwrap();
    let sets = ["run.t_end=0.03", "study.methods=[\"rk4\", \"dop853\"]", "study.rtol=[1e-6, 1e-8]"];
    let sets = sets.iter().flat_map(|set| ["--set", set]);
    let args: Vec<String> =
        ["study", "--quiet", "--out", "."].into_iter().chain(sets).map(str::to_owned).collect();
    assert!(deltazero(&folder, &args).status.success());
    let page = file("docs/results.md");
    let (_, behind) = page.split_once("### The data behind a study's figures").unwrap();
    for name in [
        "steps",
        "step_histogram",
        "stays",
        "restarts",
        "restart_costs",
        "rk4_stability",
        "tolerance",
    ] {
        let text = fs::read_to_string(folder.path().join(format!("{name}.csv"))).unwrap();
        let header = text.lines().next().unwrap();
        assert!(behind.contains(&format!("| `{name}.csv` |")), "{name}");
        assert!(behind.contains(&format!("| `{header}` |")), "{name}: {header}");
    }
}

/// Words of a text but for times [ms] and residuals, which other machines round otherwise.
fn comparable(text: &str) -> Vec<&str> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let varies = |i: usize| {
        words.get(i + 1) == Some(&"ms") || i.checked_sub(1).is_some_and(|i| words[i] == "residual")
    };
    (0..words.len()).filter(|i| !varies(*i)).map(|i| words[i]).collect()
}

#[test]
fn the_first_run_prints_what_its_page_shows() {
    let folder = tempfile::tempdir().unwrap();
    let (path, configuration) = FIRST_RUN;
    let page = pages().into_iter().find(|page| page.path == path).unwrap();
    fs::write(folder.path().join(configuration), &page.blocks("toml")[0]).unwrap();
    let transcripts = page.blocks("console");
    assert_eq!(transcripts.len(), 2);
    for transcript in transcripts {
        let (command, shown) = transcript.split_once('\n').unwrap();
        let ran = deltazero(&folder, &arguments(command.strip_prefix("$ ").unwrap()).unwrap());
        let printed = if ran.status.success() { ran.stdout } else { ran.stderr };
        let printed = String::from_utf8(printed).unwrap();
        assert_eq!(comparable(&printed), comparable(shown), "{command}");
    }
}

#[test]
fn the_python_program_prints_what_its_page_shows() {
    let program = root().join("examples/drop_test.py");
    let mut python = Command::new("python3");
    let Ok(ran) = python.arg(program).env("DELTAZERO", env!("CARGO_BIN_EXE_deltazero")).output()
    else {
        return println!("not run: there is no python3 here");
    };
    let said = String::from_utf8_lossy(&ran.stderr);
    assert!(ran.status.success(), "{said}");
    let printed = String::from_utf8(ran.stdout).unwrap();
    let page = pages().into_iter().find(|page| page.path == "docs/from_python.md").unwrap();
    let shown = &page.blocks("text")[0];
    // Which method is the cheapest is measured, and another machine may find another one.
    let is_same = |line: &&str| !line.starts_with("to 1e-6: ");
    let same = |text: &str| text.lines().filter(is_same).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(same(&printed), same(shown));
    assert_eq!(printed.lines().count(), shown.lines().count());
}

//! The program as its users meet it: command line, files, exit codes.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "helpers of tests, where a panic is a failed test"
)]

mod audit;
mod bad_input;
mod failure;
#[cfg(target_os = "linux")]
mod full_disk;
#[cfg(unix)]
mod interrupt;
mod listings;
mod mechanisms;
mod models;
mod output;
mod plot;
mod recommend;
mod regimes;
mod report;
mod report_sweep;
mod self_judgement;
mod simulate;
mod study;
#[cfg(unix)]
mod sweep;
mod sweep_models;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// What a command left behind.
struct Ran {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

/// The text of a file of the project, by its path there.
fn committed(path: &str) -> String {
    fs::read_to_string(format!("{}/{path}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// An empty directory in which commands run.
struct Scratch(TempDir);

impl Scratch {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// `deltazero` with `args`, its streams piped, not yet started.
    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_deltazero"));
        command
            .args(args)
            .current_dir(self.0.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    fn run(&self, args: &[&str]) -> Ran {
        let output = self.command(args).output().unwrap();
        Ran {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// As `run`, and it must end well.
    fn succeed(&self, args: &[&str]) -> Ran {
        let ran = self.run(args);
        assert_eq!(ran.code, Some(0), "{args:?}: {}", ran.stderr);
        ran
    }

    /// `simulate` into `dir` with each of `sets`, which must end well.
    fn simulate(&self, dir: &str, sets: &[&str]) -> Ran {
        self.succeed(&with_sets(&["simulate", "--out", dir], sets))
    }

    /// `study` into `dir` with each of `sets` and further arguments, which must end well.
    fn study(&self, dir: &str, sets: &[&str], more: &[&str]) -> Ran {
        let args = with_sets(&["study", "--out", dir], sets);
        self.succeed(&[&args[..], more].concat())
    }

    /// `sweep` of `plan.toml` into `dir`, which must end well; `runs.csv`.
    fn sweep(&self, dir: &str, more: &[&str]) -> String {
        self.succeed(&[&["sweep", "plan.toml", "--out", dir][..], more].concat());
        self.text(&format!("{dir}/runs.csv"))
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.text(name)).unwrap()
    }

    fn table(&self, name: &str) -> Table {
        Table::of(&self.text(name))
    }

    /// Names of the files below `dir`, sorted, but for that which commands lock.
    fn files(&self, dir: &str) -> Vec<String> {
        fn collect(at: &Path, from: &Path, names: &mut Vec<String>) {
            for entry in fs::read_dir(at).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    collect(&path, from, names);
                } else if !is_lock(&path) {
                    names.push(path.strip_prefix(from).unwrap().display().to_string());
                }
            }
        }
        let (mut names, from) = (Vec::new(), self.path(dir));
        collect(&from, &from, &mut names);
        names.sort();
        names
    }
}

/// Whether commands hold a lock on it.
fn is_lock(path: &Path) -> bool {
    path.file_name().unwrap().to_str().unwrap().starts_with(".deltazero-lock")
}

/// `args`, then `--set` before each of `sets`.
fn with_sets<'a>(args: &[&'a str], sets: &[&'a str]) -> Vec<&'a str> {
    let sets = sets.iter().flat_map(|set| ["--set", set]);
    args.iter().copied().chain(sets).collect()
}

/// A CSV file.
struct Table {
    header: Vec<String>,
    rows: Vec<BTreeMap<String, String>>,
}

impl Table {
    fn of(text: &str) -> Self {
        assert!(text.ends_with('\n'), "the last line is whole");
        let mut lines = text.lines();
        let header: Vec<String> = fields(lines.next().unwrap());
        let rows = lines.map(|line| {
            let fields = fields(line);
            assert_eq!(fields.len(), header.len(), "{line}");
            header.iter().cloned().zip(fields).collect()
        });
        let rows = rows.collect();
        Self { header, rows }
    }

    /// The rows of one joint.
    fn of_joint(&self, joint: usize) -> Vec<&BTreeMap<String, String>> {
        let joint = joint.to_string();
        self.rows.iter().filter(|row| row["joint"] == joint).collect()
    }
}

/// The fields of a line, quotes taken off.
fn fields(line: &str) -> Vec<String> {
    let (mut fields, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            c => fields.last_mut().unwrap().push(c),
        }
    }
    fields
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap()
}

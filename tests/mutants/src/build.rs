//! The workspace with the changes, built.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::Failure;
use crate::mutant::Mutant;
use crate::switch::Switched;

/// What came of it.
pub struct Built {
    /// Programs of tests, with the directory that each runs in.
    pub programs: Vec<Program>,
    /// The changes that compile, and have a switch.
    pub switched: Vec<usize>,
    /// How many do not compile behind a switch.
    pub refused: usize,
}

/// A program of tests, and the directory that it runs in.
pub type Program = (PathBuf, PathBuf);

/// A complaint of the compiler: the file, where in it, and what it says.
type Complaint = (String, Range<usize>, String);

/// Switches the chosen changes, and takes those back that the compiler refuses until it refuses none.
pub fn build(mutants: &[Mutant], chosen: &BTreeSet<usize>, dir: &Path) -> Result<Built, Failure> {
    let tree = dir.join("tree");
    let mut files: BTreeMap<&str, Vec<(usize, &Mutant)>> = BTreeMap::new();
    for (id, mutant) in mutants.iter().enumerate() {
        let file = files.entry(&mutant.file).or_default();
        file.extend(chosen.contains(&id).then_some((id, mutant)));
    }
    let sources: BTreeMap<&str, String> = files
        .keys()
        .map(|file| Ok((*file, original(&tree.join(file))?)))
        .collect::<std::io::Result<_>>()?;
    let known = dir.join("refused.json");
    let mut refused: BTreeSet<usize> =
        std::fs::read(&known).map_or(Ok(BTreeSet::new()), |text| serde_json::from_slice(&text))?;
    loop {
        let mut switched = BTreeMap::new();
        for (file, all) in &files {
            let wanted: Vec<_> =
                all.iter().copied().filter(|(id, _)| !refused.contains(id)).collect();
            let text = Switched::of(&sources[file], &wanted)
                .map_err(|error| format!("{file}: {error}"))?;
            if std::fs::read_to_string(tree.join(file))? != text.text {
                std::fs::write(tree.join(file), &text.text)?;
            }
            switched.insert(*file, text);
        }
        let checked = compile(&["check", "--tests", "--keep-going"], dir)?;
        let (errors, programs) =
            if checked.0.is_empty() { compile(&["test", "--no-run"], dir)? } else { checked };
        if errors.is_empty() {
            let ids: BTreeSet<usize> = switched
                .values()
                .flat_map(|file| file.places.iter().flat_map(|(_, ids)| ids.clone()))
                .collect();
            let switched = ids.into_iter().collect();
            let refused = refused.intersection(chosen).count();
            return Ok(Built { programs, switched, refused });
        }
        let before = refused.len();
        for (file, range, message) in errors {
            let file = switched
                .get(file.as_str())
                .ok_or_else(|| format!("{file} was not changed: {message}"))?;
            refused.extend(file.blamed(range));
        }
        println!("{} changes do not compile, or have no switch that does", refused.len());
        std::fs::write(&known, serde_json::to_vec(&refused)?)?;
        if refused.len() == before {
            return Err("what the compiler refuses could not be told".into());
        }
    }
}

/// What a file was before it was changed, which is kept beside it.
fn original(file: &Path) -> std::io::Result<String> {
    let kept = file.with_extension("rs.original");
    if !kept.exists() {
        std::fs::copy(file, &kept)?;
    }
    std::fs::read_to_string(kept)
}

/// What one command of cargo says of all tests: complaints with file, place and text, and the programs, if it makes them.
fn compile(command: &[&str], dir: &Path) -> Result<(Vec<Complaint>, Vec<Program>), Failure> {
    let tree = dir.join("tree");
    let output = Command::new("cargo")
        .args(command)
        .args(["--workspace", "--message-format", "json"])
        .current_dir(&tree)
        .env("CARGO_TARGET_DIR", dir.join("target"))
        .env("CARGO_INCREMENTAL", "1")
        .env("RUSTFLAGS", "--cap-lints=allow")
        .stderr(Stdio::inherit())
        .output()?;
    let (mut errors, mut programs) = (Vec::new(), Vec::new());
    for line in String::from_utf8(output.stdout)?.lines() {
        let said: Value = serde_json::from_str(line)?;
        if said["profile"]["test"] == true {
            let manifest = Path::new(said["manifest_path"].as_str().unwrap_or_default());
            let beside = manifest.parent().unwrap_or(&tree).to_owned();
            programs.extend(
                said["executable"].as_str().map(|program| (PathBuf::from(program), beside)),
            );
        }
        let message = &said["message"];
        if message["level"] != "error" {
            continue;
        }
        let spans = message["spans"].as_array().map(Vec::as_slice).unwrap_or_default();
        for span in spans.iter().filter(|span| span["is_primary"] == true) {
            let span = written_at(span, &tree);
            let bytes = |key: &str| span[key].as_u64().map_or(0, |byte| byte as usize);
            let file = span["file_name"].as_str().unwrap_or_default().to_owned();
            errors.push((
                file,
                bytes("byte_start")..bytes("byte_end"),
                message["message"].to_string(),
            ));
        }
    }
    if errors.is_empty() && !output.status.success() {
        return Err(format!("cargo {} failed", command.join(" ")).into());
    }
    Ok((errors, programs))
}

/// Where what a complaint is about is written: a macro's own text is not, but where it is called.
fn written_at<'a>(mut span: &'a Value, tree: &Path) -> &'a Value {
    while !tree.join(span["file_name"].as_str().unwrap_or_default()).starts_with(tree)
        && span["expansion"].is_object()
    {
        span = &span["expansion"]["span"];
    }
    span
}

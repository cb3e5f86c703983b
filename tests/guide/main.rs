//! README, `docs/` and the papers beside them: every page is in the guide, every link leads somewhere, every number is that of
//! the file that it is from, and every command, model and piece of code works.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

mod code;
mod links;
mod numbers;

use std::fs;
use std::path::{Path, PathBuf};

/// The folder of the repository.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The text of a file, by its path from there.
fn file(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Pages at the root of the repository.
const AT_ROOT: [&str; 3] = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"];

/// A page.
struct Page {
    /// From the folder of the repository, with `/`.
    path: String,
    text: String,
}

/// All of them: those at the root, and those below `docs`.
fn pages() -> Vec<Page> {
    let mut paths = AT_ROOT.map(PathBuf::from).to_vec();
    let mut folders = vec![PathBuf::from("docs")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(root().join(&folder)).unwrap() {
            let path = folder.join(entry.unwrap().file_name());
            if root().join(&path).is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "md") {
                paths.push(path);
            }
        }
    }
    let mut paths: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    paths.sort();
    assert!(paths.len() > 20, "{paths:?}");
    let page = |path: String| Page { text: file(&path), path };
    paths.into_iter().map(page).collect()
}

/// A fenced block.
struct Block {
    language: String,
    text: String,
}

impl Page {
    /// The fenced blocks, and the lines outside them.
    fn parts(&self) -> (Vec<Block>, Vec<&str>) {
        let (mut blocks, mut prose) = (Vec::new(), Vec::new());
        let mut open: Option<Block> = None;
        for line in self.text.lines() {
            match (line.strip_prefix("```"), &mut open) {
                (Some(language), None) => {
                    open = Some(Block { language: language.to_owned(), text: String::new() });
                }
                (Some(_), Some(_)) => blocks.extend(open.take()),
                (None, Some(block)) => block.text += &format!("{line}\n"),
                (None, None) => prose.push(line),
            }
        }
        assert!(open.is_none(), "{}: a block is not closed", self.path);
        (blocks, prose)
    }

    /// The blocks in a language.
    fn blocks(&self, language: &str) -> Vec<String> {
        let (blocks, _) = self.parts();
        blocks
            .into_iter()
            .filter(|block| block.language == language)
            .map(|block| block.text)
            .collect()
    }

    /// What stands between `<!-- word FIRST … -->` and `<!-- end -->`, with FIRST.
    fn marked(&self, word: &str) -> Vec<(&str, &str)> {
        let open = format!("<!-- {word} ");
        let mut found = Vec::new();
        for after in self.text.split(&open).skip(1) {
            let (head, rest) = after.split_once("-->").unwrap();
            let (body, _) =
                rest.split_once("<!-- end -->").unwrap_or_else(|| panic!("{}: {head}", self.path));
            found.push((head.split_whitespace().next().unwrap(), body));
        }
        found
    }
}

//! Files that are missing, unreadable, malformed or hostile.

use std::fs;
use std::path::{Path, PathBuf};

use super::super::*;
use super::{load, refusal};
use crate::keys::*;

/// A file in the directory for temporary files, removed at the end of the test.
struct Temporary(PathBuf);

impl Temporary {
    fn new(name: &str, bytes: &[u8]) -> Self {
        let path = std::env::temp_dir().join(format!("deltazero-{}-{name}", std::process::id()));
        fs::write(&path, bytes).unwrap();
        Self(path)
    }

    fn message(&self, sets: &[&str]) -> String {
        let sets: Vec<_> = sets.iter().map(|&set| set.to_owned()).collect();
        let message = Config::load(Some(&self.0), &sets).unwrap_err().to_string();
        message.replace(&self.0.display().to_string(), "FILE")
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

#[test]
fn a_file_is_read_and_sets_follow_it() {
    let file =
        Temporary::new("good.toml", b"\xEF\xBB\xBFreading = 'full'\r\n[run]\r\nt_end = 1\r\n");
    let config = Config::load(Some(&file.0), &["run.t_end=3".to_owned()]).unwrap();
    assert_eq!((config.reading, config.run.t_end), (ReadingName::Full, 3.0));
}

#[test]
fn lines_are_counted_as_editors_do() {
    let file =
        Temporary::new("lines.toml", b"\xEF\xBB\xBF# one\r\n# two\r\n[run]\r\nt_end = 0\r\n");
    assert_eq!(file.message(&[]), "FILE:4: run.t_end = 0 is out of range: s, greater than 0");
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    let message = Config::load(Some(Path::new("no/such.toml")), &[]).unwrap_err().to_string();
    assert!(message.starts_with("no/such.toml: cannot be read: "), "{message}");
    let directory = std::env::temp_dir();
    let message = Config::load(Some(&directory), &[]).unwrap_err().to_string();
    let start = format!("{}: cannot be read: ", directory.display());
    assert!(message.starts_with(&start), "{message}");
}

#[test]
fn a_file_that_is_not_utf8_is_refused_with_its_line() {
    let file = Temporary::new("latin1.toml", b"reading = 'pin'\n# caf\xE9\n");
    assert_eq!(
        file.message(&[]),
        "FILE:2: byte 21 is 0xe9: not UTF-8 text; save the file as UTF-8, or convert it: iconv -f latin1 -t utf-8"
    );
}

#[test]
fn a_syntax_error_names_its_line() {
    let quoted = "string values must be quoted, expected literal string; a number has no unit beside it, as in 1.5e8, \
                  and a word stands in quotes";
    assert_eq!(refusal("reading = 'pin'\nbays ="), format!("bad.toml:2: {quoted}"));
    assert_eq!(refusal("reading = pin"), format!("bad.toml:1: {quoted}"));
    assert_eq!(
        refusal("bays = 1\n\nbays = 1"),
        "bad.toml:3: bays stands here a second time; leave one of the two out"
    );
    assert_eq!(
        refusal("contact.law = 'power'\n[contact]"),
        "bad.toml:2: contact stands here a second time; leave one of the two out"
    );
    assert_eq!(refusal("\n[contact"), "bad.toml:2: unclosed table, expected `]`");
    assert_eq!(refusal("study.rtol = [1,\n"), "bad.toml:1: unclosed array, expected `]`");
}

#[test]
fn odd_keys_and_values_are_refused_on_one_line() {
    let texts = [
        "\"\" = 1",
        "\"a\\nb\" = 1",
        "\"\\u0000\" = 1",
        "'ключ.δ' = 1",
        "\"contact\".\"stiffness.\" = 1",
        "contact.\"stiffness\\t\" = 1",
        "reading = \"\"\"\npin\n\"\"\"",
        "reading = \"\\u001b[31m\"",
        "[\"joint1\".\"\"]\nx = 1",
        "[joint1.\"contact.stiffness\"]\nx = 1",
        "reading.\u{fffd} = 1",
        "\u{0}",
        "a.b.c.d.e.f.g.h.i.j.k.l.m.n = 1",
        "contact.stiffness.a.b.c = 1",
        "study.rtol = [[[[[[[[[[[[1]]]]]]]]]]]]",
    ];
    for text in texts {
        let message = refusal(text);
        assert!(message.starts_with("bad.toml:"), "{message}");
        assert!(!message.contains(char::is_control), "{message:?}");
        assert!(message.chars().count() < 400, "{message}");
    }
    for set in
        ["contact.=1", ".=1", "..=..", "contact..stiffness=1", "\"a=b\"=1", "a\nb=1", "a=1\nb=2"]
    {
        let message = load("", &[set]).unwrap_err().to_string();
        assert!(message.starts_with("--set ") && !message.contains('\n'), "{message:?}");
    }
}

#[test]
fn deep_nesting_is_refused_without_harm() {
    let deep = 100_000;
    for text in [
        format!("study.rtol = {}1{}", "[".repeat(deep), "]".repeat(deep)),
        format!("study.rtol = {}1{}", "[".repeat(79), "]".repeat(79)),
        format!("contact = {}1{}", "{a=".repeat(deep), "}".repeat(deep)),
        format!("contact = {}1{}", "{a.a.a.a.a.a.a.a=".repeat(70), "}".repeat(70)),
        format!("[{}a]\nb = 1", "a.".repeat(deep)),
        format!("{}a = 1", "a.".repeat(79)),
        "[".repeat(deep),
        format!("reading = \"{}\"", "x".repeat(deep)),
    ] {
        let message = refusal(&text);
        assert!(message.starts_with("bad.toml:1: "), "{}", &message[..80.min(message.len())]);
        assert!(message.chars().count() < 400, "{}", message.chars().count());
    }
}

#[test]
fn every_prefix_of_the_default_file_is_read_or_refused() {
    let text = default_toml();
    for (end, _) in text.char_indices() {
        if let Err(error) = load(&text[..end], &[]) {
            assert!(error.to_string().starts_with("bad.toml:"), "{error}");
        }
    }
}

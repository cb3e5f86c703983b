//! What several test files share.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

use deltazero_text::{ModelFile, TextModel};

/// A file that is right.
pub(crate) fn file(text: &str) -> ModelFile {
    ModelFile::parse("model.toml", text).unwrap_or_else(|report| panic!("{report}"))
}

/// The one model of a file that is right.
pub(crate) fn model(text: &str) -> TextModel {
    file(text).models(&[]).unwrap().remove(0)
}

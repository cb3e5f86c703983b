//! The page `docs/own_model.md`: its models run, and its messages are those that the crate gives.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

use deltazero_solvers::{Grid, Method, Trajectory};
use deltazero_study::Problem as _;
use deltazero_study::run::{Accuracy, Setting, integrate};
use deltazero_study::setting::Events;
use deltazero_text::ModelFile;

/// The fenced blocks of the page: language and lines.
fn blocks() -> Vec<(String, String)> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/own_model.md");
    let page = std::fs::read_to_string(path).unwrap();
    let mut all = Vec::new();
    let mut now: Option<(String, String)> = None;
    for line in page.lines() {
        match (line.strip_prefix("```"), now.as_mut()) {
            (Some(language), None) => now = Some((language.to_owned(), String::new())),
            (Some(_), Some(_)) => all.extend(now.take()),
            (None, Some((_, text))) => *text += &format!("{line}\n"),
            (None, None) => {}
        }
    }
    all
}

/// What the crate says of a model: why it is refused, its warnings, or why a run fails; nothing if all is well.
fn said_of(text: &str) -> String {
    let file = match ModelFile::parse("pendulum.toml", text) {
        Ok(file) => file,
        Err(report) => return report.to_string(),
    };
    if let Some(warning) = file.warnings().first() {
        return warning.to_string();
    }
    let model = file.models(&[]).unwrap_or_else(|report| panic!("{report}")).swap_remove(0);
    let (method, events) = (Method::named("rk45").unwrap(), Events::Located);
    let setting = Setting { method, events, accuracy: Accuracy::Rtol(1e-8, None) };
    let mut trajectory = Trajectory::on(Grid::Steps);
    let run = integrate(&model, &setting, model.start(), 5.0, &mut trajectory);
    run.outcome.err().map_or(String::new(), |error| error.to_string())
}

/// Without spaces at the ends of lines.
fn trimmed(text: &str) -> String {
    text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n").trim_end().to_owned()
}

#[test]
fn the_models_of_the_page_give_the_messages_of_the_page() {
    let blocks = blocks();
    let models: Vec<usize> = (0..blocks.len()).filter(|i| blocks[*i].0 == "toml").collect();
    assert_eq!(models.len(), 8);
    for i in models {
        let said = trimmed(&said_of(&blocks[i].1));
        let next = blocks.get(i + 1).filter(|block| block.0 == "text");
        let page = next.map_or(String::new(), |block| trimmed(&block.1));
        assert_eq!(said, page, "of\n{}", blocks[i].1);
    }
}

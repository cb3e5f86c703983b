//! A slice of what `cargo bench --bench random` draws.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

#[path = "../benches/drawn/mod.rs"]
mod drawn;

use deltazero::config::Config;
use deltazero_study::parallel::{cores, in_parallel};
use drawn::Judged;
use drawn::audit::Budget;
use drawn::draw::Draw;

const SEED: u64 = 1;
const N: u64 = 100;
/// Of the time that the bench gives a run.
const SHARE: f64 = 0.4;
/// Time is for what no count foresees.
const BUDGET: Budget = Budget { work: 3e5, wall_s: 60.0 };

#[test]
fn methods_of_different_kind_agree_on_configurations_drawn_at_random() {
    agree(Draw::new);
}

#[test]
fn methods_of_different_kind_agree_on_other_mechanisms_and_models_drawn_at_random() {
    agree(Draw::of_another);
}

fn agree(draw: fn(u64, u64) -> Draw) {
    let threads = cores();
    let draws: Vec<u64> = (0..N).collect();
    let all =
        in_parallel(&draws, threads, |i| Judged::new(draw(SEED, *i).shortened(SHARE), *i, BUDGET));
    let found: Vec<_> = all
        .iter()
        .filter(|judged| judged.verdict.class.is_found())
        .map(|judged| format!("draw {}\n{}", judged.i, judged.toml()))
        .collect();
    assert!(found.is_empty(), "{} of {N}\n{}", found.len(), found.join("\n"));
}

#[test]
fn a_draw_is_read_back_from_its_file_whatever_was_drawn_before() {
    let dir = tempfile::tempdir().unwrap();
    for (i, kind) in (0..200).flat_map(|i| [(i, Draw::new as fn(_, _) -> _), (i, Draw::of_another)])
    {
        let draw = kind(SEED, i);
        let path = dir.path().join(format!("{i}.toml"));
        std::fs::write(&path, draw.toml("what happened\nand when")).unwrap();
        let model = draw.model_file();
        let read = Config::load_with(model.as_deref(), Some(&path), &[]);
        // What is refused is named by where it stands.
        assert_eq!(read.ok(), draw.config().ok(), "{i}");
    }
    assert_eq!(Draw::new(SEED, 7).toml(""), Draw::new(SEED, 7).toml(""));
    assert_ne!(Draw::new(SEED, 7).toml(""), Draw::new(SEED, 8).toml(""));
}

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
    let threads = cores();
    let draws: Vec<u64> = (0..N).collect();
    let all = in_parallel(&draws, threads, |i| {
        Judged::new(Draw::new(SEED, *i).shortened(SHARE), *i, BUDGET)
    });
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
    for i in 0..200 {
        let draw = Draw::new(SEED, i);
        let path = dir.path().join(format!("{i}.toml"));
        std::fs::write(&path, draw.toml("what happened\nand when")).unwrap();
        assert_eq!(Config::load(Some(&path), &[]).unwrap(), draw.config().unwrap(), "{i}");
    }
    assert_eq!(Draw::new(SEED, 7).toml(""), Draw::new(SEED, 7).toml(""));
    assert_ne!(Draw::new(SEED, 7).toml(""), Draw::new(SEED, 8).toml(""));
}

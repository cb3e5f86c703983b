//! A slice of what `cargo bench --bench random` draws.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

#[path = "../benches/drawn/mod.rs"]
mod drawn;

use deltazero::config::Config;
use deltazero_study::parallel::{cores, in_parallel};
use drawn::Judged;
use drawn::audit::Budget;
use drawn::draw::Draw;
use drawn::verdict::Class;

const SEED: u64 = 1;
const N: u64 = 100;
/// Of the time that the bench gives a run.
const SHARE: f64 = 0.4;
/// Time is for what no count foresees.
const BUDGET: Budget = Budget { work: 3e5, wall_s: 60.0 };

#[test]
fn methods_of_different_kind_agree_on_configurations_drawn_at_random() {
    // Measured: 98.
    agree(Draw::new, 90);
}

#[test]
fn methods_of_different_kind_agree_on_other_mechanisms_and_models_drawn_at_random() {
    // Measured: 81; some do not close, or contradict themselves.
    agree(Draw::of_another, 65);
}

fn agree(draw: fn(u64, u64) -> Draw, least_compared: usize) {
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
    let is_compared = |judged: &&Judged| judged.is(Class::Agree) || judged.is(Class::Past);
    let n_compared = all.iter().filter(is_compared).count();
    assert!(n_compared >= least_compared, "{n_compared} of {N} were compared");
}

#[test]
fn a_draw_is_read_back_from_its_file_whatever_was_drawn_before() {
    let dir = tempfile::tempdir().unwrap();
    let read_back = |draw: &Draw, i: u64| {
        let path = dir.path().join(format!("{i}.toml"));
        std::fs::write(&path, draw.toml("what happened\nand when")).unwrap();
        Config::load_with(draw.model_file().as_deref(), Some(&path), &[])
    };
    let mut n_read = 0;
    for i in 0..200 {
        let draw = Draw::new(SEED, i);
        assert_eq!(read_back(&draw, i).unwrap(), draw.config().unwrap(), "{i}");
        // Of the others some do not close, or contradict themselves.
        let draw = Draw::of_another(SEED, i);
        let read = read_back(&draw, i).ok();
        n_read += usize::from(read.is_some());
        assert_eq!(read, draw.config().ok(), "{i}");
    }
    // Measured: 167.
    assert!(n_read > 140, "{n_read}");
    assert_eq!(Draw::new(SEED, 7).toml(""), Draw::new(SEED, 7).toml(""));
    assert_ne!(Draw::new(SEED, 7).toml(""), Draw::new(SEED, 8).toml(""));
}

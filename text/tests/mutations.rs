//! No text makes the parser or a run of its model panic, hang or take much memory.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test panics to fail and tells figures"
)]

use std::time::{Duration, Instant};

use deltazero_solvers::{Run, System, Trajectory};
use deltazero_study::Problem;
use deltazero_text::models::MODELS;
use deltazero_text::{Any, ModelFile, TextModel};
use fastrand::Rng;

/// Two that have every piece of the language between them.
const OWN: [&str; 2] = [include_str!("models/row.toml"), include_str!("models/stop.toml")];

/// These and those that come with the program.
fn models() -> Vec<&'static str> {
    OWN.into_iter().chain(MODELS.iter().map(|model| model.text)).collect()
}

/// Pieces that are put in, besides pieces of the models themselves.
const PIECES: &[&str] = &[
    "\"",
    "'",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "=",
    ",",
    "^",
    "..",
    "-",
    "1e308",
    "99999",
    "0",
    "-1",
    "1e-320",
    "i",
    "n",
    "t",
    "pi",
    "sum(j in 1..99999, j)",
    "if(i < n, 1, 2)",
    "x[i]",
    "for = \"k in 1..900000000\"",
    "F",
    "((((((((((",
    "x^x^x^x^x^x",
    "for = \"k in 1..99999\"",
    "atan2(",
    "\n",
    "\u{3b4}",
    "\u{fe0f}",
    "\r",
    "\\u0041",
    "\"\"\"",
    "true",
    "length = 100000",
    "log(x[1])",
    "1/0",
    "^0.5",
];

/// Words, numbers and signs of a text.
fn tokens(text: &str) -> Vec<&str> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let (mut all, mut rest) = (Vec::new(), text);
    while let Some(first) = rest.chars().next() {
        let length = if is_word(first) {
            rest.find(|c| !is_word(c)).unwrap_or(rest.len())
        } else {
            first.len_utf8()
        };
        all.push(&rest[..length]);
        rest = &rest[length..];
    }
    all
}

fn with_other_bytes(rng: &mut Rng, text: &str) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..rng.usize(1..6) {
        let at = rng.usize(0..bytes.len());
        match rng.u8(0..3) {
            0 => bytes[at] = rng.u8(..),
            1 => bytes.insert(at, rng.u8(32..127)),
            _ => drop(bytes.remove(at)),
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn with_other_tokens(rng: &mut Rng, text: &str) -> String {
    let mut all = tokens(text);
    for _ in 0..rng.usize(1..5) {
        let (at, from) = (rng.usize(0..all.len()), rng.usize(0..all.len()));
        let piece = if rng.bool() { all[from] } else { PIECES[rng.usize(0..PIECES.len())] };
        match rng.u8(0..4) {
            0 => all[at] = piece,
            1 => all.insert(at, piece),
            2 => drop(all.remove(at)),
            _ => {
                let end = (at + rng.usize(1..20)).min(all.len());
                let copy = all[at..end].to_vec();
                all.splice(from..from, copy);
            }
        }
    }
    all.concat()
}

/// Right-hand sides of a run.
const MOST_WORK: u64 = 200;
/// States of a model that is run.
const FEW: usize = 100;

/// Runs a model for a short while by three kinds of method: either it says why it cannot go on, or its end is finite.
fn try_run(model: &TextModel<Any>, text: &str) {
    let y = Problem::start(model);
    for method in ["rk45", "taylor", "radau5"] {
        let run = Run::of(model, y.clone()).method(method).tolerance(1e-6, 1e-6);
        let ended = run.most_work(MOST_WORK).keep(Trajectory::of_events()).to(1.0);
        let is_right = match ended {
            Ok(run) => run.end.y.iter().all(|y| y.is_finite()),
            Err(error) => !error.to_string().is_empty(),
        };
        assert!(is_right, "{method}: {text}");
    }
}

/// What became of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Tried {
    Refused,
    /// A model of too many states to run.
    Evaluated,
    Ran,
}

/// Whether a text is a model, which is then tried out.
fn try_out(text: &str) -> bool {
    tried(text) != Tried::Refused
}

/// Parses a text, evaluates every function of its models once, and runs them.
fn tried(text: &str) -> Tried {
    let file = match ModelFile::parse("mutant.toml", text) {
        Ok(file) => file,
        Err(report) => {
            let told = report.to_string();
            assert!(told.contains("--> mutant.toml:"), "no place: {told}\nof\n{text}");
            assert!(told.contains("= help: "), "no way out: {told}\nof\n{text}");
            let ((line, column), lines) = (report.line_and_column(), text.split('\n').count());
            assert!((1..=lines + 1).contains(&line) && column > 0, "{line}:{column} of\n{text}");
            assert!(report.span().end <= text.len() + 1, "{:?} of\n{text}", report.span());
            return Tried::Refused;
        }
    };
    assert!(file.warnings().iter().all(|warning| !warning.to_string().is_empty()));
    let mut end = Tried::Evaluated;
    for model in file.models(&[]).unwrap() {
        let y = Problem::start(&model);
        let mode = model.initial_mode(0.0, &y);
        let mut dydt = y.clone();
        let [mut g, mut bounds] = [(); 2].map(|()| vec![0.0; model.n_guards()]);
        assert!(model.rhs_with_guards(mode, 0.0, &y, &mut dydt, &mut g));
        model.guard_bounds(mode, 0.0, &y, &mut bounds);
        assert!(bounds.iter().all(|bound| bound.is_nan() || *bound > 0.0), "{text}");
        for guard in 0..model.n_guards().min(3) {
            model.transition(mode, guard, 0.0, &mut y.clone());
            model.accumulation(mode, guard, 0.0, &mut y.clone());
        }
        model.touch(&mode, 0.0, &y, 0);
        model.powers(&mode, 0.0, &y);
        model.rows(&mode, 0.0, &y, &mut |_, _| {});
        if model.dim() < FEW {
            model.jacobian(mode, 0.0, &y, |_, _, _| {});
            try_run(&model, text);
            end = Tried::Ran;
        }
    }
    end
}

fn mutate(n: usize, seed: u64) {
    let mut rng = Rng::with_seed(seed);
    let (mut ends, mut longest) = ([0; 3], Duration::ZERO);
    let models = models();
    for i in 0..n {
        let text = models[i % models.len()];
        let mutant = if rng.u8(0..3) == 0 {
            with_other_bytes(&mut rng, text)
        } else {
            with_other_tokens(&mut rng, text)
        };
        let start = Instant::now();
        ends[tried(&mutant) as usize] += 1;
        let took = start.elapsed();
        assert!(took < Duration::from_secs(20), "{took:?} for\n{mutant}");
        longest = longest.max(took);
    }
    let [n_refused, n_evaluated, n_ran] = ends;
    println!(
        "of {n} texts {n_refused} were refused, {n_evaluated} were models too large to run, {n_ran} ran; the longest took {longest:?}"
    );
    assert!(n_ran > n / 100);
}

#[test]
fn models_as_they_are_pass() {
    assert!(models().into_iter().all(try_out));
}

#[test]
fn mutated_models_are_refused_or_run() {
    mutate(40_000, 1);
}

/// By hand: `cargo test --release -p deltazero-text --test mutations -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes"]
fn a_million_mutated_models_are_refused_or_run() {
    mutate(1_000_000, 2);
}

#[test]
fn deep_and_long_formulas_are_refused_or_built() {
    let model = |rate: &str| format!("[states]\nx = 1\n[modes.a]\nrates = {{ x = \"{rate}\" }}\n");
    let deep = |n: usize| format!("{}x{}", "(".repeat(n), ")".repeat(n));
    assert!(try_out(&model(&deep(90))));
    assert!(!try_out(&model(&deep(5000))));
    assert!(!try_out(&model(&format!("{}x", "-".repeat(5000)))));
    assert!(!try_out(&model(&format!("{}x", "x^".repeat(5000)))));
    assert!(try_out(&model(&format!("{}x", "x+".repeat(100_000)))));
    assert!(!try_out(&model(&format!("{}x", "x+".repeat(1_000_000)))));
    assert!(!try_out(&model("sum(i in 1..99999, sum(j in 1..99999, x*i*j))")));
    let events = "events = [{ for = \"i in 1..900000000\", when = \"x > i\", stop = true }]\n";
    assert!(!try_out(&format!("{}{events}", model("1"))));
    let chain = |n: usize| {
        let formulas: String = (1..n).map(|i| format!("d{i} = \"d{}*x + 1\"\n", i + 1)).collect();
        format!("[definitions]\n{formulas}d{n} = \"x\"\n{}", model("d1"))
    };
    assert!(try_out(&chain(150)));
    try_out(&chain(10_000));
}

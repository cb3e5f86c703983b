//! Do methods of different kind agree? Configurations drawn at random over all that a user may set, run by `vern98`,
//! `radau5` and `taylor` at rtol 1e-12, and judged; see `drawn/verdict.rs`.
//!
//! `cargo bench --bench random -- --n 3000 --seed 1 --out DIR` draws joints, with `--others` the other mechanisms and the
//! models that come with the program; what disagrees, fails or takes too long is written to
//! DIR as files that `deltazero simulate` runs. `--from I` begins with draw I, `--threads T` uses T threads, which
//! changes no result.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a bench panics to fail, and prints"
)]

#[path = "drawn/mod.rs"]
mod drawn;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use deltazero_study::parallel::{cores, in_parallel};
use drawn::Judged;
use drawn::audit::Budget;
use drawn::draw::Draw;
use drawn::verdict::Class;

/// What a run may cost: some seconds; time is for what no count foresees.
const BUDGET: Budget = Budget { work: 2e6, wall_s: 60.0 };

/// The command line.
struct Args {
    n: usize,
    from: u64,
    seed: u64,
    threads: usize,
    out: Option<PathBuf>,
    others: bool,
}

impl Args {
    fn read() -> Self {
        let threads = cores();
        let mut own = Self { n: 20, from: 0, seed: 1, threads, out: None, others: false };
        let mut args = std::env::args().skip(1).filter(|arg| arg != "--bench");
        while let Some(name) = args.next() {
            if name == "--others" {
                own.others = true;
                continue;
            }
            let value = args.next().unwrap_or_else(|| panic!("{name} has no value"));
            let number = || value.parse::<u64>().unwrap_or_else(|_| panic!("{name} is a number"));
            match name.as_str() {
                "--n" => own.n = number() as usize,
                "--from" => own.from = number(),
                "--seed" => own.seed = number(),
                "--threads" => own.threads = number() as usize,
                "--out" => own.out = Some(value.into()),
                _ => panic!("{name} is none of --n, --from, --seed, --threads, --out, --others"),
            }
        }
        own
    }
}

fn main() {
    let args = Args::read();
    if let Some(dir) = &args.out {
        std::fs::create_dir_all(dir).expect("the directory can be made");
    }
    let (done, start) = (AtomicUsize::new(0), Instant::now());
    let draws: Vec<u64> = (args.from..).take(args.n).collect();
    let all = in_parallel(&draws, args.threads, |i| {
        let i = *i;
        let draw = if args.others { Draw::of_another } else { Draw::new };
        let judged = Judged::new(draw(args.seed, i), i, BUDGET);
        if let Some(dir) = args.out.as_ref().filter(|_| judged.verdict.class.is_found()) {
            let path = dir.join(format!("{}-{:04}.toml", args.seed, judged.i));
            std::fs::write(path, judged.toml()).expect("the directory can be written");
        }
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        if done.is_multiple_of(20) || judged.verdict.class.is_found() {
            let (i, class, took) = (judged.i, judged.verdict.class, start.elapsed().as_secs());
            eprintln!("{done} of {} in {took} s: draw {i} {class}", args.n);
        }
        judged
    });
    for judged in all.iter().filter(|judged| judged.verdict.class.is_found()) {
        let (verdict, draw) = (&judged.verdict, &judged.draw);
        let get = |key| draw.get(key).unwrap_or("").trim_matches('"');
        println!(
            "{:5} {:8} {} {} {}: {}",
            judged.i,
            verdict.class,
            get("mechanism"),
            get("contact.law"),
            get("friction.law"),
            verdict.lines.join(" | ")
        );
    }
    println!();
    for key in ["mechanism", "reading", "bays", "contact.law", "friction.law", "contact.adhesion"] {
        print_counts(key, &all);
    }
    print_counts("", &all);
    print_spread(&all);
}

/// Draws by class and by the value of a key; of all together where there is none.
fn print_counts(key: &str, all: &[Judged]) {
    let mut counts: BTreeMap<&str, [usize; Class::ALL.len()]> = BTreeMap::new();
    for judged in all {
        let value = if key.is_empty() { "all" } else { judged.draw.get(key).unwrap_or("-") };
        let row = counts.entry(value.trim_matches('"')).or_default();
        for (count, class) in row.iter_mut().zip(Class::ALL) {
            *count += usize::from(judged.is(class));
        }
    }
    print!("{key:28}");
    for class in Class::ALL {
        print!(" {class:>8}");
    }
    println!();
    for (value, row) in counts {
        print!("  {value:26}");
        for count in row {
            print!(" {count:8}");
        }
        println!();
    }
}

/// A number of a draw.
type Of = fn(&Judged) -> f64;

/// What the bounds of the verdict are chosen by.
fn print_spread(all: &[Judged]) {
    let kinds: [(&str, Of); 5] = [
        ("e within the horizon", |judged| judged.verdict.e),
        ("of what is allowed", |judged| judged.verdict.of_allowed),
        ("time in different modes", |judged| judged.verdict.modes_s),
        ("energy residual", |judged| judged.verdict.residual),
        ("work", |judged| judged.verdict.work),
    ];
    println!("{:28} {:>8} {:>8} {:>8} {:>8}", "", "median", "90 %", "99 %", "most");
    for (name, of) in kinds {
        let mut values: Vec<f64> = all
            .iter()
            .filter(|judged| !judged.verdict.class.is_found() && !judged.is(Class::Refused))
            .map(of)
            .collect();
        values.sort_by(f64::total_cmp);
        let at = |part: f64| {
            let last = values.len().saturating_sub(1);
            values.get((part * last as f64).round() as usize).copied().unwrap_or(f64::NAN)
        };
        println!("{name:28} {:8.1e} {:8.1e} {:8.1e} {:8.1e}", at(0.5), at(0.9), at(0.99), at(1.0));
    }
}

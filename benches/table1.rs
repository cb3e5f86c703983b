//! One run of Table 1, 0–2 s, both joints: each method, located and blind, at two accuracies.
//!
//! The pair located/blind is the price of events; `--` a name picks one.
#![allow(missing_docs, reason = "criterion's macros make undocumented functions")]

use std::hint::black_box;
use std::sync::atomic::AtomicBool;

use criterion::{Criterion, criterion_group, criterion_main};
use deltazero::config::Config;
use deltazero::model::Joints;
use deltazero::run::Run;
use deltazero_solvers::{Grid, METHODS};
use deltazero_study::run::{Accuracy, Limits, Setting};
use deltazero_study::setting::Events;

fn table1(criterion: &mut Criterion) {
    let Ok(config) = Config::table1() else { return };
    let mechanism = Joints::from(&config);
    let grid = Grid::uniform(config.run.sample, config.run.t_end);
    let stop = AtomicBool::new(false);
    let limits = Limits::none(&stop);
    for method in METHODS {
        for events in [Events::Located, Events::Blind] {
            let accuracies = if method.is_fixed_step() {
                [Accuracy::Step(1e-4), Accuracy::Step(2e-5)]
            } else {
                [Accuracy::Rtol(1e-6, None), Accuracy::Rtol(1e-9, None)]
            };
            for accuracy in accuracies {
                let name = format!("table1/{}/{events}/{accuracy:?}", method.name);
                let setting = Setting { method, events, accuracy };
                criterion.bench_function(&name, |bencher| {
                    bencher.iter(|| {
                        black_box(Run::new(&mechanism, &setting, config.run.t_end, &grid, limits))
                    });
                });
            }
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = table1
}
criterion_main!(benches);

//! One evaluation of a block: right-hand side in each mode, guards, Jacobian.
#![allow(missing_docs, reason = "criterion's macros make undocumented functions")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use deltazero::config::Config;
use deltazero::model::contact::Onset;
use deltazero::model::mode::N_GUARDS;
use deltazero::model::{Joints, Mode};
use deltazero_solvers::System;

fn rhs(criterion: &mut Criterion) {
    let Ok(config) = Config::table1() else { return };
    let block = &Joints::from(&config).blocks()[0].clone();
    let y = [-9.0e-5, -4.4e-5, 0.01, -1e-3, 2e-3, 0.02];
    for mode in [Mode::Apart, Mode::SlipPlus(Onset::PLAIN), Mode::Stick(Onset::PLAIN)] {
        let mut dydt = [0.0; 6];
        criterion.bench_function(&format!("rhs/{mode}"), |bencher| {
            bencher.iter(|| block.rhs(black_box(mode), 0.0, black_box(&y), &mut dydt));
        });
        let mut guards = [0.0; N_GUARDS];
        criterion.bench_function(&format!("guards/{mode}"), |bencher| {
            bencher.iter(|| block.guards(black_box(mode), 0.0, black_box(&y), &mut guards));
        });
        criterion.bench_function(&format!("jacobian/{mode}"), |bencher| {
            bencher.iter(|| {
                let mut sum = 0.0;
                block.jacobian(black_box(mode), 0.0, black_box(&y), |_, _, entry| sum += entry);
                sum
            });
        });
    }
}

criterion_group!(benches, rhs);
criterion_main!(benches);

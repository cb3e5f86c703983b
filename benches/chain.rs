//! N bays against 10: right-hand side, guards, Jacobian, and steps of explicit and implicit methods without
//! an event. Throughput is in bays, or in bays times steps: its inverse, the cost per bay, should not grow.
#![allow(missing_docs, reason = "criterion's macros make undocumented functions")]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use deltazero::config::Config;
use deltazero::model::struts::chain_of;
use deltazero::model::{Chain, Jointed as _};
use deltazero_solvers::{Method, System};
use deltazero_study::run::{Accuracy, Setting};
use deltazero_study::setting::Events;

const BAYS: [u32; 4] = [10, 100, 500, 1000];
/// Every pin slips in a contact, for longer than it is looked at.
const START: [f64; 6] = [-9.1e-5, -4.4e-5, 0.01, 0.0, 0.0, 0.5];
/// The span looked at [s].
const SPAN: f64 = 2e-4;

fn chain(bays: u32) -> Option<Chain> {
    let mut config = Config::table1().ok()?;
    config.bays = bays;
    Some(chain_of(&config))
}

fn evaluations(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("chain");
    for bays in BAYS {
        let Some(chain) = chain(bays) else { return };
        let y = START.repeat(chain.bays);
        let modes = chain.initial_mode(0.0, &y);
        group.throughput(Throughput::Elements(u64::from(bays)));
        let mut dydt = y.clone();
        group.bench_function(format!("rhs/{bays}"), |bencher| {
            bencher.iter(|| chain.rhs(modes.clone(), 0.0, black_box(&y), &mut dydt));
        });
        let mut guards = vec![0.0; chain.n_guards()];
        group.bench_function(format!("guards/{bays}"), |bencher| {
            bencher.iter(|| chain.guards(modes.clone(), 0.0, black_box(&y), &mut guards));
        });
        group.bench_function(format!("jacobian/{bays}"), |bencher| {
            bencher.iter(|| {
                let mut sum = 0.0;
                chain.jacobian(modes.clone(), 0.0, black_box(&y), |_, _, entry| sum += entry);
                sum
            });
        });
    }
}

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("chain");
    group.sample_size(10);
    for name in ["rk45", "rodas5p", "radau5", "bdf"] {
        let Some(method) = Method::named(name) else { return };
        for bays in BAYS {
            let Some(chain) = chain(bays) else { return };
            let accuracy = Accuracy::Rtol(1e-6, None);
            let y0 = START.repeat(chain.bays);
            let setting = Setting { method, events: Events::Located, accuracy };
            let run = || chain.integrate(&setting, y0.clone(), SPAN, &mut ());
            let stats = run().stats;
            assert_eq!(stats.n_events, 0, "{name}, {bays} bays: {stats:?}");
            group.throughput(Throughput::Elements(stats.n_accepted * u64::from(bays)));
            group.bench_function(format!("{name}/{bays}"), |bencher| bencher.iter(run));
        }
    }
}

criterion_group!(benches, evaluations, steps);
criterion_main!(benches);

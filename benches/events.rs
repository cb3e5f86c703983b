//! What guards cost where nothing crosses: the same steps with and without them.
#![allow(missing_docs, reason = "criterion's macros make undocumented functions")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use deltazero::config::Config;
use deltazero::model::contact::Onset;
use deltazero::model::mode::N_GUARDS;
use deltazero::model::{Block, Joints, Mode, State};
use deltazero_solvers::{Control, Integration, Method, Next, Real, System};

/// A block held in one mode, with the first `N` of its guards: all four, or none.
struct Held<'a, const N: usize> {
    block: &'a Block,
    mode: Mode,
}

impl<const N: usize> System for Held<'_, N> {
    type Mode = Mode;
    type State<S: Real> = State<S>;
    type Guards<S: Real> = [S; N];

    fn initial_mode(&self, _t: f64, _y: &State<f64>) -> Mode {
        self.mode
    }

    fn rhs<S: Real>(&self, mode: Mode, t: S, y: &State<S>, dydt: &mut State<S>) {
        self.block.rhs(mode, t, y, dydt);
    }

    #[inline(always)]
    fn guards<S: Real>(&self, mode: Mode, t: S, y: &State<S>, g: &mut [S; N]) {
        if N > 0 {
            let mut all = [S::cst(0.0); N_GUARDS];
            self.block.guards(mode, t, y, &mut all);
            g.copy_from_slice(&all[..N]);
        }
    }

    fn guard_bounds(&self, mode: Mode, t: f64, y: &State<f64>, bounds: &mut [f64; N]) {
        let mut all = [0.0; N_GUARDS];
        self.block.guard_bounds(mode, t, y, &mut all);
        bounds.copy_from_slice(&all[..N]);
    }

    fn transition<S: Real>(&self, _: Mode, _: usize, _: S, _: &mut State<S>) -> Next<Mode> {
        Next::Stop
    }
}

/// The span looked at [s], and the steps over it.
const SPAN: f64 = 2.5e-4;
const STEPS: u32 = 50;

/// A deep contact that slips one way for longer than it is looked at.
const START: State<f64> = [-9.1e-5, -4.4e-5, 0.01, 0.0, 0.0, 0.5];

fn run<const N: usize>(criterion: &mut Criterion, block: &Block, method: &str, name: &str) {
    let held = Held::<N> { block, mode: Mode::SlipPlus(Onset::PLAIN) };
    let control = Control::Fixed(SPAN / f64::from(STEPS));
    let Some(Ok(mut solver)) = Method::named(method).map(|method| method.solver(&held, control))
    else {
        return;
    };
    criterion.bench_function(&format!("no_crossings/{method}/{name}"), |bencher| {
        bencher.iter(|| {
            let mut run = Integration::new(&held, 0.0, black_box(START));
            let outcome = run.run(SPAN, &mut *solver, &mut ());
            assert!(run.stats.n_events == 0 && run.stats.n_accepted == u64::from(STEPS));
            outcome
        });
    });
}

/// Pairs: the same steps with guards that hold, and without guards.
fn guards_without_crossings(criterion: &mut Criterion) {
    let Ok(config) = Config::table1() else { return };
    let block = &Joints::from(&config).blocks()[0].clone();
    for method in ["rk45", "dop853"] {
        run::<N_GUARDS>(criterion, block, method, "guarded");
        run::<0>(criterion, block, method, "unguarded");
    }
}

criterion_group!(benches, guards_without_crossings);
criterion_main!(benches);

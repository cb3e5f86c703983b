//! What several test files share.
// Each test file is a crate of its own and uses a part; helpers are not marked as tests.
#![allow(dead_code, clippy::unwrap_used, clippy::print_stdout)]

use deltazero_solvers::{Control, Integration, Method, Record, System, Tolerance};

/// Asserts that `found` is at most `bound`; `--nocapture` shows what was measured.
#[track_caller]
pub(crate) fn at_most(what: &str, found: f64, bound: f64) {
    println!("{what}: {found:.1e} (bound {bound:.1e})");
    assert!(found <= bound, "{what}: {found:e} above {bound:e}");
}

/// Asserts that `found` is within `distance` of `expected`.
#[track_caller]
pub(crate) fn near(what: &str, found: f64, expected: f64, distance: f64) {
    println!("{what}: {found:.3} for {expected}");
    assert!((found - expected).abs() <= distance, "{what}: {found} for {expected}");
}

/// Slope of the line through `(ln x, ln y)` with the least sum of squares.
pub(crate) fn log_slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let logs = || points.iter().map(|(x, y)| (x.ln(), y.ln()));
    let mean_x = logs().map(|(x, _)| x).sum::<f64>() / n;
    let mean_y = logs().map(|(_, y)| y).sum::<f64>() / n;
    let xy: f64 = logs().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let xx: f64 = logs().map(|(x, _)| (x - mean_x) * (x - mean_x)).sum();
    xy / xx
}

/// How far a measured slope may be from the order of `method`.
pub(crate) fn slack(method: &Method) -> f64 {
    if method.order > 5 { 0.5 } else { 0.2 }
}

/// The same tolerance for both states, relative and absolute.
pub(crate) fn tolerance(rtol: f64) -> Control {
    Control::Adaptive(Tolerance { rtol, atol: vec![rtol; 2] })
}

/// Whether `method` takes a fixed step.
pub(crate) fn takes_fixed_steps<P: System>(method: &Method, problem: &P) -> bool {
    method.solver(problem, Control::Fixed(1.0)).is_ok()
}

/// Whether `method` chooses its steps itself and lands on its interpolant; `auto` chooses, but retakes
/// its steps to land.
pub(crate) fn steps_itself<P: System>(method: &Method, problem: &P) -> bool {
    !takes_fixed_steps(method, problem) && method.name != "auto"
}

/// Whether `method` solves the equations of a step by iteration: where the slope jumps within it they
/// may have no solution, and a fixed step is then refused.
pub(crate) fn iterates(method: &Method) -> bool {
    method.name == "radau5"
}

/// The state at `t_end` of a run from `(t0, y0)`, shown to `record`.
pub(crate) fn end_state<P: System>(
    problem: &P,
    method: &Method,
    control: Control,
    (t0, y0): (f64, P::State<f64>),
    t_end: f64,
    record: &mut dyn Record<P>,
) -> P::State<f64> {
    let mut integration = Integration::new(problem, t0, y0);
    let mut solver = method.solver(problem, control).unwrap();
    integration.run(t_end, &mut *solver, record).unwrap();
    integration.point.y
}

/// Greatest difference of two states.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

//! The impact oscillator, against the closed form of each arc.

use std::f64::consts::PI;

use super::arcs::{Arc, End, follow};
use super::oscillator::Oscillator;
use super::runs::{METHODS, Run, balance, below, distance, latest, model, of, parameter, t_end};

const NAME: &str = "impact_oscillator";

#[test]
fn every_method_follows_the_closed_form_from_impact_to_impact() {
    let [m, c, k, f, omega] = ["m", "c", "k", "F", "omega"].map(|name| parameter(NAME, name));
    let [d, e, start] = ["d", "e", "u_0"].map(|name| parameter(NAME, name));
    // m ü + c u̇ + k u = −k d + F cos ωt
    let motion =
        Oscillator { mass: m, damping: c, stiffness: k, force: [-k * d, f, 0.0], frequency: omega };
    let impact = End { reset: [0.0, -e], ..End::at(|_, [u, _]| -u, 0) };
    let arcs = [Arc {
        name: "free",
        motion: Box::new(|t_0, y, t| motion.flow(t_0, y, t)),
        ends: vec![impact],
    }];
    let (impacts, end) = follow(&arcs, 0, [start, 0.0], t_end(NAME), 1e-3);
    let exact: Vec<f64> = impacts.iter().map(|impact| impact.0).collect();
    assert_eq!(exact.len(), 34);
    let model = model(NAME, &[]);
    for method in METHODS.into_iter().chain(["bdf"]) {
        let run = Run::by(&model, method, 1e-10, t_end(NAME));
        let late = latest(&run.times_of("free"), &exact);
        let off = distance(&model, &run.y, &end);
        // Measured: 2.6e-11 s (rodas5p) and 3.0e-11 (dop853); 1.2e-9 s and 4.3e-10 (radau5); 5.9e-9 s and 1.2e-8 (bdf).
        let late_bound = of(method, [2e-10, 9e-9, 5e-8]);
        let bound = of(method, [2e-10, 4e-9, 1e-7]);
        below(&format!("{method} impacts [s]"), late, late_bound);
        below(&format!("{method} end"), off, bound);
    }
}

#[test]
fn impacts_under_a_pressing_load_end_at_the_stop_until_the_load_changes_its_sign() {
    let model = model(NAME, &[("F", 20.0), ("omega", 2.0)]);
    for method in METHODS {
        let run = Run::by(&model, method, 1e-10, 4.0 * PI);
        assert_eq!(run.times_of("at the stop").len(), 4, "{method}");
        let leaves = run.changes.iter().filter(|change| change.before == "at the stop");
        let leaves: Vec<f64> = leaves.map(|change| change.t).collect();
        // k d/F = 1/2
        let exact = [1.0, 2.0, 3.0].map(|n| (PI / 3.0 + 2.0 * PI * n) / 2.0);
        // Measured: 3.6e-15 s.
        below(&format!("{method} leaves [s]"), latest(&leaves, &exact), 3e-14);
    }
}

#[test]
fn the_force_gives_what_damping_and_impacts_take() {
    let own = balance(&model(NAME, &[]), "vern98", 1e-10, t_end(NAME));
    assert!(own.work > 1.0, "{own:?}");
    // Measured: 5.9e-12.
    below("balance", own.residual.abs() / own.work, 5e-11);
}

//! A mass against a stop, and the cam and its follower, against the closed form of each arc.

use deltazero_solvers::System as _;
use deltazero_study::Problem as _;

use super::arcs::{Arc, End, bisect, follow};
use super::oscillator::Oscillator;
use super::runs::{METHODS, Run, balance, below, distance, latest, model, of, parameter, t_end};

#[test]
fn a_mass_against_a_stop_follows_the_closed_form_until_it_lies_on_it() {
    let name = "mass_against_stop";
    let [m, k, zeta] = ["m", "K", "zeta"].map(|own| parameter(name, own));
    let [g, start] = ["g", "x_0"].map(|own| parameter(name, own));
    let d = 2.0 * zeta * (k * m).sqrt();
    let push = move |[x, v]: [f64; 2]| k * x + d * v;
    let fall = |t_0: f64, [x, v]: [f64; 2], t: f64| {
        let s = t - t_0;
        [x + s * (v + 0.5 * g * s), v + g * s]
    };
    let contact =
        Oscillator { mass: m, damping: d, stiffness: k, force: [m * g, 0.0, 0.0], frequency: 0.0 };
    let arcs = [
        Arc { name: "flight", motion: Box::new(fall), ends: vec![End::at(|_, [x, _]| -x, 1)] },
        Arc {
            name: "contact",
            motion: Box::new(move |t_0, y, t| contact.flow(t_0, y, t)),
            ends: vec![End::at(move |_, y| push(y), 2)],
        },
        Arc {
            name: "leaving",
            motion: Box::new(fall),
            ends: vec![End::at(|_, [x, _]| x, 0), End::at(move |_, y| -push(y), 1)],
        },
    ];
    let (exact, end) = follow(&arcs, 0, [start, 0.0], t_end(name), 1e-5);
    let times: Vec<f64> = exact.iter().map(|own| own.0).collect();
    let model = model(name, &[]);
    for method in METHODS {
        let run = Run::by(&model, method, 1e-10, t_end(name));
        let found: Vec<f64> = run.changes.iter().map(|change| change.t).collect();
        let late = latest(&found, &times);
        let off = distance(&model, &run.y, &end);
        // Measured: 6.7e-12 s and 5.4e-12 (dop853); 1.2e-10 s (radau5) and 5.0e-10 (rk45).
        below(
            &format!("{method} {} events [s]", times.len()),
            late,
            of(method, [6e-11, 1e-9, 0.0]),
        );
        below(&format!("{method} end"), off, of(method, [5e-11, 5e-9, 0.0]));
        assert_eq!(run.changes.last().unwrap().after, "contact");
        // It lies on the stop at m g/K, and swings no more. Measured: 3.0e-10.
        below(&format!("{method} dent at rest"), (run.y[0] / (m * g / k) - 1.0).abs(), 3e-9);
    }
}

#[test]
fn a_stop_without_damping_gives_the_energy_back() {
    let name = "mass_against_stop";
    let model = model(name, &[("zeta", 0.0)]);
    let own = balance(&model, "vern98", 1e-11, t_end(name));
    // Measured: 2.7e-14 J.
    below("elastic [J]", own.dissipated.abs().max(own.residual.abs()), 2e-13);
    // ½ K δ² = m g (δ + h) at the deepest point.
    let [m, k, g, start] = ["m", "K", "g", "x_0"].map(|own| parameter(name, own));
    let deepest = (m * g + (m * g * (m * g - 2.0 * k * start)).sqrt()) / k;
    let run = Run::by(&model, "taylor", 1e-12, t_end(name));
    let found = run.samples.iter().map(|(_, y)| y[0]).fold(0.0, f64::max);
    // The deepest of the steps.
    assert!(found > 0.98 * deepest, "{found:e} {deepest:e}");
    below("too deep", found / deepest - 1.0, 1e-12);
}

#[test]
fn the_stop_loses_what_it_takes() {
    let name = "mass_against_stop";
    let own = balance(&model(name, &[]), "vern98", 1e-11, 0.1);
    below("loss of the stop", own.residual.abs() / own.dissipated, 1e-8);
}

/// The follower in closed form: event times, and the state at the end.
fn cam(speed: f64, t_end: f64) -> super::arcs::Followed {
    let name = "cam_follower";
    let [m, k, preload, c] = ["m", "k", "F_0", "c"].map(|own| parameter(name, own));
    let [h, stiff, damp] = ["h", "K", "D"].map(|own| parameter(name, own));
    let lift = move |t: f64| {
        let (sin, cos) = libm::sincos(speed * t);
        [0.5 * h * (1.0 - cos), 0.5 * h * speed * sin]
    };
    let depth = move |t: f64, [x, v]: [f64; 2]| [lift(t)[0] - x, lift(t)[1] - v];
    let push = move |t: f64, y: [f64; 2]| {
        let [delta, rate] = depth(t, y);
        stiff * delta + damp * rate
    };
    let own = Oscillator {
        mass: m,
        damping: c,
        stiffness: k,
        force: [-preload, 0.0, 0.0],
        frequency: speed,
    };
    // K s + D ṡ, with s = (h/2)(1 − cos Ωt).
    let half = 0.5 * h;
    let together = Oscillator {
        damping: c + damp,
        stiffness: k + stiff,
        force: [stiff * half - preload, -stiff * half, damp * half * speed],
        ..own
    };
    let flies = move |t_0, y, t| own.flow(t_0, y, t);
    let arcs = [
        Arc {
            name: "flight",
            motion: Box::new(flies),
            ends: vec![End::at(move |t, y| -depth(t, y)[0], 1)],
        },
        Arc {
            name: "contact",
            motion: Box::new(move |t_0, y, t| together.flow(t_0, y, t)),
            ends: vec![End::at(push, 2)],
        },
        Arc {
            name: "leaving",
            motion: Box::new(flies),
            ends: vec![End::at(move |t, y| depth(t, y)[0], 0), End::at(move |t, y| -push(t, y), 1)],
        },
    ];
    let first = (preload + m * half * speed * speed) / (stiff + k);
    follow(&arcs, 1, [-first, 0.0], t_end, 1e-6)
}

#[test]
fn a_follower_that_lifts_off_flies_and_lands_as_in_closed_form() {
    let name = "cam_follower";
    let (exact, end) = cam(parameter(name, "Omega"), t_end(name));
    let times: Vec<f64> = exact.iter().map(|own| own.0).collect();
    let model = model(name, &[]);
    for method in METHODS {
        let run = Run::by(&model, method, 1e-10, t_end(name));
        let found: Vec<f64> = run.changes.iter().map(|change| change.t).collect();
        let late = latest(&found, &times);
        let off = distance(&model, &run.y, &end);
        // Measured: 2.6e-12 s (taylor) and 7.4e-12 (rodas5p); 3.2e-9 s and 2.9e-9 (radau5).
        below(
            &format!("{method} {} events [s]", times.len()),
            late,
            of(method, [1e-10, 3e-8, 0.0]),
        );
        below(&format!("{method} end"), off, of(method, [7e-11, 3e-8, 0.0]));
        for (change, (_, before, after)) in run.changes.iter().zip(&exact) {
            assert!(change.before == *before && change.after == *after, "{method}: {change:?}");
        }
    }
}

#[test]
fn the_follower_starts_with_the_acceleration_of_the_cam() {
    let name = "cam_follower";
    let [h, speed] = ["h", "Omega"].map(|own| parameter(name, own));
    let model = model(name, &[]);
    let start = model.start();
    let mut rates = start.clone();
    model.rhs(model.initial_mode(0.0, &start), 0.0, &start, &mut rates);
    let exact = 0.5 * h * speed * speed;
    // Measured: 2.2e-16.
    below("acceleration", (rates[1] / exact - 1.0).abs(), 2e-15);
}

/// The contact is in series with the follower: with `Z = k − mΩ² + icΩ`, `Z_c = K + iDΩ` the steady force has the mean
/// `(F_0 + k h/2) K/(K + k)` and the amplitude `(h/2) |Z Z_c/(Z + Z_c)|`; it separates where they are equal.
#[test]
fn the_follower_separates_above_the_closed_form_speed_alone() {
    let name = "cam_follower";
    let [m, k, preload, c] = ["m", "k", "F_0", "c"].map(|own| parameter(name, own));
    let [h, stiff, damp] = ["h", "K", "D"].map(|own| parameter(name, own));
    let is_past = |omega: f64| {
        let (own, contact) = ([k - m * omega * omega, c * omega], [stiff, damp * omega]);
        let size = |[re, im]: [f64; 2]| libm::hypot(re, im);
        let amplitude =
            0.5 * h * size(own) * size(contact) / size([own[0] + contact[0], own[1] + contact[1]]);
        amplitude > (preload + 0.5 * k * h) * stiff / (stiff + k)
    };
    let critical = bisect(300.0, 600.0, is_past);
    for (factor, separates) in [(1.0 - 1e-6, false), (1.0 + 1e-6, true)] {
        let speed = factor * critical;
        let run = Run::by(&model(name, &[("Omega", speed)]), "rk45", 1e-9, 0.04);
        assert_eq!(!run.changes.is_empty(), separates, "{speed}");
    }
}

#[test]
fn the_cam_gives_what_spring_and_contact_lose() {
    let name = "cam_follower";
    let own = balance(&model(name, &[]), "vern98", 1e-11, 0.05);
    below("loss of the cam", own.residual.abs() / own.dissipated, 1e-8);
}

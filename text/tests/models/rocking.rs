//! The rocking block, against its first integral, the time between impacts as a quadrature, and rest as their limit.

use super::runs::{METHODS, Run, below, latest, model, of, parameter, t_end};

const NAME: &str = "rocking_block";

/// α, p and r.
fn block() -> [f64; 3] {
    let [b, h, g] = ["b", "h", "g"].map(|name| parameter(NAME, name));
    let radius = libm::hypot(b, h);
    let sin = b / radius;
    [libm::atan2(b, h), (0.75 * g / radius).sqrt(), 1.0 - 1.5 * sin * sin]
}

/// `cos(α − θ_0) − cos α`: the energy of the start over m g R.
fn first_energy() -> f64 {
    let [alpha, ..] = block();
    2.0 * libm::sin(alpha - 0.5 * 0.15) * libm::sin(0.5 * 0.15)
}

/// Time from the turning point with the energy `energy` to the impact [s].
///
/// With β = α − θ the equation is β̈ = p² sin β, and `sin(β/2) = k cosh s` from `k = sin(β_0/2)`:
///
/// ```text
/// p t = ∫ ds/√(1 − k² cosh² s)  from 0 to S,   sinh² S = (energy/2)/k²,   k² = sin²(α/2) − energy/2
/// ```
fn quarter(energy: f64) -> f64 {
    let [alpha, p, _] = block();
    let half = libm::sin(0.5 * alpha);
    let square = half * half - 0.5 * energy;
    let end = libm::asinh((0.5 * energy / square).sqrt());
    let n = 400;
    let h = end / f64::from(n);
    let simpson = |i: i32| {
        let cosh = libm::cosh(h * f64::from(i));
        let weight = if i == 0 || i == n { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
        weight / (1.0 - square * cosh * cosh).sqrt()
    };
    (0..=n).map(simpson).sum::<f64>() * h / (3.0 * p)
}

#[test]
fn impacts_come_at_the_times_of_the_quadrature_and_end_in_rest_at_their_limit() {
    let [.., r] = block();
    let (mut t, mut energy, mut exact) = (0.0, first_energy(), Vec::new());
    for n in 0..1000 {
        t += if n == 0 { 1.0 } else { 2.0 } * quarter(energy);
        energy *= r * r;
        exact.push(t);
    }
    let accumulation = t;
    for method in METHODS {
        let run = Run::by(&model(NAME, &[]), method, 1e-10, t_end(NAME));
        // The first leaves the rest at once, the last comes to rest.
        let impacts = run.changes.len() - 2;
        let times: Vec<f64> = run.changes[1..=35].iter().map(|change| change.t).collect();
        let late = latest(&times, &exact[..35]);
        let rest = run.times_of("at rest");
        assert!(impacts > 100 && rest.len() == 1, "{method}: {impacts}");
        let limit = (rest[0] - accumulation).abs();
        // Measured: 1.5e-9 and 2.7e-9 s (rodas5p); 9.2e-9 and 1.5e-8 s (radau5).
        below(&format!("{method} impacts [s]"), late, of(method, [1e-8, 9e-8, 0.0]));
        below(&format!("{method} rest [s]"), limit, of(method, [2e-8, 1e-7, 0.0]));
        assert_eq!(run.y, [0.0, 0.0], "{method}");
    }
}

#[test]
fn between_impacts_the_first_integral_is_kept_and_at_each_it_falls_by_the_square_of_the_ratio() {
    let [alpha, p, r] = block();
    let run = Run::by(&model(NAME, &[]), "taylor", 1e-14, 7.5);
    let mut worst = 0.0_f64;
    for (t, y) in &run.samples {
        let impacts = run.changes.iter().filter(|change| 0.0 < change.t && change.t <= *t);
        let impacts = impacts.count();
        let theta = y[0].abs();
        let lift = 2.0 * libm::sin(alpha - 0.5 * theta) * libm::sin(0.5 * theta);
        let energy = 0.5 * y[1] * y[1] / (p * p) + lift;
        let left = libm::pow(r, 2.0 * impacts as f64) * first_energy();
        worst = worst.max((energy / left - 1.0).abs());
    }
    // Measured: 6.1e-13.
    below("first integral", worst, 6e-12);
}

#[test]
fn a_block_leaves_its_rest_where_the_base_exceeds_g_tan_alpha_and_overturns() {
    let [b, h, g, omega] = ["b", "h", "g", "Omega"].map(|name| parameter(NAME, name));
    let shaken = |a: f64| model(NAME, &[("A", a), ("theta_0", 0.0)]);
    let tilts = libm::asin(g * b / h / 3.0) / omega;
    for method in METHODS {
        let run = Run::by(&shaken(3.0), method, 1e-10, 20.0);
        let tilted = run.changes.iter().find(|change| change.before == "at rest").unwrap();
        let late = (tilted.t - tilts).abs();
        // Measured: 1.1e-16 s; 1.3e-8 s (rodas5p) and 4.8e-8 s (radau5) below; 8.9e-16 rad.
        below(&format!("{method} tilts [s]"), late, 1e-15);
        assert_eq!(tilted.after, "left corner", "{method}");
        let last = run.changes.last().unwrap();
        // As the built-in block does.
        let end = (last.t - 4.556_352_399).abs();
        below(&format!("{method} overturns [s]"), end, of(method, [1e-7, 4e-7, 0.0]));
        assert_eq!(last.after, "end", "{method}");
        let over = block()[0] + std::f64::consts::FRAC_PI_4;
        below(&format!("{method} angle [rad]"), (run.y[0] + over).abs(), 8e-15);
    }
}

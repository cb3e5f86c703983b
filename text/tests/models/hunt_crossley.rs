//! The ball of Hunt and Crossley, against the first integral of its contact.
//!
//! Without gravity `m u du = −K δⁿ (1 + a u) dδ`, u = δ̇, a = χ/u_0, so that over a contact
//!
//! ```text
//! K δⁿ⁺¹/((n + 1) m) = G(u_0) − G(u),   a² G(u) = a u − ln(1 + a u)
//! ```
//!
//! It is deepest at u = 0 and leaves with −ε u_0 where `χ − ln(1 + χ) = −χε − ln(1 − χε)`.

use super::arcs::bisect;
use super::runs::{METHODS, Run, below, model, parameter};

const NAME: &str = "hunt_crossley_ball";
const SPEED: f64 = 1.3;

/// Times of the contact's begin and end, speed after it, depth.
fn contact(method: &str, e: f64) -> ([f64; 2], f64, f64) {
    let values = [("g", 0.0), ("x_0", 1e-3), ("v_0", -SPEED), ("e", e)];
    let run = Run::by(&model(NAME, &values), method, 1e-12, 2e-3);
    let times: Vec<f64> = run.changes.iter().map(|change| change.t).collect();
    assert_eq!(run.times_of("flight").len(), 1, "{:?}", run.changes);
    let deepest = run.samples.iter().map(|(_, y)| -y[0]).fold(0.0, f64::max);
    ([times[0], times[1]], run.y[1], deepest)
}

#[test]
fn the_ball_leaves_with_the_speed_of_the_first_integral() {
    for method in METHODS {
        for e in [0.5, 0.8, 0.95] {
            let chi = 1.5 * (1.0 - e);
            let taken = chi - libm::log1p(chi);
            let epsilon =
                bisect(0.0, 1.0 / chi.max(1.0), |x| -chi * x - libm::log1p(-chi * x) > taken);
            let ([begins, _], speed, _) = contact(method, e);
            let off = (speed / SPEED - epsilon).abs();
            let late = (begins - 1e-3 / SPEED).abs();
            // Measured: 1.9e-10 (radau5; 2.3e-11 of the others) and 3.3e-19 s.
            below(&format!("{method} {e} speed"), off, 1e-9);
            below(&format!("{method} {e} begin [s]"), late, 3e-18);
        }
    }
}

#[test]
fn the_ball_is_as_deep_as_the_first_integral_says() {
    let [m, k, n] = ["m", "K", "n"].map(|name| parameter(NAME, name));
    for e in [0.5, 0.8, 0.95] {
        let chi = 1.5 * (1.0 - e);
        let taken = (chi - libm::log1p(chi)) / (chi * chi);
        let exact = libm::pow((n + 1.0) * m * SPEED * SPEED / k * taken, 1.0 / (n + 1.0));
        let (_, _, found) = contact("rk45", e);
        // The deepest of the steps. Measured: 9.3e-6.
        let short = 1.0 - found / exact;
        below(&format!("{e} deepest step"), short, 9e-5);
        assert!(short > -1e-12, "{short:e}");
    }
}

/// `T = 2 √π Γ(1 + p)/Γ(½ + p) δ_max/u`, p = 1/(n + 1): K. L. Johnson, *Contact Mechanics* (1985), for n = 3/2.
#[test]
fn an_elastic_contact_lasts_as_long_as_hertz_says() {
    let [m, k, n] = ["m", "K", "n"].map(|name| parameter(NAME, name));
    let p = 1.0 / (n + 1.0);
    let deepest = libm::pow(0.5 * (n + 1.0) * m * SPEED * SPEED / k, p);
    let gamma = libm::tgamma(1.0 + p) / libm::tgamma(0.5 + p);
    let exact = 2.0 * std::f64::consts::PI.sqrt() * gamma * deepest / SPEED;
    for method in METHODS {
        let ([begins, ends], speed, _) = contact(method, 1.0);
        // Measured: 2.3e-11 and 2.1e-10 (radau5; 4.9e-12 and 2.5e-11 of the others).
        below(&format!("{method} time"), ((ends - begins) / exact - 1.0).abs(), 2e-10);
        below(&format!("{method} speed"), (speed / SPEED - 1.0).abs(), 2e-9);
    }
}

#[test]
fn each_contact_keeps_its_own_speed_of_impact() {
    // Under gravity each flight is ballistic, and bounces are slower from one to the next by the same factor as long
    // as gravity is nothing beside the contact force.
    let run = Run::by(&model(NAME, &[]), "taylor", 1e-11, 2.0);
    let g = parameter(NAME, "g");
    let begins = run.times_of("contact");
    let ends = run.times_of("flight");
    assert!(begins.len() > 2, "{:?}", run.changes);
    let fall = (2.0 * parameter(NAME, "x_0") / g).sqrt();
    // Measured: 0, and 5.1e-4 below.
    below("fall [s]", (begins[0] - fall).abs(), 1e-15);
    let chi = 1.5 * (1.0 - parameter(NAME, "e"));
    let taken = chi - libm::log1p(chi);
    let epsilon = bisect(0.0, 1.0, |x| -chi * x - libm::log1p(-chi * x) > taken);
    let mut speed = g * fall;
    for (end, begin) in ends.iter().zip(&begins[1..]) {
        let next = 0.5 * g * (begin - end);
        below("ratio of speeds", (next / speed - epsilon).abs(), 5e-3);
        speed = next;
    }
}

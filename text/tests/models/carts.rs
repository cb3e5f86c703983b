//! The row of carts, against an exact computation from collision to collision.

use super::runs::{METHODS, Run, balance, below, distance, latest, model, of, parameter, t_end};

const NAME: &str = "carts";

/// Carts in free motion since `t`: `x = x_0 cos ωs + (v_0/ω) sin ωs`.
struct Row {
    omega: f64,
    gap: f64,
    e: f64,
    t: f64,
    x: Vec<f64>,
    v: Vec<f64>,
}

impl Row {
    fn new(n: usize) -> Self {
        let [k, m, gap] = ["k", "m", "gap"].map(|name| parameter(NAME, name));
        let (e, v_0) = (parameter(NAME, "e"), parameter(NAME, "v_0"));
        let v = (1..=n).map(|i| v_0 * libm::sin((i * i) as f64)).collect();
        Self { omega: (k / m).sqrt(), gap, e, t: 0.0, x: vec![0.0; n], v }
    }

    /// How long until carts i and i + 1 touch: `x_i − x_(i+1) = P cos(ωs − φ)` rises to the gap at ωs − φ = −acos(gap/P).
    fn time_to_touch(&self, i: usize) -> f64 {
        let (q, rate) = (self.x[i] - self.x[i + 1], (self.v[i] - self.v[i + 1]) / self.omega);
        let p = libm::hypot(q, rate);
        if p <= self.gap {
            return f64::INFINITY;
        }
        let phase = libm::atan2(rate, q) - libm::acos(self.gap / p);
        phase.rem_euclid(2.0 * std::f64::consts::PI) / self.omega
    }

    fn advance(&mut self, s: f64) {
        let (sin, cos) = libm::sincos(self.omega * s);
        for (x, v) in self.x.iter_mut().zip(&mut self.v) {
            (*x, *v) = (*x * cos + *v / self.omega * sin, *v * cos - *x * self.omega * sin);
        }
        self.t += s;
    }

    /// All collisions up to `t_end`: time and the cart on the left; the row is then at `t_end`.
    fn follow(&mut self, t_end: f64) -> Vec<(f64, usize)> {
        let mut collisions = Vec::new();
        loop {
            let times = (0..self.x.len() - 1).map(|i| (self.time_to_touch(i), i));
            let (s, i) = times.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            if self.t + s > t_end {
                self.advance(t_end - self.t);
                return collisions;
            }
            self.advance(s);
            // Relative to the centre of both, which goes on.
            let (centre, half) =
                (0.5 * (self.v[i] + self.v[i + 1]), 0.5 * (self.v[i] - self.v[i + 1]));
            (self.v[i], self.v[i + 1]) = (centre - self.e * half, centre + self.e * half);
            collisions.push((self.t, i));
        }
    }
}

#[test]
fn every_collision_of_fifty_carts_is_found_in_its_order() {
    let mut row = Row::new(50);
    let collisions = row.follow(t_end(NAME));
    let exact: Vec<f64> = collisions.iter().map(|collision| collision.0).collect();
    let model = model(NAME, &[]);
    for method in METHODS {
        let run = Run::by(&model, method, 1e-10, t_end(NAME));
        let times: Vec<f64> = run.changes.iter().map(|change| change.t).collect();
        let late = latest(&times, &exact);
        let end: Vec<f64> = row.x.iter().chain(&row.v).copied().collect();
        let off = distance(&model, &run.y, &end);
        // Measured: 1.5e-12 s and 1.2e-11 (dop853); 6.8e-10 s and 3.8e-9 (radau5).
        below(
            &format!("{method} {} collisions [s]", exact.len()),
            late,
            of(method, [1e-11, 6e-9, 0.0]),
        );
        below(&format!("{method} end"), off, of(method, [1e-10, 3e-8, 0.0]));
    }
}

#[test]
fn the_number_of_carts_is_a_parameter() {
    let mut row = Row::new(3);
    let collisions = row.follow(t_end(NAME));
    let run = Run::by(&model(NAME, &[("n", 3.0)]), "taylor", 1e-12, t_end(NAME));
    let exact: Vec<f64> = collisions.iter().map(|collision| collision.0).collect();
    let times: Vec<f64> = run.changes.iter().map(|change| change.t).collect();
    assert!(!exact.is_empty());
    // Measured: 3.7e-15 s.
    below("three carts [s]", latest(&times, &exact), 3e-14);
}

#[test]
fn elastic_carts_keep_their_energy() {
    let own = balance(&model(NAME, &[("e", 1.0)]), "dop853", 1e-11, t_end(NAME));
    // Measured: 2.2e-14.
    below("energy", (own.dissipated.abs() + own.residual.abs()) / own.kinetic, 2e-13);
}

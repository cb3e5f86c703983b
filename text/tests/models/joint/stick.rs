//! Sticking, which the golden runs do not do: a joint with more friction, against the equations of motion solved as a
//! linear system.

use deltazero_solvers::Grid;
use deltazero_text::TextModel;

use super::super::runs::{Run, below, parameter, parts, setting};

/// Enough friction for the first joint to stick.
const MU: f64 = 5.0;

/// What the struts of a joint weigh: sums over their rows of the displacement table, arms in lengths of a strut.
struct Struts {
    /// M_x, M_y.
    masses: [f64; 2],
    /// S_x, S_y.
    moments: [f64; 2],
    /// I_0, I_c.
    inertia: [f64; 2],
    /// c, r, K, D.
    contact: [f64; 4],
}

impl Struts {
    /// Struts 1, 2, 3, 5, 6 at joint 1.
    fn of_joint_1() -> Self {
        let [l, density, radius] =
            ["l", "density", "radius"].map(|own| parameter("paper_joint", own));
        let m = density * std::f64::consts::PI * radius * radius * l;
        let j = 0.5 * m * radius * radius;
        // S_x = m l (1/2 + 3/2 + 2 + 1/2 + 3/2), I_c = m l² (2 + 4 + 2)
        Self {
            masses: [5.0 * m, 4.0 * m],
            moments: [6.0 * m * l, 2.0 * m * l],
            inertia: [m * l * l + 4.0 * j, 8.0 * m * l * l],
            contact: ["c", "r", "K", "D"].map(|own| parameter("paper_joint", own)),
        }
    }

    /// Ẍ, Ÿ, θ̈ under a force on the pin and a torque, by elimination in the mass matrix.
    fn accelerations(&self, y: &[f64], force: [f64; 2], torque: f64) -> [f64; 3] {
        let (sin, cos) = libm::sincos(y[2]);
        let turn = y[5] * y[5];
        let ([m_x, m_y], [s_x, s_y], [i_0, i_c]) = (self.masses, self.moments, self.inertia);
        let [a, b] = [s_x * cos, -s_y * sin];
        let right = [
            s_x * sin * turn + force[0],
            s_y * cos * turn + force[1],
            i_c * sin * cos * turn + torque,
        ];
        let left = i_0 + i_c * cos * cos - a * a / m_x - b * b / m_y;
        let theta = (right[2] - a / m_x * right[0] - b / m_y * right[1]) / left;
        [(right[0] - a * theta) / m_x, (right[1] - b * theta) / m_y, theta]
    }

    /// v_T, and v̇_T in slip+ and slip−.
    fn sliding(&self, y: &[f64]) -> [f64; 3] {
        let [c, r, k, d] = self.contact;
        let rho = libm::hypot(y[0], y[1]);
        let n = [y[0] / rho, y[1] / rho];
        let rate = n[0] * y[3] + n[1] * y[4];
        let normal = k * (rho - c) + d * rate;
        let along = n[1] * y[3] - n[0] * y[4];
        let v_t_dot = |sigma: f64| {
            let torque = 1.0 - sigma * MU * normal * r;
            let [a_x, a_y, turn] = self.accelerations(y, [-n[0] * normal, -n[1] * normal], torque);
            n[1] * a_x - n[0] * a_y - along * rate / rho + turn * r
        };
        [along + y[5] * r, v_t_dot(1.0), v_t_dot(-1.0)]
    }
}

/// The first joint with that friction.
fn joint() -> TextModel {
    parts("paper_joint", &[("mu", MU)]).swap_remove(0)
}

#[test]
fn a_joint_sticks_where_both_slips_lead_back_and_until_one_does_not() {
    let (struts, c) = (Struts::of_joint_1(), parameter("paper_joint", "c"));
    // Pressed by 100 N, and sliding slowly, both ways.
    for speed in [1e-5, -1e-5] {
        for method in ["rk45", "vern98", "taylor", "radau5"] {
            let start = [2e-3 * (c + 1e-5), -c - 1e-5, 0.005, -speed, 0.0, 0.0];
            let setting = setting(method, 1e-10);
            let run = Run::from(&joint(), &start, &setting, 2e-3, Grid::Steps);
            let modes: Vec<_> = run.changes.iter().map(|change| change.after.as_str()).collect();
            let first = if speed > 0.0 { "slip+" } else { "slip-" };
            assert_eq!(modes, [first, "stick", "slip+", "free"], "{method}");
            let [begins, ends] = [1, 2].map(|i| run.changes[i].t);
            let sticks = run.samples.iter().filter(|(t, _)| (begins..=ends).contains(t));
            let sliding: Vec<_> = sticks.map(|(t, y)| (*t, struts.sliding(y))).collect();
            for (t, [_, plus, minus]) in &sliding {
                let holds = *plus <= 1e-9 && 0.0 <= *minus;
                assert!(holds, "{method} at {t}: {plus} {minus}");
            }
            let most = sliding.iter().map(|(_, [v_t, ..])| v_t.abs()).fold(0.0, f64::max);
            let last = sliding.last().unwrap().1[1].abs();
            // Measured: 1.5e-17 m/s (radau5) and 6.6e-15 m/s².
            below(&format!("{method} sliding while it sticks [m/s]"), most, 1e-16);
            below(&format!("{method} beyond the end of sticking [m/s²]"), last, 6e-14);
        }
    }
}

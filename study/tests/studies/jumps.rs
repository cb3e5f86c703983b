//! Errors of runs whose states jump.

use deltazero_solvers::problems::BouncingBall;
use deltazero_solvers::{Next, Real, System};
use deltazero_study::Subject;
use deltazero_study::problem::{Problem, Quantity};
use deltazero_study::setting::Events;

use crate::common::{plan, study};

/// An oscillator that is kicked at each whole second: `ẍ = −x`, `v⁺ = v⁻ + 1`.
#[derive(Clone)]
struct Kicked;

impl System for Kicked {
    type Mode = u8;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> u8 {
        1
    }

    fn rhs<S: Real>(&self, _n: u8, _t: S, &[x, v]: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [v, -x];
    }

    fn guards<S: Real>(&self, n: u8, t: S, _y: &[S; 2], g: &mut [S; 1]) {
        *g = [-t + f64::from(n)];
    }

    fn guard_bounds(&self, _n: u8, _t: f64, _y: &[f64; 2], bounds: &mut [f64; 1]) {
        *bounds = [1e-14];
    }

    fn transition<S: Real>(&self, n: u8, _guard: usize, _t: S, y: &mut [S; 2]) -> Next<u8> {
        y[1] = y[1] + 1.0;
        Next::Mode(n + 1)
    }
}

impl Problem for Kicked {
    fn start(&self) -> [f64; 2] {
        [0.0, 1.0]
    }

    fn states(&self) -> Vec<Quantity> {
        ["x", "v"].map(|name| Quantity::new(name, "", 1.0)).to_vec()
    }
}

#[test]
fn a_sample_at_a_jump_is_not_compared_across_it() {
    // Every hundredth sample is at a kick, to rounding.
    let rtols: Vec<f64> = (6..=12).map(|n| 10_f64.powi(-n)).collect();
    let plan = plan(&["rk45", "dop853", "taylor"], &[Events::Located], &rtols, &[], 6.0);
    let study = study(&Subject::of(Kicked), &plan);
    assert_eq!(study.reference.parts[0].horizon_s, 6.0);
    for row in &study.rows {
        let (e, rtol) = (row.e.unwrap(), row.rtol.unwrap());
        assert!(e < 100.0 * rtol, "{} at {rtol:e}: {e:e}", row.method);
        // The oscillator has no energies.
        assert_eq!(row.errors.dissipated_j, None);
    }
}

#[test]
fn a_run_that_ends_at_a_jump_is_not_compared_across_it() {
    // It drops for 1 s and rises for another: the second impact is at 3 s, for one run before the end, for another after it.
    let ball = BouncingBall { restitution: 1.0, gravity: 9.81, height: 4.905 };
    let rtols: Vec<f64> = (4..=12).map(|n| 10_f64.powi(-n)).collect();
    let methods = ["rk45", "dop853", "vern98", "radau5", "taylor", "bdf"];
    let plan = plan(&methods, &[Events::Located], &rtols, &[], 3.0);
    let study = study(&Subject::of(ball), &plan);
    assert_eq!(study.reference.parts[0].horizon_s, 3.0);
    let mut of_end = [0, 0];
    for row in &study.rows {
        let (e, rtol) = (row.e.unwrap(), row.rtol.unwrap());
        assert!(e < rtol && row.events_are_right(), "{} at {rtol:e}: {e:e}", row.method);
        // Where both have bounced, or none has, the end can be compared.
        assert!(row.errors.e_final.is_none_or(|e| e < rtol), "{} at {rtol:e}", row.method);
        of_end[usize::from(row.errors.e_final.is_some())] += 1;
    }
    assert!(of_end[0] > 5 && of_end[1] > 5, "{of_end:?}");
}

//! Each breach by a model that has it.

use super::*;
use crate::system::Next;
use crate::{Control, Grid, Integration, Method, Run, Tolerance, Trajectory};

/// What a model does not keep.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Broken {
    Nothing,
    Together,
    Jacobian,
    /// An entry of a state that is not there.
    Outside,
    TimeDerivative,
    GuardSpan,
    Length,
    Turning,
    Value,
}

/// A point on a spring to a ring, beside a pendulum whose support it shakes.
struct Ring(Broken);

impl Ring {
    fn is(&self, broken: Broken) -> bool {
        self.0 == broken
    }
}

impl System for Ring {
    type Mode = ();
    type State<S: Real> = [S; 6];
    type Guards<S: Real> = [S; 2];

    fn initial_mode(&self, _t: f64, _y: &[f64; 6]) {}

    fn rhs<S: Real>(&self, (): (), t: S, y: &[S; 6], dydt: &mut [S; 6]) {
        let [x, z, theta, v_x, v_z, omega] = *y;
        let v = if self.is(Broken::Length) { [v_x * 2.0, v_z] } else { [v_x, v_z] };
        let length = S::length([x, z], v);
        let pull = -((length.rho.value - 1.0) + length.rate * 0.1).over(&length.rho);
        let held = if self.is(Broken::Value) { S::cst(x.value()) } else { x };
        let shaken = [pull * held + t.sin(), pull * z];
        let turning = S::turning([S::cst(0.5), S::cst(0.2)], [theta, omega]);
        let theta_dd = -turning.sin - omega * 0.1;
        let told = if self.is(Broken::Turning) { theta_dd * 2.0 } else { theta_dd };
        let [a_x, a_z] = S::less_turning(shaken, turning, told);
        *dydt = [v_x, v_z, omega, a_x, a_z, theta_dd];
    }

    fn guards<S: Real>(&self, (): (), _t: S, &[x, z, ..]: &[S; 6], g: &mut [S; 2]) {
        *g = [x + 9.0, x + z * 2.0 + 9.0];
    }

    fn rhs_with_guards<S: Real>(
        &self,
        (): (),
        t: S,
        y: &[S; 6],
        dydt: &mut [S; 6],
        g: &mut [S; 2],
    ) -> bool {
        self.rhs((), t, y, dydt);
        self.guards((), t, y, g);
        if self.is(Broken::Together) {
            g[1] = g[1] * 0.5;
        }
        true
    }

    fn guard_span(&self) -> usize {
        if self.is(Broken::GuardSpan) { 1 } else { 2 }
    }

    fn jacobian(&self, (): (), t: f64, y: &[f64; 6], mut entry: impl FnMut(usize, usize, f64)) {
        if self.is(Broken::Outside) {
            entry(0, 6, 1.0);
        }
        let is_wrong = self.is(Broken::Jacobian);
        differentiated(self, (), t, y, |i, j, d| {
            if !(is_wrong && [i, j] == [5, 2]) {
                entry(i, j, d);
            }
        });
    }

    fn time_derivative(&self, (): (), t: f64, _y: &[f64; 6], dfdt: &mut [f64; 6]) {
        *dfdt = [0.0; 6];
        if !self.is(Broken::TimeDerivative) {
            dfdt[3] = libm::cos(t);
        }
    }

    fn transition<S: Real>(&self, (): (), _: usize, _t: S, _y: &mut [S; 6]) -> Next<()> {
        Next::Stop
    }
}

const START: [f64; 6] = [1.1, -0.4, 0.3, 0.7, -0.2, 0.5];

fn breach(broken: Broken) -> Option<Breach> {
    check(&Ring(broken), &(), 0.3, &START).err()
}

#[test]
fn a_promise_that_is_not_kept_is_told() {
    assert_eq!(breach(Broken::Nothing), None);
    assert_eq!(breach(Broken::Together), Some(Breach::Together));
    let found = breach(Broken::Jacobian);
    assert!(matches!(found, Some(Breach::Jacobian { entry: [5, 2], told: 0.0, .. })), "{found:?}");
    let outside = Breach::Jacobian { entry: [0, 6], told: 1.0, derivative: 0.0 };
    assert_eq!(breach(Broken::Outside), Some(outside));
    let found = breach(Broken::TimeDerivative);
    assert!(matches!(found, Some(Breach::TimeDerivative { state: 3, told: 0.0, .. })), "{found:?}");
    let span = Breach::GuardSpan { guard: 1, states: [0, 1] };
    assert_eq!(breach(Broken::GuardSpan), Some(span));
    for broken in [Broken::Length, Broken::Turning] {
        let found = breach(broken);
        assert!(matches!(found, Some(Breach::Series { .. })), "{broken:?}: {found:?}");
    }
    let found = breach(Broken::Value);
    assert!(matches!(found, Some(Breach::Value { state: 3, .. })), "{found:?}");
}

/// `ẏ = −y`, by a number or not, beside a constant slope.
struct Decay {
    loses_its_derivative: bool,
}

impl System for Decay {
    type Mode = ();
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 0];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) {}

    fn rhs<S: Real>(&self, (): (), _t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        let held = if self.loses_its_derivative { S::cst(y[0].value()) } else { y[0] };
        *dydt = [-held, S::cst(1.0)];
    }

    fn guards<S: Real>(&self, (): (), _t: S, _y: &[S; 2], _g: &mut [S; 0]) {}

    fn transition<S: Real>(&self, (): (), _: usize, _t: S, _y: &mut [S; 2]) -> Next<()> {
        Next::Stop
    }
}

#[test]
fn a_derivative_is_missed_where_no_other_one_is_left() {
    for y in [[1.0, 0.0], [-1e-6, 3.0], [1e9, 1e-9], [0.0, 1.0]] {
        let kept = Decay { loses_its_derivative: false };
        assert_eq!(check(&kept, &(), 0.5, &y), Ok(()), "{y:?}");
        let found = check(&Decay { loses_its_derivative: true }, &(), 0.5, &y);
        // Where nothing decays nothing is missed.
        assert_eq!(found.is_ok(), y[0] == 0.0, "{y:?}: {found:?}");
    }
}

#[test]
fn a_run_tells_when_a_promise_was_not_kept() {
    for (broken, is_kept) in [(Broken::Nothing, true), (Broken::Value, false)] {
        let ring = Ring(broken);
        let tolerance = Tolerance { rtol: 1e-6, atol: vec![1e-6; 6] };
        let method = Method::named("rk45").unwrap();
        let mut solver = method.solver(&ring, Control::Adaptive(tolerance)).unwrap();
        let mut record = (Trajectory::on(Grid::Times(vec![])), Checked::new(&ring));
        let mut integration = Integration::new(&ring, 0.0, START);
        integration.run(1.0, &mut *solver, &mut record).unwrap();
        assert_eq!(record.1.breach().is_none(), is_kept);
    }
}

/// A spring `ẋ = v, v̇ = −x` that is met at 0.6 and thrown back with 0.8 of its speed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Thrown {
    Rightly,
    /// By a guard or a transition that took a number by its value.
    ByGuard,
    ByTransition,
}

impl System for Thrown {
    type Mode = bool;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 2];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> bool {
        true
    }

    fn rhs<S: Real>(&self, _: bool, _t: S, &[x, v]: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [v, -x];
    }

    fn guards<S: Real>(&self, rises: bool, t: S, &[x, _]: &[S; 2], g: &mut [S; 2]) {
        let t = if *self == Self::ByGuard { S::cst(t.value()) } else { t };
        // The other one bends at x = 0.3.
        *g = [if rises { -x + 0.6 } else { S::cst(1.0) }, (t - 0.5) * (t - 0.5) + (x - 0.3).abs()];
    }

    fn transition<S: Real>(&self, _: bool, _: usize, _t: S, y: &mut [S; 2]) -> Next<bool> {
        let v = if *self == Self::ByTransition { S::cst(y[1].value()) } else { y[1] };
        y[1] = (-v * 0.8).min(S::cst(0.0));
        Next::Mode(false)
    }
}

#[test]
fn a_value_in_a_guard_or_a_transition_is_told() {
    for (thrown, guard) in [(Thrown::Rightly, None), (Thrown::ByGuard, Some(1))] {
        for y in [[0.2, 0.7], [0.3, 0.7], [-1e-6, 1e-3]] {
            let found = check(&thrown, &true, 0.1, &y).err();
            let told = found.as_ref().map(|breach| match breach {
                Breach::ValueOfGuard { guard, .. } => *guard,
                other => panic!("{other}"),
            });
            assert_eq!(told, guard, "{y:?}: {found:?}");
        }
    }
    for (thrown, is_kept) in [(Thrown::Rightly, true), (Thrown::ByTransition, false)] {
        assert_eq!(check(&thrown, &true, 0.1, &[0.3, 0.7]), Ok(()));
        let mut checked = Checked::new(&thrown);
        Run::of(&thrown, [0.0, 1.0]).tolerance(1e-8, 1e-8).record(&mut checked).to(1.5).unwrap();
        let breach = checked.breach().map(|(.., breach)| breach);
        let is_told = matches!(breach, Some(Breach::ValueOfTransition { guard: 0, state: 1, .. }));
        assert_eq!((breach.is_none(), is_told), (is_kept, !is_kept), "{breach:?}");
    }
}

/// `ẏ = b + sin(100 t)`, and a guard of roots that have no slope at zero.
struct Ripple(f64);

impl System for Ripple {
    type Mode = ();
    type State<S: Real> = [S; 3];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 3]) {}

    fn rhs<S: Real>(&self, (): (), t: S, _y: &[S; 3], dydt: &mut [S; 3]) {
        *dydt = [(t * 100.0).sin() + self.0, S::cst(0.0), S::cst(0.0)];
    }

    fn guards<S: Real>(&self, (): (), _t: S, y: &[S; 3], g: &mut [S; 1]) {
        *g = [y[1].sqrt() + y[2].sqrt() + 1.0];
    }

    fn guard_span(&self) -> usize {
        2
    }

    fn transition<S: Real>(&self, (): (), _: usize, _t: S, _y: &mut [S; 3]) -> Next<()> {
        Next::Stop
    }
}

#[test]
fn a_ripple_on_a_large_slope_and_a_derivative_that_is_no_number_are_no_breach() {
    for b in [0.0, 1e3, 1e5, 1e7, 1e9, 1e12] {
        for k in 0..100 {
            let t = 1e-3 * f64::from(k) * f64::from(k);
            assert_eq!(check(&Ripple(b), &(), t, &[b, 0.0, 0.0]), Ok(()), "{b:e} {t}");
        }
    }
}

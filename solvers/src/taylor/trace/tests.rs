//! Tests of traced series against series of one order at a time.

use std::cell::Cell;

use super::super::expand::{Expansion, SeriesField};
use super::super::guards::GuardSeries;
use super::super::rows::MAX_ORDER;
use super::super::series::Series;
use super::super::series::tests::{enough_rows, operations};
use super::*;
use crate::real::Functions;
use crate::system::Next;

/// Largest difference of coefficients of order `k` of functions whose series converge within 0.7. Measured: a quarter of it.
fn bound(k: usize) -> f64 {
    1e-14 * f64::powi(0.7, -(k as i32))
}

/// Every operation.
struct Operations;

impl Functions<1, 11> for Operations {
    fn of<S: Real>(&self, [x]: [S; 1]) -> [S; 11] {
        operations(x)
    }
}

/// Operations of multiples, and decisions.
struct OfMultiples;

impl Functions<1, 8> for OfMultiples {
    fn of<S: Real>(&self, [x]: [S; 1]) -> [S; 8] {
        let (half, double) = (x * 0.5, x * 2.0 + 0.1);
        [
            x / double + half / (-double),
            half.sqrt() + double.powf(1.5) + half.powf(-2.5),
            (half + 1.0).powf(0.0) + half.powf(4.0),
            half.exp() + double.ln(),
            half.sin_cos().0 - double.sin_cos().1,
            if half.value() > 0.3 { double } else { half * half },
            if half.value() < 0.4 { double * half } else { half },
            S::cst(3.0) * half * double - S::cst(1.0) / half,
        ]
    }
}

/// Compares the coefficients of functions of time about `t` by a trace with those of series.
fn compare<F: Functions<1, N>, const N: usize>(functions: &F, t: f64) {
    let (mut trace, mut own) = (Trace::<f64>::default(), [0.0; N]);
    let (time, []) = trace.start(t, &[]);
    trace.end(&[], &functions.of([time]), &mut own);
    assert_eq!(own, functions.of([t]), "values are those of f64 to the bit");
    let rows = enough_rows();
    for k in 0..=MAX_ORDER {
        if k > 0 {
            trace.advance(k, &[], true);
            trace.write_guards(&mut own);
        }
        let n = Cell::new(0);
        let x = Series::new(rows.table(&n, k), [t, 1.0, 0.0][k.min(2)]);
        let other = functions.of([x]).map(|series| series.coefficient(k));
        for (i, (own, other)) in own.iter().zip(other).enumerate() {
            assert!((own - other).abs() < bound(k), "{i}, order {k}: {own:e} for {other:e}");
        }
    }
}

#[test]
fn operations_have_the_coefficients_of_one_order_at_a_time() {
    compare(&Operations, 0.7);
    compare(&OfMultiples, 0.7);
}

#[test]
fn a_root_at_zero_has_no_finite_coefficients() {
    let (mut trace, mut own) = (Trace::<f64>::default(), [0.0]);
    let (time, []) = trace.start(0.0, &[]);
    trace.end(&[], &[time.sqrt()], &mut own);
    trace.advance(1, &[], true);
    trace.write_guards(&mut own);
    assert_eq!(own, [f64::INFINITY]);
}

/// What a [`Swing`] is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// A point on a spring about a moving centre.
    Curve,
    /// A pendulum: the last result that its slopes need is a sine.
    Sine,
    /// The last result that its slopes need is a length, which needs later ones.
    Length,
}

/// A motion. Slopes and guards share the sine; the guards need a
/// [length](Shortcuts::length) besides, and a curve.
struct Swing {
    /// Evaluations of the right-hand side.
    n_rhs: Cell<usize>,
}

impl System for Swing {
    type Mode = Kind;
    type State<S: Real> = [S; 6];
    type Guards<S: Real> = [S; 4];

    const IS_TRACED: bool = true;

    fn initial_mode(&self, _t: f64, _y: &[f64; 6]) -> Kind {
        Kind::Curve
    }

    fn rhs<S: Real>(&self, kind: Kind, t: S, y: &[S; 6], dydt: &mut [S; 6]) {
        self.n_rhs.set(self.n_rhs.get() + 1);
        let [x, y, theta, v_x, v_y, omega] = *y;
        let none = S::cst(0.0);
        if kind == Kind::Sine {
            *dydt = [v_x, v_y, omega, none, S::cst(-1.0), theta.sin_cos().0 * -1.5];
            return;
        }
        if kind == Kind::Length {
            let rho = S::length([x, y], [v_x, v_y]).rho.value;
            *dydt = [v_x, v_y, omega, none, rho * -1.5, none];
            return;
        }
        let curve = S::turning([S::cst(0.4), S::cst(-0.3)], [theta, omega]);
        let torque = curve.along[0] * v_y - t * curve.sin + curve.rates[1];
        let [a_x, a_y] = S::less_turning([x * -4.0, y / (x + 3.0)], curve, torque);
        *dydt = [v_x, v_y, omega, a_x, a_y, torque];
    }

    fn guards<S: Real>(&self, kind: Kind, t: S, y: &[S; 6], g: &mut [S; 4]) {
        let length = S::length([y[0], y[1]], [y[3], y[4]]);
        let sin = y[2].sin_cos().0;
        let ratio = if kind == Kind::Sine { sin } else { y[3].over(&length.rho) + t };
        *g = [length.rho.value, length.rho.value + sin * length.rate, ratio, S::cst(1.0)];
    }

    fn guard_bounds(&self, _kind: Kind, _t: f64, _y: &[f64; 6], bounds: &mut [f64; 4]) {
        *bounds = [1e-15; 4];
    }

    fn transition<S: Real>(&self, _: Kind, _: usize, _t: S, _y: &mut [S; 6]) -> Next<Kind> {
        Next::Stop
    }
}

/// The same field, one order at a time.
struct AtOnce<'a>(InMode<'a, Swing>);

impl<B: Coefficient> SeriesField<Swing, B> for AtOnce<'_> {
    fn slope<'s>(&self, t: Series<'s, B>, y: &[Series<'s, B>; 6], dydt: &mut [Series<'s, B>; 6]) {
        self.0.slope(t, y, dydt);
    }

    fn guards<'s>(&self, t: Series<'s, B>, y: &[Series<'s, B>; 6], g: &mut [Series<'s, B>; 4]) {
        SeriesField::guards(&self.0, t, y, g);
    }

    fn slope_with_guards<'s>(
        &self,
        t: Series<'s, B>,
        y: &[Series<'s, B>; 6],
        dydt: &mut [Series<'s, B>; 6],
        g: &mut [Series<'s, B>; 4],
    ) -> bool {
        self.0.slope_with_guards(t, y, dydt, g)
    }
}

/// The coefficients of states and guards from `start` on, the guards to the fifth order with the states, then alone.
struct Coefficients<B: Copy> {
    y: Vec<[B; 6]>,
    g: Vec<[f64; 4]>,
    alone: Vec<[f64; 4]>,
}

fn series<B: Coefficient<Rounded = f64>>(
    field: &impl SeriesField<Swing, B>,
    expansion: &mut Expansion<B>,
    start: [f64; 6],
) -> Coefficients<B> {
    let (t, mut y) = (B::cst(0.2), vec![[B::cst(0.0); 6]; MAX_ORDER + 1]);
    let mut g = vec![[0.0; 4]; 6];
    y[0] = start.map(B::cst);
    let (first, rest) = y.split_at_mut(1);
    expansion.begin(field, t, &first[0], &mut rest[0], &mut g[0]);
    expansion.complete(field, t, &mut y, &mut g);
    let mut alone = GuardSeries::<[f64; 4], B>::new(4, MAX_ORDER);
    alone.expand::<Swing, _>(field, t, &y, MAX_ORDER - 1);
    Coefficients { y, g, alone: alone.coefficients()[..MAX_ORDER].to_vec() }
}

fn assert_close<const N: usize>(
    own: &[[f64; N]],
    other: &[[f64; N]],
    bound: impl Fn(usize) -> f64,
) {
    assert_eq!(own.len(), other.len());
    for (k, (own, other)) in own.iter().zip(other).enumerate() {
        for (i, (own, other)) in own.iter().zip(other).enumerate() {
            let off = (own - other).abs();
            assert!(off <= bound(k), "order {k}, {i}: off by {off:e}");
        }
    }
}

/// Asserts that the values are equal to the bit and each coefficient differs by no more than its bound. A trace must forget
/// the one before, which was of another mode.
fn assert_traced_alike<B: Coefficient<Rounded = f64>>(bound_of_states: impl Fn(usize) -> f64) {
    let [mut traced, mut at_once] = [(); 2].map(|()| Expansion::<B>::default());
    let starts = [[1.1, 0.3, 0.5, -0.2, 0.7, 0.9], [0.8, -0.9, 0.0, 0.4, 0.1, -1.3]];
    for (mode, start) in [Kind::Curve, Kind::Sine, Kind::Length, Kind::Curve]
        .into_iter()
        .zip(starts.into_iter().cycle())
    {
        let swing = Swing { n_rhs: Cell::new(0) };
        let field = || InMode { problem: &swing, mode: &mode };
        let own = series::<B>(&field(), &mut traced, start);
        assert_eq!(swing.n_rhs.get(), 1, "one evaluation for all orders");
        let other = series::<B>(&AtOnce(field()), &mut at_once, start);
        let off: Vec<[f64; 6]> = own
            .y
            .iter()
            .zip(&other.y)
            .map(|(own, other)| std::array::from_fn(|i| (own[i] - other[i]).value()))
            .collect();
        let none = vec![[0.0; 6]; off.len()];
        assert_close(&off, &none, |k| if k < 2 { 0.0 } else { bound_of_states(k) });
        let of_guards = |k| if k == 0 { 0.0 } else { bound(k) };
        assert_close(&own.g, &other.g, of_guards);
        assert_close(&own.alone, &other.alone, of_guards);
    }
}

#[test]
fn a_system_has_the_coefficients_of_one_order_at_a_time() {
    assert_traced_alike::<f64>(bound);
    #[cfg(feature = "extended")]
    assert_traced_alike::<crate::double_double::DoubleDouble>(|k| 1e-16 * bound(k));
}

#[test]
#[should_panic(expected = "was not ended")]
#[cfg(debug_assertions)]
fn a_curve_that_is_not_ended_is_refused() {
    let trace = Trace::<f64>::default();
    let (t, []) = trace.start(0.7, &[]);
    use crate::real::Shortcuts as _;
    let curve = Noted::turning([0.3, -1.2].map(Noted::cst), [t * t, t * 2.0]);
    trace.end(&[], &[curve.sin], &mut [0.0]);
}

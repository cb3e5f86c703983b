//! Every function of the language, as a number, a dual number, a pair of numbers and a Taylor series.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

use std::f64::consts::LOG2_E;

use deltazero_solvers::contracts::check;
use deltazero_solvers::double_double::DoubleDouble;
use deltazero_solvers::taylor::ExtendedIntegration;
use deltazero_solvers::{Control, Integration, Method, Outcome, System, Tolerance};
use deltazero_study::Problem;
use deltazero_text::{ModelFile, TextModel};
use num_dual::Dual64;

/// Formulas of t with their integrals from 0 to 1 as sums of two numbers, by quadrature with 60 digits (mpmath 1.3).
const INTEGRALS: &[(&str, (f64, f64))] = &[
    ("atan(3*t - 1)", (0.32358463541788507, -1.462179019577591e-17)),
    ("asin(0.5*t)", (0.2556495831671762, -8.76439733574335e-18)),
    ("acos(0.5*t)", (1.3151467436277204, 1.4485586061853182e-17)),
    ("tanh(2*t)", (0.6625013736789322, -3.279899431047171e-17)),
    ("sinh(3*t - 1)", (0.7397050187561293, -3.520814037481653e-17)),
    ("cosh(2*t)", (1.8134302039235093, 9.645598289176837e-17)),
    ("log10(1 + t)", (0.16776550942471055, 1.1164922857890921e-17)),
    ("tan(t)", (0.6156264703860143, 4.83928788555466e-18)),
    ("atan2(t + 0.5, -1 - t)", (2.5643811590064125, 1.9276693031735875e-16)),
    ("(1 + t)^2.5", (2.9467738568527886, 9.623987415683529e-17)),
    ("hypot(1, t)", (1.147793574696319, -4.078044800136068e-18)),
    ("abs(-1 - t)*sign(-t - 1) + max(t, -3) + min(t, 3)", (-0.5, 0.0)),
    ("(1 + t)^-3", (0.375, 0.0)),
    // With ln 2 as a number of 53 bits, as the file's numbers are.
    ("2^t", (LOG2_E, 1.709648020818622e-18)),
    ("ln(1 + t)*exp(-t)", (0.20842739522915107, -1.0330060493687625e-17)),
    ("-(1 + t)^2^0.5", (-1.793664136789918, -8.681206417321786e-17)),
];

fn vector<S>(n: usize, entry: impl FnMut(usize) -> S) -> Vec<S> {
    (0..n).map(entry).collect()
}

fn model(formulas: &[&str]) -> TextModel {
    let states: String = (0..formulas.len()).map(|i| format!("x{i} = 0.0\n")).collect();
    let formulas: String =
        formulas.iter().enumerate().map(|(i, f)| format!("x{i} = \"{f}\"\n")).collect();
    let text = format!("[states]\n{states}[modes.only.rates]\n{formulas}");
    let file =
        ModelFile::parse("functions.toml", &text).unwrap_or_else(|report| panic!("{report}"));
    file.models(&[]).unwrap().remove(0)
}

fn integrals() -> TextModel {
    let formulas: Vec<_> = INTEGRALS.iter().map(|(formula, _)| *formula).collect();
    model(&formulas)
}

#[test]
fn integrals_by_series_and_by_stages_have_their_closed_forms() {
    let model = integrals();
    // Measured: 8, 27 and 148 steps.
    for (name, most_steps) in [("taylor", 16), ("dop853", 60), ("radau5", 300)] {
        let tolerance = Tolerance { rtol: 1e-13, atol: vec![1e-13; model.dim()] };
        let method = Method::named(name).unwrap();
        let mut solver = method.solver(&model, Control::Adaptive(tolerance)).unwrap();
        let mut run = Integration::new(&model, 0.0, Problem::start(&model));
        assert_eq!(run.run(1.0, &mut *solver, &mut ()), Ok(Outcome::Finished));
        let steps = run.stats.n_accepted;
        assert!(steps < most_steps, "{name}: {steps} steps");
        for ((formula, exact), found) in INTEGRALS.iter().zip(&run.point.y) {
            let error = (found - exact.0).abs();
            // Measured: 2.7e-14 by series, 8.2e-14 by radau5.
            assert!(error < 5e-13, "{name}: {formula} is {found}, off by {error:e}");
        }
    }
}

#[test]
fn integrals_in_extended_precision_have_their_closed_forms() {
    let model = integrals();
    // The tolerances of a reference of the study.
    let tolerance = Tolerance { rtol: 1e-20, atol: vec![1e-20; model.dim()] };
    let mut run = ExtendedIntegration::new(&model, 0.0, &Problem::start(&model), tolerance);
    assert_eq!(run.run(1.0, &mut ()), Ok(Outcome::Finished));
    assert!(run.stats.n_accepted < 26, "{} steps", run.stats.n_accepted);
    for ((formula, exact), found) in INTEGRALS.iter().zip(run.state()) {
        let exact = DoubleDouble::sum(exact.0, exact.1);
        let error = (*found - exact).hi().abs();
        // Measured: 7e-22, from the sine of twofloat.
        assert!(error < 7e-21, "{formula}: {error:e}");
    }
}

/// Formulas of x0 with their values and derivatives.
type Closed = (&'static str, fn(f64) -> [f64; 2]);
const CLOSED: &[Closed] = &[
    ("atan(x0)", |x| [x.atan(), 1.0 / (1.0 + x * x)]),
    ("asin(x0/40)", |x| [(x / 40.0).asin(), 1.0 / (1600.0 - x * x).sqrt()]),
    ("acos(x0/40)", |x| [(x / 40.0).acos(), -1.0 / (1600.0 - x * x).sqrt()]),
    ("tan(x0)", |x| [x.tan(), 1.0 + x.tan() * x.tan()]),
    ("sinh(x0)", |x| [x.sinh(), x.cosh()]),
    ("cosh(x0)", |x| [x.cosh(), x.sinh()]),
    ("tanh(x0)", |x| [x.tanh(), 1.0 / (x.cosh() * x.cosh())]),
    ("abs(x0)", |x| [x.abs(), x.signum()]),
    ("sign(x0)", |x| [x.signum(), 0.0]),
    ("min(x0, 2)", |x| [x.min(2.0), f64::from(u8::from(x < 2.0))]),
    ("max(x0, 2)", |x| [x.max(2.0), f64::from(u8::from(x > 2.0))]),
    ("hypot(x0, 3)", |x| [x.hypot(3.0), x / x.hypot(3.0)]),
    ("atan2(x0, -2)", |x| [x.atan2(-2.0), -2.0 / (4.0 + x * x)]),
    ("atan2(-2, x0)", |x| [(-2.0_f64).atan2(x), 2.0 / (4.0 + x * x)]),
    ("exp(x0/10)", |x| [(x / 10.0).exp(), (x / 10.0).exp() / 10.0]),
    ("log(x0^2)", |x| [(x * x).ln(), 2.0 / x]),
    ("log10(x0^2)", |x| [(x * x).log10(), 2.0 / x / std::f64::consts::LN_10]),
    ("x0^3 - x0^-1", |x| [x * x * x - 1.0 / x, 3.0 * x * x + 1.0 / (x * x)]),
    ("x0^1.5", |x| [x.signum() * x.abs().powf(1.5), 1.5 * x.abs().sqrt()]),
    ("sin(x0)*cos(x0)", |x| [0.5 * (2.0 * x).sin(), (2.0 * x).cos()]),
];

const POINTS: [f64; 10] = [-31.0, -2.5, -0.6, -0.4, -1e-3, 1e-5, 0.3, 0.7, 3.0, 25.0];

#[test]
fn values_and_derivatives_have_their_closed_forms() {
    let formulas: Vec<_> = CLOSED.iter().map(|(formula, _)| *formula).collect();
    let model = model(&formulas);
    let n = model.dim();
    for x in POINTS {
        let y = vector(n, |_| Dual64::new(x, 1.0));
        let mut dual = y.clone();
        let mode = model.initial_mode(0.0, &Problem::start(&model));
        model.rhs(mode, Dual64::from_re(0.0), &y, &mut dual);
        let (plain_y, mut plain) = (vector(n, |_| x), vector(n, |_| 0.0));
        model.rhs(mode, 0.0, &plain_y, &mut plain);
        for (i, (formula, exact)) in CLOSED.iter().enumerate() {
            let found = dual[i];
            // A quotient of dual numbers is rounded twice.
            let apart = (found.re / plain[i] - 1.0).abs();
            assert!(apart < 1e-15, "{formula} at {x}: {apart:e}");
            for (found, exact) in [found.re, found.eps].into_iter().zip(exact(x)) {
                let error = (found - exact).abs() / exact.abs().max(1e-300);
                let error = if exact == 0.0 { found.abs() } else { error };
                // Measured: 4.9e-16.
                assert!(error < 4.9e-15, "{formula} at {x}: {found} against {exact}");
            }
        }
        assert_eq!(check(&model, &mode, 0.0, &plain_y), Ok(()));
    }
}

#[test]
fn whole_powers_of_negative_numbers_have_their_sign() {
    let formulas = ["(t - 1.01)^64", "(t - 1.01)^65", "(t - 1.01)^66", "(t - 1.01)^-66"];
    let (model, y) = (model(&formulas), vector(4, |_| 0.0));
    let mut rates = y.clone();
    model.rhs(model.initial_mode(0.0, &y), 0.0, &y, &mut rates);
    for (rate, p) in rates.iter().zip([64, 65, 66, -66]) {
        let exact = (-1.01_f64).powi(p);
        // Measured: 1.2e-14, of a product of 64 factors.
        assert!((rate / exact - 1.0).abs() < 1e-13, "{p}: {rate:e} for {exact:e}");
    }
}

#[test]
fn what_is_no_number_is_neither_smaller_nor_larger() {
    let formulas = ["max(x0, 1)", "max(1, x0)", "min(x0, 1)", "min(1, x0)"];
    let (model, y) = (model(&formulas), vector(4, |_| f64::NAN));
    let mut rates = vector(4, |_| 0.0);
    model.rhs(model.initial_mode(0.0, &y), 0.0, &y, &mut rates);
    assert!(rates.iter().all(|rate| rate.is_nan()), "{rates:?}");
}

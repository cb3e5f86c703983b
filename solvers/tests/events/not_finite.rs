//! Slopes, guards and arguments that are not finite.

use deltazero_solvers::{Control, Error, Next, Outcome, Real, System};

use crate::log::{ROUNDING, run, settings};
use crate::script::chain;

/// Where a run that ends before its guard breaks does so.
const END: f64 = 0.999;

/// `ẋ = 1`, and beyond x = 1 something is not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Breaks {
    /// The slope of state 1 is not a number.
    Slope,
    /// The slope of state 1 is a number, its derivative by that state infinite where it is zero.
    Derivative,
    /// Guard 1 is this.
    Guard(f64),
    /// The same, and the run ends shortly before.
    GuardBeyondEnd(f64),
}

impl System for Breaks {
    type Mode = &'static str;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 2];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> &'static str {
        "only"
    }

    fn rhs<S: Real>(&self, _: &'static str, _t: S, &[x, z]: &[S; 2], dydt: &mut [S; 2]) {
        let slope = match self {
            Self::Slope => (-x + 1.0).sqrt(),
            Self::Derivative => z.sqrt() + 1.0,
            Self::Guard(_) | Self::GuardBeyondEnd(_) => -z,
        };
        *dydt = [S::cst(1.0), slope];
    }

    fn guards<S: Real>(&self, _: &'static str, _t: S, &[x, _]: &[S; 2], g: &mut [S; 2]) {
        let second = match *self {
            Self::Guard(beyond) | Self::GuardBeyondEnd(beyond) if x.value() > 1.0 => S::cst(beyond),
            _ => S::cst(1.0),
        };
        let first = match self {
            Self::GuardBeyondEnd(_) => -x + END,
            _ => S::cst(1.0),
        };
        *g = [first, second];
    }

    fn guard_bounds(&self, _: &'static str, _t: f64, _y: &[f64; 2], bounds: &mut [f64; 2]) {
        *bounds = [1e-15; 2];
    }

    fn transition<S: Real>(
        &self,
        mode: &'static str,
        guard: usize,
        _t: S,
        _y: &mut [S; 2],
    ) -> Next<&'static str> {
        if guard == 0 { Next::Stop } else { Next::Mode(mode) }
    }
}

#[test]
fn a_slope_that_is_not_a_number_is_an_error_that_names_the_place() {
    for setting in settings() {
        let name = setting.0.name;
        let (_, outcome, t, y) = run(&Breaks::Slope, &setting, (0.0, [0.0; 2]), 2.0);
        let Err(Error::NonFinite { t: at, mode, component: 1 }) = &outcome else {
            panic!("{name}: {outcome:?}");
        };
        assert_eq!((*at, mode.as_str()), (t, "\"only\""), "{name}");
        assert!(t < 1.0 + ROUNDING && y[1].is_finite(), "{name}: {t}");
        // From the very start.
        let (_, outcome, ..) = run(&Breaks::Slope, &setting, (0.0, [1.5, 0.0]), 2.0);
        let expected = matches!(outcome, Err(Error::NonFinite { t: 0.0, component: 1, .. }));
        assert!(expected, "{name}: {outcome:?}");
    }
}

#[test]
fn a_jacobian_that_is_infinite_is_no_obstacle_or_an_error_that_names_the_row() {
    for setting in settings() {
        let (_, outcome, ..) = run(&Breaks::Derivative, &setting, (0.0, [0.0; 2]), 2.0);
        match outcome {
            Ok(Outcome::Finished) | Err(Error::NonFinite { t: 0.0, component: 1, .. }) => {}
            other => panic!("{}: {other:?}", setting.0.name),
        }
    }
}

/// A run into a guard that is `beyond` must fail where it is, and name it.
fn expect_a_bad_guard(beyond: f64) {
    let breaks = Breaks::Guard(beyond);
    for setting in settings() {
        let name = setting.0.name;
        let (_, outcome, t, y) = run(&breaks, &setting, (0.0, [0.0; 2]), 2.0);
        let Err(Error::NonFiniteGuard { t: at, mode, guard: 1 }) = &outcome else {
            panic!("{name}: {outcome:?}");
        };
        assert_eq!(mode, "\"only\"", "{name}");
        assert!(t <= 1.0 + ROUNDING && *at >= 1.0 && y[1].is_finite(), "{name}: {t}, {at}");
        // From the very start.
        let (_, outcome, ..) = run(&breaks, &setting, (0.0, [1.5, 0.0]), 2.0);
        let expected = matches!(outcome, Err(Error::NonFiniteGuard { t: 0.0, guard: 1, .. }));
        assert!(expected, "{name}: {outcome:?}");
    }
}

#[test]
fn a_guard_that_is_not_a_number_is_an_error_that_names_the_place() {
    expect_a_bad_guard(f64::NAN);
}

#[test]
fn a_guard_that_is_infinite_is_an_error_that_names_the_place() {
    expect_a_bad_guard(f64::INFINITY);
    expect_a_bad_guard(f64::NEG_INFINITY);
}

#[test]
fn a_step_beyond_where_a_guard_is_a_number_is_shortened() {
    for beyond in [f64::NAN, f64::INFINITY] {
        for setting in settings() {
            let name = setting.0.name;
            let is_of_diffsol = ["bdf", "tr_bdf2", "esdirk34", "tsit45"].contains(&name);
            let can_be_shortened = matches!(setting.1, Control::Adaptive(_)) && !is_of_diffsol;
            let start = (0.0, [0.0; 2]);
            let (_, outcome, t, _) = run(&Breaks::GuardBeyondEnd(beyond), &setting, start, 2.0);
            match outcome {
                Ok(Outcome::Stopped) => assert!((t - END).abs() < ROUNDING, "{name}: {t}"),
                Err(Error::NonFiniteGuard { guard: 1, .. }) if !can_be_shortened => {}
                other => panic!("{name}: {other:?}"),
            }
        }
    }
}

#[test]
fn a_start_that_is_not_finite_is_refused() {
    for setting in settings() {
        let (_, outcome, ..) = run(&chain(&[]), &setting, (0.0, [0.0, f64::NAN]), 2.0);
        let expected = matches!(outcome, Err(Error::NonFinite { component: 1, .. }));
        assert!(expected, "{outcome:?}");
        let (_, outcome, ..) = run(&chain(&[]), &setting, (0.0, [0.0; 2]), f64::INFINITY);
        assert!(matches!(outcome, Err(Error::BadArgument { name: "t_end", .. })));
    }
}

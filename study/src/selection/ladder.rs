//! The settings of a method as rungs: each asks for an error a quarter of a decade smaller than the one
//! above it.

use std::ops::RangeInclusive;

use deltazero_solvers::Method;

use crate::digits::rounded_to;
use crate::setting::{Accuracy, Atol};

/// Rungs to a decade of the tolerance.
pub(super) const A_DECADE: i32 = 4;
/// Rungs to a decade of a fixed step, whose fourth power the error goes with.
const A_DECADE_OF_STEPS: i32 = 16;
/// The coarsest fixed step is this part of the run; from there the search begins.
const COARSEST_STEP: f64 = 1e-3;
/// The finest fixed step [s]: some 1e12 of them make a run.
const FINEST_STEP: f64 = 1e-12;

/// The tolerance or step of a rung, to two digits.
pub(super) fn accuracy(method: &Method, rung: i32, atol: Option<Atol>) -> Accuracy {
    let value =
        |per_decade: i32| rounded_to(libm::exp10(-f64::from(rung) / f64::from(per_decade)), 2);
    if method.is_fixed_step() {
        Accuracy::Step(value(A_DECADE_OF_STEPS))
    } else {
        Accuracy::Rtol(value(A_DECADE), atol)
    }
}

/// The rungs of a method, the loosest first, for a run to `t_end` [s].
pub(super) fn rungs(method: &Method, t_end: f64) -> RangeInclusive<i32> {
    let of_step = |h: f64| (-f64::from(A_DECADE_OF_STEPS) * libm::log10(h)).round() as i32;
    if method.is_fixed_step() {
        of_step(COARSEST_STEP * t_end)..=of_step(FINEST_STEP)
    } else {
        A_DECADE..=14 * A_DECADE
    }
}

/// Where the search begins: at a tolerance as large as the accuracy, or at the coarsest step, which
/// costs next to nothing.
pub(super) fn first(method: &Method, t_end: f64, accuracy: f64) -> i32 {
    let rungs = rungs(method, t_end);
    if method.is_fixed_step() {
        *rungs.start()
    } else {
        let rung = -f64::from(A_DECADE) * libm::log10(accuracy);
        (rung.round() as i32).clamp(*rungs.start(), *rungs.end())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rungs_are_four_to_a_decade_of_tolerance_and_print_in_two_digits() {
        let rtol = |rung| accuracy(Method::named("rk45").unwrap(), rung, None).to_string();
        let printed: Vec<String> = (24..=28).map(rtol).collect();
        assert_eq!(
            printed,
            ["rtol 1e-6", "rtol 5.6e-7", "rtol 3.2e-7", "rtol 1.8e-7", "rtol 1e-7"]
        );
    }

    #[test]
    fn a_decade_of_error_is_a_quarter_of_a_decade_of_fixed_steps() {
        let rk4 = Method::named("rk4").unwrap();
        let (first, rungs) = (first(rk4, 2.0, 1e-6), rungs(rk4, 2.0));
        assert_eq!(first, *rungs.start());
        let step = |rung| match accuracy(rk4, rung, None) {
            Accuracy::Step(h) => h,
            Accuracy::Rtol(..) => f64::NAN,
        };
        assert!((step(first) / 2e-3 - 1.0).abs() < 0.1);
        assert!((step(first) / step(first + 4) / libm::pow(10.0, 0.25) - 1.0).abs() < 0.1);
    }
}

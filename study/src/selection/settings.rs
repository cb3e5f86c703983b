//! The settings of a method that a contest looks at, by an index: each asks for an error a quarter of a decade smaller than
//! the one before.

use std::ops::RangeInclusive;

use deltazero_solvers::Method;

use crate::digits::rounded_to;
use crate::setting::{Accuracy, Atol};

/// Settings to a decade of the tolerance.
pub(super) const A_DECADE: i32 = 4;
/// Settings to a decade of a fixed step, whose fourth power the error goes with.
const A_DECADE_OF_STEPS: i32 = 16;
/// The coarsest fixed step is this part of the run; from there the search begins.
const COARSEST_STEP: f64 = 1e-3;
/// The finest fixed step [s]: some 1e12 of them make a run.
const FINEST_STEP: f64 = 1e-12;

/// The tolerance or step of the setting with this index, to two digits.
pub(super) fn accuracy(method: &Method, index: i32, atol: Option<Atol>) -> Accuracy {
    let value =
        |per_decade: i32| rounded_to(libm::exp10(-f64::from(index) / f64::from(per_decade)), 2);
    if method.is_fixed_step() {
        Accuracy::Step(value(A_DECADE_OF_STEPS))
    } else {
        Accuracy::Rtol(value(A_DECADE), atol)
    }
}

/// The indices of the settings of a method, the loosest first, for a run to `t_end` [s].
pub(super) fn indices(method: &Method, t_end: f64) -> RangeInclusive<i32> {
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
    let indices = indices(method, t_end);
    if method.is_fixed_step() {
        *indices.start()
    } else {
        let index = -f64::from(A_DECADE) * libm::log10(accuracy);
        (index.round() as i32).clamp(*indices.start(), *indices.end())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_four_to_a_decade_of_tolerance_and_print_in_two_digits() {
        let rtol = |index| accuracy(Method::named("rk45").unwrap(), index, None).to_string();
        let printed: Vec<String> = (24..=28).map(rtol).collect();
        assert_eq!(
            printed,
            ["rtol 1e-6", "rtol 5.6e-7", "rtol 3.2e-7", "rtol 1.8e-7", "rtol 1e-7"]
        );
    }

    #[test]
    fn a_decade_of_error_is_a_quarter_of_a_decade_of_fixed_steps() {
        let rk4 = Method::named("rk4").unwrap();
        let (first, indices) = (first(rk4, 2.0, 1e-6), indices(rk4, 2.0));
        assert_eq!(first, *indices.start());
        let step = |index| match accuracy(rk4, index, None) {
            Accuracy::Step(h) => h,
            Accuracy::Rtol(..) => f64::NAN,
        };
        assert!((step(first) / 2e-3 - 1.0).abs() < 0.1);
        assert!((step(first) / step(first + 4) / libm::pow(10.0, 0.25) - 1.0).abs() < 0.1);
    }
}

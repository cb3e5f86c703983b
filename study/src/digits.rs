//! Numbers and counts as one would write them.

use std::fmt::Display;

/// `x` to so many significant digits.
pub fn rounded_to(x: f64, digits: usize) -> f64 {
    format!("{x:.0$e}", digits - 1).parse().unwrap_or(x)
}

/// A number without zeros that tell nothing: `0.05`, `120`, `1e-9`.
pub fn in_short(x: f64) -> String {
    if x == 0.0 || (1e-3..1e4).contains(&x.abs()) { x.to_string() } else { format!("{x:e}") }
}

/// A number without the last digits, which the rounding of sums and products makes: `0.0912`, not `0.09119999999999999`.
pub fn as_meant(x: f64) -> String {
    in_short(rounded_to(x, 12))
}

/// So many of a thing whose plural ends in s: `1 run`, `2 runs`.
pub fn count_of(n: impl Display + PartialEq + From<u8>, thing: &str) -> String {
    let s = if n == 1.into() { "" } else { "s" };
    format!("{n} {thing}{s}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_one_would_write_them() {
        let told = |x: f64| in_short(rounded_to(x, 4));
        let all = [0.0, 0.012_345_6, -120.0, 123_456.0, 1e-9, f64::NAN].map(told);
        assert_eq!(all, ["0", "0.01235", "-120", "1.235e5", "1e-9", "NaN"]);
        assert_eq!([1.0 - 1e-15, 3.0 * 0.1 * 0.304].map(as_meant), ["1", "0.0912"]);
        assert_eq!([0, 1, 2].map(|n| count_of(n, "run")), ["0 runs", "1 run", "2 runs"]);
    }
}

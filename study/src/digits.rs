//! Numbers as one would write them.

/// `x` to so many significant digits.
pub fn rounded_to(x: f64, digits: usize) -> f64 {
    format!("{x:.0$e}", digits - 1).parse().unwrap_or(x)
}

/// A number without zeros that tell nothing: `0.05`, `120`, `1e-9`.
pub fn in_short(x: f64) -> String {
    if x == 0.0 || (1e-3..1e4).contains(&x.abs()) { x.to_string() } else { format!("{x:e}") }
}

/// So many of a thing whose plural ends in s: `1 run`, `2 runs`.
pub fn count_of(n: impl TryInto<u64>, thing: &str) -> String {
    // No count is beyond u64.
    let n = n.try_into().unwrap_or(u64::MAX);
    if n == 1 { format!("1 {thing}") } else { format!("{n} {thing}s") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_one_would_write_them() {
        let told = |x: f64| in_short(rounded_to(x, 4));
        let all = [0.0, 0.012_345_6, -120.0, 123_456.0, 1e-9, f64::NAN].map(told);
        assert_eq!(all, ["0", "0.01235", "-120", "1.235e5", "1e-9", "NaN"]);
        assert_eq!([0, 1, 2].map(|n| count_of(n, "run")), ["0 runs", "1 run", "2 runs"]);
    }
}

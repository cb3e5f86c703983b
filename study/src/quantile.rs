//! Quantiles of a few numbers.

/// Quantile of `values`, which it sorts: at that fraction of the way from the least to the largest, between two on the
/// line through them. The median of an even number is the mean of the two in the middle.
///
/// It is type 7 of R. J. Hyndman, Y. Fan, "Sample quantiles in statistical packages", Am. Stat. 50, 361–365 (1996), as
/// by default in numpy and R.
pub fn quantile(values: &mut [f64], fraction: f64) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    let place = fraction * values.len().checked_sub(1)? as f64;
    let [low, high] = [place.floor(), place.ceil()].map(|at| values.get(at as usize).copied());
    let (low, high, part) = (low?, high?, place.fract());
    Some(if low == high { low } else { low * (1.0 - part) + high * part })
}

#[cfg(test)]
mod tests {
    use super::quantile;

    #[test]
    fn between_two_values_it_is_on_the_line_through_them() {
        let of = |values: &[f64], fraction| quantile(&mut values.to_vec(), fraction);
        assert_eq!(of(&[], 0.5), None);
        assert_eq!(of(&[3.0], 0.25), Some(3.0));
        assert_eq!(of(&[4.0, 1.0, 3.0, 2.0], 0.5), Some(2.5));
        assert_eq!(of(&[4.0, 1.0, 3.0, 2.0], 0.25), Some(1.75));
        assert_eq!(of(&[5.0, 1.0, 3.0], 0.5), Some(3.0));
        assert_eq!([0.0, 1.0].map(|end| of(&[5.0, 1.0, 3.0], end)), [Some(1.0), Some(5.0)]);
        // The same to the bit where all are, and no number from infinities.
        assert_eq!(of(&[0.1; 4], 0.3), Some(0.1));
        assert_eq!(of(&[f64::INFINITY; 2], 0.5), Some(f64::INFINITY));
        assert_eq!(of(&[1.0, f64::INFINITY], 0.5), Some(f64::INFINITY));
    }
}

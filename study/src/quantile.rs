//! Quantiles of a few numbers.

/// Quantile of `values`, which it sorts: the element nearest below the fraction of its length.
pub fn quantile(values: &mut [f64], fraction: f64) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    values.get((fraction * last as f64 + 0.5) as usize).copied()
}

//! Quantiles of a few numbers.

/// Quantile of `values`, which it sorts: the element whose index is nearest to that fraction of the last one, the higher of
/// two; of an even number of values the median is the upper one.
pub fn quantile(values: &mut [f64], fraction: f64) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    values.get((fraction * last as f64 + 0.5) as usize).copied()
}

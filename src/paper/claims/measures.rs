//! What is measured on a deployment, claim by claim.

use super::Deployment;
use crate::paper::course::{Bin, Quantity, coarser};
use crate::paper::deployment::Course;

/// Forces are settled in the second after the paper's time of fluctuation [s].
const SETTLED_S: (f64, f64) = (2.0, 3.0);
/// The end of a deployment [s before 90°].
const LAST_S: f64 = 0.5;
/// A fluctuation below this part of the ideal value has settled; it is looked at over so many bins.
const SETTLED: f64 = 0.1;
const SETTLING_BINS: usize = 10;
/// Frequencies of the sines that are tried: spacing, which is the least one, and number [Hz].
const FREQUENCIES_HZ: (f64, u32) = (0.1, 100);
/// Bins that a sine is fitted to: 1 s, over which the frequency of a swing hardly changes.
const SINE_BINS: usize = 100;

/// Largest magnitude of a quantity over a deployment.
pub(super) fn largest(course: &Course, quantity: Quantity) -> Option<f64> {
    course.bins.iter().map(|bin| bin.of(quantity).magnitude()).reduce(f64::max)
}

/// θ̈ at 90° over its largest value, in the direction that it turned in.
pub(super) fn last_over_largest(course: &Course) -> Option<f64> {
    course.run.reached_90_s?;
    let last = course.onward(course.bins.last()?, Quantity::Alpha);
    Some(last.least / largest(course, Quantity::Alpha)?)
}

/// The bins of a joint beside the ideal ones, until one of both is at 90° or until `t` [s].
fn beside<'a>(of: &Deployment<'a>, i: usize, t: f64) -> impl Iterator<Item = (Bin, Bin)> + use<'a> {
    let until = [of.own[i], of.ideal[i]].iter().fold(t, |t, course| t.min(course.run.end_s));
    let pairs = of.own[i].until(until).iter().zip(of.ideal[i].until(until));
    pairs.map(|(own, ideal)| (*own, *ideal))
}

/// Largest difference of a quantity from its ideal course, over the largest of that: between the largest
/// values of a bin, and between the least, so that what both do within it does not count.
pub(super) fn deviation(of: &Deployment<'_>, i: usize, quantity: Quantity, t: f64) -> Option<f64> {
    let mut scale = 0.0_f64;
    let mut most = None;
    for (own, ideal) in beside(of, i, t) {
        let (own, ideal) = (own.of(quantity), ideal.of(quantity));
        let apart = (own.most - ideal.most).abs().max((own.least - ideal.least).abs());
        most = Some(apart.max(most.unwrap_or(0.0)));
        scale = scale.max(ideal.magnitude());
    }
    most.map(|most| most / scale)
}

/// When the fluctuation of θ̈, from its least to its largest value, falls below a tenth of the ideal θ̈ for
/// good [s]; none if it does not within the first half of the ideal time.
pub(super) fn settled(of: &Deployment<'_>, i: usize) -> Option<f64> {
    let end = 0.5 * of.ideal[i].run.reached_90_s?;
    let (own, ideal): (Vec<Bin>, Vec<Bin>) = beside(of, i, end).unzip();
    let (own, ideal) = (coarser(&own, SETTLING_BINS), coarser(&ideal, SETTLING_BINS));
    let is_unsettled = |(own, ideal): (&Bin, &Bin)| {
        let (own, ideal) = (own.of(Quantity::Alpha), ideal.of(Quantity::Alpha));
        own.most - own.least > SETTLED * ideal.mean.abs()
    };
    let n_unsettled = own.iter().zip(&ideal).rposition(is_unsettled).map_or(0, |last| last + 1);
    // In the very last bin nothing says that it would not go on.
    own.get(n_unsettled).map(|bin| bin.begin_s)
}

fn mean(bins: &[Bin], quantity: Quantity) -> Option<f64> {
    coarser(bins, bins.len()).first().map(|bin| bin.of(quantity).mean)
}

/// Mean contact force in the second after the fluctuation [N]; none of a run that ends within it.
pub(super) fn settled_force(course: &Course) -> Option<f64> {
    let (from, to) = SETTLED_S;
    if course.run.end_s < to {
        return None;
    }
    let bins = course.until(to);
    mean(&bins[course.until(from).len()..], Quantity::Force)
}

/// Mean contact force at the end of a deployment [N]; none where that is not after the second of [`settled_force`].
pub(super) fn last_force(course: &Course) -> Option<f64> {
    let end = course.run.reached_90_s?;
    if end - LAST_S < SETTLED_S.1 {
        return None;
    }
    mean(&course.bins[course.until(end - LAST_S).len()..], Quantity::Force)
}

/// Part of the variance of y01 within groups of bins that sines explain, each of the best frequency,
/// amplitude, phase and mean for its group.
pub(super) fn best_sine(bins: &[Bin]) -> Option<f64> {
    let whole = bins.chunks_exact(SINE_BINS).map(variance_and_sine);
    let (variance, explained) =
        whole.fold((0.0, 0.0), |sum, group| (sum.0 + group.0, sum.1 + group.1));
    (variance > 0.0).then_some(explained / variance)
}

/// Sum of squares of y01 about its mean, and as much of it as the best sine explains.
fn variance_and_sine(bins: &[Bin]) -> (f64, f64) {
    let centred = |values: Vec<f64>| -> Vec<f64> {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter().map(|value| value - mean).collect()
    };
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let y = centred(bins.iter().map(|bin| bin.of(Quantity::D2).mean).collect());
    let explained = |frequency: f64| {
        let phase = |bin: &Bin| 2.0 * std::f64::consts::PI * frequency * bin.middle_s();
        let waves = bins.iter().map(|bin| libm::sincos(phase(bin)));
        let (sin, cos): (Vec<f64>, Vec<f64>) = waves.unzip();
        let (sin, cos) = (centred(sin), centred(cos));
        // The normal equations of y ≈ a sin + b cos.
        let (ss, sc, cc) = (dot(&sin, &sin), dot(&sin, &cos), dot(&cos, &cos));
        let (ys, yc) = (dot(&y, &sin), dot(&y, &cos));
        (ys * ys * cc - 2.0 * ys * yc * sc + yc * yc * ss) / (ss * cc - sc * sc)
    };
    let (spacing, n) = FREQUENCIES_HZ;
    let best = (1..=n).map(|k| explained(spacing * f64::from(k))).filter(|part| part.is_finite());
    (dot(&y, &y), best.fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::course::Range;

    #[test]
    fn a_sine_is_one_and_a_sawtooth_is_not() {
        let bins = |y: fn(f64) -> f64| -> Vec<Bin> {
            let bin = |k: u32| {
                let begin_s = 0.01 * f64::from(k);
                let value = y(begin_s);
                let range = Range { least: value, most: value, mean: value };
                Bin { begin_s, length_s: 0.01, ranges: [range; 6] }
            };
            (0..1000).map(bin).collect()
        };
        // Measured: off by 2.2e-16; 0.630 of a sawtooth, near the 6/π² of its first harmonic.
        let sine = best_sine(&bins(|t| 0.3 + 1e-4 * (2.0 * std::f64::consts::PI * 4.1 * t).sin()));
        assert!(sine.is_some_and(|part| (part - 1.0).abs() < 2e-15), "{sine:?}");
        let sawtooth = best_sine(&bins(|t| (5.0 * t).fract()));
        assert!(sawtooth.is_some_and(|part| (0.55..0.65).contains(&part)), "{sawtooth:?}");
    }
}

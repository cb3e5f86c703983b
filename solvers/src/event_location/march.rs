//! The first fall of a guard that moves faster than the states: a march along the step, in intervals short enough to
//! follow the guard.

use crate::root::{minimum, parabola};

/// A guard is followed on an interval where the parabola through three of its values gives two more to this fraction
/// of their range.
const MISFIT: f64 = 0.05;
/// The next interval is longer by the first of these factors `f` for which the misfit is at most the misfit allowed over
/// f³: an error of the third order grows with the cube of the length.
const GROWTH: [f64; 2] = [4.0, 2.0];
/// What is at least this many times further from zero than from its parabola is followed too: it stays above zero.
const HEADROOM: f64 = 8.0;
/// Inner points of an interval. No two distances between them have a simple ratio, so that no sine has the values of a
/// parabola at all of them.
const INNER: [f64; 3] = [0.27, 0.5, 0.77];
/// A march begins with an interval of this fraction of the step, or less.
const FIRST: f64 = 1.0 / 64.0;
/// Shortest interval: at the kink of a guard no parabola follows it.
const SHORTEST: f64 = 1e-9;
/// Largest number of intervals of one march.
const MOST: usize = 20_000;

/// What a march found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Found {
    /// The guard falls between the first fraction of the step, where it is above zero, and the second, where it is
    /// below.
    Fall(f64, f64),
    /// It does not fall; the fraction of the step at which it is largest after its last minimum.
    Nothing(f64),
    /// It is not a number at this fraction of the step.
    NotFinite,
    /// It moves too fast to be followed.
    Lost,
}

/// A value of the guard at a fraction of the step.
#[derive(Clone, Copy)]
struct Value {
    theta: f64,
    g: f64,
}

/// Length of the first interval after a function with these values and slopes at 0 and 1. It is short beside the time in
/// which the slopes change the function by its size.
pub(crate) fn first_width(values: [f64; 2], slopes: [f64; 2]) -> f64 {
    let [size, steepest] = [values, slopes].map(|[a, b]| a.abs().max(b.abs()));
    let turn = size / steepest;
    if turn > 0.0 { FIRST.min(0.1 * turn) } else { FIRST }
}

/// Looks for the first fall of `g`, a function of the fraction of the step, after `from`. The first interval is `width`
/// long; each value may be wrong by `noise`. Whether `g` falls at the start and rises at the end shows dips right beside
/// them.
///
/// `turned` is told the minima before it, each by a fraction of the step and about the value there.
///
/// The intervals begin short and grow while parabolas follow the guard. So the guard is followed from the start, and
/// an interval of many of its periods is not taken for one on which it rests.
// Longer than 60 lines: parts of it would hand on the last two values, the highest one and two closures.
pub(crate) fn first_fall(
    mut g: impl FnMut(f64) -> f64,
    from: f64,
    mut width: f64,
    noise: f64,
    (falls, rises): (bool, bool),
    mut turned: impl FnMut(f64, f64),
) -> Found {
    let mut value = |theta: f64| Value { theta, g: g(theta) };
    let mut a = value(from);
    let (mut before, mut top) = (a, a);
    for _ in 0..MOST {
        if a.theta >= 1.0 {
            break;
        }
        let end = if a.theta + width >= 1.0 - 0.5 * SHORTEST { 1.0 } else { a.theta + width };
        let inner = INNER.map(|part| value(a.theta + part * (end - a.theta)));
        let values = [inner[0], inner[1], inner[2], value(end)];
        if values.iter().any(|v| !v.g.is_finite()) {
            return Found::NotFinite;
        }
        let (off, allowed) = misfit(a.g, values.map(|v| v.g), noise);
        if off > allowed && width > SHORTEST {
            width = (0.5 * width).max(SHORTEST);
            continue;
        }
        for next in values {
            let is_least = a.g <= before.g && a.g < next.g && a.theta > before.theta;
            let is_first = falls && a.theta == from && a.g <= next.g;
            let is_near = is_least && a.g < 2.0 * depth(before, a, next) + allowed;
            if top.g > 0.0 && (is_first || is_near) {
                let middle = if is_first { 0.5 * (a.theta + next.theta) } else { a.theta };
                let points = [before.theta, middle, next.theta];
                let (theta, g) = minimum(|theta| value(theta).g, points);
                if g < 0.0 {
                    return Found::Fall(top.theta, theta);
                }
                turned(theta, g);
                top = a;
            } else if is_least {
                turned(a.theta, a.g);
            }
            if next.g < 0.0 && top.g > 0.0 {
                return Found::Fall(top.theta, next.theta);
            }
            if next.g > top.g {
                top = next;
            }
            (before, a) = (a, next);
        }
        let growth = GROWTH.into_iter().find(|by| off * by * by * by <= allowed);
        width *= growth.unwrap_or(1.0);
    }
    if a.theta < 1.0 {
        return Found::Lost;
    }
    if rises && a.g <= before.g && top.g > 0.0 {
        let ends = [before.theta, 0.5 * (before.theta + a.theta), a.theta];
        let (theta, g) = minimum(|theta| value(theta).g, ends);
        if g < 0.0 {
            return Found::Fall(top.theta, theta);
        }
        turned(theta, g);
    }
    Found::Nothing(top.theta)
}

/// How far the vertex of the parabola through three values is below the middle one, the least of them.
fn depth(before: Value, least: Value, next: Value) -> f64 {
    let (vertex, c) = parabola([before, least, next].map(|value| (value.theta, value.g)));
    c * (least.theta - vertex) * (least.theta - vertex)
}

/// Largest difference, at the first and the last of the inner points, from the parabola through the start, the middle
/// and the end; and the largest one at which the parabola is held to follow.
fn misfit(start: f64, values: [f64; 4], noise: f64) -> (f64, f64) {
    let [first, middle, last, end] = values;
    let parabola = |s: f64| {
        let u = 2.0 * s - 1.0;
        middle + 0.5 * u * (end - start + u * (start - 2.0 * middle + end))
    };
    let off = (first - parabola(INNER[0])).abs().max((last - parabola(INNER[2])).abs());
    let (least, most) = values.iter().fold((start, start), |(l, m), g| (l.min(*g), m.max(*g)));
    (off, (MISFIT * (most - least) + noise).max(least / HEADROOM))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn the_first_fall_of_a_sine_is_found_whatever_its_speed_and_phase() {
        for k in 0..1000_u32 {
            // 0.3 to 300 periods in the step, each with another phase.
            let omega = TAU * 0.3 * 1000.0_f64.powf(f64::from(k) / 1000.0);
            let phase = TAU * 0.618_034 * f64::from(k) % TAU;
            let g = |s: f64| (phase + omega * s).sin();
            let width = (0.1 / omega).min(1.0 / 64.0);
            let found = first_fall(g, 0.0, width, 1e-15, (false, false), |_, _| {});
            let fall =
                if phase < TAU / 2.0 { TAU / 2.0 - phase } else { 1.5 * TAU - phase } / omega;
            match found {
                Found::Fall(above, below) => {
                    let period = TAU / omega;
                    assert!(above < fall && fall < below && below < fall + 0.5 * period, "{k}");
                }
                Found::Nothing(_) => assert!(fall > 1.0, "{k}"),
                other => panic!("{k}: {other:?}"),
            }
        }
    }

    #[test]
    fn a_dip_that_is_shallow_beside_its_range_is_found() {
        for k in 0..1000_u32 {
            // From one down to 1e-9 deep, from 0.1 to 20 periods after the start.
            let middle = 0.1 * 200.0_f64.powf((0.618_034 * f64::from(k)).fract());
            let depth = 1e-9_f64.powf((0.754_878 * f64::from(k)).fract());
            let g = |s: f64| 1.0 - depth - (40.0 * (s - middle / 20.0)).cos();
            let found = first_fall(g, 0.0, 1.0 / 64.0, 1e-15, (false, true), |_, _| {});
            let Found::Fall(above, below) = found else { panic!("{depth}: {found:?}") };
            assert!(g(above) > 0.0 && g(below) < 0.0, "{depth}");
        }
    }

    #[test]
    fn a_dip_right_beside_an_end_is_found_by_the_slope_there() {
        for middle in [1e-4, 0.99] {
            let dip = |s: f64| (s - middle) * (s - middle) - 1e-9;
            let found = first_fall(dip, 0.0, 1e-3, 0.0, (true, true), |_, _| {});
            assert!(matches!(found, Found::Fall(_, below) if dip(below) < 0.0), "{found:?}");
        }
    }

    #[test]
    fn a_guard_that_is_far_or_touches_does_not_fall() {
        let guards: [fn(f64) -> f64; 4] = [
            |s| 2.0 + (500.0 * s).sin(),
            |s| 1.0 + (50.0 * s).cos() + 1e-9,
            |s| (s - 0.37).abs(),
            |_| 0.0,
        ];
        for g in guards {
            let found = first_fall(g, 0.0, 1e-3, 0.0, (false, false), |_, _| {});
            assert!(matches!(found, Found::Nothing(_)), "{found:?}");
        }
    }

    #[test]
    fn what_cannot_be_followed_is_told() {
        assert_eq!(
            first_fall(|s| (0.5 - s).sqrt(), 0.0, 1e-3, 0.0, (false, false), |_, _| {}),
            Found::NotFinite
        );
        assert_eq!(
            first_fall(|s| 1.0 + (1e12 * s).sin(), 0.0, 1e-3, 0.0, (false, false), |_, _| {}),
            Found::Lost
        );
    }
}

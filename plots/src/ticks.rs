//! Where the ticks of an axis stand and what is written at them.

use crate::axis::{Scale, Span};
use crate::font::Fonts;
use crate::style::TICK;

/// A tick with a label.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    /// Place along the axis, from 0 to 1.
    pub(crate) at: f64,
    pub(crate) label: String,
}

/// The ticks of one axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Ticks {
    pub(crate) major: Vec<Tick>,
    /// Places of the ticks without a label.
    pub(crate) minor: Vec<f64>,
    /// A power of ten that all labels are to be multiplied by, as it is written at the axis' end.
    pub(crate) factor: String,
}

/// Least room between two labels of an x axis [px], and between two baselines of a y axis [line heights].
const LABEL_GAP: f64 = 14.0;
const LINE_GAP: f64 = 1.6;
/// Least mean distance of minor ticks, else there are none [px].
const MINOR_GAP: f64 = 4.0;

impl Ticks {
    /// As many as fit along an x axis of that width.
    pub(crate) fn across(span: Span, width: f64, fonts: &Fonts) -> Self {
        let half = |tick: &Tick| fonts.width(&tick.label, TICK) / 2.0;
        Self::most(span, width, |a, b| half(a) + half(b) + LABEL_GAP)
    }

    /// As many as fit along a y axis of that height.
    pub(crate) fn up(span: Span, height: f64) -> Self {
        Self::most(span, height, |_, _| LINE_GAP * TICK.line_height())
    }

    /// Ticks in the middle of equal intervals; too many of them for `most` get a label only now and then.
    pub(crate) fn middles(names: &[String], most: f64, reversed: bool) -> Self {
        let stride = (names.len() as f64 / most.max(1.0)).ceil().max(1.0) as usize;
        let tick = |(i, name): (usize, &String)| {
            let at = (i as f64 + 0.5) / names.len() as f64;
            Tick { at: if reversed { 1.0 - at } else { at }, label: name.clone() }
        };
        let major = names.iter().enumerate().step_by(stride).map(tick).collect();
        Self { major, ..Self::default() }
    }

    /// The densest choice of ticks in which any two neighbours are as far apart as they have to be.
    fn most(span: Span, length: f64, apart: impl Fn(&Tick, &Tick) -> f64) -> Self {
        let choices = match span.scale {
            Scale::Linear => linear(span),
            Scale::Log => logarithmic(span),
        };
        let fits = |ticks: &&Ticks| {
            let pairs = ticks.major.windows(2);
            pairs
                .into_iter()
                .all(|pair| (pair[1].at - pair[0].at) * length >= apart(&pair[0], &pair[1]))
        };
        let mut ticks = choices.iter().find(fits).or(choices.last()).cloned().unwrap_or_default();
        if ticks.minor.len() as f64 * MINOR_GAP > length {
            ticks.minor.clear();
        }
        ticks
    }
}

/// Most labels an axis gets.
const MOST_LABELS: i64 = 9;
/// Powers of ten written in full.
const PLAIN: std::ops::RangeInclusive<i32> = -2..=4;

/// Ticks at whole multiples of 1, 2 or 5 times a power of ten, densest first.
fn linear(span: Span) -> Vec<Ticks> {
    let (lo, hi) = span.ends();
    let coarsest = decade(hi - lo) + 1;
    let steps = (coarsest - 2..=coarsest).flat_map(|k| [1, 2, 5].map(|m| (m, k)));
    steps.filter_map(|(m, k)| multiples(span, m, k)).collect()
}

/// Ticks at the multiples of `m·10ᵏ`, if there are at least two and not too many.
fn multiples(span: Span, m: i64, k: i32) -> Option<Ticks> {
    let (lo, hi) = span.ends();
    let step = scaled(m, k);
    // A tick at the very end of the axis is not to be lost to rounding.
    let slack = 1e-9 * (hi - lo) / step;
    let (first, last) = ((lo / step - slack).ceil() as i64, (hi / step + slack).floor() as i64);
    if last - first < 1 || last - first >= MOST_LABELS {
        return None;
    }
    let magnitude = decade(step * first.abs().max(last.abs()) as f64);
    let power = if PLAIN.contains(&magnitude) { 0 } else { magnitude };
    let decimals = (power - k).max(0) as usize;
    let tick = |i: i64| {
        let label = format!("{:.decimals$}", scaled(i * m, k - power)).replace('-', "−");
        Some(Tick { at: span.fraction(scaled(i * m, k))?, label })
    };
    let factor = if power == 0 { String::new() } else { format!("×{}", power_of_ten(power)) };
    Some(Ticks { major: (first..=last).filter_map(tick).collect(), minor: Vec::new(), factor })
}

/// Ticks at powers of ten, with some or all of their multiples between if the axis is short, densest first.
fn logarithmic(span: Span) -> Vec<Ticks> {
    let decades = span.hi - span.lo;
    let mut choices = Vec::new();
    if decades < 1.2 {
        choices.push(decimal(span, &[1, 2, 3, 4, 5, 6, 7, 8, 9], 1));
    }
    if decades < 2.5 {
        choices.push(decimal(span, &[1, 2, 5], 1));
    }
    choices.extend([1, 2, 3, 5, 10, 20, 50, 100].map(|stride| decimal(span, &[1], stride)));
    choices.retain(|ticks| ticks.major.len() >= 2);
    if choices.is_empty() { linear(span) } else { choices }
}

/// Labels at the given multiples of every `stride`th power of ten, minor ticks at what lies between.
fn decimal(span: Span, multiples: &[i64], stride: i32) -> Ticks {
    let exponents = span.lo.floor() as i32..=span.hi.ceil() as i32;
    let plain = PLAIN.contains(exponents.start()) && PLAIN.contains(exponents.end());
    let mut ticks = Ticks::default();
    for exponent in exponents {
        for m in 1..=9 {
            let Some(at) =
                span.fraction(scaled(m, exponent)).filter(|at| (-1e-9..=1.0 + 1e-9).contains(at))
            else {
                continue;
            };
            if multiples.contains(&m) && exponent % stride == 0 {
                let power = power_of_ten(exponent);
                let label = match m {
                    _ if plain => scaled(m, exponent).to_string(),
                    1 => power,
                    _ => format!("{m}×{power}"),
                };
                ticks.major.push(Tick { at, label });
            } else if stride == 1 || m == 1 {
                ticks.minor.push(at);
            }
        }
    }
    ticks
}

/// The power of ten of a number's first digit.
fn decade(value: f64) -> i32 {
    libm::log10(value.abs().max(f64::MIN_POSITIVE)).floor() as i32
}

/// `n·10ᵏ`, rounded once where 10ᵏ is exact.
fn scaled(n: i64, k: i32) -> f64 {
    if k < 0 { n as f64 / libm::exp10(f64::from(-k)) } else { n as f64 * libm::exp10(f64::from(k)) }
}

/// A power of ten as it is written: 10⁻⁶.
pub(crate) fn power_of_ten(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |c: char| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]);
    format!("10{}", exponent.to_string().chars().map(raised).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, lo: f64, hi: f64, most: usize) -> (Vec<String>, String) {
        let span = Span { scale, lo, hi };
        let ticks = Ticks::up(span, most as f64 * LINE_GAP * TICK.line_height());
        (ticks.major.into_iter().map(|tick| tick.label).collect(), ticks.factor)
    }

    #[test]
    fn powers_of_ten_are_written_with_superscripts() {
        assert_eq!(power_of_ten(-12), "10⁻¹²");
        assert_eq!(power_of_ten(0), "10⁰");
    }

    #[test]
    fn tenths_have_no_rounding_noise() {
        let (labels, factor) = labels(Scale::Linear, 0.0, 0.5, 6);
        assert_eq!(labels, ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(factor, "");
    }

    #[test]
    fn small_numbers_share_a_factor() {
        let (labels, factor) = labels(Scale::Linear, -2e-4, 2e-4, 5);
        assert_eq!(labels, ["−2", "−1", "0", "1", "2"]);
        assert_eq!(factor, "×10⁻⁴");
    }

    #[test]
    fn a_log_axis_within_one_decade_has_two_labels() {
        assert_eq!(labels(Scale::Log, -3.0, -2.6, 9).0, ["10⁻³", "2×10⁻³"]);
        let (labels, factor) = labels(Scale::Log, libm::log10(4.2e-6), libm::log10(4.8e-6), 4);
        assert_eq!(labels, ["4.2", "4.4", "4.6", "4.8"]);
        assert_eq!(factor, "×10⁻⁶");
    }

    #[test]
    fn a_log_axis_of_everyday_numbers_writes_them_in_full() {
        assert_eq!(labels(Scale::Log, -0.4, 1.1, 9).0, ["0.5", "1", "2", "5", "10"]);
    }

    #[test]
    fn a_log_axis_of_many_decades_skips_labels() {
        let (labels, _) = labels(Scale::Log, -15.0, 0.0, 6);
        assert_eq!(labels, ["10⁻¹⁵", "10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³", "10⁰"]);
    }

    #[test]
    fn every_span_has_two_ticks() {
        for exponent in -290..290 {
            let value = scaled(37, exponent);
            let span = Span { scale: Scale::Linear, lo: value, hi: 1.03 * value };
            assert!(Ticks::up(span, 60.0).major.len() >= 2, "{value:e}");
        }
    }
}

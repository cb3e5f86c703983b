//! What is known of the unit of a formula, and whether two formulas may stand beside each other.

use std::fmt;

use deltazero_study::digits::{in_short, rounded_to};

use crate::report::{Checked, Complaint, Span};
use crate::units::Unit;

/// What is known of the unit of a formula.
#[derive(Clone, Copy, Debug)]
pub(super) enum Known {
    /// Nothing: a name without a unit stands in it.
    Open,
    /// It is made of numbers, with its value where there is no index and no function in it.
    Number(Option<f64>),
    /// A unit, and the size of the numbers that it is multiplied by.
    Unit(Unit, f64),
}

impl Known {
    pub(super) const ZERO: Self = Self::Number(Some(0.0));
    pub(super) const ONE: Self = Self::unit(Unit::ONE);

    pub(super) const fn unit(unit: Unit) -> Self {
        Self::Unit(unit, 1.0)
    }

    /// Its value, if it is a number that is known.
    pub(super) fn value(self) -> Option<f64> {
        if let Self::Number(value) = self { value } else { None }
    }

    pub(super) fn is_zero(self) -> bool {
        self.value() == Some(0.0)
    }

    pub(super) fn times(self, other: Self) -> Self {
        match (self, other) {
            _ if self.is_zero() || other.is_zero() => Self::ZERO,
            (Self::Open, _) | (_, Self::Open) => Self::Open,
            (Self::Number(a), Self::Number(b)) => Self::Number(a.zip(b).map(|(a, b)| a * b)),
            (Self::Number(a), Self::Unit(unit, n)) | (Self::Unit(unit, n), Self::Number(a)) => {
                Self::Unit(unit, n * a.unwrap_or(1.0).abs())
            }
            (Self::Unit(a, n), Self::Unit(b, m)) => Self::Unit(a.times(b), n * m),
        }
    }

    pub(super) fn over(self, other: Self) -> Self {
        match other {
            _ if other.is_zero() => Self::Open,
            Self::Number(b) => self.times(Self::Number(b.map(|b| 1.0 / b))),
            _ => self.times(other.power(Self::Number(Some(-1.0)))),
        }
    }

    pub(super) fn power(self, exponent: Self) -> Self {
        match (self, exponent) {
            (Self::Number(a), Self::Number(p)) => {
                Self::Number(a.zip(p).map(|(a, p)| libm::pow(a, p)))
            }
            (Self::Number(_), _) => Self::ONE,
            (Self::Unit(unit, n), Self::Number(Some(p))) => {
                Self::Unit(unit.power(p), libm::pow(n, p))
            }
            (Self::Unit(unit, _), _) if unit.is(Unit::ONE) => Self::ONE,
            _ => Self::Open,
        }
    }

    /// Whether both are in one unit; where numbers stand in a product, in units of one kind, as they may convert one scale to
    /// another: `0.001*w` of a `w` in mm/s is in m/s.
    pub(super) fn fits(self, other: Self) -> bool {
        let (Self::Unit(a, n), Self::Unit(b, m)) = (self, other) else { return true };
        a.factor_over(b).is_some_and(|ratio| ratio == 1.0 || n != 1.0 || m != 1.0)
    }

    /// Where both [fit](Self::fits) by numbers alone, and these are nearer to one than to the factor that converts: a warning.
    pub(super) fn doubt(self, other: Self, span: Span) -> Option<Complaint> {
        let (Self::Unit(a, n), Self::Unit(b, m)) = (self, other) else { return None };
        let ratio = a.factor_over(b).filter(|ratio| *ratio != 1.0)?;
        let number = n / m;
        let off = |from: f64| libm::log(number / from).abs();
        (off(ratio) > off(1.0)).then(|| {
            let [number, ratio] = [number, ratio].map(|x| in_short(rounded_to(x, 6)));
            let message = format!(
                "a factor of {ratio} converts one side to the unit of the other, and the numbers here make {number}"
            );
            Complaint::new(span, message)
                .help("write the factor, or make a number that does not convert a parameter with its `unit`, `1` where it has none")
        })
    }

    /// What both are, which [fit](Self::fits).
    pub(super) fn or(self, other: Self) -> Self {
        match (self, other) {
            (Self::Unit(_, n), Self::Unit(_, m)) => {
                if libm::log(n).abs() <= libm::log(m).abs() {
                    self
                } else {
                    other
                }
            }
            (Self::Unit(..), _) => self,
            (_, Self::Unit(..)) => other,
            (Self::Number(_), Self::Number(_)) => Self::Number(None),
            _ => Self::Open,
        }
    }
}

/// As the end of a sentence.
impl fmt::Display for Known {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Open => f.write_str("may have any unit"),
            Self::Number(_) => f.write_str("is a number without a unit"),
            Self::Unit(unit, _) => unit.fmt(f),
        }
    }
}

/// Checks a formula at `span` against the unit that it must have.
pub(super) fn expected(found: Known, unit: Known, span: Span, what: &str) -> Checked<()> {
    if found.fits(unit) {
        return Ok(());
    }
    let complaint = Complaint::new(span, format!("{what} {unit}, and this {found}"));
    Err(complaint.help(way_out(found, unit)))
}

/// What to do where a unit is found that is not `must`.
fn way_out(found: Known, must: Known) -> String {
    let parameter = |value: f64, unit: Unit| match unit.in_base() {
        Some(unit) => {
            let value = in_short(rounded_to(value, 6));
            format!("a parameter `{{ value = {value}, unit = \"{unit}\" }}`")
        }
        None => "a parameter with its `unit`".to_owned(),
    };
    match (found, must) {
        (Known::Number(x), Known::Unit(unit, _)) | (Known::Unit(unit, _), Known::Number(x)) => {
            let parameter = parameter(x.unwrap_or(1.0), unit);
            format!("a number in a sum has no unit, {parameter} has one, and 0 fits every unit")
        }
        (Known::Unit(a, n), Known::Unit(b, _)) => match a.factor_over(b) {
            Some(ratio) => {
                let ratio = in_short(rounded_to(ratio, 6));
                format!("both are of one kind: a factor of {ratio} converts this")
            }
            None => {
                let over = a.over(b);
                let missing =
                    format!("this over that {over}: a factor is missing, or one too many");
                if n == 1.0 {
                    return missing;
                }
                let parameter = parameter(n, b.over(a));
                format!("{missing}; a number has no unit, {parameter} has one")
            }
        },
        _ => String::new(),
    }
}

/// The unit that both have, where one is known. A number alone is in that of the other.
pub(super) fn same([(a, a_span), (b, b_span)]: [(Known, Span); 2], what: &str) -> Checked<Known> {
    if a.fits(b) {
        return Ok(a.or(b));
    }
    Err(differ([(a, a_span), (b, b_span)], what))
}

fn differ([(a, a_span), (b, b_span)]: [(Known, Span); 2], what: &str) -> Complaint {
    let message = format!("{what}, and their units differ");
    let complaint = Complaint::new(b_span, message).label(format!("this {b}"));
    complaint.and(a_span, format!("this {a}")).help(way_out(b, a))
}

/// The same where a number alone has no unit.
pub(super) fn strictly_same(
    [(a, a_span), (b, b_span)]: [(Known, Span); 2],
    what: &str,
) -> Checked<Known> {
    let is_right = match (a, b) {
        (Known::Number(_), Known::Number(_)) => true,
        (Known::Number(_), other) | (other, Known::Number(_)) => {
            a.is_zero() || b.is_zero() || other.fits(Known::ONE)
        }
        _ => a.fits(b),
    };
    if is_right { Ok(a.or(b)) } else { Err(differ([(a, a_span), (b, b_span)], what)) }
}

/// The unit of a sum.
pub(super) fn added(a: Known, b: Known, [a_span, b_span]: [Span; 2]) -> Checked<Known> {
    if let (Known::Number(a), Known::Number(b)) = (a, b) {
        return Ok(Known::Number(a.zip(b).map(|(a, b)| a + b)));
    }
    strictly_same([(a, a_span), (b, b_span)], "these are added or subtracted")
}

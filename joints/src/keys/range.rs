//! Ranges of finite numbers.

use std::fmt;

/// One end of a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// The bound itself is allowed.
    Closed(f64),
    /// The bound itself is refused.
    Open(f64),
    /// Any finite number.
    Free,
}

/// A range of finite numbers; NaN and ±∞ are outside every range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lower end, in the unit of its key.
    pub low: End,
    /// Upper end, in the unit of its key.
    pub high: End,
}

impl Range {
    /// Any finite number.
    pub const FINITE: Self = Self { low: End::Free, high: End::Free };
    /// Numbers greater than zero.
    pub const POSITIVE: Self = Self { low: End::Open(0.0), high: End::Free };
    /// Numbers from zero on.
    pub const NOT_NEGATIVE: Self = Self::at_least(0.0);

    /// Numbers from `low` on.
    pub const fn at_least(low: f64) -> Self {
        Self { low: End::Closed(low), high: End::Free }
    }

    /// Numbers from `low` to `high`, both included.
    pub const fn closed(low: f64, high: f64) -> Self {
        Self { low: End::Closed(low), high: End::Closed(high) }
    }

    /// Whether `x` lies inside; false for NaN and ±∞.
    pub fn contains(&self, x: f64) -> bool {
        let above = match self.low {
            End::Closed(low) => x >= low,
            End::Open(low) => x > low,
            End::Free => true,
        };
        let below = match self.high {
            End::Closed(high) => x <= high,
            End::Open(high) => x < high,
            End::Free => true,
        };
        x.is_finite() && above && below
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let low = match self.low {
            End::Closed(x) => format!("at least {}", number(x)),
            End::Open(x) => format!("greater than {}", number(x)),
            End::Free => String::new(),
        };
        let high = match self.high {
            End::Closed(x) => format!("at most {}", number(x)),
            End::Open(x) => format!("less than {}", number(x)),
            End::Free => String::new(),
        };
        match (self.low, self.high) {
            (End::Free, End::Free) => f.write_str("any finite number"),
            (End::Closed(low), End::Closed(high)) => {
                write!(f, "from {} to {}", number(low), number(high))
            }
            (_, End::Free) => f.write_str(&low),
            (End::Free, _) => f.write_str(&high),
            _ => write!(f, "{low}, {high}"),
        }
    }
}

/// A number as one would write it: `0.1`, but `1e-14`.
fn number(x: f64) -> String {
    if x == 0.0 || (1e-4..1e6).contains(&x.abs()) { format!("{x}") } else { format!("{x:e}") }
}

//! Units: products of powers of the seven of the SI, with a factor.

use std::fmt;

use deltazero_study::digits::{in_short, rounded_to};

/// Symbols of the base units.
const BASE: [&str; 7] = ["m", "kg", "s", "A", "K", "mol", "cd"];

/// A unit: its factor over the product of powers of base units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unit {
    factor: f64,
    powers: [f64; 7],
}

/// Unit of a symbol: factor, then powers of base units.
type Symbol = (&'static str, f64, [i8; 7]);

/// Symbols that take prefixes.
const SYMBOLS: &[Symbol] = &[
    ("m", 1.0, [1, 0, 0, 0, 0, 0, 0]),
    ("g", 1e-3, [0, 1, 0, 0, 0, 0, 0]),
    ("s", 1.0, [0, 0, 1, 0, 0, 0, 0]),
    ("A", 1.0, [0, 0, 0, 1, 0, 0, 0]),
    ("K", 1.0, [0, 0, 0, 0, 1, 0, 0]),
    ("mol", 1.0, [0, 0, 0, 0, 0, 1, 0]),
    ("cd", 1.0, [0, 0, 0, 0, 0, 0, 1]),
    ("rad", 1.0, [0; 7]),
    ("Hz", 1.0, [0, 0, -1, 0, 0, 0, 0]),
    ("N", 1.0, [1, 1, -2, 0, 0, 0, 0]),
    ("Pa", 1.0, [-1, 1, -2, 0, 0, 0, 0]),
    ("J", 1.0, [2, 1, -2, 0, 0, 0, 0]),
    ("W", 1.0, [2, 1, -3, 0, 0, 0, 0]),
    ("C", 1.0, [0, 0, 1, 1, 0, 0, 0]),
    ("V", 1.0, [2, 1, -3, -1, 0, 0, 0]),
    ("Ω", 1.0, [2, 1, -3, -2, 0, 0, 0]),
    ("Ohm", 1.0, [2, 1, -3, -2, 0, 0, 0]),
    ("ohm", 1.0, [2, 1, -3, -2, 0, 0, 0]),
    ("F", 1.0, [-2, -1, 4, 2, 0, 0, 0]),
    ("H", 1.0, [2, 1, -2, -2, 0, 0, 0]),
    ("T", 1.0, [0, 1, -2, -1, 0, 0, 0]),
    ("Wb", 1.0, [2, 1, -2, -1, 0, 0, 0]),
];

/// Symbols that take no prefix.
const OTHERS: &[Symbol] = &[
    ("1", 1.0, [0; 7]),
    ("-", 1.0, [0; 7]),
    ("%", 1e-2, [0; 7]),
    ("deg", std::f64::consts::PI / 180.0, [0; 7]),
    ("°", std::f64::consts::PI / 180.0, [0; 7]),
    ("min", 60.0, [0, 0, 1, 0, 0, 0, 0]),
    ("h", 3600.0, [0, 0, 1, 0, 0, 0, 0]),
    ("°C", 1.0, [0, 0, 0, 0, 1, 0, 0]),
];

const PREFIXES: &[(&str, f64)] = &[
    ("k", 1e3),
    ("M", 1e6),
    ("G", 1e9),
    ("T", 1e12),
    ("c", 1e-2),
    ("m", 1e-3),
    ("µ", 1e-6),
    ("μ", 1e-6),
    ("u", 1e-6),
    ("n", 1e-9),
    ("p", 1e-12),
];

/// Difference of factors or powers that is rounding.
const CLOSE: f64 = 1e-9;

impl Unit {
    /// What has no unit.
    pub(crate) const ONE: Self = Self { factor: 1.0, powers: [0.0; 7] };

    /// The second.
    pub(crate) const SECOND: Self =
        Self { factor: 1.0, powers: [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0] };

    /// The joule.
    pub(crate) const JOULE: Self =
        Self { factor: 1.0, powers: [2.0, 1.0, -2.0, 0.0, 0.0, 0.0, 0.0] };

    /// Reads a unit such as `N s/m`, `kg*m^2` or `m/s²`. After `/` stand one symbol or a product in parentheses, as
    /// it is written by hand: `N/m s` is not read. `None` for what is not read; it is warned of and not checked.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let text = text.replace('²', "^2").replace('³', "^3").replace(['·', '*'], " ");
        let text = text.trim();
        let (over, under) = match text.split_once('/') {
            None => (text, ""),
            Some((over, under)) => (over, under.trim()),
        };
        let under = match under.strip_prefix('(') {
            Some(product) => product.strip_suffix(')')?,
            None if under.contains([' ', '/']) => return None,
            None => under,
        };
        if over.contains(['(', ')']) || under.contains(['(', ')', '/']) {
            return None;
        }
        Some(product(over)?.over(product(under)?))
    }

    pub(crate) fn times(self, other: Self) -> Self {
        let powers = std::array::from_fn(|i| self.powers[i] + other.powers[i]);
        Self { factor: self.factor * other.factor, powers }
    }

    pub(crate) fn over(self, other: Self) -> Self {
        self.times(other.power(-1.0))
    }

    pub(crate) fn power(self, p: f64) -> Self {
        Self { factor: libm::pow(self.factor, p), powers: self.powers.map(|power| power * p) }
    }

    /// The same as a file gives it, in base units with their powers; none where it has a factor.
    pub(crate) fn in_base(self) -> Option<String> {
        let words: Vec<String> = self.words().collect();
        let text = if words.is_empty() { "1".to_owned() } else { words.join(" ") };
        is_close(self.factor, 1.0).then_some(text)
    }

    fn words(self) -> impl Iterator<Item = String> {
        BASE.iter().zip(self.powers).filter(|(_, power)| *power != 0.0).map(|(symbol, power)| {
            if power == 1.0 { (*symbol).to_owned() } else { format!("{symbol}^{power}") }
        })
    }

    pub(crate) fn is(self, other: Self) -> bool {
        self.factor_over(other) == Some(1.0)
    }

    /// How many of `other` it is; none where they are of different things.
    pub(crate) fn factor_over(self, other: Self) -> Option<f64> {
        let is_of_same = self.powers.iter().zip(other.powers).all(|(a, b)| is_close(*a, b));
        let factor = self.factor / other.factor;
        is_of_same.then_some(if is_close(factor, 1.0) { 1.0 } else { factor })
    }
}

fn is_close(a: f64, b: f64) -> bool {
    (a - b).abs() <= CLOSE
}

/// The way out for a unit that is not read.
pub(crate) fn way_out(text: &str) -> String {
    let words = text.split([' ', '/', '(', ')', '·', '*']).filter(|word| !word.is_empty());
    let mut symbols = words.map(|word| word.split(['^', '²', '³']).next().unwrap_or_default());
    let Some(unknown) = symbols.find(|symbol| of_symbol(symbol).is_none()) else {
        return "a product has spaces, one `/` stands before a symbol or parentheses: `N s/m`, \
                `J/(kg K)`"
            .to_owned();
    };
    let mut pairs = unknown.char_indices().skip(1).map(|(at, _)| unknown.split_at(at));
    if let Some((a, b)) = pairs.find(|(a, b)| of_symbol(a).is_some() && of_symbol(b).is_some()) {
        return format!("a product has spaces: `{a} {b}`");
    }
    if let Some(near) = all_symbols().find(|known| known.eq_ignore_ascii_case(unknown)) {
        return format!("`{unknown}` is no unit; did you mean `{near}`?");
    }
    let [with, without] = [SYMBOLS, OTHERS]
        .map(|table| table.iter().map(|(symbol, ..)| *symbol).collect::<Vec<_>>().join(", "));
    format!("`{unknown}` is no unit; known are {with}, also with a prefix, and {without}")
}

/// Every symbol, plain and with each prefix.
fn all_symbols() -> impl Iterator<Item = String> {
    let plain = OTHERS.iter().chain(SYMBOLS).map(|(symbol, ..)| (*symbol).to_owned());
    let with = |(prefix, _): &'static (&str, f64)| {
        SYMBOLS.iter().map(move |(symbol, ..)| format!("{prefix}{symbol}"))
    };
    plain.chain(PREFIXES.iter().flat_map(with))
}

fn product(text: &str) -> Option<Unit> {
    text.split_whitespace().try_fold(Unit::ONE, |unit, word| {
        let (symbol, power) = match word.split_once('^') {
            None => (word, 1.0),
            Some((symbol, power)) => (symbol, power.parse::<f64>().ok()?),
        };
        (power.abs() <= 20.0).then_some(unit.times(of_symbol(symbol)?.power(power)))
    })
}

fn of_symbol(symbol: &str) -> Option<Unit> {
    let find = |table: &[Symbol], word: &str| {
        let (_, factor, powers) = table.iter().find(|(known, ..)| *known == word)?;
        Some(Unit { factor: *factor, powers: powers.map(f64::from) })
    };
    find(OTHERS, symbol).or_else(|| find(SYMBOLS, symbol)).or_else(|| {
        PREFIXES.iter().find_map(|(prefix, factor)| {
            let unit = find(SYMBOLS, symbol.strip_prefix(prefix)?)?;
            Some(Unit { factor: factor * unit.factor, ..unit })
        })
    })
}

/// As the end of a sentence: `is in m s^-2`.
impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut words = Vec::new();
        if (self.factor - 1.0).abs() > CLOSE {
            words.push(in_short(rounded_to(self.factor, 6)));
        }
        words.extend(self.words());
        match &words[..] {
            [] => f.write_str("has no unit"),
            words => write!(f, "is in {}", words.join(" ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_as_they_are_written() {
        let is = |a: &str, b: &str| Unit::parse(a).unwrap().is(Unit::parse(b).unwrap());
        for (a, b) in [
            ("N", "kg m/s^2"),
            ("N s/m", "kg/s"),
            ("J", "N*m"),
            ("W", "J/s"),
            ("mm", "m^0.5 mm m^-0.5"),
            ("MPa", "N mm^-2"),
            ("rad/s", "1/s"),
            ("m/s²", "m/(s s)"),
            ("", "1"),
            ("min", "s^1 min s^-1"),
            ("N/m^1.5", "kg m^-0.5 s^-2"),
        ] {
            assert!(is(a, b), "{a} and {b}");
        }
        assert!(is("mmol cd", "mol mcd") && !is("mol", "1"));
        assert!(!is("mm", "m") && !is("N", "J"));
        assert_eq!(Unit::parse("N/m s"), None);
        assert_eq!(Unit::parse("furlong"), None);
        let told = |unit: &str| Unit::parse(unit).unwrap().to_string();
        assert_eq!(told("N mm"), "is in 0.001 m^2 kg s^-2");
        assert_eq!(told("mg/h"), "is in 2.77778e-10 kg s^-1");
        assert_eq!(told("deg"), "is in 0.0174533");
        let in_base = |text| Unit::parse(text).unwrap().in_base();
        assert_eq!(in_base("N/m").as_deref(), Some("kg s^-2"));
        assert_eq!(in_base("1").as_deref(), Some("1"));
        assert_eq!([in_base("N/mm"), in_base("deg")], [None, None]);
    }
}

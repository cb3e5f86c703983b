//! Numbers in JSON, which has no infinity and nothing that is no number: those are the texts `inf`, `-inf` and `nan`.
//!
//! Each module is one for `#[serde(with)]`. What an earlier version wrote for them, `null`, is read as a number that
//! is none, or that is not there.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A number as JSON has it.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(untagged)]
enum Number {
    Finite(f64),
    Other(Word),
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
enum Word {
    #[serde(rename = "inf")]
    Infinity,
    #[serde(rename = "-inf")]
    MinusInfinity,
    #[serde(rename = "nan")]
    Nan,
}

impl From<f64> for Number {
    fn from(x: f64) -> Self {
        match x {
            x if x.is_finite() => Self::Finite(x),
            x if x.is_nan() => Self::Other(Word::Nan),
            x if x > 0.0 => Self::Other(Word::Infinity),
            _ => Self::Other(Word::MinusInfinity),
        }
    }
}

impl From<Number> for f64 {
    fn from(number: Number) -> Self {
        match number {
            Number::Finite(x) => x,
            Number::Other(Word::Infinity) => Self::INFINITY,
            Number::Other(Word::MinusInfinity) => Self::NEG_INFINITY,
            Number::Other(Word::Nan) => Self::NAN,
        }
    }
}

fn or_nan(number: Option<Number>) -> f64 {
    number.map_or(f64::NAN, f64::from)
}

/// A number.
pub mod one {
    use super::{Deserialize, Deserializer, Number, Serialize, Serializer, or_nan};

    /// As JSON.
    ///
    /// # Errors
    /// Those of `to`.
    pub fn serialize<S: Serializer>(x: &f64, to: S) -> Result<S::Ok, S::Error> {
        Number::from(*x).serialize(to)
    }

    /// From JSON.
    ///
    /// # Errors
    /// Those of `from`.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Ok(or_nan(Option::deserialize(from)?))
    }
}

/// A number, if there is one; to go with `default`.
pub mod maybe {
    use super::{Deserialize, Deserializer, Number, Serialize, Serializer};

    /// As JSON.
    ///
    /// # Errors
    /// Those of `to`.
    pub fn serialize<S: Serializer>(x: &Option<f64>, to: S) -> Result<S::Ok, S::Error> {
        x.map(Number::from).serialize(to)
    }

    /// From JSON.
    ///
    /// # Errors
    /// Those of `from`.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
        Ok(Option::<Number>::deserialize(from)?.map(f64::from))
    }
}

/// Two numbers.
pub mod pair {
    use super::{Deserialize, Deserializer, Number, Serialize, Serializer, or_nan};

    /// As JSON.
    ///
    /// # Errors
    /// Those of `to`.
    pub fn serialize<S: Serializer>(x: &[f64; 2], to: S) -> Result<S::Ok, S::Error> {
        x.map(Number::from).serialize(to)
    }

    /// From JSON.
    ///
    /// # Errors
    /// Those of `from`.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<[f64; 2], D::Error> {
        Ok(<[Option<Number>; 2]>::deserialize(from)?.map(or_nan))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Serialize, Deserialize)]
    struct Numbers {
        #[serde(with = "one")]
        one: f64,
        #[serde(default, with = "maybe")]
        maybe: Option<f64>,
        #[serde(with = "pair")]
        pair: [f64; 2],
    }

    #[test]
    fn numbers_survive_json_to_the_last_bit_also_where_json_has_none() {
        let all = [0.1 + 0.2, -0.0, 5e-324, f64::MAX, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
        for x in all {
            let numbers = Numbers { one: x, maybe: Some(x), pair: [1.0, x] };
            let text = serde_json::to_string(&numbers).unwrap();
            let back: Numbers = serde_json::from_str(&text).unwrap();
            let back = [back.one, back.maybe.unwrap(), back.pair[1]].map(f64::to_bits);
            assert_eq!(back, [x.to_bits(); 3], "{text}");
        }
    }

    #[test]
    fn a_null_of_an_earlier_version_is_still_read() {
        let old: Numbers = serde_json::from_str(r#"{"one":null,"pair":[1,null]}"#).unwrap();
        assert!(old.one.is_nan() && old.maybe.is_none() && old.pair[1].is_nan(), "{old:?}");
        let null: Numbers = serde_json::from_str(r#"{"one":1,"maybe":null,"pair":[1,2]}"#).unwrap();
        assert_eq!((null.one, null.maybe, null.pair), (1.0, None, [1.0, 2.0]));
    }
}

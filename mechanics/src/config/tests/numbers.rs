//! Every key refuses what no key takes, and every number what its range does not hold.

use super::super::*;
use super::{load, mechanism_of, refusal};
use crate::keys::*;

/// The ends of the range of a number or an integer, or of its entries.
fn range(kind: &Kind) -> Option<Range> {
    match kind {
        Kind::Number(range) => Some(*range),
        Kind::Integer(low, high) => Some(Range::closed(*low as f64, *high as f64)),
        Kind::List(of) | Kind::Set(of) => range(of),
        Kind::OneOf(kinds) => kinds.iter().find_map(range),
        Kind::Boolean | Kind::Word(_) => None,
    }
}

/// The key set to a number; for a list of numbers, its only entry.
fn line(key: &Key, number: &str) -> String {
    match key.kind {
        Kind::List(_) | Kind::Set(_) => format!("{} = [{number}]", key.path),
        _ => format!("{} = {number}", key.path),
    }
}

fn outside(range: Range) -> Vec<String> {
    let below = match range.low {
        End::Closed(x) => vec![x - x.abs() * 1e-3 - 1e-300, x - 1.0],
        End::Open(x) => vec![x, x - 1e-300, x - 1.0],
        End::Free => vec![],
    };
    let above = match range.high {
        End::Closed(x) => vec![x + x.abs() * 1e-3, x + 1.0],
        End::Open(x) => vec![x, x + 1.0],
        End::Free => vec![],
    };
    below.into_iter().chain(above).map(|x| format!("{x:?}")).collect()
}

#[test]
fn every_number_refuses_what_its_range_does_not_hold() {
    let mut tried = 0;
    for key in keys() {
        let Some(range) = range(&key.kind) else {
            continue;
        };
        let bad = ["nan", "+nan", "inf", "-inf", "1e999", "-1e999"].map(str::to_owned);
        for number in bad.into_iter().chain(outside(range)) {
            let line = line(key, &number);
            let message = refusal(&line);
            assert!(message.starts_with(&format!("bad.toml:1: {}", key.path)), "{message}");
            assert!(message.contains(&number), "{line}: {message}");
            let fraction = matches!(key.kind, Kind::Integer(..)) && message.contains("an integer");
            assert!(message.contains("is out of range: ") || fraction, "{message}");
            tried += 1;
        }
    }
    assert!(tried > 150, "{tried}");
}

#[test]
fn every_number_takes_the_closed_ends_of_its_range() {
    for key in keys() {
        let Some(range) = range(&key.kind) else {
            continue;
        };
        for end in [range.low, range.high] {
            if let End::Closed(x) = end {
                let line = line(key, &format!("{x:?}"));
                let sets = [mechanism_of(key)];
                let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
                assert!(load(&line, &sets).is_ok(), "{line}: {:?}", load(&line, &sets));
            }
        }
    }
}

#[test]
fn every_key_refuses_every_other_type() {
    let values = [
        "\"\"",
        "\"no such word\"",
        "true",
        "1",
        "1.5",
        "[]",
        "[[]]",
        "[true]",
        "[\"\"]",
        "{}",
        "{ a = 1 }",
        "1979-05-27",
        "07:32:00",
        "[{}]",
    ];
    for key in keys() {
        for value in values {
            let line = format!("{} = {value}", key.path);
            let accepted = match (key.kind, value) {
                (Kind::Boolean, "true") => true,
                (Kind::Number(range), "1") => range.contains(1.0),
                (Kind::Number(range), "1.5") => range.contains(1.5),
                (Kind::Integer(..), "1") => true,
                (Kind::OneOf(_), "1" | "1.5") => true,
                _ => false,
            };
            match load(&line, &[&mechanism_of(key)]) {
                Ok(_) => assert!(accepted, "{line}"),
                Err(error) => {
                    let message = error.to_string();
                    if matches!(error, ConfigError::NotInMechanism { .. }) {
                        assert!(accepted, "{message}");
                        continue;
                    }
                    assert!(!accepted, "{message}");
                    assert!(message.starts_with(&format!("bad.toml:1: {}", key.path)), "{message}");
                    assert!(!message.contains('\n'), "{message}");
                }
            }
        }
    }
}

#[test]
fn an_integer_is_a_number_and_a_whole_number_is_an_integer() {
    assert_eq!(load("strut.length = 3", &[]).unwrap().strut.length, 3.0);
    assert_eq!(load("contact.stiffness = 0x10", &[]).unwrap().joints[0].contact.stiffness, 16.0);
    assert_eq!(load("study.repeats = 5.0", &[]).unwrap().study.repeats, 5);
    for (digits, value) in [
        ("100000000000000000000", 1e20),
        ("0x1_0000_0000_0000_0000", 2_f64.powi(64)),
        ("0xffff_ffff_ffff_ffff_ff", 2_f64.powi(72)),
        ("0o10_0000_0000_0000_0000_0000_0000", 2_f64.powi(75)),
    ] {
        let huge = load(&format!("contact.stiffness = {digits}"), &[]).unwrap();
        assert_eq!(huge.joints[0].contact.stiffness, value, "{digits}");
    }
    let message = refusal(&format!("contact.stiffness = 0x{}", "1".repeat(33)));
    assert!(message.contains("is out of range: "), "{message}");
}

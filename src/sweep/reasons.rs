//! Why runs did not come to their end: messages that differ in their numbers alone are one reason.

use std::collections::HashMap;

/// Reasons that are told apart; what comes after them is counted together.
const MOST: usize = 1000;
/// What stands for a number.
const NUMBER: char = '…';
/// The reason of what comes after [`MOST`].
const OTHERS: &str = "other reasons";

/// A reason with the runs that it kept from their end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reason {
    /// What the first of them says.
    pub first: String,
    /// How many they are.
    pub n: u64,
}

/// Reasons as far as they are counted.
#[derive(Default)]
pub(super) struct Reasons {
    all: Vec<Reason>,
    /// Where the reason of each message without its numbers stands.
    known: HashMap<String, usize>,
}

impl Reasons {
    /// Counts a run that says this.
    pub(super) fn add(&mut self, message: &str) {
        let is_full = self.all.len() >= MOST;
        let mut own = without_numbers(message);
        if is_full && !self.known.contains_key(&own) {
            own = OTHERS.to_owned();
        }
        let first = if own == OTHERS { OTHERS } else { message };
        let at = *self.known.entry(own).or_insert(self.all.len());
        match self.all.get_mut(at) {
            Some(reason) => reason.n += 1,
            None => self.all.push(Reason { first: first.to_owned(), n: 1 }),
        }
    }

    /// All, the commonest first; of equal ones that which came first.
    pub(super) fn sorted(mut self) -> Vec<Reason> {
        self.all.sort_by_key(|reason| std::cmp::Reverse(reason.n));
        self.all
    }
}

/// A message with a sign in the place of each number that begins a word.
fn without_numbers(message: &str) -> String {
    let mut text = String::new();
    let mut is_in_number = false;
    for c in message.chars() {
        let begins = c.is_ascii_digit() && !text.ends_with(|last: char| last.is_alphanumeric());
        if begins && !is_in_number {
            text.push(NUMBER);
        }
        is_in_number = begins || is_in_number && (c.is_ascii_alphanumeric() || ".+-".contains(c));
        if !is_in_number {
            text.push(c);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_that_differ_in_numbers_are_one_reason_and_the_commonest_is_first() {
        let mut reasons = Reasons::default();
        let messages = [
            "cut at 1000000 evaluations",
            "step fell below 1e-16 s at t = 3.2e-4 s in slip+",
            "step fell below 1e-16 s at t = 0.25 s in slip+",
            "step fell below 1e-16 s at t = 0.25 s in slip-",
        ];
        messages.iter().for_each(|message| reasons.add(message));
        let reason = |i: usize, n| Reason { first: messages[i].to_owned(), n };
        assert_eq!(reasons.sorted(), [reason(1, 2), reason(0, 1), reason(3, 1)]);
    }

    #[test]
    fn digits_inside_a_word_are_no_number() {
        assert_eq!(
            without_numbers("joint2 of radau5: 4 events, 1.5e+3 s"),
            "joint2 of radau5: … events, … s"
        );
    }

    #[test]
    fn reasons_beyond_the_most_are_together() {
        let mut reasons = Reasons::default();
        let letters = |i: usize| {
            (0..4).map(|k| char::from(b'a' + (i >> (3 * k) & 7) as u8)).collect::<String>()
        };
        (0..MOST + 5).for_each(|i| reasons.add(&letters(i)));
        let sorted = reasons.sorted();
        assert_eq!(sorted[0], Reason { first: OTHERS.to_owned(), n: 5 });
        assert_eq!(sorted.len(), MOST + 1);
    }
}

//! What figures call modes, and their colours.

use deltazero_study::steps::step_size::ModeKind;

use super::kind_color;

/// Colours of modes that have names, in the order of the model; their pale tints are told apart, too.
const COLORS: [usize; 7] = [0, 4, 2, 3, 6, 1, 8];
/// Colour and label of all further modes.
const FURTHER: (usize, &str) = (12, "other modes");

/// A label and a colour.
pub(super) type Look = (String, usize);

/// Modes that have names, most that have a colour each.
pub(super) const MOST: usize = COLORS.len();

/// Names of modes in a text.
pub(super) fn quoted<'a>(names: impl IntoIterator<Item = &'a String>) -> String {
    names.into_iter().map(|name| format!("“{name}”")).collect::<Vec<_>>().join(", ")
}

/// The look of a mode: that of its place among `modes`, which have names, or where it has none that of what the site does.
pub(super) fn look(modes: &[String], name: &str, kind: ModeKind) -> Look {
    match modes.iter().position(|own| own == name) {
        Some(i) => look_of(i, name),
        None => (name.to_owned(), kind_color(kind)),
    }
}

/// The look of the mode in this place.
pub(super) fn look_of(place: usize, name: &str) -> Look {
    let (color, label) = COLORS.get(place).map_or(FURTHER, |color| (*color, name));
    (label.to_owned(), color)
}

/// The looks of all these modes, in the order of the model, or of what sites do; each once.
pub(super) fn looks<'a>(
    modes: &[String],
    all: impl Iterator<Item = (&'a str, ModeKind)>,
) -> Vec<Look> {
    let place = |(name, kind)| (modes.iter().position(|own| own == name), kind, name);
    let mut all: Vec<_> = all.map(place).collect();
    all.sort_unstable();
    let mut looks: Vec<Look> = Vec::new();
    for (_, kind, name) in all {
        let look = look(modes, name, kind);
        if !looks.contains(&look) {
            looks.push(look);
        }
    }
    looks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_keep_the_order_and_colours_of_the_model_and_those_beyond_share_one() {
        let modes: Vec<String> = (0..MOST + 2).map(|i| format!("m{i}")).collect();
        let all = modes.iter().rev().map(|name| (name.as_str(), ModeKind::Flight));
        let looks = looks(&modes, all);
        let labels: Vec<&str> = looks.iter().map(|(label, _)| label.as_str()).collect();
        assert_eq!(labels, ["m0", "m1", "m2", "m3", "m4", "m5", "m6", "other modes"]);
        for (i, (_, color)) in looks.iter().enumerate() {
            assert!(looks[..i].iter().all(|(_, other)| other != color), "{looks:?}");
        }
    }

    #[test]
    fn a_mode_without_a_name_looks_as_what_the_site_does() {
        let all = [("stick", ModeKind::Stick), ("flight", ModeKind::Flight)];
        let flight = ("flight".to_owned(), kind_color(ModeKind::Flight));
        assert_eq!(looks(&[], all.into_iter())[0], flight);
    }
}

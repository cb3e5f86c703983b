//! What a user should know before trusting a result.

use serde::{Deserialize, Serialize};

/// What a warning is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Code {
    /// The run is longer than it is predictable.
    Horizon,
    /// An event that hardly is one: a change of the tolerance changes the sequence.
    Grazing,
    /// Another sequence of events than tight runs have.
    Events,
    /// A reference that only its own method comes near.
    Reference,
    /// Very many events.
    Chatter,
    /// Equations that are not smooth past the surface of their mode.
    NotSmooth,
    /// A contact law that delivers another restitution than it is asked for.
    Restitution,
    /// The energy of a run does not balance.
    Energy,
    /// What only takes energy has given some.
    Dissipation,
    /// A contact deeper than its law holds for.
    Penetration,
    /// A contact whose depth or force has the wrong sign.
    Contact,
    /// A quantity computed from the states that is no number somewhere.
    NotANumber,
    /// A value that changes nothing.
    Unused,
    /// An explicit method on a contact that damps so strongly that stability bounds its steps.
    Stiff,
}

impl Code {
    /// Whether it is about a run whose numbers are wrong, and not about a motion that is hard.
    pub fn is_of_a_wrong_run(self) -> bool {
        matches!(self, Self::Energy | Self::Dissipation)
    }

    /// As the JSON writes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Horizon => "horizon",
            Self::Grazing => "grazing",
            Self::Events => "events",
            Self::Reference => "reference",
            Self::Chatter => "chatter",
            Self::NotSmooth => "not_smooth",
            Self::Restitution => "restitution",
            Self::Energy => "energy",
            Self::Dissipation => "dissipation",
            Self::Penetration => "penetration",
            Self::Contact => "contact",
            Self::NotANumber => "not_a_number",
            Self::Unused => "unused",
            Self::Stiff => "stiff",
        }
    }
}

/// A warning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Warning {
    /// What it is about.
    pub code: Code,
    /// The text, with numbers.
    pub message: String,
}

impl Warning {
    /// The warning with the name of the part or site that it is about before its text.
    pub fn of(&self, name: &str) -> Self {
        Self { code: self.code, message: format!("{}{}", place(name), self.message) }
    }
}

/// Where a message is about: `joint 1: `; nothing of what has no name.
pub fn place(name: &str) -> String {
    if name.is_empty() { String::new() } else { format!("{name}: ") }
}

#[cfg(test)]
mod tests {
    use super::Code;

    #[test]
    fn energy_that_is_not_there_tells_of_a_wrong_run_and_a_hard_motion_does_not() {
        assert!(Code::Energy.is_of_a_wrong_run() && Code::Dissipation.is_of_a_wrong_run());
        for code in [Code::Horizon, Code::Grazing, Code::Chatter, Code::Penetration, Code::Stiff] {
            assert!(!code.is_of_a_wrong_run(), "{}", code.name());
        }
    }
}

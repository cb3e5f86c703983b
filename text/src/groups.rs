//! The groups of states: vectors in the measure of errors.

use std::collections::HashMap;

use crate::declarations::{Declarations, StateDeclaration};
use crate::report::{Checked, Complaint};
use crate::units::Unit;

/// Checks that a group has a name of its own, and one unit. A state without a group is a group of its own.
pub(crate) fn check_groups(file: &Declarations) -> Checked<()> {
    let by_name = file.states.iter().map(|state| (state.name.value.as_str(), state)).collect();
    let mut units = HashMap::new();
    for state in &file.states {
        let Some(group) = &state.group else { continue };
        let name = group.value.as_str();
        if let Some(other) = state_called(name, &by_name)
            && other.group.as_ref().is_none_or(|own| own.value != name)
        {
            let message = format!("`{}` is a state outside the group `{name}`", other.name.value);
            return Err(Complaint::new(group.span, message)
                .and(other.name.span, "this state")
                .help("give the group another name, or give the state this `group`"));
        }
        let Some(given) = &state.unit else { continue };
        let Some(unit) = Unit::parse(&given.value) else { continue };
        let (first_unit, first_span) = *units.entry(name).or_insert((unit, given.span));
        if !unit.is(first_unit) {
            let message = format!("the states of the group `{name}` differ in their units");
            return Err(Complaint::new(given.span, message)
                .and(first_span, "the other one")
                .help("a group is a vector in one unit, such as X and Y of a pin: make two groups of these"));
        }
    }
    Ok(())
}

/// The state of this name, or the vector that it is one of.
fn state_called<'a>(
    name: &str,
    by_name: &HashMap<&str, &'a StateDeclaration>,
) -> Option<&'a StateDeclaration> {
    let vector = || {
        let (name, _) = name.split_once('[')?;
        by_name.get(name).filter(|state| state.length.is_some())
    };
    by_name.get(name).or_else(vector).copied()
}

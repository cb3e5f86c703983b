//! What a file declares and does not use: most often a slip in a name.

use crate::declarations::{Declarations, Equation, EventDeclaration, Follows};
use crate::document::At;
use crate::expression::Expression;
use crate::report::Complaint;

/// Parameters that no formula has, discrete values that no event sets, and modes that no event leads to.
pub(crate) fn leftovers(file: &Declarations) -> Vec<Complaint> {
    let mut used: Vec<&str> = Vec::new();
    for formula in formulas(file) {
        formula.for_each_name(&mut |name| used.push(name));
    }
    let set: Vec<&str> = sets(file).map(|equation| equation.target.value.as_str()).collect();
    let reached = reached(file);
    let parameters = file.parameters.iter().map(|parameter| &parameter.name);
    let parameters = left(parameters, &used, "no formula has the parameter");
    let discrete = file.discrete.iter().map(|value| &value.name);
    let discrete = left(discrete, &set, "no event sets the discrete value");
    let modes = file.modes.iter().map(|mode| &mode.name);
    let modes = left(modes, &reached, "no event leads from the first mode to the mode");
    parameters.chain(discrete).chain(modes).collect()
}

fn left<'a>(
    all: impl Iterator<Item = &'a At<String>>,
    known: &[&str],
    message: &str,
) -> impl Iterator<Item = Complaint> {
    all.filter(|name| !known.contains(&name.value.as_str()))
        .map(move |At { value, span }| Complaint::new(*span, format!("{message} `{value}`")))
}

/// The names of the modes that the run may come to.
fn reached(file: &Declarations) -> Vec<&str> {
    let first = file.mode.as_ref().or(file.modes.first().map(|mode| &mode.name));
    let mut reached: Vec<&str> = first.map(|name| name.value.as_str()).into_iter().collect();
    let mut n_followed = 0;
    while let Some(name) = reached.get(n_followed).copied() {
        n_followed += 1;
        let own = file.modes.iter().filter(|mode| mode.name.value == name);
        let events = own.flat_map(|mode| &mode.events);
        for to in events.flat_map(follows).filter_map(|own| own.to.as_ref()) {
            if !reached.contains(&to.value.as_str()) {
                reached.push(&to.value);
            }
        }
    }
    reached
}

fn follows(event: &EventDeclaration) -> impl Iterator<Item = &Follows> {
    std::iter::once(&event.follows).chain(&event.rest)
}

/// What events set.
fn sets(file: &Declarations) -> impl Iterator<Item = &Equation> {
    let events = file.modes.iter().flat_map(|mode| &mode.events);
    events.flat_map(follows).flat_map(|own| &own.set)
}

/// All formulas of a file.
fn formulas(file: &Declarations) -> impl Iterator<Item = &Expression> {
    let definitions = file.modes.iter().flat_map(|mode| &mode.definitions);
    let definitions = definitions.chain(&file.definitions);
    let events = || file.modes.iter().flat_map(|mode| &mode.events);
    let indices = definitions.clone().filter_map(|own| own.indices.as_ref());
    let indices = indices.chain(events().filter_map(|event| event.indices.as_ref()));
    let states = file.states.iter();
    let equations = file.modes.iter().flat_map(|mode| &mode.rates).chain(&file.rates);
    let equations = equations.chain(sets(file)).chain(file.parts.iter().flat_map(|own| &own.start));
    let named = file.modes.iter().flat_map(|mode| &mode.keep).chain(&file.discrete);
    definitions
        .map(|definition| &definition.value)
        .chain(indices.flat_map(|own| [&own.first, &own.last]))
        .chain(states.flat_map(|own| [&own.start, &own.length, &own.scale].into_iter().flatten()))
        .chain(equations.flat_map(|own| own.index.iter().chain([&own.value])))
        .chain(named.map(|own| &own.value))
        .chain(events().flat_map(|event| [&event.when.left, &event.when.right]))
        .chain(file.contact.iter().flatten())
        .chain(file.energy.iter().flatten().flatten())
        .chain(file.power.iter().flatten())
}

//! Which parameters change how many states and observables there are.

use crate::declarations::Declarations;
use crate::expression::Expression;

/// The names of the parameters that the lengths of states and the indices of observables are made of.
pub(crate) fn parameters_of_shape(file: &Declarations) -> Vec<&str> {
    let definitions = || {
        let of_modes = file.modes.iter().flat_map(|mode| &mode.definitions);
        file.definitions.iter().chain(of_modes)
    };
    let lengths = file.states.iter().filter_map(|state| state.length.as_ref());
    let observed = definitions().filter(|definition| definition.is_observable);
    let bounds = observed.filter_map(|definition| definition.indices.as_ref());
    let bounds = bounds.flat_map(|indices| [&indices.first, &indices.last]);
    let mut open: Vec<&Expression> = lengths.chain(bounds).collect();
    let mut seen: Vec<&str> = Vec::new();
    while let Some(formula) = open.pop() {
        formula.for_each_name(&mut |name| {
            if !seen.contains(&name) {
                seen.push(name);
                let own = definitions().filter(|definition| definition.name.value == name);
                open.extend(own.map(|definition| &definition.value));
            }
        });
    }
    let is_parameter = |name: &&str| file.parameters.iter().any(|own| own.name.value == **name);
    seen.retain(is_parameter);
    seen
}

//! The columns of tables: states and observables.

use std::collections::{HashMap, HashSet};

use deltazero_study::problem::Quantity;

use crate::declarations::{Declarations, Definition};
use crate::document::At;
use crate::report::{Checked, Complaint};

/// Columns that tables have beside those of a model.
const OWN: [&str; 5] = ["t_s", "mode", "part", "run", "status"];

/// Every definition that is an observable: those of all modes, then those that stand in modes alone.
pub(crate) fn observable(file: &Declarations) -> Vec<&Definition> {
    let of_modes = file.modes.iter().flat_map(|mode| &mode.definitions);
    let all = file.definitions.iter().chain(of_modes);
    let mut known = HashSet::new();
    all.filter(|own| own.is_observable && known.insert(&own.name.value)).collect()
}

/// The units of the columns of observables that have one.
pub(crate) fn units_of_columns(file: &Declarations) -> HashMap<&str, &At<String>> {
    let all = observable(file).into_iter();
    all.filter_map(|own| Some((own.name.value.as_str(), own.unit.as_ref()?))).collect()
}

/// Checks that each column has a name of its own.
pub(crate) fn check_columns(file: &Declarations) -> Checked<()> {
    let states = file.states.iter();
    let states = states.map(|own| (&own.name, &own.unit, own.length.is_some()));
    let observables = observable(file).into_iter();
    let observables = observables.map(|own| (&own.name, &own.unit, own.indices.is_some()));
    let mut known = HashMap::new();
    for (name, unit, is_vector) in states.chain(observables) {
        let column = column(name, unit.as_ref(), is_vector);
        if OWN.contains(&&*column) {
            let message = format!("tables have a column `{column}` of their own");
            return Err(Complaint::new(name.span, message).help("give it another name"));
        }
        if let Some(before) = known.insert(column, name.span) {
            let message = format!("`{}` has the same column in tables as another", name.value);
            let complaint = Complaint::new(name.span, message).and(before, "the other one");
            return Err(
                complaint.help("a column is called by name and unit; give one another name")
            );
        }
    }
    Ok(())
}

/// The name of a column in tables. That of a vector stands for those of all its indices.
fn column(name: &At<String>, unit: Option<&At<String>>, is_vector: bool) -> String {
    let index = if is_vector { "[]" } else { "" };
    let unit = unit.map_or("", |unit| &unit.value).to_owned();
    Quantity::new(format!("{}{index}", name.value), unit, 1.0).header()
}

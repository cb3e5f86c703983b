//! The columns of tables: states and observables.

use std::collections::{HashMap, HashSet};

use deltazero_study::problem::Quantity;

use crate::declarations::{Declarations, Definition};
use crate::document::At;
use crate::report::{Checked, Complaint};
use crate::units::Unit;

/// Columns that tables have beside those of a model.
const OWN: [&str; 5] = ["t_s", "mode", "part", "run", "status"];

/// Every definition that is an observable: those of all modes, then those that stand in modes alone.
pub(crate) fn observable(file: &Declarations) -> Vec<&Definition> {
    let mut known = HashSet::new();
    definitions(file).filter(|own| own.is_observable && known.insert(&own.name.value)).collect()
}

/// All definitions, those of modes last.
fn definitions(file: &Declarations) -> impl Iterator<Item = &Definition> {
    file.definitions.iter().chain(file.modes.iter().flat_map(|mode| &mode.definitions))
}

/// The units of the columns of observables that have one: the first that a definition of the name gives.
pub(crate) fn units_of_columns(file: &Declarations) -> HashMap<&str, &At<String>> {
    let names: HashSet<&str> =
        observable(file).into_iter().map(|own| own.name.value.as_str()).collect();
    let mut units = HashMap::new();
    for Definition { name, unit, .. } in definitions(file) {
        if let Some(unit) = unit.as_ref().filter(|_| names.contains(name.value.as_str())) {
            units.entry(name.value.as_str()).or_insert(unit);
        }
    }
    units
}

/// Checks that each column has a name of its own, and one unit.
pub(crate) fn check_columns(file: &Declarations) -> Checked<()> {
    let units = units_of_columns(file);
    check_units_of_columns(file, &units)?;
    let states = file.states.iter();
    let states = states.map(|own| (&own.name, own.unit.as_ref(), own.length.is_some()));
    let observables = observable(file).into_iter().map(|own| {
        let unit = units.get(own.name.value.as_str()).copied();
        (&own.name, unit, own.indices.is_some())
    });
    let mut known = HashMap::new();
    for (name, unit, is_vector) in states.chain(observables) {
        let column = column(name, unit, is_vector);
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

/// Checks that the definitions of one column, each of another mode, give it one unit.
fn check_units_of_columns(file: &Declarations, units: &HashMap<&str, &At<String>>) -> Checked<()> {
    for own in definitions(file) {
        let name = &own.name.value;
        if let (Some(unit), Some(first)) = (&own.unit, units.get(name.as_str()))
            && differ(&unit.value, &first.value)
        {
            let message = format!(
                "`{name}` is in `{}` here and in `{}` elsewhere, and both have one column in tables",
                unit.value, first.value
            );
            return Err(Complaint::new(unit.span, message)
                .and(first.span, "the other one")
                .help("give both one unit, or one of them another name"));
        }
    }
    Ok(())
}

/// Whether these are two units.
fn differ(a: &str, b: &str) -> bool {
    match (Unit::parse(a), Unit::parse(b)) {
        (Some(a), Some(b)) => !a.is(b),
        _ => a != b,
    }
}

/// The name of a column in tables. That of a vector stands for those of all its indices.
fn column(name: &At<String>, unit: Option<&At<String>>, is_vector: bool) -> String {
    let index = if is_vector { "[]" } else { "" };
    let unit = unit.map_or("", |unit| &unit.value).to_owned();
    Quantity::new(format!("{}{index}", name.value), unit, 1.0).header()
}

//! What is told of a mode beside its motion: contact, energies, powers, observables.

use std::ops::RangeInclusive;

use deltazero_study::problem::Quantity;

use super::{each_of, indices};
use crate::columns::{observable, units_of_columns};
use crate::declarations::{Declarations, Definition, ModeRole};
use crate::derivative::along_flow;
use crate::dimensions::contact_factors;
use crate::expand::{Expander, Outside};
use crate::expression::Expression;
use crate::graph::Id;
use crate::names::Meaning;
use crate::program::Program;
use crate::report::{Checked, Complaint};
use crate::system::Told;

/// Compiles what is told of a mode with these rates.
pub(super) fn told(
    expander: &mut Expander<'_>,
    mode: usize,
    rates: &[Id],
    observables: &[Observable<'_>],
) -> Checked<Told> {
    expander.outside = Outside::Zero;
    let told = told_within(expander, mode, rates, observables);
    expander.outside = Outside::Refused;
    told
}

fn told_within(
    expander: &mut Expander<'_>,
    mode: usize,
    rates: &[Id],
    observables: &[Observable<'_>],
) -> Checked<Told> {
    let touch = touch(expander, mode, rates)?;
    let energy = energy(expander, mode)?;
    let mut power = Vec::new();
    for own in &expander.file.power {
        power.push(optional(expander, own.as_ref())?);
    }
    let observables = observed(expander, observables)?;
    let graph = &expander.graph;
    Ok(Told {
        touch: Program::of(graph, &touch),
        energy: Program::of(graph, &energy),
        power: Program::of(graph, &power),
        observables: Program::of(graph, &observables),
    })
}

fn optional(expander: &mut Expander<'_>, formula: Option<&Expression>) -> Checked<Id> {
    match formula {
        Some(formula) => expander.node(formula),
        None => Ok(expander.graph.constant(0.0)),
    }
}

/// Whether some mode is one of contact.
fn has_contact(file: &Declarations) -> bool {
    file.modes.iter().any(|mode| mode.role != ModeRole::Free)
}

/// Warns of a contact that no mode has: its force is zero in all of them.
pub(super) fn warn_of_contact(file: &Declarations, warnings: &mut Vec<Complaint>) {
    if let (Some([_, force]), false) = (&file.contact, has_contact(file)) {
        let message = "no mode is one of contact, so this force is zero in all of them";
        warnings.push(Complaint::new(force.span, message).help("give a mode `role = \"contact\"`"));
    }
}

/// Depth [m], its rate along the flow [m/s], and the force [N], which counts in contact alone.
fn touch(expander: &mut Expander<'_>, mode: usize, rates: &[Id]) -> Checked<Vec<Id>> {
    let file = expander.file;
    let Some([depth, force]) = &file.contact else { return Ok(Vec::new()) };
    let [metres, newtons] =
        contact_factors(file, expander.names, mode).map(|factor| expander.graph.constant(factor));
    let depth = expander.node(depth)?;
    let depth = expander.graph.multiply(depth, metres);
    let rate = along_flow(&mut expander.graph, depth, rates);
    let force = if file.modes[mode].role == ModeRole::Free {
        expander.graph.constant(0.0)
    } else {
        let force = expander.node(force)?;
        expander.graph.multiply(force, newtons)
    };
    Ok(vec![depth, rate, force])
}

/// Kinetic and elastic energy. The elastic one counts in contact, where the mode's own definitions make it, and in a model
/// without contact.
fn energy(expander: &mut Expander<'_>, mode: usize) -> Checked<Vec<Id>> {
    let file = expander.file;
    let Some([kinetic, elastic]) = &file.energy else { return Ok(Vec::new()) };
    let kinetic = optional(expander, kinetic.as_ref())?;
    expander.used_own = false;
    let elastic = optional(expander, elastic.as_ref());
    let counts = file.modes[mode].role != ModeRole::Free || !has_contact(file);
    let elastic = match elastic {
        // A formula that is wrong shows in contact.
        Err(complaint) if counts => return Err(complaint),
        Ok(elastic) if counts || expander.used_own => elastic,
        _ => expander.graph.constant(0.0),
    };
    Ok(vec![kinetic, elastic])
}

/// An observable with its indices, which are the same in all modes: each has a column in tables.
pub(super) struct Observable<'a> {
    definition: &'a Definition,
    unit: &'a str,
    indices: Option<RangeInclusive<i64>>,
}

/// The observables that exist in some mode.
pub(super) fn observables<'a>(expander: &mut Expander<'a>) -> Checked<Vec<Observable<'a>>> {
    let file = expander.file;
    let all = observable(file);
    // The first mode where each exists, and its indices there.
    let mut found = vec![None; all.len()];
    for mode in 0..file.modes.len() {
        expander.enter(mode);
        for (definition, found) in all.iter().zip(&mut found) {
            let Some(here) = definition_here(expander, definition) else { continue };
            let indices = indices(expander, here).map_err(|complaint| complaint.or_help(OF))?;
            match found {
                None => *found = Some((mode, indices)),
                Some((before, first)) if *first != indices => {
                    return Err(other_indices(file, here, [*before, mode]));
                }
                Some(_) => {}
            }
        }
    }
    let units = units_of_columns(file);
    let observable = |(definition, found): (&'a Definition, Option<(usize, _)>)| {
        let unit = units.get(definition.name.value.as_str()).map_or("", |unit| &unit.value);
        Some(Observable { definition, unit, indices: found?.1 })
    };
    Ok(all.into_iter().zip(found).filter_map(observable).collect())
}

/// The definition that the name of an observable stands for in this mode; none where it does not exist.
fn definition_here<'a>(expander: &Expander<'a>, observable: &Definition) -> Option<&'a Definition> {
    let (file, mode) = (expander.file, expander.mode()?);
    let name = &observable.name;
    let here = match expander.names.meaning(&name.value, name.span, Some(mode)) {
        Ok(Meaning::Common(i)) => &file.definitions[i],
        Ok(Meaning::OfMode(i)) => &file.modes[mode].definitions[i],
        _ => return None,
    };
    expander.exists(here).then_some(here)
}

fn other_indices(file: &Declarations, here: &Definition, modes: [usize; 2]) -> Complaint {
    let [before, mode] = modes.map(|mode| &file.modes[mode].name.value);
    let name = &here.name;
    let span = here.indices.as_ref().map_or(name.span, |indices| indices.span);
    let message =
        format!("`{}` has other indices in the mode `{mode}` than in `{before}`", name.value);
    Complaint::new(span, message).help(
        "an observable has a column in tables for each index, the same in all modes: give its `for` the same bounds in all of them",
    )
}

/// The observables in a mode; zero is one that does not exist there.
fn observed(expander: &mut Expander<'_>, observables: &[Observable<'_>]) -> Checked<Vec<Id>> {
    let mut all = Vec::new();
    for Observable { definition, indices, .. } in observables {
        let name = &definition.name;
        let is_here = definition_here(expander, definition).is_some();
        for index in each_of(indices.clone()) {
            let at = index.map(|i| (i, name.span));
            all.push(if is_here {
                let node = expander.named(&name.value, at, name.span);
                node.map_err(|complaint| complaint.or_help(OF))?
            } else {
                expander.graph.constant(0.0)
            });
        }
    }
    Ok(all)
}

/// What is told where an observable cannot be made in a mode.
const OF: &str = "an observable is told in all modes; `of = [\"a mode\"]` says where it exists";

/// The columns of the observables.
pub(super) fn columns(observables: &[Observable<'_>]) -> Vec<Quantity> {
    let mut all = Vec::new();
    for Observable { definition: Definition { name, .. }, unit, indices } in observables {
        for index in each_of(indices.clone()) {
            let name = match index {
                None => name.value.clone(),
                Some(i) => format!("{}[{i}]", name.value),
            };
            all.push(Quantity::new(name, (*unit).to_owned(), 1.0));
        }
    }
    all
}

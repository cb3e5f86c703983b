//! What is told of a mode beside its motion: contact, energies, powers, observables.

use super::instances;
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
    observable: &[&Definition],
) -> Checked<Told> {
    expander.outside = Outside::Zero;
    let told = told_within(expander, mode, rates, observable);
    expander.outside = Outside::Refused;
    told
}

fn told_within(
    expander: &mut Expander<'_>,
    mode: usize,
    rates: &[Id],
    observable: &[&Definition],
) -> Checked<Told> {
    let touch = touch(expander, mode, rates)?;
    let energy = energy(expander, mode)?;
    let mut power = Vec::new();
    for own in &expander.file.power {
        power.push(optional(expander, own.as_ref())?);
    }
    let observables = observed(expander, mode, observable)?;
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

/// The observables in a mode; zero is one that does not exist there.
fn observed(
    expander: &mut Expander<'_>,
    mode: usize,
    observable: &[&Definition],
) -> Checked<Vec<Id>> {
    let mut all = Vec::new();
    for definition in observable {
        let name = &definition.name;
        let meaning = expander.names.meaning(&name.value, name.span, Some(mode));
        let is_here = matches!(meaning, Ok(Meaning::Common(_) | Meaning::OfMode(_)));
        for index in instances(expander, definition)? {
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

/// Names and units of the observables.
pub(super) fn observables(
    expander: &mut Expander<'_>,
    observable: &[&Definition],
) -> Checked<Vec<(String, String)>> {
    let mut all = Vec::new();
    for definition in observable {
        let Definition { name, unit, .. } = definition;
        let unit = unit.as_ref().map_or(String::new(), |unit| unit.value.clone());
        for index in instances(expander, definition)? {
            let name = match index {
                None => name.value.clone(),
                Some(i) => format!("{}[{i}]", name.value),
            };
            all.push((name, unit.clone()));
        }
    }
    Ok(all)
}

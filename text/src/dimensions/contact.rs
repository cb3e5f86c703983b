//! The units of a contact, which tables and figures tell in metres and newtons.

use super::{Check, Known};
use crate::declarations::{Declarations, ModeRole};
use crate::names::Names;
use crate::report::Complaint;
use crate::units::Unit;

/// What the tables of contacts are in.
const TOLD_IN: [(&str, &str); 2] = [("depth", "m"), ("force", "N")];

/// Metres in the unit of a contact's depth in a mode, and newtons in that of its force; 1 for a unit that is not known, or of
/// something else, which is [warned of](contact_units).
pub(crate) fn contact_factors(file: &Declarations, names: &Names, mode: usize) -> [f64; 2] {
    told_units(file, names, mode).map(factor)
}

fn factor((found, told): (Known, Unit)) -> f64 {
    match found {
        Known::Unit(unit, _) if !found.fits(Known::unit(told)) => {
            unit.factor_over(told).unwrap_or(1.0)
        }
        _ => 1.0,
    }
}

/// Warns of a contact whose depth is no length or whose force is no force, and of one of which only one has a known unit that is
/// converted: tables and figures label them m and N.
pub(crate) fn contact_units(file: &Declarations, names: &Names) -> Vec<Complaint> {
    let mut all = Vec::new();
    let in_contact = |mode: &usize| file.modes[*mode].role != ModeRole::Free;
    for mode in (0..file.modes.len()).filter(in_contact) {
        let of_formulas = file.contact.iter().flatten().zip(TOLD_IN);
        let units = told_units(file, names, mode);
        let is_converted = units.into_iter().any(|unit| factor(unit) != 1.0);
        for ((formula, (what, symbol)), unit) in of_formulas.zip(units) {
            let (found, told) = unit;
            if matches!(found, Known::Open) && is_converted {
                let message =
                    format!("the unit of this {what} is not known, so it is taken for {symbol}");
                all.push(Complaint::new(formula.span, message).help(
                    "a name without a unit stands in it: make it a definition with its `unit`",
                ));
            }
            if let Known::Unit(unit, n) = found
                && n != 1.0
                && unit.factor_over(told).is_some_and(|ratio| ratio != 1.0)
            {
                let message = format!(
                    "the numbers in this {what}, which {unit} without them, are taken to convert it to {symbol}"
                );
                all.push(Complaint::new(formula.span, message).help(
                    "if they do not, make each a parameter with its `unit`, `1` where it has none",
                ));
            }
            if let Known::Unit(unit, _) = found
                && unit.factor_over(told).is_none()
            {
                let message =
                    format!("the {what} of a contact is told in {symbol}, and this {unit}");
                all.push(Complaint::new(formula.span, message).help(
                    "give a length and a force; else columns named m and N hold the file's own units",
                ));
            }
        }
    }
    all
}

/// What is known of the units of a contact's depth and force in a mode, each with the one that it is told in.
fn told_units(file: &Declarations, names: &Names, mode: usize) -> [(Known, Unit); 2] {
    let mut check = Check::new(file, names, Some(mode));
    std::array::from_fn(|i| {
        let formula = file.contact.as_ref().map(|contact| &contact[i]);
        let found = formula.and_then(|formula| check.unit(formula).ok());
        (found.unwrap_or(Known::Open), Unit::parse(TOLD_IN[i].1).unwrap_or(Unit::ONE))
    })
}

//! Whether both sides of each equation have the same unit, where units are given.
//!
//! A name without a unit and a number fit anything, and so does what is made of them by a product.

use std::collections::HashMap;

use crate::declarations::{Declarations, Definition, Equation, Follows, ModeDeclaration, ModeRole};
use crate::document::At;
use crate::expression::{Expression, Kind, Operator};
use crate::names::{Meaning, Names};
use crate::report::{Checked, Complaint, Span};
use crate::units::Unit;

/// Formulas within each other that are looked through.
const DEEPEST: usize = 300;

/// A unit, or none that is known.
type Known = Option<Unit>;

/// Checks the units of a file, if it gives any.
pub(crate) fn check_units(file: &Declarations, names: &Names) -> Checked<()> {
    if !units(file).any(|unit| parsed(Some(unit)).is_some()) {
        return Ok(());
    }
    let mut check = Check { file, names, mode: None, known: HashMap::new(), depth: 0 };
    for (i, state) in file.states.iter().enumerate() {
        let own = check.of_state(i);
        for formula in state.start.iter().chain(&state.scale) {
            check.expect(formula, own, &format!("`{}`", state.name.value))?;
        }
    }
    for (i, mode) in file.modes.iter().enumerate() {
        check.mode = Some(i);
        check.known.clear();
        check.mode(mode)?;
    }
    Ok(())
}

struct Check<'a> {
    file: &'a Declarations,
    names: &'a Names,
    mode: Option<usize>,
    /// Units of definitions and kept values in this mode.
    known: HashMap<Meaning, Known>,
    depth: usize,
}

/// Warns of units that are not read: nothing is checked with them.
pub(crate) fn unread_units(file: &Declarations) -> impl Iterator<Item = Complaint> {
    let unread = units(file).filter(|unit| parsed(Some(unit)).is_none());
    unread.map(|At { value, span }| {
        let message = format!("the unit `{value}` is not read, and nothing is checked with it");
        Complaint::new(*span, message)
            .help("a product has spaces, one `/` stands before a symbol or parentheses: `N s/m`, `J/(kg K)`")
    })
}

/// What the tables of contacts are in.
const TOLD_IN: [(&str, &str); 2] = [("depth", "m"), ("force", "N")];

/// Metres in the unit of a contact's depth in a mode, and newtons in that of its force; 1 for a unit that is not known, or of
/// something else, which is [warned of](contact_units).
pub(crate) fn contact_factors(file: &Declarations, names: &Names, mode: usize) -> [f64; 2] {
    told_units(file, names, mode).map(factor)
}

fn factor(unit: Option<(Unit, Unit)>) -> f64 {
    unit.and_then(|(unit, told)| unit.factor_over(told)).unwrap_or(1.0)
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
            if unit.is_none() && is_converted {
                let message =
                    format!("the unit of this {what} is not known, so it is taken for {symbol}");
                all.push(Complaint::new(formula.span, message).help(
                    "a number in a product has no unit: make it a definition with its `unit`",
                ));
            }
            if let Some((unit, told)) = unit
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

/// The units of a contact's depth and force in a mode, each with the one that it is told in; none where they are not known.
fn told_units(file: &Declarations, names: &Names, mode: usize) -> [Option<(Unit, Unit)>; 2] {
    let Some(contact) = &file.contact else { return [None; 2] };
    let mut check = Check { file, names, mode: Some(mode), known: HashMap::new(), depth: 0 };
    std::array::from_fn(|i| check.unit(&contact[i]).ok().flatten().zip(Unit::parse(TOLD_IN[i].1)))
}

/// All units that a file gives.
fn units(file: &Declarations) -> impl Iterator<Item = &At<String>> {
    let of_modes = file.modes.iter().flat_map(|mode| &mode.definitions);
    let definitions = file.definitions.iter().chain(of_modes);
    let parameters = file.parameters.iter().map(|parameter| &parameter.unit);
    let states = file.states.iter().map(|state| &state.unit);
    parameters.chain(states).chain(definitions.map(|definition| &definition.unit)).flatten()
}

fn parsed(unit: Option<&At<String>>) -> Known {
    unit.and_then(|unit| Unit::parse(&unit.value))
}

impl<'a> Check<'a> {
    fn of_state(&self, state: usize) -> Known {
        parsed(self.file.states[state].unit.as_ref())
    }

    fn mode(&mut self, mode: &'a ModeDeclaration) -> Checked<()> {
        let file = self.file;
        for definition in file.definitions.iter().chain(&mode.definitions) {
            let name = &definition.name;
            if let Some(meaning) = self.meaning(&name.value) {
                self.definition(definition, meaning)?;
            }
        }
        for equation in mode.rates.iter().chain(&file.rates) {
            let unit = self.of_target(equation).map(|unit| unit.over(Unit::SECOND));
            let name = &equation.target.value;
            self.expect(&equation.value, unit, &format!("the rate of `{name}`"))?;
        }
        for event in &mode.events {
            let left = self.unit(&event.when.left)?;
            let right = self.unit(&event.when.right)?;
            let sides = [(left, event.when.left.span), (right, event.when.right.span)];
            same(sides, "these are compared")?;
            self.follows(&event.follows)?;
            event.rest.iter().try_for_each(|rest| self.follows(rest))?;
        }
        for formula in file.energy.iter().flatten().flatten() {
            self.expect(formula, Some(Unit::JOULE), "an energy")?;
        }
        let watt = Unit::JOULE.over(Unit::SECOND);
        file.power
            .iter()
            .flatten()
            .try_for_each(|formula| self.expect(formula, Some(watt), "a power"))
    }

    fn follows(&mut self, follows: &'a Follows) -> Checked<()> {
        follows.set.iter().try_for_each(|equation| {
            let unit = self.of_target(equation);
            let name = &equation.target.value;
            self.expect(&equation.value, unit, &format!("`{name}`"))
        })
    }

    fn of_target(&self, equation: &Equation) -> Known {
        match self.meaning(&equation.target.value)? {
            Meaning::State(state) => self.of_state(state),
            _ => None,
        }
    }

    /// What a name means; none for an index, or a name that is not known, which is told elsewhere.
    fn meaning(&self, name: &str) -> Option<Meaning> {
        self.names.meaning(name, Span { start: 0, end: 0 }, self.mode).ok()
    }

    fn expect(&mut self, formula: &'a Expression, unit: Known, what: &str) -> Checked<()> {
        match (self.unit(formula)?, unit) {
            (Some(found), Some(unit)) if !found.is(unit) => {
                let message = format!("{what} {unit}, and this {found}");
                Err(Complaint::new(formula.span, message))
            }
            _ => Ok(()),
        }
    }

    fn unit(&mut self, formula: &'a Expression) -> Checked<Known> {
        if self.depth == DEEPEST {
            return Ok(None);
        }
        self.depth += 1;
        let unit = self.unit_within(formula);
        self.depth -= 1;
        unit
    }

    fn unit_within(&mut self, formula: &'a Expression) -> Checked<Known> {
        match &formula.kind {
            Kind::Number(_) => Ok(None),
            Kind::Name(name) | Kind::Element(name, _) => self.named(name),
            Kind::Negative(inner) => self.unit(inner),
            Kind::Chain(first, rest) => self.chain(first, rest),
            Kind::Power(base, exponent) => self.power(base, exponent),
            Kind::Call(name, arguments) => self.call(name, arguments),
            Kind::Sum(sum) => self.unit(&sum.1),
            Kind::Choice(choice) => {
                let (_, yes, no) = &**choice;
                let sides = [(self.unit(yes)?, yes.span), (self.unit(no)?, no.span)];
                same(sides, "these are two cases of one value")
            }
        }
    }

    fn named(&mut self, name: &str) -> Checked<Known> {
        let (file, Some(meaning)) = (self.file, self.meaning(name)) else { return Ok(None) };
        let of_mode = self.mode.map(|mode| &file.modes[mode]);
        match (meaning, of_mode) {
            (Meaning::Parameter(i), _) => Ok(parsed(file.parameters[i].unit.as_ref())),
            (Meaning::State(i), _) => Ok(self.of_state(i)),
            (Meaning::Common(i), _) => self.definition(&file.definitions[i], meaning),
            (Meaning::OfMode(i), Some(mode)) => self.definition(&mode.definitions[i], meaning),
            (Meaning::Kept(i), Some(mode)) => self.remembered(meaning, &mode.keep[i].value),
            // A model without units has none of time either.
            (Meaning::Time, _) if file.states.iter().any(|state| state.unit.is_some()) => {
                Ok(Some(Unit::SECOND))
            }
            _ => Ok(None),
        }
    }

    /// The unit of a definition, as given, else that of its formula.
    fn definition(&mut self, definition: &'a Definition, meaning: Meaning) -> Checked<Known> {
        let found = self.remembered(meaning, &definition.value)?;
        let Some(given) = parsed(definition.unit.as_ref()) else { return Ok(found) };
        let name = &definition.name.value;
        match found {
            Some(found) if !found.is(given) => {
                let message = format!("`{name}` {given}, and this {found}");
                Err(Complaint::new(definition.value.span, message))
            }
            _ => Ok(Some(given)),
        }
    }

    fn remembered(&mut self, meaning: Meaning, formula: &'a Expression) -> Checked<Known> {
        if let Some(unit) = self.known.get(&meaning) {
            return Ok(*unit);
        }
        // A definition within itself is told elsewhere.
        self.known.insert(meaning, None);
        let unit = self.unit(formula)?;
        self.known.insert(meaning, unit);
        Ok(unit)
    }

    fn chain(
        &mut self,
        first: &'a Expression,
        rest: &'a [(Operator, Expression)],
    ) -> Checked<Known> {
        let (mut unit, mut span) = (self.unit(first)?, first.span);
        for (operator, next) in rest {
            let own = self.unit(next)?;
            unit = match operator {
                Operator::Add | Operator::Subtract => {
                    same([(unit, span), (own, next.span)], "these are added or subtracted")?
                }
                Operator::Multiply => unit.zip(own).map(|(a, b)| a.times(b)),
                Operator::Divide => unit.zip(own).map(|(a, b)| a.over(b)),
            };
            span = span.to(next.span);
        }
        Ok(unit)
    }

    fn power(&mut self, base: &'a Expression, exponent: &'a Expression) -> Checked<Known> {
        self.expect(exponent, Some(Unit::ONE), "an exponent")?;
        let unit = self.unit(base)?;
        let number = match &exponent.kind {
            Kind::Number(p) => Some(*p),
            Kind::Negative(inner) => match inner.kind {
                Kind::Number(p) => Some(-p),
                _ => None,
            },
            _ => None,
        };
        Ok(unit.zip(number).map(|(unit, p)| unit.power(p)))
    }

    fn call(&mut self, name: &str, arguments: &'a [Expression]) -> Checked<Known> {
        let mut units = Vec::new();
        for argument in arguments {
            units.push((self.unit(argument)?, argument.span));
        }
        match (name, &units[..]) {
            ("sqrt", [(unit, _)]) => Ok(unit.map(|unit| unit.power(0.5))),
            ("abs", [(unit, _)]) => Ok(*unit),
            ("sign", _) => Ok(Some(Unit::ONE)),
            ("min" | "max" | "hypot", [a, b]) => same([*a, *b], "these stand in one function"),
            ("atan2", [a, b]) => {
                same([*a, *b], "these stand in one function")?;
                Ok(Some(Unit::ONE))
            }
            _ => {
                let what = format!("the argument of `{name}`");
                arguments
                    .iter()
                    .try_for_each(|argument| self.expect(argument, Some(Unit::ONE), &what))?;
                Ok(Some(Unit::ONE))
            }
        }
    }
}

/// The unit that both have, where one is known.
fn same([(a, a_span), (b, b_span)]: [(Known, Span); 2], what: &str) -> Checked<Known> {
    match (a, b) {
        (Some(a), Some(b)) if !a.is(b) => {
            let message = format!("{what}, and their units differ");
            let complaint = Complaint::new(b_span, message).label(format!("this {b}"));
            Err(complaint.and(a_span, format!("this {a}")))
        }
        (a, b) => Ok(a.or(b)),
    }
}

//! Whether both sides of each equation have the same unit, where units are given.
//!
//! | what | its unit |
//! |---|---|
//! | a name without a unit, and what is a product with one | fits anything |
//! | a number in a product | none: `2*K*x` has the unit of `K*x`, but may convert its scale |
//! | a number alone on a side of an equation or a comparison | that of the other side |
//! | 0 | every unit |
//! | another number in a sum | none, so that all else in the sum has none |

mod contact;
mod known;

use std::collections::HashMap;

pub(crate) use contact::{contact_factors, contact_units};
use known::{Known, added, expected, same, strictly_same};

use crate::columns::units_of_columns;
use crate::declarations::{
    Declarations, Definition, Equation, EventDeclaration, ModeDeclaration, ModeRole,
};
use crate::document::At;
use crate::expression::{Comparison, Expression, Kind, Operator};
use crate::names::{Meaning, Names};
use crate::report::{Checked, Complaint, Span};
use crate::units::{Unit, way_out};

/// Formulas within each other that are looked through.
const DEEPEST: usize = 300;

/// Checks the units of a file, if it gives any. Returns what is to be warned of.
pub(crate) fn check_units(file: &Declarations, names: &Names) -> Checked<Vec<Complaint>> {
    if !units(file).any(|unit| Unit::parse(&unit.value).is_some()) {
        return Ok(Vec::new());
    }
    let mut check = Check::new(file, names, None);
    check.columns = units_of_columns(file);
    for (i, state) in file.states.iter().enumerate() {
        let own = check.of_state(i);
        for formula in state.start.iter().chain(&state.scale) {
            let what = format!("`{}`", state.name.value);
            check.within(check.index_of_state(i), |check| check.expect(formula, own, &what))?;
        }
    }
    file.parts.iter().flat_map(|part| &part.start).try_for_each(|start| check.equation(start))?;
    for (i, mode) in file.modes.iter().enumerate() {
        check.mode = Some(i);
        check.known.clear();
        check.mode(mode)?;
    }
    Ok(check.doubts)
}

struct Check<'a> {
    file: &'a Declarations,
    names: &'a Names,
    mode: Option<usize>,
    /// Units of definitions and kept values in this mode.
    known: HashMap<Meaning, Known>,
    /// Units of the columns in tables, which hold the definitions of their name of all modes.
    columns: HashMap<&'a str, &'a At<String>>,
    /// Names of indices, which are numbers.
    indices: Vec<&'a str>,
    depth: usize,
    /// Numbers that are taken to convert units, and hardly do.
    doubts: Vec<Complaint>,
}

/// Warns of units that are not read: nothing is checked with them.
pub(crate) fn unread_units(file: &Declarations) -> impl Iterator<Item = Complaint> {
    let unread = units(file).filter(|unit| Unit::parse(&unit.value).is_none());
    unread.map(|At { value, span }| {
        let message = format!("the unit `{value}` is not read, and nothing is checked with it");
        Complaint::new(*span, message).help(way_out(value))
    })
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
    unit.and_then(|unit| Unit::parse(&unit.value)).map_or(Known::Open, Known::unit)
}

impl<'a> Check<'a> {
    fn new(file: &'a Declarations, names: &'a Names, mode: Option<usize>) -> Self {
        let (known, columns) = (HashMap::new(), HashMap::new());
        let (indices, doubts) = (Vec::new(), Vec::new());
        Self { file, names, mode, known, columns, indices, depth: 0, doubts }
    }

    fn of_state(&self, state: usize) -> Known {
        parsed(self.file.states[state].unit.as_ref())
    }

    /// The index of the formulas of a vector of states.
    fn index_of_state(&self, state: usize) -> Option<&'a str> {
        self.file.states[state].length.is_some().then_some("i")
    }

    /// Does something where the name of an index is known.
    fn within<T>(&mut self, index: Option<&'a str>, own: impl FnOnce(&mut Self) -> T) -> T {
        let n_indices = self.indices.len();
        self.indices.extend(index);
        let done = own(self);
        self.indices.truncate(n_indices);
        done
    }

    fn mode(&mut self, mode: &'a ModeDeclaration) -> Checked<()> {
        let file = self.file;
        for (i, definition) in file.definitions.iter().enumerate() {
            // In a mode with one of its own by this name nothing is made of it.
            let meaning = Meaning::Common(i);
            if self.meaning(&definition.name.value) == Some(meaning) {
                self.definition(definition, meaning)?;
            }
        }
        for (i, definition) in mode.definitions.iter().enumerate() {
            self.definition(definition, Meaning::OfMode(i))?;
        }
        for equation in mode.rates.iter().chain(&file.rates) {
            let unit = self.of_target(equation).over(Known::unit(Unit::SECOND));
            let what = format!("the rate of `{}`", equation.target.value);
            let index = self.index_of_target(equation);
            self.within(index, |own| own.expect(&equation.value, unit, &what))?;
        }
        for event in &mode.events {
            let index = event.indices.as_ref().map(|indices| &*indices.name);
            self.within(index, |own| own.event(event))?;
        }
        for kept in &mode.keep {
            self.unit(&kept.value)?;
        }
        if mode.role != ModeRole::Free {
            for formula in file.contact.iter().flatten() {
                self.unit(formula)?;
            }
        }
        for formula in file.energy.iter().flatten().flatten() {
            self.expect(formula, Known::unit(Unit::JOULE), "an energy")?;
        }
        let watt = Known::unit(Unit::JOULE.over(Unit::SECOND));
        file.power.iter().flatten().try_for_each(|formula| self.expect(formula, watt, "a power"))
    }

    fn event(&mut self, event: &'a EventDeclaration) -> Checked<()> {
        self.comparison(&event.when)?;
        let after = [Some(&event.follows), event.rest.as_ref()];
        let all = after.into_iter().flatten().flat_map(|follows| &follows.set);
        all.into_iter().try_for_each(|equation| self.equation(equation))
    }

    fn comparison(&mut self, comparison: &'a Comparison) -> Checked<()> {
        let Comparison { left, right, .. } = comparison;
        let sides = [(self.unit(left)?, left.span), (self.unit(right)?, right.span)];
        self.same(sides, "these are compared").map(|_| ())
    }

    /// Checks a value that a state is set to.
    fn equation(&mut self, equation: &'a Equation) -> Checked<()> {
        let (unit, index) = (self.of_target(equation), self.index_of_target(equation));
        let what = format!("`{}`", equation.target.value);
        self.within(index, |own| own.expect(&equation.value, unit, &what))
    }

    fn target(&self, equation: &Equation) -> Option<usize> {
        match self.meaning(&equation.target.value)? {
            Meaning::State(state) => Some(state),
            _ => None,
        }
    }

    fn of_target(&self, equation: &Equation) -> Known {
        self.target(equation).map_or(Known::Open, |state| self.of_state(state))
    }

    fn index_of_target(&self, equation: &Equation) -> Option<&'a str> {
        self.target(equation).and_then(|state| self.index_of_state(state))
    }

    /// What a name means; none for an index, or a name that is not known, which is told elsewhere.
    fn meaning(&self, name: &str) -> Option<Meaning> {
        self.names.meaning(name, Span { start: 0, end: 0 }, self.mode).ok()
    }

    fn expect(&mut self, formula: &'a Expression, unit: Known, what: &str) -> Checked<()> {
        let found = self.unit(formula)?;
        self.expected(found, unit, formula.span, what)
    }

    fn expected(&mut self, found: Known, unit: Known, span: Span, what: &str) -> Checked<()> {
        self.doubts.extend(found.doubt(unit, span));
        expected(found, unit, span, what)
    }

    fn same(&mut self, sides: [(Known, Span); 2], what: &str) -> Checked<Known> {
        let [(a, _), (b, span)] = sides;
        self.doubts.extend(a.doubt(b, span));
        same(sides, what)
    }

    fn added(&mut self, a: Known, b: Known, spans: [Span; 2]) -> Checked<Known> {
        self.doubts.extend(a.doubt(b, spans[1]));
        added(a, b, spans)
    }

    fn unit(&mut self, formula: &'a Expression) -> Checked<Known> {
        if self.depth == DEEPEST {
            return Ok(Known::Open);
        }
        self.depth += 1;
        let unit = self.unit_within(formula);
        self.depth -= 1;
        unit
    }

    fn unit_within(&mut self, formula: &'a Expression) -> Checked<Known> {
        match &formula.kind {
            Kind::Number(x) => Ok(Known::Number(Some(*x))),
            Kind::Name(name) | Kind::Element(name, _) => self.named(name),
            Kind::Negative(inner) => Ok(self.unit(inner)?.times(Known::Number(Some(-1.0)))),
            Kind::Chain(first, rest) => self.chain(first, rest),
            Kind::Power(base, exponent) => {
                let power = self.unit(exponent)?;
                self.expected(power, Known::ONE, exponent.span, "an exponent")?;
                Ok(self.unit(base)?.power(power))
            }
            Kind::Call(name, arguments) => self.call(name, arguments),
            Kind::Sum(sum) => match self.within(Some(&sum.0.name), |own| own.unit(&sum.1))? {
                Known::Number(Some(x)) if x != 0.0 => Ok(Known::Number(None)),
                unit => Ok(unit),
            },
            Kind::Choice(choice) => {
                let (condition, yes, no) = &**choice;
                self.comparison(condition)?;
                let sides = [(self.unit(yes)?, yes.span), (self.unit(no)?, no.span)];
                self.same(sides, "these are two cases of one value")
            }
        }
    }

    fn named(&mut self, name: &str) -> Checked<Known> {
        let file = self.file;
        let Some(meaning) = self.meaning(name) else {
            let is_index = self.indices.contains(&name);
            return Ok(if is_index { Known::Number(None) } else { Known::Open });
        };
        let of_mode = self.mode.map(|mode| &file.modes[mode]);
        match (meaning, of_mode) {
            (Meaning::Parameter(i), _) => Ok(parsed(file.parameters[i].unit.as_ref())),
            (Meaning::State(i), _) => Ok(self.of_state(i)),
            (Meaning::Common(i), _) => self.definition(&file.definitions[i], meaning),
            (Meaning::OfMode(i), Some(mode)) => self.definition(&mode.definitions[i], meaning),
            (Meaning::Kept(i), Some(mode)) => self.remembered(meaning, &mode.keep[i].value, None),
            // A model without units has none of time either.
            (Meaning::Time, _) if file.states.iter().any(|state| state.unit.is_some()) => {
                Ok(Known::unit(Unit::SECOND))
            }
            (Meaning::Pi, _) => Ok(Known::Number(Some(std::f64::consts::PI))),
            _ => Ok(Known::Open),
        }
    }

    /// The unit of a definition, as given or as that of its column, else that of its formula.
    fn definition(&mut self, definition: &'a Definition, meaning: Meaning) -> Checked<Known> {
        let index = definition.indices.as_ref().map(|indices| &*indices.name);
        let found = self.remembered(meaning, &definition.value, index)?;
        let name = &definition.name.value;
        let of_column = self.columns.get(name.as_str()).copied();
        let given = parsed(definition.unit.as_ref().or(of_column));
        let fits = self.expected(found, given, definition.value.span, &format!("`{name}`"));
        fits.map_err(|complaint| match (&definition.unit, of_column) {
            (None, Some(unit)) => complaint.and(unit.span, "the unit of its column in tables"),
            _ => complaint,
        })?;
        Ok(if matches!(given, Known::Open) { found } else { given })
    }

    fn remembered(
        &mut self,
        meaning: Meaning,
        formula: &'a Expression,
        index: Option<&'a str>,
    ) -> Checked<Known> {
        if let Some(unit) = self.known.get(&meaning) {
            return Ok(*unit);
        }
        // A definition within itself is told elsewhere.
        self.known.insert(meaning, Known::Open);
        let unit = self.within(index, |own| own.unit(formula))?;
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
                Operator::Add => self.added(unit, own, [span, next.span])?,
                Operator::Subtract => match self.added(unit, own, [span, next.span])? {
                    Known::Number(_) => {
                        Known::Number(unit.value().zip(own.value()).map(|(a, b)| a - b))
                    }
                    sum => sum,
                },
                Operator::Multiply => unit.times(own),
                Operator::Divide => unit.over(own),
            };
            span = span.to(next.span);
        }
        Ok(unit)
    }

    fn call(&mut self, name: &str, arguments: &'a [Expression]) -> Checked<Known> {
        let mut units = Vec::new();
        for argument in arguments {
            units.push((self.unit(argument)?, argument.span));
        }
        match (name, &units[..]) {
            ("sqrt", [(unit, _)]) => Ok(unit.power(Known::Number(Some(0.5)))),
            ("abs", [(Known::Number(x), _)]) => Ok(Known::Number(x.map(f64::abs))),
            ("abs", [(unit, _)]) => Ok(*unit),
            ("min" | "max", [a, b]) => self.same([*a, *b], "these stand in one function"),
            ("hypot", [a, b]) => strictly_same([*a, *b], "these stand in one function"),
            ("atan2", [a, b]) => {
                Ok(strictly_same([*a, *b], "these stand in one function")?.power(Known::ZERO))
            }
            _ => {
                let what = format!("the argument of `{name}`");
                let must = if name == "sign" { Known::Open } else { Known::ONE };
                for (unit, span) in &units {
                    self.expected(*unit, must, *span, &what)?;
                }
                let is_number = units.iter().all(|(unit, _)| matches!(unit, Known::Number(_)));
                Ok(if is_number { Known::Number(None) } else { Known::ONE })
            }
        }
    }
}

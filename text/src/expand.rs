//! From formulas to the graph: names resolved, sums written out, indices and parameters replaced by numbers.

mod call;

use std::collections::HashMap;

use crate::declarations::{Declarations, Definition};
use crate::expression::{Comparison, Expression, Indices, Kind, Operator, Relation};
use crate::graph::{Graph, Id, Node, Sign};
use crate::layout::Layout;
use crate::names::{Meaning, Names};
use crate::report::{Checked, Complaint, Span};

/// Formulas within each other, through definitions too, at most.
const DEEPEST: usize = 600;
/// Nodes of the graph, at most.
const MOST_NODES: usize = 2_000_000;
/// Parts of formulas that are expanded, each as often as it is, at most.
const MOST_WORK: usize = 8_000_000;

/// Parameters that are told with their values, at most.
const MOST_TOLD: usize = 8;

/// Values of an index, at most.
const MOST_INDICES: i64 = 1_000_000;

/// What a definition is outside the modes where it exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Outside {
    /// An error: nothing may be made of it.
    Refused,
    /// Zero, in what is only told.
    Zero,
}

/// Expands formulas into one graph.
pub(crate) struct Expander<'a> {
    pub(crate) file: &'a Declarations,
    pub(crate) names: &'a Names,
    pub(crate) graph: Graph,
    pub(crate) parameters: Vec<f64>,
    pub(crate) layout: Layout,
    pub(crate) outside: Outside,
    /// Where functions stand that are not smooth or not defined everywhere, by their results.
    pub(crate) flawed: HashMap<Id, (Span, &'static str, Flaw)>,
    /// Whether a definition of the mode itself was used.
    pub(crate) used_own: bool,
    /// Events so far.
    pub(crate) n_events: usize,
    mode: Option<usize>,
    indices: Vec<(String, i64)>,
    /// Definitions that are expanded, with their index,
    /// and whether they are made of a definition of the mode itself.
    known: HashMap<(Meaning, i64, Outside), (Id, bool)>,
    /// Definitions that are being expanded.
    open: Vec<(Meaning, i64)>,
    depth: usize,
    work: usize,
}

/// What may be wrong with a function of something that moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Flaw {
    /// It is not smooth somewhere.
    Kink,
    /// There it is not a number.
    Edge(&'static str),
}

/// The flaw of a root, whose argument has this sign.
fn of_root(argument: Sign) -> Option<Flaw> {
    match argument {
        Sign::Unknown => Some(Flaw::Edge("below zero")),
        Sign::Square => Some(Flaw::Kink),
        Sign::Squares | Sign::Above => None,
    }
}

/// The flaw of a logarithm, whose argument has this sign.
fn of_logarithm(argument: Sign) -> Option<Flaw> {
    match argument {
        Sign::Unknown => Some(Flaw::Edge("below zero")),
        Sign::Square | Sign::Squares => Some(Flaw::Edge("at zero")),
        Sign::Above => None,
    }
}

impl<'a> Expander<'a> {
    pub(crate) fn new(file: &'a Declarations, names: &'a Names, parameters: Vec<f64>) -> Self {
        Self {
            file,
            names,
            graph: Graph::default(),
            parameters,
            layout: Layout::default(),
            outside: Outside::Refused,
            flawed: HashMap::new(),
            used_own: false,
            n_events: 0,
            mode: None,
            indices: Vec::new(),
            known: HashMap::new(),
            open: Vec::new(),
            depth: 0,
            work: 0,
        }
    }

    /// Turns to the formulas of a mode.
    pub(crate) fn enter(&mut self, mode: usize) {
        self.mode = Some(mode);
        self.known.clear();
    }

    /// The mode whose formulas are expanded.
    pub(crate) fn mode(&self) -> Option<usize> {
        self.mode
    }

    /// Runs `expand` with an index.
    pub(crate) fn with_index<T>(
        &mut self,
        name: &str,
        value: i64,
        expand: impl FnOnce(&mut Self) -> Checked<T>,
    ) -> Checked<T> {
        self.indices.push((name.to_owned(), value));
        let expanded = expand(self);
        self.indices.pop();
        expanded
    }

    /// The node of a formula.
    pub(crate) fn node(&mut self, formula: &Expression) -> Checked<Id> {
        self.work += 1;
        if self.work > MOST_WORK || self.graph.len() > MOST_NODES {
            let message = "the model is too large: its formulas with all indices do not end here";
            return Err(Complaint::new(formula.span, message)
                .help("fewer values of indices, or sums within sums made definitions"));
        }
        if self.depth == DEEPEST {
            let complaint = Complaint::new(formula.span, "definitions are nested too deeply here");
            return Err(complaint.help("make one definition of several of them"));
        }
        self.depth += 1;
        let node = self.node_within(formula);
        self.depth -= 1;
        let node = node?;
        match self.graph.value(node) {
            Some(x) if !x.is_finite() => {
                Err(self.no_number(&format!("this is {x}"), formula, "which is no number"))
            }
            _ => Ok(node),
        }
    }

    /// The complaint about a formula of constants, with the values that make it what it is.
    fn no_number(&self, what: &str, formula: &Expression, why: &str) -> Complaint {
        let (mut used, mut seen) = (Vec::new(), Vec::new());
        let mut open = vec![formula];
        while let Some(formula) = open.pop() {
            formula.for_each_name(&mut |name| {
                let Ok(meaning) = self.names.meaning(name, formula.span, self.mode) else { return };
                if used.len() == MOST_TOLD || seen.contains(&meaning) {
                    return;
                }
                seen.push(meaning);
                match (meaning, self.mode) {
                    (Meaning::Parameter(i), _) => used.push((name, self.parameters[i])),
                    (Meaning::Common(i), _) => open.push(&self.file.definitions[i].value),
                    (Meaning::OfMode(i), Some(mode)) => {
                        open.push(&self.file.modes[mode].definitions[i].value);
                    }
                    _ => {}
                }
            });
        }
        let values = used.iter().map(|(name, value)| format!("{name} = {value}"));
        let indices = self.indices.iter().map(|(name, i)| format!("{name} = {i}"));
        let with = values.chain(indices).collect::<Vec<_>>().join(", ");
        let with = if with.is_empty() { with } else { format!(" with {with}") };
        let complaint = Complaint::new(formula.span, format!("{what}{with}, {why}"));
        // The one that is most likely not meant.
        let culprit = used.iter().find(|(_, value)| *value <= 0.0).or(used.first());
        match culprit {
            None => complaint.help(
                "look for a division by zero, a root or a logarithm of what is below zero, or a power that is too large",
            ),
            Some((name, _)) => complaint.help(format!(
                "give other values; `above`, `min`, `max` and `below` of a parameter refuse wrong ones: `{name} = {{ value = 1, above = 0 }}`"
            )),
        }
    }

    fn node_within(&mut self, formula: &Expression) -> Checked<Id> {
        match &formula.kind {
            Kind::Number(x) => Ok(self.graph.constant(*x)),
            Kind::Name(name) => self.named(name, None, formula.span),
            Kind::Element(name, index) => {
                let at = self.whole(index)?;
                self.named(name, Some((at, index.span)), formula.span)
            }
            Kind::Negative(inner) => {
                let inner = self.node(inner)?;
                Ok(self.graph.negative(inner))
            }
            Kind::Chain(first, rest) => {
                let mut node = self.node(first)?;
                for (operator, formula) in rest {
                    let next = self.node(formula)?;
                    let is_zero = self.graph.value(next) == Some(0.0);
                    let moves = self.graph.value(node).is_none();
                    let divides = *operator == Operator::Divide;
                    // What is only told may be infinite where its divisor does not exist.
                    if divides && is_zero && moves && self.outside == Outside::Refused {
                        return Err(self.no_number("this is zero", formula, "and divides"));
                    }
                    node = self.combined(*operator, node, next);
                }
                Ok(node)
            }
            Kind::Power(base, exponent) => {
                let (base, exponent) = (self.node(base)?, self.node(exponent)?);
                let node = self.graph.power(base, exponent);
                let sign = self.graph.sign(base);
                let flaw = match self.graph.value(exponent) {
                    Some(p) if p >= 1.0 || p.fract() == 0.0 => None,
                    Some(_) => of_root(sign),
                    None => of_logarithm(sign),
                };
                self.flaw(node, (formula.span, "^"), flaw);
                Ok(node)
            }
            Kind::Call(name, arguments) => self.call(name, arguments, formula.span),
            Kind::Sum(sum) => self.sum(&sum.0, &sum.1),
            Kind::Choice(choice) => {
                let (condition, yes, no) = &**choice;
                if self.holds(condition)? { self.node(yes) } else { self.node(no) }
            }
        }
    }

    fn combined(&mut self, operator: Operator, a: Id, b: Id) -> Id {
        match operator {
            Operator::Add => self.graph.add(a, b),
            Operator::Subtract => self.graph.subtract(a, b),
            Operator::Multiply => self.graph.multiply(a, b),
            Operator::Divide => self.graph.divide(a, b),
        }
    }

    fn sum(&mut self, indices: &Indices, term: &Expression) -> Checked<Id> {
        self.check_index(&indices.name, indices.span)?;
        let mut sum = self.graph.constant(0.0);
        for i in self.range(indices)? {
            let term = self.with_index(&indices.name, i, |expander| expander.node(term))?;
            sum = self.graph.add(sum, term);
        }
        Ok(sum)
    }

    /// Checks that an index has a name of its own.
    pub(crate) fn check_index(&self, name: &str, span: Span) -> Checked<()> {
        self.names.check_index(name, span, self.mode)?;
        if self.indices.iter().any(|(known, _)| known == name) {
            let complaint = Complaint::new(span, format!("`{name}` is an index already"));
            return Err(complaint.help("each index within another has a name of its own"));
        }
        Ok(())
    }

    /// The values of an index.
    pub(crate) fn range(&mut self, indices: &Indices) -> Checked<std::ops::RangeInclusive<i64>> {
        self.names.check_index(&indices.name, indices.span, self.mode)?;
        let (first, last) = (self.whole(&indices.first)?, self.whole(&indices.last)?);
        if last - first >= MOST_INDICES {
            let message = format!("an index has {MOST_INDICES} values at most");
            return Err(Complaint::new(indices.span, message).help("look at its two bounds"));
        }
        Ok(first..=last)
    }

    /// The number that a formula of parameters and indices is.
    pub(crate) fn number(&mut self, formula: &Expression, what: &str) -> Checked<f64> {
        let node = self.node(formula)?;
        self.graph.value(node).ok_or_else(|| {
            let message = format!("{what} is a formula of parameters and indices alone");
            Complaint::new(formula.span, message)
                .help("states, the time, and discrete and kept values change in a run")
        })
    }

    /// A whole number.
    pub(crate) fn whole(&mut self, formula: &Expression) -> Checked<i64> {
        let x = self.number(formula, "an index")?;
        if x.fract() == 0.0 && x.abs() < 1e9 {
            return Ok(x as i64);
        }
        let message = format!("an index is a whole number, and this is {x}");
        Err(Complaint::new(formula.span, message).help("indices count from 1: `x[1]`, `x[i+1]`"))
    }

    fn holds(&mut self, condition: &Comparison) -> Checked<bool> {
        let what = "each side of the condition of `if`";
        let a = self.number(&condition.left, what)?;
        let b = self.number(&condition.right, what)?;
        Ok(match condition.relation {
            Relation::Less => a < b,
            Relation::LessOrEqual => a <= b,
            Relation::Greater => a > b,
            Relation::GreaterOrEqual => a >= b,
            Relation::Equal => a == b,
            Relation::NotEqual => a != b,
        })
    }

    /// The node of `name` or `name[index]`.
    pub(crate) fn named(&mut self, name: &str, at: Option<(i64, Span)>, span: Span) -> Checked<Id> {
        if let Some((_, value)) = self.indices.iter().rev().find(|(index, _)| index == name) {
            let value = *value as f64;
            return self.single(name, at).map(|()| self.graph.constant(value));
        }
        let meaning = self.names.meaning(name, span, self.mode)?;
        let node = match meaning {
            Meaning::State(state) => {
                let index = self.index_of_state(state, at, span)?;
                return Ok(self.graph.id(Node::State(index as u32)));
            }
            Meaning::Common(i) => {
                let file = self.file;
                return self.definition(&file.definitions[i], meaning, at, span);
            }
            Meaning::OfMode(i) => {
                let file = self.file;
                let mode = self.mode.unwrap_or_default();
                return self.definition(&file.modes[mode].definitions[i], meaning, at, span);
            }
            Meaning::Parameter(i) => Node::Constant(self.parameters[i].to_bits()),
            Meaning::Discrete(i) => Node::Held(i as u8),
            Meaning::Kept(i) => Node::Held((self.layout.n_discrete + i) as u8),
            Meaning::Time => Node::Time,
            Meaning::Pi => Node::Constant(std::f64::consts::PI.to_bits()),
        };
        self.single(name, at)?;
        Ok(self.graph.id(node))
    }

    fn single(&self, name: &str, at: Option<(i64, Span)>) -> Checked<()> {
        match at {
            None => Ok(()),
            Some((_, span)) => {
                let complaint =
                    Complaint::new(span, format!("`{name}` is one number and has no index"));
                Err(complaint.help("a vector is a state with `length`, or a definition with `for`"))
            }
        }
    }

    /// The place of a state, or of one of a vector.
    pub(crate) fn index_of_state(
        &self,
        state: usize,
        at: Option<(i64, Span)>,
        span: Span,
    ) -> Checked<usize> {
        let name = &self.file.states[state].name.value;
        let Some(length) = self.layout.length.get(state).copied() else {
            let complaint =
                Complaint::new(span, format!("`{name}` is a state and is not known here"));
            return Err(complaint.help("lengths of vectors are formulas of parameters alone"));
        };
        match (length, at) {
            (None, _) => self.single(name, at).map(|()| self.layout.first[state]),
            (Some(n), Some((i, span))) => {
                self.check_bounds(name, i, (1, n as i64), span)?;
                Ok(self.layout.first[state] + i as usize - 1)
            }
            (Some(n), None) => {
                let complaint = Complaint::new(span, format!("`{name}` is a vector of {n} states"));
                Err(complaint.help(format!("write one of them as `{name}[1]`")))
            }
        }
    }

    fn check_bounds(&self, name: &str, i: i64, bounds: (i64, i64), span: Span) -> Checked<()> {
        let (first, last) = bounds;
        if (first..=last).contains(&i) {
            return Ok(());
        }
        let own: Vec<String> =
            self.indices.iter().map(|(name, i)| format!("{name} = {i}")).collect();
        let mut complaint = Complaint::new(span, format!("`{name}` has no index {i}"))
            .label(format!("indices are {first} to {last}"));
        complaint = complaint.help(match own.is_empty() {
            true => "indices count from 1, and both ends are taken".to_owned(),
            false => format!("this is met at {}", own.join(", ")),
        });
        Err(complaint)
    }

    fn definition(
        &mut self,
        definition: &'a Definition,
        meaning: Meaning,
        at: Option<(i64, Span)>,
        span: Span,
    ) -> Checked<Id> {
        let name = &definition.name.value;
        let at = match (&definition.indices, at) {
            (None, at) => self.single(name, at).map(|()| None)?,
            (Some(_), None) => {
                let complaint = Complaint::new(span, format!("`{name}` has an index"));
                return Err(complaint.help(format!("write one of its values as `{name}[1]`")));
            }
            (Some(indices), Some((i, span))) => {
                let range = self.with_no_index(|expander| expander.range(indices))?;
                self.check_bounds(name, i, range.into_inner(), span)?;
                Some((&indices.name, i))
            }
        };
        let own = at.map_or(0, |(_, i)| i);
        if let Some(node) = self.known.get(&(meaning, own, self.outside)) {
            self.used_own |= node.1;
            return Ok(node.0);
        }
        if !self.exists(definition) {
            return match self.outside {
                Outside::Zero => Ok(self.graph.constant(0.0)),
                Outside::Refused => {
                    let mode = self.mode.map_or("", |mode| &self.file.modes[mode].name.value);
                    let message = format!("`{name}` does not exist in the mode `{mode}`");
                    Err(Complaint::new(span, message)
                        .and(definition.name.span, "see its `of`")
                        .help("name this mode in its `of`, or use it in no formula of this one"))
                }
            };
        }
        if self.open.contains(&(meaning, own)) {
            return Err(self.circle((meaning, own), definition, span));
        }
        let used_own = std::mem::take(&mut self.used_own);
        self.open.push((meaning, own));
        let node = self.with_no_index(|expander| match at {
            None => expander.node(&definition.value),
            Some((index, i)) => {
                expander.with_index(index, i, |expander| expander.node(&definition.value))
            }
        });
        self.open.pop();
        let node = node?;
        let uses = self.used_own || matches!(meaning, Meaning::OfMode(_));
        self.used_own = used_own || uses;
        self.known.insert((meaning, own, self.outside), (node, uses));
        Ok(node)
    }

    /// Whether a definition exists in this mode.
    pub(crate) fn exists(&self, definition: &Definition) -> bool {
        match (&definition.of, self.mode) {
            (Some(of), Some(mode)) => {
                let here = &self.file.modes[mode].name.value;
                of.iter().any(|name| name.value == *here)
            }
            _ => true,
        }
    }

    fn circle(&self, last: (Meaning, i64), definition: &Definition, span: Span) -> Complaint {
        let name = |(meaning, _): &(Meaning, i64)| match (meaning, self.mode) {
            (Meaning::Common(i), _) => self.file.definitions[*i].name.value.clone(),
            (Meaning::OfMode(i), Some(mode)) => {
                self.file.modes[mode].definitions[*i].name.value.clone()
            }
            _ => String::new(),
        };
        let from = self.open.iter().position(|open| *open == last).unwrap_or(0);
        let mut names: Vec<_> = self.open[from..].iter().map(name).collect();
        names.push(definition.name.value.clone());
        let message = format!("`{}` is defined by itself", definition.name.value);
        Complaint::new(span, message).help(format!("the circle is {}", names.join(" → ")))
    }

    /// Runs `expand` without the indices of the formula around it.
    fn with_no_index<T>(&mut self, expand: impl FnOnce(&mut Self) -> Checked<T>) -> Checked<T> {
        let outer = std::mem::take(&mut self.indices);
        let expanded = expand(self);
        self.indices = outer;
        expanded
    }
}

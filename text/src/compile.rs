//! From declarations to tapes: the model of one part.

mod mode;
mod observables;

pub(crate) use mode::role;

use std::ops::RangeInclusive;

use deltazero_study::problem::Quantity;

use crate::declarations::{Declarations, Definition, Equation, PartDeclaration};
use crate::document::At;
use crate::expand::Expander;
use crate::expression::Expression;
use crate::jacobian::{Jacobian, MOST_NODES};
use crate::layout::Layout;
use crate::names::{Meaning, Names};
use crate::report::{Checked, Complaint, Source};
use crate::sparsity::{Sparsity, span};
use crate::system::{Model, Target, TextModel};

/// A model with what is to be warned of.
pub(crate) struct Compiled {
    pub(crate) model: TextModel,
    pub(crate) warnings: Vec<Complaint>,
}

/// Compiles one part with these values of parameters, to be run to `t_end` [s] if that is known.
pub(crate) fn compile(
    source: &Source,
    file: &Declarations,
    names: &Names,
    parameters: Vec<f64>,
    part: Option<&PartDeclaration>,
    t_end: Option<f64>,
) -> Checked<Compiled> {
    let mut expander = Expander::new(file, names, parameters);
    expander.layout = layout(&mut expander)?;
    let starts = starts(&mut expander, part)?;
    let scales = scales(&mut expander, &starts)?;
    let discrete = file
        .discrete
        .iter()
        .map(|value| expander.number(&value.value, "the start of a discrete value"));
    let discrete = discrete.collect::<Checked<Vec<_>>>()?;
    let observables = observables::observables(&mut expander)?;
    let (mut modes, mut warnings) = (Vec::new(), Vec::new());
    let (mut tried, mut rates, mut guards) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..file.modes.len() {
        expander.enter(i);
        tried.push(mode::try_definitions(&mut expander, i));
        let (mode, [own_rates, own_guards]) =
            mode::mode(&mut expander, i, &observables, &mut warnings)?;
        modes.push(mode);
        rates.push(own_rates);
        guards.extend(own_guards);
    }
    check_definitions(file, tried)?;
    observables::warn_of_contact(file, &mut warnings);
    let sparsity = Sparsity::new(&expander.graph, &rates);
    let guard_span = span(&expander.graph, &guards, expander.layout.n);
    let is_autonomous = !rates.iter().any(|rates| expander.graph.is_of_time(rates));
    let mut left = MOST_NODES;
    for (mode, rates) in modes.iter_mut().zip(&rates) {
        let rates = (&rates[..], mode.program.tape.first.len());
        mode.jacobian = Jacobian::new(&mut expander.graph, rates, &sparsity, &mut left);
    }
    let first_mode = file.mode.as_ref().map_or(Ok(0), |mode| names.mode(mode))?;
    let model = Model {
        source: source.clone(),
        part: part.map_or(String::new(), |part| part.name.value.clone()),
        part_number: part.and_then(|part| {
            let own = |other: &PartDeclaration| other.name.value == part.name.value;
            Some(1 + file.parts.iter().position(own)?)
        }),
        states: states(&expander, &scales),
        groups: groups(&expander),
        observables: observables::columns(&observables),
        sparsity,
        guard_span,
        unit_of_time: t_end.map_or(1.0, |t_end| t_end.min(1.0)),
        is_autonomous,
        friction_gives: file.friction_gives,
        starts,
        scales,
        discrete,
        n_guards: modes.iter().map(|mode| mode.transitions.len()).max().unwrap_or(0),
        first_mode,
        modes,
    };
    Ok(Compiled { model: TextModel::new(model), warnings })
}

/// The states as a study knows them.
fn states(expander: &Expander<'_>, scales: &[f64]) -> Vec<Quantity> {
    let (file, layout) = (expander.file, &expander.layout);
    let units = file.states.iter().enumerate().flat_map(|(i, state)| {
        let unit = state.unit.as_ref().map_or("", |unit| unit.value.as_str());
        std::iter::repeat_n(unit, layout.range(i).len())
    });
    let names = layout.names(file).into_iter().zip(units).zip(scales);
    names.map(|((name, unit), scale)| Quantity::new(name, unit.to_owned(), *scale)).collect()
}

/// The group of each state.
fn groups(expander: &Expander<'_>) -> Vec<Option<String>> {
    let states = expander.file.states.iter().enumerate();
    let groups = states.map(|(i, state)| {
        let group = state.group.as_ref().map(|group| group.value.clone());
        std::iter::repeat_n(group, expander.layout.range(i).len())
    });
    groups.flatten().collect()
}

/// The lengths of vectors.
fn layout(expander: &mut Expander<'_>) -> Checked<Layout> {
    let file = expander.file;
    let mut lengths = Vec::new();
    for state in &file.states {
        let Some(length) = &state.length else {
            lengths.push(None);
            continue;
        };
        let n = expander.whole(length)?;
        if n < 1 || n > crate::layout::MOST_STATES as i64 {
            let most = crate::layout::MOST_STATES;
            let message = format!("a vector has 1 to {most} states, not {n}");
            let help = "give `length` a number or a formula of parameters, such as \"n\"";
            return Err(Complaint::new(length.span, message).help(help));
        }
        lengths.push(Some(n as usize));
    }
    Layout::new(file, lengths)
}

/// The states at t = 0.
fn starts(expander: &mut Expander<'_>, part: Option<&PartDeclaration>) -> Checked<Vec<f64>> {
    let file = expander.file;
    let mut starts = vec![0.0; expander.layout.n];
    for (i, state) in file.states.iter().enumerate() {
        let Some(start) = &state.start else { continue };
        for (at, index) in elements(expander, i) {
            starts[at] = within(expander, index, start, |expander, start| {
                expander.number(start, "a start")
            })?;
        }
    }
    if let Some(part) = part {
        for assignment in assignments(expander, &[&part.start], Purpose::Start)? {
            let Assignment { target: Target::State(i), equation, index } = assignment else {
                continue;
            };
            starts[i] = within(expander, index, &equation.value, |expander, start| {
                expander.number(start, "a start")
            })?;
        }
    }
    Ok(starts)
}

/// Natural sizes: as given, else the start where it is not zero, else one.
fn scales(expander: &mut Expander<'_>, starts: &[f64]) -> Checked<Vec<f64>> {
    let file = expander.file;
    let mut scales: Vec<f64> =
        starts.iter().map(|start| if *start == 0.0 { 1.0 } else { start.abs() }).collect();
    for (i, state) in file.states.iter().enumerate() {
        let Some(scale) = &state.scale else { continue };
        for (at, index) in elements(expander, i) {
            let size = within(expander, index, scale, |expander, scale| {
                expander.number(scale, "a scale")
            })?;
            if size <= 0.0 {
                let message = format!("a scale is above zero, and this is {size}");
                let help =
                    "a scale is the size at which an error of the part rtol begins to matter";
                return Err(Complaint::new(scale.span, message).help(help));
            }
            scales[at] = size;
        }
    }
    Ok(scales)
}

/// Complains about a definition that can be made in no mode.
fn check_definitions(file: &Declarations, mut tried: Vec<Vec<Option<Checked<()>>>>) -> Checked<()> {
    for i in 0..file.definitions.len() {
        let of_modes = tried.iter_mut().filter_map(|of_mode| of_mode[i].take());
        let of_modes: Vec<_> = of_modes.collect();
        if of_modes.iter().all(Result::is_err)
            && let Some(first) = of_modes.into_iter().next()
        {
            first?;
        }
    }
    Ok(())
}

/// What equations are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    Start,
    Rate,
    Event,
}

impl Purpose {
    fn words(self) -> &'static str {
        match self {
            Self::Start => "a start",
            Self::Rate => "a rate",
            Self::Event => "what an event sets",
        }
    }
}

/// An equation for one number, with the index that its formula is of.
pub(crate) struct Assignment<'a> {
    pub(crate) target: Target,
    pub(crate) equation: &'a Equation,
    pub(crate) index: Option<i64>,
}

/// The index of a vector that its formulas are of.
const INDEX: &str = "i";

/// Expands a formula, with its index where it is that of a vector.
pub(crate) fn within<'a, T>(
    expander: &mut Expander<'a>,
    index: Option<i64>,
    formula: &Expression,
    expand: impl FnOnce(&mut Expander<'a>, &Expression) -> Checked<T>,
) -> Checked<T> {
    let Some(i) = index else { return expand(expander, formula) };
    let mut is_named = false;
    formula.for_each_name(&mut |name| is_named |= name == INDEX);
    if is_named {
        expander.check_index(INDEX, formula.span)?;
    }
    expander.with_index(INDEX, i, |expander| expand(expander, formula))
}

/// The places of a declared state, each with its index where the state is a vector.
fn elements(expander: &Expander<'_>, state: usize) -> Vec<(usize, Option<i64>)> {
    let is_vector = expander.layout.length[state].is_some();
    let range = expander.layout.range(state).enumerate();
    range.map(|(k, at)| (at, is_vector.then_some(k as i64 + 1))).collect()
}

/// The equations, number by number. Of several lists the first stands before the others; in each, an equation of one
/// number before that of its vector.
pub(crate) fn assignments<'a>(
    expander: &mut Expander<'_>,
    lists: &[&'a [Equation]],
    purpose: Purpose,
) -> Checked<Vec<Assignment<'a>>> {
    let mut all: Vec<Assignment<'a>> = Vec::new();
    let mut place = std::collections::HashMap::new();
    for (rank, list) in lists.iter().enumerate() {
        for is_single in [true, false] {
            for equation in list.iter() {
                for (target, index, single) in targets(expander, equation, purpose)? {
                    if single != is_single {
                        continue;
                    }
                    let key = (rank, is_single);
                    let assignment = Assignment { target, equation, index };
                    match place.get(&key_of(target)) {
                        None => {
                            place.insert(key_of(target), (key, equation));
                            all.push(assignment);
                        }
                        Some((before, first)) if *before == key => {
                            let first: &Equation = first;
                            let message = "this is given a value twice";
                            return Err(Complaint::new(equation.target.span, message)
                                .and(first.target.span, "first here")
                                .help("leave one of them out"));
                        }
                        Some(_) => {}
                    }
                }
            }
        }
    }
    Ok(all)
}

fn key_of(target: Target) -> (bool, usize) {
    match target {
        Target::State(i) => (true, i),
        Target::Held(i) => (false, i),
    }
}

/// The numbers that an equation gives a value to, the index for its formula, and whether it is of one number.
fn targets(
    expander: &mut Expander<'_>,
    equation: &Equation,
    purpose: Purpose,
) -> Checked<Vec<(Target, Option<i64>, bool)>> {
    let At { value: name, span } = &equation.target;
    let meaning = expander.names.meaning(name, *span, None)?;
    match (meaning, &equation.index) {
        (Meaning::State(state), None) => {
            let elements = elements(expander, state).into_iter();
            Ok(elements.map(|(at, i)| (Target::State(at), i, i.is_none())).collect())
        }
        (Meaning::State(state), Some(index)) => {
            let at = (expander.whole(index)?, index.span);
            let i = expander.index_of_state(state, Some(at), *span)?;
            Ok(vec![(Target::State(i), None, true)])
        }
        (Meaning::Discrete(i), None) if purpose == Purpose::Event => {
            Ok(vec![(Target::Held(i), None, true)])
        }
        _ => {
            let message = format!("{} is of a state, and `{name}` is none", purpose.words());
            let states = expander.file.states.iter().map(|state| &*state.name.value);
            Err(Complaint::new(*span, message).nearest(name, states))
        }
    }
}

/// The indices of a definition; none of what is one number.
fn indices(
    expander: &mut Expander<'_>,
    definition: &Definition,
) -> Checked<Option<RangeInclusive<i64>>> {
    definition.indices.as_ref().map(|indices| expander.range(indices)).transpose()
}

/// Each of these indices; none, once, for what is one number.
fn each_of(indices: Option<RangeInclusive<i64>>) -> impl Iterator<Item = Option<i64>> {
    let single = indices.is_none().then_some(None);
    single.into_iter().chain(indices.into_iter().flatten().map(Some))
}

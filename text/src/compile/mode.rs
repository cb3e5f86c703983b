//! One mode: its rates, guards, transitions and what is told of it.

use super::observables::{Observable, told};
use super::{Assignment, Purpose, assignments, each_of, indices, within};
use crate::declarations::{Definition, EventDeclaration, Follows, ModeRole};
use crate::expand::{Expander, Flaw};
use crate::expression::{Comparison, Relation};
use crate::graph::Id;
use crate::layout::MOST_EVENTS;
use crate::mode::kept_name;
use crate::names::Meaning;
use crate::program::Program;
use crate::report::{Checked, Complaint};
use crate::system::{CompiledMode, Goal, Setting, Target, Transition};

/// What is told beside a warning of an edge.
const EDGE: &str = "if the motion, or a step that is tried a little past an event, comes there: let an event end the mode before, or write a formula that goes on";
/// What is told beside a warning of an edge in what an event sets or a mode keeps.
const EDGE_AT_EVENT: &str = "if an event happens there, what is set or kept is not a number and the run ends: write a formula that goes on";
/// What is told beside a warning of a kink.
const KINK: &str = "where it has its kink, a step sees two smooth pieces as one: two modes with an event between them are exact";

/// Expands every definition, so that long recursions are built from their start. Returns what became of the common
/// ones; none of those that do not exist in this mode.
pub(super) fn try_definitions(
    expander: &mut Expander<'_>,
    mode: usize,
) -> Vec<Option<Checked<()>>> {
    let file = expander.file;
    let all = file.definitions.iter().chain(&file.modes[mode].definitions);
    let tried = all.map(|definition| {
        expander.exists(definition).then(|| try_definition(expander, definition))
    });
    let mut tried: Vec<_> = tried.collect();
    tried.truncate(file.definitions.len());
    tried
}

fn try_definition(expander: &mut Expander<'_>, definition: &Definition) -> Checked<()> {
    for index in each_of(indices(expander, definition)?) {
        expander.value_of(definition, index)?;
    }
    Ok(())
}

/// Compiles a mode; the formulas of its rates and of its guards.
pub(super) fn mode(
    expander: &mut Expander<'_>,
    number: usize,
    observables: &[Observable<'_>],
    warnings: &mut Vec<Complaint>,
) -> Checked<(CompiledMode, [Vec<Id>; 2])> {
    let declared = &expander.file.modes[number];
    let rates = rates(expander, number)?;
    let mut guards = Vec::new();
    let mut transitions = Vec::new();
    // What events set and the mode keeps: evaluated at single points, so that a kink does no harm.
    let mut at_events = Vec::new();
    for event in &declared.events {
        let indices = match &event.indices {
            None => vec![None],
            Some(indices) => expander.range(indices)?.map(Some).collect(),
        };
        for index in indices {
            let name = event.indices.as_ref().map_or("", |indices| &indices.name);
            let (guard, transition) = match index {
                None => one_event(expander, event, &mut at_events)?,
                Some(i) => expander
                    .with_index(name, i, |expander| one_event(expander, event, &mut at_events))?,
            };
            expander.n_events += 1;
            if expander.n_events > MOST_EVENTS {
                let message = format!("a model has {MOST_EVENTS} events at most");
                let help = "events of one kind with many indices are as many events";
                return Err(Complaint::new(event.when.left.span, message).help(help));
            }
            guards.push(guard);
            transitions.push(transition);
        }
    }
    let keep = declared.keep.iter().map(|kept| {
        let node = expander.node(&kept.value)?;
        // What is kept is computed from the state before anything is.
        match expander.graph.is_of_kept(node, expander.layout.n_discrete) {
            false => Ok(node),
            true => Err(Complaint::new(kept.value.span, "a kept value is made of another one")
                .help("write what it is of states, parameters and discrete values")),
        }
    });
    let keep = keep.collect::<Checked<Vec<_>>>()?;
    at_events.extend(&keep);
    warn_of_flaws(expander, [&rates, &guards], &at_events, warnings);
    let told = told(expander, number, &rates, observables)?;
    let mode = CompiledMode {
        name: kept_name(&declared.name.value),
        role: declared.role,
        program: Program::of_two(&expander.graph, &rates, &guards),
        guards: Program::of(&expander.graph, &guards),
        jacobian: None,
        keep: Program::of(&expander.graph, &keep),
        transitions,
        told,
    };
    Ok((mode, [rates, guards]))
}

/// The rate of each state.
fn rates(expander: &mut Expander<'_>, mode: usize) -> Checked<Vec<Id>> {
    let file = expander.file;
    let declared = &file.modes[mode];
    let mut rates = vec![None; expander.layout.n];
    for assignment in assignments(expander, &[&declared.rates, &file.rates], Purpose::Rate)? {
        if let Target::State(i) = assignment.target {
            let formula = &assignment.equation.value;
            rates[i] = Some(within(expander, assignment.index, formula, Expander::node)?);
        }
    }
    if let Some(missing) = rates.iter().position(Option::is_none) {
        let name = &expander.layout.names(file)[missing];
        let message = format!("`{name}` has no rate in the mode `{}`", declared.name.value);
        let help = "give it one in the mode's rates, or in [rates] for all modes";
        return Err(Complaint::new(declared.name.span, message).help(help));
    }
    Ok(rates.into_iter().flatten().collect())
}

/// The guard of an event, and what follows; what is set is added to `values`.
fn one_event(
    expander: &mut Expander<'_>,
    event: &EventDeclaration,
    values: &mut Vec<Id>,
) -> Checked<(Id, Transition)> {
    let guard = guard(expander, &event.when)?;
    let next = setting(expander, &event.follows, true, values)?;
    // A rest follows in the mode after the event, which holds values of its own.
    let here = expander.mode().unwrap_or_default();
    let stays = next.leads_to(here) == here;
    let rest =
        event.rest.as_ref().map(|rest| setting(expander, rest, stays, values)).transpose()?;
    Ok((guard, Transition { at: event.when.left.span.to(event.when.right.span), next, rest }))
}

/// `b − a` of `a > b`: positive as long as the event has not come.
fn guard(expander: &mut Expander<'_>, when: &Comparison) -> Checked<Id> {
    let (a, b) = (expander.node(&when.left)?, expander.node(&when.right)?);
    let is_upward = matches!(when.relation, Relation::Greater | Relation::GreaterOrEqual);
    Ok(if is_upward { expander.graph.subtract(b, a) } else { expander.graph.subtract(a, b) })
}

/// What an event sets, which is added to `all`, and where it leads; `is_held` where what the mode keeps is still held.
fn setting(
    expander: &mut Expander<'_>,
    follows: &Follows,
    is_held: bool,
    all: &mut Vec<Id>,
) -> Checked<Setting> {
    let (mut targets, mut values) = (Vec::new(), Vec::new());
    for Assignment { target, equation, index } in
        assignments(expander, &[&follows.set], Purpose::Event)?
    {
        let (formula, n_discrete) = (&equation.value, expander.layout.n_discrete);
        let value = within(expander, index, formula, Expander::node)?;
        if !is_held && expander.graph.is_of_kept(value, n_discrete) {
            let message = "what a mode keeps is gone in the rest of an event that leads to another";
            return Err(Complaint::new(formula.span, message)
                .help("write what it is of states, parameters and discrete values"));
        }
        targets.push(target);
        values.push(value);
    }
    let goal = match &follows.to {
        Some(mode) => Goal::Enter(expander.names.mode(mode)?),
        None if follows.stops => Goal::Stop,
        None => Goal::Stay,
    };
    all.extend(&values);
    Ok(Setting { program: Program::of(&expander.graph, &values), targets, goal })
}

/// Warns of functions that are not smooth or not defined everywhere, where rates or guards use them, and of those that are
/// not defined everywhere where they are evaluated at events.
fn warn_of_flaws(
    expander: &Expander<'_>,
    [rates, guards]: [&[Id]; 2],
    at_events: &[Id],
    warnings: &mut Vec<Complaint>,
) {
    let used = expander.graph.used_by(rates.iter().chain(guards));
    let used_at_events = expander.graph.used_by(at_events.iter());
    let mut flawed: Vec<_> = expander.flawed.iter().collect();
    flawed.retain(|(id, (.., flaw))| {
        used.contains(*id) || (*flaw != Flaw::Kink && used_at_events.contains(*id))
    });
    if flawed.is_empty() {
        return;
    }
    let varying = expander.graph.varying();
    flawed.retain(|(id, _)| varying.contains(*id));
    flawed.sort_by_key(|(_, (span, ..))| span.start);
    for (id, (span, function, flaw)) in flawed {
        let (what, help) = match flaw {
            Flaw::Kink => ("is not smooth".to_owned(), KINK),
            Flaw::Edge(there) => {
                let help = if used.contains(id) { EDGE } else { EDGE_AT_EVENT };
                (format!("is not a number where that is {there}"), help)
            }
        };
        let message = format!("`{function}` of something that moves {what}");
        warnings.push(Complaint::new(*span, message).help(help));
    }
}

impl Expander<'_> {
    /// The node of a definition of this mode, at one index.
    fn value_of(&mut self, definition: &Definition, index: Option<i64>) -> Checked<Id> {
        let (name, span) = (&definition.name.value, definition.name.span);
        let meaning = self.names.meaning(name, span, self.mode())?;
        debug_assert!(matches!(meaning, Meaning::Common(_) | Meaning::OfMode(_)));
        self.named(name, index.map(|i| (i, span)), span)
    }
}

/// The role of a mode as a study knows it.
pub(crate) fn role(role: ModeRole) -> deltazero_study::problem::Role {
    match role {
        ModeRole::Free => deltazero_study::problem::Role::Free,
        ModeRole::Contact => deltazero_study::problem::Role::Contact,
        ModeRole::Stick => deltazero_study::problem::Role::Stick,
    }
}

//! What the names of a file mean.

use std::collections::HashMap;

use crate::declarations::{Declarations, ModeDeclaration};
use crate::document::At;
use crate::report::{Checked, Complaint, Span};
use crate::token::{begins_name, is_of_name};

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Meaning {
    /// A parameter, by its place in the list.
    Parameter(usize),
    /// A state or a vector of states.
    State(usize),
    /// A definition of all modes.
    Common(usize),
    /// A definition of one mode.
    OfMode(usize),
    /// A discrete value.
    Discrete(usize),
    /// A value kept by one mode.
    Kept(usize),
    /// `t`.
    Time,
    /// `pi`.
    Pi,
}

/// Names of functions, with their numbers of arguments.
pub(crate) const FUNCTIONS: &[(&str, usize)] = &[
    ("sin", 1),
    ("cos", 1),
    ("tan", 1),
    ("asin", 1),
    ("acos", 1),
    ("atan", 1),
    ("atan2", 2),
    ("sinh", 1),
    ("cosh", 1),
    ("tanh", 1),
    ("sqrt", 1),
    ("exp", 1),
    ("log", 1),
    ("ln", 1),
    ("log10", 1),
    ("abs", 1),
    ("min", 2),
    ("max", 2),
    ("sign", 1),
    ("hypot", 2),
];

/// Words that mean something else in a formula.
const WORDS: &[&str] = &["sum", "if", "in", "and", "or", "not"];

/// The names of a file that hold in all modes, and those of each mode.
#[derive(Clone, Debug, Default)]
pub(crate) struct Names {
    common: HashMap<String, (Meaning, Span)>,
    of_mode: Vec<HashMap<String, (Meaning, Span)>>,
    modes: HashMap<String, usize>,
}

impl Names {
    /// Collects the names of a file.
    pub(crate) fn new(file: &Declarations) -> Checked<Self> {
        let mut names = Self::default();
        let nowhere = Span { start: 0, end: 0 };
        names.common.insert("t".to_owned(), (Meaning::Time, nowhere));
        names.common.insert("pi".to_owned(), (Meaning::Pi, nowhere));
        let parameters = file.parameters.iter().map(|parameter| &parameter.name);
        add(&mut names.common, parameters, Meaning::Parameter)?;
        add(&mut names.common, file.states.iter().map(|state| &state.name), Meaning::State)?;
        let definitions = file.definitions.iter().map(|definition| &definition.name);
        add(&mut names.common, definitions, Meaning::Common)?;
        add(&mut names.common, file.discrete.iter().map(|value| &value.name), Meaning::Discrete)?;
        for (i, mode) in file.modes.iter().enumerate() {
            check_mode(&mode.name)?;
            names.modes.insert(mode.name.value.clone(), i);
            let own = names.own(mode)?;
            names.of_mode.push(own);
        }
        names.check_modes_of_definitions(file)?;
        Ok(names)
    }

    /// The names of one mode: its definitions may stand before common ones, all else is new.
    fn own(&self, mode: &ModeDeclaration) -> Checked<HashMap<String, (Meaning, Span)>> {
        let mut own = HashMap::new();
        add(&mut own, mode.definitions.iter().map(|definition| &definition.name), Meaning::OfMode)?;
        add(&mut own, mode.keep.iter().map(|kept| &kept.name), Meaning::Kept)?;
        for (name, (meaning, span)) in &own {
            let is_both_definition = |common: &Meaning| {
                matches!((meaning, common), (Meaning::OfMode(_), Meaning::Common(_)))
            };
            match self.common.get(name) {
                Some((common, before)) if !is_both_definition(common) => {
                    return Err(twice(name, *span, *before));
                }
                _ => {}
            }
        }
        Ok(own)
    }

    fn check_modes_of_definitions(&self, file: &Declarations) -> Checked<()> {
        let of_modes = file.modes.iter().flat_map(|mode| &mode.definitions);
        for definition in file.definitions.iter().chain(of_modes) {
            for mode in definition.of.iter().flatten() {
                self.mode(mode)?;
            }
        }
        Ok(())
    }

    /// The number of the mode of this name.
    pub(crate) fn mode(&self, name: &At<String>) -> Checked<usize> {
        self.modes.get(&name.value).copied().ok_or_else(|| {
            let complaint =
                Complaint::new(name.span, format!("no mode is called `{}`", name.value));
            complaint.nearest(&name.value, self.modes.keys().map(String::as_str))
        })
    }

    fn known(&self, name: &str, mode: Option<usize>) -> Option<&(Meaning, Span)> {
        let own = mode.and_then(|mode| self.of_mode[mode].get(name));
        own.or_else(|| self.common.get(name))
    }

    /// What a name means in a mode, or in no mode.
    pub(crate) fn meaning(&self, name: &str, span: Span, mode: Option<usize>) -> Checked<Meaning> {
        if let Some((meaning, _)) = self.known(name, mode) {
            return Ok(*meaning);
        }
        let complaint = Complaint::new(span, format!("nothing here is called `{name}`"));
        if FUNCTIONS.iter().any(|(function, _)| *function == name) {
            return Err(
                complaint.help(format!("a function has its arguments in parentheses: `{name}(x)`"))
            );
        }
        let elsewhere = self.of_mode.iter().find_map(|own| own.get(name));
        if let Some((_, there)) = elsewhere {
            let help = "what a mode keeps or defines is known in this mode alone";
            return Err(complaint.and(*there, "known in another mode").help(help));
        }
        let own = mode.into_iter().flat_map(|mode| self.of_mode[mode].keys());
        Err(complaint.nearest(name, self.common.keys().chain(own).map(String::as_str)))
    }

    /// Checks that an index has a name that means nothing else in a mode, or in no mode.
    pub(crate) fn check_index(&self, name: &str, span: Span, mode: Option<usize>) -> Checked<()> {
        check_name(name, span)?;
        match self.known(name, mode) {
            Some((_, before)) => Err(twice(name, span, *before)),
            None => Ok(()),
        }
    }
}

fn add<'a>(
    names: &mut HashMap<String, (Meaning, Span)>,
    new: impl Iterator<Item = &'a At<String>>,
    meaning: fn(usize) -> Meaning,
) -> Checked<()> {
    for (i, At { value, span }) in new.enumerate() {
        check_name(value, *span)?;
        if let Some((_, before)) = names.insert(value.clone(), (meaning(i), *span)) {
            return Err(twice(value, *span, before));
        }
    }
    Ok(())
}

fn check_name(name: &str, span: Span) -> Checked<()> {
    if FUNCTIONS.iter().any(|(function, _)| *function == name) || WORDS.contains(&name) {
        let complaint =
            Complaint::new(span, format!("`{name}` has a meaning of its own in a formula"));
        return Err(complaint.help(format!("give it another name, such as `{name}_0`")));
    }
    if name.starts_with(begins_name) && name.chars().all(is_of_name) {
        return Ok(());
    }
    let complaint = Complaint::new(span, format!("`{name}` is no name for a formula"));
    Err(complaint.help("a name has letters, the digits 0 to 9 and `_`, and begins with no digit"))
}

/// Checks that the name of a mode can stand in a table.
fn check_mode(name: &At<String>) -> Checked<()> {
    let breaks_line = |c: char| c.is_control() || matches!(c, '\u{2028}' | '\u{2029}');
    let breaks = |c: char| breaks_line(c) || matches!(c, ',' | '"');
    if !name.value.contains(breaks) && !name.value.is_empty() {
        return Ok(());
    }
    let message = format!("{:?} is no name for a mode", name.value);
    let help = "it stands in tables: printable characters without comma and quote";
    Err(Complaint::new(name.span, message).help(help))
}

fn twice(name: &str, span: Span, before: Span) -> Complaint {
    let complaint = Complaint::new(span, format!("`{name}` has two meanings"));
    if before.end == 0 {
        let meaning = if name == "t" { "`t` is the time" } else { "`pi` is 3.14159…" };
        return complaint.help(format!("{meaning}; give this another name"));
    }
    complaint.and(before, "the other one").help("give one of them another name")
}

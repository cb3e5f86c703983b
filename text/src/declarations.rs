//! What a file declares, as it stands there: names, formulas and their places, nothing resolved.

use toml::de::DeTable;

use crate::document::{At, Entries, Entry};
use crate::expression::{Comparison, Expression, Indices, Kind};
use crate::report::{Checked, Complaint, Span};

/// Tables of a file that are settings of the program and not of the model; of them only `run.t_end` is read here.
pub const SETTINGS: [&str; 5] = ["run", "solver", "study", "contest", "regimes"];

/// The other keys at the top of a file.
const KEYS: &[&str] = &[
    "name",
    "about",
    "source",
    "mode",
    "t_end",
    "parameters",
    "definitions",
    "states",
    "rates",
    "modes",
    "discrete",
    "contact",
    "energy",
    "power",
    "parts",
];

/// A file, declaration by declaration.
#[derive(Clone, Debug, Default)]
pub(crate) struct Declarations {
    pub(crate) name: String,
    pub(crate) about: String,
    pub(crate) source: String,
    /// The mode at t = 0.
    pub(crate) mode: Option<At<String>>,
    /// The end of the runs [s].
    pub(crate) t_end: Option<f64>,
    pub(crate) parameters: Vec<ParameterDeclaration>,
    pub(crate) definitions: Vec<Definition>,
    pub(crate) states: Vec<StateDeclaration>,
    pub(crate) rates: Vec<Equation>,
    pub(crate) modes: Vec<ModeDeclaration>,
    pub(crate) discrete: Vec<Named>,
    /// Depth and force.
    pub(crate) contact: Option<[Expression; 2]>,
    /// Kinetic and elastic.
    pub(crate) energy: Option<[Option<Expression>; 2]>,
    /// Of the drive, of damping, of friction.
    pub(crate) power: [Option<Expression>; 3],
    /// Whether friction may give energy.
    pub(crate) friction_gives: bool,
    pub(crate) parts: Vec<PartDeclaration>,
}

/// A name with a formula.
#[derive(Clone, Debug)]
pub(crate) struct Named {
    pub(crate) name: At<String>,
    pub(crate) value: Expression,
}

/// A number that a user may set.
#[derive(Clone, Debug)]
pub(crate) struct ParameterDeclaration {
    pub(crate) name: At<String>,
    pub(crate) value: f64,
    pub(crate) value_span: Span,
    pub(crate) unit: Option<At<String>>,
    pub(crate) about: String,
    pub(crate) range: crate::Range,
}

/// A name for a formula, or for one formula for each index.
#[derive(Clone, Debug)]
pub(crate) struct Definition {
    pub(crate) name: At<String>,
    pub(crate) value: Expression,
    pub(crate) indices: Option<Indices>,
    pub(crate) unit: Option<At<String>>,
    pub(crate) is_observable: bool,
    /// The modes where it exists; all where there is none.
    pub(crate) of: Option<Vec<At<String>>>,
}

/// A state, or `length` states.
#[derive(Clone, Debug)]
pub(crate) struct StateDeclaration {
    pub(crate) name: At<String>,
    pub(crate) start: Option<Expression>,
    pub(crate) length: Option<Expression>,
    pub(crate) unit: Option<At<String>>,
    pub(crate) scale: Option<Expression>,
    pub(crate) group: Option<At<String>>,
}

/// `target = value`: a rate, or what an event sets.
#[derive(Clone, Debug)]
pub(crate) struct Equation {
    pub(crate) target: At<String>,
    /// The index in `x[i]`.
    pub(crate) index: Option<Expression>,
    pub(crate) value: Expression,
}

/// An event of a mode, or one for each index.
#[derive(Clone, Debug)]
pub(crate) struct EventDeclaration {
    pub(crate) indices: Option<Indices>,
    pub(crate) when: Comparison,
    pub(crate) follows: Follows,
    /// What follows where events of this kind accumulate.
    pub(crate) rest: Option<Follows>,
}

/// What follows an event.
#[derive(Clone, Debug)]
pub(crate) struct Follows {
    pub(crate) to: Option<At<String>>,
    pub(crate) stops: bool,
    pub(crate) set: Vec<Equation>,
}

/// What a mode is for a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ModeRole {
    Free,
    Contact,
    Stick,
}

/// A mode.
#[derive(Clone, Debug)]
pub(crate) struct ModeDeclaration {
    pub(crate) name: At<String>,
    pub(crate) role: ModeRole,
    pub(crate) keep: Vec<Named>,
    pub(crate) definitions: Vec<Definition>,
    pub(crate) rates: Vec<Equation>,
    pub(crate) events: Vec<EventDeclaration>,
}

/// A part: the model with some parameters and starts changed.
#[derive(Clone, Debug)]
pub(crate) struct PartDeclaration {
    pub(crate) name: At<String>,
    pub(crate) parameters: Vec<(At<String>, f64)>,
    pub(crate) start: Vec<Equation>,
}

/// Reads a file's declarations.
pub(crate) fn declarations(text: &str, table: &DeTable<'_>) -> Checked<Declarations> {
    let whole = Span { start: 0, end: text.find('\n').unwrap_or(text.len()) };
    let file = Entries::new(text, table, whole).only(&[KEYS, &SETTINGS].concat())?;
    let words = |key| -> Checked<String> {
        Ok(file.read(key, Entry::text)?.map_or(String::new(), |text| text.value))
    };
    let (power, friction_gives) = file.read("power", power)?.unwrap_or_default();
    let all = Declarations {
        name: words("name")?,
        about: words("about")?,
        source: words("source")?,
        mode: file.read("mode", Entry::text)?,
        t_end: t_end(&file)?,
        parameters: each(file.table("parameters")?, parameter)?,
        definitions: each(file.table("definitions")?, definition)?,
        states: each(file.table("states")?, state)?,
        rates: each(file.table("rates")?, equation)?,
        modes: each(file.table("modes")?, mode)?,
        discrete: each(file.table("discrete")?, named)?,
        contact: file.read("contact", contact)?,
        energy: file.read("energy", |entry| {
            let energy = entry.entries()?.only(&["kinetic", "elastic"])?;
            Ok([
                energy.read("kinetic", Entry::expression)?,
                energy.read("elastic", Entry::expression)?,
            ])
        })?,
        power,
        friction_gives,
        parts: each(file.table("parts")?, part)?,
    };
    if let Some(missing) = ["states", "modes"].into_iter().find(|key| file.get(key).is_none()) {
        let complaint = Complaint::new(whole, format!("the table [{missing}] is missing"));
        return Err(complaint.help("a model has states, and modes with their rates and events"));
    }
    if all.states.is_empty() || all.modes.is_empty() {
        return Err(Complaint::new(whole, "a model has at least one state and one mode")
            .help("as in `[states]` `x = 1` and `[modes.flight]` `rates = { x = \"-x\" }`"));
    }
    Ok(all)
}

/// `t_end`, or `run.t_end`, which it is short for; what is wrong with the latter the program says, as of every setting.
fn t_end(file: &Entries<'_>) -> Checked<Option<f64>> {
    let run = file.get("run").filter(|run| run.is_table()).map(|run| run.entries()).transpose()?;
    let long = run.and_then(|run| run.get("t_end"));
    let Some(short) = file.get("t_end") else {
        return Ok(long.and_then(|long| long.number().ok()).filter(|t_end| *t_end > 0.0));
    };
    match short.number()? {
        _ if long.is_some() => {
            let message = "`t_end` is short for `run.t_end`, which is given too";
            let complaint = Complaint::new(short.key_span, message);
            let complaint = complaint.help("leave one of them out");
            Err(match long {
                Some(long) => complaint.and(long.key_span, "here"),
                None => complaint,
            })
        }
        t_end if t_end > 0.0 => Ok(Some(t_end)),
        _ => Err(Complaint::new(short.span, "`t_end` is above zero")
            .help("it is the end of the runs, in seconds, which begin at 0")),
    }
}

fn each<'a, T>(entries: Vec<Entry<'a>>, read: impl Fn(Entry<'a>) -> Checked<T>) -> Checked<Vec<T>> {
    entries.into_iter().map(read).collect()
}

fn named(entry: Entry<'_>) -> Checked<Named> {
    Ok(Named { name: entry.name(), value: entry.expression()? })
}

fn parameter(entry: Entry<'_>) -> Checked<ParameterDeclaration> {
    let (name, mut range) = (entry.name(), crate::Range::default());
    if !entry.is_table() {
        let (value, value_span) = (entry.number()?, entry.span);
        return Ok(ParameterDeclaration {
            name,
            value,
            value_span,
            unit: None,
            about: String::new(),
            range,
        });
    }
    let entries =
        entry.entries()?.only(&["value", "unit", "about", "min", "max", "above", "below"])?;
    let value = entries.need("value", &format!("the parameter `{}`", name.value))?;
    range.min = entries.read("min", Entry::number)?;
    range.max = entries.read("max", Entry::number)?;
    range.above = entries.read("above", Entry::number)?;
    range.below = entries.read("below", Entry::number)?;
    Ok(ParameterDeclaration {
        name,
        value: value.number()?,
        value_span: value.span,
        unit: entries.read("unit", Entry::text)?,
        about: entries.read("about", Entry::text)?.map_or(String::new(), |about| about.value),
        range,
    })
}

fn definition(entry: Entry<'_>) -> Checked<Definition> {
    let name = entry.name();
    if !entry.is_table() {
        let value = entry.expression()?;
        return Ok(Definition {
            name,
            value,
            indices: None,
            unit: None,
            is_observable: false,
            of: None,
        });
    }
    let entries = entry.entries()?.only(&["value", "unit", "observe", "of", "for", "about"])?;
    let value = entries.need("value", &format!("the definition `{}`", name.value))?;
    let unit = entries.read("unit", Entry::text)?;
    Ok(Definition {
        name,
        value: value.expression()?,
        indices: entries.read("for", Entry::indices)?,
        is_observable: entries.read("observe", Entry::flag)?.unwrap_or(unit.is_some()),
        unit,
        of: entries.read("of", Entry::texts)?,
    })
}

fn state(entry: Entry<'_>) -> Checked<StateDeclaration> {
    let name = entry.name();
    if !entry.is_table() {
        let start = Some(entry.expression()?);
        return Ok(StateDeclaration {
            name,
            start,
            length: None,
            unit: None,
            scale: None,
            group: None,
        });
    }
    let entries = entry.entries()?.only(&["start", "length", "unit", "scale", "group", "about"])?;
    Ok(StateDeclaration {
        name,
        start: entries.read("start", Entry::expression)?,
        length: entries.read("length", Entry::expression)?,
        unit: entries.read("unit", Entry::text)?,
        scale: entries.read("scale", Entry::expression)?,
        group: entries.read("group", Entry::text)?,
    })
}

fn equation(entry: Entry<'_>) -> Checked<Equation> {
    let target = entry.target()?;
    let (name, index) = match target.kind {
        Kind::Name(name) => (name, None),
        Kind::Element(name, index) => (name, Some(*index)),
        _ => {
            let complaint = Complaint::new(entry.key_span, "a state stands on the left side");
            return Err(complaint.help("as in x = \"v\" or \"x[1]\" = \"v[1]\""));
        }
    };
    let target = At { value: name, span: entry.key_span };
    Ok(Equation { target, index, value: entry.expression()? })
}

fn mode(entry: Entry<'_>) -> Checked<ModeDeclaration> {
    let name = entry.name();
    let known = ["role", "contact", "keep", "definitions", "rates", "events", "about"];
    let entries = entry.entries()?.only(&known)?;
    let role = match (entries.read("contact", Entry::flag)?, entries.get("role")) {
        (Some(_), Some(role)) => {
            let message =
                "`contact = true` is short for `role = \"contact\"`; one of them is enough";
            return Err(Complaint::new(role.key_span, message).help("leave one of them out"));
        }
        (is_contact, None) => {
            if is_contact == Some(true) {
                ModeRole::Contact
            } else {
                ModeRole::Free
            }
        }
        (None, Some(role)) => role_of(role)?,
    };
    Ok(ModeDeclaration {
        name,
        role,
        keep: each(entries.table("keep")?, named)?,
        definitions: each(entries.table("definitions")?, definition)?,
        rates: each(entries.table("rates")?, equation)?,
        events: match entries.read("events", Entry::tables)? {
            None => Vec::new(),
            Some(events) => events.into_iter().map(event).collect::<Checked<_>>()?,
        },
    })
}

fn role_of(entry: Entry<'_>) -> Checked<ModeRole> {
    let word = entry.text()?;
    match word.value.as_str() {
        "free" => Ok(ModeRole::Free),
        "contact" => Ok(ModeRole::Contact),
        "stick" => Ok(ModeRole::Stick),
        other => Err(Complaint::new(word.span, format!("no role is called `{other}`"))
            .nearest(other, ["free", "contact", "stick"])),
    }
}

fn event((entries, span): (Entries<'_>, Span)) -> Checked<EventDeclaration> {
    let entries = entries.only(&["when", "to", "stop", "name", "set", "rest", "for"])?;
    let when = entries.need("when", "an event")?.condition()?;
    let follows = follows(&entries)?;
    if let (Some(to), true) = (&follows.to, follows.stops) {
        return Err(Complaint::new(to.span, "an event that stops the run leads to no mode")
            .help("leave `to` or `stop` out"));
    }
    if follows.to.is_none() && !follows.stops && follows.set.is_empty() {
        let complaint = Complaint::new(span, "nothing follows this event");
        return Err(complaint.help("give it `to = \"a mode\"`, `set = { … }` or `stop = true`"));
    }
    let rest = |entry: Entry<'_>| {
        let (span, rest) =
            (entry.key_span, self::follows(&entry.entries()?.only(&["to", "set"])?)?);
        match rest.to {
            Some(_) => Ok(rest),
            None => Err(Complaint::new(span, "a rest leads to a mode")
                .help("give it `to`: the mode that these events tend to")),
        }
    };
    // For readers of the file.
    entries.read("name", Entry::text)?;
    Ok(EventDeclaration {
        indices: entries.read("for", Entry::indices)?,
        when,
        follows,
        rest: entries.read("rest", rest)?,
    })
}

fn follows(entries: &Entries<'_>) -> Checked<Follows> {
    Ok(Follows {
        to: entries.read("to", Entry::text)?,
        stops: entries.read("stop", Entry::flag)?.unwrap_or(false),
        set: each(entries.table("set")?, equation)?,
    })
}

fn contact(entry: Entry<'_>) -> Checked<[Expression; 2]> {
    let entries = entry.entries()?.only(&["depth", "force"])?;
    let need = |key| entries.need(key, "[contact]")?.expression();
    Ok([need("depth")?, need("force")?])
}

/// The powers, and whether friction may give energy.
fn power(entry: Entry<'_>) -> Checked<([Option<Expression>; 3], bool)> {
    let entries = entry.entries()?.only(&["drive", "damping", "friction", "friction_gives"])?;
    let read = |key| entries.read(key, Entry::expression);
    let powers = [read("drive")?, read("damping")?, read("friction")?];
    Ok((powers, entries.read("friction_gives", Entry::flag)?.unwrap_or(false)))
}

fn part(entry: Entry<'_>) -> Checked<PartDeclaration> {
    let name = entry.name();
    let entries = entry.entries()?;
    let start = each(entries.table("start")?, equation)?;
    let parameters = entries.iter().filter(|entry| entry.key != "start");
    let parameters =
        parameters.map(|entry| Ok((entry.name(), entry.number()?))).collect::<Checked<_>>()?;
    Ok(PartDeclaration { name, parameters, start })
}

//! The problem: a hybrid system with what a study must know of it, and what it may know.

use std::borrow::Cow;

use deltazero_solvers::{Error, Next, Outcome, Real, Record, Switch, System};
use serde::{Deserialize, Serialize};

use crate::run::{Begun, ModeChange, OwnRun, Setting, no_such_run, one_by_one};

/// States that a summary tells.
const MOST_IN_BRIEF: usize = 8;

/// A state, or something computed from the states.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Name, as in the header of a table.
    pub name: Cow<'static, str>,
    /// Unit; empty for what has none.
    pub unit: Cow<'static, str>,
    /// Natural size, in that unit: relative tolerances become absolute ones by it.
    pub scale: f64,
}

impl Quantity {
    /// A quantity of this name, unit and natural size.
    pub fn new(
        name: impl Into<Cow<'static, str>>,
        unit: impl Into<Cow<'static, str>>,
        scale: f64,
    ) -> Self {
        Self { name: name.into(), unit: unit.into(), scale }
    }

    /// What is above its column in a table: `v1_m_s` of v1 in m/s, `x_Mm` of x in megametres, which are no millimetres.
    pub fn header(&self) -> String {
        let lower = |word: &str| match word.strip_prefix('M') {
            Some(rest) if !rest.is_empty() => format!("M{}", rest.to_lowercase()),
            _ => word.to_lowercase(),
        };
        let unit = self.unit.replace('²', "2");
        let unit = unit.split(['/', ' ']).map(lower).collect::<Vec<_>>().join("_");
        if unit.is_empty() { self.name.to_string() } else { format!("{}_{unit}", self.name) }
    }
}

/// In what the error of a group of states is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GroupScale {
    /// This number, in the states' unit.
    Fixed(f64),
    /// The largest length that the group takes at the samples of the reference; groups of one name share it, over all
    /// parts of a subject.
    Largest,
}

/// States whose errors are one vector: a displacement, an angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Name.
    pub name: Cow<'static, str>,
    /// Unit of its states.
    pub unit: Cow<'static, str>,
    /// Indices of its states.
    pub states: Vec<usize>,
    /// What its error is divided by.
    pub scale: GroupScale,
    /// The site that it belongs to.
    pub site: usize,
}

/// Groups of one state each, over its largest magnitude; `states` are those of a problem from the first one on.
pub fn each_a_group(states: impl IntoIterator<Item = Quantity>) -> Vec<Group> {
    let group = |(i, state): (usize, Quantity)| Group {
        name: state.name,
        unit: state.unit,
        states: vec![i],
        scale: GroupScale::Largest,
        site: 0,
    };
    states.into_iter().enumerate().map(group).collect()
}

/// What a site does in a mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Held: there is no contact that could open.
    Held,
    /// Free of contact.
    Free,
    /// In contact; where there is friction, the surfaces slide.
    Contact,
    /// In contact, and held by friction.
    Stick,
}

impl Role {
    /// Whether a contact force acts.
    pub fn is_contact(self) -> bool {
        matches!(self, Self::Contact | Self::Stick)
    }

    /// As tables of work name it.
    pub fn phase(self) -> &'static str {
        match self {
            Self::Held => "pinned",
            Self::Free => "flight",
            Self::Contact => "contact",
            Self::Stick => "stick",
        }
    }

    /// The usual code of such a mode in a table: 0 free, 1 in contact, 2 sticking.
    pub fn code(self) -> i8 {
        match self {
            Self::Held | Self::Free => 0,
            Self::Contact => 1,
            Self::Stick => 2,
        }
    }
}

/// A contact at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch<S> {
    /// Penetration δ [m]; below zero the gap.
    pub depth: S,
    /// Its rate δ̇ [m/s].
    pub rate: S,
    /// Normal force F_N [N]; zero where the mode is no contact.
    pub force: S,
}

/// What a terminal event did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EndName {
    /// As an outcome in a file.
    pub key: &'static str,
    /// As a summary says it.
    pub words: &'static str,
}

/// Energies of a state [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy, and what else is stored outside the contacts.
    pub kinetic: f64,
    /// Elastic energy of the contacts; none where the mode is no contact.
    pub elastic: f64,
}

/// Powers at a state [W].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Power {
    /// Of what drives the system.
    pub drive: f64,
    /// Taken by damping or hysteresis of the contacts.
    pub damping: f64,
    /// Taken by friction.
    pub friction: f64,
}

impl Power {
    /// Taken by damping and friction.
    pub fn dissipated(&self) -> f64 {
        self.damping + self.friction
    }
}

/// What a run of a problem is judged by without a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laws {
    /// Whether the equations conserve energy: work, energy and dissipation balance.
    pub balances: bool,
    /// Whether damping only takes energy.
    pub damping_takes: bool,
    /// Whether friction only takes energy.
    pub friction_takes: bool,
    /// Penetration beyond which the law of contact means nothing.
    pub deepest: Option<f64>,
}

/// A hybrid system as a study sees it.
///
/// A study must know where it [starts](Self::start) and what its [states](Self::states) are. All else has a default
/// that says "not given", and what is not given is absent from tables, figures and reports.
///
/// A system may have several *sites*: places, each with a mode of its own, whose events and contacts are told apart.
/// A mechanism with three joints has three; by default there is one.
pub trait Problem: System<Mode: Send + Sync> + Send + Sync {
    /// The state at t = 0.
    fn start(&self) -> Self::State<f64>;

    /// Names, units and natural sizes of the states, in their order.
    fn states(&self) -> Vec<Quantity>;

    /// Whether it can be integrated at all.
    ///
    /// # Errors
    /// Why not.
    fn check(&self) -> Result<(), Error> {
        Ok(())
    }

    /// How errors are measured: `e` is the largest, over samples and groups, of the Euclidean error of a group over its
    /// scale. By default each state is a group, over its largest magnitude.
    fn groups(&self) -> Vec<Group> {
        each_a_group(self.states())
    }

    /// Its name, where a subject has several parts.
    fn name(&self) -> String {
        String::new()
    }

    /// Number of sites.
    fn n_sites(&self) -> usize {
        1
    }

    /// The name of a site.
    fn site_name(&self, _site: usize) -> String {
        self.name()
    }

    /// The site that a guard of a mode belongs to.
    fn site_of_guard(&self, _mode: &Self::Mode, _guard: usize) -> usize {
        0
    }

    /// What a site does in a mode.
    fn role(&self, _mode: &Self::Mode, _site: usize) -> Role {
        Role::Free
    }

    /// The code of a site's mode in tables: 0 free, 2 sticking, any other in contact.
    fn code(&self, mode: &Self::Mode, site: usize) -> i8 {
        self.role(mode, site).code()
    }

    /// The number of a mode, where its code does not tell it from the others: runs are compared by both.
    fn mode_number(&self, _mode: &Self::Mode) -> u16 {
        0
    }

    /// Names of the modes by their [numbers](Self::mode_number), where figures tell modes by name; where there are none
    /// they tell what a site does: flight, contact, stick.
    fn named_modes(&self) -> Vec<String> {
        Vec::new()
    }

    /// Whether an event that leads from one mode to another at a site counts. Runs are compared by the events that do, but
    /// for that of a [start on a surface](Self::starts_on_surface).
    fn is_counted(&self, _before: &Self::Mode, _after: &Self::Mode, _site: usize) -> bool {
        true
    }

    /// Whether it starts on the surface of a guard. The first event of each site that [counts](Self::is_counted) is then
    /// the start's own: its time has no digits, and runs are not compared by it.
    fn starts_on_surface(&self) -> bool {
        false
    }

    /// In what its time is counted [s]. Events of two runs further apart than a thousandth of it are not the same.
    fn unit_of_time(&self) -> f64 {
        1.0
    }

    /// Whether a mode that is a contact has a [force](Self::touch): by default it must. A model of rigid contacts, or of
    /// friction alone, has none to tell.
    fn tells_forces(&self) -> bool {
        true
    }

    /// The contact at a site: in every mode at every site, without force where the mode is no contact; or none in any
    /// mode, where no force is known.
    fn touch<S: Real>(
        &self,
        _mode: &Self::Mode,
        _t: S,
        _y: &Self::State<S>,
        _site: usize,
    ) -> Option<Touch<S>> {
        None
    }

    /// Energies at `(t, y)` in `mode`, if they are given; then [`powers`](Self::powers) are, too.
    fn energies(&self, _mode: &Self::Mode, _t: f64, _y: &Self::State<f64>) -> Option<Energy> {
        None
    }

    /// Powers there.
    fn powers(&self, _mode: &Self::Mode, _t: f64, _y: &Self::State<f64>) -> Option<Power> {
        None
    }

    /// Work of the drive from `y0` to `y1` [J], where it needs no quadrature.
    fn drive_work(&self, _y0: &Self::State<f64>, _y1: &Self::State<f64>) -> Option<f64> {
        None
    }

    /// Whether an event between these modes takes energy, or gives back what one took: an impact, or a contact that
    /// ends with its surfaces still dented. The energy that the event changes then counts as dissipated.
    fn takes_energy(&self, _before: &Self::Mode, _after: &Self::Mode) -> bool {
        false
    }

    /// A mode of a site as a table of events and a trajectory name it.
    fn mode_name(&self, mode: &Self::Mode, _site: usize) -> String {
        format!("{mode:?}")
    }

    /// What tells a site apart from the others of its subject, as leading columns of tables: by default its number,
    /// from 1, where there are several.
    fn labels(&self, site: usize) -> Vec<(&'static str, usize)> {
        if self.n_sites() > 1 { vec![("site", site + 1)] } else { Vec::new() }
    }

    /// The columns of a site's motion: by default all states.
    fn columns(&self, _site: usize) -> Vec<Quantity> {
        self.states()
    }

    /// Gives `row` what each site has in its [columns](Self::columns) at `(t, y)` in `mode`.
    fn rows(
        &self,
        _mode: &Self::Mode,
        _t: f64,
        y: &Self::State<f64>,
        row: &mut dyn FnMut(usize, &[f64]),
    ) {
        (0..self.n_sites()).for_each(|site| row(site, y.as_ref()));
    }

    /// A state in some words, for a summary: by default each number with its unit, of very many the first.
    fn in_brief(&self, y: &Self::State<f64>) -> String {
        let states = self.states();
        let words = states.iter().zip(y.as_ref()).map(|(state, y)| {
            let unit =
                if state.unit.is_empty() { String::new() } else { format!(" {}", state.unit) };
            format!("{} = {y:.6e}{unit}", state.name)
        });
        let mut text = words.take(MOST_IN_BRIEF).collect::<Vec<_>>().join(", ");
        if states.len() > MOST_IN_BRIEF {
            text += &format!(", … ({} states)", states.len());
        }
        text
    }

    /// Whether the contact that begins between these modes is slower than the least speed of impact that its law
    /// reckons with.
    fn begins_at_speed_floor(&self, _before: &Self::Mode, _after: &Self::Mode) -> bool {
        false
    }

    /// A way out of stiffness beside an implicit method, as the end of a sentence.
    fn out_of_stiffness(&self) -> &'static str {
        ""
    }

    /// The site nearest to where the model ends, where that can be told.
    fn nearest_end(&self, _mode: &Self::Mode, _y: &Self::State<f64>) -> Option<usize> {
        None
    }

    /// Where the model is written that `error` of a run is about: lines of a file, to be shown below it. None by default.
    fn place_of(&self, _error: &Error) -> Option<String> {
        None
    }

    /// What a run is said to have done that a terminal event ended.
    fn end_name(&self) -> EndName {
        EndName { key: "stopped", words: "stopped" }
    }

    /// What a run is judged by without a reference.
    fn laws(&self) -> Laws {
        Laws { balances: true, damping_takes: true, friction_takes: true, deepest: None }
    }

    /// Writes the absolute tolerances that a user gave to `all`, which has one for each state: by default in their order.
    fn spread(&self, each: &[f64], all: &mut [f64]) {
        all.iter_mut().zip(each).for_each(|(atol, own)| *atol = *own);
    }

    /// What a run ended with, as the model sees it: where what stopped it was the end of the model's validity, an
    /// error.
    ///
    /// # Errors
    /// That one, or the run's own.
    fn judged(
        &self,
        outcome: Result<Outcome, Error>,
        _t: f64,
        _mode: &Self::Mode,
        _y: &Self::State<f64>,
    ) -> Result<Outcome, Error> {
        outcome
    }

    /// Whether it has [blind](Self::integrate_blind) runs.
    fn has_blind_runs(&self) -> bool {
        false
    }

    /// The mode that a blind run is computed in at `(t, y)`, inside a step begun in `mode`.
    fn mode_read(&self, mode: &Self::Mode, _t: f64, _y: &Self::State<f64>) -> Self::Mode {
        mode.clone()
    }

    /// A run that reads its mode off the state. A model that can is a
    /// [`ModeOfState`](deltazero_solvers::ModeOfState), and calls [`blind`](crate::run::blind).
    fn integrate_blind(
        &self,
        _setting: &Setting,
        y0: Self::State<f64>,
        _t_end: f64,
        _record: &mut dyn Record<Self>,
    ) -> OwnRun<Self>
    where
        Self: Sized,
    {
        no_such_run(self, y0, "this model has no blind run; use events = \"located\"")
    }

    /// Whether several of its kind are faster [at once](Self::integrate_at_once) than one after the other.
    fn runs_at_once(&self) -> bool {
        false
    }

    /// Runs of several of its kind with located events, each shown to the record of its place, with the bits that each
    /// has alone. A model that is [`Alike`](deltazero_solvers::Alike) calls [`at_once`](crate::run::at_once).
    fn integrate_at_once(
        runs: &[Begun<'_, Self>],
        setting: &Setting,
        t_end: f64,
        records: &mut [&mut dyn Record<Self>],
    ) -> Vec<OwnRun<Self>>
    where
        Self: Sized,
    {
        one_by_one(runs, setting, t_end, records)
    }

    /// A run in extended precision at the relative tolerance `rtol`. A model that offers it calls
    /// [`extended`](crate::run::extended), which compiles one method more.
    fn integrate_extended(
        &self,
        _rtol: f64,
        y0: Self::State<f64>,
        _t_end: f64,
        _record: &mut dyn Record<Self>,
    ) -> OwnRun<Self>
    where
        Self: Sized,
    {
        no_such_run(self, y0, "this model has no run in extended precision; use double")
    }
}

/// The site that stands for the whole of a problem where one has to: the first which sticks, else the first in contact,
/// else the first.
pub fn leading_site<P: Problem>(problem: &P, mode: &P::Mode) -> usize {
    let first =
        |is: fn(Role) -> bool| (0..problem.n_sites()).find(|site| is(problem.role(mode, *site)));
    first(|role| role == Role::Stick).or_else(|| first(Role::is_contact)).unwrap_or(0)
}

/// The natural sizes of the states.
pub fn scales<P: Problem>(problem: &P) -> Vec<f64> {
    problem.states().into_iter().map(|state| state.scale).collect()
}

/// The event as tables write it, with its site; none of one that does not [count](Problem::is_counted), or that ends the
/// run. The start's own is among them; see [`StartEvents`].
pub fn change<P: Problem>(
    problem: &P,
    t: f64,
    guard: usize,
    before: &P::Mode,
    after: &Next<P::Mode>,
) -> Option<(usize, ModeChange)> {
    let Next::Mode(after) = after else { return None };
    let site = problem.site_of_guard(before, guard);
    let [from, to] = [before, after].map(|mode| problem.code(mode, site));
    let numbers = [before, after].map(|mode| problem.mode_number(mode));
    let change = ModeChange { t, before: from, after: to, numbers };
    problem.is_counted(before, after, site).then_some((site, change))
}

/// Tells the start's own event of each site from the others that [count](Problem::is_counted): the first one, where the
/// problem [starts on a surface](Problem::starts_on_surface).
#[derive(Clone, Debug)]
pub struct StartEvents {
    /// Whether that of a site is still to come.
    is_due: Vec<bool>,
}

impl StartEvents {
    /// No event yet in a run of `problem`.
    pub fn of<P: Problem>(problem: &P) -> Self {
        Self { is_due: vec![problem.starts_on_surface(); problem.n_sites()] }
    }

    /// Notes an event of `site` that counts. Returns whether it is the start's own.
    pub fn take(&mut self, site: usize) -> bool {
        std::mem::take(&mut self.is_due[site])
    }
}

/// The events of each site that runs are compared by: those that [count](Problem::is_counted), without the
/// [start's own](StartEvents).
pub fn changes<P: Problem>(problem: &P, events: &[Switch<P::Mode>]) -> Vec<Vec<ModeChange>> {
    let mut all = vec![Vec::new(); problem.n_sites()];
    let mut of_start = StartEvents::of(problem);
    for Switch { t, guard, before, after } in events {
        if let Some((site, change)) = change(problem, *t, *guard, before, after)
            && !of_start.take(site)
        {
            all[site].push(change);
        }
    }
    all
}

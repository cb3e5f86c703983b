//! A subject of a study: one problem, or several that share no term; each whatever its type.

use std::fmt;
use std::sync::Arc;

use deltazero_solvers::{Grid, Trajectory};

use crate::brief::{Brief, BriefShape, brief, shape};
use crate::check::{ProblemError, check};
use crate::errors::{ErrorScale, Largest};
use crate::measured::{MeasuredPart, measure};
use crate::problem::{EndName, Group, Problem, Quantity, nudged};
use crate::reference::{Maker, PartReference, Path, ReferenceError, path};
use crate::run::{Brake, Braked, Limits, ModeChange, PartRun, Setting, integrate};
use crate::simulation::{Asked, Simulation, SiteMotion, motion_with_touches, simulate};
use crate::steps::step_size::{Steps, steps};
use crate::trace::Trace;

/// Where a run starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// At the problem's start.
    Exact,
    /// Each of its numbers moved up by its last bit.
    Up,
    /// Each moved down.
    Down,
}

impl Start {
    /// The state of `problem` there.
    pub fn of<P: Problem>(self, problem: &P) -> P::State<f64> {
        match self {
            Self::Exact => problem.start(),
            Self::Up => nudged(problem, f64::next_up),
            Self::Down => nudged(problem, f64::next_down),
        }
    }
}

/// The runs of a problem that a study makes.
pub(crate) trait Runs: Send + Sync {
    /// Samples on `grid` and events, timed.
    fn run(
        &self,
        setting: &Setting,
        start: Start,
        t_end: f64,
        grid: &Grid,
        brake: &mut dyn Brake,
    ) -> (PartRun, Trace);

    /// All that a reference keeps.
    fn path(
        &self,
        maker: &Maker,
        start: Start,
        t_end: f64,
        times: &[f64],
        limits: Limits<'_>,
    ) -> Result<Path, ReferenceError>;

    /// All that is measured against a reference.
    fn measure(
        &self,
        setting: &Setting,
        reference: &PartReference,
        t_end: f64,
        grid: &Grid,
        brake: &mut dyn Brake,
    ) -> MeasuredPart;

    /// Whether what the problem says of itself fits together.
    fn check(&self) -> Result<(), ProblemError>;

    /// The motion of the first site at `times`, with its contacts.
    fn motion(
        &self,
        setting: &Setting,
        times: &[f64],
        t_end: f64,
        brake: &mut dyn Brake,
    ) -> Option<SiteMotion>;

    /// All that a user may ask of one run.
    fn simulate(&self, asked: &Asked<'_>, brake: &mut dyn Brake) -> Simulation;

    /// What a run in brief tells of.
    fn brief_shape(&self, audit: bool) -> BriefShape;

    /// One run, of which no more than its end and some numbers are kept.
    fn brief(&self, setting: &Setting, t_end: f64, audit: bool, brake: &mut dyn Brake) -> Brief;

    /// Every step.
    fn steps(&self, setting: &Setting, t_end: f64, brake: &mut dyn Brake) -> (PartRun, Steps);
}

impl<P: Problem> Runs for P {
    fn run(
        &self,
        setting: &Setting,
        start: Start,
        t_end: f64,
        grid: &Grid,
        brake: &mut dyn Brake,
    ) -> (PartRun, Trace) {
        let mut record = (Trajectory::on(grid.clone()), Braked(brake));
        let run = integrate(self, setting, start.of(self), t_end, &mut record);
        (run.plain(), Trace::of(self, &record.0))
    }

    fn path(
        &self,
        maker: &Maker,
        start: Start,
        t_end: f64,
        times: &[f64],
        limits: Limits<'_>,
    ) -> Result<Path, ReferenceError> {
        path(self, maker, start, t_end, times, limits)
    }

    fn measure(
        &self,
        setting: &Setting,
        reference: &PartReference,
        t_end: f64,
        grid: &Grid,
        brake: &mut dyn Brake,
    ) -> MeasuredPart {
        measure(self, setting, reference, t_end, grid, brake)
    }

    fn check(&self) -> Result<(), ProblemError> {
        check(self)
    }

    fn motion(
        &self,
        setting: &Setting,
        times: &[f64],
        t_end: f64,
        brake: &mut dyn Brake,
    ) -> Option<SiteMotion> {
        let mut record = (Trajectory::on(Grid::Times(times.to_vec())), Braked(brake));
        integrate(self, setting, self.start(), t_end, &mut record);
        motion_with_touches(self, &record.0)
    }

    fn simulate(&self, asked: &Asked<'_>, brake: &mut dyn Brake) -> Simulation {
        simulate(self, asked, brake)
    }

    fn brief_shape(&self, audit: bool) -> BriefShape {
        shape(self, audit)
    }

    fn brief(&self, setting: &Setting, t_end: f64, audit: bool, brake: &mut dyn Brake) -> Brief {
        brief(self, setting, t_end, audit, brake)
    }

    fn steps(&self, setting: &Setting, t_end: f64, brake: &mut dyn Brake) -> (PartRun, Steps) {
        steps(self, setting, t_end, brake)
    }
}

/// One problem of a subject, whatever its type.
#[derive(Clone)]
pub struct Part {
    /// Its name; empty where it is alone and has none.
    pub name: String,
    /// Names of its sites.
    pub sites: Vec<String>,
    /// What tells each of its sites apart from the others.
    pub labels: Vec<Vec<(&'static str, usize)>>,
    /// What a terminal event does that ends a run of it.
    pub end_name: EndName,
    /// Its states.
    pub states: Vec<Quantity>,
    /// How its errors are measured.
    pub groups: Vec<Group>,
    /// In what its time is counted [s].
    pub unit_of_time: f64,
    /// Whether it has runs that read their mode off the state.
    pub has_blind_runs: bool,
    /// Whether it starts on the surface of a guard.
    pub starts_on_surface: bool,
    pub(crate) runs: Arc<dyn Runs>,
}

impl fmt::Debug for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Part").field("name", &self.name).field("sites", &self.sites).finish()
    }
}

impl Part {
    /// The part that `problem` is.
    pub fn new<P: Problem + 'static>(problem: P) -> Self {
        Self {
            name: problem.name(),
            sites: (0..problem.n_sites()).map(|site| problem.site_name(site)).collect(),
            labels: (0..problem.n_sites()).map(|site| problem.labels(site)).collect(),
            end_name: problem.end_name(),
            states: problem.states(),
            groups: problem.groups(),
            unit_of_time: problem.unit_of_time(),
            has_blind_runs: problem.has_blind_runs(),
            starts_on_surface: problem.starts_on_surface(),
            runs: Arc::new(problem),
        }
    }

    /// Whether what it says of itself fits together.
    ///
    /// # Errors
    /// [`ProblemError`], the first that is found.
    pub fn check(&self) -> Result<(), ProblemError> {
        self.runs.check()
    }

    /// Runs it at `setting` from `start` to `t_end`, samples kept on `grid`.
    pub fn run(
        &self,
        setting: &Setting,
        start: Start,
        t_end: f64,
        grid: &Grid,
        brake: &mut dyn Brake,
    ) -> (PartRun, Trace) {
        self.runs.run(setting, start, t_end, grid, brake)
    }

    /// The motion of its first site at `times`, with its contacts, of a run at `setting` to `t_end`.
    pub fn motion(
        &self,
        setting: &Setting,
        times: &[f64],
        t_end: f64,
        brake: &mut dyn Brake,
    ) -> Option<SiteMotion> {
        self.runs.motion(setting, times, t_end, brake)
    }

    /// Runs it once, and tells all of the run.
    pub fn simulate(&self, asked: &Asked<'_>, brake: &mut dyn Brake) -> Simulation {
        self.runs.simulate(asked, brake)
    }

    /// What a run of it [in brief](Self::brief) tells of.
    pub fn brief_shape(&self, audit: bool) -> BriefShape {
        self.runs.brief_shape(audit)
    }

    /// Runs it once at `setting` to `t_end`, and tells its end and some numbers alone: with an `audit` those of its
    /// contacts and its energy too, which more than double its time.
    pub fn brief(
        &self,
        setting: &Setting,
        t_end: f64,
        audit: bool,
        brake: &mut dyn Brake,
    ) -> Brief {
        self.runs.brief(setting, t_end, audit, brake)
    }

    /// The scales of its errors, by these largest lengths.
    pub fn error_scale(&self, largest: &Largest) -> ErrorScale {
        ErrorScale::new(&self.groups, self.unit_of_time, largest)
    }

    /// Enters the lengths that its groups take in `states`.
    pub fn measure(&self, states: &[Vec<f64>], largest: &mut Largest) {
        largest.begin(&self.groups, &self.scales());
        states.iter().for_each(|y| largest.see(&self.groups, y));
    }

    /// The natural sizes of its states.
    pub fn scales(&self) -> Vec<f64> {
        self.states.iter().map(|state| state.scale).collect()
    }
}

/// The events of a site that count: all but the one of a start on the surface, whose time has no digits.
pub fn counted(events: &[ModeChange], starts_on_surface: bool) -> &[ModeChange] {
    &events[usize::from(starts_on_surface && !events.is_empty())..]
}

/// What a study is about: problems that share no term, run one after the other.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Its parts.
    pub parts: Vec<Part>,
}

impl Subject {
    /// One problem.
    pub fn of<P: Problem + 'static>(problem: P) -> Self {
        Self { parts: vec![Part::new(problem)] }
    }

    /// In what its time is counted [s].
    pub fn unit_of_time(&self) -> f64 {
        self.parts.first().map_or(1.0, |part| part.unit_of_time)
    }

    /// Whether each of its parts has runs that read their mode off the state.
    pub fn has_blind_runs(&self) -> bool {
        self.parts.iter().all(|part| part.has_blind_runs)
    }
}

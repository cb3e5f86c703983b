//! A subject of a study: one problem, or several that share no term; each whatever its type.

use std::any::{Any, TypeId};
use std::fmt;
use std::sync::Arc;

use deltazero_solvers::{Grid, Outcome, Trajectory};

use crate::accepted::{Steps, steps};
use crate::brief::{Brief, BriefShape, briefs_of, shape};
use crate::check::{ProblemError, check};
use crate::errors::{ErrorScale, Largest};
use crate::kinds::{by_kind, of_type};
use crate::measured::{MeasuredPart, measure};
use crate::nudge::{far, nudged};
use crate::problem::{EndName, Group, Problem, Quantity};
use crate::reference::{Maker, PartReference, Path, ReferenceError, path};
use crate::run::{
    Brake, Braked, Limits, OwnRun, PartRun, Price, Setting, Took, integrate, integrate_all,
    is_at_once,
};
use crate::simulation::{Asked, Simulation, SiteMotion, motion_with_touches, simulate};
use crate::trace::Trace;

/// Where a run starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Start {
    /// At the problem's start.
    Exact,
    /// Each of its numbers moved up by its last bit, or near zero by roundings of its natural size.
    Up,
    /// Each moved down.
    Down,
    /// Each moved up by roundings of its natural size.
    Far,
}

impl Start {
    /// The state of `problem` there.
    pub fn of<P: Problem>(self, problem: &P) -> P::State<f64> {
        match self {
            Self::Exact => problem.start(),
            Self::Up => nudged(problem, f64::next_up),
            Self::Down => nudged(problem, f64::next_down),
            Self::Far => far(problem, true),
        }
    }
}

/// The runs of a problem that a study makes.
pub(crate) trait Runs: Send + Sync {
    /// Its type.
    fn kind(&self) -> TypeId;

    /// Itself, to be asked for its type.
    fn as_any(&self) -> &dyn Any;

    /// Whether runs at `setting` of several of its type are computed at once.
    fn runs_at_once(&self, setting: &Setting) -> bool;

    /// Samples on `grid` and events, timed, of `all`, which are of its type.
    fn traces(
        &self,
        all: &[&dyn Runs],
        setting: &Setting,
        start: Start,
        t_end: f64,
        grid: &Grid,
        brakes: &mut [&mut dyn Brake],
    ) -> Vec<(PartRun, Trace)>;

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

    /// Runs of `all`, which are of its type, of which no more than their ends and some numbers are kept.
    fn briefs(
        &self,
        all: &[&dyn Runs],
        setting: &Setting,
        t_end: f64,
        audit: bool,
        brakes: &mut [&mut dyn Brake],
    ) -> Vec<Brief>;

    /// Every step.
    fn steps(&self, setting: &Setting, t_end: f64, brake: &mut dyn Brake) -> (PartRun, Steps);
}

impl<P: Problem + 'static> Runs for P {
    fn kind(&self) -> TypeId {
        TypeId::of::<P>()
    }

    fn as_any(&self) -> &dyn Any {
        self
    }

    fn runs_at_once(&self, setting: &Setting) -> bool {
        is_at_once(self, setting)
    }

    fn traces(
        &self,
        all: &[&dyn Runs],
        setting: &Setting,
        start: Start,
        t_end: f64,
        grid: &Grid,
        brakes: &mut [&mut dyn Brake],
    ) -> Vec<(PartRun, Trace)> {
        let problems = of_type::<P>(all);
        let begun: Vec<_> = problems.iter().map(|own| (*own, start.of(*own))).collect();
        let mut records = Vec::new();
        for brake in brakes {
            records.push((Trajectory::on(grid.clone()), Braked(&mut **brake)));
        }
        let runs = integrate_all(&begun, setting, t_end, &mut records);
        let traced = |((own, run), (trajectory, _)): ((&&P, OwnRun<P>), &(_, _))| {
            (run.plain(), Trace::of(*own, trajectory, run.t))
        };
        problems.iter().zip(runs).zip(&records).map(traced).collect()
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

    fn briefs(
        &self,
        all: &[&dyn Runs],
        setting: &Setting,
        t_end: f64,
        audit: bool,
        brakes: &mut [&mut dyn Brake],
    ) -> Vec<Brief> {
        briefs_of(&of_type::<P>(all), setting, t_end, audit, brakes)
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
    /// [Names](Problem::named_modes) of its modes, where figures tell modes by name.
    pub modes: Vec<String>,
    /// In what its time is counted [s].
    pub unit_of_time: f64,
    /// Whether it has runs that read their mode off the state.
    pub has_blind_runs: bool,
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
            modes: problem.named_modes(),
            unit_of_time: problem.unit_of_time(),
            has_blind_runs: problem.has_blind_runs(),
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
        let mut all = self.runs.traces(&[&*self.runs], setting, start, t_end, grid, &mut [brake]);
        // Of one part there is one run.
        all.remove(0)
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

    /// Whether runs of it at `setting` are computed at once with others of its kind.
    pub fn runs_at_once(&self, setting: &Setting) -> bool {
        self.runs.runs_at_once(setting)
    }

    /// Runs it once, and tells all of the run.
    pub fn simulate(&self, asked: &Asked<'_>, brake: &mut dyn Brake) -> Simulation {
        self.runs.simulate(asked, brake)
    }

    /// What a run of it [in brief](briefs) tells of.
    pub fn brief_shape(&self, audit: bool) -> BriefShape {
        self.runs.brief_shape(audit)
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

/// What a study is about: problems that share no term, run one after the other.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Its parts.
    pub parts: Vec<Part>,
}

/// The time of a run, and how it was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// What all parts took.
    pub took: Took,
    /// Most parts that were computed at once; one where they were run one after the other.
    pub batch: usize,
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

    /// The time that a run of it takes, parts of a kind computed at once where that is offered; none where it is broken
    /// off, which is no time. The limits are those of each part.
    pub fn took(
        &self,
        setting: &Setting,
        t_end: f64,
        grid: &Grid,
        limits: Limits<'_>,
    ) -> Option<Timing> {
        let price = Price::of_setting(setting);
        let mut watches: Vec<_> = self.parts.iter().map(|_| limits.watch(price)).collect();
        let parts: Vec<&Part> = self.parts.iter().collect();
        let runs = by_kind(&parts, &mut watches, |first, all, brakes| {
            first.traces(all, setting, Start::Exact, t_end, grid, brakes)
        });
        let is_whole = runs.iter().all(|(run, _)| run.outcome != Ok(Outcome::Interrupted));
        is_whole.then(|| Timing {
            took: runs.iter().map(|(run, _)| run.took).sum(),
            batch: runs.iter().map(|(run, _)| run.batch).max().unwrap_or(1),
        })
    }

    /// Whether each of its parts has runs that read their mode off the state.
    pub fn has_blind_runs(&self) -> bool {
        self.parts.iter().all(|part| part.has_blind_runs)
    }
}

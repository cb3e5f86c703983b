//! The runs that a reference is made of: one, another that tells its error, and one from a start changed in
//! its last bit.

use std::ops::ControlFlow;

use deltazero_solvers::contracts::Checked;
use deltazero_solvers::taylor::MAX_ORDER;
use deltazero_solvers::{
    Accepted, Event, Grid, Method, Needs, Outcome, Record, Trajectory, Vector as _,
};
use num_dual::Dual64;

use super::ReferenceError;
use crate::account::Account;
use crate::balance::Balance;
use crate::check::{Entered, check_contracts};
use crate::errors::contacts::Contact;
use crate::errors::dense::{Node, Nodes};
use crate::errors::{ErrorScale, Largest, match_to_end, worse};
use crate::part::{Part, Start};
use crate::problem::{Problem, StartEvents, change};
use crate::run::{
    Accuracy, Braked, Events, Limit, Limits, ModeChange, OwnRun, PartRun, Price, Setting, integrate,
};
use crate::trace::Trace;
use crate::warning::Warning;

/// Changes with whatever changes results: what is kept on disk of a reference, a study or a map that is not
/// finished is then made anew.
pub const RECIPE: u32 = 22;

/// Method and tolerance of the reference, and those of the run that tells its error.
type Pair = [(&'static str, f64); 2];

/// The pairs of runs that references are made of, in the order in which they are tried.
///
/// Taylor series of order 23 and 25 are at rounding: on Table 1 the former agrees with extended precision to
/// `e = 2.2e-14`, and they differ by 2.9e-14. An explicit series is out of reach where damping is so strong that
/// stability bounds its steps (K = 1e9 N/m, ζ = 10 takes 5e5 series): `radau5` is then right to 1e-11 with
/// a tenth of the time, and `rodas5p` has the events right where two tolerances of `radau5` differ in them.
/// `vern98` and `dop853` are for what none of these can do.
///
/// Of the others than series two runs may part though the motion is predictable: where one rejects a step that the other
/// accepts, they differ by the error of a step. At K = 1e11 N/m without damping, reading `full`, two runs of `radau5` from
/// starts that differ in the last bit part after 0.14 s, and two of `rodas5p` not in 0.8 s.
const PAIRS: [Pair; 4] = [
    [("taylor", 1e-14), ("taylor", 1e-15)],
    [("radau5", 1e-14), ("radau5", 1e-13)],
    [("rodas5p", 1e-13), ("radau5", 1e-14)],
    [("vern98", 1e-13), ("dop853", 1e-14)],
];

/// The settings of a reference in f64, in the order in which they are tried.
pub fn settings() -> impl Iterator<Item = Setting> {
    PAIRS.into_iter().filter_map(|[(name, rtol), _]| {
        let (method, accuracy) = (Method::named(name)?, Accuracy::Rtol(rtol, None));
        Some(Setting { method, events: Events::Located, accuracy })
    })
}

/// Relative tolerances in extended precision, where a run on Table 1 changes by 3e-16 of the clearance.
const EXTENDED_RTOL: [f64; 2] = [1e-18, 1e-20];

/// Runs that differ by more than this in `e` let the next pair try.
const AGREED: f64 = 1e-8;

/// A last-bit change of the start that grows beyond this `e` ends the horizon.
pub const HORIZON_ERROR: f64 = 1e-9;

/// The first sample time at which two runs differ by more than [`HORIZON_ERROR`] [s].
pub fn parted_at(own: &Trace, other: &Trace, scale: &ErrorScale) -> Option<f64> {
    differ_at(own, other, scale, HORIZON_ERROR)
}

/// The first sample time at which two runs differ by more than `most` in `e` [s].
fn differ_at(own: &Trace, other: &Trace, scale: &ErrorScale, most: f64) -> Option<f64> {
    let is_lost = |a: &[f64], b: &[f64]| scale.error(b, a).total_cmp(&most).is_gt();
    let mut pairs = own.samples().pairs(other.samples(), scale.event_window);
    pairs.find(|(_, a, b)| is_lost(a, b)).map(|(t, ..)| t)
}

/// One run of a part, and what a reference keeps of it.
#[derive(Clone, Debug)]
pub(crate) struct Path {
    /// The state that it starts from.
    pub(super) y_start: Vec<f64>,
    pub(super) run: PartRun,
    pub(super) trace: Trace,
    /// The events of each site that runs are compared by, at the roots of their guards.
    pub(super) events: Vec<Vec<ModeChange>>,
    pub(super) nodes: Vec<Node>,
    /// The contacts of each site, where they are known.
    pub(super) contacts: Option<Vec<Vec<Contact>>>,
    /// Where its energy went, where that is known.
    pub(super) balance: Option<Balance>,
    /// Its warnings of itself.
    pub(super) warnings: Vec<Warning>,
}

/// What the reference of a part is made of.
#[derive(Clone, Debug)]
pub(super) struct Solved {
    /// Method and setting of the reference.
    pub(super) method: String,
    /// Method and setting of the run that tells its error.
    pub(super) check_method: String,
    pub(super) path: Path,
    pub(super) check: Path,
    /// The samples of a run like `path` from a start changed in its last bit.
    pub(super) nudged: Trace,
}

impl Solved {
    /// The first sample time at which a last-bit change of the start exceeds [`HORIZON_ERROR`] [s]; infinite where none
    /// does.
    pub(super) fn lost_at(&self, scale: &ErrorScale) -> f64 {
        parted_at(&self.path.trace, &self.nudged, scale).unwrap_or(f64::INFINITY)
    }

    /// The first sample time at which its runs differ by more than [`AGREED`], or `lost_at` where that comes first [s].
    fn agrees_until(&self, scale: &ErrorScale, lost_at: f64) -> f64 {
        let differ = differ_at(&self.path.trace, &self.check.trace, scale, AGREED);
        differ.map_or(lost_at, |t| t.min(lost_at))
    }

    /// Largest `e` between both runs before `lost_at`, none where there is no sample before; and the largest
    /// difference of their event times [s], none where their events differ.
    pub(super) fn disagreement(
        &self,
        scale: &ErrorScale,
        lost_at: f64,
    ) -> (Option<f64>, Option<f64>) {
        let (own, check) = (&self.path.trace, &self.check.trace);
        let pairs = own.samples().pairs(check.samples(), scale.event_window);
        let errors = pairs.filter(|(t, ..)| *t < lost_at);
        let largest = errors.map(|(_, a, b)| scale.error(b, a)).reduce(worse);
        let mut latest = Some(0.0_f64);
        let end = own.t_end.max(check.t_end).min(lost_at);
        for (own, check) in self.path.events.iter().zip(&self.check.events) {
            let within = |events: &[ModeChange]| -> Vec<ModeChange> {
                events.iter().filter(|event| event.t < lost_at).copied().collect()
            };
            let times = match_to_end(&within(check), &within(own), (scale.event_window, end));
            let is_whole = times.missed == 0 && times.spurious == 0;
            latest = latest.filter(|_| is_whole).map(|most| most.max(times.time_error));
        }
        (largest, latest)
    }
}

/// The reference of `part` in f64: the first of [`PAIRS`] whose runs come to their end and agree, to the end or by series.
/// Else the one that agrees longest, or where none agrees the one that agrees best.
///
/// # Errors
/// That of the last pair, where none came to its end.
pub(super) fn solve(
    part: &Part,
    t_end: f64,
    times: &[f64],
    limits: Limits<'_>,
) -> Result<Solved, ReferenceError> {
    let mut best: Option<(Agreement, Solved)> = None;
    let mut failure = None;
    for pair in PAIRS {
        match solve_by(pair, part, t_end, times, limits) {
            Err(error @ (ReferenceError::Interrupted | ReferenceError::Problem(_))) => {
                return Err(error);
            }
            Err(error) => failure = Some(error),
            Ok(solved) => {
                let mut largest = Largest::default();
                part.measure(&solved.path.trace.states, &mut largest);
                let scale = part.error_scale(&largest);
                let lost_at = solved.lost_at(&scale);
                let (e, times) = solved.disagreement(&scale, lost_at);
                let may_agree = times.is_some() && solved.path.is_sound();
                let agrees = may_agree && e.is_none_or(|e| e <= AGREED);
                if agrees && (lost_at == f64::INFINITY || pair == PAIRS[0]) {
                    return Ok(solved);
                }
                let until = if may_agree { solved.agrees_until(&scale, lost_at) } else { 0.0 };
                let own = Agreement { until, e: e.unwrap_or(0.0) };
                if best.as_ref().is_none_or(|(best, _)| own.is_better_than(best)) {
                    best = Some((own, solved));
                }
            }
        }
    }
    match (best, failure) {
        (Some((_, solved)), _) => Ok(solved),
        (None, Some(error)) => Err(error),
        (None, None) => Err(ReferenceError::Interrupted),
    }
}

/// How well the runs of a pair agree.
struct Agreement {
    /// To this time they agree and do not part by a change of the start; zero where their events differ [s].
    until: f64,
    /// The largest difference between them before they part.
    e: f64,
}

impl Agreement {
    fn is_better_than(&self, other: &Self) -> bool {
        self.until > other.until || self.until == other.until && self.e < other.e
    }
}

fn solve_by(
    pair: Pair,
    part: &Part,
    t_end: f64,
    times: &[f64],
    limits: Limits<'_>,
) -> Result<Solved, ReferenceError> {
    let setting = |(name, rtol)| {
        let method = Method::named(name).ok_or(ReferenceError::NoMethod(name))?;
        let accuracy = Accuracy::Rtol(rtol, None);
        Ok::<_, ReferenceError>(Maker::Method(Setting {
            method,
            events: Events::Located,
            accuracy,
        }))
    };
    let [own, other] = pair.map(setting);
    solve_with(&[own?, other?], part, t_end, times, limits)
}

/// The reference of `part` in extended precision.
///
/// # Errors
/// [`ReferenceError`].
pub(super) fn solve_extended(
    part: &Part,
    t_end: f64,
    times: &[f64],
    limits: Limits<'_>,
) -> Result<Solved, ReferenceError> {
    solve_with(&EXTENDED_RTOL.map(Maker::Extended), part, t_end, times, limits)
}

fn solve_with(
    [own, other]: &[Maker; 2],
    part: &Part,
    t_end: f64,
    times: &[f64],
    limits: Limits<'_>,
) -> Result<Solved, ReferenceError> {
    let path = |maker, start| part.runs.path(maker, start, t_end, times, limits);
    // First the one that may cost more: too much of it, and the others are spared.
    let check = path(other, Start::Exact)?;
    let own_path = path(own, Start::Exact)?;
    let mut nudged = path(own, Start::Up)?;
    if nudged.run.ends_like(&own_path.run) {
        nudged = path(own, Start::Far)?;
    }
    let (method, check_method) = (own.described(), other.described());
    Ok(Solved { method, check_method, path: own_path, check, nudged: nudged.trace })
}

/// The method by which a run of a reference is made.
pub(crate) enum Maker {
    /// A method at a setting, in f64.
    Method(Setting),
    /// Taylor series in extended precision, at this relative tolerance.
    Extended(f64),
}

impl Maker {
    fn name(&self) -> &'static str {
        match self {
            Self::Method(setting) => setting.method.name,
            Self::Extended(_) => "extended taylor",
        }
    }

    /// Its relative tolerance; the members of a pair all have one.
    fn rtol(&self) -> f64 {
        match self {
            Self::Method(setting) => setting.rtol().unwrap_or(f64::INFINITY),
            Self::Extended(rtol) => *rtol,
        }
    }

    /// Order of its series, where it has one.
    fn series_order(&self) -> Option<usize> {
        match self {
            Self::Method(setting) => setting.method.series_order(setting.rtol()),
            Self::Extended(_) => Some(MAX_ORDER),
        }
    }

    fn order(&self) -> usize {
        match self {
            Self::Method(setting) => setting.method.order,
            Self::Extended(_) => MAX_ORDER,
        }
    }

    fn described(&self) -> String {
        let text = match self {
            Self::Method(setting) => setting.to_string(),
            Self::Extended(rtol) => format!("{} located, rtol {rtol:e}", self.name()),
        };
        self.series_order().map_or(text.clone(), |order| format!("{text} (order {order})"))
    }

    /// What its work is worth: a series of order N counts as N²/2 right-hand sides. That is several times its cost;
    /// where series are so many, an implicit method is faster.
    fn price(&self) -> Price {
        let of_series = |order: usize| Price::of_series((order * order / 2) as f64);
        self.series_order().map_or(Price::PLAIN, of_series)
    }

    fn run<P: Problem>(
        &self,
        problem: &P,
        y0: P::State<f64>,
        t_end: f64,
        record: &mut dyn Record<P>,
    ) -> OwnRun<P> {
        match self {
            Self::Method(setting) => integrate(problem, setting, y0, t_end, record),
            Self::Extended(rtol) => problem.integrate_extended(*rtol, y0, t_end, record),
        }
    }
}

/// One run of `problem` for a reference.
///
/// # Errors
/// [`ReferenceError`], where it does not come to its end.
pub(crate) fn path<P: Problem>(
    problem: &P,
    maker: &Maker,
    start: Start,
    t_end: f64,
    times: &[f64],
    limits: Limits<'_>,
) -> Result<Path, ReferenceError> {
    let y0 = start.of(problem);
    let trajectory = Trajectory::on(Grid::Times(times.to_vec()));
    let account = Account::new(problem, maker.order(), Events::Located, &y0);
    let y_start = y0.as_ref().to_vec();
    let mut watch = limits.watch(maker.price());
    let mut record = (
        ((trajectory, Braked(&mut watch)), Roots::new(problem, maker)),
        ((Nodes::new(problem.n_sites()), account), (Checked::new(problem), Entered::new(problem))),
    );
    let run = maker.run(problem, y0, t_end, &mut record);
    let (((trajectory, _), roots), ((nodes, Account { balance, contacts }), (checked, entered))) =
        record;
    entered.refused.map_or(Ok(()), Err)?;
    check_contracts(&checked)?;
    if let Some(contradiction) = contacts.contradiction() {
        return Err(contradiction.clone().into());
    }
    match &run.outcome {
        Err(error) => Err(ReferenceError::Failed {
            method: maker.name(),
            place: super::place(&problem.name()),
            t: run.t,
            mode: format!("{:?}", run.mode),
            error: Box::new(error.clone()),
        }),
        Ok(Outcome::Interrupted) if limits.is_stopped() => Err(ReferenceError::Interrupted),
        Ok(Outcome::Interrupted) => Err(match watch.cut {
            Some(Limit::Time) => ReferenceError::TooMuchTime { max_seconds: limits.max_seconds },
            _ => ReferenceError::TooMuchWork { max_rhs: limits.max_rhs },
        }),
        Ok(_) => Ok(Path {
            y_start,
            trace: Trace::of(problem, &trajectory, run.t),
            events: roots.changes,
            nodes: nodes.list,
            contacts: contacts.lists(),
            warnings: balance.check.warnings(Some(maker.rtol())),
            balance: balance.at(&run.mode, run.t, &run.y),
            run: run.plain(),
        }),
    }
}

impl Path {
    /// Whether nothing that it tells of itself makes it wrong.
    fn is_sound(&self) -> bool {
        !self.warnings.iter().any(|warning| warning.code.is_of_a_wrong_run())
    }
}

/// A recorder of the events that runs are compared by, at the roots of their guards.
///
/// A run lands past the surface, by half the guard's rounding bound: where a guard falls slowly, as that of
/// sticking does, that is late by picoseconds. One step of Newton's iteration goes back to the root.
struct Roots<'a, P> {
    problem: &'a P,
    of_start: StartEvents,
    /// These events of each site.
    changes: Vec<Vec<ModeChange>>,
    /// Whether runs land on the root itself.
    is_exact: bool,
    /// By how much the last step landed late [s].
    late: f64,
}

impl<'a, P: Problem> Roots<'a, P> {
    fn new(problem: &'a P, maker: &Maker) -> Self {
        let is_exact = matches!(maker, Maker::Extended(_));
        let (of_start, changes) = (StartEvents::of(problem), vec![Vec::new(); problem.n_sites()]);
        Self { problem, of_start, changes, is_exact, late: 0.0 }
    }
}

impl<P: Problem> Record<P> for Roots<'_, P> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        let guard = match accepted.landed_on {
            Some(guard) if !self.is_exact => guard,
            _ => return ControlFlow::Continue(()),
        };
        let step = accepted.step;
        let (y, slope) = (step.y1().as_ref(), step.slope1().as_ref());
        let along = P::State::from_fn(y.len(), |i| Dual64::new(y[i], slope[i]));
        let mut guards = P::Guards::from_fn(self.problem.n_guards(), |_| Dual64::new(0.0, 0.0));
        let t = Dual64::new(step.t1(), 1.0);
        self.problem.guards(accepted.mode.clone(), t, &along, &mut guards);
        let guard = guards.as_ref()[guard];
        let late = guard.re / guard.eps;
        self.late = if late.abs() <= step.t1() - step.t0() { late } else { 0.0 };
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        let t = event.t - self.late;
        let change = change(self.problem, t, event.guard, &event.before, &event.after);
        if let Some((site, change)) = change
            && !self.of_start.take(site)
        {
            self.changes[site].push(change);
        }
        ControlFlow::Continue(())
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Ends
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_that_agrees_longer_is_better_and_of_two_as_long_the_one_that_agrees_closer() {
        let pair = |until, e| Agreement { until, e };
        assert!(pair(2.0, 1e-3).is_better_than(&pair(1.0, 1e-9)));
        assert!(pair(2.0, 1e-10).is_better_than(&pair(2.0, 1e-9)));
        assert!(!pair(2.0, 1e-9).is_better_than(&pair(2.0, 1e-9)));
        assert!(!pair(1.0, 1e-10).is_better_than(&pair(2.0, 1e-9)));
    }
}

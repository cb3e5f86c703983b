//! One run with all that a user may ask of it: its motion site by site, contacts, energy, and what it tells of itself.

use deltazero_solvers::{Error, Grid, Next, Sample, Stats, Switch, Trajectory, WorkByKind};

use crate::account::Account;
use crate::balance::Balance;
use crate::digits::count_of;
use crate::errors::contact_summary::ContactSummary;
use crate::errors::contacts::Contact;
use crate::problem::{Problem, Quantity, StartEvents, Touch, change, leading_site};
use crate::run::{Brake, Braked, ModeChange, OwnRun, PartRun, Setting, integrate};
use crate::stiffness::Stiffness;
use crate::trace::OwnTrajectory;
use crate::warning::{Code, Warning};

/// Contacts have no depth that are less deep than this part of the rate at which they begin times their duration.
const UNSEEN_DEPTH: f64 = 1e-3;

/// What is asked of a run of one part.
pub struct Asked<'a> {
    /// Method and tolerance.
    pub setting: &'a Setting,
    /// End of the run [s].
    pub t_end: f64,
    /// Samples that are kept.
    pub grid: Grid,
    /// Told at once where stability bounds the steps of an explicit method.
    pub tell: &'a dyn Fn(&Warning),
}

/// A change of the mode of a site, by the names of the modes.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedChange {
    /// The change by the codes of the modes.
    pub by_code: ModeChange,
    /// Time [s].
    pub t: f64,
    /// The mode before.
    pub before: String,
    /// The mode after.
    pub after: String,
    /// Whether it is that of a [start on a surface](Problem::starts_on_surface), by which runs are not compared.
    pub is_of_start: bool,
}

/// The motion of one site.
#[derive(Clone, Debug, PartialEq)]
pub struct SiteMotion {
    /// Its name.
    pub name: String,
    /// What tells it apart from the others.
    pub labels: Vec<(&'static str, usize)>,
    /// Its columns.
    pub columns: Vec<Quantity>,
    /// Times of the samples [s].
    pub times: Vec<f64>,
    /// The mode at each sample: its place in [`modes`](Self::modes).
    pub mode_of: Vec<u32>,
    /// Names of the modes that it took at samples.
    pub modes: Vec<String>,
    /// Values, sample by sample, in the order of the columns.
    pub values: Vec<f64>,
    /// Whether it is in contact at each sample, how deep [m], and under which force [N]; empty where that is not told,
    /// or not asked for.
    pub touches: Vec<(bool, Touch<f64>)>,
    /// Its events that [count](Problem::is_counted), that of a start on a surface among them.
    pub changes: Vec<NamedChange>,
}

impl SiteMotion {
    /// The events that runs are compared by.
    pub fn compared(&self) -> impl Iterator<Item = &NamedChange> {
        self.changes.iter().filter(|change| !change.is_of_start)
    }

    /// Each sample: time, mode and values.
    pub fn samples(&self) -> impl Iterator<Item = (f64, &str, &[f64])> {
        let width = self.columns.len();
        self.times.iter().enumerate().map(move |(i, t)| {
            let mode = self.modes[self.mode_of[i] as usize].as_str();
            (*t, mode, &self.values[i * width..(i + 1) * width])
        })
    }

    /// The modes that it goes through, each from one time to another [s]. An event that leads from a mode to itself does
    /// not part it; a mode that takes no time is left out.
    pub fn stays(&self) -> Vec<(&str, (f64, f64))> {
        let (Some(first), Some(to)) = (self.samples().next(), self.times.last()) else {
            return Vec::new();
        };
        let start = self.changes.first().map_or(first.1, |change| &change.before);
        let mut stays = vec![(start, (first.0, *to))];
        for change in &self.changes {
            if let Some(last) = stays.last_mut().filter(|last| last.0 != change.after) {
                last.1.1 = change.t;
                stays.push((&change.after, (change.t, *to)));
            }
        }
        stays.retain(|(_, (from, to))| from < to);
        stays
    }

    /// Ends a sample whose values were added. Where there are more or fewer than columns, none of them is a number.
    fn end_sample(&mut self) {
        let (n, width) = (self.mode_of.len(), self.columns.len());
        if self.values.len() != n * width {
            self.values.truncate((n - 1) * width);
            self.values.resize(n * width, f64::NAN);
        }
    }

    /// The place of the name of a mode.
    fn place(&mut self, name: String) -> u32 {
        let place = self.modes.iter().rposition(|known| *known == name).unwrap_or_else(|| {
            self.modes.push(name);
            self.modes.len() - 1
        });
        place as u32
    }
}

/// A run of one part, with all that a user may ask of it.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// How it ended.
    pub run: PartRun,
    /// The motion of each site.
    pub sites: Vec<SiteMotion>,
    /// Events of all sites that runs are compared by.
    pub n_events: usize,
    /// The contacts of each site, where the problem tells of any.
    pub contacts: Option<Vec<Vec<Contact>>>,
    /// Contacts that are reckoned with the least speed of impact.
    pub n_at_speed_floor: usize,
    /// Where the energy went, where the problem tells of it.
    pub balance: Option<Balance>,
    /// Work by the phase that it was done in.
    pub work: Vec<(&'static str, Stats)>,
    /// The state at the end, as the problem says it in brief.
    pub end: String,
    /// The site whose terminal event ended it, where one did.
    pub stopped: Option<usize>,
    /// The site that the error is about, where it is about one.
    pub failed_site: Option<usize>,
    /// Where the model is written that the error of a failed run is about.
    pub failed_place: Option<String>,
    /// What to know before trusting it.
    pub warnings: Vec<Warning>,
}

/// Runs `problem` as `asked`, and tells all of the run.
pub(crate) fn simulate<P: Problem>(
    problem: &P,
    asked: &Asked<'_>,
    brake: &mut dyn Brake,
) -> Simulation {
    let Asked { setting, t_end, grid, tell } = asked;
    let y0 = problem.start();
    let is_explicit = !setting.method.is_implicit() && !setting.method.chooses();
    let told = |warning: &Warning| {
        if is_explicit {
            tell(warning);
        }
    };
    let phase = |mode: P::Mode| problem.role(&mode, leading_site(problem, &mode)).phase();
    let account = Account::new(problem, setting.method.order, setting.events, &y0);
    let audit = (account, Stiffness::new(problem, &told));
    let mut record =
        ((Trajectory::on(grid.clone()), audit), (Braked(brake), WorkByKind::new(phase)));
    let run = integrate(problem, setting, y0, *t_end, &mut record);
    let ((kept, (account, stiffness)), (_, work)) = record;
    let Account { balance, contacts } = account;
    let mut warnings = balance.check.warnings(setting.rtol());
    warnings.extend(stiffness.warning().filter(|_| is_explicit).map(|mut warning| {
        warning.message += problem.out_of_stiffness();
        warning
    }));
    let sites = motions(problem, &kept, problem.n_sites());
    warnings.extend(not_a_number(&sites));
    let contacts = contacts.lists();
    warnings.extend(contacts.iter().flat_map(|sites| wrong_signs(&sites.concat())));
    Simulation {
        n_events: sites.iter().map(|site| site.compared().count()).sum(),
        sites,
        contacts,
        n_at_speed_floor: kept.events.iter().filter(|event| at_floor(problem, event)).count(),
        balance: balance.at(&run.mode, run.t, &run.y),
        work: work.kinds,
        end: problem.in_brief(&run.y),
        stopped: run.stopped_at().map(|_| stopped_site(problem, &kept)),
        failed_site: failed_site(problem, &run),
        failed_place: run.outcome.as_ref().err().and_then(|error| problem.place_of(error)),
        warnings,
        run: run.plain(),
    }
}

/// The warnings of contacts whose depth falls as they begin and never comes above rounding, or which pull on the whole.
pub(crate) fn wrong_signs(contacts: &[Contact]) -> Vec<Warning> {
    let all = ContactSummary::of(contacts.iter());
    let mut messages = Vec::new();
    if let (Some(rate), Some(deepest), Some(longest)) =
        (all.largest_impact_speed_m_s, all.deepest_m, all.longest_s)
        && deepest < -UNSEEN_DEPTH * rate * longest
    {
        messages.push(format!(
            "contacts begin with a depth that falls, by {:.1e} m/s, and are {deepest:.1e} m deep at most: the depth is \
             above zero in contact; look at its sign",
            -rate
        ));
    }
    if all.impulse_n_s < 0.0 {
        messages.push(format!(
            "contacts pull on the whole, their impulse is {:.1e} N s: the force is above zero where it presses; look at \
             its sign",
            all.impulse_n_s
        ));
    }
    messages.into_iter().map(|message| Warning { code: Code::Contact, message }).collect()
}

/// The warnings of columns that are no number at a sample.
fn not_a_number(sites: &[SiteMotion]) -> Vec<Warning> {
    let mut warnings = Vec::new();
    for site in sites {
        for (i, column) in site.columns.iter().enumerate() {
            let mut bad = site.samples().filter(|(.., values)| !values[i].is_finite());
            let Some((t, ..)) = bad.next() else { continue };
            let (name, n) = (&column.name, bad.count());
            let more = match n {
                0 => String::new(),
                _ => format!(", nor at {}", count_of(n, "more sample")),
            };
            let message = format!("{name} is no number at {t} s{more}; its cells are empty");
            warnings.push(Warning { code: Code::NotANumber, message });
        }
    }
    warnings
}

fn at_floor<P: Problem>(problem: &P, event: &Switch<P::Mode>) -> bool {
    match &event.after {
        Next::Mode(after) => problem.begins_at_speed_floor(&event.before, after),
        Next::Stop => false,
    }
}

/// The site whose terminal event ended a run.
fn stopped_site<P: Problem>(problem: &P, run: &OwnTrajectory<P>) -> usize {
    let last = run.events.last().filter(|event| event.after == Next::Stop);
    last.map_or(0, |event| problem.site_of_guard(&event.before, event.guard))
}

/// The site that the error of a run is about, where it is about one.
fn failed_site<P: Problem>(problem: &P, run: &OwnRun<P>) -> Option<usize> {
    match run.outcome.as_ref().err()? {
        _ if problem.n_sites() == 1 => Some(0),
        // Sites of a chain have as many states each.
        Error::NonFinite { component, .. } if problem.dim().is_multiple_of(problem.n_sites()) => {
            Some(component * problem.n_sites() / problem.dim())
        }
        Error::NonFiniteGuard { guard, .. } | Error::Chatter { guard, .. } => {
            Some(problem.site_of_guard(&run.mode, *guard))
        }
        Error::OutsideModel { .. } | Error::Refused { .. } => {
            problem.nearest_end(&run.mode, &run.y)
        }
        _ => None,
    }
}

/// The motion of the first `most` sites of `problem` in a run.
fn motions<P: Problem>(problem: &P, run: &OwnTrajectory<P>, most: usize) -> Vec<SiteMotion> {
    let site = |k: usize| SiteMotion {
        name: problem.site_name(k),
        labels: problem.labels(k),
        columns: problem.columns(k),
        times: run.samples.iter().map(|sample| sample.t).collect(),
        mode_of: Vec::with_capacity(run.samples.len()),
        modes: Vec::new(),
        values: Vec::with_capacity(run.samples.len() * problem.columns(k).len()),
        touches: Vec::new(),
        changes: Vec::new(),
    };
    let mut sites: Vec<_> = (0..problem.n_sites().min(most)).map(site).collect();
    let mut last: Option<&P::Mode> = None;
    for sample in &run.samples {
        let is_same = last.replace(&sample.mode) == Some(&sample.mode);
        for (k, site) in sites.iter_mut().enumerate() {
            let place = match site.mode_of.last() {
                Some(place) if is_same => *place,
                _ => site.place(problem.mode_name(&sample.mode, k)),
            };
            site.mode_of.push(place);
        }
        problem.rows(&sample.mode, sample.t, &sample.y, &mut |k, values| {
            if let Some(site) = sites.get_mut(k) {
                site.values.extend_from_slice(values);
            }
        });
        sites.iter_mut().for_each(SiteMotion::end_sample);
    }
    let mut of_start = StartEvents::of(problem);
    for Switch { t, guard, before, after } in &run.events {
        if let (Some((k, by_code)), Next::Mode(after)) =
            (change(problem, *t, *guard, before, after), after)
        {
            let [before, after] = [before, after].map(|mode| problem.mode_name(mode, k));
            let is_of_start = of_start.take(k);
            if let Some(site) = sites.get_mut(k) {
                site.changes.push(NamedChange { by_code, t: *t, before, after, is_of_start });
            }
        }
    }
    sites
}

/// The motion of the first site of `problem` in a run, with the contact at each sample.
pub(crate) fn motion_with_touches<P: Problem>(
    problem: &P,
    run: &OwnTrajectory<P>,
) -> Option<SiteMotion> {
    let mut sites = motions(problem, run, 1);
    for (k, site) in sites.iter_mut().enumerate() {
        let touch = |sample: &Sample<P::State<f64>, P::Mode>| {
            let touch = problem.touch(&sample.mode, sample.t, &sample.y, k)?;
            Some((problem.role(&sample.mode, k).is_contact(), touch))
        };
        site.touches = run.samples.iter().map(touch).collect::<Option<_>>().unwrap_or_default();
    }
    sites.pop()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contacts_of_the_wrong_sign_are_told() {
        let contact = |depth, impact_speed, impulse| Contact {
            begin: 1.0,
            end: 1.1,
            impulse,
            peak: 1.0,
            peak_at: 1.0,
            depth,
            impact_speed: Some(impact_speed),
        };
        let told = |contact| wrong_signs(&[contact]).len();
        assert_eq!(told(contact(1e-3, 0.1, 2.0)), 0);
        // One that is laid down begins with a rate that is rounding.
        assert_eq!(told(contact(1e-3, -1e-17, 2.0)), 0);
        assert_eq!(told(contact(1e-16, -0.1, 2.0)), 1);
        assert_eq!(told(contact(1e-3, 0.1, -2.0)), 1);
        assert_eq!(wrong_signs(&[]), []);
    }

    /// Three samples of two columns, of which the second is `q`.
    fn site(q: [f64; 3]) -> SiteMotion {
        SiteMotion {
            name: String::new(),
            labels: Vec::new(),
            columns: ["x", "q"].map(|name| Quantity::new(name, "", 1.0)).to_vec(),
            times: vec![0.1, 0.2, 0.3],
            mode_of: vec![0; 3],
            modes: vec!["m".to_owned()],
            values: q.into_iter().flat_map(|q| [1.0, q]).collect(),
            touches: Vec::new(),
            changes: Vec::new(),
        }
    }

    #[test]
    fn a_sample_of_more_or_fewer_values_than_columns_shifts_no_other() {
        for n in [5, 7] {
            let mut site = site([4.0, 5.0, 6.0]);
            site.values.resize(n, 7.0);
            site.end_sample();
            let values: Vec<_> = site.samples().map(|(.., values)| values.to_vec()).collect();
            assert_eq!(values[..2], [[1.0, 4.0], [1.0, 5.0]]);
            assert!(values[2].iter().all(|value| value.is_nan()), "{values:?}");
        }
    }

    #[test]
    fn a_column_that_is_no_number_is_told_with_its_first_time() {
        assert_eq!(not_a_number(&[site([0.0, 1.0, 2.0])]), []);
        let told = |q| not_a_number(&[site(q)]).remove(0).message;
        let [once, twice, always] =
            [[0.0, f64::NAN, 2.0], [0.0, f64::INFINITY, f64::NAN], [f64::NAN; 3]].map(told);
        assert_eq!(once, "q is no number at 0.2 s; its cells are empty");
        assert_eq!(twice, "q is no number at 0.2 s, nor at 1 more sample; its cells are empty");
        assert_eq!(always, "q is no number at 0.1 s, nor at 2 more samples; its cells are empty");
    }
}

//! One run in brief: how it ended, with its events, contacts and energy in a few numbers.

use std::ops::ControlFlow;

use deltazero_solvers::{Event, Needs, Record};

use crate::account::Account;
use crate::balance::Balance;
use crate::errors::contact_summary::ContactSummary;
use crate::kinds::by_kind;
use crate::part::Part;
use crate::problem::{Problem, Quantity, StartEvents, change};
use crate::run::{Begun, Brake, Braked, OwnRun, PartRun, Setting, integrate_all};
use crate::simulation::wrong_signs;
use crate::stiffness::Stiffness;
use crate::warning::Code;

/// What a run in brief tells of, before it is made.
#[derive(Clone, Debug, PartialEq)]
pub struct BriefShape {
    /// The columns of each site at the end.
    pub columns: Vec<Vec<Quantity>>,
    /// Whether it tells of contacts.
    pub has_contacts: bool,
    /// Whether it tells of energies.
    pub has_energy: bool,
}

/// A run of one part in brief.
#[derive(Clone, Debug)]
pub struct Brief {
    /// How it ended.
    pub run: PartRun,
    /// Each site.
    pub sites: Vec<SiteBrief>,
    /// Where the energy went, where the problem tells of it.
    pub balance: Option<Balance>,
    /// What to know before trusting it.
    pub warnings: Vec<Code>,
}

/// A site in a run in brief.
#[derive(Clone, Debug, PartialEq)]
pub struct SiteBrief {
    /// The mode at the end.
    pub mode: String,
    /// What its columns have at the end.
    pub values: Vec<f64>,
    /// Its events that runs are compared by.
    pub n_events: usize,
    /// Its contacts, where the problem tells of any.
    pub contacts: Option<ContactSummary>,
}

/// What a run of `problem` in brief tells of, where contacts and energy are audited and where not.
pub(crate) fn shape<P: Problem>(problem: &P, audit: bool) -> BriefShape {
    let (sites, start) = (0..problem.n_sites(), problem.start());
    let mode = problem.initial_mode(0.0, &start);
    BriefShape {
        columns: sites.clone().map(|site| problem.columns(site)).collect(),
        has_contacts: audit
            && sites.clone().any(|k| problem.touch(&mode, 0.0, &start, k).is_some()),
        has_energy: audit && problem.energies(&mode, 0.0, &start).is_some(),
    }
}

/// Runs each part from its start to `t_end` under the brake of its place, those of a kind at once where that is faster,
/// and keeps nothing of the way but these numbers. Without an `audit` it tells of no contacts, energy and warnings, and
/// costs little more than its integration.
///
/// # Panics
/// Where there are fewer brakes than parts.
pub fn briefs<B: Brake>(
    parts: &[&Part],
    setting: &Setting,
    t_end: f64,
    audit: bool,
    brakes: &mut [B],
) -> Vec<Brief> {
    by_kind(parts, brakes, |first, all, brakes| first.briefs(all, setting, t_end, audit, brakes))
}

/// As [`briefs`], of problems of one type.
pub(crate) fn briefs_of<'a, P: Problem>(
    problems: &[&'a P],
    setting: &Setting,
    t_end: f64,
    audit: bool,
    brakes: &mut [&mut dyn Brake],
) -> Vec<Brief> {
    let begun: Vec<Begun<'a, P>> = problems.iter().map(|p| (*p, p.start())).collect();
    let audit = |(problem, y0): &Begun<'a, P>| {
        audit.then(|| {
            let account = Account::new(*problem, setting.method.order, setting.events, y0);
            (account, Stiffness::new(*problem, &|_| {}))
        })
    };
    let mut records = Vec::new();
    for (own, brake) in begun.iter().zip(brakes) {
        records.push((audit(own), (Braked(&mut **brake), Counts::new(own.0))));
    }
    let runs = integrate_all(&begun, setting, t_end, &mut records);
    let brief = |((problem, run), (audit, (_, counts))): ((&&P, _), (_, (_, Counts<'_, P>)))| {
        brief(*problem, setting, run, audit, &counts.of_site)
    };
    problems.iter().zip(runs).zip(records).map(brief).collect()
}

/// What a run tells, with its contacts and energy and looks at its steps if it was audited.
fn brief<P: Problem>(
    problem: &P,
    setting: &Setting,
    run: OwnRun<P>,
    audit: Option<(Account<'_, P>, Stiffness<'_, P>)>,
    counts: &[usize],
) -> Brief {
    let (mut balance, mut contacts, mut warnings) = (None, None, Vec::new());
    if let Some((account, stiffness)) = audit {
        let is_explicit = !setting.method.is_implicit() && !setting.method.chooses();
        let told = account.balance.check.warnings(setting.rtol()).into_iter();
        let told = told.chain(stiffness.warning().filter(|_| is_explicit));
        warnings = told.map(|warning| warning.code).collect();
        balance = account.balance.at(&run.mode, run.t, &run.y);
        contacts = account.contacts.lists();
        let signs = contacts.iter().flat_map(|sites| wrong_signs(&sites.concat()));
        warnings.extend(signs.map(|warning| warning.code));
    }
    let site = |(k, n_events): (usize, &usize)| SiteBrief {
        mode: problem.mode_name(&run.mode, k),
        values: Vec::new(),
        n_events: *n_events,
        contacts: contacts.as_ref().map(|lists| ContactSummary::of(lists[k].iter())),
    };
    let mut sites: Vec<_> = counts.iter().enumerate().map(site).collect();
    problem.rows(&run.mode, run.t, &run.y, &mut |k, values| {
        if let Some(site) = sites.get_mut(k) {
            site.values = values.to_vec();
        }
    });
    if sites.iter().flat_map(|site| &site.values).any(|value| !value.is_finite()) {
        warnings.push(Code::NotANumber);
    }
    Brief { sites, balance, warnings, run: run.plain() }
}

/// A recorder of how many events that runs are compared by each site has.
struct Counts<'a, P> {
    problem: &'a P,
    of_start: StartEvents,
    of_site: Vec<usize>,
}

impl<'a, P: Problem> Counts<'a, P> {
    fn new(problem: &'a P) -> Self {
        let of_start = StartEvents::of(problem);
        Self { problem, of_start, of_site: vec![0; problem.n_sites()] }
    }
}

impl<P: Problem> Record<P> for Counts<'_, P> {
    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        let change = change(self.problem, event.t, event.guard, &event.before, &event.after);
        if let Some((site, _)) = change
            && !self.of_start.take(site)
        {
            self.of_site[site] += 1;
        }
        ControlFlow::Continue(())
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Nothing
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use deltazero_solvers::problems::CompliantBall;
    use deltazero_solvers::{Grid, Method};

    use super::*;
    use crate::problems::balls::HEAVY_BALL;
    use crate::run::{Accuracy, Events, Limits, Price};
    use crate::simulation::{Asked, simulate};

    #[test]
    fn a_run_in_brief_is_the_end_of_the_run_that_tells_all() {
        let ball = CompliantBall { start: [1e-4, -1e-3], ..HEAVY_BALL };
        let method = Method::named("rk45").unwrap();
        let accuracy = Accuracy::Rtol(1e-8, None);
        let setting = Setting { method, events: Events::Located, accuracy };
        let stop = AtomicBool::new(false);
        let mut watch = Limits::none(&stop).watch(Price::PLAIN);
        let mut run = |audit: bool| {
            briefs_of(&[&ball], &setting, 0.6, audit, &mut [&mut watch]).pop().unwrap()
        };
        let (brief, alone) = (run(true), run(false));
        let grid = Grid::Times(vec![0.6]);
        let asked = Asked { setting: &setting, t_end: 0.6, grid, tell: &|_| {} };
        let whole = simulate(&ball, &asked, &mut watch);
        assert_eq!(brief.run.stats, whole.run.stats);
        assert_eq!(brief.run.y, whole.run.y);
        assert_eq!(brief.sites.iter().map(|site| site.n_events).sum::<usize>(), whole.n_events);
        assert_eq!(brief.balance, whole.balance);
        for ((own, site), list) in brief.sites.iter().zip(&whole.sites).zip(whole.contacts.unwrap())
        {
            assert_eq!(own.values, site.values);
            assert_eq!(own.contacts, Some(ContactSummary::of(list.iter())));
        }
        let plain = shape(&ball, false);
        assert_eq!((plain.has_contacts, plain.has_energy), (false, false));
        let shape = shape(&ball, true);
        let columns: Vec<_> = whole.sites.iter().map(|site| site.columns.clone()).collect();
        assert_eq!(shape.columns, columns);
        assert_eq!((shape.has_contacts, shape.has_energy), (true, brief.balance.is_some()));
        assert_eq!((&alone.run.y, &alone.run.stats), (&brief.run.y, &brief.run.stats));
        assert_eq!(alone.sites[0].values, brief.sites[0].values);
        assert_eq!((alone.balance, alone.sites[0].contacts), (None, None));
    }
}

//! Whether runs of a part agree, whatever it is: what joints alone can be asked is in `ran.rs` and `audit.rs`.

use std::sync::atomic::AtomicBool;

use deltazero_solvers::{Error, Grid, Method, Outcome};
use deltazero_study::errors::{ErrorScale, Largest, worse};
use deltazero_study::horizon::parting;
use deltazero_study::part::{Part, Start};
use deltazero_study::reference::HORIZON_ERROR;
use deltazero_study::run::{Accuracy, PartRun, Price, Setting};
use deltazero_study::setting::Events;
use deltazero_study::simulation::Asked;
use deltazero_study::trace::Trace;

use super::audit::Budget;
use super::ran::Growth;
use super::verdict::{
    Class, FARTHER, LEAST_SHARE, METHODS, MOST_E, MOST_OF_GROWTH, RTOL, STEADY, Verdict,
};

/// States of a part whose right-hand sides count as they are.
const FEW: f64 = 20.0;

/// A run of a part.
struct Ran {
    setting: Setting,
    run: PartRun,
    trace: Trace,
    /// What it tells against itself.
    told: Vec<String>,
    /// Whether it has the same bits where all of it is asked for.
    repeats: bool,
}

impl Verdict {
    /// Judges `part`, run to `t_end` with samples `sample` apart [s].
    pub(super) fn judge_whatever(&mut self, part: &Part, span: (f64, f64), budget: Budget) {
        // A right-hand side costs by its states.
        let share = (FEW / part.states.len() as f64).min(1.0);
        let budget = Budget { work: share * budget.work, ..budget };
        let all: Vec<Ran> = METHODS
            .iter()
            .filter_map(|name| Method::named(name))
            .map(|method| Ran::new(part, method, Start::Exact, span, budget))
            .collect();
        let is_complete =
            |ran: &&Ran| matches!(ran.run.outcome, Ok(Outcome::Finished | Outcome::Stopped));
        let Some(base) = all.iter().find(is_complete).or(all.first()) else { return };
        let nudged = Ran::new(part, base.setting.method, Start::Up, span, budget);
        let mut largest = Largest::default();
        part.measure(&base.trace.states, &mut largest);
        let scale = part.error_scale(&largest);
        let pairs = base.trace.samples().pairs(nudged.trace.samples(), scale.event_window);
        let (times, errors) = pairs.map(|(t, y, z)| (t, scale.error(z, y))).unzip();
        let growth = Growth::of(times, errors, [base.run.t, nudged.run.t], false);
        let implicit = all.iter().filter(|ran| ran.setting.method.name == METHODS[1]);
        let implicit = implicit.map(|ran| ran.run.t).fold(0.0, f64::max);
        let variant = |ran: &Ran| ran.run.outcome.as_ref().err().map(std::mem::discriminant);
        let variants: Vec<_> = all.iter().filter_map(variant).collect();
        if variants.len() == all.len() && variants.iter().all(|own| *own == variants[0]) {
            let why = format!("{}: refused by all methods: {:?}", part.name, base.run.outcome);
            return self.add(Class::Refused, why);
        }
        for ran in &all {
            self.whatever_alone(part, ran, implicit, span.0);
        }
        for ran in all.iter().filter(|ran| ran.setting.method.name != base.setting.method.name) {
            self.whatever_together(part, [base, ran], &scale, &growth);
        }
    }

    /// What a run shows by itself; `implicit` is how far the implicit run came [s].
    fn whatever_alone(&mut self, part: &Part, ran: &Ran, implicit: f64, t_end: f64) {
        let who = format!("{}, {} at {:.6e} s", part.name, ran.setting.method.name, ran.run.t);
        match &ran.run.outcome {
            Ok(Outcome::Finished | Outcome::Stopped) => {}
            // It comes on: what it did until then is judged.
            Ok(Outcome::Interrupted) if ran.run.t > LEAST_SHARE * t_end => {}
            Ok(Outcome::Interrupted) if implicit > FARTHER * ran.run.t => {
                let why = "its steps are bound by stability, radau5 came to";
                self.add(Class::Stiff, format!("{who}: {why} {implicit:.6e} s"));
            }
            Ok(Outcome::Interrupted) => {
                self.add(Class::Timeout, format!("{who}: more than its budget"))
            }
            Err(error @ (Error::OutsideModel { .. } | Error::Refused { .. })) => {
                self.add(Class::Refused, format!("{who}: {error}"))
            }
            Err(error) => self.add(Class::Failed, format!("{who}: {error}")),
        }
        if ran.trace.states.iter().flatten().any(|y| !y.is_finite()) {
            self.add(Class::Disagree, format!("{who}: states that are not finite"));
        }
        self.work += Price::of_setting(&ran.setting).of(&ran.run.stats);
        for told in &ran.told {
            self.add(Class::Warned, format!("{who}: {told}"));
        }
        if !ran.repeats {
            self.add(Class::Disagree, format!("{who}: other bits where all of it is asked for"));
        }
    }

    /// What two runs show beside each other, up to their horizon.
    fn whatever_together(
        &mut self,
        part: &Part,
        [a, b]: [&Ran; 2],
        scale: &ErrorScale,
        growth: &Growth,
    ) {
        let short = growth.until(HORIZON_ERROR).min(a.run.t).min(b.run.t);
        if short < a.run.t.max(b.run.t) {
            self.class = self.class.max(Class::Past);
        }
        let (mut e, mut of_allowed) = (0.0, 0.0);
        let pairs = a.trace.samples().pairs(b.trace.samples(), scale.event_window);
        for (t, y, z) in pairs.take_while(|(t, ..)| *t <= short) {
            let own = scale.error(z, y);
            e = worse(e, own);
            of_allowed = worse(of_allowed, own / (MOST_E + MOST_OF_GROWTH * growth.at(t)));
        }
        self.e = worse(self.e, e);
        self.of_allowed = worse(self.of_allowed, of_allowed);
        let sites = a.trace.changes.iter().zip(&b.trace.changes);
        let parted = sites.filter_map(|(a, b)| parting(a, b)).reduce(f64::min);
        let parted = parted.filter(|t| *t < growth.until(STEADY).min(short));
        let (class, why) = match parted {
            Some(t) => (Class::Warned, format!("; other events from {t:.6e} s on, which is told")),
            None if !(a.told.is_empty() && b.told.is_empty()) => {
                (Class::Warned, ", of which one warns".to_owned())
            }
            None => (Class::Disagree, String::new()),
        };
        let methods = [a, b].map(|ran| ran.setting.method.name);
        let who = format!("{}, {} and {} up to {short:.6e} s", part.name, methods[0], methods[1]);
        if of_allowed.total_cmp(&1.0).is_gt() {
            self.add(class, format!("{who}: e {e:.1e}, {of_allowed:.1e} of what is allowed{why}"));
        }
        let is_refused = |ran: &Ran| {
            matches!(ran.run.outcome, Err(Error::OutsideModel { .. } | Error::Refused { .. }))
        };
        if is_refused(a) != is_refused(b) && a.run.t.min(b.run.t) < growth.until(STEADY) {
            self.add(Class::Disagree, format!("{who}: one alone is refused"));
        }
    }
}

impl Ran {
    fn new(
        part: &Part,
        method: &'static Method,
        start: Start,
        (t_end, sample): (f64, f64),
        budget: Budget,
    ) -> Self {
        let accuracy = Accuracy::Rtol(RTOL, None);
        let setting = Setting { method, events: Events::Located, accuracy };
        let stop = AtomicBool::new(false);
        let watch = || budget.limits(&stop).watch(Price::of_setting(&setting));
        let grid = Grid::uniform(sample, t_end);
        let (run, trace) = part.run(&setting, start, t_end, &grid, &mut watch());
        let asked = Asked { setting: &setting, t_end, grid, tell: &|_| {} };
        let (mut told, mut repeats) = (Vec::new(), true);
        if start == Start::Exact {
            let all = part.simulate(&asked, &mut watch());
            // Where time cut one of them, they end where it did.
            let is_cut = [&run, &all.run].map(|run| run.outcome == Ok(Outcome::Interrupted));
            repeats = is_cut.contains(&true) || (all.run.t, &all.run.y) == (run.t, &run.y);
            let wrong = all.warnings.into_iter().filter(|warning| warning.code.is_of_a_wrong_run());
            told = wrong.map(|warning| warning.message).collect();
        }
        Self { setting, run, trace, told, repeats }
    }
}

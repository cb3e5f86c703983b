//! Contacts, from the event that begins one to the event that ends it: impulse, peak force, depth, impact speed.

use std::ops::ControlFlow;

use deltazero_solvers::root::{Bracket, find_root};
use deltazero_solvers::{Accepted, Event, Needs, Next, Record, Step, Vector};
use num_dual::Dual64;
use serde::{Deserialize, Serialize};

use super::worse;
use crate::check::{ProblemError, check_untold, force_in_part, no_force};
use crate::points::{Point, Points, mode_inside};
use crate::problem::{Problem, Touch};
use crate::quadrature::{GAUSS, Nodes};
use crate::setting::Events;

/// How exactly the time of a peak is found, as a fraction of its step: the force is flat there.
const PRECISION: f64 = 1e-9;
/// The most points of a step at which the force is looked at: both ends and the nodes.
const MOST_POINTS: usize = GAUSS.len() + 2;

/// The contact in a mode without contact, where the problem tells none: no depth, no force.
const NO_FORCE: Touch<f64> = Touch { depth: 0.0, rate: 0.0, force: 0.0 };

/// One contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// When it began [s].
    pub begin: f64,
    /// When it ended, or the run did [s].
    pub end: f64,
    /// `∫ F_N dt` [N s].
    pub impulse: f64,
    /// Largest F_N [N].
    pub peak: f64,
    /// Time of the largest F_N [s].
    #[serde(default)]
    pub peak_at: f64,
    /// Largest penetration δ [m].
    #[serde(default)]
    pub depth: f64,
    /// δ̇ where it began [m/s]; none where the run starts in it, or on the surface that it leaves.
    #[serde(default)]
    pub impact_speed: Option<f64>,
}

impl Contact {
    /// One that begins at `t`, and what was felt before that belongs to it.
    fn begun(t: f64, impact_speed: Option<f64>, before: Felt) -> Self {
        let Felt { impulse, peak: (peak_at, peak), depth } = before;
        let peak_at = if peak > 0.0 { peak_at } else { t };
        Self { begin: t, end: t, impulse, peak, peak_at, depth, impact_speed }
    }

    /// What was felt in it so far.
    fn felt(&self) -> Felt {
        Felt { impulse: self.impulse, peak: (self.peak_at, self.peak), depth: self.depth }
    }
}

/// What a site feels in a step, or in a contact.
#[derive(Clone, Copy, Debug, Default)]
struct Felt {
    /// `∫ F_N dt` [N s].
    impulse: f64,
    /// When F_N is largest [s], and how large [N].
    peak: (f64, f64),
    /// Largest δ, or zero [m].
    depth: f64,
}

/// A recorder of the contacts of each site of a problem: quadrature and peaks of F_N on the dense output of its
/// steps.
///
/// They are as good as that dense output: rk4's cubic is off by `(ωh)⁴/384` of an oscillating force, 1e-3 at
/// ωh = 0.8, where the states at the ends of its steps are better.
///
/// What a blind run feels in a step that it begins outside belongs to the contact that it is in after it.
pub struct Contacts<'a, P: Problem> {
    problem: &'a P,
    events: Events,
    /// Whether it gives forces at the start.
    gives_forces: bool,
    /// The first contradiction in what it said of forces.
    contradiction: Option<ProblemError>,
    sites: Vec<SiteContacts>,
    points: Points<P>,
}

/// The contacts of one site so far.
#[derive(Clone, Debug, Default)]
struct SiteContacts {
    /// The last one may not have ended.
    list: Vec<Contact>,
    is_in_contact: bool,
    /// What was felt in the last step outside.
    outside: Felt,
}

impl<'a, P: Problem> Contacts<'a, P> {
    /// No contact yet in a run of `problem` that treats events in this way.
    pub fn new(problem: &'a P, events: Events) -> Self {
        Self::with(&GAUSS, problem, events)
    }

    /// As [`new`](Self::new), the force integrated by the quadrature of `nodes`.
    pub(crate) fn with(nodes: Nodes, problem: &'a P, events: Events) -> Self {
        let y0 = problem.start();
        let mode = problem.initial_mode(0.0, &y0);
        let n_sites = problem.n_sites();
        Self {
            problem,
            events,
            gives_forces: (0..n_sites).any(|k| problem.touch(&mode, 0.0, &y0, k).is_some()),
            contradiction: None,
            sites: vec![SiteContacts::default(); n_sites],
            points: Points::of(nodes),
        }
    }

    /// The contacts of each site; its last one may not have ended. None where forces are not given, or not in every contact.
    pub fn lists(self) -> Option<Vec<Vec<Contact>>> {
        let are_known = self.gives_forces && self.contradiction.is_none();
        are_known.then(|| self.sites.into_iter().map(|site| site.list).collect())
    }

    /// The first contradiction in what the problem said of forces in the run.
    pub(crate) fn contradiction(&self) -> Option<&ProblemError> {
        self.contradiction.as_ref()
    }

    /// Looks for what a mode that an event led to says of forces against the start, where there are none.
    fn look_for_forces(&mut self, mode: &P::Mode, t: f64, y: &P::State<f64>) {
        for k in 0..self.sites.len() {
            let told = match self.problem.touch(mode, t, y, k) {
                Some(_) => Err(force_in_part((t, mode), k, k)),
                None => check_untold(self.problem, (t, mode), k, None),
            };
            self.contradiction = self.contradiction.take().or(told.err());
        }
    }

    /// The contact of site `k` at `(t, y)` in `mode`; that of a mode without one has no force.
    fn touch(&self, mode: &P::Mode, t: f64, y: &P::State<f64>, k: usize) -> Touch<f64> {
        self.problem.touch(mode, t, y, k).unwrap_or(NO_FORCE)
    }

    fn is_contact(&self, mode: &P::Mode, k: usize) -> bool {
        self.problem.role(mode, k).is_contact()
    }

    /// The problem inside a step begun in `mode`.
    fn inside(
        &self,
        mode: &P::Mode,
        step: &dyn Step<P::State<f64>>,
        t: f64,
    ) -> (P::Mode, P::State<f64>) {
        let mut y = step.y0().clone();
        step.interpolate(t, &mut y);
        (mode_inside(self.problem, self.events, mode, t, &y), y)
    }

    /// The slope of the state.
    fn slope(&self, mode: &P::Mode, t: f64, y: &P::State<f64>) -> P::State<f64> {
        let mut slope = y.clone();
        self.problem.rhs(mode.clone(), t, y, &mut slope);
        slope
    }

    /// `dF_N/dt` of site `k` [N/s].
    fn rate(
        &self,
        mode: &P::Mode,
        t: f64,
        y: &P::State<f64>,
        slope: &P::State<f64>,
        k: usize,
    ) -> f64 {
        let (y, slope) = (y.as_ref(), slope.as_ref());
        let along = P::State::from_fn(y.len(), |i| Dual64::new(y[i], slope[i]));
        self.problem
            .touch(mode, Dual64::new(t, 1.0), &along, k)
            .map_or(0.0, |touch| touch.force.eps)
    }

    /// What site `k` feels over a step begun in `mode`; its extremes are looked for between the points where they
    /// may be above those of `before`.
    fn of_step(
        &mut self,
        mode: &P::Mode,
        step: &dyn Step<P::State<f64>>,
        points: &mut [Point<P>],
        (k, before): (usize, Felt),
    ) -> Felt {
        let h = step.t1() - step.t0();
        let (mut impulse, mut rates) = (0.0, [0.0; MOST_POINTS]);
        let mut forces = [(0.0, 0.0); MOST_POINTS];
        let mut depths = forces;
        for (i, Point { t, weight, mode, y, .. }) in points.iter().enumerate() {
            let touch = self.problem.touch(mode, *t, y, k);
            if touch.is_none() && self.contradiction.is_none() && self.is_contact(mode, k) {
                self.contradiction = Some(no_force((*t, mode), k));
            }
            let touch = touch.unwrap_or(NO_FORCE);
            impulse += weight * touch.force;
            (forces[i], depths[i], rates[i]) = ((*t, touch.force), (*t, touch.depth), touch.rate);
        }
        let n = points.len();
        let depth_at = |t: f64| {
            let (mode, y) = self.inside(mode, step, t);
            let touch = self.touch(&mode, t, &y, k);
            (touch.depth, touch.rate)
        };
        let (_, depth) = largest(&depths[..n], before.depth, PRECISION * h, |i| rates[i], depth_at);
        // One slope for all sites.
        let rate = |i: usize| {
            let Point { t, mode, y, slope, .. } = &mut points[i];
            let slope = slope.get_or_insert_with(|| self.slope(mode, *t, y));
            self.rate(mode, *t, y, slope, k)
        };
        let force_at = |t: f64| {
            let (mode, y) = self.inside(mode, step, t);
            let slope = self.slope(&mode, t, &y);
            (self.touch(&mode, t, &y, k).force, self.rate(&mode, t, &y, &slope, k))
        };
        let peak = largest(&forces[..n], before.peak.1, PRECISION * h, rate, force_at);
        Felt { impulse, peak, depth: depth.max(0.0) }
    }
}

impl<P: Problem> Contacts<'_, P> {
    /// Whether a step begun in `mode` is one to look at.
    pub(crate) fn feels(&self, mode: &P::Mode) -> bool {
        let is_contact = |k| self.is_contact(mode, k);
        self.gives_forces && (self.events == Events::Blind || (0..self.sites.len()).any(is_contact))
    }

    /// Adds a step with these points.
    pub(crate) fn add(&mut self, accepted: &Accepted<'_, P>, points: &mut [Point<P>]) {
        let (mode, step) = (&accepted.mode, accepted.step);
        for k in 0..self.sites.len() {
            if !self.is_contact(mode, k) {
                if self.events == Events::Blind {
                    let before = Felt::default();
                    self.sites[k].outside = self.of_step(mode, step, points, (k, before));
                }
                continue;
            }
            let site = &mut self.sites[k];
            if !std::mem::replace(&mut site.is_in_contact, true) {
                // A run that starts in contact.
                site.list.push(Contact::begun(step.t0(), None, Felt::default()));
            }
            let before = site.list.last().map_or(Felt::default(), Contact::felt);
            let felt = self.of_step(mode, step, points, (k, before));
            if let Some(contact) = self.sites[k].list.last_mut() {
                contact.end = step.t1();
                contact.impulse += felt.impulse;
                contact.depth = contact.depth.max(felt.depth);
                if felt.peak.1 > contact.peak {
                    (contact.peak_at, contact.peak) = felt.peak;
                }
            }
        }
    }
}

/// When a smooth quantity is largest in a step, to `precision` [s], and how large: at one of the times that it
/// has these `values` at, or, where it may be above `highest`, beside it, where its rate is zero. `rate` is that
/// rate at a point, `inside` quantity and rate at a time.
fn largest(
    values: &[(f64, f64)],
    highest: f64,
    precision: f64,
    mut rate: impl FnMut(usize) -> f64,
    inside: impl Fn(f64) -> (f64, f64),
) -> (f64, f64) {
    let n = values.len();
    let top = (1..n).fold(0, |top, i| if values[i].1 > values[top].1 { i } else { top });
    let [a, b] = [top.saturating_sub(1), (top + 1).min(n - 1)];
    let found = values[top];
    // No smooth quantity rises above three points by more than they differ.
    if 2.0 * found.1 - values[a].1.min(values[b].1) > highest && rate(a) > 0.0 && rate(b) < 0.0 {
        let bracket = Bracket { above: values[a].0, below: values[b].0 };
        let t = find_root(|t| inside(t).1, bracket, precision);
        let between = inside(t).0;
        return if between > found.1 { (t, between) } else { found };
    }
    found
}

impl<P: Problem> Record<P> for Contacts<'_, P> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        if self.feels(&accepted.mode) {
            let mut points = std::mem::replace(&mut self.points, Points::of(&[]));
            points.look(self.problem, self.events, accepted);
            self.add(accepted, points.all());
            self.points = points;
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        let Next::Mode(after) = &event.after else { return ControlFlow::Continue(()) };
        if !self.gives_forces {
            self.look_for_forces(after, event.t, event.y);
            return ControlFlow::Continue(());
        }
        for k in 0..self.sites.len() {
            let is_in_contact = self.is_contact(after, k);
            let was_in_contact = std::mem::replace(&mut self.sites[k].is_in_contact, is_in_contact);
            if is_in_contact && !was_in_contact {
                let rate = self.touch(after, event.t, event.y, k).rate;
                let is_start = self.sites[k].list.is_empty() && self.problem.starts_on_surface();
                let before = std::mem::take(&mut self.sites[k].outside);
                let contact = Contact::begun(event.t, (!is_start).then_some(rate), before);
                self.sites[k].list.push(contact);
            }
        }
        ControlFlow::Continue(())
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        if self.gives_forces { Needs::DenseOutput } else { Needs::Nothing }
    }
}

/// Impulse of these contacts together [N s].
pub fn total_impulse(contacts: &[Contact]) -> f64 {
    contacts.iter().map(|contact| contact.impulse).sum()
}

/// The contacts of a run against those of its reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactErrors {
    /// Worst error of a peak force, relative to the largest of the reference.
    pub peak: f64,
    /// Worst error of the impulse of a contact, relative to the largest of the reference.
    pub impulse: f64,
    /// Worst error of the speed at which a contact begins, relative to the largest of the reference; none where no
    /// pair has both speeds.
    pub impact_speed: Option<f64>,
}

/// Compares contacts whose ends are the same events, in order, both within `window` [s]; none
/// where there are no such pairs.
pub fn contact_errors(
    run: &[Contact],
    reference: &[Contact],
    window: f64,
) -> Option<ContactErrors> {
    let largest = |of: fn(&Contact) -> f64| {
        reference.iter().map(of).fold(f64::MIN_POSITIVE, |largest, x| largest.max(x.abs()))
    };
    let (largest_peak, largest_impulse) = (largest(|c| c.peak), largest(|c| c.impulse));
    let largest_speed = largest(|c| c.impact_speed.unwrap_or(0.0));
    let near = |a: f64, b: f64| (a - b).abs() <= window;
    let mut ahead = run.iter();
    let mut errors: Option<ContactErrors> = None;
    for contact in reference {
        let rest = ahead.clone();
        let Some(own) =
            ahead.find(|own| near(own.begin, contact.begin) && near(own.end, contact.end))
        else {
            ahead = rest;
            continue;
        };
        let worst = errors.get_or_insert_default();
        worst.peak = worse(worst.peak, (own.peak - contact.peak).abs() / largest_peak);
        worst.impulse =
            worse(worst.impulse, (own.impulse - contact.impulse).abs() / largest_impulse);
        if let Some((own, exact)) = own.impact_speed.zip(contact.impact_speed) {
            let error = (own - exact).abs() / largest_speed;
            worst.impact_speed = Some(worse(worst.impact_speed.unwrap_or(0.0), error));
        }
    }
    errors
}

#[cfg(test)]
mod tests {
    use deltazero_solvers::Method;
    use deltazero_solvers::problems::CompliantBall;

    use super::*;
    use crate::problems::balls::HEAVY_BALL;
    use crate::run::{Accuracy, Setting, integrate};

    /// Impact speed [m/s].
    const V: f64 = 1e-3;
    /// An undamped mass between two walls: half a sine at each.
    const BALL: CompliantBall = CompliantBall { damping: 0.0, start: [1e-4, -V], ..HEAVY_BALL };

    /// The contacts of the mass with both walls.
    fn half_sines(method: &str, events: Events, accuracy: Accuracy) -> Vec<Contact> {
        let setting = Setting { method: Method::named(method).unwrap(), events, accuracy };
        let mut contacts = Contacts::new(&BALL, events);
        let run = integrate(&BALL, &setting, BALL.start, 0.6, &mut contacts);
        assert!(run.outcome.is_ok(), "{:?}", run.outcome);
        contacts.lists().unwrap().concat()
    }

    /// Worst relative errors of impulse, `2 m v`, peak force, `v √(K m)`, and duration, `π √(m/K)`.
    fn errors(contacts: &[Contact]) -> [f64; 3] {
        let (m, k) = (BALL.mass, BALL.stiffness);
        let exact = [2.0 * m * V, V * (k * m).sqrt(), std::f64::consts::PI * (m / k).sqrt()];
        let mut worst = [0.0_f64; 3];
        for contact in contacts {
            let own = [contact.impulse, contact.peak, contact.end - contact.begin];
            for (worst, (own, exact)) in worst.iter_mut().zip(own.iter().zip(exact)) {
                *worst = worst.max((own / exact - 1.0).abs());
            }
        }
        worst
    }

    #[test]
    fn impulse_and_peak_of_half_a_sine_are_those_of_its_closed_form() {
        // A step of taylor spans a good part of the contact, and its peak lies between the nodes. Measured:
        // 9.0e-12, 9.4e-12, 7.4e-14, and 8.1e-14, 7.6e-14, 6.2e-14.
        let cases = [("rk45", [9e-11, 9e-11, 7e-13]), ("taylor", [8e-13, 7e-13, 6e-13])];
        for (method, bounds) in cases {
            let half_sines = half_sines(method, Events::Located, Accuracy::Rtol(1e-12, None));
            assert_eq!(half_sines.len(), 3);
            let errors = errors(&half_sines);
            let holds = errors.iter().zip(bounds).all(|(e, bound)| *e < bound);
            assert!(holds, "{method}: {errors:?}");
        }
    }

    #[test]
    fn depth_impact_speed_and_time_of_the_peak_are_those_of_half_a_sine() {
        for method in ["rk45", "taylor"] {
            let contacts = half_sines(method, Events::Located, Accuracy::Rtol(1e-12, None));
            let depth = V * (BALL.mass / BALL.stiffness).sqrt();
            let speeds: Vec<_> =
                contacts.iter().filter_map(|contact| contact.impact_speed).collect();
            assert_eq!(speeds.len(), contacts.len());
            // Measured: 9.4e-12 at most, and the time of a flat top to 3.0e-10 of its contact.
            assert!(speeds.iter().all(|speed| (speed / V - 1.0).abs() < 9e-11), "{speeds:?}");
            for Contact { begin, end, peak_at, depth: own, .. } in contacts {
                assert!((own / depth - 1.0).abs() < 9e-11, "{method}: {own:e} for {depth:e}");
                let off = (peak_at - begin) / (end - begin) - 0.5;
                assert!(off.abs() < 3e-9, "{method}: {off:e}");
            }
        }
    }

    #[test]
    fn a_blind_run_has_its_contacts_from_the_state() {
        let half_sines = half_sines("rk4", Events::Blind, Accuracy::Step(1e-6));
        assert_eq!(half_sines.len(), 3);
        let errors = errors(&half_sines);
        // Measured: 6.4e-9, 5.3e-9, 2.2e-4; its events are up to a step late.
        let holds = errors.iter().zip([6e-8, 5e-8, 2e-3]).all(|(e, bound)| *e < bound);
        assert!(holds, "{errors:?}");
    }

    #[test]
    fn contacts_pair_where_both_ends_do() {
        let contact = |begin: f64, impulse| {
            let felt = Felt { impulse, peak: (begin, 2.0), depth: 0.0 };
            Contact { end: begin + 0.01, ..Contact::begun(begin, None, felt) }
        };
        let reference = [contact(0.0, 1.0), contact(0.1, 4.0), contact(0.2, 1.0)];
        let run = [contact(0.0, 1.1), contact(0.15, 9.0), contact(0.2, 1.2)];
        let errors = contact_errors(&run, &reference, 1e-3).unwrap();
        assert!((errors.impulse - 0.05).abs() < 1e-15 && errors.peak == 0.0, "{errors:?}");
        assert_eq!(contact_errors(&run[1..2], &reference, 1e-3), None);
        assert_eq!(errors.impact_speed, None);
    }

    #[test]
    fn speeds_of_impact_are_compared_where_both_runs_know_them() {
        let contacts = |speeds: [Option<f64>; 4]| -> [Contact; 4] {
            std::array::from_fn(|i| Contact::begun(i as f64, speeds[i], Felt::default()))
        };
        let reference = contacts([None, Some(2e-3), Some(4e-3), Some(1e-3)]);
        let error = |speeds| contact_errors(&contacts(speeds), &reference, 1e-3)?.impact_speed;
        // Over 4 mm/s, the largest; not of contacts that one of both starts in.
        let worst = error([Some(9.0), Some(2.5e-3), Some(4.1e-3), None]).unwrap();
        assert!((worst - 0.125).abs() < 1e-15, "{worst}");
        assert!(error([None, Some(f64::NAN), Some(4e-3), None]).unwrap().is_nan());
        assert_eq!(error([Some(9.0), None, None, None]), None);
    }
}

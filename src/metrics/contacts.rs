//! Contacts, from the event that begins one to the event that ends it: impulse, peak force, depth, impact speed.

use std::ops::ControlFlow;

use deltazero_solvers::root::{Bracket, find_root};
use deltazero_solvers::{Accepted, Event, Next, Real, Record, Step, System};
use num_dual::Dual64;
use serde::{Deserialize, Serialize};

use super::{ErrorScale, worse};
use crate::config::Events;
use crate::model::contact::PinPose;
use crate::model::{Block, Jointed, Mode, State};
use crate::quadrature::GAUSS;

/// How exactly the time of a peak is found, as a fraction of its step: the force is flat there.
const PRECISION: f64 = 1e-9;
/// Points of a step at which the force is looked at: both ends and the nodes.
const N_POINTS: usize = GAUSS.len() + 2;

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
    /// When it was [s].
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

/// What a joint feels in a step, or in a contact.
#[derive(Clone, Copy, Debug, Default)]
struct Felt {
    /// `∫ F_N dt` [N s].
    impulse: f64,
    /// When F_N is largest [s], and how large [N].
    peak: (f64, f64),
    /// Largest δ, or zero [m].
    depth: f64,
}

/// A recorder of the contacts of each joint of a part: quadrature and peaks of F_N on the dense output of its
/// steps.
///
/// They are as good as that dense output: rk4's cubic is off by `(ωh)⁴/384` of an oscillating force, 1e-3 at
/// ωh = 0.8, where the states at the ends of its steps are better.
///
/// What a blind run feels in a step that it begins outside belongs to the contact that it is in after it.
#[derive(Clone, Debug)]
pub struct Contacts<'a, P = Block> {
    part: &'a P,
    events: Events,
    joints: Vec<JointContacts>,
}

/// The contacts of one joint so far.
#[derive(Clone, Debug, Default)]
struct JointContacts {
    /// The last one may not have ended.
    list: Vec<Contact>,
    is_in_contact: bool,
    /// What was felt in the last step outside.
    outside: Felt,
}

impl<'a, P: Jointed> Contacts<'a, P> {
    /// No contact yet in a run of `part` that treats events in this way.
    pub fn new(part: &'a P, events: Events) -> Self {
        Self { part, events, joints: vec![JointContacts::default(); part.n_joints()] }
    }

    /// The contacts of each joint; its last one may not have ended.
    pub fn lists(self) -> Vec<Vec<Contact>> {
        self.joints.into_iter().map(|joint| joint.list).collect()
    }

    /// `F_N` at `y` in `mode` [N], both of one joint.
    fn force<S: Real>(&self, mode: Mode, y: &State<S>) -> S {
        let (Some(touch), true) = (mode.touch(), mode.is_contact()) else {
            return S::cst(0.0);
        };
        let block = self.part.block();
        let pose = block.pose(y);
        block.normal.force(pose.delta, pose.delta_dot, touch)
    }

    /// The part inside a step begun in `mode`.
    fn inside(
        &self,
        mode: &P::Mode,
        step: &dyn Step<P::State<f64>>,
        t: f64,
    ) -> (P::Mode, P::State<f64>) {
        let mut y = step.y0().clone();
        step.interpolate(t, &mut y);
        (self.part.mode_inside(self.events, mode, t, &y), y)
    }

    /// `F_N` of joint `k` there [N].
    fn force_at(&self, mode: &P::Mode, step: &dyn Step<P::State<f64>>, t: f64, k: usize) -> f64 {
        let (mode, y) = self.inside(mode, step, t);
        self.force(P::joint_mode(&mode, k), &self.part.joint_state(&y, k))
    }

    /// `dF_N/dt` of joint `k` there [N/s].
    fn rate_at(&self, mode: &P::Mode, step: &dyn Step<P::State<f64>>, t: f64, k: usize) -> f64 {
        let (mode, y) = self.inside(mode, step, t);
        let slope = self.slope(&mode, t, &y);
        self.rate(&mode, &y, &slope, k)
    }

    /// The slope of the part's state.
    fn slope(&self, mode: &P::Mode, t: f64, y: &P::State<f64>) -> P::State<f64> {
        let mut slope = y.clone();
        self.part.rhs(mode.clone(), t, y, &mut slope);
        slope
    }

    /// `dF_N/dt` of joint `k` [N/s].
    fn rate(&self, mode: &P::Mode, y: &P::State<f64>, slope: &P::State<f64>, k: usize) -> f64 {
        let (y, slope) = (self.part.joint_state(y, k), self.part.joint_state(slope, k));
        let along: State<Dual64> = std::array::from_fn(|i| Dual64::new(y[i], slope[i]));
        self.force(P::joint_mode(mode, k), &along).eps
    }

    /// What joint `k` feels over a step begun in `mode`; its extremes are looked for between the points where they
    /// may be above those of `before`.
    fn of_step(
        &self,
        mode: &P::Mode,
        step: &dyn Step<P::State<f64>>,
        points: &mut Points<P>,
        (k, before): (usize, Felt),
    ) -> Felt {
        let h = step.t1() - step.t0();
        let forces: Values = std::array::from_fn(|i| {
            let Point { t, mode, y, .. } = &points[i];
            (*t, self.force(P::joint_mode(mode, k), &self.part.joint_state(y, k)))
        });
        let nodes = forces[1..].iter().zip(GAUSS);
        let impulse = h * nodes.map(|((_, force), (_, weight))| weight * force).sum::<f64>();
        let poses: [PinPose<f64>; N_POINTS] = std::array::from_fn(|i| {
            self.part.block().pose(&self.part.joint_state(&points[i].y, k))
        });
        let depths: Values = std::array::from_fn(|i| (points[i].t, poses[i].delta));
        let pose_at = |t: f64| {
            let (_, y) = self.inside(mode, step, t);
            self.part.block().pose(&self.part.joint_state(&y, k))
        };
        let (_, depth) = largest(
            &depths,
            before.depth,
            PRECISION * h,
            |i| poses[i].delta_dot,
            |t| {
                let pose = pose_at(t);
                (pose.delta, pose.delta_dot)
            },
        );
        // One slope for all joints.
        let rate = |i: usize| {
            let Point { t, mode, y, slope } = &mut points[i];
            let slope = slope.get_or_insert_with(|| self.slope(mode, *t, y));
            self.rate(mode, y, slope, k)
        };
        let inside = |t: f64| (self.force_at(mode, step, t, k), self.rate_at(mode, step, t, k));
        let peak = largest(&forces, before.peak.1, PRECISION * h, rate, inside);
        Felt { impulse, peak, depth: depth.max(0.0) }
    }

    /// The part at the points of a step.
    fn points(&self, mode: &P::Mode, step: &dyn Step<P::State<f64>>) -> Points<P> {
        let (t0, h) = (step.t0(), step.t1() - step.t0());
        std::array::from_fn(|i| {
            let t = match i {
                0 => t0,
                i if i < N_POINTS - 1 => t0 + GAUSS[i - 1].0 * h,
                _ => step.t1(),
            };
            let (mode, y) = self.inside(mode, step, t);
            Point { t, mode, y, slope: None }
        })
    }
}

/// Times of the points of a step, and a quantity there.
type Values = [(f64, f64); N_POINTS];

/// When a smooth quantity is largest in a step, to `precision` [s], and how large: at one of the points that it
/// has these `values` at, or, where it may be above `highest`, beside it, where its rate is zero. `rate` is that
/// rate at a point, `inside` quantity and rate at a time.
fn largest(
    values: &Values,
    highest: f64,
    precision: f64,
    mut rate: impl FnMut(usize) -> f64,
    inside: impl Fn(f64) -> (f64, f64),
) -> (f64, f64) {
    let top = (1..N_POINTS).fold(0, |top, i| if values[i].1 > values[top].1 { i } else { top });
    let [a, b] = [top.saturating_sub(1), (top + 1).min(N_POINTS - 1)];
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

/// A part at one point of a step.
struct Point<P: System> {
    t: f64,
    mode: P::Mode,
    y: P::State<f64>,
    /// Once it was asked for.
    slope: Option<P::State<f64>>,
}

type Points<P> = [Point<P>; N_POINTS];

impl<P: Jointed> Record<P> for Contacts<'_, P> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        let (mode, step) = (&accepted.mode, accepted.step);
        let is_outside = |k: usize| !P::joint_mode(mode, k).is_contact();
        let is_located = self.events == Events::Located;
        if is_located && (0..self.joints.len()).all(is_outside) {
            return ControlFlow::Continue(());
        }
        let mut points = self.points(mode, step);
        for k in 0..self.joints.len() {
            if is_outside(k) {
                if !is_located {
                    let before = Felt::default();
                    self.joints[k].outside = self.of_step(mode, step, &mut points, (k, before));
                }
                continue;
            }
            let joint = &mut self.joints[k];
            if !std::mem::replace(&mut joint.is_in_contact, true) {
                // A run that starts in contact.
                joint.list.push(Contact::begun(step.t0(), None, Felt::default()));
            }
            let before = joint.list.last().map_or(Felt::default(), Contact::felt);
            let felt = self.of_step(mode, step, &mut points, (k, before));
            if let Some(contact) = self.joints[k].list.last_mut() {
                contact.end = step.t1();
                contact.impulse += felt.impulse;
                contact.depth = contact.depth.max(felt.depth);
                if felt.peak.1 > contact.peak {
                    (contact.peak_at, contact.peak) = felt.peak;
                }
            }
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        let Next::Mode(after) = &event.after else { return ControlFlow::Continue(()) };
        for (k, joint) in self.joints.iter_mut().enumerate() {
            let is_in_contact = P::joint_mode(after, k).is_contact();
            let was_in_contact = std::mem::replace(&mut joint.is_in_contact, is_in_contact);
            if is_in_contact && !was_in_contact {
                let pose = self.part.block().pose(&self.part.joint_state(event.y, k));
                let is_start = joint.list.is_empty() && self.part.block().starts_on_surface();
                let speed = (!is_start).then_some(pose.delta_dot);
                let before = std::mem::take(&mut joint.outside);
                joint.list.push(Contact::begun(event.t, speed, before));
            }
        }
        ControlFlow::Continue(())
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
}

/// Compares contacts whose ends are the same events, in order, both within the window of `scale`; none
/// where there are no such pairs.
pub fn contact_errors(
    run: &[Contact],
    reference: &[Contact],
    scale: ErrorScale,
) -> Option<ContactErrors> {
    let largest = |of: fn(&Contact) -> f64| {
        reference.iter().map(of).fold(f64::MIN_POSITIVE, |largest, x| largest.max(x.abs()))
    };
    let (largest_peak, largest_impulse) = (largest(|c| c.peak), largest(|c| c.impulse));
    let near = |a: f64, b: f64| (a - b).abs() <= scale.event_window;
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
    }
    errors
}

#[cfg(test)]
mod tests {
    use deltazero_solvers::Method;

    use super::*;
    use crate::config::Config;
    use crate::model::{Body, Mechanism};
    use crate::run::{Accuracy, Setting, integrate};

    /// Impact speed of the pin [m/s].
    const V: f64 = 1e-3;

    /// The contacts of a pin that moves along Y alone, without drive, damping and friction: half a sine each,
    /// from wall to wall.
    fn half_sines(method: &str, events: Events, accuracy: Accuracy) -> (Block, Vec<Contact>) {
        let sets = ["drive.m1=0", "contact.damping=0", "friction.coefficient=0"];
        let config = Config::load(None, &sets.map(str::to_owned)).unwrap();
        let block = Mechanism::new(&config).blocks()[0].clone();
        let setting = Setting { method: Method::named(method).unwrap(), events, accuracy };
        let mut y0 = block.initial_state();
        y0[4] = -V;
        let mut contacts = Contacts::new(&block, events);
        let run = integrate(&block, &setting, y0, 0.5, &mut contacts);
        assert!(run.outcome.is_ok(), "{:?}", run.outcome);
        let list = contacts.lists().remove(0);
        (block, list)
    }

    /// Worst relative errors of impulse, `2 m v`, peak force, `v √(K m)`, and duration, `π √(m/K)`.
    fn errors((block, contacts): &(Block, Vec<Contact>)) -> [f64; 3] {
        let Body::Struts(inertia) = &block.body else { panic!("joint 1 holds struts") };
        let (m, k) = (inertia.m_y, block.normal.elastic.slope(0.0));
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
        // 9.0e-12, 9.4e-12, 7.4e-14, and 6.9e-14, 5.7e-14, 6.7e-15.
        let cases = [("rk45", [9e-11, 9e-11, 7e-13]), ("taylor", [7e-13, 6e-13, 6e-14])];
        for (method, bounds) in cases {
            let half_sines = half_sines(method, Events::Located, Accuracy::Rtol(1e-12, None));
            assert_eq!(half_sines.1.len(), 3);
            let errors = errors(&half_sines);
            let holds = errors.iter().zip(bounds).all(|(e, bound)| *e < bound);
            assert!(holds, "{method}: {errors:?}");
        }
    }

    #[test]
    fn depth_impact_speed_and_time_of_the_peak_are_those_of_half_a_sine() {
        for method in ["rk45", "taylor"] {
            let (block, contacts) =
                half_sines(method, Events::Located, Accuracy::Rtol(1e-12, None));
            let Body::Struts(inertia) = &block.body else { panic!("joint 1 holds struts") };
            let depth = V * (inertia.m_y / block.normal.elastic.slope(0.0)).sqrt();
            // The first one, on whose surface the run starts, is no impact.
            let speeds: Vec<_> =
                contacts.iter().filter_map(|contact| contact.impact_speed).collect();
            assert_eq!(speeds.len(), contacts.len() - 1);
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
        assert_eq!(half_sines.1.len(), 3);
        let errors = errors(&half_sines);
        // Measured: 9.3e-10, 4.3e-10, 3.7e-4; its events are up to a step late.
        let holds = errors.iter().zip([9e-9, 4e-9, 3e-3]).all(|(e, bound)| *e < bound);
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
        let scale = ErrorScale { clearance: 1e-4, theta: 1.0, event_window: 1e-3 };
        let errors = contact_errors(&run, &reference, scale).unwrap();
        assert!((errors.impulse - 0.05).abs() < 1e-15 && errors.peak == 0.0, "{errors:?}");
        assert_eq!(contact_errors(&run[1..2], &reference, scale), None);
    }
}

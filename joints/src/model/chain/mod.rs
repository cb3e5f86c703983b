//! N bays: each root pin in a bush at the end C of the bay before.
//!
//! Bay k has the pin displacement d_k *relative to its bush*, the angle θ_k and their rates; the bush does
//! not turn. With the contact force F_k n_k of joint k on its pin, and reversed on the bay before, the
//! absolute accelerations of a bay's pin are those of a [`Block`] under its own forces and
//!
//! ```text
//! Q_X = F_(k+1) n_X,   Q_Y = F_(k+1) n_Y,   Q_θ = (l1 + l2) cos θ_k F_(k+1) n_X        (n of joint k + 1)
//! d̈_k = (Ẍ_k, Ÿ_k) − C̈_(k−1),   C̈ = (Ẍ + (l1 + l2)(cos θ θ̈ − sin θ θ̇²), Ÿ)
//! ```
//!
//! so a right-hand side is one pass from the root. Friction is a torque on the bay's own angle (reading
//! `pin`); as a force it would couple the sticks of neighbours. A linkage whose joint has bristles is a
//! chain of one bay, with another [`Body`]. Relative displacements keep their digits: an
//! absolute position of some metres would leave a gap of 0.1 mm ten.

mod energy;
mod jacobian;
mod mode;
mod problem;

use std::ops::Range;

use deltazero_solvers::{Next, Real, System};

use super::block::{Block, ContactForces};
use super::body::{Body, Held, Posture};
use super::contact::{Onset, PinPose};
use super::inertia::{Arrow, BlockInertia};
use super::linkage::Linkage as _;
use super::linkages::AnyLinkage;
use super::mode::{Mode, N_GUARDS};
use super::sliding::Bristles;
use super::state::State;

pub use mode::Modes;

/// Guards of a bay, those of its joint.
const GUARDS: usize = N_GUARDS;
/// States of a bay.
const STATES: usize = 6;

/// A chain of equal bays, a hybrid system of six states a bay, [`State`] after [`State`] from the root; of
/// seven where friction has [`Bristles`], whose deflection z [m] follows the six.
///
/// It has a joint 1 in each bay; joint 2 is at the root alone and shares no term with them. A joint whose
/// friction has bristles is a chain of one bay.
#[derive(Clone, Debug)]
pub struct Chain {
    /// A bay on its own. Of several the reading is `pin` and the body struts; the clearance is above zero.
    pub bay: Block,
    /// Number of bays, at least one.
    pub bays: usize,
    /// What the friction of its joints keeps of their sliding.
    bristles: Option<Bristles>,
}

/// The contact of a joint, with its forces and how it began.
type Contact<S> = (PinPose<S>, ContactForces<S>, Onset);

/// How one bay moves among the others.
struct Motion<S> {
    y: State<S>,
    /// Its contact, if any.
    contact: Option<Contact<S>>,
    /// ż of its bristles [m/s].
    bristles: S,
    /// `(d̈, θ̈)`, the displacement relative to the bush.
    relative: [S; 3],
    /// What the neighbours add to them.
    extra: [S; 3],
    /// `C̈` of its end; zero of a linkage, which has no bush there.
    end: [S; 2],
}

impl<S: Real> Motion<S> {
    /// The forces of its contact, none where it has none.
    fn forces(&self) -> ContactForces<S> {
        let none = ContactForces::frictionless(S::cst(0.0));
        self.contact.as_ref().map_or(none, |(_, forces, _)| *forces)
    }
}

impl Chain {
    /// `l1 + l2`, from a bay's pin to the bush at its end [m].
    fn reach(&self) -> f64 {
        2.0 * self.bay.strut_length
    }

    /// A chain of `bays`.
    pub fn of(bay: Block, bays: usize) -> Self {
        let bristles = bay.sliding.bristles();
        Self { bay, bays, bristles }
    }

    /// States of a bay.
    pub(super) fn stride(&self) -> usize {
        if self.bristles.is_some() { STATES + 1 } else { STATES }
    }

    /// `of_bay` for each bay, followed by `of_bristles` where there are any.
    pub(super) fn of_each(&self, of_bay: State<f64>, of_bristles: f64) -> Vec<f64> {
        let bay = of_bay.into_iter().chain([of_bristles]).take(self.stride());
        bay.collect::<Vec<_>>().repeat(self.bays)
    }

    /// The deflection at which bristles slide at rest [m].
    pub(super) fn bristle_scale(&self) -> f64 {
        self.bristles.map_or(0.0, |bristles| bristles.most_deflection(self.bay.mu))
    }

    /// The bay, counted from zero, that a guard belongs to.
    pub fn bay_of(guard: usize) -> usize {
        guard / GUARDS
    }

    /// The six states of bay `k`, counted from zero.
    pub(super) fn state_of<S: Real>(&self, y: &[S], k: usize) -> State<S> {
        let first = self.stride() * k;
        std::array::from_fn(|i| y[first + i])
    }

    /// The deflection of its bristles [m]; zero where there are none.
    fn deflection<S: Real>(&self, y: &[S], k: usize) -> S {
        if self.bristles.is_some() { y[self.stride() * k + STATES] } else { S::cst(0.0) }
    }

    /// The contact forces of every bay.
    pub fn forces(&self, modes: &Modes, y: &[f64]) -> Vec<ContactForces<f64>> {
        let mut all = Vec::with_capacity(self.bays);
        self.along(modes, y, 0..self.bays, |_, motion| all.push(motion.forces()));
        all
    }

    /// How the pin of joint `k` stands in its bush, where the two are in contact.
    fn contact<S: Real>(&self, modes: &[Mode], y: &[S], k: usize) -> Option<(PinPose<S>, Onset)> {
        let mode = modes.get(k).filter(|mode| mode.is_contact())?;
        mode.onset().map(|onset| (self.bay.pose(&self.state_of(y, k)), onset))
    }

    /// The normal force of a contact on the bush, `F_N n` [N].
    fn push<S: Real>(&self, pose: &PinPose<S>, onset: Onset) -> [S; 2] {
        let normal = self.bay.normal.force(pose.delta, pose.delta_dot, onset);
        [pose.n[0] * normal, pose.n[1] * normal]
    }

    /// `(Ẍ, Ÿ, θ̈)` of a bay by the force `push` on the bush at its end.
    fn response<S: Real>(&self, inertia: &BlockInertia, arrow: &Arrow<S>, push: [S; 2]) -> [S; 3] {
        let load = [push[0], push[1], arrow.cos * push[0] * self.reach()];
        inertia.accelerations(arrow, S::cst(0.0), load)
    }

    /// Shows the bays of `range` to `see`, from the root on; the first one is the chain's, or does not
    /// stick: what its bush does it cannot feel but in its own displacement.
    fn along<S: Real>(
        &self,
        modes: &[Mode],
        y: &[S],
        range: Range<usize>,
        mut see: impl FnMut(usize, &Motion<S>),
    ) {
        let mut bush = [S::cst(0.0); 2];
        let mut own = self.contact(modes, y, range.start);
        for k in range {
            let next = self.contact(modes, y, k + 1);
            let state = (&self.state_of(y, k), self.deflection(y, k));
            let motion = match &self.bay.body {
                Body::Struts(inertia) => {
                    self.strut_motion(inertia, modes[k], state, own, next, bush)
                }
                Body::Linkage(linkage) => self.linkage_motion(linkage, modes[k], state, own),
            };
            see(k, &motion);
            (own, bush) = (next, motion.end);
        }
    }

    /// Struts at `y`, their bristles at `z`, in `mode` with their `own` contact and the `next` one at their
    /// end, their bush accelerating with `bush`.
    // A function of its own: inlined in every pass, series of it take minutes to compile.
    #[inline(never)]
    fn strut_motion<S: Real>(
        &self,
        inertia: &BlockInertia,
        mode: Mode,
        (y, z): (&State<S>, S),
        own: Option<(PinPose<S>, Onset)>,
        next: Option<(PinPose<S>, Onset)>,
        bush: [S; 2],
    ) -> Motion<S> {
        let (arrow, omega_sq) = (inertia.at(y[2]), y[5] * y[5]);
        let none = [S::cst(0.0); 3];
        let response = next
            .map_or(none, |(pose, onset)| self.response(inertia, &arrow, self.push(&pose, onset)));
        let extra = [response[0] - bush[0], response[1] - bush[1], response[2]];
        let held = Held::Struts(inertia);
        let (contact, bristles) = self.touching(held, mode, (y, z), own, extra);
        let alone = match &contact {
            Some((pose, forces, _)) => {
                self.bay.accelerations(y, &Posture::Struts(inertia, arrow), pose, *forces)
            }
            None => self.bay.free_accelerations(inertia, y, &arrow),
        };
        let [a_x, a_y, theta]: [S; 3] = std::array::from_fn(|i| alone[i] + response[i]);
        let swing = (arrow.cos * theta - arrow.sin * omega_sq) * self.reach();
        let relative = [a_x - bush[0], a_y - bush[1], theta];
        Motion { y: *y, contact, bristles, relative, extra, end: [a_x + swing, a_y] }
    }

    /// A linkage at `y`, its bristles at `z`, in `mode` with its `own` contact.
    #[inline(never)]
    fn linkage_motion<S: Real>(
        &self,
        linkage: &AnyLinkage,
        mode: Mode,
        (y, z): (&State<S>, S),
        own: Option<(PinPose<S>, Onset)>,
    ) -> Motion<S> {
        let none = [S::cst(0.0); 3];
        let held = Held::Linkage(linkage);
        let (contact, bristles) = self.touching(held, mode, (y, z), own, none);
        let at = linkage.at(y);
        let [a_x, a_y, _] = match &contact {
            Some((pose, forces, _)) => {
                self.bay.accelerations(y, &Posture::Linkage(linkage, at), pose, *forces)
            }
            None => linkage.accelerations(&at, None),
        };
        let (relative, end) = ([a_x, a_y, none[2]], [none[0], none[1]]);
        Motion { y: *y, contact, bristles, relative, extra: none, end }
    }

    /// A contact with its forces, where there is one, and ż of its bristles.
    #[inline(always)]
    fn touching<S: Real>(
        &self,
        held: Held<'_>,
        mode: Mode,
        (y, z): (&State<S>, S),
        own: Option<(PinPose<S>, Onset)>,
        extra: [S; 3],
    ) -> (Option<Contact<S>>, S) {
        let Some((pose, onset)) = own else { return (None, S::cst(0.0)) };
        let (Some(bristles), Some(sigma)) = (self.bristles, mode.sigma()) else {
            let forces = self.bay.forces_among(held, mode, y, &pose, Some(extra));
            return (Some((pose, forces, onset)), S::cst(0.0));
        };
        let v_t = self.bay.v_t_of(held, &pose, y);
        let (ratio, z_dot) = bristles.bent((self.bay.mu, onset.piece), sigma, v_t, z);
        let normal = self.bay.normal.force(pose.delta, pose.delta_dot, onset);
        let forces = ContactForces { normal, tangential: -(normal * ratio) };
        (Some((pose, forces, onset)), z_dot)
    }

    /// What its neighbours add to the accelerations of bay `k`.
    fn extra<S: Real>(&self, modes: &[Mode], y: &[S], k: usize) -> [S; 3] {
        // Only a bay that sticks hands on what its own bush does.
        let first = (0..k).rev().find(|j| !modes[*j].sticks()).unwrap_or(0);
        let mut extra = [S::cst(0.0); 3];
        self.along(modes, y, first..k + 1, |_, motion| extra = motion.extra);
        extra
    }
}

impl System for Chain {
    type Mode = Modes;
    type State<S: Real> = Vec<S>;
    type Guards<S: Real> = Vec<S>;

    fn dim(&self) -> usize {
        self.stride() * self.bays
    }

    fn n_guards(&self) -> usize {
        GUARDS * self.bays
    }

    /// A guard goes with the states of its bay, and sticking with those of its neighbours.
    fn guard_span(&self) -> usize {
        3 * self.stride()
    }

    /// Each bay as a [`Block`] of its own has it, the sign of its slip decided among the others.
    fn initial_mode(&self, t: f64, y: &Vec<f64>) -> Modes {
        let alone = |k| self.bay.initial_mode(t, &self.state_of(y, k));
        let mut modes: Vec<Mode> = (0..self.bays).map(alone).collect();
        for k in 0..self.bays {
            if modes[k].is_contact() {
                let extra = self.extra(&modes, y, k);
                modes[k] = self.bay.entered(&self.state_of(y, k), Some(extra));
            }
        }
        modes.into()
    }

    fn rhs<S: Real>(&self, modes: Modes, _t: S, y: &Vec<S>, dydt: &mut Vec<S>) {
        self.along(&modes, y, 0..self.bays, |k, motion| {
            let stride = self.stride();
            let rates = &mut dydt[stride * k..stride * (k + 1)];
            rates[..3].copy_from_slice(&motion.y[3..]);
            rates[3..STATES].copy_from_slice(&motion.relative);
            rates[STATES..].fill(motion.bristles);
        });
    }

    fn guards<S: Real>(&self, modes: Modes, _t: S, y: &Vec<S>, g: &mut Vec<S>) {
        let (none, mut extra) = (S::cst(0.0), Vec::new());
        if modes.iter().any(|mode| mode.sticks()) {
            self.along(&modes, y, 0..self.bays, |_, motion| extra.push(motion.extra));
        }
        for (k, g) in g.chunks_exact_mut(GUARDS).enumerate() {
            // Where nothing sticks they go with no acceleration.
            let extra = extra.get(k).copied().unwrap_or([none; 3]);
            let own = self.state_of(y, k);
            g.copy_from_slice(&self.bay.guards_among(
                self.bay.body.held(),
                modes[k],
                &own,
                Some(extra),
            ));
        }
    }

    fn guard_bounds(&self, modes: Modes, _t: f64, y: &Vec<f64>, bounds: &mut Vec<f64>) {
        for k in 0..self.bays {
            let own = self.bay.guard_bounds_of(modes[k], &self.state_of(y, k));
            bounds[GUARDS * k..GUARDS * (k + 1)].copy_from_slice(&own);
        }
    }

    fn transition<S: Real>(
        &self,
        modes: Modes,
        guard: usize,
        _t: S,
        y: &mut Vec<S>,
    ) -> Next<Modes> {
        let (k, guard) = (Self::bay_of(guard), guard % GUARDS);
        let extra = Some(self.extra(&modes, y, k));
        let mut own = self.state_of(y, k);
        match self.bay.after(modes[k], guard, &mut own, extra) {
            Next::Stop => Next::Stop,
            Next::Mode(mode) => {
                let first = self.stride() * k;
                y[first..first + STATES].copy_from_slice(&own);
                // What touches anew is not bent yet.
                if !(modes[k].is_contact() && mode.is_contact()) {
                    y[first + STATES..first + self.stride()].fill(S::cst(0.0));
                }
                Next::Mode(modes.with(k, mode))
            }
        }
    }

    fn jacobian(&self, modes: Modes, _t: f64, y: &Vec<f64>, entry: impl FnMut(usize, usize, f64)) {
        match (&self.bay.body, self.bristles) {
            (Body::Struts(inertia), None) => self.jacobian_entries(inertia, &modes, y, entry),
            _ => self.dual_jacobian(&modes, y, entry),
        }
    }

    fn time_derivative(&self, _modes: Modes, _t: f64, _y: &Vec<f64>, dfdt: &mut Vec<f64>) {
        dfdt.fill(0.0);
    }
}

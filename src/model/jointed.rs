//! What is integrated by itself: a joint with what hangs on it, or several in one system.

use deltazero_solvers::{Error, ModeOfState, System};

use super::block::{Block, Body, ContactForces, State};
use super::chain::{Chain, Modes};
use super::energy::{Energy, Power};
use super::mode::Mode;
use crate::config::Events;

/// A hybrid system of one joint or more, each with a state and a mode of its own.
pub trait Jointed: System {
    /// A joint with what hangs on it, alone; all of a system are equal.
    fn block(&self) -> &Block;

    /// Number of joints: of a chain one a bay.
    fn n_joints(&self) -> usize;

    /// Whether the contacts can carry what the drive alone asks of them; see [`Block::check_load`].
    ///
    /// # Errors
    /// [`Error::OutsideModel`]: they cannot, or the system is not the one to integrate.
    fn check(&self) -> Result<(), Error> {
        self.block().check_load()
    }

    /// The start; see [`Block::initial_state`].
    fn start(&self) -> Self::State<f64>;

    /// The start with each of its numbers but zeros moved by `nudge`: by its last bit, to see what that does.
    fn start_nudged(&self, nudge: fn(f64) -> f64) -> Self::State<f64> {
        let mut start = self.start();
        for y in start.as_mut().iter_mut().filter(|y| **y != 0.0) {
            *y = nudge(*y);
        }
        start
    }

    /// The scale of each state; see [`Block::scale`].
    fn scales(&self) -> Self::State<f64>;

    /// The mode of joint `k`, counted from zero.
    fn joint_mode(mode: &Self::Mode, k: usize) -> Mode;

    /// The joint that a guard is of.
    fn joint_of_guard(guard: usize) -> usize;

    /// The mode that stands for the whole where one has to: of several joints that of the first which sticks,
    /// else of the first in contact, else of the root.
    fn foremost(mode: &Self::Mode) -> Mode;

    /// The contact forces of every joint.
    fn joint_forces(&self, mode: &Self::Mode, y: &Self::State<f64>) -> Vec<ContactForces<f64>>;

    /// Energies at `y` in `mode`.
    fn energies(&self, mode: &Self::Mode, y: &Self::State<f64>) -> Energy;

    /// Powers there.
    fn powers(&self, mode: &Self::Mode, y: &Self::State<f64>) -> Power;

    /// Work of the drive from `y0` to `y1` [J], where it needs no quadrature: a constant torque does it, or no
    /// energy is lost.
    fn drive_work(&self, y0: &Self::State<f64>, y1: &Self::State<f64>) -> Option<f64>;

    /// The mode that it is computed in at `(t, y)`, inside a step begun in `mode`: this very one where events
    /// are located, and what the state says where they are not.
    fn mode_inside(
        &self,
        events: Events,
        mode: &Self::Mode,
        t: f64,
        y: &Self::State<f64>,
    ) -> Self::Mode;

    /// Whether an event between these modes may leave a dent in a bush, or take it up again.
    fn may_relax(before: &Self::Mode, after: &Self::Mode) -> bool;

    /// The joint that a component of the state is of.
    fn joint_of_component(&self, component: usize) -> usize {
        component * self.n_joints() / self.dim()
    }

    /// Where the six states of joint `k` begin.
    fn offset(&self, k: usize) -> usize {
        k * (self.dim() / self.n_joints())
    }

    /// The six states of joint `k`.
    fn joint_state(&self, y: &Self::State<f64>, k: usize) -> State<f64> {
        let (y, offset) = (y.as_ref(), self.offset(k));
        std::array::from_fn(|i| y[offset + i])
    }

    /// The six states of every joint.
    fn joint_states(&self, y: &Self::State<f64>) -> Vec<State<f64>> {
        (0..self.n_joints()).map(|k| self.joint_state(y, k)).collect()
    }

    /// The joint nearest to where it ends, at 90° or at the range of its contact law; the first of several.
    fn nearest_end(&self, mode: &Self::Mode, y: &Self::State<f64>) -> usize {
        let left = |k: &usize| {
            self.block().before_end(Self::joint_mode(mode, *k), &self.joint_state(y, *k))
        };
        (0..self.n_joints()).min_by(|a, b| left(a).total_cmp(&left(b))).unwrap_or(0)
    }

    /// The modes of all joints.
    fn joint_modes(&self, mode: &Self::Mode) -> Vec<Mode> {
        (0..self.n_joints()).map(|k| Self::joint_mode(mode, k)).collect()
    }

    /// Sets the six entries of every joint in `all`, which has one for each state, to those of `each`.
    fn set_each(&self, all: &mut [f64], each: &State<f64>) {
        for k in 0..self.n_joints() {
            let offset = self.offset(k);
            all[offset..offset + each.len()].copy_from_slice(each);
        }
    }
}

impl Jointed for Block {
    fn block(&self) -> &Block {
        self
    }

    fn check(&self) -> Result<(), Error> {
        if self.sliding.bristles().is_some() {
            let reason = "the bristles of lugre are a state that a block does not have; integrate the part \
                          that `Mechanism::new` makes of it";
            let mode = Mode::Apart.to_string();
            return Err(Error::OutsideModel { t: 0.0, mode, reason: reason.to_owned() });
        }
        self.check_load()
    }

    fn n_joints(&self) -> usize {
        1
    }

    fn start(&self) -> State<f64> {
        self.initial_state()
    }

    fn scales(&self) -> State<f64> {
        self.scale()
    }

    fn joint_mode(mode: &Mode, _k: usize) -> Mode {
        *mode
    }

    fn joint_of_guard(_guard: usize) -> usize {
        0
    }

    fn foremost(mode: &Mode) -> Mode {
        *mode
    }

    fn joint_forces(&self, mode: &Mode, y: &State<f64>) -> Vec<ContactForces<f64>> {
        vec![self.forces(*mode, y, &self.pose(y))]
    }

    fn energies(&self, mode: &Mode, y: &State<f64>) -> Energy {
        self.energy(*mode, y)
    }

    fn powers(&self, mode: &Mode, y: &State<f64>) -> Power {
        self.power(*mode, y)
    }

    fn drive_work(&self, y0: &State<f64>, y1: &State<f64>) -> Option<f64> {
        match &self.body {
            Body::Struts(_) => Some(self.torque * (y1[2] - y0[2])),
            // A pin that is held follows the crank through steps that no quadrature resolves.
            Body::SliderCrank(crank) => {
                (self.clearance == 0.0).then(|| crank.kinetic(y1) - crank.kinetic(y0))
            }
        }
    }

    fn mode_inside(&self, events: Events, mode: &Mode, t: f64, y: &State<f64>) -> Mode {
        match events {
            Events::Located => *mode,
            Events::Blind => self.mode_of_state(t, y),
        }
    }

    fn may_relax(before: &Mode, after: &Mode) -> bool {
        [before, after].iter().any(|mode| matches!(mode, Mode::Relaxing(_)))
    }
}

impl Jointed for Chain {
    fn block(&self) -> &Block {
        &self.bay
    }

    fn n_joints(&self) -> usize {
        self.bays
    }

    fn start(&self) -> Vec<f64> {
        self.of_each(self.bay.initial_state(), 0.0)
    }

    fn scales(&self) -> Vec<f64> {
        self.of_each(self.bay.scale(), self.bristle_scale())
    }

    fn joint_mode(modes: &Modes, k: usize) -> Mode {
        modes[k]
    }

    fn joint_of_guard(guard: usize) -> usize {
        Self::bay_of(guard)
    }

    fn foremost(modes: &Modes) -> Mode {
        modes.foremost()
    }

    fn joint_forces(&self, modes: &Modes, y: &Vec<f64>) -> Vec<ContactForces<f64>> {
        self.forces(modes, y)
    }

    fn energies(&self, modes: &Modes, y: &Vec<f64>) -> Energy {
        self.energy(modes, y)
    }

    fn powers(&self, modes: &Modes, y: &Vec<f64>) -> Power {
        self.power(modes, y)
    }

    fn drive_work(&self, y0: &Vec<f64>, y1: &Vec<f64>) -> Option<f64> {
        let of_bay = |k| self.bay.drive_work(&self.joint_state(y0, k), &self.joint_state(y1, k));
        (0..self.bays).map(of_bay).sum()
    }

    /// The same: its events are always located.
    fn mode_inside(&self, _: Events, modes: &Modes, _t: f64, _y: &Vec<f64>) -> Modes {
        modes.clone()
    }

    fn may_relax(before: &Modes, after: &Modes) -> bool {
        before.iter().zip(after.iter()).any(|(a, b)| a != b && Block::may_relax(a, b))
    }
}

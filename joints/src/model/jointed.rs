//! What is integrated by itself: a joint with what hangs on it, or several in one system.

use deltazero_solvers::{Alike as _, Error, ModeOfState, Outcome, Real, Record};
use deltazero_study::Problem;
use deltazero_study::problem::{
    EndName, Energy, Group, GroupScale, Laws, Power, Quantity, Role, Touch,
};
use deltazero_study::run::{Begun, OwnRun, Setting, at_once, blind, extended, integrate};

use super::block::{Block, ContactForces};
use super::body::Body;
use super::contact;
use super::linkage::{Linkage as _, Outputs};
use super::mode::Mode;
use super::state::State;

/// A problem of one joint or more, each with six states and a mode of its own.
pub trait Jointed: Problem {
    /// A joint with what hangs on it, alone; all of a system are equal.
    fn block(&self) -> &Block;

    /// The mode of joint `k`, counted from zero.
    fn joint_mode(mode: &Self::Mode, k: usize) -> Mode;

    /// Where the six states of joint `k` begin.
    fn offset(&self, k: usize) -> usize {
        k * (self.dim() / self.n_sites())
    }

    /// The six states of joint `k` among all.
    fn joint_state(&self, y: &[f64], k: usize) -> State<f64> {
        let offset = self.offset(k);
        std::array::from_fn(|i| y[offset + i])
    }

    /// A run of it; see [`run::integrate`](integrate).
    ///
    /// It has no default: what is generic is compiled anew, with every method, in each crate that calls it. What stands in
    /// an `impl` is compiled here alone.
    fn integrate(
        &self,
        setting: &Setting,
        y0: Self::State<f64>,
        t_end: f64,
        record: &mut dyn Record<Self>,
    ) -> OwnRun<Self>
    where
        Self: Sized;

    /// The joint nearest to where it ends, at 90° or at the range of its contact law; the first of several.
    fn joint_nearest_end(&self, mode: &Self::Mode, y: &[f64]) -> usize {
        let left = |k: &usize| {
            self.block().before_end(Self::joint_mode(mode, *k), &self.joint_state(y, *k))
        };
        (0..self.n_sites()).min_by(|a, b| left(a).total_cmp(&left(b))).unwrap_or(0)
    }
}

/// The name of a joint's part.
pub(super) fn part_name(block: &Block) -> String {
    format!("joint {}", block.joint)
}

/// The states of one joint, the scales of which are `scale`.
pub(super) fn joint_quantities(scale: State<f64>) -> impl Iterator<Item = Quantity> {
    let names = ["X", "Y", "θ", "Ẋ", "Ẏ", "ω"];
    let units = ["m", "m", "rad", "m/s", "m/s", "rad/s"];
    let pairs = names.into_iter().zip(units).zip(scale);
    pairs.map(|((name, unit), scale)| Quantity::new(name, unit, scale))
}

/// The pin over its clearance (0.1 mm where there is none), the angle over its largest.
pub(super) fn joint_groups(block: &Block, offset: usize, site: usize) -> [Group; 2] {
    let clearance = if block.clearance > 0.0 { block.clearance } else { 1e-4 };
    let group = |name: &'static str, unit: &'static str, states: &[usize], scale| Group {
        name: name.into(),
        unit: unit.into(),
        states: states.iter().map(|i| offset + i).collect(),
        scale,
        site,
    };
    [
        group("pin", "m", &[0, 1], GroupScale::Fixed(clearance)),
        group("θ", "rad", &[2], GroupScale::Largest),
    ]
}

pub(super) fn role(mode: Mode) -> Role {
    match mode {
        Mode::Pinned => Role::Held,
        Mode::Apart | Mode::Relaxing(_) => Role::Free,
        Mode::SlipPlus(_) | Mode::SlipMinus(_) => Role::Contact,
        Mode::Stick(_) => Role::Stick,
    }
}

/// The contact of a joint like `block`; none of one whose pin is held.
pub(super) fn touch<S: Real>(block: &Block, mode: Mode, y: &State<S>) -> Option<Touch<S>> {
    if block.clearance == 0.0 {
        return None;
    }
    let pose = block.pose(y);
    let force = match mode.onset() {
        Some(onset) if mode.is_contact() => block.normal.force(pose.delta, pose.delta_dot, onset),
        _ => S::cst(0.0),
    };
    Some(Touch { depth: pose.delta, rate: pose.delta_dot, force })
}

/// A reading that feeds energy in has no balance. Friction only takes energy where it acts as a force, without
/// bristles, on a contact that never pulls.
pub(super) fn laws(block: &Block) -> Laws {
    Laws {
        balances: block.reading.is_consistent(),
        damping_takes: true,
        friction_takes: block.reading.tangential_force == 1.0
            && !block.normal.adhesion
            && block.sliding.bristles().is_none(),
        deepest: (block.clearance > 0.0).then_some(block.clearance),
    }
}

/// What a joint has done that a terminal event ended.
pub(super) const REACHED_90: EndName = EndName { key: "reached_90", words: "reached 90 degrees" };

/// Another way out, of a law with hysteresis.
pub(super) fn out_of_stiffness(block: &Block) -> &'static str {
    match block.normal.hysteresis {
        0.0 => "",
        _ => ", or, where a contact begins slowly, a larger contact.impact_speed_floor",
    }
}

impl Block {
    /// The columns of its motion: pin, angle, their rates, what moves with them, and the forces of the contact.
    pub(super) fn motion_columns(&self) -> Vec<Quantity> {
        let column = |(name, unit): (&'static str, &'static str)| Quantity::new(name, unit, 1.0);
        const ANGLE: [(&str, &str); 2] = [("theta", "rad"), ("omega", "rad/s")];
        const CRANK: [(&str, &str); 2] = [("crank", "rad"), ("crank", "rad/s")];
        let (angle, outputs, drive) = match &self.body {
            Body::Struts(_) => (ANGLE, None, None),
            Body::Linkage(linkage) => (CRANK, Some(linkage.outputs()), Some(("torque", "N m"))),
        };
        let of = |part: fn(&Outputs) -> &'static [_]| outputs.as_ref().map_or(&[][..], part);
        let pin = [("d1", "m"), ("d2", "m"), angle[0]];
        let rates = [("v1", "m/s"), ("v2", "m/s"), angle[1]];
        let forces = [("f_n", "N"), ("f_t", "N")];
        let all = pin.iter().chain(of(|outputs| outputs.places));
        let all = all.chain(&rates).chain(of(|outputs| outputs.rates));
        let all = all.chain(of(|outputs| outputs.accelerations)).chain(&forces).chain(&drive);
        all.copied().map(column).collect()
    }

    /// Its motion in these columns.
    pub(super) fn motion_row(
        &self,
        mode: Mode,
        y: &State<f64>,
        forces: ContactForces<f64>,
    ) -> Vec<f64> {
        let in_order = self.in_paper_order(y);
        let (pin, rates) = in_order.split_at(3);
        let forces_on_pin = [forces.normal, forces.tangential];
        let Body::Linkage(linkage) = &self.body else {
            return [pin, rates, &forces_on_pin].concat();
        };
        let load = self.load_on_linkage(mode, y, forces);
        let (outputs, values) = (linkage.outputs(), linkage.output(y, load));
        let (places, values) = values.split_at(outputs.places.len());
        let torque = [linkage.torque(y, load)];
        let (own_rates, accelerations) = values.split_at(outputs.rates.len());
        [pin, places, rates, own_rates, accelerations, &forces_on_pin, &torque].concat()
    }
}

/// Whether a dent in a bush is left, or taken up again, between these modes.
pub(super) fn relaxes(before: Mode, after: Mode) -> bool {
    [before, after].iter().any(|mode| matches!(mode, Mode::Relaxing(_)))
}

impl Problem for Block {
    fn name(&self) -> String {
        part_name(self)
    }

    fn check(&self) -> Result<(), Error> {
        if self.sliding.bristles().is_some() {
            let reason = "the bristles of lugre are a state that a block does not have; integrate the part \
                          that `Joints::from` makes of it";
            return Err(Error::Refused { reason: reason.to_owned() });
        }
        self.check_load()
    }

    fn start(&self) -> State<f64> {
        self.initial_state()
    }

    fn states(&self) -> Vec<Quantity> {
        joint_quantities(self.scale()).collect()
    }

    fn groups(&self) -> Vec<Group> {
        joint_groups(self, 0, 0).into()
    }

    fn role(&self, mode: &Mode, _site: usize) -> Role {
        role(*mode)
    }

    fn code(&self, mode: &Mode, _site: usize) -> i8 {
        mode.code()
    }

    /// Free apart and free relaxing are one mode.
    fn is_counted(&self, before: &Mode, after: &Mode, _site: usize) -> bool {
        before.code() != after.code()
    }

    fn starts_on_surface(&self) -> bool {
        self.starts_in_contact()
    }

    fn unit_of_time(&self) -> f64 {
        self.body_time()
    }

    fn touch<S: Real>(&self, mode: &Mode, _t: S, y: &State<S>, _site: usize) -> Option<Touch<S>> {
        touch(self, *mode, y)
    }

    fn energies(&self, mode: &Mode, _t: f64, y: &State<f64>) -> Option<Energy> {
        Some(self.energy(*mode, y))
    }

    fn powers(&self, mode: &Mode, _t: f64, y: &State<f64>) -> Option<Power> {
        Some(self.power(*mode, y))
    }

    fn drive_work(&self, y0: &State<f64>, y1: &State<f64>) -> Option<f64> {
        match &self.body {
            Body::Struts(_) => Some(self.torque * (y1[2] - y0[2])),
            // A pin that is held follows the crank through steps that no quadrature resolves.
            Body::Linkage(linkage) => {
                (self.clearance == 0.0).then(|| linkage.kinetic(y1) - linkage.kinetic(y0))
            }
        }
    }

    /// Contact modes by their codes, as the files have them.
    fn mode_name(&self, mode: &Mode, _site: usize) -> String {
        mode.code().to_string()
    }

    fn labels(&self, _site: usize) -> Vec<(&'static str, usize)> {
        vec![("bay", 1), ("joint", self.joint)]
    }

    fn columns(&self, _site: usize) -> Vec<Quantity> {
        self.motion_columns()
    }

    fn rows(&self, mode: &Mode, _t: f64, y: &State<f64>, row: &mut dyn FnMut(usize, &[f64])) {
        row(0, &self.motion_row(*mode, y, self.forces(*mode, y, &self.pose(y))));
    }

    fn in_brief(&self, y: &State<f64>) -> String {
        format!("theta = {:.6e} rad", y[2])
    }

    fn end_name(&self) -> EndName {
        REACHED_90
    }

    fn begins_at_speed_floor(&self, before: &Mode, after: &Mode) -> bool {
        self.begins_at_floor(*before, *after)
    }

    fn out_of_stiffness(&self) -> &'static str {
        out_of_stiffness(self)
    }

    fn takes_energy(&self, before: &Mode, after: &Mode) -> bool {
        relaxes(*before, *after)
    }

    fn laws(&self) -> Laws {
        laws(self)
    }

    /// In the paper's order.
    fn spread(&self, each: &[f64], all: &mut [f64]) {
        if let Ok(each) = each.try_into() {
            all.copy_from_slice(&self.in_paper_order(each));
        }
    }

    fn judged(
        &self,
        outcome: Result<Outcome, Error>,
        t: f64,
        mode: &Mode,
        y: &State<f64>,
    ) -> Result<Outcome, Error> {
        self.range_judged(outcome, t, *mode, y)
    }

    fn has_blind_runs(&self) -> bool {
        true
    }

    fn mode_read(&self, _mode: &Mode, t: f64, y: &State<f64>) -> Mode {
        self.mode_of_state(t, y)
    }

    fn integrate_blind(
        &self,
        setting: &Setting,
        y0: State<f64>,
        t_end: f64,
        record: &mut dyn Record<Self>,
    ) -> OwnRun<Self> {
        blind(self, setting, y0, t_end, record)
    }

    fn runs_at_once(&self) -> bool {
        self.parameters(&Mode::SlipPlus(contact::Onset::PLAIN)).is_some()
    }

    fn integrate_at_once(
        runs: &[Begun<'_, Self>],
        setting: &Setting,
        t_end: f64,
        records: &mut [&mut dyn Record<Self>],
    ) -> Vec<OwnRun<Self>> {
        at_once(runs, setting, t_end, records)
    }

    fn integrate_extended(
        &self,
        rtol: f64,
        y0: State<f64>,
        t_end: f64,
        record: &mut dyn Record<Self>,
    ) -> OwnRun<Self> {
        extended(self, rtol, y0, t_end, record)
    }
}

impl Jointed for Block {
    fn block(&self) -> &Block {
        self
    }

    fn joint_mode(mode: &Mode, _k: usize) -> Mode {
        *mode
    }

    fn integrate(
        &self,
        setting: &Setting,
        y0: State<f64>,
        t_end: f64,
        record: &mut dyn Record<Self>,
    ) -> OwnRun<Self> {
        integrate(self, setting, y0, t_end, record)
    }
}

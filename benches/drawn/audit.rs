//! What every run must hold to, however far it is predictable: its states are those of its modes, and no law gives
//! energy that only takes it.

use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use deltazero::model::{Jointed, Mode};
use deltazero_solvers::{Accepted, Event, Method, Next, Record};
use deltazero_study::run::Limits;
use deltazero_study::selection::work;

/// Where a step is looked at, in parts of it.
const NODES: [f64; 4] = [0.25, 0.5, 0.75, 1.0];

/// The farthest that a run went astray, each as a part of what is usual in it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Audit {
    /// Penetration while apart, in clearances.
    pub(crate) in_bush: f64,
    /// Distance while in contact, in clearances.
    pub(crate) off_bush: f64,
    /// Pull in a contact without adhesion, as the penetration that makes such a force, in clearances.
    pub(crate) pull: f64,
    /// Speed against the sign of a slip, of the largest sliding speed.
    pub(crate) against: f64,
    /// Speed while sticking, likewise.
    pub(crate) creep: f64,
    /// Energy that damping or hysteresis gave, of the energy that went through the run.
    pub(crate) normal_gave: f64,
    /// Energy that friction gave which acts as a force and a torque, likewise.
    pub(crate) friction_gave: f64,
    /// Deepest penetration, in clearances.
    pub(crate) deepest: f64,
    /// Largest force [N].
    pub(crate) force: f64,
    /// Least speed at which a contact began [m/s]; zero of a run without any.
    pub(crate) slowest: f64,
}

impl Audit {
    /// Each with its name.
    pub(crate) fn all(&self) -> [(&'static str, f64); 7] {
        [
            ("in the bush while free, of c", self.in_bush),
            ("off the bush in contact, of c", self.off_bush),
            ("pull without adhesion, as a depth, of c", self.pull),
            ("slips against its sign, of the peak speed", self.against),
            ("creeps while it sticks, of the peak speed", self.creep),
            ("the normal law gave energy, of all", self.normal_gave),
            ("friction gave energy, of all", self.friction_gave),
        ]
    }
}

/// A recorder of an [`Audit`].
pub(crate) struct Auditor<'a, P> {
    part: &'a P,
    /// Bristles give back what bends them, and a contact that pulls has its friction the other way round.
    friction_takes: bool,
    seen: Audit,
    speed: f64,
}

impl<'a, P: Jointed> Auditor<'a, P> {
    pub(crate) fn new(part: &'a P) -> Self {
        let block = part.block();
        let friction_takes = block.reading.tangential_force != 0.0
            && block.sliding.bristles().is_none()
            && !block.normal.adhesion;
        Self { part, friction_takes, seen: Audit::default(), speed: 0.0 }
    }

    /// What it saw of a run through which this energy went [J].
    pub(crate) fn audit(&self, energy: f64) -> Audit {
        let part = |x: f64, of: f64| if x == 0.0 { 0.0 } else { x / of };
        let seen = self.seen;
        Audit {
            // By the run's secant stiffness, so that an error is small where a contact is shallow.
            pull: part(seen.pull, seen.force) * seen.deepest,
            against: part(seen.against, self.speed),
            creep: part(seen.creep, self.speed),
            normal_gave: part(seen.normal_gave, energy),
            friction_gave: part(seen.friction_gave, energy),
            ..seen
        }
    }

    /// Looks at one state, which stands for `dt` [s].
    fn look(&mut self, mode: &P::Mode, y: &P::State<f64>, dt: f64) {
        let block = self.part.block();
        let mut loss = 0.0;
        for k in 0..self.part.n_sites() {
            let (mode, y) = (P::joint_mode(mode, k), self.part.joint_state(y.as_ref(), k));
            if mode == Mode::Pinned {
                continue;
            }
            let pose = block.pose(&y);
            let depth = pose.delta / block.clearance;
            let seen = &mut self.seen;
            if mode == Mode::Apart {
                seen.in_bush = seen.in_bush.max(depth);
            }
            let (Some(onset), true) = (mode.onset(), mode.is_contact()) else { continue };
            let (force, v_t) =
                (block.normal.force(pose.delta, pose.delta_dot, onset), block.v_t(&pose, &y));
            seen.off_bush = seen.off_bush.max(-depth);
            seen.deepest = seen.deepest.max(depth);
            seen.force = seen.force.max(force.abs());
            self.speed = self.speed.max(v_t.abs());
            if !block.normal.adhesion {
                seen.pull = seen.pull.max(-force);
            }
            match mode.sigma() {
                Some(sigma) => seen.against = seen.against.max(-sigma * v_t),
                None => seen.creep = seen.creep.max(v_t.abs()),
            }
            let own = block.normal.loss(pose.delta, pose.delta_dot, onset);
            seen.normal_gave += dt * (-own).max(0.0);
            loss += own;
        }
        if self.friction_takes {
            // A joint knows no time.
            let friction = self.part.powers(mode, 0.0, y).unwrap_or_default().dissipated() - loss;
            self.seen.friction_gave += dt * (-friction).max(0.0);
        }
    }
}

impl<P: Jointed> Record<P> for Auditor<'_, P> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        let step = accepted.step;
        let h = step.t1() - step.t0();
        let mut y = step.y0().clone();
        for node in NODES {
            let t = if node == 1.0 { step.t1() } else { step.t0() + node * h };
            step.interpolate(t, &mut y);
            self.look(&accepted.mode, &y, h / NODES.len() as f64);
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        let Next::Mode(after) = &event.after else { return ControlFlow::Continue(()) };
        for k in 0..self.part.n_sites() {
            let [before, after] = [&event.before, after].map(|mode| P::joint_mode(mode, k));
            if after.is_contact() && !before.is_contact() {
                let pose = self.part.block().pose(&self.part.joint_state(event.y.as_ref(), k));
                let (speed, slowest) = (pose.delta_dot.abs(), &mut self.seen.slowest);
                *slowest = if *slowest == 0.0 { speed } else { slowest.min(speed) };
            }
        }
        ControlFlow::Continue(())
    }
}

/// What a run may cost.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget {
    /// [`work`] of a joint, and one for each step and event: the same on every machine.
    pub(crate) work: f64,
    /// Time for what no count foresees [s].
    pub(crate) wall_s: f64,
}

impl Budget {
    /// The same as limits of a run of whatever part.
    pub(crate) fn limits(self, stop: &AtomicBool) -> Limits<'_> {
        Limits { max_rhs: self.work as u64, max_seconds: self.wall_s, stop }
    }
}

/// A recorder that ends a run at its budget.
pub(crate) struct Meter {
    method: &'static Method,
    rtol: Option<f64>,
    n_joints: f64,
    budget: Budget,
    start: Instant,
    /// Work done.
    pub(crate) work: f64,
}

impl Meter {
    pub(crate) fn new(
        method: &'static Method,
        rtol: Option<f64>,
        n_joints: usize,
        budget: Budget,
    ) -> Self {
        let (n_joints, start) = (n_joints as f64, Instant::now());
        Self { method, rtol, n_joints, budget, start, work: 0.0 }
    }

    /// Whether work ended it; else time did.
    pub(crate) fn is_worked_out(&self) -> bool {
        self.work > self.budget.work
    }
}

impl<P: Jointed> Record<P> for Meter {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        let stats = accepted.stats;
        let steps = stats.n_accepted + stats.n_rejected + stats.n_retaken + stats.n_events;
        // Rejected series are in no count of right-hand sides.
        let steps = 10.0 * steps as f64;
        self.work = self.n_joints * (work(self.method, self.rtol, &stats.work) + steps);
        let is_late = self.start.elapsed().as_secs_f64() > self.budget.wall_s;
        if self.is_worked_out() || is_late {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

//! The run of one part: the integration, timed.

use deltazero_solvers::taylor::ExtendedIntegration;
use deltazero_solvers::{
    Blind, Error, Integration, ModeOfState, Outcome, Real as _, Record, Stats, System, Tolerance,
    Unblind,
};

use super::stopwatch::{Stopwatch, Took};
use super::{BlockTrajectory, Setting};
use crate::config::Events;
use crate::model::{Block, Chain, Jointed, Mode, State};

/// What became of one part.
#[derive(Clone, Debug)]
pub struct PartRun<Y = State<f64>, M = Mode> {
    /// The number of its joint, 1 or 2, whatever the bay.
    pub joint: usize,
    /// How it ended.
    pub outcome: Result<Outcome, Error>,
    /// Time of the last accepted step [s].
    pub t: f64,
    /// State there.
    pub y: Y,
    /// Mode there.
    pub mode: M,
    /// Work; an evaluation of the right-hand side is one of all joints of the part.
    pub stats: Stats,
    /// Time that the integration took.
    pub took: Took,
}

/// What became of one block.
pub type BlockRun = PartRun;

/// What became of a part, states and modes joint by joint.
pub type JointsRun = PartRun<Vec<State<f64>>, Vec<Mode>>;

/// What became of a part, in its own states and modes.
pub type OwnRun<P> = PartRun<<P as System>::State<f64>, <P as System>::Mode>;

impl<Y, M> PartRun<Y, M> {
    /// When θ reached 90° [s], if it did.
    pub fn reached_90(&self) -> Option<f64> {
        (self.outcome == Ok(Outcome::Stopped)).then_some(self.t)
    }

    /// The joint, from zero, that an error of a run of `part` is about, where it is about one.
    pub fn failed_joint<P: Jointed<State<f64> = Y, Mode = M>>(&self, part: &P) -> Option<usize> {
        match self.outcome.as_ref().err()? {
            _ if part.n_joints() == 1 => Some(0),
            Error::NonFinite { component, .. } => Some(part.joint_of_component(*component)),
            Error::NonFiniteGuard { guard, .. } | Error::Chatter { guard, .. } => {
                Some(P::joint_of_guard(*guard))
            }
            Error::OutsideModel { .. } => Some(part.nearest_end(&self.mode, &self.y)),
            _ => None,
        }
    }

    /// The same with states and modes joint by joint.
    pub fn by_joint<P: Jointed<State<f64> = Y, Mode = M>>(self, part: &P) -> JointsRun {
        PartRun {
            joint: self.joint,
            outcome: self.outcome,
            t: self.t,
            y: part.joint_states(&self.y),
            mode: part.joint_modes(&self.mode),
            stats: self.stats,
            took: self.took,
        }
    }
}

/// What [`integrate`] takes: a block, or a chain.
pub trait Integrable: Jointed {
    /// Integrates it blind; see [`integrate`].
    fn integrate_blind(
        &self,
        setting: &Setting,
        y0: Self::State<f64>,
        t_end: f64,
        record: &mut dyn Record<Self>,
    ) -> OwnRun<Self>;

    /// Integrates it in extended precision; located, by Taylor series over pairs of f64 at the relative
    /// tolerance `rtol`, the absolute ones `rtol` times the scale of each state.
    fn integrate_extended(
        &self,
        rtol: f64,
        y0: Self::State<f64>,
        t_end: f64,
        record: &mut dyn Record<Self>,
    ) -> OwnRun<Self>;
}

impl Integrable for Block {
    fn integrate_blind(
        &self,
        setting: &Setting,
        y0: State<f64>,
        t_end: f64,
        record: &mut dyn Record<Self>,
    ) -> BlockRun {
        let watch = Stopwatch::start();
        let blind = Blind(self);
        let mut run = Integration::new(&blind, 0.0, y0);
        let mut record = Unblind::new(self, 0.0, &y0, record);
        let outcome = self.check().and_then(|()| {
            let mut solver = setting.method.solver(&blind, setting.control(self))?;
            run.run(t_end, &mut *solver, &mut record)
        });
        let mode = self.mode_of_state(run.point.t, &run.point.y);
        let end = Point { t: run.point.t, y: run.point.y, mode };
        finished(self, end, run.stats, outcome, watch.took())
    }

    fn integrate_extended(
        &self,
        rtol: f64,
        y0: State<f64>,
        t_end: f64,
        record: &mut dyn Record<Self>,
    ) -> BlockRun {
        let watch = Stopwatch::start();
        let atol = self.scale().map(|scale| rtol * scale).to_vec();
        let mut run = ExtendedIntegration::new(self, 0.0, &y0, Tolerance { rtol, atol });
        let outcome = self.check().and_then(|()| run.run(t_end, record));
        let end = Point { t: run.t.value(), y: run.rounded(), mode: run.mode };
        finished(self, end, run.stats, outcome, watch.took())
    }
}

/// A chain runs in f64 with its events located: the other two would be a second and a third copy of every
/// method, for what one bay has shown.
impl Integrable for Chain {
    fn integrate_blind(
        &self,
        _: &Setting,
        y0: Vec<f64>,
        _: f64,
        _: &mut dyn Record<Self>,
    ) -> OwnRun<Self> {
        not_built(self, y0, "no blind run of a chain, or of bristles; use events = \"located\"")
    }

    fn integrate_extended(
        &self,
        _: f64,
        y0: Vec<f64>,
        _: f64,
        _: &mut dyn Record<Self>,
    ) -> OwnRun<Self> {
        not_built(self, y0, "no extended precision of a chain, or of bristles; use f64")
    }
}

/// A run of `part` that there is not.
fn not_built<P: Jointed>(part: &P, y0: P::State<f64>, reason: &str) -> OwnRun<P> {
    let mode = part.initial_mode(0.0, &y0);
    let error =
        Error::OutsideModel { t: 0.0, mode: format!("{mode:?}"), reason: reason.to_owned() };
    let end = Point { t: 0.0, y: y0, mode };
    finished(part, end, Stats::default(), Err(error), Took::default())
}

/// Where a run ended.
struct Point<Y, M> {
    t: f64,
    y: Y,
    mode: M,
}

fn finished<P: Jointed>(
    part: &P,
    end: Point<P::State<f64>, P::Mode>,
    stats: Stats,
    outcome: Result<Outcome, Error>,
    took: Took,
) -> OwnRun<P> {
    let Point { t, y, mode } = end;
    let (block, k) = (part.block(), part.nearest_end(&mode, &y));
    let outcome = block.judged(outcome, t, P::joint_mode(&mode, k), &part.joint_state(&y, k));
    PartRun { joint: block.joint, outcome, t, y, mode, stats, took }
}

/// Integrates `part` from `y0` at t = 0 to `t_end`, shown to `record`.
///
/// The one stopwatch is here: [`PartRun::took`] is the time of the integration with its recorder.
pub fn integrate<P: Integrable>(
    part: &P,
    setting: &Setting,
    y0: P::State<f64>,
    t_end: f64,
    record: &mut dyn Record<P>,
) -> OwnRun<P> {
    if setting.events == Events::Blind {
        return part.integrate_blind(setting, y0, t_end, record);
    }
    let watch = Stopwatch::start();
    let mut run = Integration::new(part, 0.0, y0);
    let outcome = part.check().and_then(|()| {
        let mut solver = setting.method.solver(part, setting.control(part))?;
        run.run(t_end, &mut *solver, record)
    });
    ended(part, run, outcome, watch.took())
}

/// What became of an integration that took so long.
fn ended<P: Jointed>(
    part: &P,
    run: Integration<'_, P>,
    outcome: Result<Outcome, Error>,
    took: Took,
) -> OwnRun<P> {
    let end = Point { t: run.point.t, y: run.point.y, mode: run.point.mode };
    finished(part, end, run.stats, outcome, took)
}

/// Integrates two joints as [`integrate`] does, with the same bits, [both at once](Method::run_pair) where events
/// are located and the method [can](Method::is_for_pairs); the time is shared between them.
///
/// What compares methods runs one joint after the other: how well two of them overlap is none of a method's merits.
pub fn integrate_pair<R: Record<Block>>(
    blocks: [&Block; 2],
    setting: &Setting,
    t_end: f64,
    records: [&mut R; 2],
) -> [BlockRun; 2] {
    let starts = blocks.map(Block::initial_state);
    if setting.events == Events::Blind || blocks.iter().any(|block| block.check().is_err()) {
        let [first, second] = records;
        return [
            integrate(blocks[0], setting, starts[0], t_end, first),
            integrate(blocks[1], setting, starts[1], t_end, second),
        ];
    }
    let watch = Stopwatch::start();
    let controls = blocks.map(|block| setting.control(block));
    let mut runs = [0, 1].map(|i| Integration::new(blocks[i], 0.0, starts[i]));
    let [first, second] = &mut runs;
    let ends = setting.method.run_pair([first, second], t_end, controls.each_ref(), records);
    let [end_1, end_2] = ends.unwrap_or_else(|error| [Err(error.clone()), Err(error)]);
    let (share, [run_1, run_2]) = (watch.took().share(2), runs);
    [ended(blocks[0], run_1, end_1, share), ended(blocks[1], run_2, end_2, share)]
}

/// Integrates `block` as [`integrate`] does from each of `starts`, with the same bits, each into the
/// trajectory of its place: located runs by [several at once](Method::run_many), the time shared among them.
///
/// # Panics
/// Where there are fewer trajectories than starts.
pub fn integrate_many(
    block: &Block,
    setting: &Setting,
    starts: &[State<f64>],
    t_end: f64,
    trajectories: &mut [BlockTrajectory],
) -> Vec<BlockRun> {
    assert!(trajectories.len() >= starts.len(), "a trajectory for each start is needed");
    let watch = Stopwatch::start();
    let mut runs: Vec<_> = starts.iter().map(|y| Integration::new(block, 0.0, *y)).collect();
    let control = setting.control(block);
    let ends = match setting.events {
        Events::Located => block
            .check()
            .and_then(|()| setting.method.run_many(&mut runs, t_end, &control, trajectories)),
        Events::Blind => {
            let pairs = starts.iter().zip(trajectories);
            return pairs.map(|(y, record)| integrate(block, setting, *y, t_end, record)).collect();
        }
    };
    let ends = ends.unwrap_or_else(|error| vec![Err(error); runs.len()]);
    let share = watch.took().share(runs.len());
    let pairs = runs.into_iter().zip(ends);
    pairs.map(|(run, outcome)| ended(block, run, outcome, share)).collect()
}

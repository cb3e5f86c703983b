//! Golden runs, and runs to compare with them.
#![allow(dead_code, unreachable_pub, missing_docs, reason = "each test target uses its part")]
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

use std::sync::atomic::AtomicBool;

use deltazero::config::Config;
use deltazero::model::struts::chain_of;
use deltazero::model::{Chain, Jointed, Joints, Part, State};
use deltazero::run::{Run, mode_changes, trajectories, without_start};
use deltazero_solvers::{Grid, Method, Trajectory};
use deltazero_study::Problem as _;
use deltazero_study::energy_balance::{Balance, EnergyBalance};
use deltazero_study::errors::{ErrorScale, EventMatch, match_events, worse};
use deltazero_study::run::{Accuracy, Limits, ModeChange, Setting, integrate};
use deltazero_study::setting::Events;
use deltazero_study::trace::OwnTrajectory;
use deltazero_study::warning::Warning;

/// A golden run: states and mode changes of each joint, in the paper's order of coordinates.
pub struct Golden {
    pub states: [Vec<(f64, i8, State<f64>)>; 2],
    pub events: [Vec<ModeChange>; 2],
}

impl Golden {
    pub fn read(name: &str) -> Self {
        let mut golden = Self { states: Default::default(), events: Default::default() };
        for [joint, t, mode, y @ ..] in rows::<9>(&format!("{name}.csv")) {
            golden.states[joint as usize - 1].push((t, mode as i8, y));
        }
        for [joint, t, before, after] in rows::<4>(&format!("{name}.events.csv")) {
            let change = ModeChange::new(t, before as i8, after as i8);
            golden.events[joint as usize - 1].push(change);
        }
        golden
    }

    /// `e` of a run on the golden grid, and its events against the golden ones, joint by joint.
    pub fn compare(&self, mechanism: &Joints, run: &Run) -> (f64, [EventMatch; 2]) {
        let states = || self.states.iter().flatten();
        let theta = states().fold(0.0_f64, |most, (_, _, y)| most.max(y[2].abs()));
        let mut e = 0.0_f64;
        let mut matches = [EventMatch::default(); 2];
        for (i, trajectory) in run.trajectories.iter().enumerate() {
            let block = &mechanism.blocks()[i];
            let scale = block.error_scale(theta);
            assert_eq!(trajectory.samples.len(), self.states[i].len());
            for (sample, (t, mode, golden)) in trajectory.samples.iter().zip(&self.states[i]) {
                assert!((sample.t - t).abs() < 1e-12);
                assert_eq!(sample.mode.code(), *mode, "joint {} at {t} s", i + 1);
                let own = scale.error(&block.in_paper_order(&sample.y), golden);
                assert!(own.is_finite());
                e = e.max(own);
            }
            let changes = mode_changes(trajectory);
            let [own, golden] =
                [&changes, &self.events[i]].map(|events| without_start(*block, events));
            matches[i] = match_events(own, golden, scale.event_window);
        }
        (e, matches)
    }
}

/// The golden run of a chain: the states and the mode changes of each bay.
pub struct GoldenChain {
    pub states: Vec<Vec<(f64, i8, State<f64>)>>,
    pub events: Vec<Vec<ModeChange>>,
}

impl GoldenChain {
    pub fn read(name: &str, bays: usize) -> Self {
        let mut golden = Self { states: vec![Vec::new(); bays], events: vec![Vec::new(); bays] };
        for [bay, t, mode, y @ ..] in rows::<9>(&format!("{name}.csv")) {
            golden.states[bay as usize - 1].push((t, mode as i8, y));
        }
        for [bay, t, before, after] in rows::<4>(&format!("{name}.events.csv")) {
            let change = ModeChange::new(t, before as i8, after as i8);
            golden.events[bay as usize - 1].push(change);
        }
        golden
    }

    /// `e` of a run on the golden grid, and its events against the golden ones, bay by bay.
    pub fn compare(&self, chain: &Chain, run: &OwnTrajectory<Chain>) -> (f64, Vec<EventMatch>) {
        let states = || self.states.iter().flatten();
        let theta = states().fold(0.0_f64, |most, (_, _, y)| most.max(y[2].abs()));
        let scale = chain.bay.error_scale(theta);
        let mut e = 0.0_f64;
        let bays = trajectories(chain, run);
        for (k, (own, golden)) in bays.iter().zip(&self.states).enumerate() {
            assert_eq!(own.samples.len(), golden.len());
            for (sample, (t, mode, golden)) in own.samples.iter().zip(golden) {
                assert!((sample.t - t).abs() < 1e-12);
                assert_eq!(sample.mode.code(), *mode, "bay {} at {t} s", k + 1);
                e = e.max(scale.error(&sample.y, golden));
            }
        }
        let pairs = bays.iter().map(mode_changes).zip(&self.events);
        (
            e,
            pairs
                .map(|(own, golden)| {
                    let [own, golden] = [&own, golden].map(|events| without_start(chain, events));
                    match_events(own, golden, scale.event_window)
                })
                .collect(),
        )
    }
}

fn rows<const N: usize>(file: &str) -> Vec<[f64; N]> {
    let path = format!("{}/tests/golden/{file}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let row = |line: &str| -> [f64; N] {
        let fields: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        fields.try_into().unwrap()
    };
    text.lines().skip(1).map(row).collect()
}

pub fn config(sets: &[&str]) -> Config {
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    Config::load(None, &sets).unwrap()
}

pub fn setting(method: &str, events: Events, accuracy: Accuracy) -> Setting {
    Setting { method: Method::named(method).unwrap(), events, accuracy }
}

pub fn located(method: &str, rtol: f64) -> Setting {
    setting(method, Events::Located, Accuracy::Rtol(rtol, None))
}

/// The blocks of a configuration, sampled as it asks.
pub fn run(config: &Config, setting: &Setting) -> (Joints, Run) {
    let mechanism = Joints::from(config);
    let t_end = config.run.t_end;
    let limits =
        Limits { max_rhs: u64::MAX, max_seconds: f64::INFINITY, stop: &AtomicBool::new(false) };
    let run =
        Run::new(&mechanism, setting, t_end, &Grid::uniform(config.run.sample, t_end), limits);
    (mechanism, run)
}

/// The energy balance of a run, all parts together.
pub fn balance(config: &Config, setting: &Setting) -> Balance {
    audited(config, setting).0
}

/// The same with what the run tells of itself.
pub fn audited(config: &Config, setting: &Setting) -> (Balance, Vec<Warning>) {
    fn of<P: Jointed>(part: &P, config: &Config, setting: &Setting) -> (Balance, Vec<Warning>) {
        let y0 = part.start();
        let mut record = EnergyBalance::new(part, setting.events, &y0);
        let run = integrate(part, setting, y0, config.run.t_end, &mut record);
        assert!(run.outcome.is_ok(), "{:?}", run.outcome);
        (record.at(&run.mode, run.t, &run.y).unwrap(), record.check.warnings(setting.rtol()))
    }
    let (mut sum, mut warnings) = (Balance::default(), Vec::new());
    for part in &Joints::from(config).parts {
        let (balance, own) = match part {
            Part::Block(block) => of(block, config, setting),
            Part::Chain(chain) => of(chain, config, setting),
        };
        sum += balance;
        warnings.extend(own);
    }
    (sum, warnings)
}

/// `e` of two runs of one configuration, both sampled alike.
pub fn distance(one: &Run, other: &Run, scale: &ErrorScale) -> f64 {
    let joints = one.trajectories.iter().zip(&other.trajectories);
    let samples = joints.flat_map(|(one, other)| one.samples.iter().zip(&other.samples));
    samples.map(|(one, other)| scale.error(&one.y, &other.y)).fold(0.0, worse)
}

/// The chain of a configuration, sampled every 0.01 s.
pub fn run_chain(config: &Config, method: &str, rtol: f64) -> (Chain, OwnTrajectory<Chain>) {
    let chain = chain_of(config);
    let t_end = config.run.t_end;
    let mut trajectory = Trajectory::on(Grid::uniform(0.01, t_end));
    let run = integrate(&chain, &located(method, rtol), chain.start(), t_end, &mut trajectory);
    assert!(run.outcome.is_ok(), "{:?}", run.outcome);
    (chain, trajectory)
}

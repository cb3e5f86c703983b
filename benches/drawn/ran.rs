//! One run of a part, with all that is asked of it.

use deltazero::model::{Block, Jointed, State};
use deltazero::run::{mode_changes, trajectories};
use deltazero_solvers::{Error, Grid, Outcome, Trajectory};
use deltazero_study::energy_balance::{Balance, EnergyBalance};
use deltazero_study::errors::worse;
use deltazero_study::part::Start;
use deltazero_study::run::{ModeChange, Setting, integrate};

use super::audit::{Audit, Auditor, Budget, Meter};

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum End {
    /// At the end of its time.
    Finished,
    /// At 90°.
    Stopped,
    /// Where the model ends.
    Refused(String),
    /// By an error.
    Failed(String),
    /// At its budget, by work or by time.
    Cut(&'static str),
}

/// One joint of a run.
#[derive(Clone, Debug)]
pub(crate) struct OwnRan {
    /// Times and states.
    pub(crate) samples: Vec<(f64, State<f64>)>,
    /// Its mode changes.
    pub(crate) events: Vec<ModeChange>,
    /// The mode that it starts in.
    pub(crate) first: i8,
}

/// One run of a part.
#[derive(Clone, Debug)]
pub(crate) struct Ran {
    pub(crate) method: &'static str,
    pub(crate) end: End,
    /// Its last time [s].
    pub(crate) t: f64,
    pub(crate) joints: Vec<OwnRan>,
    pub(crate) balance: Balance,
    pub(crate) audit: Audit,
    /// Right-hand sides that it was worth.
    pub(crate) work: f64,
}

impl Ran {
    /// Runs `part` from its start, or from one that is changed in its last bit.
    pub(crate) fn new<P: Jointed>(
        part: &P,
        setting: &Setting,
        start: Start,
        (t_end, sample): (f64, f64),
        budget: Budget,
    ) -> Self {
        let y0 = start.of(part);
        let trajectory = Trajectory::on(Grid::uniform(sample, t_end));
        let balance = EnergyBalance::new(part, setting.events, &y0);
        let meter = Meter::new(setting.method, setting.rtol(), part.n_sites(), budget);
        let mut record = ((trajectory, meter), (balance, Auditor::new(part)));
        let run = integrate(part, setting, y0.clone(), t_end, &mut record);
        let ((trajectory, meter), (balance, auditor)) = record;
        let balance = balance.at(&run.mode, run.t, &run.y).unwrap_or_default();
        let end = match &run.outcome {
            Ok(Outcome::Finished) => End::Finished,
            Ok(Outcome::Stopped) => End::Stopped,
            Ok(Outcome::Interrupted) if meter.is_worked_out() => End::Cut("work"),
            Ok(Outcome::Interrupted) => End::Cut("time"),
            Err(error @ (Error::OutsideModel { .. } | Error::Refused { .. })) => {
                End::Refused(error.to_string())
            }
            Err(error) => End::Failed(error.to_string()),
        };
        let start = part.initial_mode(0.0, &y0);
        let joints = trajectories(part, &trajectory).into_iter().enumerate();
        let joint = |(k, own): (usize, deltazero::run::BlockTrajectory)| OwnRan {
            events: mode_changes(&own),
            samples: own.samples.into_iter().map(|sample| (sample.t, sample.y)).collect(),
            first: P::joint_mode(&start, k).code(),
        };
        let energy = energy_of(&balance);
        Self {
            method: setting.method.name,
            end,
            t: run.t,
            joints: joints.map(joint).collect(),
            balance,
            audit: auditor.audit(energy),
            work: meter.work,
        }
    }

    /// Whether it came as far as it should.
    pub(crate) fn is_complete(&self) -> bool {
        matches!(self.end, End::Finished | End::Stopped)
    }

    /// Largest |θ| of the samples [rad].
    pub(crate) fn largest_angle(&self) -> f64 {
        let angles = self.joints.iter().flat_map(|own| &own.samples).map(|(_, y)| y[2].abs());
        angles.fold(f64::MIN_POSITIVE, f64::max)
    }

    /// Whether all samples are numbers.
    pub(crate) fn is_finite(&self) -> bool {
        let mut samples = self.joints.iter().flat_map(|own| &own.samples);
        samples.all(|(_, y)| y.iter().all(|y| y.is_finite()))
    }
}

/// What went through a run at least [J].
pub(crate) fn energy_of(balance: &Balance) -> f64 {
    let Balance { work, kinetic, elastic, dissipated, .. } = *balance;
    work.abs().max(kinetic + elastic).max(dissipated.abs()).max(f64::MIN_POSITIVE)
}

/// How far a run is predictable: what a change of its start in the last bit grows to.
pub(crate) struct Growth {
    /// The largest `e` so far at each sample, of all joints.
    grown: Vec<f64>,
    times: Vec<f64>,
    /// The last time of both runs, where they end apart [s]; else infinite.
    end: f64,
}

impl Growth {
    /// From a run and one that was nudged.
    pub(crate) fn new(a: &Ran, b: &Ran, block: &Block) -> Self {
        let scale = block.error_scale(a.largest_angle());
        let (mut grown, mut times) = (Vec::new(), Vec::new());
        for (own, other) in a.joints.iter().zip(&b.joints) {
            for (i, ((t, y), (_, z))) in own.samples.iter().zip(&other.samples).enumerate() {
                if i == grown.len() {
                    grown.push(0.0);
                    times.push(*t);
                }
                grown[i] = worse(grown[i], scale.error(z, y));
            }
        }
        Self::of(times, grown, [a.t, b.t], a.end != b.end)
    }

    /// From the errors of two runs at these times, of which the last ones are `ends` [s]; they end apart also where they do so
    /// in different ways.
    pub(crate) fn of(
        times: Vec<f64>,
        mut grown: Vec<f64>,
        [a, b]: [f64; 2],
        is_other_end: bool,
    ) -> Self {
        let mut most = 0.0;
        for e in &mut grown {
            most = worse(most, *e);
            *e = most;
        }
        let ends_apart = is_other_end || (a - b).abs() > 1e-6 * a;
        Self { grown, times, end: if ends_apart { a.min(b) } else { f64::INFINITY } }
    }

    /// What has grown up to `t` [s].
    pub(crate) fn at(&self, t: f64) -> f64 {
        let n = self.times.partition_point(|own| *own <= t);
        self.grown[..n].last().copied().unwrap_or(0.0)
    }

    /// The last sample time at which it is no more than `e` [s]; infinite where it nowhere is more.
    pub(crate) fn until(&self, e: f64) -> f64 {
        let lost = self.grown.iter().position(|own| own.total_cmp(&e).is_gt());
        let last = lost.map(|i| if i == 0 { 0.0 } else { self.times[i - 1] });
        last.unwrap_or(f64::INFINITY).min(self.end)
    }
}

/// Two runs beside each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Apart {
    /// Largest `e` of the samples up to the horizon.
    pub(crate) e: f64,
    /// The same in units of what is allowed.
    pub(crate) of_allowed: f64,
    /// Time that they are in different modes [s].
    pub(crate) modes_s: f64,
    /// Difference of their last times, where both came to one [s].
    pub(crate) end_s: f64,
}

impl Apart {
    /// What lies between `a` and `b`: samples up to the horizon, where `allowed` of what has grown is allowed, modes and
    /// ends as long as no more than `steady` has.
    pub(crate) fn new(
        (a, b): (&Ran, &Ran),
        block: &Block,
        growth: &Growth,
        allowed: impl Fn(f64) -> f64,
        [horizon, steady]: [f64; 2],
    ) -> Self {
        let scale = block.error_scale(a.largest_angle().max(b.largest_angle()));
        let until = |most| growth.until(most).min(a.t).min(b.t);
        let mut apart = Self { e: 0.0, of_allowed: 0.0, modes_s: 0.0, end_s: 0.0 };
        for (own, other) in a.joints.iter().zip(&b.joints) {
            let pairs = own.samples.iter().zip(&other.samples).zip(&growth.grown);
            let within = pairs.take_while(|(((t, _), _), _)| *t <= until(horizon));
            for (((_, y), (_, z)), grown) in within {
                let e = scale.error(z, y);
                apart.e = worse(apart.e, e);
                apart.of_allowed = worse(apart.of_allowed, e / allowed(*grown));
            }
            apart.modes_s += differing(own, other, until(steady));
        }
        if a.is_complete() && b.is_complete() && a.t.min(b.t) <= until(steady) {
            apart.end_s = (a.t - b.t).abs();
        }
        apart
    }
}

/// How long the modes of two runs differ up to `until` [s].
fn differing(a: &OwnRan, b: &OwnRan, until: f64) -> f64 {
    let mut times: Vec<f64> = a.events.iter().chain(&b.events).map(|event| event.t).collect();
    times.retain(|t| *t < until);
    times.sort_by(f64::total_cmp);
    times.push(until);
    let mode = |own: &OwnRan, next: &mut usize, t: f64| {
        while own.events.get(*next).is_some_and(|event| event.t <= t) {
            *next += 1;
        }
        if *next == 0 { own.first } else { own.events[*next - 1].after }
    };
    let (mut last, mut sum, mut next) = (0.0, 0.0, [0, 0]);
    for t in times {
        let modes = (mode(a, &mut next[0], last), mode(b, &mut next[1], last));
        if modes.0 != modes.1 {
            sum += t - last;
        }
        last = t;
    }
    sum
}

//! Where a contest takes place: a mechanism, its time, and the reference that judges.

use std::sync::atomic::AtomicBool;

use crate::config::Config;
use crate::model::Mechanism;
use crate::reference::{Reference, ReferenceError, counted};
use crate::run::Limits;

/// A problem that is predictable for less than this is ill-posed \[[units of time](Arena::unit_s)\].
const ILL_POSED_BELOW: f64 = 0.2;

/// A mechanism with the time over which methods are compared on it.
#[derive(Clone, Debug)]
pub struct Arena {
    /// The mechanism.
    pub mechanism: Mechanism,
    /// The run that judges.
    pub reference: Reference,
    /// When states are compared [s].
    pub times: Vec<f64>,
    /// The end of the runs [s].
    pub t_end: f64,
    /// In what the mechanism's time is counted [s]: a second, or the turn of a crank.
    pub unit_s: f64,
    /// The time at which a change of the start's last bit is seen [s]; none where it is beyond the time
    /// looked at.
    pub horizon: Option<f64>,
    /// Events of the reference that count.
    pub n_events: usize,
    /// The longest that a run may take [s].
    pub max_seconds: f64,
}

impl Arena {
    /// The arena of a configuration: its whole run where that is predictable, else the first half of
    /// what is, states compared at `times` [s].
    ///
    /// Beyond the first half an error of the size of a tolerance is more and more the amplified error
    /// of the first steps: how good a method is shows before.
    ///
    /// # Errors
    /// [`ReferenceError`] where there is no reference.
    pub fn new(
        config: &Config,
        mut times: Vec<f64>,
        stop: &AtomicBool,
    ) -> Result<Self, ReferenceError> {
        let mechanism = Mechanism::new(config);
        let limits = Limits::of(config, stop);
        let mut t_end = config.run.t_end;
        let mut reference = Reference::new(&mechanism, t_end, &times, limits)?;
        let lost = reference.joints.iter().fold(f64::INFINITY, |least, b| least.min(b.lost_at));
        let horizon = lost.is_finite().then_some(lost);
        if let Some(horizon) = horizon {
            t_end = 0.5 * horizon;
            times.retain(|t| *t <= t_end);
            reference = Reference::new(&mechanism, t_end, &times, limits)?;
        }
        let n_events = n_counted(&mechanism, &reference);
        let unit_s = mechanism.blocks().first().map_or(1.0, |block| block.unit_of_time());
        let max_seconds = config.study.max_seconds;
        Ok(Self { mechanism, reference, times, t_end, unit_s, horizon, n_events, max_seconds })
    }

    /// Its first part with the first `most` events, up to a sample; itself where it has no more.
    pub fn with_at_most(mut self, most: usize) -> Self {
        let joints = self.mechanism.joints().into_iter().zip(&self.reference.joints);
        let events = joints.flat_map(|((_, block), own)| counted(&own.events, block));
        let mut at: Vec<f64> = events.map(|event| event.t).collect();
        at.sort_by(f64::total_cmp);
        let Some(last) = at.get(most) else {
            return self;
        };
        if let Some(&t_end) = self.times.iter().find(|t| *t >= last) {
            self.t_end = t_end;
            self.times.retain(|t| *t <= t_end);
            self.reference.cut(t_end);
            self.n_events = n_counted(&self.mechanism, &self.reference);
        }
        self
    }

    /// The time that a run covers, its parts added [s].
    pub(super) fn whole(&self) -> f64 {
        self.t_end * self.mechanism.parts.len() as f64
    }

    /// The reason why methods cannot be compared on it, where it is predictable for too short a time.
    pub fn ill_posed(&self) -> Option<String> {
        let least = ILL_POSED_BELOW * self.unit_s;
        let rounded = (1e6 * least).round() / 1e6;
        let is_short = self.horizon.is_some_and(|horizon| horizon < least);
        is_short.then(|| format!("predictable for less than {rounded} s"))
    }
}

/// The events of a reference that count.
fn n_counted(mechanism: &Mechanism, reference: &Reference) -> usize {
    let joints = mechanism.joints().into_iter().zip(&reference.joints);
    joints.map(|((_, block), own)| counted(&own.events, block).len()).sum()
}

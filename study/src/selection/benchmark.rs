//! Where methods are compared: a subject, its time, and the reference that judges.

use std::sync::atomic::AtomicBool;

use deltazero_solvers::Grid;

use crate::part::{Subject, Timing};
use crate::plan::sample_times;
use crate::quadrature::GAUSS;
use crate::reference::{PartReference, Reference, ReferenceError};
use crate::run::{Limits, Setting};

/// Where the first events alone are asked for, a reference is made of this part of the time first, then of twice as much, and
/// so on.
const FIRST_PART: f64 = 1.0 / 16.0;

/// A problem that is predictable for less than this is ill-posed \[[units of time](Subject::unit_of_time)\].
const ILL_POSED_BELOW: f64 = 0.2;

/// A subject with the time over which methods are compared on it.
#[derive(Clone, Debug)]
pub struct Benchmark {
    /// What is integrated.
    pub subject: Subject,
    /// The run that judges.
    pub reference: Reference,
    /// When states are compared [s].
    pub times: Vec<f64>,
    /// The end of the runs [s].
    pub t_end: f64,
    /// The time at which a change of the start's last bit is seen [s]; none where it is beyond the time
    /// looked at.
    pub horizon: Option<f64>,
    /// Events of the reference that count.
    pub n_events: usize,
    /// The longest that a run may take [s].
    pub max_seconds: f64,
    /// Why it is only a part of what was asked for, where no reference could be made of a longer one.
    pub no_longer: Option<ReferenceError>,
}

/// The shortest time over which a subject must be predictable [s].
fn least_horizon(subject: &Subject) -> f64 {
    ILL_POSED_BELOW * subject.unit_of_time()
}

impl Benchmark {
    /// The whole run of a subject to `t_end` [s] where that is predictable, else the first half of what is, states
    /// compared at `times` [s].
    ///
    /// Beyond the first half an error of the size of a tolerance is more and more the amplified error
    /// of the first steps: how good a method is shows before. Samples so far apart that none lies in that half tell the
    /// horizon no better than their distance: it is looked for again, with samples of its own.
    ///
    /// # Errors
    /// [`ReferenceError`] where there is no reference.
    pub fn new(
        subject: Subject,
        mut t_end: f64,
        mut times: Vec<f64>,
        limits: Limits<'_>,
    ) -> Result<Self, ReferenceError> {
        let mut reference = Reference::new(&subject, t_end, &times, limits)?;
        let mut lost = reference.lost_at();
        let least = least_horizon(&subject);
        let is_sampled = |times: &[f64], lost: f64| times.iter().any(|t| *t <= 0.5 * lost);
        while lost.is_finite() && lost >= least && !is_sampled(&times, lost) {
            times = sample_times(None, lost);
            reference = Reference::new(&subject, lost, &times, limits)?;
            lost = lost.min(reference.lost_at());
        }
        let horizon = lost.is_finite().then_some(lost);
        if let Some(horizon) = horizon {
            t_end = 0.5 * horizon;
            times.retain(|t| *t <= t_end);
            reference = Reference::new(&subject, t_end, &times, limits)?;
        }
        let (n_events, max_seconds) = (reference.n_events(), limits.max_seconds);
        Ok(Self {
            subject,
            reference,
            times,
            t_end,
            horizon,
            n_events,
            max_seconds,
            no_longer: None,
        })
    }

    /// The part of [`new`](Self::new) that has the first `most` events, up to a sample; all of it where there are no more.
    ///
    /// References are made of longer and longer parts of the time, until one is twice as long as those events take, or as
    /// the horizon: a horizon beyond would not end the comparison earlier. So a storm of events is not followed to the end of
    /// the run; a run with fewer events is made about twice. The one that judges is made of what is compared alone: how many
    /// impacts are told apart before they accumulate depends on how long a run is.
    ///
    /// Where the longer reference is lost before the end of a shorter one that was not, the shorter one is taken. The motion is
    /// predictable to its end: the method that showed it did not come to the end of the longer one within the limits, and two
    /// runs of another method parted by their own noise. So too where there is no longer one, and [`no_longer`](Self::no_longer)
    /// tells why.
    ///
    /// # Errors
    /// [`ReferenceError`] where there is no reference.
    pub fn of_first(
        subject: Subject,
        t_end: f64,
        times: Vec<f64>,
        limits: Limits<'_>,
        most: usize,
    ) -> Result<Self, ReferenceError> {
        let least = least_horizon(&subject);
        let (mut part, mut longest) = (FIRST_PART, None::<Self>);
        loop {
            let is_whole = part >= 1.0;
            let end = if is_whole { t_end } else { part * t_end };
            part *= 2.0;
            let own: Vec<f64> = times.iter().copied().filter(|t| *t <= end).collect();
            let own_end = if is_whole { Some(&t_end) } else { own.last() };
            let Some(&own_end) = own_end else { continue };
            let first = match Self::new(subject.clone(), own_end, own, limits) {
                Ok(first) => first,
                Err(ReferenceError::Interrupted) => return Err(ReferenceError::Interrupted),
                Err(error) => {
                    return match longest {
                        Some(own) => own.with_first_before(most, limits, error),
                        None => Err(error),
                    };
                }
            };
            let is_lost_by = |t: f64| first.horizon.is_some_and(|horizon| horizon < t);
            if let Some(longest) = longest.take_if(|longest| is_lost_by(longest.t_end)) {
                return longest.with_first(most, limits);
            }
            let is_known = match first.horizon {
                Some(horizon) => horizon <= 0.5 * own_end,
                // One that is seen later may still make the problem ill-posed.
                None if own_end < least => false,
                None => first.end_of_first(most).is_some_and(|end| end <= 0.5 * own_end),
            };
            if is_whole || is_known {
                return first.with_first(most, limits);
            }
            if first.horizon.is_none() && own_end >= least {
                longest = Some(first);
            }
        }
    }

    /// The first sample with more than `most` events of the reference up to it [s], if it has more.
    fn end_of_first(&self, most: usize) -> Option<f64> {
        let events = self.reference.parts.iter().flat_map(|part| part.events());
        let mut at: Vec<f64> = events.map(|event| event.t).collect();
        at.sort_by(f64::total_cmp);
        let last = at.get(most)?;
        self.times.iter().find(|t| *t >= last).copied().filter(|t| *t < self.t_end)
    }

    /// Its first part with the first `most` events, up to a sample; itself where it has no more, or that part has no reference.
    ///
    /// # Errors
    /// [`ReferenceError::Interrupted`].
    fn with_first(mut self, most: usize, limits: Limits<'_>) -> Result<Self, ReferenceError> {
        if let Some(t_end) = self.end_of_first(most) {
            let times: Vec<f64> = self.times.iter().copied().filter(|t| *t <= t_end).collect();
            match Reference::new(&self.subject, t_end, &times, limits) {
                Ok(reference) => {
                    (self.n_events, self.reference) = (reference.n_events(), reference);
                    (self.t_end, self.times) = (t_end, times);
                }
                Err(ReferenceError::Interrupted) => return Err(ReferenceError::Interrupted),
                // The whole has one.
                Err(_) => {}
            }
        }
        Ok(self)
    }

    /// As [`with_first`](Self::with_first), where there is no longer reference for this reason; which does not matter where its
    /// first events are enough.
    fn with_first_before(
        mut self,
        most: usize,
        limits: Limits<'_>,
        no_longer: ReferenceError,
    ) -> Result<Self, ReferenceError> {
        self.no_longer = self.end_of_first(most).is_none().then_some(no_longer);
        self.with_first(most, limits)
    }

    /// The time that a run covers, its parts added [s].
    pub(super) fn whole(&self) -> f64 {
        self.t_end * self.subject.parts.len() as f64
    }

    /// How far a run is that came to `t` [s] in its part `at`: the part of its time, or of the nodes of the reference up to
    /// there with those of one step more, whichever is larger.
    ///
    /// Work is spread over time as the steps of the reference are, which are dense in a contact and far apart in a flight;
    /// that of a method whose steps stability binds, evenly.
    pub(super) fn course(&self, at: usize, t: f64) -> f64 {
        let parts = &self.reference.parts;
        let of_time = (at as f64 * self.t_end + t) / self.whole();
        let nodes = |parts: &[PartReference]| parts.iter().map(|part| part.nodes.len()).sum();
        let before = parts[at].nodes.partition_point(|node| node.t <= t);
        let begun: usize = nodes(&parts[..at]) + before + GAUSS.len();
        let all: usize = nodes(parts);
        of_time.max((begun as f64 / all as f64).min(1.0))
    }

    /// The time that its run at `setting` takes; none where that is broken off.
    pub fn took(&self, setting: &Setting, stop: &AtomicBool) -> Option<Timing> {
        let limits = Limits { max_seconds: self.max_seconds, ..Limits::none(stop) };
        self.subject.took(setting, self.t_end, &Grid::Times(self.times.clone()), limits)
    }

    /// The reason why methods cannot be compared on it, where it is predictable for too short a time or ends at its start.
    pub fn ill_posed(&self) -> Option<String> {
        if self.reference.parts.iter().all(|part| part.t_end == 0.0) {
            return Some("the run ends at its start".to_owned());
        }
        let least = least_horizon(&self.subject);
        let rounded = (1e6 * least).round() / 1e6;
        let is_short = self.horizon.is_some_and(|horizon| horizon < least);
        is_short.then(|| format!("predictable for less than {rounded} s"))
    }
}

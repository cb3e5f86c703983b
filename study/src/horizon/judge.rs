//! The events that a run is compared with.

use crate::part::Part;
use crate::run::ModeChange;
use crate::warning::{Code, Warning};

/// Events this close to the end of a run are not looked at, in units of the subject's time.
pub(super) const AT_END: f64 = 1e-3;

/// The events of each site of a part in a tight run that others are compared by, and for how long they are certain [s].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TightEvents {
    pub(super) changes: Vec<Vec<ModeChange>>,
    pub(super) until: Vec<f64>,
    /// When an event ended it [s]; none where it came to the end, or where that is not certain.
    pub(super) stopped_at: Option<f64>,
    pub(super) by: Judge,
}

/// What run or runs a run is compared with.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Judge {
    /// Two at rounding.
    Tight,
    /// One that is more exact, at this accuracy.
    Finer(String),
}

impl Judge {
    fn name(&self) -> String {
        match self {
            Self::Tight => "runs at rounding".to_owned(),
            Self::Finer(accuracy) => format!("a run at {accuracy}"),
        }
    }

    /// What another sequence of events may mean, too.
    fn caveat(&self) -> &'static str {
        match self {
            Self::Tight => "",
            Self::Finer(_) => ", or the motion is not predictable for so long",
        }
    }
}

impl TightEvents {
    /// The warning that a run that reached a time [s], where an event ended it or not, with these events of each site, has
    /// another sequence.
    pub(super) fn warning(
        &self,
        part: &Part,
        run: &[Vec<ModeChange>],
        (reached, is_stopped): (f64, bool),
    ) -> Option<Warning> {
        (0..run.len().min(self.changes.len())).find_map(|site| {
            let (own, tight, until) = (&run[site], &self.changes[site], self.until[site]);
            // An event so close to the end of one run may lie beyond it.
            let until = until.min(reached) - AT_END * part.unit_of_time;
            let t = parting(own, tight).filter(|t| *t < until)?;
            let count = |all: &[ModeChange]| all.iter().filter(|change| change.t < until).count();
            let message = format!(
                "from t = {t:.6e} s on the run has another sequence of events than {} ({} for {} up \
                 to {until:.6e} s): it has lost a contact or made one up, or one grazes{}; take a tighter tolerance or \
                 another method",
                self.by.name(),
                count(own),
                count(tight),
                self.by.caveat()
            );
            Some(Warning { code: Code::Events, message }.of(&part.sites[site]))
        })
        .or_else(|| match is_stopped {
            true => self.stops_alone(part, reached),
            false => self.goes_on(part, reached),
        })
    }

    /// The warning that an event ended a run at this time [s], and these go on beyond it, to their end or to another event.
    fn stops_alone(&self, part: &Part, reached: f64) -> Option<Warning> {
        let beyond = reached + AT_END * part.unit_of_time;
        let certain = self.until.iter().copied().fold(f64::INFINITY, f64::min);
        // Of one that ends them all later, this is the same, early.
        let until = match self.stopped_at {
            Some(t) => t - AT_END * part.unit_of_time,
            None => certain,
        };
        let next = self.changes.iter().flatten().map(|change| change.t);
        let next = next.filter(|t| (beyond..until).contains(t)).reduce(f64::min);
        let goes_on_to =
            next.or((self.stopped_at.is_none() && certain > beyond).then_some(certain))?;
        let message = format!(
            "an event ended the run at t = {reached:.6e} s, and {} went on to {goes_on_to:.6e} s: it has made that event up, or this \
             grazes{}; take a tighter tolerance or another method",
            self.by.name(),
            self.by.caveat()
        );
        Some(Warning { code: Code::Events, message }.of(&part.sites[0]))
    }

    /// The warning that a run that reached a time [s] went on beyond the event that ends it.
    fn goes_on(&self, part: &Part, reached: f64) -> Option<Warning> {
        let t = self.stopped_at.filter(|t| reached > t + AT_END * part.unit_of_time)?;
        let message = format!(
            "an event ends {} at t = {t:.6e} s, and the run went on to {reached:.6e} s: it has lost that event, or this grazes{}; \
             take a tighter tolerance or another method",
            self.by.name(),
            self.by.caveat()
        );
        Some(Warning { code: Code::Events, message }.of(&part.sites[0]))
    }
}

/// The first time at which two sequences differ in what changes, whenever it does [s].
pub fn parting(a: &[ModeChange], b: &[ModeChange]) -> Option<f64> {
    let is_same = |(a, b): &(&ModeChange, &ModeChange)| a.is_like(b);
    let same = a.iter().zip(b).take_while(is_same).count();
    [a.get(same), b.get(same)].into_iter().flatten().map(|change| change.t).reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn events(list: &[(f64, i8)]) -> Vec<ModeChange> {
        list.iter().map(|(t, after)| ModeChange::new(*t, 1 - after, *after)).collect()
    }

    #[test]
    fn sequences_part_where_one_lacks_an_event_and_not_where_it_is_late() {
        let tight = events(&[(0.1, 1), (0.2, 0), (0.3, 1)]);
        assert_eq!(parting(&tight, &events(&[(0.11, 1), (0.2, 0), (0.29, 1)])), None);
        assert_eq!(parting(&tight, &events(&[(0.1, 1), (0.2, 0)])), Some(0.3));
        assert_eq!(parting(&tight, &events(&[(0.2, 0), (0.3, 1)])), Some(0.1));
    }
}

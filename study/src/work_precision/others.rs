//! What the other methods say of a reference.

use std::collections::BTreeMap;

use super::{Row, Status, WorkPrecision};
use crate::run::Events;

/// Located runs at this relative tolerance or below have the events right, if any have.
const TIGHT: f64 = 1e-8;
/// So many other methods are asked at least.
pub(crate) const ENOUGH: usize = 3;

impl WorkPrecision {
    /// What its reference cannot serve for, a sentence each; the last that all others have other events.
    pub fn limits(&self) -> Vec<String> {
        let mut limits = self.reference.limits();
        limits.extend(self.others());
        limits
    }

    /// That no method but those of the reference has its events, however tight; none where one has them, or where
    /// fewer than [`ENOUGH`] say so.
    ///
    /// Two runs of one method may miss the same event. Others miss it in other places.
    fn others(&self) -> Option<String> {
        let mut tightest: BTreeMap<&str, (f64, &Row)> = BTreeMap::new();
        let is_asked = |row: &&Row| {
            row.status == Status::Ok
                && row.events == Events::Located
                && self.reference.is_made_without(&row.method)
        };
        for row in self.rows.iter().filter(is_asked) {
            let Some(rtol) = row.rtol.filter(|rtol| *rtol <= TIGHT) else { continue };
            if tightest.get(&*row.method).is_none_or(|(least, _)| rtol < *least) {
                tightest.insert(&row.method, (rtol, row));
            }
        }
        let is_known = self.reference.event_time_agreement_s.is_some();
        if !is_known
            || tightest.len() < ENOUGH
            || tightest.values().any(|(_, row)| row.events_are_right())
        {
            return None;
        }
        let count = |n: Option<usize>| n.unwrap_or_default();
        let own = |(method, (_, row)): (&&str, &(f64, &Row))| {
            format!("{method} {} and {}", count(row.missed), count(row.spurious))
        };
        let all: Vec<String> = tightest.iter().map(own).collect();
        Some(format!(
            "no method but that of the reference has its events at the tightest setting (missed and spurious: {}): \
             if they agree, the reference is wrong",
            all.join(", ")
        ))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use deltazero_solvers::Method;

    use super::super::work_precision;
    use super::*;
    use crate::part::Subject;
    use crate::plan::Plan;
    use crate::problems::balls::LIGHT_BALL;
    use crate::run::{Accuracy, Setting};

    #[test]
    fn where_all_others_agree_against_the_reference_it_says_so() {
        let setting = |name| Setting {
            method: Method::named(name).unwrap(),
            events: Events::Located,
            accuracy: Accuracy::Rtol(1e-10, None),
        };
        let settings = ["taylor", "rk45", "dop853", "radau5"].map(setting).to_vec();
        let plan = Plan { settings, repeats: 0, ..Plan::new(0.1) };
        let subject = Subject::of(LIGHT_BALL);
        let stop = AtomicBool::new(false);
        let table = work_precision(&subject, &plan, &[], &stop, &|_| {}).unwrap();
        assert!(table.rows.iter().all(Row::events_are_right), "{:?}", table.rows);
        assert_eq!(table.limits(), table.reference.limits());
        let with = |n_spurious: [usize; 4], rtol: f64| {
            let mut table = table.clone();
            for (row, n) in table.rows.iter_mut().zip(n_spurious) {
                (row.spurious, row.rtol) = (Some(n), Some(rtol));
            }
            table.limits().concat()
        };
        let told = with([0, 2, 2, 2], 1e-10);
        assert!(told.contains("dop853 0 and 2, radau5 0 and 2, rk45 0 and 2"), "{told}");
        assert_eq!(with([0, 2, 2, 0], 1e-10), "");
        assert_eq!(with([2, 0, 0, 0], 1e-10), "");
        assert_eq!(with([0, 2, 2, 2], 1e-6), "");
    }
}

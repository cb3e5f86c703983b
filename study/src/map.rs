//! The map of any model: the contest over a grid of two of its parameters, at several accuracies.

use std::sync::atomic::AtomicBool;

use serde::{Deserialize, Serialize};

use crate::digits::as_meant;
use crate::parallel::in_parallel;
use crate::part::Subject;
use crate::plan::sample_times;
use crate::run::Limits;
use crate::selection::{Benchmark, Contest, Entry, Known, Rules, Standings};
use crate::setting::Events;

/// What became of a contest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CellStatus {
    /// A method reaches the accuracy.
    Ok,
    /// None does.
    None,
    /// The motion is predictable for less than 0.2 of its unit of time.
    IllPosed,
    /// The reference is not good enough for this accuracy.
    Undecidable,
    /// There is no reference.
    NoReference,
}

impl CellStatus {
    /// As the files write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::None => "none",
            Self::IllPosed => "ill-posed",
            Self::Undecidable => "undecidable",
            Self::NoReference => "no-reference",
        }
    }
}

/// A contest on one subject at one accuracy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contested {
    /// The error asked for.
    pub accuracy: f64,
    /// What became of it.
    pub status: CellStatus,
    /// Why there is no winner, or no reference of the time beyond the runs.
    pub error: Option<String>,
    /// The end of the runs [s].
    pub t_end_s: Option<f64>,
    /// Where a change of the start's last bit is seen [s]; none: not within twice the time compared, or not within the run.
    pub horizon_s: Option<f64>,
    /// Events of the reference.
    pub n_events: Option<usize>,
    /// Who reaches the accuracy, and who does not.
    pub standings: Standings,
}

impl Contested {
    /// Those that reach the accuracy by a method that is the same throughout, the fastest first; `auto`, which
    /// is made of them, is measured against them.
    pub fn fixed(&self) -> impl Iterator<Item = &Entry> {
        self.standings.entries.iter().filter(|entry| !entry.is_auto())
    }

    /// The fastest of them; `auto` where it alone arrives.
    pub fn winner(&self) -> Option<&Entry> {
        self.fixed().next().or_else(|| self.standings.entries.first())
    }

    /// The second, where it came near enough to be timed with the fastest.
    pub fn second(&self) -> Option<&Entry> {
        self.fixed().nth(1).filter(|entry| entry.timed)
    }

    /// Those that the noise of the times does not tell from the winner.
    pub fn within_noise(&self) -> Vec<&Entry> {
        let Some(first) = self.winner() else { return Vec::new() };
        self.fixed().skip(1).filter(|entry| entry.is_within_noise_of(first)).collect()
    }

    /// Time of `auto` over that of the winner, each by whichever of located and blind is faster for it.
    pub fn auto_over_winner(&self) -> Option<f64> {
        let own = self.standings.entries.iter().find(|entry| entry.is_auto())?;
        Some(own.time_s() / self.winner()?.time_s())
    }

    /// The fastest of those that `of` is true for.
    pub fn best(&self, of: impl Fn(&Entry) -> bool) -> Option<&Entry> {
        let own = self.fixed().filter(|entry| of(entry));
        own.min_by(|a, b| a.time_s().total_cmp(&b.time_s()))
    }

    /// To where its runs are compared and why no further, where that is neither the end nor the horizon nor the last event
    /// asked for.
    pub fn cut_short(&self) -> Option<String> {
        let is_run = matches!(self.status, CellStatus::Ok | CellStatus::None);
        let (t_end, why) = self.t_end_s.zip(self.error.as_ref()).filter(|_| is_run)?;
        Some(format!("compared to {} s; beyond: {why}", as_meant(t_end)))
    }

    /// Time of the second over that of the winner.
    pub fn margin(&self) -> Option<f64> {
        Some(self.second()?.time_s() / self.winner()?.time_s())
    }

    /// Time of the best explicit method over that of the best implicit one.
    pub fn explicit_over_implicit(&self) -> Option<f64> {
        let time = |implicit| self.best(|entry| entry.implicit == implicit).map(Entry::time_s);
        Some(time(false)? / time(true)?)
    }

    /// Time of the best blind run over that of the best located one.
    pub fn blind_over_located(&self) -> Option<f64> {
        let time = |events| self.best(|entry| entry.events == events).map(Entry::time_s);
        Some(time(Events::Blind)? / time(Events::Located)?)
    }
}

/// What every contest of a map has.
#[derive(Clone, Debug)]
pub struct MapPlan {
    /// The end of the runs [s].
    pub t_end: f64,
    /// When states are compared [s].
    pub times: Vec<f64>,
    /// Errors to be reached.
    pub accuracies: Vec<f64>,
    /// Who takes part.
    pub rules: Rules,
    /// Events after which a contest ends.
    pub max_events: usize,
    /// Right-hand sides beyond which a run is cut.
    pub max_rhs: u64,
    /// Time beyond which a run is cut [s].
    pub max_seconds: f64,
}

impl MapPlan {
    /// Every method, its events located, to `t_end` [s], at errors of 1e-3 and 1e-6.
    pub fn new(t_end: f64) -> Self {
        Self {
            t_end,
            times: sample_times(None, t_end),
            accuracies: vec![1e-3, 1e-6],
            rules: Rules::default(),
            max_events: 100,
            max_rhs: 10_000_000,
            max_seconds: 60.0,
        }
    }
}

/// The contests on one subject, one an accuracy, in the order of the plan.
pub fn contested(subject: Subject, plan: &MapPlan, stop: &AtomicBool) -> Vec<Contested> {
    let empty = |accuracy: f64| Contested {
        accuracy,
        status: CellStatus::NoReference,
        error: None,
        t_end_s: None,
        horizon_s: None,
        n_events: None,
        standings: Standings::default(),
    };
    let limits = Limits { max_rhs: plan.max_rhs, max_seconds: plan.max_seconds, stop };
    let (most, times) = (plan.max_events, plan.times.clone());
    let benchmark = match Benchmark::of_first(subject, plan.t_end, times, limits, most) {
        Ok(benchmark) => benchmark,
        Err(error) => {
            let error = Some(error.to_string());
            let without = |e: &f64| Contested { error: error.clone(), ..empty(*e) };
            return plan.accuracies.iter().map(without).collect();
        }
    };
    let (rules, known) = (&plan.rules, Known::default());
    let contest = |accuracy: &f64| {
        let own = Contested {
            t_end_s: Some(benchmark.t_end),
            horizon_s: benchmark.horizon,
            n_events: Some(benchmark.n_events),
            error: benchmark.no_longer.as_ref().map(ToString::to_string),
            ..empty(*accuracy)
        };
        let contest = Contest { benchmark: &benchmark, accuracy: *accuracy, rules, stop };
        if let Some(reason) = benchmark.ill_posed() {
            return Contested { status: CellStatus::IllPosed, error: Some(reason), ..own };
        }
        if !contest.is_decidable() {
            let error = Some(benchmark.reference.summary.undecided());
            return Contested { status: CellStatus::Undecidable, error, ..own };
        }
        let standings = contest.run_knowing(&known, &|_| {});
        let status = if standings.entries.is_empty() { CellStatus::None } else { CellStatus::Ok };
        Contested { status, standings, ..own }
    };
    // The smallest error first: what reaches it reaches a larger one, too.
    let mut order: Vec<usize> = (0..plan.accuracies.len()).collect();
    order.sort_by(|a, b| plan.accuracies[*a].total_cmp(&plan.accuracies[*b]));
    let mut all: Vec<(usize, Contested)> =
        order.into_iter().map(|i| (i, contest(&plan.accuracies[i]))).collect();
    all.sort_by_key(|(i, _)| *i);
    all.into_iter().map(|(_, own)| own).collect()
}

/// A parameter of a model with the values that a map has of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapAxis {
    /// Name.
    pub name: String,
    /// Unit; empty for what has none.
    pub unit: String,
    /// Values, ascending.
    pub values: Vec<f64>,
}

impl MapAxis {
    /// A parameter of this name and unit with these values.
    pub fn new(name: impl Into<String>, unit: impl Into<String>, values: &[f64]) -> Self {
        Self { name: name.into(), unit: unit.into(), values: values.to_vec() }
    }

    /// Name and unit.
    pub fn label(&self) -> String {
        if self.unit.is_empty() {
            self.name.clone()
        } else {
            format!("{} [{}]", self.name, self.unit)
        }
    }
}

/// A cell of a map.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapCell {
    /// The two parameters.
    pub at: [f64; 2],
    /// The contest there.
    #[serde(flatten)]
    pub contest: Contested,
}

/// A map over two parameters of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The two parameters: to the right, and upwards.
    pub axes: [MapAxis; 2],
    /// Its cells: for each value of the first parameter, of the second, and each accuracy.
    pub cells: Vec<MapCell>,
}

impl Map {
    /// Runs the contest for every pair of values, each on the subject that `of` makes of it, on so many threads.
    pub fn new(
        axes: [MapAxis; 2],
        plan: &MapPlan,
        threads: usize,
        of: impl Fn([f64; 2]) -> Subject,
    ) -> Self {
        let (subjects, stop): (Vec<_>, _) =
            (pairs(&axes).map(of).collect(), AtomicBool::new(false));
        let contests =
            in_parallel(&subjects, threads, |subject| contested(subject.clone(), plan, &stop));
        Self::of(axes, contests)
    }

    /// The map of `contests` that were run before, in the order of [`pairs`].
    pub fn of(axes: [MapAxis; 2], contests: impl IntoIterator<Item = Vec<Contested>>) -> Self {
        let cells = pairs(&axes)
            .zip(contests)
            .flat_map(|(at, own)| own.into_iter().map(move |contest| MapCell { at, contest }));
        let cells = cells.collect();
        Self { axes, cells }
    }
}

/// Every pair of values of two parameters.
pub fn pairs([right, up]: &[MapAxis; 2]) -> impl Iterator<Item = [f64; 2]> {
    right.values.iter().flat_map(|x| up.values.iter().map(move |y| [*x, *y]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::balls::LIGHT_BALL;

    #[test]
    fn contests_at_several_accuracies_share_their_runs_and_end_as_alone() {
        let contests = |accuracies: &[f64]| {
            let rules = Rules { repeats: 1, ..Rules::default() };
            let plan = MapPlan { accuracies: accuracies.to_vec(), rules, ..MapPlan::new(0.2) };
            contested(Subject::of(LIGHT_BALL), &plan, &AtomicBool::new(false))
        };
        // Times are of the machine, and so is the order by them.
        let found = |contest: &Contested| {
            let all = contest.standings.entries.iter();
            let mut all: Vec<_> =
                all.map(|entry| (entry.method.clone(), entry.setting(), entry.e)).collect();
            all.sort_by(|a, b| a.0.cmp(&b.0));
            all
        };
        let n_trials =
            |all: &[Contested]| all.iter().map(|own| own.standings.n_trials).sum::<usize>();
        let (both, alone) =
            (contests(&[1e-4, 1e-6]), [contests(&[1e-4]), contests(&[1e-6])].concat());
        for (own, other) in both.iter().zip(&alone) {
            assert_eq!(found(own), found(other), "{}", own.accuracy);
        }
        assert!(n_trials(&both) < n_trials(&alone), "{} {}", n_trials(&both), n_trials(&alone));
    }
}

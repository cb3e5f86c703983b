//! A step of the Taylor method of two runs at once.

use wide::f64x2;

use super::attempt::pick;
use super::field::OfEach;
use super::lane::{Fate, Lane, scene};
use super::pair::Together;
use super::scalar::{Lanes, Own};
use crate::control::Verdict;
use crate::error::Error;
use crate::integrate::Integration;
use crate::phase::PhaseEnd;
use crate::real::{Ordered, Real};
use crate::record::{Needs, Record};
use crate::system::{Alike, System, Vector};
use crate::taylor::TaylorMethod;
use crate::taylor::expand::Expansion;
use crate::taylor::guards::GuardSeries;
use crate::taylor::method::{sum_with_slope, to_defect};
use crate::taylor::order::{Reach, reach_by};
use crate::tolerance::{Tolerance, norm_sq, weigh, weighed_sq};

/// A number of each of two runs.
type Two = Lanes<f64x2>;

/// A run by the Taylor method.
type SeriesLane<'r, 'a, P, R> =
    Lane<'r, 'a, P, R, TaylorMethod<<P as System>::State<f64>, <P as System>::Guards<f64>>>;

/// A step of the Taylor method of two runs: their series, guards, ends and errors at once.
pub(super) struct SeriesPair<P: Alike> {
    expansion: Expansion<Two>,
    guards: GuardSeries<P::Guards<Two>, Two>,
    /// Coefficients by order.
    y: Vec<P::State<Two>>,
    /// What the tolerances weigh each state with at the start.
    weights: P::State<Two>,
    rtol: Own<f64x2>,
    atol: Vec<Own<f64x2>>,
    t0: Two,
    t1: Two,
    y1: P::State<Two>,
    slope1: P::State<Two>,
    error: P::State<Two>,
    /// Square of its norm.
    error_sq: Two,
    /// A bit for each run whose end is finite and whose guards are clear.
    plain: u32,
}

/// What part a run has in a step of both.
enum Part {
    /// To take part.
    Joins,
    /// To take a step alone: its series is to be cut, or tells no step size.
    Leaves,
    /// To end.
    Fails(Error),
}

impl<P: Alike> SeriesPair<P> {
    /// For systems like `problem`, by series of `order`.
    pub(super) fn new(problem: &P, order: usize, tolerances: [&Tolerance; 2]) -> Self {
        let number = |of: &dyn Fn(&Tolerance) -> f64| Own::from_fn(|run| of(tolerances[run]));
        let (n, n_guards) = (problem.dim(), problem.n_guards());
        let state = || Vector::from_fn(n, |_| Two::cst(0.0));
        Self {
            expansion: Expansion::default(),
            guards: GuardSeries::new(n_guards, order),
            y: (0..=order).map(|_| state()).collect(),
            weights: state(),
            rtol: number(&|tolerance| tolerance.rtol),
            atol: (0..n).map(|i| number(&|tolerance| tolerance.atol[i])).collect(),
            t0: Two::cst(0.0),
            t1: Two::cst(0.0),
            y1: state(),
            slope1: state(),
            error: state(),
            error_sq: Two::cst(0.0),
            plain: 0,
        }
    }

    fn order(&self) -> usize {
        self.y.len() - 1
    }

    /// Starts where both runs are.
    fn start<R: Record<P>>(
        &mut self,
        field: &OfEach<P, f64x2>,
        of: [&SeriesLane<'_, '_, P, R>; 2],
    ) {
        self.t0 = Lanes::from_fn(|run| of[run].run.point.t);
        for (i, y) in self.y[0].as_mut().iter_mut().enumerate() {
            *y = Lanes::from_fn(|run| of[run].run.point.y.as_ref()[i]);
        }
        let (start, rest) = self.y.split_at_mut(1);
        self.expansion.begin(field, self.t0, &start[0], &mut rest[0], self.guards.start());
    }

    /// Starts where the last steps ended.
    #[inline(always)]
    fn go_on(&mut self) {
        self.t0 = self.t1;
        self.y[0].clone_from(&self.y1);
        self.y[1].clone_from(&self.slope1);
        self.guards.advance();
    }

    /// Expands solutions about the start.
    #[inline(always)]
    fn expand(&mut self, field: &OfEach<P, f64x2>) {
        self.expansion.complete(field, self.t0, &mut self.y, self.guards.low());
        weigh((self.rtol, &self.atol), self.y[0].as_ref(), self.weights.as_mut());
    }

    /// How far the series of this run reaches.
    fn reach(&self, lane: usize) -> Option<Reach> {
        let norm_sq = |k: usize| weighed_sq(self.y[k].as_ref(), self.weights.as_ref()).lane(lane);
        reach_by(self.order(), norm_sq)
    }

    /// Takes the steps that end at `t1`, and looks at ends, errors and guards.
    #[inline(always)]
    fn take(&mut self, field: &OfEach<P, f64x2>, t1: Two) {
        self.t1 = t1;
        let h = t1 - self.t0;
        sum_with_slope(&self.y, h, &mut self.y1, &mut self.error);
        self.expansion.begin(field, t1, &self.y1, &mut self.slope1, &mut self.guards.end);
        to_defect(h, self.order(), &self.slope1, &mut self.error);
        let (y0, y1) = (self.y[0].as_ref(), self.y1.as_ref());
        self.error_sq = norm_sq((self.rtol, &self.atol), self.error.as_ref(), y0, y1);
        self.plain = Two::YES;
        for x in y1.iter().chain(self.slope1.as_ref()) {
            self.plain &= Two::cst(f64::INFINITY).is_above(x.abs());
        }
        let highest = self.guards.highest_low();
        for (i, end) in self.guards.end.as_ref().iter().enumerate() {
            self.plain &= self.guards.is_clear(i, h, highest, *end);
        }
    }
}

impl<P: Alike> Together<P, TaylorMethod<P::State<f64>, P::Guards<f64>>> for SeriesPair<P> {
    /// A run has the place of its index. One without another takes both places: that is faster than alone, for its
    /// code is of one mode.
    fn go<'r, 'a, R: Record<P>>(
        &mut self,
        field: &OfEach<P, f64x2>,
        first: &mut SeriesLane<'r, 'a, P, R>,
        mut second: Option<&mut SeriesLane<'r, 'a, P, R>>,
    ) -> [Fate; 2] {
        self.start(field, [first, second.as_deref().unwrap_or(first)]);
        loop {
            self.expand(field);
            let part_1 = first.aim_by(self);
            let part_2 = second.as_deref_mut().map(|lane| lane.aim_by(self));
            let both_join = matches!((&part_1, &part_2), (Part::Joins, None | Some(Part::Joins)));
            let t1 = [first.t1, second.as_deref().map_or(first.t1, |lane| lane.t1)];
            self.take(field, Lanes::from_fn(|run| t1[run]));
            let fate_1 = first.settle_by(self, part_1);
            let fate_2 = match (second.as_deref_mut(), part_2) {
                (Some(lane), Some(part)) => lane.settle_by(self, part),
                _ => Fate::Attempts,
            };
            let runs = [first, second.as_deref().unwrap_or(first)];
            let took_it = |run: usize| self.t1.lane(run) == runs[run].run.point.t;
            let both_go_on = matches!((&fate_1, &fate_2), (Fate::Attempts, Fate::Attempts))
                && both_join
                && took_it(0)
                && took_it(1);
            self.go_on();
            if !both_go_on {
                first.refresh(self);
                if let Some(lane) = second {
                    lane.refresh(self);
                }
                return [fate_1, fate_2];
            }
        }
    }
}

impl<P: Alike, R: Record<P>> SeriesLane<'_, '_, P, R> {
    /// Aims as far as its series reaches.
    #[inline(always)]
    fn aim_by(&mut self, pair: &SeriesPair<P>) -> Part {
        let Self { index, run, solver, course, .. } = self;
        let Integration { problem, point, stats, .. } = &mut **run;
        solver.choose_step_by(problem, point, course, stats, |method, _, stats| {
            stats.work.n_rhs += 1;
            method.reaches(pair.reach(*index))
        });
        match course.next(point) {
            Ok(Some((t1, h))) => (self.t1, self.h) = (t1, h),
            Ok(None) => {}
            Err(error) => return Part::Fails(error),
        }
        if solver.method.degree == Some(pair.order()) { Part::Joins } else { Part::Leaves }
    }

    /// Goes on by what the step of both came to for it, to the start of another step.
    #[inline(always)]
    fn settle_by(&mut self, pair: &SeriesPair<P>, part: Part) -> Fate {
        if !matches!(part, Part::Joins) {
            self.refresh(pair);
        }
        let mut judged = match part {
            Part::Joins => self.judge_by(pair),
            Part::Leaves => {
                self.solver.method.take_all(pair, self.index);
                self.attempt()
            }
            Part::Fails(error) => Err(error),
        };
        while let (Ok(None), None) = (&judged, self.course.due) {
            match self.go_on(Ok(None)) {
                Fate::Attempts => judged = self.attempt(),
                fate => return fate,
            }
        }
        match judged {
            Ok(None) if self.run.point.t != self.course.t_end => Fate::Attempts,
            judged => self.go_on(judged),
        }
    }

    /// Takes over the start of the step of both, where it is [stale](Lane::is_stale); what else there is of it comes
    /// by [`take_all`](TaylorMethod::take_all).
    fn refresh(&mut self, pair: &SeriesPair<P>) {
        if std::mem::take(&mut self.is_stale) {
            let (point, step) = (&mut self.run.point, &mut self.solver.method.step);
            step.t0 = point.t;
            for (all, y) in pair.y.iter().zip(&mut step.y).take(2) {
                pick(all, self.index, y);
            }
            point.y.clone_from(&step.y[0]);
        }
    }

    /// How the phase ended, if it did: by a look at the step of both where that is enough, else as it would alone.
    #[inline(always)]
    fn judge_by(&mut self, pair: &SeriesPair<P>) -> Result<Option<PhaseEnd>, Error> {
        let (lane, needs) = (self.index, self.needs());
        let error_sq = |_: &_| pair.error_sq.lane(lane);
        let solver = &mut self.solver;
        let verdict = solver.controller.verdict(solver.is_proposed, self.h, error_sq);
        let is_plain = pair.plain & (1 << lane) != 0;
        if let (Verdict::Accept(next), true, Needs::Nothing) = (verdict, is_plain, needs) {
            self.step_unseen(next);
            return Ok(None);
        }
        self.refresh(pair);
        let Self { run, record, solver, course, t1, h, .. } = self;
        solver.method.take_end(*t1, pair, lane);
        match verdict {
            Verdict::Accept(next) if is_plain => {
                if needs == Needs::DenseOutput {
                    solver.method.take_series(&pair.y, lane);
                }
                course.h = next;
                Ok(solver.accept(&mut scene(run, *record), course, None, needs))
            }
            _ => {
                solver.method.take_all(pair, lane);
                pick(&pair.error, lane, &mut solver.method.error);
                solver.apply_verdict(&mut scene(run, *record), course, *h, verdict)
            }
        }
    }
}

impl<Y: Vector<f64>, G: Vector<f64>> TaylorMethod<Y, G> {
    /// Takes over the end, at `t1`, of the step of one run from that of two.
    #[inline(always)]
    fn take_end<P: Alike>(&mut self, t1: f64, pair: &SeriesPair<P>, lane: usize) {
        (self.step.t1, self.step.degree) = (t1, pair.order());
        pick(&pair.y1, lane, &mut self.step.y1);
        pick(&pair.slope1, lane, &mut self.step.slope1);
    }

    /// Takes over its series.
    fn take_series<L: Vector<Two>>(&mut self, all: &[L], lane: usize) {
        for (all, y) in all.iter().zip(&mut self.step.y) {
            pick(all, lane, y);
        }
        self.is_expanded = true;
    }

    /// Takes over its series, with those of its guards.
    fn take_all<P: Alike>(&mut self, pair: &SeriesPair<P>, lane: usize) {
        self.take_series(&pair.y, lane);
        self.guards.take(&pair.guards, |all, own| pick(all, lane, own));
    }
}

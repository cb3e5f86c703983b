//! The passage of a set of states through an event.

use super::expand::Field;
use super::interval::{Interval, points};
use super::set::{Set, along};
use super::tube::Tube;
use super::watched::{Allowed, Watch, Watched};
use crate::doubt::Doubt;
use crate::sensitivity::Tangent;
use crate::system::{Next, System, Vector};

/// Times that the bound of an event's time is doubled before it is given up.
const DOUBLINGS: usize = 8;

/// An event of every solution of a set.
pub(super) struct Passage<M> {
    /// Its time, from that about which it was sought.
    pub(super) time: Interval,
    /// The states before the transition.
    pub(super) before: Vec<Interval>,
    /// The states after it.
    pub(super) after: Vec<Interval>,
    /// What follows, and the set at the time about which it was sought, as if the new mode had been there all along.
    pub(super) next: Next<(M, Set)>,
}

/// What is known of a guard's fall about the time `t`.
pub(super) struct Fall {
    guard: usize,
    t: f64,
    /// A bound of the distance in time of the fall from `t`.
    around: f64,
    /// The fall, from `t`.
    time: Interval,
    /// The slopes of the states about it.
    slope: Vec<Interval>,
    /// `−1/ġ` about it.
    per_rate: Interval,
}

impl Fall {
    /// The one fall of `guard` near `t` of every solution through `set` at that time, as if it had not fallen before.
    ///
    /// By Newton's method on intervals: with `ġ` over `t ± r`, each fall within is at `t + s`, `s ∈ −g(y)/ġ`. Where
    /// these are all within `± r` and `ġ` is below zero, every solution has one fall there and no other.
    pub(super) fn new<P: System>(
        field: &Field<'_, P>,
        (guard, t): (usize, f64),
        set: &Set,
    ) -> Result<Self, Doubt> {
        let (y, touch) = (set.hull(), Doubt::Touch { guard });
        let of = |slope: &[Interval], over: Interval, y: &[Interval]| {
            field.guard_along(guard, (over, 1.0), y, slope)
        };
        let at = Interval::from(t);
        let [g, rate] = of(&field.slope(at, &y), at, &y);
        let mut around = 2.0 * (g / rate).mag() + f64::MIN_POSITIVE;
        for _ in 0..DOUBLINGS {
            let span = Interval::within(around);
            let Tube::Box(tube) = field.tube(t, &y, span)? else {
                return Err(touch);
            };
            let slope = field.slope(at + span, &tube);
            let [_, rate] = of(&slope, at + span, &tube);
            let per_rate = Interval::from(-1.0) / rate;
            let time = g * per_rate;
            if rate.hi() < 0.0 && time.mag() < around {
                return Ok(Self { guard, t, around, time, slope, per_rate });
            }
            around *= 2.0;
        }
        Err(touch)
    }

    /// The bound of its distance in time from where it was sought.
    pub(super) fn around(&self) -> f64 {
        self.around
    }

    /// The passage of `set` through the transition.
    ///
    /// With `s = −g/ġ` of the state `y` at `t`, the state before the event is `y + f⁻ s`, after it `R(y + f⁻ s)`, and
    /// that which the new mode has at `t` is `R(y + f⁻ s) − f⁺ s`. All are linear in the numbers of the set with
    /// coefficients in intervals, so that the width does not grow by more than the dynamics let it: the matrix is that
    /// of saltation.
    pub(super) fn pass<P: System>(
        &self,
        field: &Field<'_, P>,
        set: &Set,
    ) -> Result<Passage<P::Mode>, Doubt> {
        let (hull, at) = (set.hull(), Interval::from(self.t));
        let gradient =
            |axis: &Vec<f64>| field.guard_along(self.guard, (at, 0.0), &hull, &points(axis))[1];
        let center = set.center();
        let [g, _] = field.guard_along(self.guard, (at, 0.0), &center, &center);
        let delay = g * self.per_rate;
        let delays: Vec<_> = set.axes.iter().map(|a| gradient(a) * self.per_rate).collect();
        let moved = |y: &[Interval], delay: Interval| -> Vec<Interval> {
            y.iter().zip(&self.slope).map(|(y, f)| *y + *f * delay).collect()
        };
        let columns: Vec<Vec<Interval>> = set
            .axes
            .iter()
            .zip(&delays)
            .map(|(axis, delay)| moved(&points(axis), *delay))
            .collect();
        let middle = moved(&center, delay);
        let before = along(&middle, &columns, &set.r);
        let columns_of_time: Vec<_> = delays.iter().map(|delay| vec![*delay]).collect();
        let time = along(&[delay], &columns_of_time, &set.r)[0].meet(self.time);
        let reset = Reset { field, guard: self.guard, t: at + time };
        let (next, after) = reset.all(&before)?;
        let next = match next {
            Next::Stop => Next::Stop,
            Next::Mode(mode) => {
                let new = Field { problem: field.problem, mode: mode.clone() };
                let span = Interval::within(2.0 * self.around);
                let Tube::Box(tube) = new.tube(self.t, &after, span)? else {
                    return Err(Doubt::NoBox);
                };
                let slope = new.slope(at + span, &tube);
                let back = |y: Vec<Interval>, delay: Interval| -> Vec<Interval> {
                    y.into_iter().zip(&slope).map(|(y, f)| y - *f * delay).collect()
                };
                let point = points(&middle.iter().map(|y| y.mid()).collect::<Vec<_>>());
                let away: Vec<_> = middle.iter().zip(&point).map(|(y, p)| *y - *p).collect();
                let of_point = reset.of_point(&point)?;
                let moved = reset.derivative(&before, &away)?;
                let center = of_point.iter().zip(moved).map(|(y, d)| *y + d).collect();
                let column = |(column, delay): (&Vec<Interval>, &Interval)| {
                    reset.derivative(&before, column).map(|column| back(column, *delay))
                };
                let columns: Vec<_> =
                    columns.iter().zip(&delays).map(column).collect::<Result<_, _>>()?;
                let image = set.image(&back(center, delay), &columns);
                Next::Mode((mode, image.ok_or(Doubt::NoBox)?))
            }
        };
        Ok(Passage { time, before, after, next })
    }
}

/// The transition at an event.
struct Reset<'a, 'p, P: System> {
    field: &'a Field<'p, P>,
    guard: usize,
    /// The times that are possible.
    t: Interval,
}

impl<P: System> Reset<'_, '_, P> {
    /// What follows, and the states after it, for every state of the box: it must be the same mode for all, by the same
    /// formulas.
    fn all(&self, y: &[Interval]) -> Result<(Next<P::Mode>, Vec<Interval>), Doubt> {
        let undecided = Doubt::Transition { guard: self.guard };
        let by = |allowed| {
            let watch = Watch::new(allowed);
            let mut at = P::State::from_fn(y.len(), |i| Watched::new(y[i], &watch));
            let t = Watched::new(self.t, &watch);
            let mode = self.field.mode.clone();
            let next = self.field.problem.transition(mode, self.guard, t, &mut at);
            let after: Vec<_> = at.as_ref().iter().map(|y| y.x).collect();
            (!watch.is_undecided()).then_some((next, after))
        };
        match (by(Allowed::SignsLow), by(Allowed::SignsHigh)) {
            (Some(low), Some(high)) if low == high => Ok(low),
            _ => Err(undecided),
        }
    }

    /// The state after it, of one state of a box on which it is decided.
    fn of_point(&self, y: &[Interval]) -> Result<Vec<Interval>, Doubt> {
        let derived = self.derived(y, &vec![Interval::ZERO; y.len()])?;
        Ok(derived.into_iter().map(|[y, _]| y).collect())
    }

    /// The derivative of the state after it along `direction`, for every state of the box.
    fn derivative(&self, y: &[Interval], direction: &[Interval]) -> Result<Vec<Interval>, Doubt> {
        let derived = self.derived(y, direction)?;
        Ok(derived.into_iter().map(|[_, derivative]| derivative).collect())
    }

    /// The states after it with their derivatives, of a box on which it is decided in `all`. A value at whose ends other
    /// formulas hold may have led to the same states there.
    fn derived(&self, y: &[Interval], direction: &[Interval]) -> Result<Vec<[Interval; 2]>, Doubt> {
        let by = |allowed| -> Vec<[Interval; 2]> {
            let watch = Watch::new(allowed);
            let of = |x| Watched::new(x, &watch);
            let mut at = P::State::from_fn(y.len(), |i| Tangent::new(of(y[i]), of(direction[i])));
            let t = Tangent::constant(of(self.t));
            self.field.problem.transition(self.field.mode.clone(), self.guard, t, &mut at);
            at.as_ref().iter().map(|y| [y.re.x, y.eps.x]).collect()
        };
        let low = by(Allowed::SignsLow);
        let is_same = low == by(Allowed::SignsHigh);
        is_same.then_some(low).ok_or(Doubt::Transition { guard: self.guard })
    }
}

//! Numbers that were taken by their value, so that they have no derivative: the derivatives along the solution against
//! difference quotients.

use num_dual::Dual64;

use super::{Breach, Derivatives, Entries, Place, sizes_of_product};
use crate::real::Real;
use crate::record::Event;
use crate::system::{System, Vector};

/// A difference quotient agrees to the first fraction of the derivative, or the second of the terms that it is a sum of. A number
/// without a derivative is missing altogether.
const NEAR: [f64; 2] = [0.1, 1e-4];
/// Difference quotients that differ by more than this fraction of what is to be told tell nothing.
const SURE: f64 = 0.1;
/// Sums are taken to be rounded by this many last bits of their terms.
pub(super) const BITS: f64 = 100.0;
/// Steps of the difference quotients, as fractions of the time in which slopes or their rates change by their size. A part of a
/// slope may change faster than that.
const STEPS: [f64; 5] = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12];

/// What numbers change by a unit of time along the solution.
struct Changes<V> {
    now: V,
    /// By derivatives.
    derivative: V,
    /// Sizes of the terms whose sums are the derivatives.
    terms: V,
    /// Sizes of the terms whose sums are the numbers.
    sizes: V,
}

/// A number whose change by a difference quotient its derivative lacks.
struct Missing {
    index: usize,
    change: f64,
    derivative: f64,
}

impl<V: Vector<f64>> Changes<V> {
    /// The first number that lacks its derivative by the quotients of `ahead` over the steps of each of these `times`, of which the
    /// `n_sure` longest must tell it, and the others unless they are rounded.
    fn missing(&self, times: &[f64], n_sure: usize, ahead: impl Fn(f64) -> V) -> Option<Missing> {
        let over = |time: &f64| STEPS.map(|part| self.quotients(part * time, &ahead));
        let quotients: Vec<_> = times.iter().map(over).collect();
        let derivatives = self.derivative.as_ref().iter().enumerate();
        derivatives.map(|(index, derivative)| (index, *derivative)).find_map(
            |(index, derivative)| {
                let is_missing = times.iter().zip(&quotients).all(|(time, quotients)| {
                    let quotients = quotients.each_ref().map(|quotients| quotients.as_ref()[index]);
                    self.is_missing(index, (*time, n_sure), quotients)
                });
                let change = quotients[0][0].as_ref()[index];
                is_missing.then_some(Missing { index, change, derivative })
            },
        )
    }

    fn is_missing(&self, index: usize, (time, n_sure): (f64, usize), quotients: [f64; 5]) -> bool {
        let derivative = self.derivative.as_ref()[index];
        let change = quotients[0];
        let off = (change - derivative).abs();
        let terms = NEAR[1] * self.terms.as_ref()[index];
        STEPS.iter().zip(quotients).enumerate().all(|(k, (part, quotient))| {
            let rounded = BITS * f64::EPSILON * self.sizes.as_ref()[index] / (part * time).abs();
            if k >= n_sure && rounded > SURE * off {
                return true;
            }
            let size = NEAR[0] * derivative.abs().max(quotient.abs());
            (quotient - derivative).abs() > size.max(terms).max(rounded)
                && (quotient - change).abs() <= SURE * off
        })
    }

    /// What the numbers change by a unit of time, from three values `h` apart.
    fn quotients(&self, h: f64, ahead: impl Fn(f64) -> V) -> V {
        let (now, once, twice) = (self.now.as_ref(), ahead(h), ahead(2.0 * h));
        let (once, twice) = (once.as_ref(), twice.as_ref());
        Vector::from_fn(now.len(), |i| (4.0 * once[i] - twice[i] - 3.0 * now[i]) / (2.0 * h))
    }
}

impl<P: System> Place<'_, P> {
    /// Compares slopes and guards; the slopes are sums of terms of these `sizes`.
    pub(super) fn check_values(
        &self,
        of: Derivatives<P::State<f64>>,
        jacobian: &Entries,
        sizes: P::State<f64>,
    ) -> Result<(), Breach> {
        let Some(time) = of.shortest_time(self.y) else { return Ok(()) };
        let terms = sizes_of_product(jacobian, &of.first);
        let slopes = Changes { now: of.first, derivative: of.second, terms, sizes };
        let first = &slopes.now;
        let slope_ahead = |h: f64| {
            let y = self.ahead(first, h);
            let mut slope = y.clone();
            self.problem.rhs(self.mode.clone(), self.t + h, &y, &mut slope);
            slope
        };
        if let Some(found) = slopes.missing(&[time], 1, slope_ahead) {
            let Missing { index: state, change, derivative } = found;
            return Err(Breach::Value { state, change, derivative });
        }
        let n = self.problem.n_guards();
        let guards = self.changes(first, |t, y| {
            let mut g = P::Guards::from_fn(n, |_| Dual64::cst(0.0));
            self.problem.guards(self.mode.clone(), t, y, &mut g);
            g
        });
        let guards_ahead = |h: f64| {
            let mut g = P::Guards::from_fn(n, |_| 0.0);
            self.problem.guards(self.mode.clone(), self.t + h, &self.ahead(first, h), &mut g);
            g
        };
        let found = guards.missing(&[time, -time], 2, guards_ahead);
        found.map_or(Ok(()), |Missing { index: guard, change, derivative }| {
            Err(Breach::ValueOfGuard { guard, change, derivative })
        })
    }

    /// Compares the state after the transition of `guard`.
    fn check_transition(&self, guard: usize) -> Result<(), Breach> {
        let of = self.derivatives();
        let Some(time) = of.shortest_time(self.y) else { return Ok(()) };
        let changes = self.changes(&of.first, |t, y| {
            let mut y = y.clone();
            self.problem.transition(self.mode.clone(), guard, t, &mut y);
            y
        });
        let ahead = |h: f64| {
            let mut y = self.ahead(&of.first, h);
            self.problem.transition(self.mode.clone(), guard, self.t + h, &mut y);
            y
        };
        let found = changes.missing(&[time, -time], 2, ahead);
        found.map_or(Ok(()), |Missing { index: state, change, derivative }| {
            Err(Breach::ValueOfTransition { guard, state, change, derivative })
        })
    }

    /// The state after a time `h` on the straight line with the slope `first`.
    fn ahead(&self, first: &P::State<f64>, h: f64) -> P::State<f64> {
        let (y, first) = (self.y.as_ref(), first.as_ref());
        Vector::from_fn(y.len(), |i| y[i] + h * first[i])
    }

    /// What `f` changes by along the straight line with the slope `first`: one evaluation for each state, and one for the time.
    fn changes<D: Vector<Dual64>, V: Vector<f64>>(
        &self,
        first: &P::State<f64>,
        f: impl Fn(Dual64, &P::State<Dual64>) -> D,
    ) -> Changes<V> {
        let (n, y) = (self.y.as_ref().len(), self.y.as_ref());
        let seeded = |j: usize| {
            let seed = |i| if i == j { 1.0 } else { 0.0 };
            f(Dual64::new(self.t, seed(n)), &Vector::from_fn(n, |i| Dual64::new(y[i], seed(i))))
        };
        let by_time = seeded(n);
        let by_time = by_time.as_ref();
        let vector = |of: &dyn Fn(&Dual64) -> f64| V::from_fn(by_time.len(), |i| of(&by_time[i]));
        let mut changes = Changes {
            now: vector(&|f| f.re),
            derivative: vector(&|f| f.eps),
            terms: vector(&|f| f.eps.abs()),
            sizes: vector(&|f| f.re.abs() + (f.eps * self.t).abs()),
        };
        for (j, (y, first)) in y.iter().zip(first.as_ref()).enumerate() {
            for (i, f) in seeded(j).as_ref().iter().enumerate() {
                let term = f.eps * first;
                changes.derivative.as_mut()[i] += term;
                changes.terms.as_mut()[i] += term.abs();
                changes.sizes.as_mut()[i] += (f.eps * y).abs();
            }
        }
        changes
    }
}

/// Compares the derivatives of the state after the transition of an event with difference quotients.
pub(super) fn check_transition<P: System>(problem: &P, event: &Event<'_, P>) -> Result<(), Breach> {
    let Event { t, guard, before: mode, y_before: y, .. } = event;
    Place { problem, mode, t: *t, y }.check_transition(*guard)
}

impl<Y: Vector<f64>> Derivatives<Y> {
    /// The shortest time in which a slope or its rate changes by its size, or, where none changes, a state `y`; `None` where
    /// nothing does.
    fn shortest_time(&self, y: &Y) -> Option<f64> {
        shortest(&[(&self.first, &self.second), (&self.second, &self.third)])
            .or_else(|| shortest(&[(y, &self.first)]))
    }
}

/// The shortest time in which an entry of these changes by its size at its rate.
fn shortest<Y: Vector<f64>>(with_rates: &[(&Y, &Y)]) -> Option<f64> {
    let each = with_rates.iter().flat_map(|(a, rates)| a.as_ref().iter().zip(rates.as_ref()));
    let times = each.map(|(a, rate)| (a / rate).abs()).filter(|time| *time > 0.0);
    Some(times.fold(f64::INFINITY, f64::min)).filter(|time| time.is_finite())
}

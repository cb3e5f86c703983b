//! How a joint moves over a whole deployment: least, largest and mean value of each quantity in short
//! intervals of time, so that no oscillation is lost between samples.

use std::ops::ControlFlow;

use deltazero_solvers::{Accepted, Record, System as _};
use deltazero_study::quadrature::GAUSS;
use serde::{Deserialize, Serialize};

use crate::model::{Block, Mode, State};

/// What a course follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// θ [rad].
    Theta,
    /// θ̇ [rad/s].
    Omega,
    /// θ̈ [rad/s²].
    Alpha,
    /// Pin displacement x01 or y02 [m].
    D1,
    /// Pin displacement y01 or z02 [m].
    D2,
    /// Normal force F_N [N].
    Force,
}

impl Quantity {
    /// All of them, in the order of [`Bin::ranges`].
    pub const ALL: [Self; 6] =
        [Self::Theta, Self::Omega, Self::Alpha, Self::D1, Self::D2, Self::Force];

    /// Name and unit, as a column.
    pub fn column(self) -> &'static str {
        match self {
            Self::Theta => "theta_rad",
            Self::Omega => "omega_rad_s",
            Self::Alpha => "alpha_rad_s2",
            Self::D1 => "d1_m",
            Self::D2 => "d2_m",
            Self::Force => "f_n_n",
        }
    }
}

/// Values of a quantity over an interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Range {
    /// Least.
    pub least: f64,
    /// Largest.
    pub most: f64,
    /// Mean over time.
    pub mean: f64,
}

impl Range {
    /// Largest value without its sign.
    pub fn magnitude(&self) -> f64 {
        self.most.max(-self.least)
    }

    /// Of two adjacent intervals, of lengths `own` and `others`.
    fn joined(self, own: f64, other: Self, others: f64) -> Self {
        Self {
            least: self.least.min(other.least),
            most: self.most.max(other.most),
            mean: (self.mean * own + other.mean * others) / (own + others),
        }
    }
}

/// All quantities over an interval of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bin {
    /// Where it begins [s].
    pub begin_s: f64,
    /// How much of it the run covers [s].
    pub length_s: f64,
    /// In the order of [`Quantity::ALL`].
    pub ranges: [Range; 6],
}

impl Bin {
    /// Its middle [s].
    pub fn middle_s(&self) -> f64 {
        self.begin_s + 0.5 * self.length_s
    }

    /// The values of a quantity.
    pub fn of(&self, quantity: Quantity) -> Range {
        self.ranges[quantity as usize]
    }

    fn join(&mut self, other: &Self) {
        for (range, next) in self.ranges.iter_mut().zip(other.ranges) {
            *range = range.joined(self.length_s, next, other.length_s);
        }
        self.length_s += other.length_s;
    }
}

/// The same bins, `n` of them made one.
pub fn coarser(bins: &[Bin], n: usize) -> Vec<Bin> {
    let join = |group: &[Bin]| {
        let (first, rest) = group.split_first()?;
        let mut whole = *first;
        rest.iter().for_each(|bin| whole.join(bin));
        Some(whole)
    };
    bins.chunks(n.max(1)).filter_map(join).collect()
}

/// A recorder of bins: every step is looked at, in its own mode, at both ends and at the nodes of a
/// quadrature, in each bin that it has a part in.
#[derive(Clone, Debug)]
pub struct Binning<'a> {
    block: &'a Block,
    width: f64,
    /// From t = 0 on, without a gap.
    pub bins: Vec<Bin>,
}

impl<'a> Binning<'a> {
    /// Bins of `width` [s] for a run of `block`.
    pub fn new(block: &'a Block, width: f64) -> Self {
        Self { block, width, bins: Vec::new() }
    }

    fn values(&self, mode: Mode, t: f64, y: &State<f64>) -> [f64; 6] {
        let mut dydt = *y;
        self.block.rhs(mode, t, y, &mut dydt);
        let force = self.block.forces(mode, y, &self.block.pose(y)).normal;
        let [d1, d2, theta, _, _, omega] = self.block.in_paper_order(y);
        [theta, omega, dydt[5], d1, d2, force]
    }
}

impl Record<Block> for Binning<'_> {
    fn step(&mut self, accepted: &Accepted<'_, Block>) -> ControlFlow<()> {
        let (mode, step) = (accepted.mode, accepted.step);
        let mut from = step.t0();
        while from < step.t1() {
            let below = (from / self.width).floor();
            // The quotient at the edge of a bin may round to the one before.
            let place = if (below + 1.0) * self.width > from { below } else { below + 1.0 };
            let to = ((place + 1.0) * self.width).min(step.t1());
            let length = to - from;
            let at = |part: f64| {
                let t = from + part * length;
                let mut y = *step.y0();
                step.interpolate(t, &mut y);
                self.values(mode, t, &y)
            };
            let ends = [at(0.0), at(1.0)];
            let inside = GAUSS.map(|(node, weight)| (weight, at(node)));
            let ranges = std::array::from_fn(|i| {
                let seen = ends.iter().chain(inside.iter().map(|(_, values)| values));
                let seen = seen.map(|values| values[i]);
                Range {
                    least: seen.clone().fold(f64::INFINITY, f64::min),
                    most: seen.fold(f64::NEG_INFINITY, f64::max),
                    mean: inside.iter().map(|(weight, values)| weight * values[i]).sum(),
                }
            });
            let part = Bin { begin_s: place * self.width, length_s: length, ranges };
            match self.bins.last_mut() {
                Some(last) if last.begin_s == part.begin_s => last.join(&part),
                _ => self.bins.push(part),
            }
            from = to;
        }
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use deltazero_solvers::Method;
    use deltazero_study::run::{Accuracy, Setting};
    use deltazero_study::setting::Events;

    use super::*;
    use crate::config::Config;
    use crate::model::{Jointed as _, Joints};

    #[test]
    fn bins_cover_the_run_without_a_gap_and_hold_its_integrals() {
        let config = Config::table1().unwrap();
        let block = &Joints::from(&config).blocks()[0].clone();
        let (method, accuracy) = (Method::named("vern98").unwrap(), Accuracy::Rtol(1e-10, None));
        let setting = Setting { method, events: Events::Located, accuracy };
        let mut record = Binning::new(block, 0.01);
        let run = block.integrate(&setting, block.initial_state(), 0.5, &mut record);
        let bins = record.bins;
        assert_eq!(bins.len(), 50);
        for (k, bin) in bins.iter().enumerate() {
            assert_eq!(bin.begin_s, k as f64 * 0.01);
            assert!((bin.length_s - 0.01).abs() < 1e-15);
            for range in bin.ranges {
                assert!(range.least <= range.mean && range.mean <= range.most, "{range:?}");
            }
        }
        // θ̇ and θ̈ integrate to θ and θ̇ at the end.
        let whole = coarser(&bins, bins.len())[0];
        let ends = [(Quantity::Omega, run.y[2]), (Quantity::Alpha, run.y[5])];
        for (quantity, end) in ends {
            let relative = whole.of(quantity).mean * 0.5 / end - 1.0;
            // Measured: 3.3e-16 and 7.8e-13.
            assert!(relative.abs() < 7e-12, "{quantity:?}: {relative:e}");
        }
    }
}

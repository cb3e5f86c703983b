//! A plan: which keys take which values in which run.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::draw::{Law, Place, Sampling, unit_of_run};
use super::saltelli;

/// Rounding of a whole number that is computed from the ends of its axis, in units of the larger end's; and where that is
/// much, how far it may be off.
const ROUNDING: f64 = 64.0 * f64::EPSILON;
const MOST_OFF: f64 = 1e-3;

/// What a sweep runs.
///
/// The grid is the product of the axes, the last one fastest; at each of its points there are so many draws. Nothing
/// of it is listed: the values of a run are computed from its number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The axes of the grid.
    pub axes: Vec<Axis>,
    /// The draws at each of its points.
    pub random: Option<Random>,
    /// Runs that are written together.
    pub chunk: u64,
    /// Whether runs tell of contacts and energy.
    #[serde(default = "audited")]
    pub audit: bool,
    /// Part of the runs whose error is estimated, from zero to one: the chance that each of them is.
    #[serde(default, skip_serializing_if = "is_none")]
    pub check: f64,
}

/// What the plans of earlier builds, which do not say it, had.
fn audited() -> bool {
    true
}

/// Whether no run is checked: then a plan is that of earlier builds, which did not say it.
fn is_none(check: &f64) -> bool {
    *check == 0.0
}

/// One key and the values that it takes in turn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Path of the key.
    pub key: String,
    /// Its values.
    pub values: Values,
}

/// The values of an axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Values {
    /// These.
    List(Vec<Value>),
    /// As many at equal distances, both ends included.
    Linear {
        /// First and last.
        ends: [f64; 2],
        /// Number of values.
        points: u64,
        /// Whether the key takes whole numbers.
        whole: bool,
    },
    /// As many at equal ratios, both ends included.
    Log {
        /// First and last.
        ends: [f64; 2],
        /// Number of values.
        points: u64,
        /// Whether the key takes whole numbers.
        whole: bool,
    },
}

impl Values {
    /// How many.
    pub fn len(&self) -> u64 {
        match self {
            Self::List(values) => values.len() as u64,
            Self::Linear { points, .. } | Self::Log { points, .. } => *points,
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The number `i` of them, where they are numbers at equal distances or ratios. Where the key takes whole numbers, one
    /// that is whole but for rounding is whole.
    pub fn number(&self, i: u64) -> Option<f64> {
        let (ends, points, whole) = match self {
            Self::List(_) => return None,
            Self::Linear { ends, points, whole } | Self::Log { ends, points, whole } => {
                (*ends, *points, *whole)
            }
        };
        let last = points.saturating_sub(1);
        let between = || {
            let (x, logs) = (i as f64 / last as f64, ends.map(libm::log10));
            match self {
                Self::Log { .. } => libm::exp10(logs[0] + x * (logs[1] - logs[0])),
                _ => ends[0] + x * (ends[1] - ends[0]),
            }
        };
        Some(match i {
            0 => ends[0],
            _ if i == last => ends[1],
            _ if whole => rounded(between(), ends),
            _ => between(),
        })
    }

    /// The number `i` of them.
    pub fn at(&self, i: u64) -> Value {
        match self {
            Self::List(values) => values[i as usize].clone(),
            Self::Linear { whole, .. } | Self::Log { whole, .. } => {
                let x = self.number(i).unwrap_or(f64::NAN);
                if *whole { Value::from(x as i64) } else { Value::from(x) }
            }
        }
    }
}

/// The whole number that `x`, computed from these ends, is but for rounding; else `x`.
fn rounded(x: f64, ends: [f64; 2]) -> f64 {
    let (near, largest) = (libm::round(x), ends[0].abs().max(ends[1].abs()));
    if (x - near).abs() <= (ROUNDING * largest).min(MOST_OFF) { near } else { x }
}

/// Draws at each point of the grid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Random {
    /// How many; in the design for Sobol indices each makes several runs.
    pub samples: u64,
    /// From what they follow.
    pub seed: u64,
    /// How they are spread.
    pub sampling: Sampling,
    /// What is drawn.
    pub keys: Vec<Draw>,
}

impl Random {
    /// Runs at each point of the grid.
    pub fn n_runs(&self) -> u64 {
        match self.sampling {
            Sampling::Saltelli => self.samples.saturating_mul(saltelli::runs(self.keys.len())),
            _ => self.samples,
        }
    }
}

/// One key and the distribution that it is drawn from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Draw {
    /// Path of the key.
    pub key: String,
    /// Its distribution.
    pub law: Law,
}

impl Plan {
    /// Whether the error of a run is estimated: drawn for each run, so that it follows no axis of the grid.
    pub fn is_checked(&self, run: u64) -> bool {
        let seed = self.random.as_ref().map_or(0, |random| random.seed);
        unit_of_run(seed, run) < self.check
    }

    /// The keys that it sets, in the order of their columns.
    pub fn keys(&self) -> Vec<&str> {
        let axes = self.axes.iter().map(|axis| axis.key.as_str());
        let drawn = self.random.iter().flat_map(|random| &random.keys);
        axes.chain(drawn.map(|draw| draw.key.as_str())).collect()
    }

    /// Points of the grid; none where they cannot be counted.
    pub fn n_points(&self) -> Option<u64> {
        self.axes.iter().try_fold(1_u64, |n, axis| n.checked_mul(axis.values.len()))
    }

    /// Runs at each point of the grid.
    pub fn n_samples(&self) -> u64 {
        self.random.as_ref().map_or(1, Random::n_runs)
    }

    /// Number of runs; none where they cannot be counted.
    pub fn n_runs(&self) -> Option<u64> {
        self.n_points()?.checked_mul(self.n_samples())
    }

    /// Where the run number `run` stands on each axis.
    pub fn indices(&self, run: u64, indices: &mut Vec<u64>) {
        indices.clear();
        indices.resize(self.axes.len(), 0);
        let mut rest = run / self.n_samples();
        for (index, axis) in indices.iter_mut().zip(&self.axes).rev() {
            *index = rest % axis.values.len();
            rest /= axis.values.len();
        }
    }

    /// The values of the run number `run`, which stands at `indices` on the axes.
    pub fn values(&self, run: u64, indices: &[u64], values: &mut Vec<Value>) {
        values.clear();
        values.extend(self.axes.iter().zip(indices).map(|(axis, i)| axis.values.at(*i)));
        let Some(random) = &self.random else { return };
        let (grid, at) = (run / random.n_runs(), run % random.n_runs());
        for (key, draw) in random.keys.iter().enumerate() {
            let (sample, key) = match random.sampling {
                Sampling::Saltelli => saltelli::place(at, key, random.keys.len()),
                _ => (at, key),
            };
            let place = Place { seed: random.seed, grid, sample, samples: random.samples, key };
            // −0 as 0, as every number of the configuration.
            values.push(Value::from(draw.law.at(place.unit(random.sampling)) + 0.0));
        }
    }
}

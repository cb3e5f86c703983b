//! Where does which method win? The contest over a grid of contact stiffness × damping × accuracy.

use std::ops::Deref;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use deltazero_study::Subject;
use deltazero_study::forecast::Forecast;
use deltazero_study::map::{Contested, MapPlan, contested, contests};
use serde::{Deserialize, Serialize};

use super::plan::{rules, sample_times};
use crate::config::Config;
use crate::keys::ReadingName;
use crate::model::inertia::BlockInertia;

/// The trial before the map runs this part of the time …
const TRIAL_PART: f64 = 0.02;
/// … but at least this long [s], or no pin has left its bush.
const TRIAL_LEAST_S: f64 = 0.02;
/// A preview runs no longer than this [s].
const QUICK_T_END: f64 = 0.25;

/// One cell of the map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Reading of the paper.
    pub reading: ReadingName,
    /// Contact stiffness K [N/mⁿ].
    pub stiffness: f64,
    /// Damping ratio ζ.
    pub damping_ratio: f64,
    /// The contest there.
    #[serde(flatten)]
    pub contest: Contested,
}

impl Deref for Cell {
    type Target = Contested;

    fn deref(&self) -> &Contested {
        &self.contest
    }
}

/// One problem of the map; its cells differ in accuracy alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// Reading of the paper.
    pub reading: ReadingName,
    /// Contact stiffness K [N/mⁿ].
    pub stiffness: f64,
    /// Damping ratio ζ.
    pub damping_ratio: f64,
}

impl Site {
    /// `D = 2ζ√(K m_ref)` [N s/m], m_ref the mass M_y of joint 1's struts 1, 2, 5 and 6 (6.126 kg).
    fn damping(&self, config: &Config) -> f64 {
        let m_ref = BlockInertia::joint_1(&config.strut).m_y;
        2.0 * self.damping_ratio * (self.stiffness * m_ref).sqrt()
    }

    /// `config` with this reading, stiffness and damping at both joints.
    fn config(&self, config: &Config) -> Config {
        let damping = self.damping(config);
        let mut own = config.clone();
        own.reading = self.reading;
        for joint in &mut own.joints {
            joint.contact.stiffness = self.stiffness;
            joint.contact.damping = damping;
        }
        own
    }

    /// What is studied there.
    fn subject(&self, config: &Config) -> Subject {
        let own = self.config(config);
        own.mechanism.subject(&own)
    }

    /// Its cells with these contests, one an accuracy.
    fn cells(&self, contests: Vec<Contested>) -> impl Iterator<Item = Cell> {
        let Self { reading, stiffness, damping_ratio } = *self;
        contests.into_iter().map(move |contest| Cell { reading, stiffness, damping_ratio, contest })
    }

    fn holds(&self, cell: &Cell) -> bool {
        self.reading == cell.reading
            && self.stiffness == cell.stiffness
            && self.damping_ratio == cell.damping_ratio
    }
}

impl std::fmt::Display for Site {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}, K = {:e}, ζ = {}", self.reading, self.stiffness, self.damping_ratio)
    }
}

/// The problems of a map: reading by reading, stiffness by stiffness.
pub fn sites(config: &Config) -> Vec<Site> {
    let grid = &config.regimes;
    let readings = grid.readings.clone().unwrap_or_else(|| vec![config.reading]);
    let mut sites = Vec::new();
    for reading in readings {
        for &stiffness in &grid.stiffness {
            for &damping_ratio in &grid.damping_ratio {
                sites.push(Site { reading, stiffness, damping_ratio });
            }
        }
    }
    sites
}

/// The preview of a map: every third stiffness, every second damping ratio, at most 0.25 s.
pub fn quick(config: &Config) -> Config {
    let mut quick = config.clone();
    let thin = |list: &[f64], n: usize| list.iter().copied().step_by(n).collect();
    quick.regimes.stiffness = thin(&config.regimes.stiffness, 3);
    quick.regimes.damping_ratio = thin(&config.regimes.damping_ratio, 2);
    quick.run.t_end = config.run.t_end.min(QUICK_T_END);
    quick
}

/// Shown how far something has come: so many of so many.
pub type Shown<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// What the sites not in `known` will take: from short runs at both ends of the stiffness, every damping ratio,
/// interpolated by a power law between them. None once `stop` is set; `shown` hears of each short run.
pub fn estimate(
    config: &Config,
    known: &[Cell],
    stop: &AtomicBool,
    shown: Shown<'_>,
) -> Option<Forecast> {
    let missing: Vec<Site> = missing(config, known);
    let mut short = config.clone();
    short.run.t_end = (TRIAL_PART * config.run.t_end).max(TRIAL_LEAST_S).min(config.run.t_end);
    let times = config.run.t_end / short.run.t_end;
    let stiffness = || missing.iter().map(|site| site.stiffness);
    let (low, high) =
        (stiffness().fold(f64::INFINITY, f64::min), stiffness().fold(0.0_f64, f64::max));
    let mut ratios: Vec<f64> = missing.iter().map(|site| site.damping_ratio).collect();
    ratios.sort_by(f64::total_cmp);
    ratios.dedup();
    let trials: Vec<(f64, f64)> =
        ratios.iter().flat_map(|&ratio| [(ratio, low), (ratio, high)]).collect();
    let mut measured: Vec<f64> = Vec::new();
    for (n, &(damping_ratio, stiffness)) in trials.iter().enumerate() {
        shown(n, trials.len());
        let start = Instant::now();
        let site = Site { stiffness, damping_ratio, ..*missing.first()? };
        contested(site.subject(&short), &map_plan(&short), stop);
        if stop.load(Ordering::Relaxed) {
            return None;
        }
        measured.push(start.elapsed().as_secs_f64());
    }
    shown(trials.len(), trials.len());
    let expected = |site: &Site| {
        let ratio = ratios.iter().position(|ratio| *ratio == site.damping_ratio)?;
        let (soft, stiff) = (measured.get(2 * ratio)?, measured.get(2 * ratio + 1)?);
        let part =
            if high > low { libm::log(site.stiffness / low) / libm::log(high / low) } else { 0.0 };
        Some(times * soft * libm::pow(stiff / soft, part))
    };
    let expected = missing.iter().map(|site| expected(site).unwrap_or(0.0)).collect();
    Some(Forecast::new(expected, config.regimes.threads))
}

/// The sites of which a cell is not known, the stiffest first: they take longest, and none of them is left for the end.
fn missing(config: &Config, known: &[Cell]) -> Vec<Site> {
    let n = config.regimes.accuracy.len();
    let is_missing = |site: &Site| known.iter().filter(|cell| site.holds(cell)).count() < n;
    let mut missing: Vec<Site> = sites(config).into_iter().filter(is_missing).collect();
    missing.sort_by(|a, b| b.stiffness.total_cmp(&a.stiffness));
    missing
}

/// A site that is done.
pub struct Done<'a> {
    /// Which.
    pub site: &'a Site,
    /// Its place among those that were to be done.
    pub place: usize,
    /// What it took.
    pub took: Duration,
    /// All cells so far.
    pub cells: &'a [Cell],
}

/// Runs the contest in every cell that is not `known`; `done` is shown each site that is. Returns the cells in the order of
/// the grid; once `stop` is set, those that were finished.
pub fn regimes(
    config: &Config,
    known: Vec<Cell>,
    stop: &AtomicBool,
    done: &(dyn Fn(&Done<'_>) + Sync),
) -> Vec<Cell> {
    let missing = missing(config, &known);
    let cells_so_far = Mutex::new(known);
    let (plan, threads) = (map_plan(config), config.regimes.threads);
    let subject = |site: &Site| site.subject(config);
    contests(&missing, subject, &plan, threads, stop, |place, own, took| {
        let (Some(site), Ok(mut all)) = (missing.get(place), cells_so_far.lock()) else { return };
        all.retain(|cell| !site.holds(cell));
        all.extend(site.cells(own));
        sort(config, &mut all);
        done(&Done { site, place, took, cells: &all });
    });
    cells_so_far.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Puts cells into the order of the grid.
fn sort(config: &Config, cells: &mut [Cell]) {
    let sites = sites(config);
    let place = |cell: &Cell| {
        let accuracy = config.regimes.accuracy.iter().position(|e| *e == cell.accuracy);
        (accuracy, sites.iter().position(|site| site.holds(cell)))
    };
    cells.sort_by_key(place);
}

/// The maps that the cells make up: a reading and an accuracy each.
pub fn maps(cells: &[Cell]) -> Vec<(ReadingName, f64)> {
    let mut maps = Vec::new();
    for cell in cells {
        let own = (cell.reading, cell.accuracy);
        if !maps.contains(&own) {
            maps.push(own);
        }
    }
    maps
}

/// The cells of one map.
pub fn of_map(cells: &[Cell], reading: ReadingName, accuracy: f64) -> Vec<&Cell> {
    cells.iter().filter(|cell| cell.reading == reading && cell.accuracy == accuracy).collect()
}

/// What every contest of a map has.
pub fn map_plan(config: &Config) -> MapPlan {
    MapPlan {
        t_end: config.run.t_end,
        times: sample_times(config),
        accuracies: config.regimes.accuracy.clone(),
        rules: rules(config),
        max_events: config.regimes.max_events,
        max_rhs: config.study.max_rhs,
        max_seconds: config.study.max_seconds,
    }
}

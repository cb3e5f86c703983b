//! Rows of `trajectory.csv` where every accepted step is one: they are bounded as those on a grid are.

use std::ops::ControlFlow;

use deltazero::config::{Config, MOST_ROWS, ROW_BYTES};
use deltazero_solvers::Stats;
use deltazero_study::run::{Brake, Setting};

use super::Failure;

/// The way out.
const WAY_OUT: &str = "give run.sample, or shorten run.t_end";

/// How many rows a run may make.
#[derive(Clone, Copy)]
pub(super) struct Rows {
    /// Of a part: each makes a row for each of its sites.
    most_steps: f64,
}

/// Breaks a run off where it has made too many rows, else leaves it to another brake.
pub(super) struct RowBrake<B> {
    rows: Rows,
    n_steps: f64,
    inner: B,
}

impl Rows {
    /// None yet of a run of `config`.
    ///
    /// # Errors
    /// [`Failure::Usage`] where fixed steps are known to make too many.
    pub(super) fn new(config: &Config, setting: &Setting) -> Result<Self, Failure> {
        if config.run.sample > 0.0 {
            return Ok(Self { most_steps: f64::INFINITY });
        }
        let n_sites = config.mechanism.n_sites(config) as f64;
        if let Some(step) = setting.step() {
            let rows = config.run.t_end / step * n_sites;
            if rows > MOST_ROWS {
                return Err(Failure::Usage(format!(
                    "run.sample = 0 at steps of {step:e} s makes {rows:.1e} rows of trajectory.csv, {:.1e} bytes, \
                     at most {MOST_ROWS:e} rows; {WAY_OUT}",
                    rows * ROW_BYTES
                )));
            }
        }
        Ok(Self { most_steps: MOST_ROWS / n_sites })
    }

    /// A brake of a run that begins now.
    pub(super) fn over<B: Brake>(self, inner: B) -> RowBrake<B> {
        RowBrake { rows: self, n_steps: 0.0, inner }
    }
}

impl<B> RowBrake<B> {
    /// Why the run was broken off, where it was by this brake.
    pub(super) fn complaint(&self, t: f64) -> Option<String> {
        (self.n_steps > self.rows.most_steps).then(|| {
            format!(
                "run.sample = 0 keeps every step, and they made more than {MOST_ROWS:e} rows of all sites by t = {t:e} s; {WAY_OUT}"
            )
        })
    }
}

impl<B: Brake> Brake for RowBrake<B> {
    fn step(&mut self, t: f64, stats: &Stats) -> ControlFlow<()> {
        self.n_steps += 1.0;
        if self.n_steps > self.rows.most_steps {
            return ControlFlow::Break(());
        }
        self.inner.step(t, stats)
    }

    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()> {
        self.inner.rejected(stats)
    }

    fn event(&mut self) -> ControlFlow<()> {
        self.inner.event()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use deltazero::model::{Jointed as _, Joints};
    use deltazero_solvers::Outcome;
    use deltazero_study::run::{Braked, Limits, Price};

    use super::*;

    #[test]
    fn a_run_with_too_many_steps_to_keep_is_broken_off_and_says_so() {
        let config = Config::load(None, &["run.sample=0".to_owned()]).unwrap();
        let (setting, joints) = (deltazero::run::setting(&config).unwrap(), Joints::from(&config));
        let mut rows = Rows::new(&config, &setting).unwrap();
        assert_eq!(rows.most_steps, 0.5 * MOST_ROWS);
        rows.most_steps = 10.0;
        let (stop, block) = (AtomicBool::new(false), joints.blocks()[0]);
        let mut brake = rows.over(Limits::none(&stop).watch(Price::of_setting(&setting)));
        let run = block.integrate(&setting, block.initial_state(), 2.0, &mut Braked(&mut brake));
        assert_eq!((run.outcome, run.stats.n_accepted), (Ok(Outcome::Interrupted), 11));
        let complaint = brake.complaint(run.t).unwrap();
        assert!(complaint.contains("run.sample = 0") && complaint.contains(WAY_OUT), "{complaint}");
    }

    #[test]
    fn samples_on_a_grid_never_break_a_run_off() {
        let config = Config::table1().unwrap();
        let rows = Rows::new(&config, &deltazero::run::setting(&config).unwrap()).unwrap();
        assert_eq!(rows.most_steps, f64::INFINITY);
    }
}

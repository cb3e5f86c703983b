//! Rows of `trajectory.csv` where every accepted step is one: they are bounded as those on a grid are.

use std::ops::ControlFlow;

use deltazero::config::{Config, MOST_ROWS, ROW_BYTES};
use deltazero_solvers::{Accepted, Event, Needs, Record, System};
use deltazero_study::run::Setting;

use super::Failure;

/// The way out.
const WAY_OUT: &str = "give run.sample, or shorten run.t_end";

/// A recorder that breaks a run off where it has made too many rows.
#[derive(Clone, Copy)]
pub(super) struct Rows {
    n_steps: f64,
    /// Of a part: each makes a row for each of its joints.
    most_steps: f64,
}

impl Rows {
    /// None yet of a run of `config`.
    ///
    /// # Errors
    /// [`Failure::Usage`] where fixed steps are known to make too many.
    pub(super) fn new(config: &Config, setting: &Setting) -> Result<Self, Failure> {
        if config.run.sample > 0.0 {
            return Ok(Self { n_steps: 0.0, most_steps: f64::INFINITY });
        }
        let n_joints = config.n_joints() as f64;
        if let Some(step) = setting.step() {
            let rows = config.run.t_end / step * n_joints;
            if rows > MOST_ROWS {
                return Err(Failure::Usage(format!(
                    "run.sample = 0 at steps of {step:e} s makes {rows:.1e} rows of trajectory.csv, {:.1e} bytes, \
                     at most {MOST_ROWS:e} rows; {WAY_OUT}",
                    rows * ROW_BYTES
                )));
            }
        }
        Ok(Self { n_steps: 0.0, most_steps: MOST_ROWS / n_joints })
    }

    /// Why the run was broken off, where it was.
    pub(super) fn complaint(&self, t: f64) -> Option<String> {
        (self.n_steps > self.most_steps).then(|| {
            format!(
                "run.sample = 0 keeps every step, and they made more than {MOST_ROWS:e} rows of all joints by t = {t:e} s; {WAY_OUT}"
            )
        })
    }
}

impl<P: System> Record<P> for Rows {
    fn step(&mut self, _: &Accepted<'_, P>) -> ControlFlow<()> {
        self.n_steps += 1.0;
        if self.n_steps > self.most_steps {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, _: &Event<'_, P>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Ends
    }
}

#[cfg(test)]
mod tests {
    use deltazero::model::Mechanism;
    use deltazero_solvers::Outcome;
    use deltazero_study::run::integrate;

    use super::*;

    #[test]
    fn a_run_with_too_many_steps_to_keep_is_broken_off_and_says_so() {
        let config = Config::load(None, &["run.sample=0".to_owned()]).unwrap();
        let (setting, mechanism) =
            (deltazero::run::setting(&config).unwrap(), Mechanism::new(&config));
        let mut rows = Rows::new(&config, &setting).unwrap();
        assert_eq!(rows.most_steps, 0.5 * MOST_ROWS);
        rows.most_steps = 10.0;
        let block = mechanism.blocks()[0];
        let run = integrate(block, &setting, block.initial_state(), 2.0, &mut rows);
        assert_eq!((run.outcome, run.stats.n_accepted), (Ok(Outcome::Interrupted), 11));
        let complaint = rows.complaint(run.t).unwrap();
        assert!(complaint.contains("run.sample = 0") && complaint.contains(WAY_OUT), "{complaint}");
    }

    #[test]
    fn samples_on_a_grid_never_break_a_run_off() {
        let config = Config::table1().unwrap();
        let rows = Rows::new(&config, &deltazero::run::setting(&config).unwrap()).unwrap();
        assert_eq!((rows.most_steps, rows.complaint(1.0)), (f64::INFINITY, None));
    }
}

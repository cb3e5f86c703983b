//! How does the step size of each method follow flight, contact and events?

use std::ops::ControlFlow;

use deltazero_solvers::{Accepted, Event, Method, Record};
use serde::{Deserialize, Serialize};

use crate::config::{Config, Events};
use crate::model::{Block, Mechanism};
use crate::run::{Accuracy, Limits, Setting, integrate};

/// Tolerance at which step sizes are shown.
const RTOL: f64 = 1e-6;
/// Step of the fixed-step methods at which they are shown, nearest to this many steps in a run.
const FIXED_STEPS: f64 = 2e4;

/// The steps of one method on joint 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepHistory {
    /// Method and setting.
    pub title: String,
    /// End [s] and size [s] of each accepted step.
    pub steps: Vec<(f64, f64)>,
    /// Times of the events [s].
    pub events: Vec<f64>,
}

struct Steps(StepHistory);

impl Record<Block> for Steps {
    fn step(&mut self, accepted: &Accepted<'_, Block>) -> ControlFlow<()> {
        let (t0, t1) = (accepted.step.t0(), accepted.step.t1());
        self.0.steps.push((t1, t1 - t0));
        ControlFlow::Continue(())
    }

    fn event(&mut self, event: &Event<'_, Block>) -> ControlFlow<()> {
        self.0.events.push(event.t);
        ControlFlow::Continue(())
    }

    fn interpolates(&self, _t0: f64, _t1: f64) -> bool {
        false
    }
}

/// The accepted steps of every method of the study on joint 1, events located: adaptive ones at
/// rtol 1e-6, fixed-step ones at the study's step nearest to 20 000 steps a run.
pub fn step_histories(config: &Config, limits: Limits<'_>) -> Vec<StepHistory> {
    let mechanism = Mechanism::new(config);
    let block = &mechanism.blocks[0];
    let methods = config.study.methods.iter().filter_map(|name| Method::named(name));
    let history = |method: &'static Method| {
        let accuracy = if method.is_fixed_step() {
            Accuracy::Step(shown_step(config)?)
        } else {
            Accuracy::Rtol(RTOL, config.solver.atol)
        };
        let setting = Setting { method, events: Events::Located, accuracy };
        let title = format!("{}, {accuracy}", method.name);
        let empty = StepHistory { title, steps: Vec::new(), events: Vec::new() };
        let mut record = (Steps(empty), limits);
        integrate(block, &setting, block.initial_state(), config.run.t_end, &mut record);
        Some(record.0.0)
    };
    methods.filter_map(history).collect()
}

fn shown_step(config: &Config) -> Option<f64> {
    let wanted = config.run.t_end / FIXED_STEPS;
    let distance = |step: &f64| libm::log(step / wanted).abs();
    config.study.steps.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

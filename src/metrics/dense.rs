//! How far a run is from the reference between the samples: on the run's dense output.

use std::ops::ControlFlow;

use deltazero_solvers::{Accepted, Event, Record};
use serde::{Deserialize, Serialize};

use super::{ErrorScale, sample_error, worse};
use crate::model::{Block, State};
use crate::quadrature::GAUSS;

/// Nodes beyond which every other one is left out.
const MOST_NODES: usize = 8192;

/// A state of the reference within one of its steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Node {
    /// Time [s].
    pub t: f64,
    /// Time that it stands for in an integral [s].
    pub weight: f64,
    /// State.
    pub y: State<f64>,
}

/// A recorder of nodes: the Gauss points of every step, so that they are dense where the motion is
/// fast; thinned out evenly where they are too many.
#[derive(Clone, Debug)]
pub struct Nodes {
    /// The nodes, in order.
    pub list: Vec<Node>,
    /// Every so many points is a node.
    stride: usize,
    /// Points since the last node, and what they stand for.
    since: (usize, f64),
}

impl Nodes {
    /// No nodes yet.
    pub fn new() -> Self {
        Self { list: Vec::new(), stride: 1, since: (0, 0.0) }
    }

    fn thin(&mut self) {
        self.list = self
            .list
            .chunks(2)
            .filter_map(|pair| {
                let last = pair.last()?;
                Some(Node { weight: pair.iter().map(|node| node.weight).sum(), ..*last })
            })
            .collect();
        self.stride *= 2;
    }
}

impl Default for Nodes {
    fn default() -> Self {
        Self::new()
    }
}

impl Record<Block> for Nodes {
    fn step(&mut self, accepted: &Accepted<'_, Block>) -> ControlFlow<()> {
        let step = accepted.step;
        let h = step.t1() - step.t0();
        for (node, weight) in GAUSS {
            self.since = (self.since.0 + 1, self.since.1 + weight * h);
            if self.since.0 == self.stride {
                let t = step.t0() + node * h;
                let mut y = *step.y0();
                step.interpolate(t, &mut y);
                self.list.push(Node { t, weight: self.since.1, y });
                self.since = (0, 0.0);
            }
        }
        if self.list.len() > MOST_NODES {
            self.thin();
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, _: &Event<'_, Block>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// A recorder that compares a run with the nodes of its reference.
#[derive(Clone, Debug)]
pub struct Distance<'a> {
    ahead: &'a [Node],
    scale: ErrorScale,
    /// Largest `e` at a node.
    pub largest: f64,
    /// ∫ e² dt [s].
    square: f64,
    /// Time compared [s].
    time: f64,
}

impl<'a> Distance<'a> {
    /// Nothing compared yet.
    pub fn new(nodes: &'a [Node], scale: ErrorScale) -> Self {
        Self { ahead: nodes, scale, largest: 0.0, square: 0.0, time: 0.0 }
    }

    /// `√(∫ e² dt / T)`; zero where nothing was compared.
    pub fn l2(&self) -> f64 {
        if self.time > 0.0 { (self.square / self.time).sqrt() } else { 0.0 }
    }
}

impl Record<Block> for Distance<'_> {
    fn step(&mut self, accepted: &Accepted<'_, Block>) -> ControlFlow<()> {
        let step = accepted.step;
        let mut y = *step.y0();
        while let [node, rest @ ..] = self.ahead
            && node.t <= step.t1()
        {
            step.interpolate(node.t, &mut y);
            let e = sample_error(&y, &node.y, self.scale);
            self.largest = worse(self.largest, e);
            self.square += node.weight * e * e;
            self.time += node.weight;
            self.ahead = rest;
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, _: &Event<'_, Block>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn interpolates(&self, _t0: f64, t1: f64) -> bool {
        self.ahead.first().is_some_and(|node| node.t < t1)
    }
}

#[cfg(test)]
mod tests {
    use deltazero_solvers::Method;

    use super::*;
    use crate::config::{Config, Events};
    use crate::model::Mechanism;
    use crate::run::{Accuracy, Setting, integrate};

    /// Runs joint 1 for 0.1 s.
    fn run(step: f64, record: &mut dyn Record<Block>) -> Block {
        let block = Mechanism::new(&Config::table1().unwrap()).blocks[0].clone();
        let method = Method::named("rk4").unwrap();
        let setting = Setting { method, events: Events::Located, accuracy: Accuracy::Step(step) };
        integrate(&block, &setting, block.initial_state(), 0.1, record);
        block
    }

    #[test]
    fn nodes_stand_for_all_of_time_however_many_steps_there_are() {
        for step in [1e-3, 1e-5] {
            let mut nodes = Nodes::new();
            run(step, &mut nodes);
            let time: f64 = nodes.list.iter().map(|node| node.weight).sum();
            // The last few points may not have made a node.
            assert!((time - 0.1).abs() < 10.0 * step, "{time}");
            assert!(nodes.list.len() <= MOST_NODES && nodes.list.is_sorted_by_key(|node| node.t));
        }
    }

    #[test]
    fn a_run_that_is_off_by_a_constant_has_it_as_maximum_and_as_mean() {
        let mut nodes = Nodes::new();
        let block = run(1e-4, &mut nodes);
        for node in &mut nodes.list {
            node.y[0] += 0.25 * block.clearance;
        }
        let mut distance = Distance::new(&nodes.list, ErrorScale::of(&block, 1.0));
        run(1e-4, &mut distance);
        // Measured: 1.1e-16 and 2.8e-17.
        for e in [distance.largest, distance.l2()] {
            assert!((e - 0.25).abs() < 1e-15, "{e}");
        }
    }
}

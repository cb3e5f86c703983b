//! How far a run is from the reference between the samples: on the run's dense output.

use std::ops::ControlFlow;

use deltazero_solvers::{Accepted, Event, Needs, Record};
use serde::{Deserialize, Serialize};

use super::{ErrorScale, sample_error, worse};
use crate::model::{Block, Jointed, State};
use crate::quadrature::GAUSS;

/// Nodes of all joints together beyond which every other one is left out.
const MOST_NODES: usize = 8192;
/// Nodes that a joint may have however many there are.
const LEAST_NODES: usize = 256;

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
pub struct Nodes<'a, P = Block> {
    part: &'a P,
    /// The nodes of each joint, in order and at the same times.
    pub lists: Vec<Vec<Node>>,
    /// Every so many points is a node.
    stride: usize,
    /// Points since the last node, and what they stand for.
    since: (usize, f64),
}

impl<'a, P: Jointed> Nodes<'a, P> {
    /// No nodes of a run of `part` yet.
    pub fn new(part: &'a P) -> Self {
        Self { part, lists: vec![Vec::new(); part.n_joints()], stride: 1, since: (0, 0.0) }
    }

    fn thin(&mut self) {
        let joined = |pair: &[Node]| {
            let last = pair.last()?;
            Some(Node { weight: pair.iter().map(|node| node.weight).sum(), ..*last })
        };
        for list in &mut self.lists {
            *list = list.chunks(2).filter_map(joined).collect();
        }
        self.stride *= 2;
    }
}

impl<P: Jointed> Record<P> for Nodes<'_, P> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        let step = accepted.step;
        let h = step.t1() - step.t0();
        for (node, weight) in GAUSS {
            self.since = (self.since.0 + 1, self.since.1 + weight * h);
            if self.since.0 == self.stride {
                let t = step.t0() + node * h;
                let mut y = step.y0().clone();
                step.interpolate(t, &mut y);
                let weight = self.since.1;
                for (k, list) in self.lists.iter_mut().enumerate() {
                    list.push(Node { t, weight, y: self.part.joint_state(&y, k) });
                }
                self.since = (0, 0.0);
            }
        }
        let most = (MOST_NODES / self.lists.len()).max(LEAST_NODES);
        if self.lists.iter().any(|list| list.len() > most) {
            self.thin();
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, _: &Event<'_, P>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// A recorder that compares a run with the nodes of its reference.
#[derive(Clone, Debug)]
pub struct Distance<'a, P = Block> {
    part: &'a P,
    /// What is found of each joint.
    pub joints: Vec<JointDistance<'a>>,
}

/// How far one joint is from the nodes of its reference.
#[derive(Clone, Debug)]
pub struct JointDistance<'a> {
    ahead: &'a [Node],
    scale: ErrorScale,
    /// Largest `e` at a node.
    pub largest: f64,
    /// ∫ e² dt [s].
    square: f64,
    /// Time compared [s].
    time: f64,
}

impl<'a> JointDistance<'a> {
    fn new((nodes, scale): (&'a [Node], ErrorScale)) -> Self {
        Self { ahead: nodes, scale, largest: 0.0, square: 0.0, time: 0.0 }
    }

    /// `√(∫ e² dt / T)`; zero where nothing was compared.
    pub fn l2(&self) -> f64 {
        if self.time > 0.0 { (self.square / self.time).sqrt() } else { 0.0 }
    }

    /// The node that comes next, if it is not after `t`.
    fn next(&self, t: f64) -> Option<Node> {
        self.ahead.first().filter(|node| node.t <= t).copied()
    }

    /// Compares the state at the next node with it.
    fn compare(&mut self, y: &State<f64>, node: &Node) {
        let e = sample_error(y, &node.y, self.scale);
        self.largest = worse(self.largest, e);
        self.square += node.weight * e * e;
        self.time += node.weight;
        self.ahead = &self.ahead[1..];
    }
}

impl<'a, P: Jointed> Distance<'a, P> {
    /// Nothing compared yet of a run of `part`; of each joint the nodes and scale of its reference, nodes at
    /// the same times.
    pub fn new(part: &'a P, joints: impl Iterator<Item = (&'a [Node], ErrorScale)>) -> Self {
        Self { part, joints: joints.map(JointDistance::new).collect() }
    }
}

impl<P: Jointed> Record<P> for Distance<'_, P> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        let step = accepted.step;
        let mut y = step.y0().clone();
        while let Some(t) = self.joints.iter().find_map(|own| own.next(step.t1())).map(|n| n.t) {
            step.interpolate(t, &mut y);
            for (k, own) in self.joints.iter_mut().enumerate() {
                if let Some(node) = own.next(t) {
                    own.compare(&self.part.joint_state(&y, k), &node);
                }
            }
        }
        ControlFlow::Continue(())
    }

    fn event(&mut self, _: &Event<'_, P>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn needs(&self, t0: f64, t1: f64) -> Needs {
        let nodes = self.joints.iter().filter_map(|own| own.ahead.first());
        let first = nodes.map(|node| node.t).reduce(f64::min);
        first.map_or(Needs::Nothing, |t| Needs::to_sample(t, t0, t1))
    }
}

#[cfg(test)]
mod tests {
    use deltazero_solvers::Method;

    use super::*;
    use crate::config::{Config, Events};
    use crate::model::Mechanism;
    use crate::run::{Accuracy, Setting, integrate};

    fn joint_1() -> Block {
        Mechanism::new(&Config::table1().unwrap()).blocks()[0].clone()
    }

    /// Runs `block` for 0.1 s.
    fn run(block: &Block, step: f64, record: &mut dyn Record<Block>) {
        let method = Method::named("rk4").unwrap();
        let setting = Setting { method, events: Events::Located, accuracy: Accuracy::Step(step) };
        integrate(block, &setting, block.initial_state(), 0.1, record);
    }

    #[test]
    fn nodes_stand_for_all_of_time_however_many_steps_there_are() {
        let block = joint_1();
        for step in [1e-3, 1e-5] {
            let mut nodes = Nodes::new(&block);
            run(&block, step, &mut nodes);
            let list = &nodes.lists[0];
            let time: f64 = list.iter().map(|node| node.weight).sum();
            // The last few points may not have made a node.
            assert!((time - 0.1).abs() < 10.0 * step, "{time}");
            assert!(list.len() <= MOST_NODES && list.is_sorted_by_key(|node| node.t));
        }
    }

    #[test]
    fn a_run_that_is_off_by_a_constant_has_it_as_maximum_and_as_mean() {
        let block = joint_1();
        let mut nodes = Nodes::new(&block);
        run(&block, 1e-4, &mut nodes);
        for node in &mut nodes.lists[0] {
            node.y[0] += 0.25 * block.clearance;
        }
        let of_joint = [(nodes.lists[0].as_slice(), ErrorScale::of(&block, 1.0))];
        let mut distance = Distance::new(&block, of_joint.into_iter());
        run(&block, 1e-4, &mut distance);
        // Measured: 1.1e-16 and 2.8e-17.
        for e in [distance.joints[0].largest, distance.joints[0].l2()] {
            assert!((e - 0.25).abs() < 1e-15, "{e}");
        }
    }
}

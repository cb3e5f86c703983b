//! How far a run is from the reference between the samples: on the run's dense output.

use std::ops::ControlFlow;

use deltazero_solvers::{Accepted, Needs, Record};
use serde::{Deserialize, Serialize};

use super::{ErrorScale, worse};
use crate::problem::Problem;
use crate::quadrature::GAUSS;

/// Nodes of all sites together beyond which every other one is left out.
const MOST_NODES: usize = 8192;
/// Nodes that a site may have however many there are.
const LEAST_NODES: usize = 256;

/// A state of the reference within one of its steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Node {
    /// Time [s].
    pub t: f64,
    /// Time that it stands for in an integral [s].
    pub weight: f64,
    /// State.
    pub y: Vec<f64>,
}

/// A recorder of nodes: the Gauss points of every step, so that they are dense where the motion is
/// fast; thinned out evenly where they are too many.
#[derive(Clone, Debug)]
pub struct Nodes {
    /// The nodes, in order.
    pub list: Vec<Node>,
    /// Most nodes.
    most: usize,
    /// Every so many points is a node.
    stride: usize,
    /// Points since the last node, and what they stand for.
    since: (usize, f64),
}

impl Nodes {
    /// No nodes of a run of a problem with so many sites yet.
    pub fn new(n_sites: usize) -> Self {
        let most = (MOST_NODES / n_sites).max(LEAST_NODES);
        Self { list: Vec::new(), most, stride: 1, since: (0, 0.0) }
    }

    fn thin(&mut self) {
        let joined = |pair: &mut [Node]| {
            let weight = pair.iter().map(|node| node.weight).sum();
            let last = pair.last_mut()?;
            Some(Node { t: last.t, weight, y: std::mem::take(&mut last.y) })
        };
        self.list = self.list.chunks_mut(2).filter_map(joined).collect();
        self.stride *= 2;
    }
}

impl<P: Problem> Record<P> for Nodes {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        let step = accepted.step;
        let h = step.t1() - step.t0();
        for (node, weight) in GAUSS {
            self.since = (self.since.0 + 1, self.since.1 + weight * h);
            if self.since.0 == self.stride {
                let t = step.t0() + node * h;
                let mut y = step.y0().clone();
                step.interpolate(t, &mut y);
                self.list.push(Node { t, weight: self.since.1, y: y.as_ref().to_vec() });
                self.since = (0, 0.0);
            }
        }
        if self.list.len() > self.most {
            self.thin();
        }
        ControlFlow::Continue(())
    }
}

/// A recorder that compares a run with the nodes of its reference.
#[derive(Clone, Debug)]
pub struct Distance<'a> {
    ahead: &'a [Node],
    scale: &'a ErrorScale,
    /// Time compared [s].
    time: f64,
    /// What is found of each site.
    pub sites: Vec<SiteDistance>,
}

/// How far one site is from the nodes of its reference.
#[derive(Clone, Copy, Debug, Default)]
pub struct SiteDistance {
    /// Largest `e` at a node.
    pub largest: f64,
    /// ∫ e² dt [s].
    square: f64,
}

impl<'a> Distance<'a> {
    /// Nothing compared yet of a run of a problem with so many sites.
    pub fn new(n_sites: usize, nodes: &'a [Node], scale: &'a ErrorScale) -> Self {
        Self { ahead: nodes, scale, time: 0.0, sites: vec![SiteDistance::default(); n_sites] }
    }

    /// `√(∫ e² dt / T)` of each site; zero where nothing was compared.
    pub fn l2(&self) -> Vec<f64> {
        let l2 = |site: &SiteDistance| (site.square / self.time).sqrt();
        self.sites.iter().map(|site| if self.time > 0.0 { l2(site) } else { 0.0 }).collect()
    }
}

impl<P: Problem> Record<P> for Distance<'_> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        let step = accepted.step;
        let mut y = step.y0().clone();
        while let Some((node, rest)) = self.ahead.split_first()
            && node.t <= step.t1()
        {
            step.interpolate(node.t, &mut y);
            for (k, site) in self.sites.iter_mut().enumerate() {
                let e = self.scale.error_of_site(k, y.as_ref(), &node.y);
                site.largest = worse(site.largest, e);
                site.square += node.weight * e * e;
            }
            self.time += node.weight;
            self.ahead = rest;
        }
        ControlFlow::Continue(())
    }

    fn needs(&self, t0: f64, t1: f64) -> Needs {
        self.ahead.first().map_or(Needs::Nothing, |node| Needs::to_sample(node.t, t0, t1))
    }
}

#[cfg(test)]
mod tests {
    use deltazero_solvers::Method;
    use deltazero_solvers::problems::CompliantBall;

    use super::*;
    use crate::errors::ScaledGroup;
    use crate::problems::balls::LIGHT_BALL;
    use crate::run::{Accuracy, Events, Setting, integrate};

    /// Runs the ball for 0.1 s.
    fn run(step: f64, record: &mut dyn Record<CompliantBall>) {
        let method = Method::named("rk4").unwrap();
        let setting = Setting { method, events: Events::Located, accuracy: Accuracy::Step(step) };
        integrate(&LIGHT_BALL, &setting, LIGHT_BALL.start, 0.1, record);
    }

    #[test]
    fn nodes_stand_for_all_of_time_however_many_steps_there_are() {
        for step in [1e-3, 1e-5] {
            let mut nodes = Nodes::new(1);
            run(step, &mut nodes);
            let time: f64 = nodes.list.iter().map(|node| node.weight).sum();
            // The last few points may not have made a node.
            assert!((time - 0.1).abs() < 10.0 * step, "{time}");
            assert!(nodes.list.len() <= MOST_NODES && nodes.list.is_sorted_by_key(|node| node.t));
            // Two nodes are joined to one whenever there are too many.
            assert!(nodes.stride.is_power_of_two(), "{}", nodes.stride);
        }
    }

    #[test]
    fn a_run_that_is_off_by_a_constant_has_it_as_maximum_and_as_mean() {
        let mut nodes = Nodes::new(1);
        run(1e-4, &mut nodes);
        for node in &mut nodes.list {
            node.y[0] += 0.25 * LIGHT_BALL.gap;
        }
        let group =
            |states: &[usize], scale| ScaledGroup { states: states.to_vec(), scale, site: 0 };
        let groups = vec![group(&[0], LIGHT_BALL.gap), group(&[1], 1.0)];
        let scale = ErrorScale { groups, event_window: 1e-3 };
        let mut distance = Distance::new(1, &nodes.list, &scale);
        run(1e-4, &mut distance);
        // Measured: 1.1e-16 and 2.8e-17.
        for e in [distance.sites[0].largest, distance.l2()[0]] {
            assert!((e - 0.25).abs() < 1e-15, "{e}");
        }
    }
}

//! The problem at points of a step: both ends, and the nodes of a quadrature between them.

use deltazero_solvers::{Accepted, System};

use crate::problem::Problem;
use crate::quadrature::Nodes;
use crate::setting::Events;

/// A problem at one point of a step.
pub(crate) struct Point<P: System> {
    /// Time [s].
    pub(crate) t: f64,
    /// Time that the point stands for [s]: zero of both ends.
    pub(crate) weight: f64,
    pub(crate) mode: P::Mode,
    pub(crate) y: P::State<f64>,
    /// The slope of the state, once it was asked for.
    pub(crate) slope: Option<P::State<f64>>,
}

impl<P: System> Point<P> {
    /// Sets time, weight and mode, and forgets the slope. The state is that at `t` already.
    fn stand_at(&mut self, t: f64, weight: f64, mode: impl FnOnce(f64, &P::State<f64>) -> P::Mode) {
        (self.t, self.weight) = (t, weight);
        self.mode = mode(t, &self.y);
        self.slope = None;
    }
}

/// The points of the step looked at last, in the order of time.
pub(crate) struct Points<P: System> {
    nodes: Nodes,
    list: Vec<Point<P>>,
}

impl<P: Problem> Points<P> {
    /// The points of a quadrature by `nodes`; none before the first step.
    pub(crate) fn of(nodes: Nodes) -> Self {
        Self { nodes, list: Vec::new() }
    }

    /// Looks at a step of a run of `problem` that treats events in this way.
    pub(crate) fn look(&mut self, problem: &P, events: Events, accepted: &Accepted<'_, P>) {
        let (step, begun) = (accepted.step, &accepted.mode);
        let (t0, h) = (step.t0(), step.t1() - step.t0());
        let inside = |t: f64, y: &P::State<f64>| mode_inside(problem, events, begun, t, y);
        // Made once: each step writes over the points of the one before.
        let new =
            || Point { t: t0, weight: 0.0, mode: begun.clone(), y: step.y0().clone(), slope: None };
        self.list.resize_with(self.nodes.len() + 2, new);
        let [first, nodes @ .., last] = &mut self.list[..] else { return };
        first.y.clone_from(step.y0());
        first.stand_at(t0, 0.0, inside);
        for (point, (node, weight)) in nodes.iter_mut().zip(self.nodes) {
            let t = t0 + node * h;
            step.interpolate(t, &mut point.y);
            point.stand_at(t, weight * h, inside);
        }
        last.y.clone_from(step.y1());
        last.stand_at(step.t1(), 0.0, inside);
    }

    /// Both ends and the nodes of the quadrature.
    pub(crate) fn all(&mut self) -> &mut [Point<P>] {
        &mut self.list
    }

    /// The nodes of the quadrature alone.
    pub(crate) fn nodes(&self) -> &[Point<P>] {
        match &self.list[..] {
            [_, nodes @ .., _] => nodes,
            _ => &[],
        }
    }
}

/// The mode of `problem` at `(t, y)` inside a step begun in the mode `begun`.
pub(crate) fn mode_inside<P: Problem>(
    problem: &P,
    events: Events,
    begun: &P::Mode,
    t: f64,
    y: &P::State<f64>,
) -> P::Mode {
    match events {
        Events::Located => begun.clone(),
        Events::Blind => problem.mode_read(begun, t, y),
    }
}

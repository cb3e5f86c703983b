//! Derivatives of formulas, as formulas.

use std::collections::{HashMap, HashSet};

use crate::functions::Elementary;
use crate::graph::{Graph, Id, Node};

/// `dg/dt = ∂g/∂t + Σ ∂g/∂x_i ẋ_i`, where the rates of all states are given.
pub(crate) fn along_flow(graph: &mut Graph, of: Id, rates: &[Id]) -> Id {
    let nodes = graph.used_by([of].iter());
    let one = graph.constant(1.0);
    derivatives(graph, nodes, one, rates)[&of]
}

/// The derivatives of these nodes, all nodes that they are made of among them, in a direction: that of the time and of each
/// state are given.
pub(crate) fn derivatives(
    graph: &mut Graph,
    nodes: HashSet<Id>,
    of_time: Id,
    of_states: &[Id],
) -> HashMap<Id, Id> {
    let mut nodes: Vec<Id> = nodes.into_iter().collect();
    // Operands have smaller numbers, so they come first.
    nodes.sort_unstable();
    let mut derivatives = HashMap::with_capacity(nodes.len());
    for id in nodes {
        let derivative = derivative(graph, id, (of_time, of_states), &derivatives);
        derivatives.insert(id, derivative);
    }
    derivatives
}

fn derivative(
    graph: &mut Graph,
    id: Id,
    (of_time, of_states): (Id, &[Id]),
    known: &HashMap<Id, Id>,
) -> Id {
    let rate = |a: Id| known[&a];
    match graph.node(id) {
        Node::Constant(_) | Node::Held(_) => graph.constant(0.0),
        Node::Time => of_time,
        Node::State(i) => of_states[i as usize],
        Node::Negative(a) => graph.negative(rate(a)),
        Node::Add(a, b) => graph.add(rate(a), rate(b)),
        Node::Subtract(a, b) => graph.subtract(rate(a), rate(b)),
        Node::Multiply(a, b) => {
            let [first, second] = [graph.multiply(rate(a), b), graph.multiply(a, rate(b))];
            graph.add(first, second)
        }
        // (a/b)˙ = (ȧ − (a/b) ḃ)/b
        Node::Divide(a, b) => {
            let less = graph.multiply(id, rate(b));
            let over = graph.subtract(rate(a), less);
            graph.divide(over, b)
        }
        Node::Elementary(function, a) => {
            let slope = slope(graph, function, a, id);
            graph.multiply(slope, rate(a))
        }
        // (x ẏ − y ẋ)/(x² + y²)
        Node::ArcTangent(y, x) => {
            let [first, second] = [graph.multiply(x, rate(y)), graph.multiply(y, rate(x))];
            let over = graph.subtract(first, second);
            let squares = [graph.multiply(x, x), graph.multiply(y, y)];
            let under = graph.add(squares[0], squares[1]);
            graph.divide(over, under)
        }
        Node::Smaller(a, b) => {
            let is_second = is_above(graph, a, b);
            chosen(graph, is_second, rate(a), rate(b))
        }
        Node::Larger(a, b) => {
            let is_second = is_above(graph, b, a);
            chosen(graph, is_second, rate(a), rate(b))
        }
        // p aᵖ/a would divide by zero at the surface of a contact.
        Node::Power(a, p) => {
            let p = f64::from_bits(p);
            let [factor, exponent] = [graph.constant(p), graph.constant(p - 1.0)];
            // Below zero the power is that of a whole number, or is continued as an odd function.
            let is_odd = p > 1.0 && p.fract() != 0.0;
            let base = if is_odd { graph.elementary(Elementary::Abs, a) } else { a };
            let power = graph.power(base, exponent);
            let slope = graph.multiply(factor, power);
            graph.multiply(slope, rate(a))
        }
    }
}

/// 1 where `a > b`, else 0.
fn is_above(graph: &mut Graph, a: Id, b: Id) -> Id {
    let (gap, zero) = (graph.subtract(a, b), graph.constant(0.0));
    let sign = graph.elementary(Elementary::Sign, gap);
    graph.larger(sign, zero)
}

/// `b` where `is_second` is 1, `a` where it is 0.
fn chosen(graph: &mut Graph, is_second: Id, a: Id, b: Id) -> Id {
    let one = graph.constant(1.0);
    let is_first = graph.subtract(one, is_second);
    let [a, b] = [graph.multiply(is_first, a), graph.multiply(is_second, b)];
    graph.add(a, b)
}

/// `f′(a)`, where `f(a)` is `value`.
fn slope(graph: &mut Graph, function: Elementary, a: Id, value: Id) -> Id {
    let one = graph.constant(1.0);
    match function {
        Elementary::Sqrt => {
            let half = graph.constant(0.5);
            graph.divide(half, value)
        }
        // Zero at zero, where the slope of the squares is zero, and not 0·∞.
        Elementary::Norm => {
            let [half, least] = [0.5, f64::MIN_POSITIVE].map(|x| graph.constant(x));
            let sign = graph.elementary(Elementary::Sign, value);
            let [over, under] = [graph.multiply(half, sign), graph.larger(value, least)];
            graph.divide(over, under)
        }
        Elementary::Sin => graph.elementary(Elementary::Cos, a),
        Elementary::Cos => {
            let sin = graph.elementary(Elementary::Sin, a);
            graph.negative(sin)
        }
        Elementary::Exp => value,
        Elementary::Ln => graph.divide(one, a),
        Elementary::Log10 => {
            let factor = graph.constant(std::f64::consts::LOG10_E);
            graph.divide(factor, a)
        }
        Elementary::Sinh => graph.elementary(Elementary::Cosh, a),
        Elementary::Cosh => graph.elementary(Elementary::Sinh, a),
        Elementary::Tanh => {
            let square = graph.multiply(value, value);
            graph.subtract(one, square)
        }
        Elementary::Abs => {
            let [zero, less] = [0.0, -1.0].map(|x| graph.constant(x));
            let is_below = is_above(graph, zero, a);
            chosen(graph, is_below, one, less)
        }
        Elementary::Sign => graph.constant(0.0),
    }
}

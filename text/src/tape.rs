//! A tape: the operations of some formulas in order, with registers for their results.

use std::collections::HashMap;

use crate::functions::Elementary;
use crate::graph::{Graph, Id, Node};

/// A register.
pub(crate) type Register = u32;

/// An operation: what it writes, what it reads, and constants.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Instruction {
    Add {
        to: Register,
        a: Register,
        b: Register,
    },
    Subtract {
        to: Register,
        a: Register,
        b: Register,
    },
    Multiply {
        to: Register,
        a: Register,
        b: Register,
    },
    Divide {
        to: Register,
        a: Register,
        b: Register,
    },
    AddConstant {
        to: Register,
        a: Register,
        c: f64,
    },
    /// `c − a`
    ConstantLess {
        to: Register,
        a: Register,
        c: f64,
    },
    MultiplyConstant {
        to: Register,
        a: Register,
        c: f64,
    },
    DivideConstant {
        to: Register,
        a: Register,
        c: f64,
    },
    /// `c/a`
    ConstantOver {
        to: Register,
        a: Register,
        c: f64,
    },
    Constant {
        to: Register,
        c: f64,
    },
    Negative {
        to: Register,
        a: Register,
    },
    SinCos {
        sin: Register,
        cos: Register,
        a: Register,
    },
    Elementary {
        to: Register,
        a: Register,
        function: Elementary,
    },
    ArcTangent {
        to: Register,
        y: Register,
        x: Register,
    },
    Smaller {
        to: Register,
        a: Register,
        b: Register,
    },
    Larger {
        to: Register,
        a: Register,
        b: Register,
    },
    Power {
        to: Register,
        a: Register,
        p: f64,
    },
}

/// What is read into a register before the first operation.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Input {
    Time,
    State(u32),
    Held(u8),
}

/// What a tape reads.
#[derive(Debug)]
pub(crate) struct Inputs<'a, S> {
    pub(crate) t: S,
    pub(crate) y: &'a [S],
    pub(crate) held: &'a [f64],
}

/// Where a result is at the end of a tape, or of its first part.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Output {
    Register(Register),
    Constant(f64),
}

/// The operations of one or two groups of formulas: those of the first group come first.
#[derive(Debug, Default)]
pub(crate) struct Tape {
    pub(crate) inputs: Vec<(Register, Input)>,
    pub(crate) first: Vec<Instruction>,
    pub(crate) first_outputs: Vec<Output>,
    pub(crate) second: Vec<Instruction>,
    pub(crate) second_outputs: Vec<Output>,
    pub(crate) n_registers: usize,
}

impl Tape {
    /// The tape of two groups, of which the first can be run alone; the second may be empty.
    pub(crate) fn of(graph: &Graph, first: &[Id], second: &[Id]) -> Self {
        let mut order = Order::new(graph);
        order.add(first);
        let split = order.nodes.len();
        order.add(second);
        let mut writer = Writer::new(graph, &order, split, [first, second]);
        let [one, two] = [0..split, split..order.nodes.len()];
        let mut tape = Self { inputs: writer.inputs(), ..Self::default() };
        tape.first = writer.instructions(one);
        tape.first_outputs = writer.outputs(first);
        tape.second = writer.instructions(two);
        tape.second_outputs = writer.outputs(second);
        tape.n_registers = writer.n_registers;
        tape
    }
}

/// The nodes that need an operation or an input, in the order of operations.
struct Order<'a> {
    graph: &'a Graph,
    nodes: Vec<Id>,
    inputs: Vec<Id>,
    is_known: HashMap<Id, ()>,
}

/// Whether an operand that is a constant stands in the operation itself.
fn takes_constants(node: Node) -> bool {
    matches!(node, Node::Add(..) | Node::Subtract(..) | Node::Multiply(..) | Node::Divide(..))
}

impl<'a> Order<'a> {
    fn new(graph: &'a Graph) -> Self {
        Self { graph, nodes: Vec::new(), inputs: Vec::new(), is_known: HashMap::new() }
    }

    /// Adds the nodes of these outputs, operands first.
    fn add(&mut self, outputs: &[Id]) {
        for output in outputs {
            if self.graph.value(*output).is_none() {
                self.visit(*output);
            }
        }
    }

    fn visit(&mut self, output: Id) {
        let mut stack = vec![(output, false)];
        while let Some((id, is_ready)) = stack.pop() {
            if is_ready {
                self.nodes.push(id);
                continue;
            }
            if self.is_known.insert(id, ()).is_some() {
                continue;
            }
            let node = self.graph.node(id);
            if matches!(node, Node::Time | Node::State(_) | Node::Held(_)) {
                self.inputs.push(id);
                continue;
            }
            stack.push((id, true));
            let in_place = takes_constants(node);
            let operands: Vec<_> = node.operands().collect();
            for operand in operands.into_iter().rev() {
                if !(in_place && self.graph.value(operand).is_some()) {
                    stack.push((operand, false));
                }
            }
        }
    }
}

/// Gives registers to nodes as long as they are needed.
struct Writer<'a> {
    graph: &'a Graph,
    order: &'a Order<'a>,
    /// Position of the last operation that reads a node.
    last_use: HashMap<Id, usize>,
    registers: HashMap<Id, Register>,
    free: Vec<Register>,
    n_registers: usize,
}

impl<'a> Writer<'a> {
    fn new(graph: &'a Graph, order: &'a Order<'a>, split: usize, outputs: [&[Id]; 2]) -> Self {
        let mut last_use = HashMap::new();
        for (position, id) in order.nodes.iter().enumerate() {
            for operand in graph.node(*id).operands() {
                last_use.insert(operand, position);
            }
        }
        // An output is read at the end of its part.
        for (outputs, end) in outputs.iter().zip([split, order.nodes.len()]) {
            for output in *outputs {
                let last = last_use.entry(*output).or_insert(end);
                *last = end.max(*last);
            }
        }
        Self { graph, order, last_use, registers: HashMap::new(), free: Vec::new(), n_registers: 0 }
    }

    fn inputs(&mut self) -> Vec<(Register, Input)> {
        let order = self.order;
        let input = |id: &Id| {
            let input = match self.graph.node(*id) {
                Node::State(i) => Input::State(i),
                Node::Held(i) => Input::Held(i),
                _ => Input::Time,
            };
            (self.give(*id), input)
        };
        order.inputs.iter().map(input).collect()
    }

    fn give(&mut self, id: Id) -> Register {
        let register = self.free.pop().unwrap_or_else(|| {
            self.n_registers += 1;
            (self.n_registers - 1) as Register
        });
        self.registers.insert(id, register);
        register
    }

    /// The register of an operand.
    fn at(&self, id: Id) -> Register {
        self.registers[&id]
    }

    fn instructions(&mut self, range: std::ops::Range<usize>) -> Vec<Instruction> {
        let order = self.order;
        let mut all = Vec::with_capacity(range.len());
        for position in range {
            let id = order.nodes[position];
            // The other half of a sine and cosine wrote this one already.
            if !self.registers.contains_key(&id) {
                let instruction = self.instruction(id, position);
                all.push(instruction);
            }
        }
        all
    }

    /// The operation of a node; the registers that it reads last are free for what it writes.
    fn instruction(&mut self, id: Id, position: usize) -> Instruction {
        let node = self.graph.node(id);
        let read: Vec<Id> = node.operands().collect();
        let [c, d] = [0, 1].map(|i| read.get(i).and_then(|id| self.graph.value(*id)));
        // A constant that stands in the operation, and an operand that there is not, have no register.
        let in_place = takes_constants(node);
        let has_register = |id: &&Id| !(in_place && self.graph.value(**id).is_some());
        let [a, b] = [0, 1]
            .map(|i| read.get(i).filter(has_register).map_or(Register::MAX, |id| self.at(*id)));
        for (i, operand) in read.iter().enumerate() {
            let is_last = self.last_use.get(operand).is_some_and(|last| *last <= position);
            if is_last && !read[..i].contains(operand) && self.registers.contains_key(operand) {
                self.free.push(self.at(*operand));
            }
        }
        if let Node::Elementary(function @ (Elementary::Sin | Elementary::Cos), _) = node {
            let [sin, cos] = [Elementary::Sin, Elementary::Cos]
                .map(|function| self.graph.known(Node::Elementary(function, read[0])));
            let other = if function == Elementary::Sin { cos } else { sin };
            if let (Some(sin), Some(cos), Some(other)) = (sin, cos, other)
                && self.order.is_known.contains_key(&other)
            {
                let [sin, cos] = [sin, cos].map(|id| self.give(id));
                return Instruction::SinCos { sin, cos, a };
            }
        }
        let to = self.give(id);
        match (node, c, d) {
            (Node::Constant(bits), ..) => Instruction::Constant { to, c: f64::from_bits(bits) },
            (Node::Negative(_), ..) => Instruction::Negative { to, a },
            (Node::Add(..), _, Some(c)) => Instruction::AddConstant { to, a, c },
            (Node::Add(..), Some(c), _) => Instruction::AddConstant { to, a: b, c },
            (Node::Add(..), ..) => Instruction::Add { to, a, b },
            (Node::Subtract(..), Some(c), _) => Instruction::ConstantLess { to, a: b, c },
            (Node::Subtract(..), _, Some(c)) => Instruction::AddConstant { to, a, c: -c },
            (Node::Subtract(..), ..) => Instruction::Subtract { to, a, b },
            (Node::Multiply(..), _, Some(c)) => Instruction::MultiplyConstant { to, a, c },
            (Node::Multiply(..), Some(c), _) => Instruction::MultiplyConstant { to, a: b, c },
            (Node::Multiply(..), ..) => Instruction::Multiply { to, a, b },
            (Node::Divide(..), Some(c), _) => Instruction::ConstantOver { to, a: b, c },
            (Node::Divide(..), _, Some(c)) => Instruction::DivideConstant { to, a, c },
            (Node::Divide(..), ..) => Instruction::Divide { to, a, b },
            (Node::Elementary(function, _), ..) => Instruction::Elementary { to, a, function },
            (Node::ArcTangent(..), ..) => Instruction::ArcTangent { to, y: a, x: b },
            (Node::Smaller(..), ..) => Instruction::Smaller { to, a, b },
            (Node::Larger(..), ..) => Instruction::Larger { to, a, b },
            (Node::Power(_, p), ..) => Instruction::Power { to, a, p: f64::from_bits(p) },
            (Node::Time | Node::State(_) | Node::Held(_), ..) => {
                unreachable!("an input has no operation")
            }
        }
    }

    fn outputs(&self, ids: &[Id]) -> Vec<Output> {
        let output = |id: &Id| match self.graph.value(*id) {
            Some(c) => Output::Constant(c),
            None => Output::Register(self.at(*id)),
        };
        ids.iter().map(output).collect()
    }
}

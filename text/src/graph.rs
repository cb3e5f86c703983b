//! The graph of all formulas of a model: each subexpression once, constants folded.

use std::collections::{HashMap, HashSet};

use deltazero_solvers::Real;

use crate::functions::{Elementary, power};

/// A node of a graph, by its number. Operands have smaller numbers than what is made of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Id(pub(crate) u32);

/// A node: an input, a constant or an operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Node {
    /// A number, by its bits.
    Constant(u64),
    Time,
    State(u32),
    /// A value that the mode holds, by its place there.
    Held(u8),
    Negative(Id),
    Add(Id, Id),
    Subtract(Id, Id),
    Multiply(Id, Id),
    Divide(Id, Id),
    Elementary(Elementary, Id),
    /// `atan2(y, x)`.
    ArcTangent(Id, Id),
    Smaller(Id, Id),
    Larger(Id, Id),
    /// A power with a number that is not whole, by its bits.
    Power(Id, u64),
}

impl Node {
    /// What it is made of.
    pub(crate) fn operands(self) -> impl Iterator<Item = Id> {
        let [a, b] = match self {
            Self::Constant(_) | Self::Time | Self::State(_) | Self::Held(_) => [None, None],
            Self::Negative(a) | Self::Elementary(_, a) | Self::Power(a, _) => [Some(a), None],
            Self::Add(a, b)
            | Self::Subtract(a, b)
            | Self::Multiply(a, b)
            | Self::Divide(a, b)
            | Self::ArcTangent(a, b)
            | Self::Smaller(a, b)
            | Self::Larger(a, b) => [Some(a), Some(b)],
        };
        a.into_iter().chain(b)
    }
}

/// The largest whole exponent for which a power is a product.
const LARGEST_PRODUCT: f64 = 64.0;

/// The nodes.
#[derive(Debug, Default)]
pub(crate) struct Graph {
    nodes: Vec<Node>,
    numbers: HashMap<Node, Id>,
}

impl Graph {
    pub(crate) fn len(&self) -> usize {
        self.nodes.len()
    }

    pub(crate) fn node(&self, id: Id) -> Node {
        self.nodes[id.0 as usize]
    }

    /// The number of a node, which is new or as before.
    pub(crate) fn id(&mut self, node: Node) -> Id {
        let next = Id(self.nodes.len() as u32);
        let id = *self.numbers.entry(node).or_insert(next);
        if id == next {
            self.nodes.push(node);
        }
        id
    }

    /// The number of a node that is there.
    pub(crate) fn known(&self, node: Node) -> Option<Id> {
        self.numbers.get(&node).copied()
    }

    pub(crate) fn constant(&mut self, x: f64) -> Id {
        self.id(Node::Constant(x.to_bits()))
    }

    /// The number that the node is, if it is a constant.
    pub(crate) fn value(&self, id: Id) -> Option<f64> {
        match self.node(id) {
            Node::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    fn values(&self, a: Id, b: Id) -> (Option<f64>, Option<f64>) {
        (self.value(a), self.value(b))
    }

    pub(crate) fn negative(&mut self, a: Id) -> Id {
        match self.node(a) {
            Node::Constant(bits) => self.constant(-f64::from_bits(bits)),
            Node::Negative(inner) => inner,
            Node::Subtract(x, y) => self.subtract(y, x),
            _ => self.id(Node::Negative(a)),
        }
    }

    pub(crate) fn add(&mut self, a: Id, b: Id) -> Id {
        match (self.values(a, b), self.node(a), self.node(b)) {
            ((Some(a), Some(b)), ..) => self.constant(a + b),
            ((Some(0.0), _), ..) => b,
            ((_, Some(0.0)), ..) => a,
            (_, _, Node::Negative(b)) => self.subtract(a, b),
            (_, Node::Negative(a), _) => self.subtract(b, a),
            _ => {
                let (a, b) = self.ordered(a, b);
                self.id(Node::Add(a, b))
            }
        }
    }

    pub(crate) fn subtract(&mut self, a: Id, b: Id) -> Id {
        match (self.values(a, b), self.node(b)) {
            ((Some(a), Some(b)), _) => self.constant(a - b),
            ((Some(0.0), _), _) => self.negative(b),
            ((_, Some(0.0)), _) => a,
            ((_, Some(b)), _) => {
                let less = self.constant(-b);
                self.id(Node::Add(a, less))
            }
            (_, Node::Negative(b)) => self.add(a, b),
            _ if a == b => self.constant(0.0),
            _ => self.id(Node::Subtract(a, b)),
        }
    }

    /// A product with zero is zero, whatever the other factor: a parameter that is zero takes its term away.
    pub(crate) fn multiply(&mut self, a: Id, b: Id) -> Id {
        match (self.values(a, b), self.node(a), self.node(b)) {
            ((Some(a), Some(b)), ..) => self.constant(a * b),
            ((Some(0.0), _) | (_, Some(0.0)), ..) => self.constant(0.0),
            ((Some(1.0), _), ..) => b,
            ((_, Some(1.0)), ..) => a,
            ((Some(-1.0), _), ..) => self.negative(b),
            ((_, Some(-1.0)), ..) => self.negative(a),
            ((_, Some(c)), Node::Negative(a), _) | ((Some(c), _), _, Node::Negative(a)) => {
                let c = self.constant(-c);
                self.id(Node::Multiply(a, c))
            }
            _ => {
                let (a, b) = self.ordered(a, b);
                self.id(Node::Multiply(a, b))
            }
        }
    }

    pub(crate) fn divide(&mut self, a: Id, b: Id) -> Id {
        match (self.values(a, b), self.node(a)) {
            ((Some(a), Some(b)), _) => self.constant(a / b),
            ((Some(0.0), _), _) => a,
            ((_, Some(1.0)), _) => a,
            ((_, Some(-1.0)), _) => self.negative(a),
            ((_, Some(c)), Node::Negative(a)) => {
                let c = self.constant(-c);
                self.id(Node::Divide(a, c))
            }
            _ => self.id(Node::Divide(a, b)),
        }
    }

    /// `aᵇ`: a product where b is whole, a root where it is a half, else [`power`] or `e^(b ln a)`.
    pub(crate) fn power(&mut self, a: Id, b: Id) -> Id {
        match self.values(a, b) {
            (Some(a), Some(b)) if b.fract() != 0.0 || b.abs() > LARGEST_PRODUCT => {
                self.constant(if b.fract() == 0.0 { libm::pow(a, b) } else { power(a, b) })
            }
            (_, Some(0.5)) => self.root(a),
            (_, Some(-0.5)) => {
                let root = self.root(a);
                self.reciprocal(root)
            }
            (_, Some(p)) if p.fract() == 0.0 && p.abs() <= LARGEST_PRODUCT => {
                let product = self.product(a, p.abs() as u32);
                if p < 0.0 { self.reciprocal(product) } else { product }
            }
            (_, Some(p)) => self.id(Node::Power(a, p.to_bits())),
            (_, None) => {
                let ln = self.elementary(Elementary::Ln, a);
                let exponent = self.multiply(b, ln);
                self.elementary(Elementary::Exp, exponent)
            }
        }
    }

    /// `√a`, which is a norm where a is made of squares.
    pub(crate) fn root(&mut self, a: Id) -> Id {
        let is_norm = matches!(self.sign(a), Sign::Square | Sign::Squares);
        self.elementary(if is_norm { Elementary::Norm } else { Elementary::Sqrt }, a)
    }

    fn reciprocal(&mut self, a: Id) -> Id {
        let one = self.constant(1.0);
        self.divide(one, a)
    }

    /// `aⁿ` by repeated squaring.
    fn product(&mut self, a: Id, mut n: u32) -> Id {
        let (mut square, mut product) = (a, self.constant(1.0));
        while n > 0 {
            if n % 2 == 1 {
                product = self.multiply(product, square);
            }
            n /= 2;
            if n > 0 {
                square = self.multiply(square, square);
            }
        }
        product
    }

    pub(crate) fn elementary(&mut self, function: Elementary, a: Id) -> Id {
        match self.value(a) {
            Some(a) => self.constant(function.of(a)),
            None => self.id(Node::Elementary(function, a)),
        }
    }

    pub(crate) fn arc_tangent(&mut self, y: Id, x: Id) -> Id {
        match self.values(y, x) {
            (Some(y), Some(x)) => self.constant(Real::atan2(y, x)),
            _ => self.id(Node::ArcTangent(y, x)),
        }
    }

    pub(crate) fn smaller(&mut self, a: Id, b: Id) -> Id {
        match self.values(a, b) {
            (Some(a), Some(b)) => self.constant(Real::min(a, b)),
            _ if a == b => a,
            _ => self.id(Node::Smaller(a, b)),
        }
    }

    pub(crate) fn larger(&mut self, a: Id, b: Id) -> Id {
        match self.values(a, b) {
            (Some(a), Some(b)) => self.constant(Real::max(a, b)),
            _ if a == b => a,
            _ => self.id(Node::Larger(a, b)),
        }
    }

    /// The operands of a sum or product in the order that makes equal ones the same node: a constant last, else the
    /// newest last.
    fn ordered(&self, a: Id, b: Id) -> (Id, Id) {
        let is_first = match self.values(a, b) {
            (None, Some(_)) => true,
            (Some(_), None) => false,
            _ => a <= b,
        };
        if is_first { (a, b) } else { (b, a) }
    }
}

impl Graph {
    /// All nodes that these are made of, themselves included.
    pub(crate) fn used_by<'a>(&self, ids: impl Iterator<Item = &'a Id>) -> HashSet<Id> {
        let (mut stack, mut used): (Vec<Id>, _) = (ids.copied().collect(), HashSet::new());
        while let Some(id) = stack.pop() {
            if used.insert(id) {
                stack.extend(self.node(id).operands());
            }
        }
        used
    }

    /// Whether one of the nodes is of the time itself.
    pub(crate) fn is_of_time(&self, ids: &[Id]) -> bool {
        self.known(Node::Time).is_some_and(|time| self.used_by(ids.iter()).contains(&time))
    }

    /// Those of all nodes that change within a mode. What a node is made of was made before it.
    pub(crate) fn varying(&self) -> HashSet<Id> {
        let mut varying = HashSet::new();
        for (number, node) in self.nodes.iter().enumerate() {
            let is_moving = matches!(node, Node::Time | Node::State(_));
            if is_moving || node.operands().any(|operand| varying.contains(&operand)) {
                varying.insert(Id(number as u32));
            }
        }
        varying
    }

    /// Whether the node is made of a value that a mode keeps, of which the discrete ones come first.
    pub(crate) fn is_of_kept(&self, id: Id, n_discrete: usize) -> bool {
        let is_kept = |id: &Id| match self.node(*id) {
            Node::Held(i) => usize::from(i) >= n_discrete,
            _ => false,
        };
        self.used_by([id].iter()).iter().any(is_kept)
    }
}

/// What is seen of a formula's sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Sign {
    Unknown,
    /// A square: what moves takes it through zero.
    Square,
    /// A sum of squares, which are zero together at single points.
    Squares,
    Above,
}

/// How far [`Graph::sign`] looks.
const LOOK: usize = 8;

impl Graph {
    pub(crate) fn sign(&self, id: Id) -> Sign {
        self.sign_within(id, LOOK)
    }

    fn sign_within(&self, id: Id, left: usize) -> Sign {
        let Some(left) = left.checked_sub(1) else { return Sign::Unknown };
        let both = |a, b| [a, b].map(|id| self.sign_within(id, left));
        match self.node(id) {
            Node::Constant(bits) if f64::from_bits(bits) > 0.0 => Sign::Above,
            Node::Multiply(a, b) if a == b => self.sign_within(a, left).max(Sign::Square),
            Node::Multiply(a, b) | Node::Divide(a, b) => {
                let [a, b] = both(a, b);
                a.min(b)
            }
            Node::Add(a, b) => match both(a, b) {
                [Sign::Unknown, _] | [_, Sign::Unknown] => Sign::Unknown,
                [Sign::Above, _] | [_, Sign::Above] => Sign::Above,
                _ => Sign::Squares,
            },
            Node::Elementary(Elementary::Exp | Elementary::Cosh, _) => Sign::Above,
            Node::Elementary(Elementary::Abs, a) => self.sign_within(a, left).max(Sign::Square),
            Node::Constant(bits) if f64::from_bits(bits) == 0.0 => Sign::Square,
            Node::Larger(a, b) => {
                let [a, b] = both(a, b);
                a.max(b)
            }
            _ => Sign::Unknown,
        }
    }
}

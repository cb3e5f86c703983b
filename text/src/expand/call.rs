//! Functions of a formula.

use deltazero_study::digits::count_of;

use super::{Expander, Flaw, of_logarithm, of_root};
use crate::expression::Expression;
use crate::functions::Elementary;
use crate::graph::{Id, Node};
use crate::names::FUNCTIONS;
use crate::report::{Checked, Complaint, Span};

impl Expander<'_> {
    pub(super) fn call(&mut self, name: &str, arguments: &[Expression], span: Span) -> Checked<Id> {
        let Some((known, n)) = FUNCTIONS.iter().find(|(function, _)| *function == name) else {
            let complaint = Complaint::new(span, format!("no function is called `{name}`"));
            return Err(match self.names.meaning(name, span, None) {
                Ok(_) => complaint.help("a product is written with `*`"),
                Err(_) => complaint.nearest(name, FUNCTIONS.iter().map(|(name, _)| *name)),
            });
        };
        if arguments.len() != *n {
            let (own, given) = (count_of(*n, "argument"), arguments.len());
            let message = format!("`{name}` has {own}, not {given}");
            let help = match n {
                1 => format!("write `{name}(x)`"),
                _ => format!("write `{name}(x, y)`"),
            };
            return Err(Complaint::new(span, message).help(help));
        }
        let a = self.node(&arguments[0])?;
        let node = match arguments.get(1) {
            Some(b) => {
                let b = self.node(b)?;
                self.of_two(name, a, b)
            }
            None => self.of_one(name, a),
        };
        let flaw = match (self.graph.node(node), *known) {
            // `sqrt` and `hypot`
            (Node::Elementary(Elementary::Sqrt | Elementary::Norm, a), _) => {
                of_root(self.graph.sign(a))
            }
            (_, "log" | "ln" | "log10") => of_logarithm(self.graph.sign(a)),
            (_, "asin" | "acos") => Some(Flaw::Edge("beyond −1 and 1")),
            (_, "abs" | "sign" | "min" | "max") => Some(Flaw::Kink),
            _ => None,
        };
        self.flaw(node, (span, known), flaw);
        Ok(node)
    }

    /// Notes a flaw of the function that gives `node`.
    pub(super) fn flaw(
        &mut self,
        node: Id,
        (span, function): (Span, &'static str),
        flaw: Option<Flaw>,
    ) {
        if let Some(flaw) = flaw {
            self.flawed.entry(node).or_insert((span, function, flaw));
        }
    }

    fn of_two(&mut self, name: &str, a: Id, b: Id) -> Id {
        let graph = &mut self.graph;
        match name {
            "min" => graph.smaller(a, b),
            "max" => graph.larger(a, b),
            "atan2" => graph.arc_tangent(a, b),
            // hypot
            _ => {
                let squares = [graph.multiply(a, a), graph.multiply(b, b)];
                let sum = graph.add(squares[0], squares[1]);
                graph.root(sum)
            }
        }
    }

    fn of_one(&mut self, name: &str, a: Id) -> Id {
        let graph = &mut self.graph;
        let function = match name {
            "sqrt" => return graph.root(a),
            "sin" => Elementary::Sin,
            "cos" => Elementary::Cos,
            "exp" => Elementary::Exp,
            "log10" => Elementary::Log10,
            "sinh" => Elementary::Sinh,
            "cosh" => Elementary::Cosh,
            "tanh" => Elementary::Tanh,
            "abs" => Elementary::Abs,
            "sign" => Elementary::Sign,
            "tan" => {
                let [sin, cos] = [Elementary::Sin, Elementary::Cos]
                    .map(|function| graph.elementary(function, a));
                return graph.divide(sin, cos);
            }
            "atan" => {
                let one = graph.constant(1.0);
                return graph.arc_tangent(a, one);
            }
            "asin" => {
                let cos = self.leg(a);
                return self.graph.arc_tangent(a, cos);
            }
            "acos" => {
                let sin = self.leg(a);
                return self.graph.arc_tangent(sin, a);
            }
            // log and ln
            _ => Elementary::Ln,
        };
        graph.elementary(function, a)
    }

    /// `√(1 − a²)`, as `√((1 − a)(1 + a))`, which keeps its digits near a = ±1.
    fn leg(&mut self, a: Id) -> Id {
        let graph = &mut self.graph;
        let one = graph.constant(1.0);
        let (below, above) = (graph.subtract(one, a), graph.add(a, one));
        let product = graph.multiply(below, above);
        graph.elementary(Elementary::Sqrt, product)
    }
}

//! The Jacobian of a mode's rates, as formulas.

use crate::derivative::derivatives;
use crate::functions::Elementary;
use crate::graph::{Graph, Id, Node};
use crate::program::Program;
use crate::sparsity::{Column, Sparsity};
use crate::tape::Inputs;
use crate::vector::Buffer;

/// Nodes of a model that are differentiated, by one state each, after which a mode's Jacobian has no formulas: to write them takes
/// longer than they save.
pub(crate) const MOST_NODES: usize = 200_000;
/// Entries that are computed without memory of their own.
const FEW: usize = 36;
/// How many operations a dual number takes for one, about.
const DUAL: usize = 3;

/// The entries that can be nonzero in some mode, with their formulas in this one.
#[derive(Debug)]
pub(crate) struct Jacobian {
    /// Row and column of each result.
    places: Vec<(u32, u32)>,
    pub(crate) program: Program,
}

impl Jacobian {
    /// Of these rates, which take `n_operations`; `left` of [`MOST_NODES`] may be differentiated. None where they are so long, or
    /// depend on so much, that dual numbers are faster, or where they have a kink: there dual numbers follow the branch that
    /// the value takes, and a formula has both.
    pub(crate) fn new(
        graph: &mut Graph,
        (rates, n_operations): (&[Id], usize),
        sparsity: &Sparsity,
        left: &mut usize,
    ) -> Option<Self> {
        let Sparsity::Known(groups) = sparsity else { return None };
        if graph.used_by(rates.iter()).into_iter().any(|id| has_kink(graph.node(id))) {
            return None;
        }
        let [zero, one] = [0.0, 1.0].map(|x| graph.constant(x));
        let mut direction = vec![zero; rates.len()];
        let (mut places, mut entries) = (Vec::new(), Vec::new());
        for Column { column, rows } in groups.iter().flatten() {
            let nodes = graph.used_by(rows.iter().map(|i| &rates[*i as usize]));
            *left = left.checked_sub(nodes.len())?;
            direction[*column] = one;
            let derivatives = derivatives(graph, nodes, zero, &direction);
            direction[*column] = zero;
            places.extend(rows.iter().map(|i| (*i, *column as u32)));
            entries.extend(rows.iter().map(|i| derivatives[&rates[*i as usize]]));
        }
        let program = Program::of(graph, &entries);
        let is_short = program.tape.first.len() <= DUAL * groups.len() * n_operations;
        is_short.then_some(Self { places, program })
    }

    /// Tells each entry: row, column, value.
    pub(crate) fn tell(&self, inputs: &Inputs<'_, f64>, mut entry: impl FnMut(usize, usize, f64)) {
        let mut buffer = Buffer::<f64, FEW>::new(self.places.len());
        let values = buffer.numbers();
        self.program.run(inputs, values);
        for ((row, column), value) in self.places.iter().zip(values) {
            entry(*row as usize, *column as usize, *value);
        }
    }
}

fn has_kink(node: Node) -> bool {
    matches!(node, Node::Smaller(..) | Node::Larger(..) | Node::Elementary(Elementary::Abs, _))
}

#[cfg(test)]
mod tests {
    use crate::ModelFile;

    #[test]
    fn smooth_rates_have_formulas_and_kinks_have_none() {
        let has_formulas = |rate: &str| {
            let text = format!("[states]\nx = 1\n[modes.a]\nrates = {{ x = \"{rate}\" }}\n");
            let file = ModelFile::parse("rate.toml", &text).unwrap();
            file.models(&[]).unwrap()[0].0.modes[0].jacobian.is_some()
        };
        let every = "sin(x) - cos(x)^3 + exp(-x)*tanh(x) + x^66 + (x + 3)^0.3 + 2/x + sinh(x) - cosh(x)*sqrt(x + 3) \
                     + log(x + 4)/log10(x + 3) + atan2(x, x + 1)";
        for rate in [every, "-x^3", "sin(x)*exp(-x)", "x^1.5 + sign(x)", "t"] {
            assert!(has_formulas(rate), "{rate}");
        }
        for rate in ["abs(x)", "min(x, 1)", "max(0, sqrt(x))"] {
            assert!(!has_formulas(rate), "{rate}");
        }
    }
}

//! Which rate depends on which state, and which states can be differentiated by at once.

use crate::graph::{Graph, Id, Node};

/// Steps of the search after which the Jacobian is taken for full.
const MOST_STEPS: usize = 30_000_000;
/// Pairs of columns with a common row after which each column is taken alone.
const MOST_PAIRS: usize = 50_000_000;

/// A column of a Jacobian, with the rows where it can be nonzero.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    pub(crate) column: usize,
    pub(crate) rows: Vec<u32>,
}

/// The entries of a Jacobian that can be nonzero in some mode.
#[derive(Clone, Debug)]
pub(crate) enum Sparsity {
    /// Groups of columns; those of one group have no row in common.
    Known(Vec<Vec<Column>>),
    /// Not known: any entry.
    Full,
}

impl Sparsity {
    /// The pattern of these rates, those of each mode.
    pub(crate) fn new(graph: &Graph, rates: &[Vec<Id>]) -> Self {
        let n = rates.first().map_or(0, Vec::len);
        let Some(columns) = columns(graph, rates, n) else { return Self::Full };
        let colours = colours(&columns, n);
        let n_groups = colours.iter().max().map_or(0, |most| most + 1);
        let mut groups = vec![Vec::new(); n_groups];
        for ((column, rows), colour) in columns.into_iter().enumerate().zip(colours) {
            if !rows.is_empty() {
                groups[colour].push(Column { column, rows });
            }
        }
        Self::Known(groups)
    }
}

/// A number for each column, different for two columns that have a row in common: the least that is left.
fn colours(columns: &[Vec<u32>], n: usize) -> Vec<usize> {
    let mut rows: Vec<Vec<usize>> = vec![Vec::new(); n];
    for (column, of) in columns.iter().enumerate() {
        of.iter().for_each(|row| rows[*row as usize].push(column));
    }
    let n_pairs: usize = rows.iter().map(|row| row.len() * row.len()).sum();
    if n_pairs > MOST_PAIRS {
        return (0..columns.len()).collect();
    }
    let mut colours = vec![usize::MAX; columns.len()];
    // The column that a colour was last refused to.
    let mut refused = vec![usize::MAX; columns.len() + 1];
    for (column, of) in columns.iter().enumerate() {
        for other in of.iter().flat_map(|row| &rows[*row as usize]) {
            if let Some(refused) = refused.get_mut(colours[*other]) {
                *refused = column;
            }
        }
        colours[column] = refused.iter().position(|last| *last != column).unwrap_or(column);
    }
    colours
}

/// The rows of each column; none where the search would take too long.
fn columns(graph: &Graph, rates: &[Vec<Id>], n: usize) -> Option<Vec<Vec<u32>>> {
    let mut columns: Vec<Vec<u32>> = vec![Vec::new(); n];
    let mut search = Search::new(graph);
    for row in 0..n {
        for rates in rates {
            search.states(rates[row], |j| {
                let column = &mut columns[j as usize];
                if column.last() != Some(&(row as u32)) {
                    column.push(row as u32);
                }
            })?;
        }
    }
    Some(columns)
}

/// The least span such that none of `guards` depends on two of the `n` states whose indices differ by a multiple of it; `n` where the
/// search would take too long.
pub(crate) fn span(graph: &Graph, guards: &[Id], n: usize) -> usize {
    let (mut search, mut left) = (Search::new(graph), MOST_PAIRS);
    let (mut states, mut differ) = (Vec::new(), vec![false; n]);
    for guard in guards {
        states.clear();
        let found = search.states(*guard, |j| states.push(j));
        let Some(rest) = left.checked_sub(states.len() * states.len()) else { return n };
        if found.is_none() {
            return n;
        }
        left = rest;
        for a in &states {
            states.iter().for_each(|b| differ[a.abs_diff(*b) as usize] = true);
        }
    }
    let is_apart = |span: &usize| !(*span..n).step_by(*span).any(|distance| differ[distance]);
    (1..n).find(is_apart).unwrap_or(n)
}

/// Which states formulas depend on.
struct Search<'a> {
    graph: &'a Graph,
    /// The formula that each node was last seen in.
    seen: Vec<u32>,
    formula: u32,
    left: usize,
}

impl<'a> Search<'a> {
    fn new(graph: &'a Graph) -> Self {
        Self { graph, seen: vec![0; graph.len()], formula: 0, left: MOST_STEPS }
    }

    /// Tells the states that `formula` depends on, each once; none where this would take too long.
    fn states(&mut self, formula: Id, mut told: impl FnMut(u32)) -> Option<()> {
        self.formula += 1;
        let mut stack = vec![formula];
        while let Some(id) = stack.pop() {
            if std::mem::replace(&mut self.seen[id.0 as usize], self.formula) == self.formula {
                continue;
            }
            self.left = self.left.checked_sub(1)?;
            if let Node::State(j) = self.graph.node(id) {
                told(j);
            }
            stack.extend(self.graph.node(id).operands());
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_needs_three_groups() {
        let n = 50;
        let near = |i: usize| (i.saturating_sub(1)..(i + 2).min(n)).map(|j| j as u32).collect();
        let columns: Vec<Vec<u32>> = (0..n).map(near).collect();
        let colours = colours(&columns, n);
        assert_eq!(colours.iter().max(), Some(&2));
        for i in 0..n {
            for j in (i + 1)..(i + 3).min(n) {
                assert_ne!(colours[i], colours[j], "{i} and {j}");
            }
        }
    }

    #[test]
    fn columns_with_one_full_row_are_taken_one_by_one() {
        let columns = vec![vec![0]; 20];
        assert_eq!(colours(&columns, 20), (0..20).collect::<Vec<_>>());
    }

    #[test]
    fn guards_of_neighbours_have_a_span_of_two_and_one_of_all_states_has_all() {
        let mut graph = Graph::default();
        let states: Vec<Id> = (0..9).map(|i| graph.id(Node::State(i))).collect();
        let mut gaps: Vec<Id> = states.windows(2).map(|two| graph.add(two[0], two[1])).collect();
        assert_eq!(span(&graph, &gaps, 9), 2);
        let far = graph.add(states[0], states[2]);
        gaps.push(far);
        assert_eq!(span(&graph, &gaps, 9), 3);
        let all = states.iter().skip(1).fold(states[0], |sum, state| graph.add(sum, *state));
        assert_eq!(span(&graph, &[all], 9), 9);
        assert_eq!(span(&graph, &[], 9), 1);
    }
}

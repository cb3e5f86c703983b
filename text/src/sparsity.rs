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
    let (mut seen, mut mark, mut left) = (vec![0_u32; graph.len()], 0, MOST_STEPS);
    for row in 0..n {
        for rates in rates {
            mark += 1;
            let mut stack = vec![rates[row]];
            while let Some(id) = stack.pop() {
                if std::mem::replace(&mut seen[id.0 as usize], mark) == mark {
                    continue;
                }
                left = left.checked_sub(1)?;
                if let Node::State(j) = graph.node(id) {
                    let column = &mut columns[j as usize];
                    if column.last() != Some(&(row as u32)) {
                        column.push(row as u32);
                    }
                }
                stack.extend(graph.node(id).operands());
            }
        }
    }
    Some(columns)
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
}

//! Order conditions of Runge–Kutta and Rosenbrock methods: one condition for each rooted tree.

/// A rooted tree, and its terms in the order condition of a method.
#[derive(Clone, Debug)]
pub struct Tree {
    /// Number of its nodes.
    pub order: usize,
    /// Its density γ.
    pub density: f64,
    /// Its elementary weight Φ_i at each stage.
    pub weights: Vec<f64>,
}

/// All rooted trees of up to `order` nodes, sorted by order, with their elementary weights in a method of
/// `many.len()` stages. The arguments are rows of the method's matrices; entries beyond the end of a row are zero.
///
/// ```text
/// t = [t₁ … t_m]:   γ(t) = |t| Π γ(t_k),   Φ_i(t) = Π_k Σ_j e_ij Φ_j(t_k)
/// e = `single` for m = 1, `many` for m ≥ 2;   of a single node γ = Φ_i = 1
/// ```
///
/// `|t|` is the number of nodes. For a Runge–Kutta method both arguments are the matrix `a`. For a Rosenbrock method,
/// `many` is α and `single` is α + γ of its tableau.
///
/// E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I*, II.2;
/// E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, IV.7.
///
/// ```
/// use deltazero_solvers::methods::CLASSICAL_4;
/// use deltazero_solvers::order_conditions::trees;
///
/// let all = trees(&CLASSICAL_4.a, &CLASSICAL_4.a, 5);
/// let of_order = |order| all.iter().filter(|tree| tree.order == order).count();
/// assert_eq!([1, 2, 3, 4, 5].map(of_order), [1, 1, 2, 4, 9]);
/// // Of two nodes, one on the other: γ = 2, and Φ_i = c_i.
/// assert_eq!((all[1].density, &all[1].weights[..]), (2.0, &CLASSICAL_4.c[..]));
/// ```
pub fn trees(many: &[&[f64]], single: &[&[f64]], order: usize) -> Vec<Tree> {
    let mut trees: Vec<Tree> = Vec::new();
    for n in 1..=order {
        let grown: Vec<_> = forests(&trees, n - 1, 0)
            .into_iter()
            .map(|children| {
                let edges = if children.len() == 1 { single } else { many };
                let mut tree = Tree { order: n, density: n as f64, weights: vec![1.0; many.len()] };
                for child in children.into_iter().map(|i| &trees[i]) {
                    tree.density *= child.density;
                    for (weight, row) in tree.weights.iter_mut().zip(edges) {
                        *weight *= dot(row, &child.weights);
                    }
                }
                tree
            })
            .collect();
        trees.extend(grown);
    }
    trees
}

/// All multisets of `trees`, from index `first` on, that have `n` nodes together, as indices.
fn forests(trees: &[Tree], n: usize, first: usize) -> Vec<Vec<usize>> {
    if n == 0 {
        return vec![Vec::new()];
    }
    let mut all = Vec::new();
    for i in (first..trees.len()).filter(|&i| trees[i].order <= n) {
        for mut forest in forests(trees, n - trees[i].order, i) {
            forest.push(i);
            all.push(forest);
        }
    }
    all
}

/// Residuals `Σ b_i Φ_i(t) − 1/γ(t)` of the weights `b` over `trees`. They are zero for all trees up to the order of
/// the method.
///
/// ```
/// use deltazero_solvers::methods::CLASSICAL_4;
/// use deltazero_solvers::order_conditions::{residuals, trees};
///
/// let trees = trees(&CLASSICAL_4.a, &CLASSICAL_4.a, 5);
/// let residuals = residuals(&CLASSICAL_4.b, &trees);
/// for (tree, residual) in trees.iter().zip(&residuals) {
///     assert!(tree.order > 4 || residual.abs() < 1e-15);
/// }
/// assert!(residuals.iter().any(|residual| residual.abs() > 1e-3));
/// ```
pub fn residuals(b: &[f64], trees: &[Tree]) -> Vec<f64> {
    trees.iter().map(|tree| dot(b, &tree.weights) - 1.0 / tree.density).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worst(b: &[f64], a: &[&[f64]], order: usize) -> f64 {
        let residuals = residuals(b, &trees(a, a, order));
        residuals.iter().fold(0.0, |worst, residual| residual.abs().max(worst))
    }

    #[test]
    fn there_are_as_many_trees_as_there_should_be() {
        let trees = trees(&[&[]], &[&[]], 9);
        for (n, count) in (1..).zip([1, 1, 2, 4, 9, 20, 48, 115, 286]) {
            assert_eq!(trees.iter().filter(|tree| tree.order == n).count(), count, "order {n}");
        }
    }

    #[test]
    fn a_tall_and_a_bushy_tree_have_the_density_of_the_book() {
        // Table II.2.1: 24 for the tall tree of four nodes, 4 for the bush.
        let densities: Vec<_> = trees(&[&[]], &[&[]], 4)[4..].iter().map(|t| t.density).collect();
        let mut sorted = densities.clone();
        sorted.sort_by(f64::total_cmp);
        assert_eq!(sorted, [4.0, 8.0, 12.0, 24.0]);
    }

    #[test]
    fn kutta_s_third_order_method_has_order_three_and_no_more() {
        let (b, a): (_, [&[f64]; 3]) =
            ([1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0], [&[], &[0.5], &[-1.0, 2.0]]);
        assert!(worst(&b, &a, 3) < 1e-15);
        assert!(worst(&b, &a, 4) > 1e-2);
        // One wrong digit.
        let wrong: [&[f64]; 3] = [&[], &[0.5], &[-1.0, 2.01]];
        assert!(worst(&b, &wrong, 3) > 1e-3);
    }

    #[test]
    fn rosenbrock_methods_are_told_from_runge_kutta_methods_by_their_single_edges() {
        // The two-stage method of order two with α₂₁ = 1, γ₂₁ = −2γ, b = (1/2, 1/2), for any γ.
        let gamma = 0.3;
        let alpha: [&[f64]; 2] = [&[], &[1.0]];
        let beta: [&[f64]; 2] = [&[gamma], &[1.0 - 2.0 * gamma, gamma]];
        let residuals = residuals(&[0.5, 0.5], &trees(&alpha, &beta, 2));
        assert!(residuals.iter().all(|r| r.abs() < 1e-16), "{residuals:?}");
    }
}

//! Butcher tableaux of explicit methods, and the order conditions as functions of them.

/// An explicit Runge–Kutta method with `S` stages.
///
/// ```text
/// k_i = f(t + c_i h, y + h Σ_j a_ij k_j),   y₁ = y + h Σ b_i k_i,   error = h Σ (b_i − b̂_i) k_i
/// ```
#[derive(Debug)]
pub struct Tableau<const S: usize> {
    /// Order of the propagated solution.
    pub order: usize,
    /// Order of the embedded solution `b_hat`; zero where there is none.
    pub embedded_order: usize,
    /// Nodes.
    pub c: [f64; S],
    /// Rows of the strictly lower triangle: row `i` has `i` entries.
    pub a: [&'static [f64]; S],
    /// Weights of the propagated solution.
    pub b: [f64; S],
    /// Weights of the embedded solution, from which the local error is estimated.
    pub b_hat: Option<[f64; S]>,
    /// Weights of a second embedded solution of lower order, which sharpens the estimate:
    /// `err = err₁²/√(err₁² + 0.01 err₂²)` in the norms of both.
    pub b_hat_low: Option<[f64; S]>,
    /// Dense output.
    pub dense: Dense<S>,
}

/// A stage that only dense output needs: its node, and its weights of all slopes before it: the
/// stages, the slope at the end, the extra stages.
pub type ExtraStage = (f64, &'static [f64]);

/// How a method interpolates within a step.
#[derive(Debug)]
pub enum Dense<const S: usize> {
    /// Cubic Hermite interpolation of states and slopes at both ends: third order.
    Hermite,
    /// `y(t + θh) = y + h Σ_i k_i (p_i0 θ + p_i1 θ² + …)`, a row of coefficients a stage.
    Stages {
        /// Row `i`: the coefficients `p_i0, p_i1, …` of stage `i`.
        p: [&'static [f64]; S],
    },
    /// Hermite's cubic corrected by a bubble over the slopes, to seventh order:
    /// `y = y₀ + θ (F₀ + (1 − θ)(F₁ + θ (F₂ + (1 − θ)(F₃ + θ (F₄ + (1 − θ)(F₅ + θ F₆))))))` with
    /// `F₀ = y₁ − y₀`, `F₁ = h ẏ₀ − F₀`, `F₂ = 2 F₀ − h (ẏ₀ + ẏ₁)` and `F_(3+i) = h Σ_j d_ij k_j`.
    Nested {
        /// Stages evaluated for it alone.
        extra: &'static [ExtraStage],
        /// Weights of all slopes, a row each for `F₃ … F₆`.
        d: [&'static [f64]; 4],
    },
}

impl<const S: usize> Dense<S> {
    /// The stages that it needs beyond those of the step.
    pub fn extra_stages(&self) -> &'static [ExtraStage] {
        match self {
            Self::Nested { extra, .. } => extra,
            Self::Hermite | Self::Stages { .. } => &[],
        }
    }
}

impl<const S: usize> Tableau<S> {
    /// Whether the last stage is the slope at the end of the step, and so the first stage of the
    /// next (first same as last): its row of `a` is `b`, its node 1.
    pub fn first_same_as_last(&self) -> bool {
        let last = S - 1;
        self.c[last] == 1.0 && self.b[last] == 0.0 && self.a[last] == &self.b[..last]
    }

    /// `Σ_j a_ij v_j` for each stage.
    fn a_times(&self, v: &[f64; S]) -> [f64; S] {
        std::array::from_fn(|i| self.a[i].iter().zip(v).map(|(a, v)| a * v).sum())
    }

    /// Residuals of the order conditions up to order `order` (at most 5) for the weights `b`.
    ///
    /// One residual a rooted tree, `Σ b_i Φ_i(tree) − 1/γ(tree)`, trees by order.
    /// E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I*, Table II.2.2.
    pub fn order_residuals(&self, b: &[f64; S], order: usize) -> Vec<f64> {
        let product = |u: &[f64; S], v: &[f64; S]| std::array::from_fn(|i| u[i] * v[i]);
        let one = [1.0; S];
        let c = self.a_times(&one);
        let c2 = product(&c, &c);
        let c3 = product(&c2, &c);
        let (ac, ac2, ac3) = (self.a_times(&c), self.a_times(&c2), self.a_times(&c3));
        let (aac, aac2) = (self.a_times(&ac), self.a_times(&ac2));
        let c_ac = product(&c, &ac);
        let trees: [(usize, [f64; S], f64); 17] = [
            (1, one, 1.0),
            (2, c, 2.0),
            (3, c2, 3.0),
            (3, ac, 6.0),
            (4, c3, 4.0),
            (4, c_ac, 8.0),
            (4, ac2, 12.0),
            (4, aac, 24.0),
            (5, product(&c3, &c), 5.0),
            (5, product(&c2, &ac), 10.0),
            (5, product(&ac, &ac), 20.0),
            (5, product(&c, &ac2), 15.0),
            (5, ac3, 20.0),
            (5, product(&c, &aac), 30.0),
            (5, self.a_times(&c_ac), 40.0),
            (5, aac2, 60.0),
            (5, self.a_times(&aac), 120.0),
        ];
        trees
            .iter()
            .filter(|(tree_order, ..)| *tree_order <= order)
            .map(|(_, phi, gamma)| b.iter().zip(phi).map(|(b, p)| b * p).sum::<f64>() - 1.0 / gamma)
            .collect()
    }

    /// Residuals of all that the coefficients promise: the row sums `Σ_j a_ij = c_i`, and the order
    /// conditions (up to order 5) of `b` up to `order` and of `b_hat` up to `embedded_order`.
    pub fn residuals(&self) -> Vec<f64> {
        let row_sums = self.a_times(&[1.0; S]);
        let mut all: Vec<_> = row_sums.iter().zip(&self.c).map(|(a, c)| a - c).collect();
        all.extend(self.order_residuals(&self.b, self.order));
        if let Some(b_hat) = &self.b_hat {
            all.extend(self.order_residuals(b_hat, self.embedded_order));
        }
        all
    }
}

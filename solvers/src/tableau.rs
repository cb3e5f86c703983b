//! Butcher tableaux of explicit methods, and the conditions that their coefficients must meet.
//!
//! A tableau that is not in the [list of methods](crate::METHODS) is used in the same way as those that are: it is a
//! `static` [`Tableau`], [`ExplicitRk`](crate::erk::ExplicitRk) is its stage loop, and
//! [`OneStepSolver`](crate::one_step::OneStepSolver) adds step control and events. Heun's method of order two, with
//! Euler's method for the error estimate:
//!
//! ```
//! use deltazero_solvers::erk::ExplicitRk;
//! use deltazero_solvers::one_step::OneStepSolver;
//! use deltazero_solvers::problems::BouncingBall;
//! use deltazero_solvers::tableau::{Dense, Tableau};
//! use deltazero_solvers::{Control, Error, Grid, Integration, Tolerance, Trajectory};
//!
//! static HEUN_21: Tableau<2> = Tableau {
//!     order: 2,
//!     embedded_order: 1,
//!     c: [0.0, 1.0],
//!     a: [&[], &[1.0]],
//!     b: [1.0 / 2.0, 1.0 / 2.0],
//!     b_hat: Some([1.0, 0.0]),
//!     b_hat_low: None,
//!     dense: Dense::Hermite,
//! };
//! assert!(HEUN_21.residuals().iter().all(|residual| residual.abs() < 1e-14));
//!
//! let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
//! let tolerance = Tolerance { rtol: 1e-4, atol: vec![1e-4; 2] };
//! tolerance.check(2)?;
//! let method = ExplicitRk::new(&HEUN_21, 2);
//! let mut solver = OneStepSolver::new(&ball, method, Control::Adaptive(tolerance));
//! let mut trajectory = Trajectory::on(Grid::Steps);
//! Integration::new(&ball, 0.0, ball.start()).run(1.3, &mut solver, &mut trajectory)?;
//! assert_eq!(trajectory.events.len(), 5);
//! for (n, bounce) in trajectory.events.iter().enumerate() {
//!     // Free fall is quadratic in t, so a method of order two is exact. Measured: 4.4e-16.
//!     assert!((bounce.t - ball.bounce_time(n)).abs() < 4e-15);
//! }
//! # Ok::<(), Error>(())
//! ```
//!
//! A tableau without `b_hat` has no error estimate, so it takes [`Control::Fixed`](crate::Control::Fixed) only.
//! [`Method::solver`](crate::Method::solver) checks that and the tolerance; here the caller does.

use crate::order_conditions;

/// An explicit Runge–Kutta method with `S` stages.
///
/// ```text
/// k_i = f(t + c_i h, y + h Σ_j a_ij k_j),   y₁ = y + h Σ b_i k_i,   error = h Σ (b_i − b̂_i) k_i
/// ```
///
/// ```
/// use deltazero_solvers::methods::DORMAND_PRINCE_5;
///
/// assert_eq!((DORMAND_PRINCE_5.order, DORMAND_PRINCE_5.error_order()), (5, 5));
/// assert!(DORMAND_PRINCE_5.first_same_as_last());
/// assert!(DORMAND_PRINCE_5.residuals().iter().all(|residual| residual.abs() < 1e-14));
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
    /// Weights of a second embedded solution of lower order, and that order. It makes the error estimate sharper:
    /// `err = err₁²/√(err₁² + 0.01 err₂²)`, where err₁ and err₂ are the norms of the two estimates.
    pub b_hat_low: Option<([f64; S], usize)>,
    /// Dense output.
    pub dense: Dense<S>,
}

/// A stage that only the dense output needs: its node, and its weights of all earlier slopes, in the order stages,
/// slope at the end of the step, earlier extra stages.
pub type ExtraStage = (f64, &'static [f64]);

/// How a method interpolates within a step.
#[derive(Debug)]
pub enum Dense<const S: usize> {
    /// Cubic Hermite interpolation of states and slopes at both ends: third order.
    Hermite,
    /// `y(t + θh) = y + h Σ_i k_i (p_0i θ + p_1i θ² + …)`, with a row of coefficients for each power of θ.
    Stages {
        /// Row `j`: the coefficients of `θ^(j+1)`, one of each stage.
        p: &'static [[f64; S]],
    },
    /// The Hermite cubic plus a correction from all slopes, which vanishes with its derivative at both ends. With n
    /// rows `d`, at most five, the polynomial is of degree 3 + n: `y = y₀ + θ (F₀ + (1 − θ)(F₁ + θ (F₂ + (1 − θ)(F₃ +
    /// θ (F₄ + (1 − θ)(F₅ + θ (F₆ + …)))))))` with `F₀ = y₁ − y₀`, `F₁ = h ẏ₀ − F₀`, `F₂ = 2 F₀ − h (ẏ₀ + ẏ₁)` and
    /// `F_(3+i) = h Σ_j d_ij k_j`.
    Nested {
        /// Stages evaluated for the dense output alone.
        extra: &'static [ExtraStage],
        /// Weights of all slopes, one row for each of `F₃, F₄, …`.
        d: &'static [&'static [f64]],
    },
}

impl<const S: usize> Dense<S> {
    /// The stages that the dense output needs beyond those of the step.
    pub fn extra_stages(&self) -> &'static [ExtraStage] {
        match self {
            Self::Nested { extra, .. } => extra,
            Self::Hermite | Self::Stages { .. } => &[],
        }
    }
}

impl<const S: usize> Tableau<S> {
    /// Whether the last stage is evaluated at the end of the step (its row of `a` is `b`, its node 1), so that it is
    /// also the first stage of the next step: first same as last, FSAL.
    pub fn first_same_as_last(&self) -> bool {
        let last = S - 1;
        self.c[last] == 1.0 && self.b[last] == 0.0 && self.a[last] == &self.b[..last]
    }

    /// Order of the estimate of the local error: the power of the step size with which it falls.
    pub fn error_order(&self) -> usize {
        match &self.b_hat_low {
            None => self.embedded_order + 1,
            Some((_, low_order)) => 2 * (self.embedded_order + 1) - (low_order + 1),
        }
    }

    /// Residuals of all conditions that the coefficients must meet: the row sums `Σ_j a_ij = c_i` of all stages, and
    /// the [order conditions](order_conditions::residuals) of `b` and of the embedded solutions up to their orders.
    pub fn residuals(&self) -> Vec<f64> {
        let extra = self.dense.extra_stages().iter().copied();
        let rows = self.c.into_iter().zip(self.a).chain(extra);
        let mut all: Vec<_> = rows.map(|(c, a)| a.iter().sum::<f64>() - c).collect();
        let highest = self.order.max(self.embedded_order);
        let trees = order_conditions::trees(&self.a, &self.a, highest);
        let mut check = |b: &[f64; S], order: usize| {
            let n = trees.iter().filter(|tree| tree.order <= order).count();
            all.extend(order_conditions::residuals(b, &trees[..n]));
        };
        check(&self.b, self.order);
        if let Some(b_hat) = &self.b_hat {
            check(b_hat, self.embedded_order);
        }
        if let Some((b_hat_low, order)) = &self.b_hat_low {
            check(b_hat_low, *order);
        }
        all
    }
}

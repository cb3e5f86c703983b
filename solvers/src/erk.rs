//! The stage loop of explicit tableau methods.

use crate::dense::{add, combine_with};
use crate::one_step::OneStep;
use crate::real::{Ordered, Over, Real};
use crate::step::TableauStep;
use crate::system::{System, Vector};
use crate::tableau::Tableau;
use crate::tolerance::{Tolerance, norm_sq};
use crate::work::Stats;

/// The right-hand side that a stage loop evaluates.
pub(crate) trait Slope<T, Y> {
    /// Writes the slope at `(t, y)` to `dydt`.
    fn slope(&self, t: T, y: &Y, dydt: &mut Y);
}

/// A system in a mode.
pub(crate) struct InMode<'a, P: System> {
    pub(crate) problem: &'a P,
    pub(crate) mode: &'a P::Mode,
}

impl<P: System, T: Real> Slope<T, P::State<T>> for InMode<'_, P> {
    #[inline(always)]
    fn slope(&self, t: T, y: &P::State<T>, dydt: &mut P::State<T>) {
        self.problem.rhs(self.mode.clone(), t, y, dydt);
    }
}

/// An explicit tableau method applied to one system: its tableau and the workspace of one step.
///
/// ```
/// use deltazero_solvers::erk::ExplicitRk;
/// use deltazero_solvers::methods::DORMAND_PRINCE_5;
/// use deltazero_solvers::one_step::OneStepSolver;
/// use deltazero_solvers::problems::FrictionOscillator;
/// use deltazero_solvers::{Control, Integration, Run, Tolerance};
///
/// let slider = FrictionOscillator { mass: 1.0, stiffness: 1.0, friction: 0.15, release: 1.0 };
/// let tolerance = Tolerance { rtol: 1e-6, atol: vec![1e-6; 2] };
/// let method = ExplicitRk::new(&DORMAND_PRINCE_5, 2);
/// let mut solver = OneStepSolver::new(&slider, method, Control::Adaptive(tolerance));
/// let mut own = Integration::new(&slider, 0.0, slider.start());
/// own.run(8.0, &mut solver, &mut ())?;
/// let listed = Run::of(&slider, slider.start()).method("rk45").tolerance(1e-6, 1e-6).to(8.0)?;
/// assert_eq!((own.point.y, own.stats), (listed.end.y, listed.stats));
/// # Ok::<(), deltazero_solvers::Error>(())
/// ```
#[derive(Debug)]
pub struct ExplicitRk<Y, const S: usize, T = f64> {
    tableau: &'static Tableau<S>,
    first_same_as_last: bool,
    /// Weights of the error estimate, `b − b̂`.
    error_weights: Option<[f64; S]>,
    /// The same for the second embedded solution, where there is one, and the error by it.
    low_weights: Option<[f64; S]>,
    pub(crate) low_error: Y,
    y_stage: Y,
    zero: Y,
    pub(crate) step: TableauStep<Y, S, T>,
    /// Whether the extra stages of the dense output are evaluated.
    pub(crate) is_dense: bool,
}

impl<Y: Vector<T>, const S: usize, T: Real> ExplicitRk<Y, S, T> {
    /// The method of `tableau` for systems of `n` states.
    pub fn new(tableau: &'static Tableau<S>, n: usize) -> Self {
        let zero = || Y::from_fn(n, |_| T::cst(0.0));
        let weights = |b_hat| difference(tableau.b, b_hat);
        Self {
            tableau,
            first_same_as_last: tableau.first_same_as_last(),
            error_weights: tableau.b_hat.map(weights),
            low_weights: tableau.b_hat_low.map(|(b_hat, _)| weights(b_hat)),
            low_error: zero(),
            y_stage: zero(),
            zero: zero(),
            step: TableauStep::new(n, &tableau.dense),
            is_dense: false,
        }
    }

    /// Takes a step of size `h` to `t1` along `field`: computes the stages after the first, the state at the end and
    /// the error estimates, by the formulas of [`Tableau`].
    #[inline(always)]
    pub(crate) fn take(&mut self, t1: T, h: T, field: &impl Slope<T, Y>) {
        let (Tableau { a, b, c, .. }, step) = (self.tableau, &mut self.step);
        (step.t1, step.h) = (t1, h);
        let mut y = self.y_stage.take();
        let mut k = Stages::new(&mut step.k);
        for i in 1..S {
            // k_i = f(t₀ + c_i h, y₀ + h Σ_j a_ij k_j)
            k.combine(&step.y0, h, a[i], &mut y);
            field.slope(step.t0 + h * c[i], &y, k.next());
        }
        // y₁ = y₀ + h Σ_j b_j k_j, where that is not the state of the last stage
        if !self.first_same_as_last {
            k.combine(&step.y0, h, b, &mut y);
        }
        // error = h Σ_j (b_j − b̂_j) k_j
        if let Some(weights) = &self.error_weights {
            k.combine(&self.zero, h, weights, &mut step.error);
        }
        if let Some(weights) = &self.low_weights {
            k.combine(&self.zero, h, weights, &mut self.low_error);
        }
        k.finish();
        step.y1.clone_from(&y);
        self.y_stage = y;
    }

    /// Evaluations of the right-hand side in one attempt.
    pub(crate) const N_RHS: u64 = S as u64 - 1;

    /// Evaluations of the right-hand side for the slope at the end of a step.
    pub(crate) fn n_rhs_of_end(&self) -> u64 {
        u64::from(!self.first_same_as_last)
    }

    /// Computes the slope at the end of the last step.
    #[inline(always)]
    pub(crate) fn end_slope(&mut self, field: &impl Slope<T, Y>) {
        let step = &mut self.step;
        if self.first_same_as_last {
            step.slope1.clone_from(&step.k[S - 1]);
        } else {
            field.slope(step.t1, &step.y1, &mut step.slope1);
        }
    }

    /// Square of the norm of the error of the last step for tolerances `(rtol, atol)`, and, where there is a second
    /// embedded solution, a closure that computes the same for its error.
    #[inline]
    pub(crate) fn norms_sq<C: Copy>(&self, tolerance: (C, &[C])) -> (T, Option<impl FnOnce() -> T>)
    where
        T: Ordered + Over<C>,
    {
        let (y0, y1) = (self.step.y0.as_ref(), self.step.y1.as_ref());
        let low = move || norm_sq(tolerance, self.low_error.as_ref(), y0, y1);
        let error_sq = norm_sq(tolerance, self.step.error.as_ref(), y0, y1);
        (error_sq, self.low_weights.is_some().then_some(low))
    }
}

/// `b − b̂`.
fn difference<const S: usize>(mut b: [f64; S], b_hat: [f64; S]) -> [f64; S] {
    b.iter_mut().zip(b_hat).for_each(|(b, b_hat)| *b -= b_hat);
    b
}

/// The slopes `k` of the stages computed so far in one step.
///
/// The newest slope is held apart from the others, because short states then stay in registers: a slope that is stored
/// number by number and loaded as a vector would wait for its stores.
struct Stages<'a, Y, const S: usize> {
    k: &'a mut [Y; S],
    newest: Y,
    /// Number of stages so far, the newest included.
    n: usize,
}

impl<'a, Y, const S: usize> Stages<'a, Y, S> {
    /// The first stage alone, whose slope is in `k`.
    #[inline(always)]
    fn new<T>(k: &'a mut [Y; S]) -> Self
    where
        Y: Vector<T>,
    {
        let newest = k[0].take();
        Self { k, newest, n: 1 }
    }

    /// Writes `from + h Σ_j w_j k_j` over the stages so far to `to`.
    #[inline(always)]
    fn combine<T: Real>(&self, from: &Y, h: T, w: &[f64], to: &mut Y)
    where
        Y: Vector<T>,
    {
        let n_before = self.n - 1;
        let (w, w_newest) = w.split_at(w.len().min(n_before));
        let w_newest = w_newest.first().copied().unwrap_or(0.0);
        combine_with(from, h, (w, w_newest), (&self.k[..n_before], &self.newest), to);
    }

    /// Adds a stage, whose slope the caller must write to the result.
    ///
    /// It takes no closure: a closure may be compiled as a function of its own, which costs explicit methods a third
    /// more instructions.
    #[inline(always)]
    fn next<T>(&mut self) -> &mut Y
    where
        Y: Vector<T>,
    {
        let next = self.k[self.n].take();
        self.k[self.n - 1] = std::mem::replace(&mut self.newest, next);
        self.n += 1;
        &mut self.newest
    }

    /// Puts the newest slope to the others.
    #[inline(always)]
    fn finish(self) {
        self.k[self.n - 1] = self.newest;
    }
}

/// Square of the error estimate from two embedded solutions, `err₁⁴/(err₁² + 0.01 err₂²)`, from the squares of the
/// norms of both errors.
#[inline]
pub(crate) fn sharpened(error_sq: f64, low_sq: impl FnOnce() -> f64) -> f64 {
    if error_sq == 0.0 { error_sq } else { error_sq * (error_sq / (error_sq + 0.01 * low_sq())) }
}

impl<P: System, const S: usize> OneStep<P> for ExplicitRk<P::State<f64>, S> {
    type Step = TableauStep<P::State<f64>, S>;

    fn embedded_order(&self) -> Option<usize> {
        self.error_weights.map(|_| self.tableau.error_order() - 1)
    }

    fn restart(
        &mut self,
        problem: &P,
        mode: P::Mode,
        t: f64,
        y: &P::State<f64>,
        stats: &mut Stats,
    ) {
        let step = &mut self.step;
        (step.t0, step.t1, step.h) = (t, t, 0.0);
        step.y0.clone_from(y);
        step.y1.clone_from(y);
        problem.rhs(mode, t, y, &mut step.k[0]);
        stats.work.n_rhs += 1;
    }

    #[inline(always)]
    fn attempt(&mut self, problem: &P, mode: P::Mode, t1: f64, h: f64, stats: &mut Stats) {
        self.is_dense = false;
        self.take(t1, h, &InMode { problem, mode: &mode });
        stats.work.n_rhs += Self::N_RHS;
    }

    #[inline(always)]
    fn complete(&mut self, problem: &P, mode: P::Mode, stats: &mut Stats) {
        self.end_slope(&InMode { problem, mode: &mode });
        stats.work.n_rhs += self.n_rhs_of_end();
    }

    fn densify(&mut self, problem: &P, mode: P::Mode, stats: &mut Stats) {
        if std::mem::replace(&mut self.is_dense, true) {
            return;
        }
        let step = &mut self.step;
        for (i, (c, a)) in step.dense.extra_stages().iter().enumerate() {
            self.y_stage.clone_from(&step.y0);
            for (a, slope) in a.iter().zip(step.slopes()) {
                add(&mut self.y_stage, step.h * a, slope);
            }
            problem.rhs(mode.clone(), step.t0 + c * step.h, &self.y_stage, &mut step.extra[i]);
            stats.work.n_rhs += 1;
        }
    }

    fn advance(&mut self) {
        let step = &mut self.step;
        step.t0 = step.t1;
        std::mem::swap(&mut step.y0, &mut step.y1);
        std::mem::swap(&mut step.k[0], &mut step.slope1);
    }

    fn step(&self) -> &Self::Step {
        &self.step
    }

    fn error(&self) -> &P::State<f64> {
        &self.step.error
    }

    #[inline]
    fn error_norm_sq(&self, tolerance: &Tolerance) -> f64 {
        match self.norms_sq((tolerance.rtol, &tolerance.atol)) {
            (error_sq, None) => error_sq,
            (error_sq, Some(low_sq)) => sharpened(error_sq, low_sq),
        }
    }
}

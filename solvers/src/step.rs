//! One step: the result that a method hands on, with its two ends and the dense output between them.

use std::fmt::Debug;

use crate::dense;
use crate::real::Real;
use crate::system::Vector;
use crate::tableau::Dense;

/// A step of one smooth phase.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use deltazero_solvers::problems::FrictionOscillator;
/// use deltazero_solvers::{Accepted, Control, Integration, Method, Record, Tolerance};
///
/// /// How far the middles of the steps are from the exact solution.
/// struct Off<'a>(&'a FrictionOscillator, f64);
///
/// impl Record<FrictionOscillator> for Off<'_> {
///     fn step(&mut self, accepted: &Accepted<'_, FrictionOscillator>) -> ControlFlow<()> {
///         let step = accepted.step;
///         let (middle, mut y) = (0.5 * (step.t0() + step.t1()), [0.0; 2]);
///         step.interpolate(middle, &mut y);
///         self.1 = self.1.max((y[0] - self.0.state(middle)[0]).abs());
///         ControlFlow::Continue(())
///     }
/// }
///
/// let slider = FrictionOscillator { mass: 1.0, stiffness: 1.0, friction: 0.15, release: 1.0 };
/// let control = Control::Adaptive(Tolerance { rtol: 1e-9, atol: vec![1e-9; 2] });
/// let mut solver = Method::named("dop853").ok_or("no such method")?.solver(&slider, control)?;
/// let mut off = Off(&slider, 0.0);
/// Integration::new(&slider, 0.0, slider.start()).run(10.0, &mut *solver, &mut off)?;
/// assert!(off.1 > 0.0 && off.1 < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Step<Y> {
    /// Time at the start.
    fn t0(&self) -> f64;
    /// Time at the end.
    fn t1(&self) -> f64;
    /// State at the start.
    fn y0(&self) -> &Y;
    /// State at the end.
    fn y1(&self) -> &Y;
    /// Slope at the start.
    fn slope0(&self) -> &Y;
    /// Slope at the end.
    fn slope1(&self) -> &Y;
    /// Writes the dense output at `t`, between both ends, to `y`; equal to the ends there.
    fn interpolate(&self, t: f64, y: &mut Y);
}

/// Writes the accessors of a [`Step`] over states `Y` that has the fields `t0`, `t1`, `y1` and `slope1`; state and slope
/// at its start are given as expressions of it.
macro_rules! end_accessors {
    ($step:ident => $y0:expr, $slope0:expr) => {
        fn t0(&self) -> f64 {
            self.t0
        }

        fn t1(&self) -> f64 {
            self.t1
        }

        fn y0(&self) -> &Y {
            let $step = self;
            $y0
        }

        fn y1(&self) -> &Y {
            &self.y1
        }

        fn slope0(&self) -> &Y {
            let $step = self;
            $slope0
        }

        fn slope1(&self) -> &Y {
            &self.slope1
        }
    };
}

pub(crate) use end_accessors;

/// A step of an explicit tableau method with `S` stages.
#[derive(Debug)]
pub struct TableauStep<Y, const S: usize, T = f64> {
    /// Time at the start.
    pub t0: T,
    /// Time at the end.
    pub t1: T,
    /// Step size: `t1 − t0`, given separately because the difference loses digits where `t0` is large.
    pub h: T,
    /// State at the start.
    pub y0: Y,
    /// State at the end.
    pub y1: Y,
    /// Slopes of the stages, the first one at the start.
    pub k: [Y; S],
    /// Slope at the end.
    pub slope1: Y,
    /// Slopes of the stages that dense output alone needs.
    pub extra: Vec<Y>,
    /// Estimate of the local error; zero where the method has none.
    pub error: Y,
    /// The kind of dense output.
    pub dense: &'static Dense<S>,
}

impl<Y: Vector<T>, const S: usize, T: Real> TableauStep<Y, S, T> {
    /// A step of length zero over `n` states, whose memory all later steps use.
    pub fn new(n: usize, dense: &'static Dense<S>) -> Self {
        let zero = || Y::from_fn(n, |_| T::cst(0.0));
        Self {
            t0: T::cst(0.0),
            t1: T::cst(0.0),
            h: T::cst(0.0),
            y0: zero(),
            y1: zero(),
            k: std::array::from_fn(|_| zero()),
            slope1: zero(),
            extra: dense.extra_stages().iter().map(|_| zero()).collect(),
            error: zero(),
            dense,
        }
    }
}

impl<Y: Vector<f64>, const S: usize> TableauStep<Y, S> {
    /// All slopes in order: the stages, the end, the extra stages.
    pub(crate) fn slopes(&self) -> impl Iterator<Item = &Y> {
        self.k.iter().chain([&self.slope1]).chain(&self.extra)
    }
}

impl<Y: Vector<f64>, const S: usize> Step<Y> for TableauStep<Y, S> {
    end_accessors!(step => &step.y0, &step.k[0]);

    fn interpolate(&self, t: f64, y: &mut Y) {
        if t == self.t1 {
            y.clone_from(&self.y1);
            return;
        }
        let theta = (t - self.t0) / self.h;
        let (start, end) = ((&self.y0, &self.k[0]), (&self.y1, &self.slope1));
        match self.dense {
            Dense::Hermite => dense::hermite(theta, self.h, start, end, y),
            Dense::Stages { p } => dense::stages(theta, self.h, &self.y0, &self.k, p, y),
            Dense::Nested { d, .. } => {
                dense::nested(theta, self.h, (start, end), (self.slopes(), d), y)
            }
        }
    }
}

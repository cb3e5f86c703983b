//! A step of a Radau method: its collocation polynomial, corrected by the error estimate.

use super::Radau;
use crate::step::{Step, end_accessors};
use crate::system::Vector;
use crate::tolerance::Tolerance;

/// A step of a Radau method.
#[derive(Debug)]
pub struct RadauStep<Y> {
    pub(super) t0: f64,
    pub(super) t1: f64,
    pub(super) h: f64,
    pub(super) y0: Y,
    pub(super) y1: Y,
    pub(super) slope0: Y,
    pub(super) slope1: Y,
    pub(super) error: Y,
    /// The coefficients `e` and `d` of the cubic.
    pub(super) bend: [Y; 2],
    tableau: &'static Radau,
}

impl<Y: Vector<f64>> RadauStep<Y> {
    /// A step of length zero over `n` states, whose memory all later steps use.
    pub(super) fn new(tableau: &'static Radau, n: usize) -> Self {
        let zero = || Y::from_fn(n, |_| 0.0);
        Self {
            t0: 0.0,
            t1: 0.0,
            h: 0.0,
            y0: zero(),
            y1: zero(),
            slope0: zero(),
            slope1: zero(),
            error: zero(),
            bend: [zero(), zero()],
            tableau,
        }
    }

    /// Square of the norm of the error estimate.
    pub(super) fn norm_sq(&self, tolerance: &Tolerance) -> f64 {
        tolerance.norm_sq(self.error.as_ref(), self.y0.as_ref(), self.y1.as_ref())
    }

    /// Sets `component` of the end to NaN, so that it is reported. A linear solve would have spread the NaN to all
    /// components.
    pub(super) fn spoil(&mut self, component: usize) {
        self.y1.clone_from(&self.y0);
        self.y1.as_mut()[component] = f64::NAN;
        self.error.as_mut().fill(0.0);
        self.error.as_mut()[component] = f64::NAN;
    }
}

impl<Y: Vector<f64>> Step<Y> for RadauStep<Y> {
    end_accessors!(step => &step.y0, &step.slope0);

    fn interpolate(&self, t: f64, y: &mut Y) {
        if t == self.t1 {
            y.clone_from(&self.y1);
            return;
        }
        let theta = (t - self.t0) / self.h;
        let rest = 1.0 - theta;
        let bubble = self.tableau.real * rest * (1.0 - theta / self.tableau.bubble_root);
        let ends = self.y0.as_ref().iter().zip(self.y1.as_ref());
        let [e, d] = self.bend.each_ref().map(|bend| bend.as_ref());
        let bends = self.error.as_ref().iter().zip(e.iter().zip(d));
        for ((y, (y0, y1)), (error, (e, d))) in y.as_mut().iter_mut().zip(ends).zip(bends) {
            *y = rest * y0 + theta * y1 + theta * rest * (bubble * error - e - theta * d);
        }
    }
}

//! DOPRI5, unrolled. Coefficients: `deltazero_solvers::methods::DORMAND_PRINCE_5`.

use deltazero_solvers::methods::DORMAND_PRINCE_5 as PAIR;
use deltazero_solvers::tableau::Dense;

use super::combine;
use super::drive::Pair;
use super::joint::{Joint, Mode, Y};

/// Weights of the error estimate, `b − b̂`.
const E: [f64; 7] = {
    let (mut e, mut i) = ([0.0; 7], 0);
    while let Some(b_hat) = PAIR.b_hat
        && i < 7
    {
        e[i] = PAIR.b[i] - b_hat[i];
        i += 1;
    }
    e
};

/// Memory of a step.
pub(crate) struct Dopri5 {
    y0: Y,
    y1: Y,
    h: f64,
    k: [Y; 7],
}

impl Pair for Dopri5 {
    const ERROR_ORDER: f32 = 5.0;
    const COST: [u64; 3] = [6, 0, 0];

    fn new(y0: Y, slope0: Y) -> Self {
        Self { y0, y1: y0, h: 0.0, k: [slope0; 7] }
    }

    #[inline(always)]
    fn restart(&mut self, y0: Y, slope0: Y) {
        self.y0 = y0;
        self.k[0] = slope0;
    }

    #[inline(always)]
    fn attempt(&mut self, joint: &Joint, mode: Mode, h: f64) {
        self.h = h;
        let (y, k) = (&self.y0, &mut self.k);
        k[1] = joint.rhs(mode, &combine!(*y, h, *k, PAIR.a[1]; 0));
        k[2] = joint.rhs(mode, &combine!(*y, h, *k, PAIR.a[2]; 0 1));
        k[3] = joint.rhs(mode, &combine!(*y, h, *k, PAIR.a[3]; 0 1 2));
        k[4] = joint.rhs(mode, &combine!(*y, h, *k, PAIR.a[4]; 0 1 2 3));
        k[5] = joint.rhs(mode, &combine!(*y, h, *k, PAIR.a[5]; 0 1 2 3 4));
        self.y1 = combine!(*y, h, *k, PAIR.a[6]; 0 2 3 4 5);
        k[6] = joint.rhs(mode, &self.y1);
    }

    #[inline(always)]
    fn error_sq(&self, rtol: f64, atol: &Y) -> f64 {
        let error: Y = combine!([0.0; 6], self.h, self.k, E; 0 2 3 4 5 6);
        let mut sum = 0.0;
        for i in 0..6 {
            let ratio = error[i] / (atol[i] + rtol * self.y0[i].abs().max(self.y1[i].abs()));
            sum += ratio * ratio;
        }
        sum / 6.0
    }

    #[inline(always)]
    fn complete(&mut self, _joint: &Joint, _mode: Mode) {}

    #[inline(always)]
    fn densify(&mut self, _joint: &Joint, _mode: Mode) {}

    fn interpolate(&self, theta: f64) -> Y {
        let Dense::Stages { p } = &PAIR.dense else { return [f64::NAN; 6] };
        let w: [f64; 7] = std::array::from_fn(|i| {
            theta * (p[0][i] + theta * (p[1][i] + theta * (p[2][i] + theta * p[3][i])))
        });
        combine!(self.y0, self.h, self.k, w; 0 2 3 4 5 6)
    }

    #[inline(always)]
    fn y1(&self) -> &Y {
        &self.y1
    }

    #[inline(always)]
    fn slope1(&self) -> &Y {
        &self.k[6]
    }
}

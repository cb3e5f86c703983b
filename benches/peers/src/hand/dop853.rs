//! DOP853, unrolled. Coefficients: `deltazero_solvers::methods::DORMAND_PRINCE_853`.

use deltazero_solvers::methods::DORMAND_PRINCE_853 as PAIR;
use deltazero_solvers::tableau::{Dense, ExtraStage};

use super::combine;
use super::drive::Pair;
use super::joint::{Joint, Mode, Y};

/// Weights of both error estimates, `b − b̂`.
const E: [[f64; 12]; 2] = {
    let (mut e, mut i) = ([[0.0; 12]; 2], 0);
    while let (Some(high), Some((low, _))) = (PAIR.b_hat, PAIR.b_hat_low)
        && i < 12
    {
        e[0][i] = PAIR.b[i] - high[i];
        e[1][i] = PAIR.b[i] - low[i];
        i += 1;
    }
    e
};

/// Stages and rows of its dense output.
const DENSE: (&[ExtraStage], &[&[f64]]) = match PAIR.dense {
    Dense::Nested { extra, d } => (extra, d),
    _ => (&[], &[]),
};

/// Memory of a step: twelve stages, the slope at the end, three stages of dense output.
pub(crate) struct Dop853 {
    y0: Y,
    y1: Y,
    h: f64,
    k: [Y; 16],
}

impl Pair for Dop853 {
    const ERROR_ORDER: f32 = 8.0;
    const COST: [u64; 3] = [11, 1, 3];

    fn new(y0: Y, slope0: Y) -> Self {
        Self { y0, y1: y0, h: 0.0, k: [slope0; 16] }
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
        k[3] = joint.rhs(mode, &combine!(*y, h, *k, PAIR.a[3]; 0 2));
        k[4] = joint.rhs(mode, &combine!(*y, h, *k, PAIR.a[4]; 0 2 3));
        k[5] = joint.rhs(mode, &combine!(*y, h, *k, PAIR.a[5]; 0 3 4));
        k[6] = joint.rhs(mode, &combine!(*y, h, *k, PAIR.a[6]; 0 3 4 5));
        k[7] = joint.rhs(mode, &combine!(*y, h, *k, PAIR.a[7]; 0 3 4 5 6));
        k[8] = joint.rhs(mode, &combine!(*y, h, *k, PAIR.a[8]; 0 3 4 5 6 7));
        k[9] = joint.rhs(mode, &combine!(*y, h, *k, PAIR.a[9]; 0 3 4 5 6 7 8));
        k[10] = joint.rhs(mode, &combine!(*y, h, *k, PAIR.a[10]; 0 3 4 5 6 7 8 9));
        k[11] = joint.rhs(mode, &combine!(*y, h, *k, PAIR.a[11]; 0 3 4 5 6 7 8 9 10));
        self.y1 = combine!(*y, h, *k, PAIR.b; 0 5 6 7 8 9 10 11);
    }

    #[inline(always)]
    fn error_sq(&self, rtol: f64, atol: &Y) -> f64 {
        let high: Y = combine!([0.0; 6], self.h, self.k, E[0]; 0 5 6 7 8 9 10 11);
        let low: Y = combine!([0.0; 6], self.h, self.k, E[1]; 0 5 6 7 8 9 10 11);
        let (mut high_sq, mut low_sq) = (0.0, 0.0);
        for i in 0..6 {
            let per_scale = 1.0 / (atol[i] + rtol * self.y0[i].abs().max(self.y1[i].abs()));
            high_sq += (high[i] * per_scale) * (high[i] * per_scale);
            low_sq += (low[i] * per_scale) * (low[i] * per_scale);
        }
        if high_sq == 0.0 {
            return 0.0;
        }
        high_sq / 6.0 * (high_sq / (high_sq + 0.01 * low_sq))
    }

    #[inline(always)]
    fn complete(&mut self, joint: &Joint, mode: Mode) {
        self.k[12] = joint.rhs(mode, &self.y1);
    }

    fn densify(&mut self, joint: &Joint, mode: Mode) {
        let (y, h, k) = (&self.y0, self.h, &mut self.k);
        let a = |i: usize| DENSE.0[i].1;
        k[13] = joint.rhs(mode, &combine!(*y, h, *k, a(0); 0 6 7 8 9 10 11 12));
        k[14] = joint.rhs(mode, &combine!(*y, h, *k, a(1); 0 5 6 7 10 11 12 13));
        k[15] = joint.rhs(mode, &combine!(*y, h, *k, a(2); 0 5 6 7 8 12 13 14));
    }

    fn interpolate(&self, theta: f64) -> Y {
        let (rest, h, k) = (1.0 - theta, self.h, &self.k);
        let f3: [Y; 4] = std::array::from_fn(
            |row| combine!([0.0; 6], h, *k, DENSE.1[row]; 0 5 6 7 8 9 10 11 12 13 14 15),
        );
        std::array::from_fn(|i| {
            let f0 = self.y1[i] - self.y0[i];
            let f1 = h * k[0][i] - f0;
            let f2 = 2.0 * f0 - h * (k[0][i] + k[12][i]);
            let high = f3[0][i] + theta * (f3[1][i] + rest * (f3[2][i] + theta * f3[3][i]));
            self.y0[i] + theta * (f0 + rest * (f1 + theta * (f2 + rest * high)))
        })
    }

    #[inline(always)]
    fn y1(&self) -> &Y {
        &self.y1
    }

    #[inline(always)]
    fn slope1(&self) -> &Y {
        &self.k[12]
    }
}

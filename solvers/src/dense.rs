//! Interpolants over one step.

use crate::real::Real;
use crate::system::Vector;

/// Cubic Hermite interpolation at `θ` between two ends, each a state and its slope.
///
/// ```text
/// y = (1 − θ) y₀ + θ y₁ + θ (θ − 1) [(1 − 2θ)(y₁ − y₀) + (θ − 1) h ẏ₀ + θ h ẏ₁]
/// ```
///
/// E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I*, (II.6.7).
///
/// ```
/// use deltazero_solvers::dense::hermite;
///
/// // y = t³ from t = 0 to 1 is a cubic itself.
/// let mut y = [0.0];
/// hermite(0.5, 1.0, (&[0.0], &[0.0]), (&[1.0], &[3.0]), &mut y);
/// assert_eq!(y, [0.125]);
/// ```
pub fn hermite<Y: Vector<f64>>(
    theta: f64,
    h: f64,
    (y0, slope0): (&Y, &Y),
    (y1, slope1): (&Y, &Y),
    y: &mut Y,
) {
    let ends = y0.as_ref().iter().zip(y1.as_ref());
    let slopes = slope0.as_ref().iter().zip(slope1.as_ref());
    for ((y, (y0, y1)), (slope0, slope1)) in y.as_mut().iter_mut().zip(ends).zip(slopes) {
        let cubic =
            (1.0 - 2.0 * theta) * (y1 - y0) + (theta - 1.0) * h * slope0 + theta * h * slope1;
        *y = y0 + theta * (y1 - y0) + theta * (theta - 1.0) * cubic;
    }
}

/// `y = y₀ + h Σ_i k_i (p_0i θ + p_1i θ² + …)`.
///
/// ```
/// use deltazero_solvers::dense::stages;
///
/// // Heun's method on ẏ = t from t = 0 to 2, with the weights θ − θ²/2 and θ²/2.
/// let (k, p) = ([[0.0], [2.0]], [[1.0, 0.0], [-0.5, 0.5]]);
/// let mut y = [0.0];
/// stages(0.5, 2.0, &[0.0], &k, &p, &mut y);
/// assert_eq!(y, [0.5]);
/// ```
pub fn stages<Y: Vector<f64>, const S: usize>(
    theta: f64,
    h: f64,
    y0: &Y,
    k: &[Y; S],
    p: &[[f64; S]],
    y: &mut Y,
) {
    combine(y0, h, &weights_at(theta, p), k, y);
}

/// The weights `p_0i θ + p_1i θ² + …` of the stages, power by power for all of them together, so that the compiler makes vector
/// instructions of it.
#[inline]
fn weights_at<const S: usize>(theta: f64, p: &[[f64; S]]) -> [f64; S] {
    let mut weights = [0.0; S];
    for p in p.iter().rev() {
        for (weight, p) in weights.iter_mut().zip(p) {
            *weight = *weight * theta + p;
        }
    }
    weights.map(|weight| theta * weight)
}

/// The nested form of [`Dense::Nested`](crate::tableau::Dense::Nested) at `θ`: the cubic between both ends, and all slopes
/// with the weights `d`.
pub(crate) fn nested<'y, Y: Vector<f64> + 'y>(
    theta: f64,
    h: f64,
    (start, end): ((&Y, &Y), (&Y, &Y)),
    (slopes, d): (impl Iterator<Item = &'y Y>, &[&[f64]]),
    y: &mut Y,
) {
    let rest = 1.0 - theta;
    // The factors of F₃ … F₇: products of θ and 1 − θ in turn.
    let mut factors = [theta * rest * theta * rest; 5];
    for i in 1..factors.len() {
        factors[i] = factors[i - 1] * if i % 2 == 1 { theta } else { rest };
    }
    hermite(theta, h, start, end, y);
    for (j, slope) in slopes.enumerate() {
        let weight: f64 = d.iter().zip(factors).map(|(row, factor)| row[j] * factor).sum();
        add(y, h * weight, slope);
    }
}

/// `y ← y + w k`.
#[inline(always)]
pub(crate) fn add<T: Real, Y: Vector<T>>(y: &mut Y, w: T, k: &Y) {
    for (y, k) in y.as_mut().iter_mut().zip(k.as_ref()) {
        *y = *y + *k * w;
    }
}

/// `y = y₀ + h Σ_i w_i k_i` over the first `w.len()` stages.
///
/// ```
/// use deltazero_solvers::dense::combine;
///
/// let mut y = [0.0];
/// combine(&[1.0], 0.5, &[0.25, 0.75], &[[4.0], [8.0]], &mut y);
/// assert_eq!(y, [1.0 + 0.5 * (0.25 * 4.0 + 0.75 * 8.0)]);
/// ```
#[inline]
pub fn combine<T: Real, Y: Vector<T>>(y0: &Y, h: T, w: &[f64], k: &[Y], y: &mut Y) {
    sum(h, w, k, y);
    start_from(y0, y);
}

/// The same with one more slope, `k_last` of weight `w_last`, stored apart from the others.
#[inline(always)]
pub(crate) fn combine_with<T: Real, Y: Vector<T>>(
    y0: &Y,
    h: T,
    (w, w_last): (&[f64], f64),
    (k, k_last): (&[Y], &Y),
    y: &mut Y,
) {
    sum(h, w, k, y);
    add(y, h * w_last, k_last);
    start_from(y0, y);
}

/// `y = Σ_i (h w_i) k_i`. The products `h w_i` do not depend on the slopes, so the processor computes them in
/// advance.
#[inline(always)]
fn sum<T: Real, Y: Vector<T>>(h: T, w: &[f64], k: &[Y], y: &mut Y) {
    y.as_mut().fill(T::cst(0.0));
    for (w, k) in w.iter().zip(k) {
        add(y, h * *w, k);
    }
}

/// `y ← y₀ + y`.
#[inline(always)]
fn start_from<T: Real, Y: Vector<T>>(y0: &Y, y: &mut Y) {
    for (y, y0) in y.as_mut().iter_mut().zip(y0.as_ref()) {
        *y = *y0 + *y;
    }
}

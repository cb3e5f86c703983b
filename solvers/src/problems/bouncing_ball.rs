//! A ball that drops on a rigid floor and loses a fraction of its speed at every bounce.

use std::fmt::Debug;

use super::ROUNDING;
use crate::real::{Over, Real};
use crate::system::{Alike, Next, System};

/// What the ball does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BouncingMode {
    /// Flies or touches for an instant.
    Flight,
    /// Lies on the floor.
    Rest,
}

/// A ball dropped from rest on a rigid floor, bouncing by Newton's law of impact.
///
/// ```text
/// ÿ = −g  while y ≥ 0,     ẏ⁺ = −e ẏ⁻  at y = 0
///
/// t_n = t_0 (1 + 2 (e + e² + … + eⁿ)),   v_n = g t_0 eⁿ⁺¹,   t_0 = √(2 y_0 / g)
/// ```
///
/// `y` is the height [m], `g` gravity [m/s²], `e` the restitution, `t_n` the time of bounce
/// n = 0, 1, … [s] and `v_n` the speed after it [m/s]. For e < 1 the bounces accumulate at
/// `t_0 (1 + e)/(1 − e)`, where the ball comes to [rest](System::accumulation); for e = 0 it does at
/// the first one.
///
/// B. Brogliato, *Nonsmooth Mechanics*, 3rd ed., Springer (2016), section 1.1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BouncingBall {
    /// Restitution e, from 0 to 1.
    pub restitution: f64,
    /// Gravity g [m/s²].
    pub gravity: f64,
    /// Height of the drop y_0 [m].
    pub height: f64,
}

impl BouncingBall {
    /// State at t = 0: height [m] and velocity [m/s].
    pub fn start(&self) -> [f64; 2] {
        [self.height, 0.0]
    }

    /// Time t_n of bounce `n` [s], the first one being 0.
    pub fn bounce_time(&self, n: usize) -> f64 {
        let mut sum = 0.0;
        for _ in 0..n {
            sum = self.restitution * (1.0 + sum);
        }
        self.fall_time() * (1.0 + 2.0 * sum)
    }

    /// Speed v_n after bounce `n` [m/s].
    pub fn bounce_speed(&self, n: usize) -> f64 {
        self.gravity * self.fall_time() * libm::pow(self.restitution, (n + 1) as f64)
    }

    /// Time at which the bounces accumulate [s]; infinite for e = 1.
    pub fn accumulation_time(&self) -> f64 {
        self.fall_time() * (1.0 + self.restitution) / (1.0 - self.restitution)
    }

    /// State at `t ≥ 0`; at rest on the floor from the accumulation on.
    pub fn state(&self, t: f64) -> [f64; 2] {
        let g = self.gravity;
        if t >= self.accumulation_time() {
            return [0.0, 0.0];
        }
        if t < self.fall_time() {
            return [self.height - 0.5 * g * t * t, -g * t];
        }
        let (mut start, mut speed) = (self.fall_time(), self.bounce_speed(0));
        loop {
            let end = start + 2.0 * speed / g;
            // Near the accumulation an arc may be shorter than the rounding of its time.
            if end > t || end == start {
                break;
            }
            start = end;
            speed *= self.restitution;
        }
        let s = t - start;
        [s * (speed - 0.5 * g * s), speed - g * s]
    }

    /// Time t_0 of the first fall [s].
    fn fall_time(&self) -> f64 {
        (2.0 * self.height / self.gravity).sqrt()
    }
}

impl System for BouncingBall {
    type Mode = BouncingMode;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, y: &[f64; 2]) -> BouncingMode {
        if *y == [0.0, 0.0] { BouncingMode::Rest } else { BouncingMode::Flight }
    }

    fn rhs<S: Real>(&self, mode: BouncingMode, _t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = match mode {
            BouncingMode::Flight => [y[1], S::cst(-self.gravity)],
            BouncingMode::Rest => [S::cst(0.0); 2],
        };
    }

    fn guards<S: Real>(&self, mode: BouncingMode, _t: S, y: &[S; 2], g: &mut [S; 1]) {
        *g = match mode {
            BouncingMode::Flight => [y[0]],
            BouncingMode::Rest => [S::cst(1.0)],
        };
    }

    // The height of the present arc, not of the drop: small bounces have small rounding errors.
    fn guard_bounds(&self, mode: BouncingMode, _t: f64, &[y, v]: &[f64; 2], bounds: &mut [f64; 1]) {
        *bounds = match mode {
            BouncingMode::Flight => [ROUNDING * (y.abs() + 0.5 * v * v / self.gravity)],
            BouncingMode::Rest => [ROUNDING],
        };
    }

    fn transition<S: Real>(
        &self,
        mode: BouncingMode,
        _guard: usize,
        _t: S,
        y: &mut [S; 2],
    ) -> Next<BouncingMode> {
        *y = [S::cst(0.0), -y[1] * self.restitution];
        Next::Mode(if self.restitution == 0.0 { BouncingMode::Rest } else { mode })
    }

    fn accumulation(
        &self,
        _mode: BouncingMode,
        _guard: usize,
        _t: f64,
        y: &mut [f64; 2],
    ) -> Option<BouncingMode> {
        *y = [0.0, 0.0];
        Some(BouncingMode::Rest)
    }
}

/// Two balls differ by gravity alone as long as both fly.
impl Alike for BouncingBall {
    type Parameters<C: Copy + Debug> = [C; 1];

    fn parameters(&self, mode: &BouncingMode) -> Option<[f64; 1]> {
        (*mode == BouncingMode::Flight).then_some([-self.gravity])
    }

    fn rhs_of<S: Over<C>, C: Copy + Debug>(of: &[C; 1], _t: S, y: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [y[1], <S as Over<C>>::of(of[0])];
    }

    fn guards_of<S: Over<C>, C: Copy + Debug>(_: &[C; 1], _t: S, y: &[S; 2], g: &mut [S; 1]) {
        *g = [y[0]];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closed_form_agrees_with_its_bounces() {
        let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
        assert_eq!(ball.accumulation_time(), 1.355_261_854_357_876_7);
        for n in 0..20 {
            let t = ball.bounce_time(n);
            let apex = ball.bounce_speed(n) / ball.gravity;
            let [y, v] = ball.state(t + apex);
            let height = 0.5 * ball.gravity * apex * apex;
            // Measured: 1.1e-16 s and 1.5e-15 m/s.
            assert!((y - height).abs() < 1e-15 && v.abs() < 1e-14, "{n}: {y} {v}");
        }
        assert_eq!(ball.state(0.0), ball.start());
        assert_eq!(ball.state(2.0), [0.0, 0.0]);
    }

    #[test]
    fn a_ball_is_nearly_at_rest_right_before_its_bounces_accumulate() {
        for restitution in [0.0, 0.3, 0.6, 0.7, 0.8, 0.95] {
            let ball = BouncingBall { restitution, gravity: 9.8, height: 1.0 };
            let [y, v] = ball.state(ball.accumulation_time().next_down());
            if restitution > 0.0 {
                assert!(y.abs() < 1e-14 && v.abs() < 1e-12, "{restitution}: {y} {v}");
            }
        }
    }
}

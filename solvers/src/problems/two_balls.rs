//! Two bouncing balls in one system: events that coincide, or nearly.

use super::{BouncingBall, BouncingMode};
use crate::real::Real;
use crate::system::{Next, System};

/// Two balls side by side, each dropped and bouncing by itself.
///
/// ```text
/// ÿ_i = −g_i  while y_i ≥ 0,     ẏ_i⁺ = −e_i ẏ_i⁻  at y_i = 0,     i = 1, 2
/// ```
///
/// The state is `[y_1, ẏ_1, y_2, ẏ_2]` [m, m/s, m, m/s], guard i falls where ball i lands, and each
/// has the closed form of its [`BouncingBall`]. Equal balls land at one instant: both guards fall
/// together and switch one after the other at the same t. Nearly equal ones land as closely after
/// each other as their heights are chosen.
///
/// Derived here: the balls do not touch, so nothing is added to [`BouncingBall`]. Each comes to rest
/// where its own bounces accumulate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoBalls {
    /// The balls.
    pub balls: [BouncingBall; 2],
}

impl TwoBalls {
    /// State at t = 0.
    pub fn start(&self) -> [f64; 4] {
        joined(self.balls.map(|ball| ball.start()))
    }

    /// State at `t ≥ 0`.
    pub fn state(&self, t: f64) -> [f64; 4] {
        joined(self.balls.map(|ball| ball.state(t)))
    }

    /// Time [s] and ball, counted from 0, of all bounces before `t`, in the order in which they
    /// occur; of two at one instant the first ball's comes first. Past an accumulation none are
    /// counted.
    pub fn bounces(&self, t: f64) -> Vec<(f64, usize)> {
        let mut bounces = Vec::new();
        for (i, ball) in self.balls.iter().enumerate() {
            let end = t.min(ball.accumulation_time());
            // By rounding the times may stop to grow before the accumulation.
            let mut before = f64::NEG_INFINITY;
            let follows = |t: &f64| std::mem::replace(&mut before, *t) < *t && *t < end;
            let times = (0..).map(|n| ball.bounce_time(n)).take_while(follows);
            bounces.extend(times.map(|t| (t, i)));
        }
        bounces.sort_by(|a, b| a.0.total_cmp(&b.0));
        bounces
    }
}

/// One state of both balls.
fn joined<S: Copy>([[y1, v1], [y2, v2]]: [[S; 2]; 2]) -> [S; 4] {
    [y1, v1, y2, v2]
}

/// The states of each ball.
fn parted<S: Copy>(&[y1, v1, y2, v2]: &[S; 4]) -> [[S; 2]; 2] {
    [[y1, v1], [y2, v2]]
}

impl System for TwoBalls {
    type Mode = [BouncingMode; 2];
    type State<S: Real> = [S; 4];
    type Guards<S: Real> = [S; 2];

    fn initial_mode(&self, t: f64, y: &[f64; 4]) -> [BouncingMode; 2] {
        let each = parted(y);
        std::array::from_fn(|i| self.balls[i].initial_mode(t, &each[i]))
    }

    fn rhs<S: Real>(&self, modes: [BouncingMode; 2], t: S, y: &[S; 4], dydt: &mut [S; 4]) {
        let mut slopes = parted(y);
        for (i, (y, slope)) in parted(y).iter().zip(&mut slopes).enumerate() {
            self.balls[i].rhs(modes[i], t, y, slope);
        }
        *dydt = joined(slopes);
    }

    fn guards<S: Real>(&self, modes: [BouncingMode; 2], t: S, y: &[S; 4], g: &mut [S; 2]) {
        for (i, (y, g)) in parted(y).iter().zip(g).enumerate() {
            self.balls[i].guards(modes[i], t, y, std::array::from_mut(g));
        }
    }

    fn guard_bounds(&self, modes: [BouncingMode; 2], t: f64, y: &[f64; 4], bounds: &mut [f64; 2]) {
        for (i, (y, bound)) in parted(y).iter().zip(bounds).enumerate() {
            self.balls[i].guard_bounds(modes[i], t, y, std::array::from_mut(bound));
        }
    }

    fn transition<S: Real>(
        &self,
        mut modes: [BouncingMode; 2],
        guard: usize,
        t: S,
        y: &mut [S; 4],
    ) -> Next<[BouncingMode; 2]> {
        let mut each = parted(y);
        let next = self.balls[guard].transition(modes[guard], 0, t, &mut each[guard]);
        *y = joined(each);
        match next {
            Next::Stop => Next::Stop,
            Next::Mode(mode) => {
                modes[guard] = mode;
                Next::Mode(modes)
            }
        }
    }

    fn accumulation(
        &self,
        mut modes: [BouncingMode; 2],
        guard: usize,
        t: f64,
        y: &mut [f64; 4],
    ) -> Option<[BouncingMode; 2]> {
        let mut each = parted(y);
        modes[guard] = self.balls[guard].accumulation(modes[guard], 0, t, &mut each[guard])?;
        *y = joined(each);
        Some(modes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BALL: BouncingBall = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };

    #[test]
    fn bounces_come_in_order_and_ties_by_ball() {
        let lower = BouncingBall { height: 0.25, restitution: 0.8, ..BALL };
        let order = |balls| -> Vec<usize> {
            TwoBalls { balls }.bounces(0.95).into_iter().map(|bounce| bounce.1).collect()
        };
        // The lower ball falls for half the time: it lands at 0.5, 1.3, 1.94, … of the other's
        // fall, which lands at 1, 2, …; 0.95 s are 2.10 of it.
        assert_eq!(order([BALL, lower]), [1, 0, 1, 1, 0]);
        assert_eq!(order([BALL, BALL]), [0, 1, 0, 1]);
    }

    #[test]
    fn bounces_stop_at_the_accumulation() {
        for (restitution, least) in [(0.3, 50), (0.5, 80), (0.8, 250), (0.9, 500)] {
            let ball = BouncingBall { restitution, ..BALL };
            let times = TwoBalls { balls: [ball, ball] }.bounces(10.0);
            let last = times.last().unwrap().0;
            assert!(last < ball.accumulation_time(), "{restitution}: {last}");
            assert!(times.len() > least, "{restitution}: {}", times.len());
        }
    }

    #[test]
    fn each_bounce_leaves_the_other_ball_alone() {
        let balls = TwoBalls { balls: [BALL, BouncingBall { restitution: 0.8, ..BALL }] };
        let mut y = [0.0, -4.0, 0.1, -3.0];
        let flight = [BouncingMode::Flight; 2];
        assert_eq!(balls.transition(flight, 0, 0.0, &mut y), Next::Mode(flight));
        assert_eq!(y, [0.0, 2.0, 0.1, -3.0]);
        assert_eq!(balls.transition(flight, 1, 0.0, &mut y), Next::Mode(flight));
        assert_eq!(y, [0.0, 2.0, 0.0, 0.8 * 3.0]);
    }
}

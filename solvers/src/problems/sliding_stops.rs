//! A block that a square wave drives to and fro between two rigid stops, with dry friction.

use super::{Piece, ROUNDING, Wall, pieces};
use crate::real::Real;
use crate::system::{Next, System};

/// What the block does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Block {
    /// Rests at this stop.
    At(Wall),
    /// Slides towards this stop.
    Slides(Wall),
    /// Rests between the stops.
    Rests,
}

/// What the block does, and which way the drive points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StopsMode {
    /// What the block does.
    pub block: Block,
    /// Number n of the half period of the drive.
    pub half_period: u32,
}

/// A block between two rigid stops, pushed by a force that reverses at known times.
///
/// ```text
/// F(t) = F_0 (−1)ⁿ                    for n T/2 ≤ t < (n + 1) T/2,   n = 0, 1, …
/// m ẍ = F ∓ F_f                       while it slides with ẋ ≷ 0
/// ẋ⁺ = 0                              where it meets a stop, x = 0 or x = L
/// ẋ = 0                               at rest, while |F| ≤ F_f; at a stop while −F ≤ F_f or F ≤ F_f:
///                                     F away from the stop must exceed F_f
///
/// for F_0 > F_f and t_L ≤ T/2, from rest at x = 0:
/// leaves a stop at n T/2,  meets the other at n T/2 + t_L  with speed 2 L/t_L,
/// t_L = √(2 m L/(F_0 − F_f))
/// ```
///
/// `x` is the position [m], `m` the mass [kg], `L` the distance of the stops [m], `F` the drive, `F_0`
/// its strength and `F_f` the friction [N], `T` the period [s], `t_L` the time from stop to stop [s].
///
/// One guard in every mode is time itself, `t_{n+1} − t`. When the drive reverses, the guard of a block
/// at rest jumps from above zero to below, and the block leaves at the same instant, with its new
/// guard, the velocity, exactly zero: a crossing that a search for changes of sign misses. For
/// F_0 = F_f the guard at rest is exactly zero for ever, and nothing happens. For F_0 < F_f the block
/// rests for good where it stops first. Impacts reset the velocity, which no right-hand side can, so
/// there is no blind run of it.
///
/// Derived here: every piece is a parabola, and meets its stop or rest at the first root of one. The
/// problem: issue 3222 of SciML/OrdinaryDiffEq.jl, "Apparent failure to catch a zero cross of a
/// condition" (2021), without its spring and with plastic impacts.
///
/// Valid for starts with 0 ≤ x ≤ L at t = 0; before that the drive is F_0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlidingStops {
    /// Mass m [kg].
    pub mass: f64,
    /// Distance of the stops L [m].
    pub gap: f64,
    /// Strength of the drive F_0 [N].
    pub drive: f64,
    /// Half the period of the drive, T/2 [s].
    pub half_period: f64,
    /// Friction F_f [N], sliding and sticking alike.
    pub friction: f64,
    /// State at t = 0: position [m] and velocity [m/s].
    pub start: [f64; 2],
}

impl SlidingStops {
    /// Time t_L from rest at one stop to the other while the drive does not reverse [s].
    pub fn travel_time(&self) -> f64 {
        (2.0 * self.mass * self.gap / (self.drive - self.friction)).sqrt()
    }

    /// State at `t ≥ 0`.
    pub fn state(&self, t: f64) -> [f64; 2] {
        let last = |piece: &Piece<_, _>| self.flow(piece.mode, piece.y, t - piece.t);
        self.pieces(t).last().map_or(self.start, last)
    }

    /// The pieces of the solution that begin by `t_end`: one from the start, one from each event.
    pub fn pieces(&self, t_end: f64) -> Vec<Piece<StopsMode, [f64; 2]>> {
        let start = Piece { t: 0.0, mode: self.initial_mode(0.0, &self.start), y: self.start };
        pieces(start, t_end, |piece| self.next(piece))
    }

    /// State `tau` after `y` in `mode` [s], past its surfaces too.
    pub fn flow(&self, mode: StopsMode, [x, v]: [f64; 2], tau: f64) -> [f64; 2] {
        let a = self.acceleration(mode);
        [x + tau * (v + 0.5 * a * tau), v + a * tau]
    }

    /// The piece that follows.
    fn next(&self, piece: Piece<StopsMode, [f64; 2]>) -> Piece<StopsMode, [f64; 2]> {
        let Piece { t, mode, y } = piece;
        let force = self.force(mode);
        let (end, block, y_end) = match mode.block {
            Block::Slides(wall) => self.slide(wall, mode, y),
            Block::At(Wall::Left) | Block::Rests if force > self.friction => {
                (0.0, Block::Slides(Wall::Right), y)
            }
            Block::At(Wall::Right) | Block::Rests if force < -self.friction => {
                (0.0, Block::Slides(Wall::Left), y)
            }
            at_rest => (f64::INFINITY, at_rest, y),
        };
        let reversal = self.reversal(mode);
        if t + end < reversal {
            return Piece { t: t + end, mode: StopsMode { block, ..mode }, y: y_end };
        }
        let mode_after = StopsMode { half_period: mode.half_period + 1, ..mode };
        Piece { t: reversal, mode: mode_after, y: self.flow(mode, y, reversal - t) }
    }

    /// How long a slide lasts under a steady drive [s], and what it ends in.
    fn slide(&self, wall: Wall, mode: StopsMode, [x, v]: [f64; 2]) -> (f64, Block, [f64; 2]) {
        let sign = sign(wall);
        let (ahead, speed, gain) = (self.ahead(wall, x), sign * v, sign * self.acceleration(mode));
        let square = speed * speed + 2.0 * gain * ahead;
        if square < 0.0 {
            let x_end = x + sign * 0.5 * speed * speed / -gain;
            return (speed / -gain, Block::Rests, [x_end, 0.0]);
        }
        (2.0 * ahead / (speed + square.sqrt()), Block::At(wall), [self.stop(wall), 0.0])
    }

    /// The drive F in `mode` [N].
    pub fn force(&self, mode: StopsMode) -> f64 {
        if mode.half_period.is_multiple_of(2) { self.drive } else { -self.drive }
    }

    /// When it reverses next [s].
    fn reversal(&self, mode: StopsMode) -> f64 {
        self.half_period * (f64::from(mode.half_period) + 1.0)
    }

    /// Acceleration [m/s²].
    fn acceleration(&self, mode: StopsMode) -> f64 {
        match mode.block {
            Block::Slides(wall) => (self.force(mode) - sign(wall) * self.friction) / self.mass,
            Block::At(_) | Block::Rests => 0.0,
        }
    }

    /// Position of a stop [m].
    fn stop(&self, wall: Wall) -> f64 {
        match wall {
            Wall::Left => 0.0,
            Wall::Right => self.gap,
        }
    }

    /// Distance from `x` to a stop [m].
    fn ahead<S: Real>(&self, wall: Wall, x: S) -> S {
        match wall {
            Wall::Left => x,
            Wall::Right => -x + self.gap,
        }
    }
}

/// The sign of a velocity towards `wall`.
fn sign(wall: Wall) -> f64 {
    match wall {
        Wall::Left => -1.0,
        Wall::Right => 1.0,
    }
}

impl System for SlidingStops {
    type Mode = StopsMode;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 3];

    fn initial_mode(&self, t: f64, &[x, v]: &[f64; 2]) -> StopsMode {
        let block = if v > 0.0 {
            Block::Slides(Wall::Right)
        } else if v < 0.0 {
            Block::Slides(Wall::Left)
        } else if x <= 0.0 {
            Block::At(Wall::Left)
        } else if x >= self.gap {
            Block::At(Wall::Right)
        } else {
            Block::Rests
        };
        StopsMode { block, half_period: (t / self.half_period) as u32 }
    }

    fn rhs<S: Real>(&self, mode: StopsMode, _t: S, &[_, v]: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [v, S::cst(self.acceleration(mode))];
    }

    fn guards<S: Real>(&self, mode: StopsMode, t: S, &[x, v]: &[S; 2], g: &mut [S; 3]) {
        let unused = S::cst(1.0);
        let (force, friction) = (self.force(mode), self.friction);
        let [stays, stays_too] = match mode.block {
            Block::Slides(wall) => [v * sign(wall), self.ahead(wall, x)],
            Block::At(wall) => [S::cst(friction + sign(wall) * force), unused],
            Block::Rests => [S::cst(friction - force), S::cst(friction + force)],
        };
        *g = [-t + self.reversal(mode), stays, stays_too];
    }

    fn guard_bounds(&self, mode: StopsMode, t: f64, &[x, v]: &[f64; 2], bounds: &mut [f64; 3]) {
        let force = self.drive.abs() + self.friction;
        let sizes = match mode.block {
            Block::Slides(_) => {
                [v.abs() + force / self.mass * self.half_period, x.abs() + self.gap]
            }
            Block::At(_) | Block::Rests => [force; 2],
        };
        let time = t.abs() + self.half_period;
        *bounds = [ROUNDING * time, ROUNDING * sizes[0], ROUNDING * sizes[1]];
    }

    fn transition<S: Real>(
        &self,
        mode: StopsMode,
        guard: usize,
        _t: S,
        y: &mut [S; 2],
    ) -> Next<StopsMode> {
        let StopsMode { block, half_period } = mode;
        if guard == 0 {
            return Next::Mode(StopsMode { block, half_period: half_period + 1 });
        }
        y[1] = S::cst(0.0);
        let block = match (block, guard) {
            (Block::Slides(_), 1) => Block::Rests,
            (Block::Slides(wall), _) => {
                y[0] = S::cst(self.stop(wall));
                Block::At(wall)
            }
            (Block::At(Wall::Left), _) | (Block::Rests, 1) => Block::Slides(Wall::Right),
            (Block::At(Wall::Right) | Block::Rests, _) => Block::Slides(Wall::Left),
        };
        Next::Mode(StopsMode { block, half_period })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block whose drive is twice its friction, ahead of it 0.4 m/s² of acceleration.
    fn stops(gap: f64, start: [f64; 2]) -> SlidingStops {
        SlidingStops { mass: 5.0, gap, drive: 4.0, half_period: 2.0, friction: 2.0, start }
    }

    /// Times and blocks of the pieces.
    fn blocks(stops: &SlidingStops, t_end: f64) -> Vec<(f64, Block)> {
        stops.pieces(t_end).iter().map(|piece| (piece.t, piece.mode.block)).collect()
    }

    #[test]
    fn from_rest_at_a_stop_the_block_goes_from_stop_to_stop() {
        let stops = stops(0.2, [0.0; 2]);
        let mut expected = vec![(0.0, Block::At(Wall::Left))];
        let (mut behind, mut ahead) = (Wall::Left, Wall::Right);
        for n in 0..10 {
            let t = 2.0 * f64::from(n);
            if n > 0 {
                expected.push((t, Block::At(behind)));
            }
            expected.push((t, Block::Slides(ahead)));
            expected.push((t + 1.0, Block::At(ahead)));
            (behind, ahead) = (ahead, behind);
        }
        assert_eq!(stops.travel_time(), 1.0);
        assert_eq!(blocks(&stops, 19.5), expected);
        let [x, v] = stops.state(1.0 - 1e-9);
        // Measured: 2.2e-17 m and 2.2e-17 m/s.
        assert!((x - 0.2 + 0.4e-9).abs() < 2e-16 && (v - 0.4 + 0.4e-9).abs() < 2e-16, "{x} {v}");
    }

    #[test]
    fn drive_and_friction_do_the_work_that_the_energy_shows() {
        let mut n_met_while_braking = 0;
        for (gap, start) in [(0.2, [0.1, 0.0]), (1.2, [0.0, 0.0]), (1.0, [0.5, -0.7])] {
            let stops = stops(gap, start);
            for pair in stops.pieces(40.0).windows(2) {
                let (mode, tau) = (pair[0].mode, pair[1].t - pair[0].t);
                let [x, v] = stops.flow(mode, pair[0].y, tau);
                // Measured: 2.2e-16 m.
                assert!((x - pair[1].y[0]).abs() < 2e-15, "{x} {}", pair[1].y[0]);
                let Block::Slides(wall) = mode.block else {
                    assert_eq!(pair[0].y, pair[1].y);
                    continue;
                };
                let work = (stops.force(mode) - sign(wall) * stops.friction) * (x - pair[0].y[0]);
                let gain = 0.5 * stops.mass * (v * v - pair[0].y[1] * pair[0].y[1]);
                // Measured: 6.7e-16 J of 1.6 J, and 3.0e-15 m/s where the block comes to rest.
                assert!((work - gain).abs() < 6e-15, "{work} {gain}");
                let met = pair[1].mode.block == Block::At(wall);
                n_met_while_braking += usize::from(met && work < 0.0);
                assert!(met || pair[1].mode.block != Block::Rests || v.abs() < 2e-14);
            }
        }
        assert!(n_met_while_braking > 0);
    }

    #[test]
    fn a_drive_below_friction_lets_the_block_rest_for_good() {
        let stops = SlidingStops { drive: 1.0, ..stops(1.0, [0.2, 0.5]) };
        // 0.5 m/s against 0.2 m/s² for 2 s, then 0.1 m/s against 0.6 m/s².
        let rest = 2.0 + 0.1 / 0.6;
        let rests: Vec<_> = stops.pieces(100.0).into_iter().skip(2).collect();
        // Measured: 0 s, and 1.1e-16 m below.
        assert!((rests[0].t - rest).abs() < 1e-15, "{}", rests[0].t);
        assert!(rests.iter().all(|piece| piece.mode.block == Block::Rests));
        let x = 0.2 + 0.5 * 2.0 - 0.1 * 4.0 + 0.01 / 1.2;
        assert!((stops.state(100.0)[0] - x).abs() < 1e-15 && stops.state(100.0)[1] == 0.0);
    }

    #[test]
    fn a_drive_equal_to_friction_does_not_move_the_block() {
        let stops = SlidingStops { drive: 2.0, ..stops(1.0, [0.0; 2]) };
        assert!(blocks(&stops, 9.0).iter().all(|(_, block)| *block == Block::At(Wall::Left)));
    }
}

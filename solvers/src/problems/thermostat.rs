//! A room with a thermostat: a heater that switches with hysteresis.

use super::{Piece, ROUNDING, pieces};
use crate::real::Real;
use crate::system::{Next, System};

/// Whether the heater is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heater {
    /// Heats, until the room is warm.
    On,
    /// Does not, until the room is cold.
    Off,
}

/// A room that loses heat to the outside, and a heater that keeps it between two temperatures.
///
/// ```text
/// C Ṫ = P − G (T − T_out)   on,  while T ≤ T_high
/// C Ṫ =   − G (T − T_out)   off, while T ≥ T_low
///
/// T(s) = T_∞ + (T(0) − T_∞) exp(−s/τ),   τ = C/G,   T_∞ = T_out + P/G on, T_out off
///
/// τ_on  = τ ln((T_out + P/G − T_low) / (T_out + P/G − T_high))
/// τ_off = τ ln((T_high − T_out) / (T_low − T_out))
/// ```
///
/// `T` is the temperature of the room [K], `T_out` that outside, `C` the heat capacity of the room
/// [J/K], `G` the conductance of its walls [W/K], `P` the power of the heater [W], `s` the time
/// since it switched [s], `τ_on` and `τ_off` how long it is then on and off [s].
///
/// Valid for T_out < T_low < T_high < T_out + P/G, else the heater may never switch, and any start; one
/// beyond the temperature that its heater switches at switches at once. Between both temperatures
/// the heater may be on or off, so no mode can be read off the state: there is no blind run of it.
///
/// The room: T. A. Henzinger, "The theory of hybrid automata", Proc. 11th IEEE Symp. Logic in
/// Computer Science, 278–292 (1996). Durations derived here: the exponential, solved for its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thermostat {
    /// Heat capacity C [J/K].
    pub heat_capacity: f64,
    /// Conductance G [W/K].
    pub conductance: f64,
    /// Power P [W].
    pub power: f64,
    /// Temperature outside T_out [K].
    pub outside: f64,
    /// Temperature at which the heater switches on, T_low [K].
    pub low: f64,
    /// Temperature at which it switches off, T_high [K].
    pub high: f64,
    /// Temperature of the room at t = 0 [K].
    pub start: f64,
    /// The heater at t = 0.
    pub heater: Heater,
}

impl Thermostat {
    /// Time constant τ of the room [s].
    pub fn time_constant(&self) -> f64 {
        self.heat_capacity / self.conductance
    }

    /// How long the heater is on in a cycle [s].
    pub fn time_on(&self) -> f64 {
        self.duration(Heater::On, self.low)
    }

    /// How long it is off [s].
    pub fn time_off(&self) -> f64 {
        self.duration(Heater::Off, self.high)
    }

    /// State at `t ≥ 0`.
    pub fn state(&self, t: f64) -> [f64; 1] {
        let last = |piece: &Piece<_, _>| self.flow(piece.mode, piece.y, t - piece.t);
        self.pieces(t).last().map_or([self.start], last)
    }

    /// The pieces of the solution that begin by `t_end`: one from the start, one from each event.
    pub fn pieces(&self, t_end: f64) -> Vec<Piece<Heater, [f64; 1]>> {
        let start = Piece { t: 0.0, mode: self.heater, y: [self.start] };
        pieces(start, t_end, |Piece { t, mode, y: [temperature] }| {
            let (other, switches_at) = match mode {
                Heater::On => (Heater::Off, temperature.max(self.high)),
                Heater::Off => (Heater::On, temperature.min(self.low)),
            };
            Piece { t: t + self.duration(mode, temperature), mode: other, y: [switches_at] }
        })
    }

    /// State `s` after `y` in `mode` [s], past its surfaces too.
    pub fn flow(&self, mode: Heater, [temperature]: [f64; 1], s: f64) -> [f64; 1] {
        let settled = self.settled(mode);
        [settled + (temperature - settled) * libm::exp(-s / self.time_constant())]
    }

    /// Temperature T_∞ that the room tends to [K].
    fn settled(&self, mode: Heater) -> f64 {
        match mode {
            Heater::On => self.outside + self.power / self.conductance,
            Heater::Off => self.outside,
        }
    }

    /// How long `mode` lasts from `temperature` on [s]; infinite where the room does not get to the end of the band.
    fn duration(&self, mode: Heater, temperature: f64) -> f64 {
        let settled = self.settled(mode);
        // Below zero past the end of the band.
        let (switches_at, left, reach) = match mode {
            Heater::On => (self.high, self.high - temperature, settled - self.high),
            Heater::Off => (self.low, temperature - self.low, self.low - settled),
        };
        if left <= 0.0 {
            return 0.0;
        }
        if reach <= 0.0 {
            return f64::INFINITY;
        }
        self.time_constant() * libm::log((settled - temperature) / (settled - switches_at))
    }
}

impl System for Thermostat {
    type Mode = Heater;
    type State<S: Real> = [S; 1];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 1]) -> Heater {
        self.heater
    }

    fn rhs<S: Real>(&self, mode: Heater, _t: S, &[temperature]: &[S; 1], dydt: &mut [S; 1]) {
        let power = match mode {
            Heater::On => self.power,
            Heater::Off => 0.0,
        };
        let loss = (temperature - self.outside) * self.conductance;
        *dydt = [(-loss + power) / self.heat_capacity];
    }

    fn guards<S: Real>(&self, mode: Heater, _t: S, &[temperature]: &[S; 1], g: &mut [S; 1]) {
        *g = match mode {
            Heater::On => [-temperature + self.high],
            Heater::Off => [temperature - self.low],
        };
    }

    fn guard_bounds(&self, _: Heater, _t: f64, &[temperature]: &[f64; 1], bounds: &mut [f64; 1]) {
        *bounds = [ROUNDING * (temperature.abs() + self.high.abs())];
    }

    // The temperature is continuous, and the guard of the other mode far from its surface.
    fn transition<S: Real>(
        &self,
        mode: Heater,
        _guard: usize,
        _t: S,
        _y: &mut [S; 1],
    ) -> Next<Heater> {
        Next::Mode(match mode {
            Heater::On => Heater::Off,
            Heater::Off => Heater::On,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thermostat(start: f64, heater: Heater) -> Thermostat {
        Thermostat {
            heat_capacity: 2e6,
            conductance: 200.0,
            power: 6e3,
            outside: 275.0,
            low: 292.0,
            high: 294.0,
            start,
            heater,
        }
    }

    #[test]
    fn over_a_cycle_the_heater_gives_what_the_walls_lose() {
        let room = thermostat(292.0, Heater::On);
        let pieces = room.pieces(4e3);
        let cycle = room.time_on() + room.time_off();
        assert_eq!(pieces.len(), 3);
        assert_eq!(pieces[1].t, room.time_on());
        assert_eq!(pieces[2], Piece { t: cycle, mode: Heater::On, y: [292.0] });
        let mut lost = 0.0;
        for pair in pieces.windows(2) {
            // Simpson's rule in 64 panels.
            let h = (pair[1].t - pair[0].t) / 128.0;
            for n in 0..=128 {
                let weight = [2.0, 4.0][n % 2] - if n % 128 == 0 { 1.0 } else { 0.0 };
                let [temperature] = room.state(pair[0].t + h * n as f64);
                lost += weight * h / 3.0 * room.conductance * (temperature - room.outside);
            }
        }
        // Measured: 4.1e-15.
        let given = room.power * room.time_on();
        assert!((lost / given - 1.0).abs() < 2e-14, "{lost} {given}");
    }

    #[test]
    fn a_start_beyond_its_switch_switches_at_once() {
        for (temperature, heater, other) in
            [(294.0, Heater::On, Heater::Off), (290.0, Heater::Off, Heater::On)]
        {
            let pieces = thermostat(temperature, heater).pieces(1.0);
            assert_eq!(pieces.len(), 2);
            assert_eq!(pieces[1], Piece { t: 0.0, mode: other, y: [temperature] });
        }
    }

    #[test]
    fn a_room_that_does_not_get_to_the_end_of_its_band_does_not_switch() {
        let room = Thermostat { power: 0.0, outside: 293.0, ..thermostat(292.5, Heater::Off) };
        assert_eq!((room.time_on(), room.time_off()), (f64::INFINITY, f64::INFINITY));
        assert_eq!(room.pieces(1e9).len(), 1);
        assert!((room.state(1e9)[0] - 293.0).abs() < 1e-9);
    }
}

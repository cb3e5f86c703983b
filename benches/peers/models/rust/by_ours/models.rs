//! The five models as a user of `deltazero-solvers` would state them. Parameters are those of `text/models`; the block rests below
//! 1e-10 of the largest speed, as it does for the other tools here.

use std::f64::consts::FRAC_PI_4;

use deltazero_solvers::{Next, Real, System};

use crate::parameters::{block, carts, converter, neuron, van_der_pol};

/// A system with its start, the sizes of its states, which allowed errors are a share of, and its end [s].
pub(crate) trait Model: System {
    const T_END: f64;

    fn start(&self) -> Self::State<f64>;
    fn scale(&self) -> Vec<f64>;
}

pub(crate) struct VanDerPol;

impl System for VanDerPol {
    type Mode = ();
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 0];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) {}

    fn rhs<S: Real>(&self, (): (), _t: S, &[x, v]: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = [v, (-(x * x) + 1.0) * v * van_der_pol::MU - x];
    }

    fn guards<S: Real>(&self, (): (), _t: S, _y: &[S; 2], _g: &mut [S; 0]) {}

    fn transition<S: Real>(&self, (): (), _i: usize, _t: S, _y: &mut [S; 2]) -> Next<()> {
        Next::Mode(())
    }
}

impl Model for VanDerPol {
    const T_END: f64 = van_der_pol::T_END;

    fn start(&self) -> [f64; 2] {
        [2.0, 0.0]
    }

    fn scale(&self) -> Vec<f64> {
        vec![2.0, 1e-3]
    }
}

/// The potential [V].
pub(crate) struct IntegrateAndFire;

#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Membrane {
    Charging,
    HeldSince(f64),
}

impl System for IntegrateAndFire {
    type Mode = Membrane;
    type State<S: Real> = [S; 1];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 1]) -> Membrane {
        Membrane::Charging
    }

    fn rhs<S: Real>(&self, mode: Membrane, _t: S, &[v]: &[S; 1], dydt: &mut [S; 1]) {
        *dydt = [match mode {
            Membrane::Charging => (-v + (neuron::E_L + neuron::RI)) / neuron::TAU,
            Membrane::HeldSince(_) => S::cst(0.0),
        }];
    }

    fn guards<S: Real>(&self, mode: Membrane, t: S, &[v]: &[S; 1], g: &mut [S; 1]) {
        *g = [match mode {
            Membrane::Charging => -v + neuron::V_TH,
            Membrane::HeldSince(spike) => -t + (spike + neuron::T_REF),
        }];
    }

    fn transition<S: Real>(
        &self,
        mode: Membrane,
        _i: usize,
        t: S,
        y: &mut [S; 1],
    ) -> Next<Membrane> {
        Next::Mode(match mode {
            Membrane::Charging => {
                *y = [S::cst(neuron::V_R)];
                Membrane::HeldSince(t.value())
            }
            Membrane::HeldSince(_) => Membrane::Charging,
        })
    }
}

impl Model for IntegrateAndFire {
    const T_END: f64 = neuron::T_END;

    fn start(&self) -> [f64; 1] {
        [neuron::E_L]
    }

    fn scale(&self) -> Vec<f64> {
        vec![neuron::V_TH - neuron::V_R]
    }
}

/// The current of the coil [A] and the voltage of the load [V].
pub(crate) struct BuckConverter;

/// What conducts, with the periods that are over.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Conduction {
    On(u32),
    Diode(u32),
    Idle(u32),
}

impl System for BuckConverter {
    type Mode = Conduction;
    type State<S: Real> = [S; 2];
    /// The current, and the time to the next turn of the switch.
    type Guards<S: Real> = [S; 2];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> Conduction {
        Conduction::On(0)
    }

    fn rhs<S: Real>(&self, mode: Conduction, _t: S, &[i, v]: &[S; 2], dydt: &mut [S; 2]) {
        let didt = match mode {
            Conduction::On(_) => (-v + converter::V_IN) / converter::L,
            Conduction::Diode(_) => -v / converter::L,
            Conduction::Idle(_) => S::cst(0.0),
        };
        *dydt = [didt, (i - v / converter::R) / converter::C];
    }

    fn guards<S: Real>(&self, mode: Conduction, t: S, &[i, _]: &[S; 2], g: &mut [S; 2]) {
        let until = |periods: f64| -t + periods * converter::T;
        *g = match mode {
            Conduction::On(k) => [S::cst(1.0), until(f64::from(k) + converter::DUTY)],
            Conduction::Diode(k) => [i, until(f64::from(k + 1))],
            Conduction::Idle(k) => [S::cst(1.0), until(f64::from(k + 1))],
        };
    }

    fn transition<S: Real>(
        &self,
        mode: Conduction,
        guard: usize,
        _t: S,
        [i, _]: &mut [S; 2],
    ) -> Next<Conduction> {
        Next::Mode(match (mode, guard) {
            (Conduction::On(k), _) => Conduction::Diode(k),
            (Conduction::Diode(k), 0) => {
                *i = S::cst(0.0);
                Conduction::Idle(k)
            }
            (Conduction::Diode(k) | Conduction::Idle(k), _) => Conduction::On(k + 1),
        })
    }
}

impl Model for BuckConverter {
    const T_END: f64 = converter::T_END;

    fn start(&self) -> [f64; 2] {
        [0.0; 2]
    }

    fn scale(&self) -> Vec<f64> {
        vec![converter::V_IN * converter::T / converter::L, converter::V_IN]
    }
}

/// The tilt [rad] and its rate.
pub(crate) struct RockingBlock {
    /// The angle of the diagonal [rad].
    alpha: f64,
    /// The square of the frequency [1/s²].
    p2: f64,
    /// What an impact keeps of the angular velocity.
    kept: f64,
}

impl RockingBlock {
    pub(crate) fn new() -> Self {
        let alpha = f64::atan2(0.2, 0.8);
        let p2 = 3.0 * 9.81 / (4.0 * f64::hypot(0.2, 0.8));
        Self { alpha, p2, kept: 1.0 - 1.5 * alpha.sin().powi(2) }
    }
}

/// The corner that the block stands on.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum On {
    Left,
    Right,
    Both,
}

impl System for RockingBlock {
    type Mode = On;
    type State<S: Real> = [S; 2];
    /// The angle, what it lacks to overturn, what the corner carries.
    type Guards<S: Real> = [S; 3];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> On {
        On::Right
    }

    fn rhs<S: Real>(&self, on: On, _t: S, &[theta, omega]: &[S; 2], dydt: &mut [S; 2]) {
        *dydt = match on {
            On::Right => [omega, (-theta + self.alpha).sin() * -self.p2],
            On::Left => [omega, (theta + self.alpha).sin() * self.p2],
            On::Both => [S::cst(0.0); 2],
        };
    }

    fn guards<S: Real>(&self, on: On, _t: S, &[theta, omega]: &[S; 2], g: &mut [S; 3]) {
        let angle = match on {
            On::Right => theta,
            On::Left => -theta,
            On::Both => {
                *g = [S::cst(1.0); 3];
                return;
            }
        };
        let (sin, cos) = (-angle + self.alpha).sin_cos();
        let press = (sin * sin + cos * omega * omega / self.p2) * -0.75 + 1.0;
        *g = [angle, -angle + (self.alpha + FRAC_PI_4), press];
    }

    fn transition<S: Real>(&self, on: On, guard: usize, _t: S, y: &mut [S; 2]) -> Next<On> {
        if guard > 0 {
            return Next::Stop;
        }
        *y = [S::cst(0.0), y[1] * self.kept];
        if y[1].value().abs() < block::LEAST * self.p2.sqrt() * self.alpha {
            y[1] = S::cst(0.0);
            return Next::Mode(On::Both);
        }
        Next::Mode(if on == On::Right { On::Left } else { On::Right })
    }
}

impl Model for RockingBlock {
    const T_END: f64 = block::T_END;

    fn start(&self) -> [f64; 2] {
        [0.15, 0.0]
    }

    fn scale(&self) -> Vec<f64> {
        vec![self.alpha, self.p2.sqrt() * self.alpha]
    }
}

/// Places [m], then velocities [m/s]; guard i is the gap between carts i and i + 1.
pub(crate) struct Carts;

impl System for Carts {
    type Mode = ();
    type State<S: Real> = Vec<S>;
    type Guards<S: Real> = Vec<S>;

    fn dim(&self) -> usize {
        2 * carts::N
    }

    fn n_guards(&self) -> usize {
        carts::N - 1
    }

    fn guard_span(&self) -> usize {
        2
    }

    fn initial_mode(&self, _t: f64, _y: &Vec<f64>) {}

    fn rhs<S: Real>(&self, (): (), _t: S, y: &Vec<S>, dydt: &mut Vec<S>) {
        let (x, v) = y.split_at(carts::N);
        let (dx, dv) = dydt.split_at_mut(carts::N);
        dx.copy_from_slice(v);
        for (dv, x) in dv.iter_mut().zip(x) {
            *dv = *x * -carts::K;
        }
    }

    fn guards<S: Real>(&self, (): (), _t: S, y: &Vec<S>, g: &mut Vec<S>) {
        for (g, pair) in g.iter_mut().zip(y[..carts::N].windows(2)) {
            *g = pair[1] - pair[0] + carts::GAP;
        }
    }

    fn transition<S: Real>(&self, (): (), i: usize, _t: S, y: &mut Vec<S>) -> Next<()> {
        let (x, v) = y.split_at_mut(carts::N);
        let (middle, [a, b]) = ((x[i] + x[i + 1]) * 0.5, [v[i], v[i + 1]]);
        x[i] = middle + 0.5 * carts::GAP;
        x[i + 1] = middle - 0.5 * carts::GAP;
        let [less, more] = [0.5 * (1.0 - carts::E), 0.5 * (1.0 + carts::E)];
        v[i] = a * less + b * more;
        v[i + 1] = a * more + b * less;
        Next::Mode(())
    }
}

impl Model for Carts {
    const T_END: f64 = carts::T_END;

    fn start(&self) -> Vec<f64> {
        carts::start()
    }

    fn scale(&self) -> Vec<f64> {
        carts::scale()
    }
}

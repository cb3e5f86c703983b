//! Implicit methods on a stiff system of many states, its linear systems sparse.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

mod common;

use common::at_most;
use deltazero_solvers::taylor::ExtendedIntegration;
use deltazero_solvers::{
    Blind, Control, Error, Integration, METHODS, Method, ModeOfState, Next, Real, Sensitive, Stats,
    System, Tolerance, Unblind,
};

/// Heat in a rod, `ẏ_i = (n + 1)² (y_(i−1) − 2 y_i + y_(i+1))` between ends at zero.
struct Rod {
    n: usize,
}

impl Rod {
    fn stiffness(&self) -> f64 {
        ((self.n + 1) * (self.n + 1)) as f64
    }

    /// The slowest and the fastest mode together, in closed form.
    fn solution(&self, t: f64) -> Vec<f64> {
        let mode = |k: usize, i: usize| {
            let angle = std::f64::consts::PI * k as f64 / (self.n + 1) as f64;
            let decay = 4.0 * self.stiffness() * (0.5 * angle).sin().powi(2);
            (angle * (i + 1) as f64).sin() * (-decay * t).exp()
        };
        (0..self.n).map(|i| mode(1, i) + mode(self.n, i)).collect()
    }
}

impl System for Rod {
    type Mode = ();
    type State<S: Real> = Vec<S>;
    type Guards<S: Real> = [S; 0];

    fn dim(&self) -> usize {
        self.n
    }

    fn initial_mode(&self, _t: f64, _y: &Vec<f64>) {}

    fn rhs<S: Real>(&self, (): (), _t: S, y: &Vec<S>, dydt: &mut Vec<S>) {
        for i in 0..self.n {
            let left = if i > 0 { y[i - 1] } else { S::cst(0.0) };
            let right = if i + 1 < self.n { y[i + 1] } else { S::cst(0.0) };
            dydt[i] = (left - y[i] * 2.0 + right) * self.stiffness();
        }
    }

    fn guards<S: Real>(&self, (): (), _t: S, _y: &Vec<S>, _g: &mut [S; 0]) {}

    fn guard_bounds(&self, (): (), _t: f64, _y: &Vec<f64>, _bounds: &mut [f64; 0]) {}

    fn transition<S: Real>(&self, (): (), _guard: usize, _t: S, _y: &mut Vec<S>) -> Next<()> {
        Next::Stop
    }

    fn jacobian(&self, (): (), _t: f64, _y: &Vec<f64>, mut entry: impl FnMut(usize, usize, f64)) {
        for i in 0..self.n {
            entry(i, i, -2.0 * self.stiffness());
            if i > 0 {
                entry(i, i - 1, self.stiffness());
                entry(i - 1, i, self.stiffness());
            }
        }
    }

    fn time_derivative(&self, (): (), _t: f64, _y: &Vec<f64>, dfdt: &mut Vec<f64>) {
        dfdt.fill(0.0);
    }
}

#[test]
fn heat_in_a_rod_of_many_cells_is_followed_in_few_steps() {
    let t_end = 0.1;
    for n in [20, 200] {
        let rod = Rod { n };
        // Measured: 2.9e-11, 8.8e-10, 1.4e-8.
        for (name, bound) in [("rodas5p", 2.9e-10), ("radau5", 8.8e-9), ("bdf", 1.4e-7)] {
            let tolerance = Tolerance { rtol: 1e-8, atol: vec![1e-8; n] };
            let method = Method::named(name).unwrap();
            let mut solver = method.solver(&rod, Control::Adaptive(tolerance)).unwrap();
            let mut run = Integration::new(&rod, 0.0, rod.solution(0.0));
            run.run(t_end, &mut *solver, &mut ()).unwrap();
            // The fastest mode decays in 6e-6 of a unit of time where there are 200 cells.
            assert!(run.stats.n_accepted < 500, "{name}: {}", run.stats.n_accepted);
            at_most(name, common::distance(&run.point.y, &rod.solution(t_end)), bound);
        }
    }
}

/// Carts in a row, joined by springs that stiffen and by dampers, the ends to walls: `[x_1 …, v_1 …]`.
struct Carts {
    n: usize,
}

impl Carts {
    const DAMPING: f64 = 300.0;

    /// Stretch and its rate of the joint before cart i.
    fn joint<S: Real>(&self, y: &[S], i: usize) -> [S; 2] {
        let at = |i: usize| {
            let is_wall = i == 0 || i > self.n;
            if is_wall { [S::cst(0.0); 2] } else { [y[i - 1], y[self.n + i - 1]] }
        };
        let ([x0, v0], [x1, v1]) = (at(i), at(i + 1));
        [x1 - x0, v1 - v0]
    }

    /// Stiffness of a joint at a stretch.
    fn stiffness(stretch: f64) -> f64 {
        1e4 * (1.0 + 3.0 * stretch * stretch)
    }
}

impl System for Carts {
    type Mode = ();
    type State<S: Real> = Vec<S>;
    type Guards<S: Real> = [S; 0];

    fn dim(&self) -> usize {
        2 * self.n
    }

    fn initial_mode(&self, t: f64, y: &Vec<f64>) {
        self.mode_of_state(t, y);
    }

    fn rhs<S: Real>(&self, (): (), t: S, y: &Vec<S>, dydt: &mut Vec<S>) {
        let force = |i: usize| {
            let [u, u_dot] = self.joint(y, i);
            (u + u * u * u) * 1e4 + u_dot * Self::DAMPING
        };
        for i in 0..self.n {
            dydt[i] = y[self.n + i];
            dydt[self.n + i] = force(i + 1) - force(i);
        }
        dydt[self.n] = dydt[self.n] + t.sin() * 50.0;
    }

    fn guards<S: Real>(&self, (): (), _t: S, _y: &Vec<S>, _g: &mut [S; 0]) {}

    fn guard_bounds(&self, (): (), _t: f64, _y: &Vec<f64>, _bounds: &mut [f64; 0]) {}

    fn transition<S: Real>(&self, (): (), _guard: usize, _t: S, _y: &mut Vec<S>) -> Next<()> {
        Next::Stop
    }

    fn jacobian(&self, (): (), _t: f64, y: &Vec<f64>, mut entry: impl FnMut(usize, usize, f64)) {
        let n = self.n;
        for i in 0..n {
            entry(i, n + i, 1.0);
            let [before, after] = [i, i + 1].map(|joint| Self::stiffness(self.joint(y, joint)[0]));
            entry(n + i, i, -before - after);
            entry(n + i, n + i, -2.0 * Self::DAMPING);
            for (j, k) in [(i.wrapping_sub(1), before), (i + 1, after)] {
                if j < n {
                    entry(n + i, j, k);
                    entry(n + i, n + j, Self::DAMPING);
                }
            }
        }
    }
}

impl ModeOfState for Carts {
    fn mode_of_state<S: Real>(&self, _t: S, y: &Vec<S>) {
        assert_eq!(y.len(), self.dim(), "a model may look at each of its states");
    }
}

/// The carts with the default Jacobian.
struct ByDefault(Carts);

impl System for ByDefault {
    type Mode = ();
    type State<S: Real> = Vec<S>;
    type Guards<S: Real> = [S; 0];

    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn initial_mode(&self, _t: f64, _y: &Vec<f64>) {}

    fn rhs<S: Real>(&self, (): (), t: S, y: &Vec<S>, dydt: &mut Vec<S>) {
        self.0.rhs((), t, y, dydt);
    }

    fn guards<S: Real>(&self, (): (), _t: S, _y: &Vec<S>, _g: &mut [S; 0]) {}

    fn guard_bounds(&self, (): (), _t: f64, _y: &Vec<f64>, _bounds: &mut [f64; 0]) {}

    fn transition<S: Real>(&self, (): (), _guard: usize, _t: S, _y: &mut Vec<S>) -> Next<()> {
        Next::Stop
    }
}

/// Work and end of a run of 20 carts from rest to 2.
fn run_of_carts<P: System<State<f64> = Vec<f64>>>(carts: &P, name: &str) -> (Stats, Vec<f64>) {
    let tolerance = Tolerance { rtol: 1e-6, atol: vec![1e-6; 40] };
    let method = Method::named(name).unwrap();
    let mut solver = method.solver(carts, Control::Adaptive(tolerance)).unwrap();
    let mut run = Integration::new(carts, 0.0, vec![0.0; 40]);
    run.run(2.0, &mut *solver, &mut ()).unwrap();
    (run.stats, run.point.y)
}

#[test]
fn the_default_jacobian_of_carts_in_a_row_is_as_good_as_one_by_hand() {
    for name in ["rodas5p", "radau5", "bdf", "auto"] {
        let (work, y) = run_of_carts(&Carts { n: 20 }, name);
        let (work_by_default, y_by_default) = run_of_carts(&ByDefault(Carts { n: 20 }), name);
        assert_eq!(work, work_by_default, "{name}");
        at_most(name, common::distance(&y, &y_by_default), 1e-9);
    }
}

#[test]
fn a_start_with_other_states_than_the_system_has_is_refused() {
    let carts = Carts { n: 3 };
    let tolerance = Tolerance { rtol: 1e-6, atol: vec![1e-6; 6] };
    let is_refused = |outcome: Result<_, Error>| {
        matches!(outcome, Err(Error::BadArgument { name: "number of states", .. }))
    };
    for n in [0, 5, 7] {
        for method in METHODS {
            let control = match method.is_fixed_step() {
                true => Control::Fixed(0.01),
                false => Control::Adaptive(tolerance.clone()),
            };
            let mut solver = method.solver(&carts, control).unwrap();
            let mut run = Integration::new(&carts, 0.0, vec![0.0; n]);
            assert!(is_refused(run.run(1.0, &mut *solver, &mut ())), "{} with {n}", method.name);
        }
        let (blind, start) = (Blind(&carts), vec![0.0; n]);
        let mut unblind = Unblind::new(&carts, 0.0, &start, ());
        let mut solver = METHODS[0].solver(&blind, Control::Fixed(0.01)).unwrap();
        let mut run = Integration::new(&blind, 0.0, start);
        assert!(is_refused(run.run(1.0, &mut *solver, &mut unblind)), "blind with {n}");
        let mut run = ExtendedIntegration::new(&carts, 0.0, &vec![0.0; n], tolerance.clone());
        assert!(is_refused(run.run(1.0, &mut ())), "extended with {n}");
        let system = Sensitive::new(&carts, vec![vec![1.0; 6]], tolerance.clone()).unwrap();
        let refused = system.start(0.0, &vec![0.0; n]).unwrap_err();
        assert!(matches!(refused, Error::BadArgument { name: "number of states", .. }));
    }
}

/// A mass that falls on a damped spring, in one mode whose rate branches.
struct Drop;

/// The same with its state in a `Vec`, whose default Jacobian has the entries of the branch taken.
struct DropInVec;

impl Drop {
    fn rates<S: Real>(x: S, v: S) -> [S; 2] {
        [v, if x.value() > 0.0 { S::cst(-9.8) } else { -x * 1e8 - v * 3e4 - 9.8 }]
    }
}

macro_rules! without_guards {
    ($System:ty, $State:ident, $of:ty) => {
        impl System for $System {
            type Mode = ();
            type State<$State: Real> = $of;
            type Guards<S: Real> = [S; 0];

            fn dim(&self) -> usize {
                2
            }

            fn initial_mode(&self, _t: f64, _y: &Self::State<f64>) {}

            fn rhs<S: Real>(&self, (): (), _t: S, y: &Self::State<S>, dydt: &mut Self::State<S>) {
                dydt.copy_from_slice(&Drop::rates(y[0], y[1]));
            }

            fn guards<S: Real>(&self, (): (), _t: S, _y: &Self::State<S>, _g: &mut [S; 0]) {}

            fn guard_bounds(&self, (): (), _: f64, _y: &Self::State<f64>, _: &mut [f64; 0]) {}

            fn transition<S: Real>(
                &self,
                (): (),
                _guard: usize,
                _t: S,
                _y: &mut Self::State<S>,
            ) -> Next<()> {
                Next::Stop
            }
        }
    };
}

without_guards!(Drop, S, [S; 2]);
without_guards!(DropInVec, S, Vec<S>);

#[test]
fn a_branch_that_gives_the_jacobian_more_entries_is_no_matter() {
    fn run<P: System>(problem: &P, name: &str, y: P::State<f64>) -> (Stats, Vec<f64>) {
        let tolerance = Tolerance { rtol: 1e-6, atol: vec![1e-9; 2] };
        let method = Method::named(name).unwrap();
        let mut solver = method.solver(problem, Control::Adaptive(tolerance)).unwrap();
        let mut run = Integration::new(problem, 0.0, y);
        run.run(0.2, &mut *solver, &mut ()).unwrap();
        (run.stats, run.point.y.as_ref().to_vec())
    }
    for name in ["bdf", "tr_bdf2", "esdirk34", "radau5", "rodas5p"] {
        let (of_array, expected) = run(&Drop, name, [1e-3, 0.0]);
        let (of_vec, found) = run(&DropInVec, name, vec![1e-3, 0.0]);
        let (n, m) = (of_vec.n_accepted, of_array.n_accepted);
        assert!(n <= 2 * m, "{name}: {n} steps for {m}");
        at_most(name, common::distance(&found, &expected), 1e-6);
    }
}

//! How long a run of a model from text takes, over the same in Rust: `cargo bench -p deltazero-text`.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a bench panics to fail and prints its figures"
)]

use std::time::{Duration, Instant};

use deltazero_solvers::problems::SpringStop;
use deltazero_solvers::{Control, Integration, Method, Next, Outcome, Real, System, Tolerance};
use deltazero_study::Problem;
use deltazero_text::{ModelFile, TextModel};

const STOP: &str = include_str!("../tests/models/spring_stop.toml");

/// A driven double pendulum whose second bob hits a damped stop.
const PENDULUM: &str = r#"
    [parameters]
    g = 9.81
    K = 1e5
    D = 50
    c = 0.05
    [definitions]
    s = "sin(a - b)"
    co = "cos(a - b)"
    delta = "sin(a) + sin(b) - c"
    rate = "cos(a)*p + cos(b)*q"
    F = { value = "K*delta + D*rate", of = ["contact"] }
    # 2 ä + co b̈ = f1, co ä + b̈ = f2
    f1 = "-s*q^2 - 2*g*sin(a) - P*cos(a) + 0.5*cos(3*t)"
    f2 = "s*p^2 - g*sin(b) - P*cos(b)"
    P = 0
    det = "2 - co^2"
    [states]
    a = 0.3
    b = -0.4
    p = 0
    q = 0
    [rates]
    a = "p"
    b = "q"
    p = "(f1 - co*f2)/det"
    q = "(2*f2 - co*f1)/det"
    [modes.free]
    events = [{ when = "delta > 0", to = "contact" }]
    [modes.contact]
    contact = true
    definitions = { P = "F" }
    events = [{ when = "delta < 0", to = "free" }]
"#;

/// The same by hand.
struct Pendulum;

impl Pendulum {
    fn touch<S: Real>([a, b, p, q]: [S; 4]) -> (S, [S; 4], S) {
        let ((sa, ca), (sb, cb)) = (a.sin_cos(), b.sin_cos());
        let delta = sa + sb - 0.05;
        (delta, [sa, ca, sb, cb], delta * 1e5 + (ca * p + cb * q) * 50.0)
    }
}

impl System for Pendulum {
    type Mode = bool;
    type State<S: Real> = [S; 4];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 4]) -> bool {
        false
    }

    fn rhs<S: Real>(&self, touches: bool, t: S, y: &[S; 4], dydt: &mut [S; 4]) {
        let (mut g, [a, b, p, q]) = ([S::cst(0.0)], *y);
        self.rhs_with_guards(touches, t, &[a, b, p, q], dydt, &mut g);
    }

    fn guards<S: Real>(&self, touches: bool, _t: S, y: &[S; 4], g: &mut [S; 1]) {
        let delta = y[0].sin_cos().0 + y[1].sin_cos().0 - 0.05;
        *g = [if touches { delta } else { -delta }];
    }

    fn rhs_with_guards<S: Real>(
        &self,
        touches: bool,
        t: S,
        y: &[S; 4],
        dydt: &mut [S; 4],
        g: &mut [S; 1],
    ) -> bool {
        let [a, b, p, q] = *y;
        let (delta, [sa, ca, sb, cb], force) = Self::touch(*y);
        let (s, co) = (a - b).sin_cos();
        let drive = (t * 3.0).sin_cos().1 * 0.5;
        let mut f1 = -(s * (q * q)) - sa * 19.62;
        let mut f2 = s * (p * p) - sb * 9.81;
        if touches {
            f1 = f1 - force * ca;
            f2 = f2 - force * cb;
        }
        f1 = f1 + drive;
        let det = -(co * co) + 2.0;
        *dydt = [p, q, (f1 - co * f2) / det, (f2 * 2.0 - co * f1) / det];
        *g = [if touches { delta } else { -delta }];
        true
    }

    fn guard_bounds(&self, _touches: bool, _t: f64, _y: &[f64; 4], bounds: &mut [f64; 1]) {
        *bounds = [1e-15];
    }

    fn transition<S: Real>(&self, touches: bool, _: usize, _t: S, _y: &mut [S; 4]) -> Next<bool> {
        Next::Mode(!touches)
    }
}

fn model(text: &str) -> TextModel {
    let file = ModelFile::parse("speed.toml", text).unwrap_or_else(|report| panic!("{report}"));
    file.models(&[]).unwrap().remove(0)
}

/// The least time of several runs, and the evaluations of one.
fn time<P: System>(
    problem: &P,
    y0: &P::State<f64>,
    method: &str,
    rtol: f64,
    t_end: f64,
) -> (Duration, u64, Vec<f64>) {
    let method = Method::named(method).unwrap();
    let mut best = Duration::MAX;
    let mut last = (0, Vec::new());
    for _ in 0..15 {
        let tolerance = Tolerance { rtol, atol: vec![rtol * 0.1; problem.dim()] };
        let start = Instant::now();
        let mut solver = method.solver(problem, Control::Adaptive(tolerance)).unwrap();
        let mut run = Integration::new(problem, 0.0, y0.clone());
        assert_eq!(run.run(t_end, &mut *solver, &mut ()), Ok(Outcome::Finished));
        best = best.min(start.elapsed());
        last = (run.stats.work.n_rhs, run.point.y.as_ref().to_vec());
    }
    (best, last.0, last.1)
}

fn compare<P: System, const N: usize>(text: &str, exact: &P, y0: &P::State<f64>, t_end: f64) {
    let text = model(text);
    println!("any number of states");
    compare_with(&text, exact, y0, t_end);
    println!("{N} states");
    compare_with(&text.few::<N>().unwrap(), exact, y0, t_end);
}

fn compare_with<T: Problem, P: System>(text: &T, exact: &P, y0: &P::State<f64>, t_end: f64) {
    for (method, rtol) in [("rk45", 1e-6), ("dop853", 1e-10), ("taylor", 1e-10), ("radau5", 1e-8)] {
        let (own, n_rhs, end) = time(text, &text.start(), method, rtol, t_end);
        let (rust, n_rust, end_rust) = time(exact, y0, method, rtol, t_end);
        let ratio = own.as_secs_f64() / rust.as_secs_f64();
        println!(
            "{method}: {ratio:.2} = {own:.1?} over {rust:.1?}, {n_rhs} and {n_rust} evaluations, {:.1} and {:.1} ns each; {:e}",
            own.as_nanos() as f64 / n_rhs as f64,
            rust.as_nanos() as f64 / n_rust as f64,
            (end[0] - end_rust[0]).abs(),
        );
    }
}

fn mass_at_a_stop() {
    println!("== a mass at a stop");
    let exact = SpringStop {
        mass: 100.0,
        stiffness: 1e4,
        stop_stiffness: 1e6,
        gap: 0.05,
        start: [0.0, 1.0],
    };
    compare::<_, 2>(STOP, &exact, &exact.start, 50.0);
}

fn double_pendulum_at_a_stop() {
    println!("== a double pendulum at a stop");
    compare::<_, 4>(PENDULUM, &Pendulum, &[0.3, -0.4, 0.0, 0.0], 20.0);
}

/// Time of one evaluation alone.
fn right_hand_side() {
    fn per_call<P: System>(problem: &P, y: &P::State<f64>) -> f64 {
        let mut dydt = y.clone();
        let mode = problem.initial_mode(0.0, y);
        let n = 1_000_000;
        let start = Instant::now();
        for i in 0..n {
            problem.rhs(
                std::hint::black_box(mode.clone()),
                f64::from(i),
                std::hint::black_box(y),
                &mut dydt,
            );
        }
        std::hint::black_box(&dydt);
        start.elapsed().as_nanos() as f64 / f64::from(n)
    }
    println!("== a right-hand side");
    for text in [STOP, PENDULUM] {
        let text = model(text);
        println!("{:.1} ns", per_call(&text, &Problem::start(&text)));
    }
    println!("{:.1} ns in Rust", per_call(&Pendulum, &[0.3, -0.4, 0.0, 0.0]));
}

fn compilation() {
    println!("== parser, checks and compilation");
    for (name, text) in [("stop", STOP), ("pendulum", PENDULUM)] {
        let start = Instant::now();
        for _ in 0..100 {
            model(text);
        }
        println!("{name}: {:?} for parse, check and compile", start.elapsed() / 100);
    }
    let row = include_str!("../tests/models/row.toml").replace("value = 6", "value = 500");
    let start = Instant::now();
    let file = ModelFile::parse("row.toml", &row).unwrap();
    println!("1000 states: {:?} for parse and check", start.elapsed());
    let start = Instant::now();
    file.models(&[]).unwrap();
    println!("1000 states: {:?} for a model", start.elapsed());
}

fn main() {
    mass_at_a_stop();
    double_pendulum_at_a_stop();
    right_hand_side();
    compilation();
}

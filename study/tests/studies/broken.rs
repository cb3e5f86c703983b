//! What is told of problems whose runs break down.

use std::sync::atomic::AtomicBool;

use deltazero_solvers::{Error, Grid, Method, Next, Real, System};
use deltazero_study::Subject;
use deltazero_study::problem::{Problem, Quantity};
use deltazero_study::recommend::recommend;
use deltazero_study::run::{Accuracy, Limits, Price, Setting};
use deltazero_study::selection::Rules;
use deltazero_study::setting::Events;
use deltazero_study::simulation::{Asked, Simulation};
use deltazero_study::warning::{Code, Warning};

/// How it breaks down, at 0.1.
#[derive(Clone, Copy)]
enum Way {
    /// The rate of this state is no number any more.
    NotANumber(usize),
    /// The transition of this guard leaves it violated, for it lowers the last state.
    Chatter(usize),
}

/// States at rest until a run breaks down; each half of them is a site, with a guard of its own.
#[derive(Clone)]
struct Broken {
    n: usize,
    way: Way,
}

impl System for Broken {
    type Mode = ();
    type State<S: Real> = Vec<S>;
    type Guards<S: Real> = [S; 2];

    fn dim(&self) -> usize {
        self.n
    }

    fn initial_mode(&self, _t: f64, _y: &Vec<f64>) {}

    fn rhs<S: Real>(&self, (): (), t: S, _y: &Vec<S>, dydt: &mut Vec<S>) {
        dydt.fill(S::cst(0.0));
        if let Way::NotANumber(state) = self.way {
            dydt[state] = (-t + 0.1).sqrt();
        }
    }

    fn guards<S: Real>(&self, (): (), t: S, y: &Vec<S>, g: &mut [S; 2]) {
        *g = [S::cst(1.0); 2];
        if let Way::Chatter(guard) = self.way {
            let lowered = -y[self.n - 1] + (self.n - 1) as f64;
            g[guard] = -t - lowered + 0.1;
        }
    }

    fn guard_bounds(&self, (): (), _t: f64, _y: &Vec<f64>, bounds: &mut [f64; 2]) {
        *bounds = [1e-15; 2];
    }

    fn transition<S: Real>(&self, (): (), _guard: usize, _t: S, y: &mut Vec<S>) -> Next<()> {
        y[self.n - 1] = y[self.n - 1] - 1.0;
        Next::Mode(())
    }
}

impl Problem for Broken {
    fn start(&self) -> Vec<f64> {
        (0..self.n).map(|i| i as f64).collect()
    }

    fn states(&self) -> Vec<Quantity> {
        let unit = |i| if i % 2 == 0 { "m" } else { "" };
        (0..self.n).map(|i| Quantity::new(format!("q{i}"), unit(i), 1.0)).collect()
    }

    fn n_sites(&self) -> usize {
        2
    }

    fn site_of_guard(&self, (): &(), guard: usize) -> usize {
        guard
    }
}

fn simulated(way: Way) -> Simulation {
    let (subject, stop) = (Subject::of(Broken { n: 4, way }), AtomicBool::new(false));
    let method = Method::named("rk45").unwrap();
    let setting = Setting { method, events: Events::Located, accuracy: Accuracy::Rtol(1e-6, None) };
    let grid = Grid::uniform(0.05, 1.0);
    let asked = Asked { setting: &setting, t_end: 1.0, grid, tell: &|_: &Warning| {} };
    let mut watch = Limits::none(&stop).watch(Price::of_setting(&setting));
    subject.parts[0].simulate(&asked, &mut watch)
}

#[test]
fn the_site_of_a_state_or_a_guard_that_breaks_a_run_is_told() {
    for (way, site) in [
        (Way::NotANumber(1), 0),
        (Way::NotANumber(2), 1),
        (Way::NotANumber(3), 1),
        (Way::Chatter(0), 0),
        (Way::Chatter(1), 1),
    ] {
        let own = simulated(way);
        let error = own.run.outcome.as_ref().unwrap_err();
        match way {
            Way::NotANumber(_) => assert!(matches!(error, Error::NonFinite { .. }), "{error}"),
            Way::Chatter(_) => assert!(matches!(error, Error::Chatter { .. }), "{error}"),
        }
        assert_eq!(own.failed_site, Some(site), "{error}");
    }
}

#[test]
fn a_reference_that_breaks_down_in_events_is_a_warning_of_chatter() {
    let stop = AtomicBool::new(false);
    let codes = |way| -> Vec<Code> {
        let subject = Subject::of(Broken { n: 4, way });
        let (times, rules) = (vec![0.5, 1.0], Rules::default());
        let limits = Limits::none(&stop);
        let answer = recommend(subject, (1.0, times), 1e-6, &rules, limits, Vec::new(), &|_| {});
        assert!(answer.first().is_none());
        answer.warnings.iter().map(|warning| warning.code).collect()
    };
    assert_eq!(codes(Way::Chatter(1)), [Code::Chatter]);
    assert_eq!(codes(Way::NotANumber(1)), []);
}

#[test]
fn a_state_is_told_with_its_units_and_a_long_one_by_its_first_numbers() {
    let words = |n| {
        let problem = Broken { n, way: Way::Chatter(0) };
        problem.in_brief(&problem.start())
    };
    assert_eq!(words(2), "q0 = 0.000000e0 m, q1 = 1.000000e0");
    assert!(words(8).ends_with("q6 = 6.000000e0 m, q7 = 7.000000e0"), "{}", words(8));
    assert!(words(9).ends_with("q7 = 7.000000e0, … (9 states)"), "{}", words(9));
}

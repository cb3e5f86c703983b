//! Problems that contradict themselves, as a user of the study meets them.

use std::sync::atomic::AtomicBool;

use deltazero_solvers::contracts::Breach;
use deltazero_solvers::{Next, Real, System};
use deltazero_study::check::ProblemError;
use deltazero_study::problem::{Problem, Quantity, Role, Touch};
use deltazero_study::reference::ReferenceError;
use deltazero_study::setting::Events;
use deltazero_study::work_precision::work_precision;
use deltazero_study::{Plan, Subject};

use crate::common::plan;

/// A mass that falls on a pad and is held there, as it is pressed down, for a while.
#[derive(Clone, Copy)]
struct Faller {
    /// The modes in which it gives a force.
    gives: fn(Mode) -> bool,
    tells_forces: bool,
    /// Whether the push of the pad has no derivative.
    takes_value: bool,
    /// The site of its guard in a mode, and the numbers of its row there.
    site: fn(Mode) -> usize,
    row: fn(Mode) -> &'static [f64],
}

/// One that does not contradict itself.
const FALLER: Faller = Faller {
    gives: |_| true,
    tells_forces: true,
    takes_value: false,
    site: |_| 0,
    row: |_| &[0.0; 2],
};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    Falls,
    OnPad,
    Held,
}

impl System for Faller {
    type Mode = Mode;
    type State<S: Real> = [S; 2];
    type Guards<S: Real> = [S; 1];

    fn initial_mode(&self, _t: f64, _y: &[f64; 2]) -> Mode {
        Mode::Falls
    }

    fn rhs<S: Real>(&self, mode: Mode, _t: S, &[x, v]: &[S; 2], dydt: &mut [S; 2]) {
        let pressed = if self.takes_value { S::cst(x.value()) } else { x };
        *dydt = match mode {
            Mode::Falls => [v, S::cst(-10.0)],
            Mode::OnPad => [v, -pressed * 1e3 - 10.0],
            Mode::Held => [S::cst(0.0); 2],
        };
    }

    fn guards<S: Real>(&self, mode: Mode, _t: S, &[x, v]: &[S; 2], g: &mut [S; 1]) {
        *g = match mode {
            Mode::Falls => [x],
            Mode::OnPad => [-v],
            Mode::Held => [S::cst(1.0)],
        };
    }

    fn guard_bounds(&self, _mode: Mode, _t: f64, _y: &[f64; 2], bounds: &mut [f64; 1]) {
        *bounds = [1e-15];
    }

    fn transition<S: Real>(&self, mode: Mode, _: usize, _t: S, y: &mut [S; 2]) -> Next<Mode> {
        Next::Mode(match mode {
            Mode::Falls => Mode::OnPad,
            _ => {
                y[1] = S::cst(0.0);
                Mode::Held
            }
        })
    }
}

impl Problem for Faller {
    fn start(&self) -> [f64; 2] {
        [0.05, 0.0]
    }

    fn states(&self) -> Vec<Quantity> {
        vec![Quantity::new("x", "m", 0.05), Quantity::new("v", "m/s", 1.0)]
    }

    fn site_of_guard(&self, mode: &Mode, _guard: usize) -> usize {
        (self.site)(*mode)
    }

    fn rows(&self, mode: &Mode, _t: f64, _y: &[f64; 2], row: &mut dyn FnMut(usize, &[f64])) {
        row(0, (self.row)(*mode));
    }

    fn role(&self, mode: &Mode, _site: usize) -> Role {
        if *mode == Mode::Falls { Role::Free } else { Role::Contact }
    }

    fn tells_forces(&self) -> bool {
        self.tells_forces
    }

    fn touch<S: Real>(&self, mode: &Mode, _t: S, y: &[S; 2], site: usize) -> Option<Touch<S>> {
        let force = if self.role(mode, site).is_contact() { -y[0] * 1e3 } else { S::cst(0.0) };
        (self.gives)(*mode).then_some(Touch { depth: -y[0], rate: -y[1], force })
    }
}

/// What a study of it to `t_end` says against it.
fn refusal(problem: Faller, t_end: f64) -> Option<ProblemError> {
    let plan =
        Plan { times: vec![0.1], ..plan(&["rk45"], &[Events::Located], &[1e-6], &[], t_end) };
    let (subject, stop) = (Subject::of(problem), AtomicBool::new(false));
    match work_precision(&subject, &plan, &[], &stop, &|_| {}) {
        Err(ReferenceError::Problem(error)) => Some(error),
        other => other.map(|_| None).unwrap(),
    }
}

#[test]
fn a_contact_without_a_force_is_refused_at_the_first_such_mode_that_is_met() {
    let falls = FALLER;
    assert_eq!(refusal(falls, 0.3), None);
    let no_force = |gives, tells_forces| {
        let error = refusal(Faller { gives, tells_forces, ..FALLER }, 0.3).unwrap();
        let ProblemError::NoForce { t, mode, site } = error else { panic!("{error}") };
        assert_eq!(site, 0);
        (mode, t)
    };
    // It lands at 0.1 s.
    let (mode, t) = no_force(|_| false, true);
    assert!(mode == "OnPad" && (t - 0.1).abs() < 1e-9, "{mode} {t}");
    // Where one contact has a force, another has.
    for tells_forces in [true, false] {
        let (mode, t) = no_force(|mode| mode != Mode::Held, tells_forces);
        assert!(mode == "Held" && t > 0.1, "{mode} {t}");
    }
    // A rigid contact has none to tell.
    assert_eq!(refusal(Faller { gives: |_| false, tells_forces: false, ..FALLER }, 0.3), None);
}

#[test]
fn a_force_that_is_given_in_contact_alone_is_refused_and_not_lost() {
    let error = refusal(Faller { gives: |mode| mode != Mode::Falls, ..FALLER }, 0.3);
    let message = error.unwrap().to_string();
    assert!(message.contains("gives a force in mode OnPad") && message.contains("at site 0"));
}

#[test]
fn an_end_of_the_run_that_is_no_time_after_its_start_is_refused() {
    for t_end in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let error = refusal(FALLER, t_end);
        assert!(matches!(error, Some(ProblemError::End { .. })), "{t_end}: {error:?}");
    }
}

#[test]
fn a_number_without_a_derivative_is_refused_in_the_first_such_mode_that_is_met() {
    let error = refusal(Faller { takes_value: true, ..FALLER }, 0.3);
    let Some(ProblemError::Contract { t, mode, breach }) = error else { panic!("{error:?}") };
    assert!(mode == "OnPad" && t > 0.1, "{mode} {t}");
    assert!(matches!(*breach, Breach::Value { state: 1, .. }), "{breach}");
}

#[test]
fn a_later_mode_of_another_shape_is_refused_where_it_is_met() {
    let refused = |problem, what: &str| {
        let error = refusal(problem, 0.3).unwrap();
        let ProblemError::InMode { t, mode, error } = error else { panic!("{error}") };
        assert!(mode == "OnPad" && (t - 0.1).abs() < 1e-9, "{mode} {t}");
        assert!(error.to_string().contains(what), "{error}");
    };
    let row = |row| Faller { row, ..FALLER };
    refused(row(|mode| if mode == Mode::OnPad { &[0.0; 3] } else { &[0.0; 2] }), "3 values");
    refused(row(|mode| if mode == Mode::OnPad { &[0.0; 1] } else { &[0.0; 2] }), "1 values");
    let site = |mode| if mode == Mode::OnPad { 5 } else { 0 };
    refused(Faller { site, ..FALLER }, "guard 0 is of site 5");
}

//! The event-blind baseline: a system whose mode is read off the state at every stage.

use std::fmt;
use std::ops::ControlFlow;

use crate::error::Error;
use crate::integrate::of_its_length;
use crate::point::Point;
use crate::real::Real;
use crate::record::{Accepted, Event, Grazing, Needs, Record};
use crate::system::{ModeOfState, Next, System, Vector};
use crate::work::Stats;

/// A system whose right-hand side reads its mode off the state, as a model written with `if` statements does. Of its
/// guards only the one that [ends](ModeOfState::end) a run remains.
///
/// A step whose stages lie on both sides of a surface has order one or two, whatever the method. Runs with
/// [located](crate::integrate) events are compared with this baseline. It has no [sensitivities](crate::Sensitive), because
/// nothing carries a derivative across a switch.
///
/// ```
/// use deltazero_solvers::problems::SpringStop;
/// use deltazero_solvers::{Blind, Run};
///
/// let (mass, stiffness, stop_stiffness) = (1.0, 4.0, 400.0);
/// let stop = SpringStop { mass, stiffness, stop_stiffness, gap: 0.1, start: [-0.3, 0.4] };
/// let exact = Run::of(&stop, stop.start).method("dop853").tolerance(1e-12, 1e-12).to(3.0)?;
/// let located = Run::of(&stop, stop.start).method("rk4").step(1e-3).to(3.0)?;
/// let blind = Run::of(&Blind(&stop), stop.start).method("rk4").step(1e-3).to(3.0)?;
/// let error = |y: [f64; 2]| (y[0] - exact.end.y[0]).abs();
/// assert!(error(blind.end.y) > 100.0 * error(located.end.y));
/// # Ok::<(), deltazero_solvers::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Blind<'a, P>(pub &'a P);

/// The one mode of a [`Blind`] system.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct OfState;

impl fmt::Debug for OfState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("(read off the state)")
    }
}

impl<P: ModeOfState> System for Blind<'_, P> {
    type Mode = OfState;
    type State<S: Real> = P::State<S>;
    type Guards<S: Real> = [S; 1];

    // Code for each order, of all modes in one function, would be too much.
    const IS_TRACED: bool = true;

    const IS_BLIND: bool = true;

    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn initial_mode(&self, _t: f64, _y: &Self::State<f64>) -> OfState {
        OfState
    }

    fn rhs<S: Real>(&self, _: OfState, t: S, y: &Self::State<S>, dydt: &mut Self::State<S>) {
        // The values decide, and a mode has no derivative.
        let values = Vector::from_fn(y.as_ref().len(), |i| y.as_ref()[i].value());
        self.0.rhs(self.0.mode_of_state(t.value(), &values), t, y, dydt);
    }

    fn guards<S: Real>(&self, _: OfState, t: S, y: &Self::State<S>, g: &mut [S; 1]) {
        *g = [self.0.end(t, y)];
    }

    fn guard_bounds(&self, _: OfState, _t: f64, _y: &Self::State<f64>, bounds: &mut [f64; 1]) {
        *bounds = [self.0.end_bound()];
    }

    fn transition<S: Real>(
        &self,
        _: OfState,
        _guard: usize,
        _t: S,
        _y: &mut Self::State<S>,
    ) -> Next<OfState> {
        Next::Stop
    }

    fn time_derivative(
        &self,
        _: OfState,
        t: f64,
        y: &Self::State<f64>,
        dfdt: &mut Self::State<f64>,
    ) {
        self.0.time_derivative(self.0.mode_of_state(t, y), t, y, dfdt);
    }

    fn jacobian(
        &self,
        _: OfState,
        t: f64,
        y: &Self::State<f64>,
        entry: impl FnMut(usize, usize, f64),
    ) {
        self.0.jacobian(self.0.mode_of_state(t, y), t, y, entry);
    }
}

/// Shows a blind run to a recorder of the underlying system. Each step is shown in the mode of its start, and an
/// event is shown at the end of each step after which the mode is another.
///
/// ```
/// use deltazero_solvers::problems::{HertzBall, StopMode};
/// use deltazero_solvers::{Blind, Control, Integration, Method, Next, Trajectory, Unblind};
///
/// let ball = HertzBall { mass: 1.0, stiffness: 1e4, exponent: 1.5, start: [-0.1, 1.0] };
/// let (h, blind) = (1e-3, Blind(&ball));
/// let method = Method::named("rk4").ok_or("no such method")?;
/// let mut solver = method.solver(&blind, Control::Fixed(h))?;
/// let mut trajectory = Trajectory::of_events();
/// let mut record = Unblind::new(&ball, 0.0, &ball.start, &mut trajectory);
/// Integration::new(&blind, 0.0, ball.start).run(0.15, &mut *solver, &mut record)?;
/// let [entry] = &trajectory.events[..] else { panic!("it touches once") };
/// assert_eq!((entry.before, entry.after), (StopMode::Free, Next::Mode(StopMode::Contact)));
/// assert!((entry.t - ball.entry_time()).abs() < 1.001 * h);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Unblind<'a, P: System, R> {
    problem: &'a P,
    mode: P::Mode,
    record: R,
}

impl<'a, P: ModeOfState, R: Record<P>> Unblind<'a, P, R> {
    /// A recorder for a run of `Blind(problem)` from `(t, y)`, which shows the run to `record`.
    pub fn new(problem: &'a P, t: f64, y: &P::State<f64>, record: R) -> Self {
        Self { problem, mode: problem.mode_of_state(t, &of_its_length(problem, y)), record }
    }
}

impl<'a, P: ModeOfState, R: Record<P>> Record<Blind<'a, P>> for Unblind<'a, P, R> {
    fn begin(&mut self, start: &Point<Blind<'a, P>>, t_end: f64) -> Result<(), Error> {
        let mode = self.mode.clone();
        self.record.begin(&Point { t: start.t, y: start.y.clone(), mode }, t_end)
    }

    fn step(&mut self, accepted: &Accepted<'_, Blind<'a, P>>) -> ControlFlow<()> {
        let (step, before) = (accepted.step, self.mode.clone());
        let Accepted { proposed, stats, .. } = *accepted;
        let seen = Accepted { mode: before.clone(), step, landed_on: None, proposed, stats };
        let go_on = self.record.step(&seen);
        let after = self.problem.mode_of_state(step.t1(), step.y1());
        if after == before {
            return go_on;
        }
        self.mode = after.clone();
        let (t, y) = (step.t1(), step.y1());
        let after = Next::Mode(after);
        // A run that is interrupted here has made this step, so its event is shown, too.
        let event = self.record.event(&Event { t, guard: 0, before, after, y_before: y, y });
        if go_on.is_break() { go_on } else { event }
    }

    fn event(&mut self, event: &Event<'_, Blind<'a, P>>) -> ControlFlow<()> {
        let Event { t, guard, y_before, y, .. } = *event;
        let before = self.mode.clone();
        self.record.event(&Event { t, guard, before, after: Next::Stop, y_before, y })
    }

    fn grazing(&mut self, grazing: &Grazing<OfState>) {
        let Grazing { t, guard, depth, error, is_event, .. } = *grazing;
        let mode = self.mode.clone();
        self.record.grazing(&Grazing { t, mode, guard, depth, error, is_event });
    }

    fn rejected(&mut self, stats: &Stats) -> ControlFlow<()> {
        self.record.rejected(stats)
    }

    fn needs(&self, t0: f64, t1: f64) -> Needs {
        self.record.needs(t0, t1).max(Needs::Ends)
    }
}

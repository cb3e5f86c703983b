//! What a run shows its recorder, kept as plain values; and the settings every rule is tried with.

use std::ops::ControlFlow;

use deltazero_solvers::{
    Accepted, Control, Error, Event, Integration, METHODS, Method, Needs, Next, Outcome, Record,
    Stats, System, Tolerance,
};

use crate::script::chain;

/// What rounding may do to times and states of constant slope: diffsol's methods add up hundreds of
/// steps to 2.5e-14.
pub(crate) const ROUNDING: f64 = 2e-13;

/// A method, and a control that it takes.
pub(crate) type Setting = (&'static Method, Control);

/// Every method, with a fixed step where it takes one and with a tolerance where it takes one.
pub(crate) fn settings() -> Vec<Setting> {
    settings_with(0.25)
}

/// The same, with fixed steps of `h`.
pub(crate) fn settings_with(h: f64) -> Vec<Setting> {
    let mut settings = Vec::new();
    for method in METHODS {
        let adaptive = Control::Adaptive(Tolerance { rtol: 1e-8, atol: vec![1e-8; 2] });
        for control in [Control::Fixed(h), adaptive] {
            if method.solver(&chain(&[]), control.clone()).is_ok() {
                settings.push((method, control));
            }
        }
    }
    settings
}

/// All that a recorder is shown, as plain values.
pub(crate) struct Log<M> {
    /// Start, end and guard of each step.
    pub(crate) steps: Vec<(f64, f64, Option<usize>)>,
    /// Time, guard, mode before, what follows, and the number of steps seen by then.
    pub(crate) events: Vec<(f64, usize, M, Next<M>, usize)>,
    /// Ends of the steps that were not shown, and evaluations of the right-hand side by then.
    pub(crate) passed: Vec<(f64, u64)>,
    /// States and slopes at the ends of each, and the state amid it where that was needed.
    pub(crate) states: Vec<Vec<f64>>,
    /// Breaks at the step, shown or not, and at the event of this number.
    pub(crate) break_at: (usize, usize),
    /// What it needs of a step from this time.
    pub(crate) needs: fn(f64) -> Needs,
}

impl<M> Default for Log<M> {
    fn default() -> Self {
        let break_at = (usize::MAX, usize::MAX);
        let (steps, states, events) = (Vec::new(), Vec::new(), Vec::new());
        let passed = Vec::new();
        Self { steps, states, events, passed, break_at, needs: |_| Needs::DenseOutput }
    }
}

impl<M> Log<M> {
    pub(crate) fn times(&self) -> Vec<f64> {
        self.events.iter().map(|event| event.0).collect()
    }

    pub(crate) fn guards(&self) -> Vec<usize> {
        self.events.iter().map(|event| event.1).collect()
    }

    /// Whether to go on after a step.
    fn goes_on(&self) -> ControlFlow<()> {
        flow(self.steps.len() + self.passed.len() != self.break_at.0)
    }
}

pub(crate) fn flow(go_on: bool) -> ControlFlow<()> {
    if go_on { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
}

impl<P: System> Record<P> for Log<P::Mode> {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        let step = accepted.step;
        self.steps.push((step.t0(), step.t1(), accepted.landed_on));
        let mut amid = step.y1().clone();
        if (self.needs)(step.t0()) == Needs::DenseOutput {
            step.interpolate(0.5 * (step.t0() + step.t1()), &mut amid);
        }
        let ends = [step.y0(), step.y1(), step.slope0(), step.slope1()];
        self.states
            .push(ends.into_iter().chain([&amid]).flat_map(|y| y.as_ref()).copied().collect());
        self.goes_on()
    }

    fn passed(&mut self, t: f64, stats: &Stats) -> ControlFlow<()> {
        self.passed.push((t, stats.work.n_rhs));
        self.goes_on()
    }

    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        let (guard, before) = (event.guard, event.before.clone());
        let n = self.steps.len();
        self.events.push((event.t, guard, before, event.after.clone(), n));
        flow(self.events.len() != self.break_at.1)
    }

    fn needs(&self, t0: f64, _t1: f64) -> Needs {
        (self.needs)(t0)
    }
}

/// What was seen of a run, how it ended, and where.
pub(crate) type Ran<P> =
    (Log<<P as System>::Mode>, Result<Outcome, Error>, f64, <P as System>::State<f64>);

/// A run of `problem` from `(t0, y0)`.
pub(crate) fn run<P: System>(
    problem: &P,
    (method, control): &Setting,
    (t0, y0): (f64, P::State<f64>),
    t_end: f64,
) -> Ran<P> {
    let mut log = Log::default();
    let mut integration = Integration::new(problem, t0, y0);
    let Ok(mut solver) = method.solver(problem, control.clone()) else {
        panic!("{} does not take {control:?}", method.name);
    };
    let outcome = integration.run(t_end, &mut *solver, &mut log);
    let n = log.events.len() as u64;
    assert_eq!(integration.stats.n_events, n, "{}", method.name);
    (log, outcome, integration.point.t, integration.point.y)
}

/// The recorders of the runs of a batch.
pub(crate) fn as_records<P: System, R: Record<P>>(own: &mut [R]) -> Vec<&mut dyn Record<P>> {
    own.iter_mut().map(|own| own as &mut dyn Record<P>).collect()
}

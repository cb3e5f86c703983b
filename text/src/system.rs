//! The compiled model as a [`System`].

use std::marker::PhantomData;
use std::sync::Arc;

use deltazero_solvers::rounding::guard_bounds;
use deltazero_solvers::{Next, Real, System, Vector};
use deltazero_study::problem::Quantity;
use num_dual::Dual64;

use crate::declarations::ModeRole;
use crate::jacobian::Jacobian;
use crate::layout::MOST_HELD;
use crate::mode::Mode;
use crate::program::Program;
use crate::report::{Source, Span};
use crate::sparsity::{Column, Sparsity};
use crate::tape::Inputs;
use crate::vector::{Any, Family, Few};

/// A state below this part of its scale is taken for zero, so that bounces do not shrink for ever.
const LEAST: f64 = 1e-14;

/// A model from a file, compiled with the values of its parameters; one part of it where the file has parts.
#[derive(Clone, Debug)]
pub struct TextModel<F: Family = Any>(pub(crate) Arc<Model>, PhantomData<F>);

/// What a compiled model is.
#[derive(Debug)]
pub(crate) struct Model {
    pub(crate) source: Source,
    pub(crate) part: String,
    /// Its number, from one, where the file has parts.
    pub(crate) part_number: Option<usize>,
    pub(crate) states: Vec<Quantity>,
    pub(crate) starts: Vec<f64>,
    pub(crate) scales: Vec<f64>,
    /// The group of each state that is in one.
    pub(crate) groups: Vec<Option<String>>,
    pub(crate) observables: Vec<Quantity>,
    pub(crate) sparsity: Sparsity,
    /// No guard depends on two states whose indices differ by a multiple of it.
    pub(crate) guard_span: usize,
    /// In what its time is counted [s].
    pub(crate) unit_of_time: f64,
    /// Whether no rate is of the time itself.
    pub(crate) is_autonomous: bool,
    /// Whether friction may give energy.
    pub(crate) friction_gives: bool,
    /// Starts of the discrete values.
    pub(crate) discrete: Vec<f64>,
    pub(crate) n_guards: usize,
    pub(crate) first_mode: usize,
    pub(crate) modes: Vec<CompiledMode>,
}

/// A mode, compiled.
#[derive(Debug)]
pub(crate) struct CompiledMode {
    pub(crate) name: &'static str,
    pub(crate) role: ModeRole,
    /// Rates, then guards.
    pub(crate) program: Program,
    /// Guards alone.
    pub(crate) guards: Program,
    /// What the rates depend on, if it has formulas.
    pub(crate) jacobian: Option<Jacobian>,
    /// Values that are kept on entry.
    pub(crate) keep: Program,
    /// What follows each guard.
    pub(crate) transitions: Vec<Transition>,
    pub(crate) told: Told,
}

/// What is told of a mode: each tape has no results where the file says nothing.
#[derive(Debug)]
pub(crate) struct Told {
    /// Depth, its rate, force.
    pub(crate) touch: Program,
    /// Kinetic, elastic.
    pub(crate) energy: Program,
    /// Of the drive, of damping, of friction.
    pub(crate) power: Program,
    pub(crate) observables: Program,
}

/// What follows an event.
#[derive(Debug)]
pub(crate) struct Transition {
    /// Where its condition is written.
    pub(crate) at: Span,
    pub(crate) next: Setting,
    /// What follows where such events accumulate.
    pub(crate) rest: Option<Setting>,
}

/// Values that are set, all at once, and where this leads.
#[derive(Debug)]
pub(crate) struct Setting {
    pub(crate) program: Program,
    pub(crate) targets: Vec<Target>,
    pub(crate) goal: Goal,
}

/// What is given a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    State(usize),
    Held(usize),
}

impl Transition {
    /// What the event sets, and what its rest does.
    pub(crate) fn settings(&self) -> impl Iterator<Item = &Setting> {
        std::iter::once(&self.next).chain(&self.rest)
    }
}

impl Setting {
    /// The number of the mode that follows the mode `before`; that of no mode where the run stops.
    pub(crate) fn leads_to(&self, before: usize) -> usize {
        match self.goal {
            Goal::Enter(mode) => mode,
            Goal::Stay => before,
            Goal::Stop => usize::MAX,
        }
    }

    pub(crate) fn sets_states(&self) -> bool {
        self.targets.iter().any(|target| matches!(target, Target::State(_)))
    }
}

/// Where an event leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Goal {
    Enter(usize),
    Stay,
    Stop,
}

impl Model {
    fn mode(&self, mode: &Mode) -> &CompiledMode {
        &self.modes[usize::from(mode.number)]
    }

    /// Enters a mode, which keeps what it keeps of this state.
    fn enter<S: Real>(&self, number: usize, from: Mode, t: S, y: &[S]) -> Mode {
        let mode = &self.modes[number];
        let mut held = from.held;
        let n = self.discrete.len();
        held[n..].fill(0.0);
        let n_kept = mode.keep.n_first();
        if n_kept > 0 {
            let mut kept = [S::cst(0.0); MOST_HELD];
            mode.keep.run(&Inputs { t, y, held: &held }, &mut kept[..n_kept]);
            for (held, kept) in held[n..].iter_mut().zip(&kept[..n_kept]) {
                *held = kept.value();
            }
        }
        Mode::new(number, mode.name, held, from.number)
    }

    /// Sets what is to be set, and returns what follows.
    fn set<S: Real>(&self, setting: &Setting, mut mode: Mode, t: S, y: &mut [S]) -> Next<Mode> {
        let mut values = vec![S::cst(0.0); setting.targets.len()];
        setting.program.run(&Inputs { t, y, held: &mode.held }, &mut values);
        for (target, value) in setting.targets.iter().zip(values) {
            match target {
                Target::State(i) => y[*i] = value,
                Target::Held(i) => mode.held[*i] = value.value(),
            }
        }
        match setting.goal {
            Goal::Stop => Next::Stop,
            Goal::Stay => {
                mode.before = mode.number;
                Next::Mode(mode)
            }
            Goal::Enter(number) => Next::Mode(self.enter(number, mode, t, y)),
        }
    }
}

impl<F: Family> System for TextModel<F> {
    type Mode = Mode;
    type State<S: Real> = F::State<S>;
    type Guards<S: Real> = Vec<S>;

    const IS_TRACED: bool = true;

    fn dim(&self) -> usize {
        self.0.starts.len()
    }

    fn n_guards(&self) -> usize {
        self.0.n_guards
    }

    fn initial_mode(&self, t: f64, y: &F::State<f64>) -> Mode {
        let (model, mut held) = (&self.0, [0.0; MOST_HELD]);
        held[..model.discrete.len()].copy_from_slice(&model.discrete);
        let none = Mode::new(model.first_mode, "", held, model.first_mode as u16);
        model.enter(model.first_mode, none, t, y.as_ref())
    }

    #[inline]
    fn rhs<S: Real>(&self, mode: Mode, t: S, y: &F::State<S>, dydt: &mut F::State<S>) {
        let inputs = Inputs { t, y: y.as_ref(), held: &mode.held };
        self.0.mode(&mode).program.run(&inputs, dydt.as_mut());
    }

    fn guards<S: Real>(&self, mode: Mode, t: S, y: &F::State<S>, g: &mut Vec<S>) {
        let guards = &self.0.mode(&mode).guards;
        let (own, unused) = g.split_at_mut(guards.n_first());
        guards.run(&Inputs { t, y: y.as_ref(), held: &mode.held }, own);
        unused.fill(S::cst(1.0));
    }

    fn rhs_with_guards<S: Real>(
        &self,
        mode: Mode,
        t: S,
        y: &F::State<S>,
        dydt: &mut F::State<S>,
        g: &mut Vec<S>,
    ) -> bool {
        let program = &self.0.mode(&mode).program;
        let (own, unused) = g.split_at_mut(program.n_second());
        let inputs = Inputs { t, y: y.as_ref(), held: &mode.held };
        program.run_both(&inputs, dydt.as_mut(), own);
        unused.fill(S::cst(1.0));
        true
    }

    fn guard_bounds(&self, mode: Mode, t: f64, y: &F::State<f64>, bounds: &mut Vec<f64>) {
        guard_bounds(self, mode, t, y, |i| LEAST * self.0.scales[i], bounds);
    }

    fn guard_span(&self) -> usize {
        self.0.guard_span
    }

    /// By its formulas; where there are none by dual numbers, all columns of a group at once.
    fn jacobian(
        &self,
        mode: Mode,
        t: f64,
        y: &F::State<f64>,
        mut entry: impl FnMut(usize, usize, f64),
    ) {
        if let Some(jacobian) = &self.0.mode(&mode).jacobian {
            return jacobian.tell(&Inputs { t, y: y.as_ref(), held: &mode.held }, entry);
        }
        let (y, t) = (y.as_ref(), Dual64::from_re(t));
        let mut seeded = F::State::<Dual64>::from_fn(y.len(), |i| Dual64::from_re(y[i]));
        let mut dydt = seeded.clone();
        match &self.0.sparsity {
            Sparsity::Known(groups) => {
                for group in groups {
                    group.iter().for_each(|column| seeded.as_mut()[column.column].eps = 1.0);
                    self.rhs(mode, t, &seeded, &mut dydt);
                    for Column { column, rows } in group {
                        seeded.as_mut()[*column].eps = 0.0;
                        for i in rows {
                            entry(*i as usize, *column, dydt.as_ref()[*i as usize].eps);
                        }
                    }
                }
            }
            Sparsity::Full => {
                for j in 0..y.len() {
                    seeded.as_mut()[j].eps = 1.0;
                    self.rhs(mode, t, &seeded, &mut dydt);
                    seeded.as_mut()[j].eps = 0.0;
                    dydt.as_ref().iter().enumerate().for_each(|(i, d)| entry(i, j, d.eps));
                }
            }
        }
    }

    fn time_derivative(&self, mode: Mode, t: f64, y: &F::State<f64>, dfdt: &mut F::State<f64>) {
        if self.0.is_autonomous {
            return dfdt.as_mut().fill(0.0);
        }
        let y = y.as_ref();
        let y = F::State::<Dual64>::from_fn(y.len(), |i| Dual64::from_re(y[i]));
        let mut dydt = y.clone();
        self.rhs(mode, Dual64::new(t, 1.0), &y, &mut dydt);
        for (dfdt, d) in dfdt.as_mut().iter_mut().zip(dydt.as_ref()) {
            *dfdt = d.eps;
        }
    }

    fn transition<S: Real>(
        &self,
        mode: Mode,
        guard: usize,
        t: S,
        y: &mut F::State<S>,
    ) -> Next<Mode> {
        match self.0.mode(&mode).transitions.get(guard) {
            Some(transition) => self.0.set(&transition.next, mode, t, y.as_mut()),
            None => Next::Mode(mode),
        }
    }

    /// What the event that fell says of its rest. That of another event is of another place.
    fn accumulation(
        &self,
        mode: Mode,
        guard: usize,
        t: f64,
        y: &mut F::State<f64>,
    ) -> Option<Mode> {
        let before = &self.0.modes[usize::from(mode.before)].transitions;
        let rest = before.get(guard)?.rest.as_ref()?;
        match self.0.set(rest, mode, t, y.as_mut()) {
            Next::Mode(mode) => Some(mode),
            Next::Stop => None,
        }
    }
}

impl TextModel {
    /// The same model with its states in an array, if it has `N` states.
    pub fn few<const N: usize>(&self) -> Option<TextModel<Few<N>>> {
        (self.dim() == N && N > 0).then(|| TextModel(self.0.clone(), PhantomData))
    }
}

impl<F: Family> TextModel<F> {
    pub(crate) fn new(model: Model) -> Self {
        Self(Arc::new(model), PhantomData)
    }

    /// The name of the part; empty where the file has none.
    pub fn part(&self) -> &str {
        &self.0.part
    }

    /// The name of a mode of this model.
    pub fn name_of(&self, mode: Mode) -> &str {
        self.0.mode(&mode).name
    }
}

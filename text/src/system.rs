//! The compiled model as a [`System`].

use std::sync::Arc;

use deltazero_solvers::{Next, Real, System};
use deltazero_study::problem::Quantity;

use crate::bounds::guard_bounds;
use crate::compile::Target;
use crate::declarations::ModeRole;
use crate::evaluate::Inputs;
use crate::layout::MOST_HELD;
use crate::mode::Mode;
use crate::tape::Tape;
use crate::vector::Numbers;

/// A model from a file, compiled with the values of its parameters; one part of it where the file has parts.
#[derive(Clone, Debug)]
pub struct TextModel(pub(crate) Arc<Model>);

/// What a compiled model is.
#[derive(Debug)]
pub(crate) struct Model {
    pub(crate) part: String,
    pub(crate) states: Vec<Quantity>,
    pub(crate) starts: Vec<f64>,
    pub(crate) scales: Vec<f64>,
    /// Starts of the discrete values.
    pub(crate) discrete: Vec<f64>,
    pub(crate) n_guards: usize,
    pub(crate) first_mode: usize,
    pub(crate) modes: Vec<CompiledMode>,
}

/// A mode, compiled.
#[derive(Debug)]
pub(crate) struct CompiledMode {
    pub(crate) name: String,
    pub(crate) role: ModeRole,
    /// Rates, then guards.
    pub(crate) tape: Tape,
    /// Guards alone.
    pub(crate) guards: Tape,
    /// Values that are kept on entry.
    pub(crate) keep: Tape,
    /// What follows each guard.
    pub(crate) transitions: Vec<Transition>,
}

/// What follows an event.
#[derive(Debug)]
pub(crate) struct Transition {
    pub(crate) name: Option<String>,
    pub(crate) next: Setting,
    /// What follows where such events accumulate.
    pub(crate) rest: Option<Setting>,
}

/// Values that are set, all at once, and where this leads.
#[derive(Debug)]
pub(crate) struct Setting {
    pub(crate) tape: Tape,
    pub(crate) targets: Vec<Target>,
    pub(crate) goal: Goal,
}

/// Where an event leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Goal {
    Enter(usize),
    Stay,
    Stop,
}

impl Model {
    fn mode(&self, mode: Mode) -> &CompiledMode {
        &self.modes[usize::from(mode.number)]
    }

    /// Enters a mode, which keeps what it keeps of this state.
    fn enter<S: Real>(&self, number: usize, from: Mode, t: S, y: &[S]) -> Mode {
        let mode = &self.modes[number];
        let mut held = from.held;
        let n = self.discrete.len();
        held[n..].fill(0.0);
        let n_kept = mode.keep.first_outputs.len();
        if n_kept > 0 {
            let mut kept = [S::cst(0.0); MOST_HELD];
            mode.keep.run(&Inputs { t, y, held: &held }, &mut kept[..n_kept]);
            for (held, kept) in held[n..].iter_mut().zip(&kept[..n_kept]) {
                *held = kept.value();
            }
        }
        Mode::new(number, &mode.name, held, from.number)
    }

    /// Sets what is to be set, and returns what follows.
    fn set<S: Real>(&self, setting: &Setting, mut mode: Mode, t: S, y: &mut [S]) -> Next<Mode> {
        let mut values = vec![S::cst(0.0); setting.targets.len()];
        setting.tape.run(&Inputs { t, y, held: &mode.held }, &mut values);
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

impl System for TextModel {
    type Mode = Mode;
    type State<S: Real> = Numbers<S>;
    type Guards<S: Real> = Numbers<S>;

    fn dim(&self) -> usize {
        self.0.starts.len()
    }

    fn n_guards(&self) -> usize {
        self.0.n_guards
    }

    fn initial_mode(&self, t: f64, y: &Numbers<f64>) -> Mode {
        let (model, mut held) = (&self.0, [0.0; MOST_HELD]);
        held[..model.discrete.len()].copy_from_slice(&model.discrete);
        let none = Mode::new(model.first_mode, "", held, model.first_mode as u16);
        model.enter(model.first_mode, none, t, y.as_ref())
    }

    #[inline]
    fn rhs<S: Real>(&self, mode: Mode, t: S, y: &Numbers<S>, dydt: &mut Numbers<S>) {
        let inputs = Inputs { t, y: y.as_ref(), held: &mode.held };
        self.0.mode(mode).tape.run(&inputs, dydt.as_mut());
    }

    fn guards<S: Real>(&self, mode: Mode, t: S, y: &Numbers<S>, g: &mut Numbers<S>) {
        let tape = &self.0.mode(mode).guards;
        let (own, unused) = g.as_mut().split_at_mut(tape.first_outputs.len());
        tape.run(&Inputs { t, y: y.as_ref(), held: &mode.held }, own);
        unused.fill(S::cst(1.0));
    }

    fn rhs_with_guards<S: Real>(
        &self,
        mode: Mode,
        t: S,
        y: &Numbers<S>,
        dydt: &mut Numbers<S>,
        g: &mut Numbers<S>,
    ) {
        let tape = &self.0.mode(mode).tape;
        let (own, unused) = g.as_mut().split_at_mut(tape.second_outputs.len());
        let inputs = Inputs { t, y: y.as_ref(), held: &mode.held };
        tape.run_both(&inputs, dydt.as_mut(), own);
        unused.fill(S::cst(1.0));
    }

    fn guard_bounds(&self, mode: Mode, t: f64, y: &Numbers<f64>, bounds: &mut Numbers<f64>) {
        guard_bounds(&self.0, mode, t, y.as_ref(), bounds.as_mut());
    }

    fn transition<S: Real>(
        &self,
        mode: Mode,
        guard: usize,
        t: S,
        y: &mut Numbers<S>,
    ) -> Next<Mode> {
        match self.0.mode(mode).transitions.get(guard) {
            Some(transition) => self.0.set(&transition.next, mode, t, y.as_mut()),
            None => Next::Mode(mode),
        }
    }

    /// What the event itself says of its rest, or else the first event of the present mode that says something.
    fn accumulation(&self, mode: Mode, guard: usize, t: f64, y: &mut Numbers<f64>) -> Option<Mode> {
        let before = &self.0.modes[usize::from(mode.before)].transitions;
        let own = before.get(guard).and_then(|transition| transition.rest.as_ref());
        let mut others = self.0.mode(mode).transitions.iter();
        let rest = own.or_else(|| others.find_map(|transition| transition.rest.as_ref()))?;
        match self.0.set(rest, mode, t, y.as_mut()) {
            Next::Mode(mode) => Some(mode),
            Next::Stop => None,
        }
    }
}

impl TextModel {
    /// The name of the part; empty where the file has none.
    pub fn part(&self) -> &str {
        &self.0.part
    }

    /// The name of a mode of this model.
    pub fn name_of(&self, mode: Mode) -> &str {
        &self.0.mode(mode).name
    }

    /// The name of an event, by the mode that it ends and the number of its guard.
    pub fn event_name(&self, mode: Mode, guard: usize) -> Option<&str> {
        self.0.mode(mode).transitions.get(guard)?.name.as_deref()
    }
}

//! The compiled model as a [`Problem`].

use std::borrow::Cow;

use deltazero_solvers::{Error, Real, Record, System, Vector};
use deltazero_study::nudge::{Moment, setting_out};
use deltazero_study::problem::{
    EndName, Energy, Group, GroupScale, Laws, Power, Problem, Quantity, Role, Touch,
};
use deltazero_study::run::{OwnRun, extended};
use num_dual::Dual64;

use crate::compile::role;
use crate::mode::Mode;
use crate::program::Program;
use crate::report::Complaint;
use crate::system::{TextModel, Told};
use crate::tape::Inputs;
use crate::vector::Family;

impl<F: Family> TextModel<F> {
    fn told(&self, mode: &Mode) -> &Told {
        &self.0.modes[usize::from(mode.number)].told
    }
}

/// `N` results of a program; none where it has none.
fn results<S: Real, const N: usize>(
    program: &Program,
    mode: &Mode,
    t: S,
    y: &[S],
) -> Option<[S; N]> {
    let mut all = [S::cst(0.0); N];
    program.run(&Inputs { t, y, held: &mode.held }, &mut all);
    (program.n_first() == N).then_some(all)
}

impl<F: Family> Problem for TextModel<F> {
    fn start(&self) -> F::State<f64> {
        F::State::<f64>::from_fn(self.0.starts.len(), |i| self.0.starts[i])
    }

    fn states(&self) -> Vec<Quantity> {
        self.0.states.clone()
    }

    /// States of one group are one vector; each of the others is a group of its own.
    fn groups(&self) -> Vec<Group> {
        let mut groups: Vec<Group> = Vec::new();
        for (i, (state, name)) in self.0.states.iter().zip(&self.0.groups).enumerate() {
            let own =
                name.as_ref().and_then(|name| groups.iter_mut().find(|group| group.name == *name));
            match own {
                Some(group) => group.states.push(i),
                None => groups.push(Group {
                    name: name.as_ref().map_or(state.name.clone(), |name| Cow::Owned(name.clone())),
                    unit: state.unit.clone(),
                    states: vec![i],
                    scale: GroupScale::Largest,
                    site: 0,
                }),
            }
        }
        groups
    }

    fn name(&self) -> String {
        self.0.part.clone()
    }

    /// The number of the part, where the file has several.
    fn labels(&self, _site: usize) -> Vec<(&'static str, usize)> {
        self.0.part_number.map(|number| ("part", number)).into_iter().collect()
    }

    fn role(&self, mode: &Mode, _site: usize) -> Role {
        role(self.0.modes[usize::from(mode.number)].role)
    }

    fn mode_number(&self, mode: &Mode) -> u16 {
        mode.number
    }

    fn named_modes(&self) -> Vec<String> {
        self.0.modes.iter().map(|mode| mode.name.to_owned()).collect()
    }

    /// The span of a run where it is shorter than a second.
    fn unit_of_time(&self) -> f64 {
        self.0.unit_of_time
    }

    /// Whether a guard is zero at the start and falls from there: at once, or where it has no rate a moment later.
    fn starts_on_surface(&self) -> bool {
        let mode = self.initial_mode(0.0, &self.start());
        let moments = setting_out(self, &mode);
        let [now, then] = moments.each_ref().map(|Moment { t, y, slope }| {
            let (y, f) = (y.as_ref(), slope.as_ref());
            let moving = F::State::<Dual64>::from_fn(y.len(), |i| Dual64::new(y[i], f[i]));
            let mut g = vec![Dual64::from_re(0.0); self.n_guards()];
            self.guards(mode, Dual64::new(*t, 1.0), &moving, &mut g);
            g
        });
        let mut bounds = vec![0.0; now.len()];
        self.guard_bounds(mode, 0.0, &moments[0].y, &mut bounds);
        now.iter().zip(&then).zip(&bounds).any(|((now, then), bound)| {
            let falls = now.eps < 0.0 || now.eps == 0.0 && then.eps < 0.0;
            now.re.abs() <= *bound && falls
        })
    }

    /// Where the file has a table `contact`.
    fn tells_forces(&self) -> bool {
        self.0.modes.iter().any(|mode| mode.told.touch.n_first() > 0)
    }

    fn touch<S: Real>(&self, mode: &Mode, t: S, y: &F::State<S>, _site: usize) -> Option<Touch<S>> {
        let [depth, rate, force] = results(&self.told(mode).touch, mode, t, y.as_ref())?;
        Some(Touch { depth, rate, force })
    }

    fn energies(&self, mode: &Mode, t: f64, y: &F::State<f64>) -> Option<Energy> {
        let [kinetic, elastic] = results(&self.told(mode).energy, mode, t, y.as_ref())?;
        Some(Energy { kinetic, elastic })
    }

    fn powers(&self, mode: &Mode, t: f64, y: &F::State<f64>) -> Option<Power> {
        self.energies(mode, t, y)?;
        let [drive, damping, friction] = results(&self.told(mode).power, mode, t, y.as_ref())?;
        Some(Power { drive, damping, friction })
    }

    /// Whether an event between these modes sets a state, or begins or ends a contact, which may then be dented.
    fn takes_energy(&self, before: &Mode, after: &Mode) -> bool {
        let [was_contact, is_contact] = [before, after].map(|mode| self.role(mode, 0).is_contact());
        if was_contact != is_contact {
            return true;
        }
        let transitions = &self.0.modes[usize::from(before.number)].transitions;
        transitions.iter().flat_map(|transition| transition.settings()).any(|setting| {
            setting.leads_to(usize::from(before.number)) == usize::from(after.number)
                && setting.sets_states()
        })
    }

    fn mode_name(&self, mode: &Mode, _site: usize) -> String {
        self.name_of(*mode).to_owned()
    }

    fn columns(&self, _site: usize) -> Vec<Quantity> {
        self.0.states.iter().chain(&self.0.observables).cloned().collect()
    }

    fn rows(&self, mode: &Mode, t: f64, y: &F::State<f64>, row: &mut dyn FnMut(usize, &[f64])) {
        let n = y.as_ref().len();
        let mut all = vec![0.0; n + self.0.observables.len()];
        let (states, observables) = all.split_at_mut(n);
        states.copy_from_slice(y.as_ref());
        let inputs = Inputs { t, y: y.as_ref(), held: &mode.held };
        self.told(mode).observables.run(&inputs, observables);
        row(0, &all);
    }

    /// The line of the file where a guard that failed is written.
    fn place_of(&self, error: &Error) -> Option<String> {
        let (Error::NonFiniteGuard { mode, guard, .. }
        | Error::BadGuardBound { mode, guard, .. }
        | Error::UnresolvedGuard { mode, guard, .. }
        | Error::Chatter { mode, guard, .. }) = error
        else {
            return None;
        };
        let mode = self.0.modes.iter().find(|own| own.name == mode)?;
        let complaint = Complaint::new(
            mode.transitions.get(*guard)?.at,
            format!("guard {guard} of the mode `{}`", mode.name),
        );
        Some(self.0.source.note(complaint).to_string())
    }

    fn end_name(&self) -> EndName {
        EndName { key: "stopped", words: "stopped" }
    }

    /// Energy balances where it is given; damping takes it, and so does friction unless the file says otherwise.
    fn laws(&self) -> Laws {
        let is_given = self.0.modes.iter().any(|mode| mode.told.energy.n_first() > 0);
        Laws {
            balances: is_given,
            damping_takes: is_given,
            friction_takes: is_given && !self.0.friction_gives,
            deepest: None,
        }
    }

    fn integrate_extended(
        &self,
        rtol: f64,
        y0: F::State<f64>,
        t_end: f64,
        record: &mut dyn Record<Self>,
    ) -> OwnRun<Self> {
        extended(self, rtol, y0, t_end, record)
    }
}

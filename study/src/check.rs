//! Whether what a problem says of itself fits together: before anything runs, and in the runs of its reference.

mod error;

use std::fmt::Debug;
use std::ops::ControlFlow;

use deltazero_solvers::contracts::Checked;
use deltazero_solvers::{Event, Needs, Next, Record};
pub use error::ProblemError;

use crate::problem::{GroupScale, Problem};

/// See [`Part::check`](crate::Part::check).
pub(crate) fn check<P: Problem>(problem: &P) -> Result<(), ProblemError> {
    let y = problem.start();
    check_states(problem, y.as_ref())?;
    check_groups(problem)?;
    let mode = problem.initial_mode(0.0, &y);
    check_sites(problem, &mode)?;
    check_columns(problem, &mode, &y)?;
    check_forces(problem, &mode, &y)?;
    check_energies(problem, &mode, &y)
}

/// The modes that a run enters, each with what the problem says in it.
pub(crate) struct Entered<'a, P> {
    problem: &'a P,
    /// The first mode in which it does not fit together.
    pub(crate) refused: Option<ProblemError>,
}

impl<'a, P: Problem> Entered<'a, P> {
    /// No mode yet but that of the start, which is [checked](check) before.
    pub(crate) fn new(problem: &'a P) -> Self {
        Self { problem, refused: None }
    }
}

impl<P: Problem> Record<P> for Entered<'_, P> {
    fn event(&mut self, event: &Event<'_, P>) -> ControlFlow<()> {
        let Next::Mode(mode) = &event.after else { return ControlFlow::Continue(()) };
        let said = check_sites(self.problem, mode)
            .and_then(|()| rows(self.problem, mode, event.t, event.y).map(|_| ()));
        match said {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                let (t, mode, error) = (event.t, format!("{mode:?}"), Box::new(error));
                self.refused = Some(ProblemError::InMode { t, mode, error });
                ControlFlow::Break(())
            }
        }
    }

    fn needs(&self, _t0: f64, _t1: f64) -> Needs {
        Needs::Nothing
    }
}

/// Whether a run can end at `t_end` [s].
pub(crate) fn check_end(t_end: f64) -> Result<(), ProblemError> {
    if t_end > 0.0 && t_end.is_finite() { Ok(()) } else { Err(ProblemError::End { t_end }) }
}

fn check_states<P: Problem>(problem: &P, y: &[f64]) -> Result<(), ProblemError> {
    let (dim, states) = (problem.dim(), problem.states());
    if dim == 0 {
        return Err(ProblemError::NoStates);
    }
    if states.len() != dim {
        return Err(ProblemError::StatesDiffer { named: states.len(), dim });
    }
    if y.len() != dim {
        return Err(ProblemError::StartDiffers { given: y.len(), dim });
    }
    for (state, y) in states.iter().zip(y) {
        let item = format!("state {}", state.name);
        if !is_scale(state.scale) {
            return Err(ProblemError::Scale { item, scale: state.scale });
        }
        finite(item, *y)?;
    }
    Ok(())
}

fn check_groups<P: Problem>(problem: &P) -> Result<(), ProblemError> {
    let (dim, n_sites, groups) = (problem.dim(), problem.n_sites(), problem.groups());
    if groups.is_empty() {
        return Err(ProblemError::NoGroups);
    }
    for group in groups {
        let name = format!("group {}", group.name);
        if group.states.is_empty() || group.states.iter().any(|i| *i >= dim) {
            return Err(ProblemError::Group { group: name, states: group.states, dim });
        }
        if group.site >= n_sites {
            return Err(ProblemError::Site { item: name, site: group.site, n_sites });
        }
        if let GroupScale::Fixed(scale) = group.scale
            && !is_scale(scale)
        {
            return Err(ProblemError::Scale { item: name, scale });
        }
    }
    Ok(())
}

fn check_sites<P: Problem>(problem: &P, mode: &P::Mode) -> Result<(), ProblemError> {
    let n_sites = problem.n_sites();
    for guard in 0..problem.n_guards() {
        let site = problem.site_of_guard(mode, guard);
        if site >= n_sites {
            return Err(ProblemError::Site { item: format!("guard {guard}"), site, n_sites });
        }
    }
    Ok(())
}

/// The values of each site as a table of the motion has them, one for each column.
fn rows<P: Problem>(
    problem: &P,
    mode: &P::Mode,
    t: f64,
    y: &P::State<f64>,
) -> Result<Vec<Vec<f64>>, ProblemError> {
    let n_sites = problem.n_sites();
    let (mut rows, mut beyond) = (vec![Vec::new(); n_sites], None);
    problem.rows(mode, t, y, &mut |site, values| match rows.get_mut(site) {
        Some(row) => row.extend_from_slice(values),
        None => beyond = Some(site),
    });
    if let Some(site) = beyond {
        return Err(ProblemError::Site { item: "a row".to_owned(), site, n_sites });
    }
    for (site, row) in rows.iter().enumerate() {
        let (named, given) = (problem.columns(site).len(), row.len());
        if named != given {
            return Err(ProblemError::ColumnsDiffer { site, named, given });
        }
    }
    Ok(rows)
}

/// States and observables at the start: finite numbers.
fn check_columns<P: Problem>(
    problem: &P,
    mode: &P::Mode,
    y: &P::State<f64>,
) -> Result<(), ProblemError> {
    for (site, row) in rows(problem, mode, 0.0, y)?.iter().enumerate() {
        for (column, value) in problem.columns(site).iter().zip(row) {
            finite(format!("column {} of site {site}", column.name), *value)?;
        }
    }
    Ok(())
}

fn check_forces<P: Problem>(
    problem: &P,
    mode: &P::Mode,
    y: &P::State<f64>,
) -> Result<(), ProblemError> {
    let touches: Vec<_> =
        (0..problem.n_sites()).map(|site| problem.touch(mode, 0.0, y, site)).collect();
    let told = touches.iter().position(Option::is_some);
    for (site, touch) in touches.iter().enumerate() {
        match touch {
            Some(touch) => {
                finite(format!("the penetration at site {site}"), touch.depth)?;
                finite(format!("the contact force at site {site}"), touch.force)?;
            }
            None => check_untold(problem, (0.0, mode), site, told)?,
        }
    }
    Ok(())
}

/// Whether [`Problem::touch`] may give no force at `site` in a mode, met at a time, where it gives one at the site `told` or
/// at none.
pub(crate) fn check_untold<P: Problem>(
    problem: &P,
    met: (f64, &P::Mode),
    site: usize,
    told: Option<usize>,
) -> Result<(), ProblemError> {
    if problem.tells_forces() && problem.role(met.1, site).is_contact() {
        return Err(no_force(met, site));
    }
    told.map_or(Ok(()), |told| Err(force_in_part(met, told, site)))
}

/// [`ProblemError::Contract`] of a problem that was checked along a run.
///
/// # Errors
/// The first breach that was found.
pub(crate) fn check_contracts<P: Problem>(checked: &Checked<'_, P>) -> Result<(), ProblemError> {
    checked.breach().map_or(Ok(()), |(t, mode, breach)| {
        let (t, mode, breach) = (*t, format!("{mode:?}"), Box::new(breach.clone()));
        Err(ProblemError::Contract { t, mode, breach })
    })
}

/// [`ProblemError::NoForce`] of a mode met at a time.
pub(crate) fn no_force((t, mode): (f64, &impl Debug), site: usize) -> ProblemError {
    ProblemError::NoForce { t, mode: format!("{mode:?}"), site }
}

/// [`ProblemError::ForceInPart`] of a mode met at a time.
pub(crate) fn force_in_part(
    (t, mode): (f64, &impl Debug),
    site: usize,
    silent: usize,
) -> ProblemError {
    ProblemError::ForceInPart { t, mode: format!("{mode:?}"), site, silent }
}

fn check_energies<P: Problem>(
    problem: &P,
    mode: &P::Mode,
    y: &P::State<f64>,
) -> Result<(), ProblemError> {
    let Some(energy) = problem.energies(mode, 0.0, y) else { return Ok(()) };
    finite("the energy", energy.kinetic + energy.elastic)?;
    let power = problem.powers(mode, 0.0, y).ok_or(ProblemError::NoPowers)?;
    finite("the power of the drive", power.drive)?;
    finite("the dissipated power", power.dissipated())
}

fn is_scale(scale: f64) -> bool {
    scale > 0.0 && scale.is_finite()
}

fn finite(item: impl Into<String>, value: f64) -> Result<(), ProblemError> {
    let item = item.into();
    if value.is_finite() { Ok(()) } else { Err(ProblemError::NotFinite { item, value }) }
}

#[cfg(test)]
mod tests {
    use std::borrow::Cow;

    use deltazero_solvers::{Next, Real, System};

    use super::*;
    use crate::problem::{Energy, Group, Power, Quantity, Role, Touch};

    /// `ẏ = −y` that says of itself what it is told to.
    #[derive(Clone)]
    struct Told {
        dim: usize,
        start: Vec<f64>,
        states: Vec<Quantity>,
        group: Option<Group>,
        /// Values of its one column, of each site.
        rows: Vec<Vec<f64>>,
        role: Role,
        /// Contact force, of each site.
        forces: Vec<Option<f64>>,
        energy: Option<f64>,
        power: Option<f64>,
    }

    impl System for Told {
        type Mode = ();
        type State<S: Real> = Vec<S>;
        type Guards<S: Real> = [S; 0];

        fn dim(&self) -> usize {
            self.dim
        }

        fn initial_mode(&self, _: f64, _: &Vec<f64>) {}

        fn rhs<S: Real>(&self, (): (), _: S, y: &Vec<S>, dydt: &mut Vec<S>) {
            dydt.iter_mut().zip(y).for_each(|(dydt, y)| *dydt = -*y);
        }

        fn guards<S: Real>(&self, (): (), _: S, _: &Vec<S>, _: &mut [S; 0]) {}

        fn guard_bounds(&self, (): (), _: f64, _: &Vec<f64>, _: &mut [f64; 0]) {}

        fn transition<S: Real>(&self, (): (), _: usize, _: S, _: &mut Vec<S>) -> Next<()> {
            Next::Stop
        }
    }

    impl Problem for Told {
        fn start(&self) -> Vec<f64> {
            self.start.clone()
        }

        fn states(&self) -> Vec<Quantity> {
            self.states.clone()
        }

        fn groups(&self) -> Vec<Group> {
            self.group.iter().cloned().collect()
        }

        fn n_sites(&self) -> usize {
            self.forces.len()
        }

        fn role(&self, (): &(), _: usize) -> Role {
            self.role
        }

        fn touch<S: Real>(&self, (): &(), _: S, _: &Vec<S>, site: usize) -> Option<Touch<S>> {
            let [depth, rate] = [S::cst(0.0); 2];
            self.forces[site].map(|force| Touch { depth, rate, force: S::cst(force) })
        }

        fn energies(&self, (): &(), _: f64, _: &Vec<f64>) -> Option<Energy> {
            self.energy.map(|kinetic| Energy { kinetic, elastic: 0.0 })
        }

        fn powers(&self, (): &(), _: f64, _: &Vec<f64>) -> Option<Power> {
            self.power.map(|damping| Power { damping, ..Power::default() })
        }

        fn columns(&self, _: usize) -> Vec<Quantity> {
            vec![Quantity::new("f", "N", 1.0)]
        }

        fn rows(&self, (): &(), _: f64, _: &Vec<f64>, row: &mut dyn FnMut(usize, &[f64])) {
            self.rows.iter().enumerate().for_each(|(site, values)| row(site, values));
        }
    }

    fn told() -> Told {
        let group = Group {
            name: Cow::Borrowed("y"),
            unit: Cow::Borrowed("m"),
            states: vec![0],
            scale: GroupScale::Fixed(1.0),
            site: 0,
        };
        Told {
            dim: 1,
            start: vec![1.0],
            states: vec![Quantity::new("y", "m", 1.0)],
            group: Some(group),
            rows: vec![vec![1.0]],
            role: Role::Free,
            forces: vec![None],
            energy: None,
            power: None,
        }
    }

    fn assert_refused(problem: &Told, what: &str) {
        let message = check(problem).unwrap_err().to_string();
        assert!(message.contains(what), "{what}: {message}");
    }

    #[test]
    fn states_that_do_not_fit_together_are_refused() {
        let states = |scale| vec![Quantity::new("y", "m", scale)];
        assert_eq!(check(&told()), Ok(()));
        let none = Told { dim: 0, start: vec![], states: vec![], ..told() };
        for (problem, what) in [
            (none, "has no states"),
            (Told { states: vec![], ..told() }, "names 0 states and has 1"),
            (Told { start: vec![0.0; 2], ..told() }, "starts with 2 states and has 1"),
            (Told { states: states(0.0), ..told() }, "scale of state y is 0"),
            (Told { start: vec![0.0], states: states(0.0), ..told() }, "scale of state y is 0"),
            (Told { states: states(f64::NAN), ..told() }, "scale of state y is NaN"),
            (Told { start: vec![f64::INFINITY], ..told() }, "state y is inf at the start"),
        ] {
            assert_refused(&problem, what);
        }
    }

    #[test]
    fn groups_that_do_not_fit_the_states_are_refused() {
        let group = |change: fn(&mut Group)| {
            let mut told = told();
            told.group.iter_mut().for_each(change);
            told
        };
        for (problem, what) in [
            (Told { group: None, ..told() }, "no groups"),
            (group(|group| group.states = vec![1]), "group y has the states [1]"),
            (group(|group| group.scale = GroupScale::Fixed(-1.0)), "scale of group y is -1"),
            (group(|group| group.site = 3), "of site 3; the problem has 1"),
        ] {
            assert_refused(&problem, what);
        }
    }

    #[test]
    fn columns_that_their_heads_do_not_fit_or_that_are_no_number_are_refused() {
        let rows = |rows: &[&[f64]]| Told {
            rows: rows.iter().map(|values| values.to_vec()).collect(),
            ..told()
        };
        for (problem, what) in [
            (rows(&[&[1.0, 2.0]]), "site 0 has 1 columns by Problem::columns and 2 values"),
            (rows(&[]), "site 0 has 1 columns by Problem::columns and 0 values"),
            (rows(&[&[1.0], &[1.0]]), "a row is of site 1; the problem has 1"),
            (rows(&[&[f64::NAN]]), "column f of site 0 is NaN at the start"),
        ] {
            assert_refused(&problem, what);
        }
    }

    #[test]
    fn forces_and_energies_that_are_not_given_whole_are_refused() {
        let two = Told { rows: vec![vec![1.0]; 2], ..told() };
        let energy = |energy, power| Told { energy: Some(energy), power, ..told() };
        for (problem, what) in [
            (
                Told { role: Role::Contact, ..told() },
                "at site 0, but Problem::touch gives no force",
            ),
            (
                Told { forces: vec![None, Some(1.0)], ..two },
                "at site 1, and none at the start at site 0",
            ),
            (Told { forces: vec![Some(f64::NAN)], ..told() }, "contact force at site 0 is NaN"),
            (energy(1.0, None), "Problem::powers no powers"),
            (energy(f64::NAN, Some(0.0)), "the energy is NaN"),
            (energy(1.0, Some(f64::INFINITY)), "the dissipated power is inf"),
        ] {
            assert_refused(&problem, what);
        }
        assert_eq!(check(&energy(1.0, Some(0.0))), Ok(()));
        assert_eq!(check(&Told { role: Role::Contact, forces: vec![Some(1.0)], ..told() }), Ok(()));
    }

    #[test]
    fn an_end_that_is_not_after_the_start_is_refused() {
        assert_eq!(check_end(1e-9), Ok(()));
        for t_end in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let message = check_end(t_end).unwrap_err().to_string();
            assert!(message.contains(&format!("the end of the run is {t_end} s")), "{message}");
        }
    }
}

//! Whether what a problem says of itself fits together, before anything runs.

use crate::problem::{GroupScale, Problem};

/// Why a problem cannot be studied.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProblemError {
    /// It has no states.
    #[error("the problem has no states; System::dim is 0")]
    NoStates,
    /// It names more or fewer states than it has.
    #[error("the problem names {named} states and has {dim}; Problem::states must name each")]
    StatesDiffer {
        /// Names.
        named: usize,
        /// States.
        dim: usize,
    },
    /// A scale is zero, negative or not a number.
    #[error("the scale of {item} is {scale}; it must be above zero")]
    Scale {
        /// State or group.
        item: String,
        /// Its scale.
        scale: f64,
    },
    /// A group of states is empty, or has a state that does not exist.
    #[error("group {group} has the states {states:?}; the problem has {dim}, from 0")]
    Group {
        /// Its name.
        group: String,
        /// Its states.
        states: Vec<usize>,
        /// States of the problem.
        dim: usize,
    },
    /// No group, so that there is no error.
    #[error("the problem has no groups of states to measure errors by; see Problem::groups")]
    NoGroups,
    /// A site that does not exist.
    #[error("{item} is of site {site}; the problem has {n_sites}, from 0")]
    Site {
        /// Group or guard.
        item: String,
        /// Its site.
        site: usize,
        /// Sites of the problem.
        n_sites: usize,
    },
    /// A number at the start is none.
    #[error("{item} is {value} at the start")]
    NotFinite {
        /// State, force or energy.
        item: String,
        /// Its value.
        value: f64,
    },
    /// A mode is contact, and no force is given.
    #[error(
        "the start is a contact by Problem::role at site {site}, but Problem::touch gives no force there"
    )]
    NoForce {
        /// The site.
        site: usize,
    },
}

/// See [`Part::check`](crate::Part::check).
pub(crate) fn check<P: Problem>(problem: &P) -> Result<(), ProblemError> {
    let (dim, states) = (problem.dim(), problem.states());
    if dim == 0 {
        return Err(ProblemError::NoStates);
    }
    let (y, named) = (problem.start(), states.len());
    if named != dim || y.as_ref().len() != dim {
        return Err(ProblemError::StatesDiffer { named, dim });
    }
    for (state, y) in states.iter().zip(y.as_ref()) {
        let is_scale = state.scale > 0.0 && state.scale.is_finite();
        // A state that rests at zero, and stays there, may have no scale.
        if !is_scale && (state.scale != 0.0 || *y != 0.0) {
            let item = format!("state {}", state.name);
            return Err(ProblemError::Scale { item, scale: state.scale });
        }
        finite(&format!("state {}", state.name), *y)?;
    }
    groups(problem)?;
    start(problem, &y)
}

fn groups<P: Problem>(problem: &P) -> Result<(), ProblemError> {
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
            && !(scale > 0.0 && scale.is_finite())
        {
            return Err(ProblemError::Scale { item: name, scale });
        }
    }
    Ok(())
}

/// What is given of forces and energies where it starts.
fn start<P: Problem>(problem: &P, y: &P::State<f64>) -> Result<(), ProblemError> {
    let (mode, n_sites) = (problem.initial_mode(0.0, y), problem.n_sites());
    for guard in 0..problem.n_guards() {
        let site = problem.site_of_guard(&mode, guard);
        if site >= n_sites {
            return Err(ProblemError::Site { item: format!("guard {guard}"), site, n_sites });
        }
    }
    for site in 0..n_sites {
        match problem.touch(&mode, 0.0, y, site) {
            Some(touch) => {
                finite("the penetration", touch.depth)?;
                finite("the contact force", touch.force)?;
            }
            None if problem.tells_forces() && problem.role(&mode, site).is_contact() => {
                return Err(ProblemError::NoForce { site });
            }
            None => {}
        }
    }
    if let Some(energy) = problem.energies(&mode, 0.0, y) {
        finite("the energy", energy.kinetic + energy.elastic)?;
    }
    Ok(())
}

fn finite(item: &str, value: f64) -> Result<(), ProblemError> {
    let item = item.to_owned();
    if value.is_finite() { Ok(()) } else { Err(ProblemError::NotFinite { item, value }) }
}

#[cfg(test)]
mod tests {
    use std::borrow::Cow;

    use deltazero_solvers::{Next, Real, System};

    use super::*;
    use crate::problem::{Group, Quantity, Role};

    /// `ẏ = −y` that says of itself what it is told to.
    #[derive(Clone)]
    struct Told {
        states: Vec<Quantity>,
        group: Option<Group>,
        start: f64,
        role: Role,
    }

    impl System for Told {
        type Mode = ();
        type State<S: Real> = [S; 1];
        type Guards<S: Real> = [S; 0];

        fn initial_mode(&self, _: f64, _: &[f64; 1]) {}

        fn rhs<S: Real>(&self, (): (), _: S, y: &[S; 1], dydt: &mut [S; 1]) {
            *dydt = [-y[0]];
        }

        fn guards<S: Real>(&self, (): (), _: S, _: &[S; 1], _: &mut [S; 0]) {}

        fn guard_bounds(&self, (): (), _: f64, _: &[f64; 1], _: &mut [f64; 0]) {}

        fn transition<S: Real>(&self, (): (), _: usize, _: S, _: &mut [S; 1]) -> Next<()> {
            Next::Stop
        }
    }

    impl Problem for Told {
        fn start(&self) -> [f64; 1] {
            [self.start]
        }

        fn states(&self) -> Vec<Quantity> {
            self.states.clone()
        }

        fn groups(&self) -> Vec<Group> {
            self.group.iter().cloned().collect()
        }

        fn role(&self, (): &(), _: usize) -> Role {
            self.role
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
        let states = vec![Quantity::new("y", "m", 1.0)];
        Told { states, group: Some(group), start: 1.0, role: Role::Free }
    }

    #[test]
    fn a_problem_that_contradicts_itself_is_told_what_is_wrong() {
        let group = |change: fn(&mut Group)| {
            let mut told = told();
            told.group.iter_mut().for_each(change);
            told
        };
        let cases = [
            (Told { states: vec![], ..told() }, "names 0 states and has 1"),
            (
                Told { states: vec![Quantity::new("y", "m", 0.0)], ..told() },
                "scale of state y is 0",
            ),
            (Told { states: vec![Quantity::new("y", "m", f64::NAN)], ..told() }, "is NaN"),
            (Told { group: None, ..told() }, "no groups"),
            (group(|group| group.states = vec![1]), "group y has the states [1]"),
            (group(|group| group.scale = GroupScale::Fixed(-1.0)), "scale of group y is -1"),
            (group(|group| group.site = 3), "of site 3; the problem has 1"),
            (Told { start: f64::INFINITY, ..told() }, "state y is inf at the start"),
            (Told { role: Role::Contact, ..told() }, "gives no force"),
        ];
        assert_eq!(check(&told()), Ok(()));
        for (problem, what) in cases {
            let message = check(&problem).unwrap_err().to_string();
            assert!(message.contains(what), "{what}: {message}");
        }
    }
}

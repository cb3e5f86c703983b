//! The list of methods, one line each: whatever compares methods loops over it.

mod classical_4;
mod dormand_prince_5;

pub use classical_4::CLASSICAL_4;
pub use dormand_prince_5::DORMAND_PRINCE_5;

use crate::control::Control;
use crate::diffsol::DiffsolSolver;
use crate::erk::ExplicitRk;
use crate::error::Error;
use crate::one_step::OneStepSolver;
use crate::phase::PhaseSolver;
use crate::system::System;
use crate::tableau::Tableau;

/// A method: its name, and what it is made of.
#[derive(Debug)]
pub struct Method {
    /// Short name, as in configurations.
    pub name: &'static str,
    /// Order of the propagated solution (the highest one, where it varies).
    pub order: usize,
    /// What it is, and what it is for.
    pub about: &'static str,
    scheme: Scheme,
}

/// What a method is made of.
#[derive(Debug)]
enum Scheme {
    Explicit4(&'static Tableau<4>),
    Explicit7(&'static Tableau<7>),
    DiffsolBdf,
}

/// All methods.
pub static METHODS: &[Method] = &[
    Method {
        name: "rk4",
        order: CLASSICAL_4.order,
        about: "classical Runge-Kutta, explicit, fixed step: the paper's method and the baseline",
        scheme: Scheme::Explicit4(&CLASSICAL_4),
    },
    Method {
        name: "rk45",
        order: DORMAND_PRINCE_5.order,
        about: "Dormand-Prince 5(4), explicit, adaptive: moderate tolerances, frequent events",
        scheme: Scheme::Explicit7(&DORMAND_PRINCE_5),
    },
    Method {
        name: "bdf",
        order: 5,
        about: "diffsol's BDF, implicit, adaptive, orders 1 to 5: strong damping, few events",
        scheme: Scheme::DiffsolBdf,
    },
];

impl Method {
    /// The method called `name`.
    pub fn named(name: &str) -> Option<&'static Self> {
        METHODS.iter().find(|method| method.name == name)
    }

    /// Whether its step size is the user's to choose.
    pub fn is_fixed_step(&self) -> bool {
        match self.scheme {
            Scheme::Explicit4(tableau) => tableau.b_hat.is_none(),
            Scheme::Explicit7(tableau) => tableau.b_hat.is_none(),
            Scheme::DiffsolBdf => false,
        }
    }

    /// Residuals of the conditions that its [tableau](Tableau::residuals) must meet; none where it
    /// has no tableau.
    pub fn residuals(&self) -> Vec<f64> {
        match self.scheme {
            Scheme::Explicit4(tableau) => tableau.residuals(),
            Scheme::Explicit7(tableau) => tableau.residuals(),
            Scheme::DiffsolBdf => Vec::new(),
        }
    }

    /// The method at work on `problem`, its steps chosen by `control`.
    ///
    /// # Errors
    /// [`Error::BadControl`] for a tolerance given to a fixed-step method, or a fixed step to one
    /// that cannot take it; [`Error::BadArgument`] for a step that is not finite and above zero;
    /// [`Error::BadTolerance`].
    pub fn solver<'p, P: System + 'p>(
        &self,
        problem: &P,
        control: Control,
    ) -> Result<Box<dyn PhaseSolver<P> + 'p>, Error>
    where
        P::Mode: 'p,
    {
        let n = problem.dim();
        match &control {
            Control::Adaptive(_) if self.is_fixed_step() => {
                return Err(Error::BadControl { method: self.name, needs: "a fixed step" });
            }
            Control::Adaptive(tolerance) => tolerance.check(n)?,
            Control::Fixed(h) if !(h.is_finite() && *h > 0.0) => {
                let allowed = "a step must be finite and above zero";
                return Err(Error::BadArgument { name: "step", value: *h, allowed });
            }
            Control::Fixed(_) => {}
        }
        Ok(match self.scheme {
            Scheme::Explicit4(tableau) => {
                Box::new(OneStepSolver::new(problem, ExplicitRk::new(tableau, n), control))
            }
            Scheme::Explicit7(tableau) => {
                Box::new(OneStepSolver::new(problem, ExplicitRk::new(tableau, n), control))
            }
            Scheme::DiffsolBdf => match control {
                Control::Adaptive(tolerance) => Box::new(DiffsolSolver::new(problem, tolerance)),
                Control::Fixed(_) => {
                    return Err(Error::BadControl { method: self.name, needs: "a tolerance" });
                }
            },
        })
    }
}

//! The list of methods. Tests, benches and figures loop over it, so a method in the list is in all of them.
//!
//! A new explicit tableau is a file in `tableaux` and an entry in [`METHODS`]. A tableau need not be in the list to be
//! used: see [`tableau`](crate::tableau).

pub use crate::tableaux::*;

use crate::auto::{self, AutoSolver, LOOSE};
use crate::batch::{self, Entry};
use crate::control::{Control, StepLimits, Steps};
use crate::diffsol::DiffsolScheme;
use crate::erk::ExplicitRk;
use crate::error::{Error, Outcome};
use crate::integrate::Integration;
use crate::one_step::OneStepSolver;
use crate::phase::PhaseSolver;
use crate::radau::{Radau, RadauMethod};
use crate::record::Record;
use crate::rosenbrock::{Rosenbrock, RosenbrockMethod};
use crate::system::{Alike, System};
use crate::tableau::Tableau;
use crate::taylor::{self, TaylorMethod};
use crate::tolerance::Tolerance;

/// Smallest relative tolerance of a run in `f64`.
const LEAST_RTOL: f64 = 1e-15;

/// A method: its name, and what it is made of.
///
/// ```
/// use deltazero_solvers::Method;
///
/// let rk4 = Method::named("rk4").ok_or("no such method")?;
/// assert_eq!((rk4.order, rk4.is_fixed_step(), rk4.is_implicit()), (4, true, false));
/// // Four row sums, and eight conditions of order four.
/// assert_eq!(rk4.residuals().len(), 12);
/// let taylor = Method::named("taylor").ok_or("no such method")?;
/// assert_eq!((taylor.series_order(None), taylor.series_order(Some(1e-9))), (Some(8), Some(15)));
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug)]
pub struct Method {
    /// Short name, as in configurations.
    pub name: &'static str,
    /// Order of the propagated solution; the highest order of methods of several. Of Taylor series it is that of fixed
    /// steps; a tolerance sets [others](Self::series_order).
    pub order: usize,
    /// What the method is, and what it suits.
    pub about: &'static str,
    scheme: Scheme,
}

/// What a method is made of.
#[derive(Debug)]
enum Scheme {
    Explicit(Explicit),
    Taylor,
    Rosenbrock(&'static Rosenbrock<8>),
    Radau(&'static Radau),
    #[cfg_attr(not(feature = "diffsol"), expect(dead_code, reason = "its methods are left out"))]
    Diffsol(DiffsolScheme),
    Auto,
}

/// An explicit tableau, by its number of stages.
///
/// The stage loop is compiled for each number of stages, so that it is unrolled and a step allocates nothing. A tableau
/// with another number of stages needs a variant here and its line in [`for_any_stages`].
#[derive(Clone, Copy, Debug)]
enum Explicit {
    Stages4(&'static Tableau<4>),
    Stages5(&'static Tableau<5>),
    Stages7(&'static Tableau<7>),
    Stages12(&'static Tableau<12>),
    Stages16(&'static Tableau<16>),
}

/// Evaluates an expression with the tableau of an [`Explicit`], whatever its number of stages.
macro_rules! for_any_stages {
    ($explicit:expr, $tableau:ident => $value:expr) => {
        match $explicit {
            Explicit::Stages4($tableau) => $value,
            Explicit::Stages5($tableau) => $value,
            Explicit::Stages7($tableau) => $value,
            Explicit::Stages12($tableau) => $value,
            Explicit::Stages16($tableau) => $value,
        }
    };
}

/// The method of an explicit tableau, for the list.
const fn explicit(name: &'static str, about: &'static str, tableau: Explicit) -> Method {
    let order = for_any_stages!(tableau, tableau => tableau.order);
    Method { name, order, about, scheme: Scheme::Explicit(tableau) }
}

/// All methods; those of `diffsol` where the feature of that name is on.
///
/// ```
/// use deltazero_solvers::METHODS;
///
/// let implicit = METHODS.iter().filter(|method| method.is_implicit());
/// let names: Vec<_> = implicit.map(|method| method.name).collect();
/// assert!(names.starts_with(&["rodas5p", "radau5"]));
/// ```
pub static METHODS: &[Method] = &[
    explicit(
        "rk4",
        "classical Runge-Kutta, explicit, fixed step: the paper's method and the baseline",
        Explicit::Stages4(&CLASSICAL_4),
    ),
    explicit(
        "rk43",
        "Kutta 4(3), the 3/8 rule with an error estimate, explicit, adaptive: loose tolerances, stiff springs",
        Explicit::Stages5(&KUTTA_43),
    ),
    explicit(
        "bs32",
        "Bogacki-Shampine 3(2), explicit, adaptive: loose tolerances, cheap restarts",
        Explicit::Stages4(&BOGACKI_SHAMPINE_3),
    ),
    explicit(
        "rk45",
        "Dormand-Prince 5(4), explicit, adaptive: moderate tolerances, frequent events",
        Explicit::Stages7(&DORMAND_PRINCE_5),
    ),
    explicit(
        "dop853",
        "Dormand-Prince 8(5,3), explicit, adaptive: tight tolerances",
        Explicit::Stages12(&DORMAND_PRINCE_853),
    ),
    explicit(
        "vern98",
        "Verner 9(8), explicit, adaptive: the tightest tolerances",
        Explicit::Stages16(&VERNER_98),
    ),
    Method {
        name: "taylor",
        order: taylor::FIXED_STEP_ORDER,
        about: "Taylor series, explicit, adaptive, order by tolerance: few long steps, tight tolerances",
        scheme: Scheme::Taylor,
    },
    Method {
        name: "rodas5p",
        order: RODAS_5P.order,
        about: "Rodas5P, implicit, L-stable, adaptive: strong damping, loose tolerances, many events",
        scheme: Scheme::Rosenbrock(&RODAS_5P),
    },
    Method {
        name: "radau5",
        order: RADAU_IIA_5.order,
        about: "Radau IIA 5, implicit, L-stable, adaptive: strong damping, moderate to tight tolerances",
        scheme: Scheme::Radau(&RADAU_IIA_5),
    },
    #[cfg(feature = "diffsol")]
    Method {
        name: "bdf",
        order: 5,
        about: "diffsol's BDF, implicit, adaptive, orders 1 to 5: strong damping, few events",
        scheme: Scheme::Diffsol(DiffsolScheme::Bdf),
    },
    #[cfg(feature = "diffsol")]
    Method {
        name: "tr_bdf2",
        order: 2,
        about: "diffsol's TR-BDF2, implicit, L-stable, adaptive: strong damping, loose tolerances",
        scheme: Scheme::Diffsol(DiffsolScheme::TrBdf2),
    },
    #[cfg(feature = "diffsol")]
    Method {
        name: "esdirk34",
        order: 3,
        about: "diffsol's ESDIRK 3(4), implicit, L-stable, adaptive: strong damping, many events",
        scheme: Scheme::Diffsol(DiffsolScheme::Esdirk34),
    },
    #[cfg(feature = "diffsol")]
    Method {
        name: "tsit45",
        order: 5,
        about: "diffsol's Tsitouras 5(4), explicit, adaptive: a check of rk45 by other hands",
        scheme: Scheme::Diffsol(DiffsolScheme::Tsit45),
    },
    Method {
        name: "auto",
        order: DORMAND_PRINCE_853.order,
        about: "rk43, taylor or dop853 by tolerance and size, radau5 where stability binds: any damping",
        scheme: Scheme::Auto,
    },
];

impl Method {
    /// The method called `name`.
    ///
    /// ```
    /// use deltazero_solvers::Method;
    ///
    /// assert_eq!(Method::named("radau5").map(|method| method.order), Some(5));
    /// assert!(Method::named("euler").is_none());
    /// ```
    pub fn named(name: &str) -> Option<&'static Self> {
        METHODS.iter().find(|method| method.name == name)
    }

    /// Whether the method has no error estimate, so that the user must choose its step size.
    pub fn is_fixed_step(&self) -> bool {
        match self.scheme {
            Scheme::Explicit(explicit) => {
                for_any_stages!(explicit, tableau => tableau.b_hat.is_none())
            }
            _ => false,
        }
    }

    /// Whether every step of the method is implicit, so that stability does not limit the step size.
    pub fn is_implicit(&self) -> bool {
        match self.scheme {
            Scheme::Rosenbrock(_) | Scheme::Radau(_) => true,
            Scheme::Diffsol(scheme) => scheme.is_implicit(),
            _ => false,
        }
    }

    /// Whether the method switches between other methods during a run.
    pub fn chooses(&self) -> bool {
        matches!(self.scheme, Scheme::Auto)
    }

    /// Whether the method can compute several runs [at once](Self::run_batch).
    pub fn is_for_batches(&self) -> bool {
        matches!(self.scheme, Scheme::Explicit(_) | Scheme::Taylor | Scheme::Auto)
    }

    /// Order of the Taylor series at a relative tolerance, or with a fixed step for `None`; `None` for a method that
    /// takes none there. [`auto`] may take others than series, [`Work::n_series`](crate::Work) tells.
    pub fn series_order(&self, rtol: Option<f64>) -> Option<usize> {
        match self.scheme {
            Scheme::Taylor => Some(rtol.map_or(taylor::FIXED_STEP_ORDER, taylor::order_for)),
            Scheme::Auto => rtol.filter(|rtol| *rtol < LOOSE).map(taylor::order_for),
            _ => None,
        }
    }

    /// Residuals of the conditions that the [tableau](Tableau::residuals) must meet; empty for a method without a
    /// tableau.
    pub fn residuals(&self) -> Vec<f64> {
        match self.scheme {
            Scheme::Explicit(explicit) => for_any_stages!(explicit, tableau => tableau.residuals()),
            Scheme::Rosenbrock(tableau) => tableau.residuals(),
            Scheme::Radau(tableau) => tableau.residuals(),
            Scheme::Taylor | Scheme::Diffsol(_) | Scheme::Auto => Vec::new(),
        }
    }

    /// A solver that applies the method to `problem`, with steps chosen by a [`Control`], or by [`Steps`] with more
    /// limits.
    ///
    /// # Errors
    /// [`Error::BadControl`] for a tolerance given to a fixed-step method, a fixed step given to a method that needs a
    /// tolerance, and limits given with a fixed step or the longest step to a method of `diffsol`;
    /// [`Error::BadArgument`] for a step that is not finite and above zero, and for `rtol` below 1e-15;
    /// [`Error::BadTolerance`] for a tolerance that is not valid in another way.
    pub fn solver<'p, P: System + 'p>(
        &self,
        problem: &P,
        steps: impl Into<Steps>,
    ) -> Result<Box<dyn PhaseSolver<P> + 'p>, Error>
    where
        P::Mode: 'p,
    {
        self.solver_by(problem, steps.into())
    }

    fn solver_by<'p, P: System + 'p>(
        &self,
        problem: &P,
        steps: Steps,
    ) -> Result<Box<dyn PhaseSolver<P> + 'p>, Error>
    where
        P::Mode: 'p,
    {
        let n = problem.dim();
        self.check(n, &steps.control)?;
        self.check_limits(&steps)?;
        Ok(match self.scheme {
            Scheme::Explicit(explicit) => for_any_stages!(explicit, tableau => {
                Box::new(OneStepSolver::new(problem, ExplicitRk::new(tableau, n), steps))
            }),
            Scheme::Taylor => {
                let order = match &steps.control {
                    Control::Fixed(_) => taylor::FIXED_STEP_ORDER,
                    Control::Adaptive(tolerance) => taylor::order_for(tolerance.rtol),
                };
                let method = TaylorMethod::new(n, problem.n_guards(), order);
                Box::new(OneStepSolver::new(problem, method, steps))
            }
            Scheme::Rosenbrock(tableau) => {
                Box::new(OneStepSolver::new(problem, RosenbrockMethod::new(tableau, n), steps))
            }
            Scheme::Radau(tableau) => {
                let method = RadauMethod::new(tableau, n, &steps.control);
                Box::new(OneStepSolver::new(problem, method, steps))
            }
            Scheme::Diffsol(scheme) => {
                scheme.solver(problem, self.tolerance(steps.control)?, steps.first)
            }
            Scheme::Auto => {
                let Steps { control, first, longest } = steps;
                let limits = StepLimits { first, longest };
                Box::new(AutoSolver::new(self.tolerance(control)?, limits))
            }
        })
    }

    /// The tolerance of `control`, for a method that cannot take fixed steps.
    fn tolerance(&self, control: Control) -> Result<Tolerance, Error> {
        match control {
            Control::Adaptive(tolerance) => Ok(tolerance),
            Control::Fixed(_) => Err(Error::BadControl { method: self.name, needs: "a tolerance" }),
        }
    }

    /// Integrates `runs` of systems of a kind to `t_end`, each under the control and shown to the recorder of its index,
    /// and returns how each ended.
    ///
    /// The results are, to the bit, those of [`Integration::run`] with a [solver](Self::solver) for each run. Methods
    /// with an explicit tableau, Taylor series of one order to tolerances, and [`auto`] in its explicit turns
    /// compute several runs [at once](crate::batch) while their modes differ only in [parameters](Alike::parameters).
    /// Other runs follow one after the other. A run of `auto` whose explicit method is chosen anew goes on with others
    /// that have the same.
    ///
    /// # Errors
    /// As [`solver`](Self::solver), before any run begins.
    ///
    /// # Panics
    /// Where there are fewer `controls` or `records` than `runs`, where two systems give different numbers of
    /// parameters, or where one branches on a number in a mode that has parameters.
    ///
    /// ```
    /// use deltazero_solvers::problems::BouncingBall;
    /// use deltazero_solvers::{Control, Integration, Method, Tolerance};
    ///
    /// let ball = |gravity| BouncingBall { restitution: 0.5, gravity, height: 1.0 };
    /// let balls = [9.8, 1.6, 3.7].map(ball);
    /// let control = Control::Adaptive(Tolerance { rtol: 1e-9, atol: vec![1e-9; 2] });
    /// let mut runs: Vec<_> =
    ///     balls.iter().map(|ball| Integration::new(ball, 0.0, ball.start())).collect();
    /// let method = Method::named("dop853").ok_or("no such method")?;
    /// let controls = vec![control; 3];
    /// method.run_batch(&mut runs, 1.0, &controls, &mut [&mut (), &mut (), &mut ()])?;
    /// for (run, ball) in runs.iter().zip(&balls) {
    ///     assert!((run.point.y[0] - ball.state(1.0)[0]).abs() < 1e-7);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn run_batch<P: Alike>(
        &self,
        runs: &mut [Integration<'_, P>],
        t_end: f64,
        controls: &[Control],
        records: &mut [&mut dyn Record<P>],
    ) -> Result<Vec<Result<Outcome, Error>>, Error> {
        assert!(controls.len().min(records.len()) >= runs.len(), "a run needs control and record");
        for (run, control) in runs.iter().zip(controls) {
            self.check(run.problem.dim(), control)?;
        }
        let mut ends: Vec<batch::End> = runs
            .iter_mut()
            .zip(&mut *records)
            .map(|(run, record)| run.begin(t_end, *record).transpose())
            .collect();
        // A run whose explicit method is chosen anew comes back without an end.
        while ends.iter().any(Option::is_none) {
            self.go_on_in_batches(runs, t_end, controls, records, &mut ends)?;
        }
        Ok(ends.into_iter().flatten().collect())
    }

    /// Goes on with the runs that have no end.
    fn go_on_in_batches<P: Alike>(
        &self,
        runs: &mut [Integration<'_, P>],
        t_end: f64,
        controls: &[Control],
        records: &mut [&mut dyn Record<P>],
        ends: &mut [batch::End],
    ) -> Result<(), Error> {
        let mut entries: Vec<Entry<'_, '_, P>> = Vec::with_capacity(runs.len());
        for (index, ((run, control), record)) in
            runs.iter_mut().zip(controls).zip(records).enumerate()
        {
            if ends[index].is_none() {
                let in_turns = self.in_turns(run, control);
                let record = &mut **record;
                entries.push(Entry { index, run, control, record, in_turns });
            }
        }
        // Runs in one batch have vectors of the same lengths, and series of the same order.
        let class = |Entry { run, control, in_turns, .. }: &Entry<'_, '_, P>| {
            let tolerance = control.tolerance().filter(|_| in_turns.is_none());
            let order = tolerance.and_then(|tolerance| self.series_order(Some(tolerance.rtol)));
            (run.problem.dim(), run.problem.n_guards(), order, *in_turns)
        };
        while let Some(first) = entries.first().map(class) {
            let (same, others) = entries.into_iter().partition(|entry| class(entry) == first);
            entries = others;
            let (.., order, in_turns) = first;
            match (&self.scheme, order, in_turns) {
                (Scheme::Explicit(explicit), ..) => for_any_stages!(*explicit, tableau => {
                    batch::by_tableau(tableau, same, t_end, ends);
                }),
                (.., Some(auto::Explicit::FourthOrder)) => {
                    batch::by_tableau(&KUTTA_43, same, t_end, ends);
                }
                (.., Some(auto::Explicit::EighthOrder)) => {
                    batch::by_tableau(&DORMAND_PRINCE_853, same, t_end, ends);
                }
                // Lanes do not trace: a run that does alone has other last bits.
                (.., Some(auto::Explicit::Series(order))) | (Scheme::Taylor, Some(order), None)
                    if !P::IS_TRACED =>
                {
                    batch::by_series(order, same, t_end, ends);
                }
                _ => {
                    for Entry { index, run, control, record, .. } in same {
                        let mut solver = self.solver(run.problem, control.clone())?;
                        ends[index] = Some(run.go_on(None, t_end, &mut *solver, record));
                    }
                }
            }
        }
        Ok(())
    }

    /// The explicit method of a run that has begun, where an implicit one takes turns with it.
    fn in_turns<P: System>(
        &self,
        run: &Integration<'_, P>,
        control: &Control,
    ) -> Option<auto::Explicit> {
        let tolerance = control.tolerance().filter(|_| self.chooses())?;
        Some(auto::Explicit::of(run.problem, &run.point, tolerance.rtol))
    }

    /// Checks that the method can work on `n` states under `control`.
    fn check(&self, n: usize, control: &Control) -> Result<(), Error> {
        match control {
            Control::Adaptive(_) if self.is_fixed_step() => {
                Err(Error::BadControl { method: self.name, needs: "a fixed step" })
            }
            Control::Adaptive(tolerance) if tolerance.rtol < LEAST_RTOL => {
                let allowed = "f64 has no digits below 1e-15";
                Err(Error::BadArgument { name: "rtol", value: tolerance.rtol, allowed })
            }
            Control::Adaptive(tolerance) => tolerance.check(n),
            Control::Fixed(h) => {
                check_step("step", *h)?;
                match self.scheme {
                    Scheme::Diffsol(_) | Scheme::Auto => {
                        self.tolerance(control.clone()).map(|_| ())
                    }
                    _ => Ok(()),
                }
            }
        }
    }

    /// Checks the first and the longest step.
    fn check_limits(&self, Steps { control, first, longest }: &Steps) -> Result<(), Error> {
        let is_unlimited = *longest == f64::INFINITY;
        let refused = |needs| Err(Error::BadControl { method: self.name, needs });
        match (control, &self.scheme) {
            (Control::Fixed(_), _) if first.is_some() || !is_unlimited => {
                refused("a tolerance where the first or the longest step is given")
            }
            (_, Scheme::Diffsol(_)) if !is_unlimited => {
                refused("an infinite longest step, because diffsol has no such limit")
            }
            _ => {
                first.map_or(Ok(()), |first| check_step("first step", first))?;
                if is_unlimited { Ok(()) } else { check_step("longest step", *longest) }
            }
        }
    }
}

/// Checks that a step is one.
fn check_step(name: &'static str, h: f64) -> Result<(), Error> {
    if h.is_finite() && h > 0.0 {
        return Ok(());
    }
    Err(Error::BadArgument { name, value: h, allowed: "a step must be finite and above zero" })
}

//! What stands for the methods of `diffsol` in a build without them: a type without values.

use crate::phase::PhaseSolver;
use crate::system::System;
use crate::tolerance::Tolerance;

#[derive(Clone, Copy, Debug)]
pub(crate) enum DiffsolScheme {}

impl DiffsolScheme {
    pub(crate) fn is_implicit(self) -> bool {
        match self {}
    }

    pub(crate) fn solver<'p, P: System + 'p>(
        self,
        _problem: &P,
        _tolerance: Tolerance,
        _first: Option<f64>,
    ) -> Box<dyn PhaseSolver<P> + 'p>
    where
        P::Mode: 'p,
    {
        match self {}
    }
}

//! What several runs are integrated along: one model in one mode.

use super::dual::DualLanes;
use super::scalar::{Lanes, Simd};
use crate::erk::{InMode, Slope};
use crate::system::System;

/// The right-hand side and the guards of several runs.
pub(super) trait Field<P: System, V: Simd>: Slope<Lanes<V>, P::State<Lanes<V>>> {
    /// Writes values and rates of the guards at `(t, y)` to `g`.
    fn guards(&self, t: DualLanes<V>, y: &P::State<DualLanes<V>>, g: &mut P::Guards<DualLanes<V>>);
}

impl<P: System, V: Simd> Field<P, V> for InMode<'_, P> {
    #[inline(always)]
    fn guards(&self, t: DualLanes<V>, y: &P::State<DualLanes<V>>, g: &mut P::Guards<DualLanes<V>>) {
        self.problem.guards(self.mode.clone(), t, y, g);
    }
}

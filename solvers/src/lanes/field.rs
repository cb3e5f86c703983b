//! What several runs are integrated along: one model in one mode, or a model of each.

use super::dual::DualLanes;
use super::scalar::{Lanes, Own, Simd};
use crate::erk::{InMode, Slope};
use crate::system::{Alike, System, Vector};
use crate::taylor::coefficient::Coefficient;
use crate::taylor::expand::SeriesField;
use crate::taylor::series::Series;

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

/// A model and a mode of each run, by their numbers.
pub(super) struct OfEach<P: Alike, V: Simd>(P::Numbers<Own<V>>);

impl<P: Alike, V: Simd> OfEach<P, V> {
    /// Of the numbers of each run.
    ///
    /// # Panics
    /// Where they differ in length.
    pub(super) fn new(each: &[P::Numbers<f64>]) -> Self {
        let n = each[0].as_ref().len();
        assert!(
            each.iter().all(|own| own.as_ref().len() == n),
            "systems alike have as many numbers"
        );
        Self(Vector::from_fn(n, |i| Own::from_fn(|lane| each[lane].as_ref()[i])))
    }
}

impl<P: Alike, V: Simd> Slope<Lanes<V>, P::State<Lanes<V>>> for OfEach<P, V> {
    #[inline(always)]
    fn slope(&self, t: Lanes<V>, y: &P::State<Lanes<V>>, dydt: &mut P::State<Lanes<V>>) {
        P::rhs_of(&self.0, t, y, dydt);
    }
}

impl<P: Alike, V: Simd> SeriesField<P, Lanes<V>> for OfEach<P, V>
where
    Lanes<V>: Coefficient,
{
    #[inline(always)]
    fn slope<'s>(
        &self,
        t: Series<'s, Lanes<V>>,
        y: &P::State<Series<'s, Lanes<V>>>,
        dydt: &mut P::State<Series<'s, Lanes<V>>>,
    ) {
        P::rhs_of(&self.0, t, y, dydt);
    }

    #[inline(always)]
    fn guards<'s>(
        &self,
        t: Series<'s, Lanes<V>>,
        y: &P::State<Series<'s, Lanes<V>>>,
        g: &mut P::Guards<Series<'s, Lanes<V>>>,
    ) {
        P::guards_of(&self.0, t, y, g);
    }

    #[inline(always)]
    fn slope_with_guards<'s>(
        &self,
        t: Series<'s, Lanes<V>>,
        y: &P::State<Series<'s, Lanes<V>>>,
        dydt: &mut P::State<Series<'s, Lanes<V>>>,
        g: &mut P::Guards<Series<'s, Lanes<V>>>,
    ) {
        P::rhs_with_guards_of(&self.0, t, y, dydt, g);
    }
}

impl<P: Alike, V: Simd> Field<P, V> for OfEach<P, V> {
    #[inline(always)]
    fn guards(&self, t: DualLanes<V>, y: &P::State<DualLanes<V>>, g: &mut P::Guards<DualLanes<V>>) {
        P::guards_of(&self.0, t, y, g);
    }
}

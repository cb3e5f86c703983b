//! The right-hand side and the guards of several systems of a kind, by the parameters of each.

use crate::erk::Slope;
use crate::lanes::dual::DualLanes;
use crate::lanes::{Lanes, Simd};
use crate::system::{Alike, Vector};
use crate::taylor::coefficient::Coefficient;
use crate::taylor::expand::SeriesField;
use crate::taylor::series::Series;

/// The systems and modes of several runs: the parameters of one in each lane.
pub(super) struct ByParameters<P: Alike, V: Simd>(P::Parameters<Lanes<V>>);

impl<P: Alike, V: Simd> ByParameters<P, V> {
    /// The same `parameters` in all lanes.
    pub(super) fn all(parameters: &P::Parameters<f64>) -> Self {
        let parameters = parameters.as_ref();
        Self(Vector::from_fn(parameters.len(), |i| Lanes::from_fn(|_| parameters[i])))
    }

    /// Sets the parameters in `lane`.
    ///
    /// # Panics
    /// Where their number is another than in the other lanes.
    pub(super) fn set(&mut self, lane: usize, parameters: &P::Parameters<f64>) {
        set(&mut self.0, lane, parameters);
    }

    /// Writes values of the guards at `(t, y)`, and their derivatives where `y` changes by `direction`, to `g`.
    #[inline(always)]
    pub(super) fn guards_along(
        &self,
        t: DualLanes<V>,
        (y, direction): (&[Lanes<V>], &[Lanes<V>]),
        g: &mut P::Guards<DualLanes<V>>,
    ) {
        let along =
            P::State::<DualLanes<V>>::from_fn(y.len(), |i| DualLanes::new(y[i], direction[i]));
        P::guards_of(&self.0, t, &along, g);
    }
}

impl<P: Alike, V: Simd> Slope<Lanes<V>, P::State<Lanes<V>>> for ByParameters<P, V> {
    #[inline(always)]
    fn slope(&self, t: Lanes<V>, y: &P::State<Lanes<V>>, dydt: &mut P::State<Lanes<V>>) {
        P::rhs_of(&self.0, t, y, dydt);
    }
}

impl<P: Alike, V: Simd> SeriesField<P, Lanes<V>> for ByParameters<P, V>
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
    ) -> bool {
        P::rhs_with_guards_of(&self.0, t, y, dydt, g);
        true
    }
}

/// Writes the numbers of `one` to `lane`.
///
/// # Panics
/// Where `one` has another length.
#[inline(always)]
pub(super) fn set<V: Simd, L: Vector<Lanes<V>>, Y: Vector<f64>>(all: &mut L, lane: usize, one: &Y) {
    let (all, one) = (all.as_mut(), one.as_ref());
    assert_eq!(all.len(), one.len(), "systems alike have as many parameters as each other");
    for (all, one) in all.iter_mut().zip(one) {
        all.set(lane, *one);
    }
}

/// Writes the numbers in `lane` to `one`.
#[inline(always)]
pub(super) fn pick<V: Simd, L: Vector<Lanes<V>>, Y: Vector<f64>>(
    all: &L,
    lane: usize,
    one: &mut Y,
) {
    for (all, one) in all.as_ref().iter().zip(one.as_mut()) {
        *one = all.lane(lane);
    }
}

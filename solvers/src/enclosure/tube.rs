//! A box that a solution stays in over a span of time.

use super::expand::Field;
use super::interval::Interval;
use super::watched::{Allowed, Watch, Watched};
use crate::doubt::Doubt;
use crate::system::{System, Vector};

/// Attempts at a box, each wider than the one before.
const ATTEMPTS: usize = 12;
/// Times that a box is made tighter by its own slopes.
const TIGHTENED: usize = 2;
/// Share of its width that a box is widened by at each attempt.
const WIDENED: f64 = 0.2;

/// What a span of time does for a box.
pub(super) enum Tube {
    /// The states over the span.
    Box(Vec<Interval>),
    /// None was found: a shorter span may have one.
    TooLong,
}

impl<P: System> Field<'_, P> {
    /// A box that every solution through `y` at the time `t` stays in over `t + span`; the span contains zero.
    ///
    /// A box `B` with `y + span f(B) ⊆ B` is one (Picard and Lindelöf). Neither the right-hand side nor the guards
    /// take a decision in it on anything but single numbers: it is the same code for all its states, and so for those
    /// of every box inside it.
    ///
    /// N. S. Nedialkov, K. R. Jackson, G. F. Corliss, "Validated solutions of initial value problems for ordinary
    /// differential equations", Appl. Math. Comput. 105(1), 21–68 (1999), section 4.
    pub(super) fn tube(&self, t: f64, y: &[Interval], span: Interval) -> Result<Tube, Doubt> {
        let over = Interval::from(t) + span;
        let image = |of: &[Interval]| -> Vec<Interval> {
            let slope = self.slope(over, of);
            y.iter().zip(slope).map(|(y, f)| *y + span * f).collect()
        };
        let mut guess = image(y);
        for _ in 0..ATTEMPTS {
            let wide: Vec<_> = guess.iter().zip(y).map(|(b, y)| widened(b.hull(*y))).collect();
            let next = image(&wide);
            if next.iter().zip(&wide).all(|(next, wide)| next.is_in(*wide)) {
                let tight = (0..TIGHTENED).fold(next, |tube, _| image(&tube));
                return self.without_branches(over, &wide).map(|()| Tube::Box(tight));
            }
            if next.iter().any(|x| !x.mag().is_finite()) {
                return Ok(Tube::TooLong);
            }
            guess = next;
        }
        Ok(Tube::TooLong)
    }

    /// That the right-hand side and the guards take no decision in the box.
    fn without_branches(&self, t: Interval, y: &[Interval]) -> Result<(), Doubt> {
        let watch = Watch::new(Allowed::Points);
        let t = Watched::new(t, &watch);
        let at = P::State::from_fn(y.len(), |i| Watched::new(y[i], &watch));
        let mut slope = at.clone();
        let mut g = P::Guards::from_fn(self.problem.n_guards(), |_| t);
        self.problem.rhs(self.mode.clone(), t, &at, &mut slope);
        self.problem.guards(self.mode.clone(), t, &at, &mut g);
        if watch.is_undecided() { Err(Doubt::Branch) } else { Ok(()) }
    }
}

fn widened(x: Interval) -> Interval {
    let by = WIDENED * x.width() + f64::MIN_POSITIVE;
    x + Interval::within(by)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::Real;
    use crate::system::Next;

    /// `ẏ = y²`, with the solution `1/(1 − t)` from one; or `ẏ = |y|`, with a branch.
    struct Power {
        branches: bool,
    }

    impl System for Power {
        type Mode = ();
        type State<S: Real> = [S; 1];
        type Guards<S: Real> = [S; 0];

        fn initial_mode(&self, _t: f64, _y: &[f64; 1]) {}

        fn rhs<S: Real>(&self, (): (), _t: S, y: &[S; 1], dydt: &mut [S; 1]) {
            *dydt = match self.branches {
                false => [y[0] * y[0]],
                true if y[0].value() < 0.0 => [-y[0]],
                true => [y[0]],
            };
        }

        fn guards<S: Real>(&self, (): (), _t: S, _y: &[S; 1], _g: &mut [S; 0]) {}

        fn guard_bounds(&self, (): (), _t: f64, _y: &[f64; 1], _bounds: &mut [f64; 0]) {}

        fn transition<S: Real>(&self, (): (), _: usize, _t: S, _y: &mut [S; 1]) -> Next<()> {
            Next::Stop
        }
    }

    fn tube_from(y: Interval, branches: bool, span: f64) -> Result<Tube, Doubt> {
        let field = Field { problem: &Power { branches }, mode: () };
        field.tube(0.0, &[y], Interval::new(0.0, span))
    }

    #[test]
    fn a_tube_holds_the_solution_all_along_and_ends_before_infinity() {
        for span in [0.01, 0.1, 0.2] {
            let Ok(Tube::Box(tube)) = tube_from(Interval::from(1.0), false, span) else {
                panic!("no tube over {span}");
            };
            let exact = Interval::new(1.0, 1.0 / (1.0 - span));
            assert!(exact.is_in(tube[0]) && tube[0].width() < 4.0 * exact.width(), "{tube:?}");
        }
        let beyond = tube_from(Interval::from(1.0), false, 1.01);
        assert!(matches!(beyond, Ok(Tube::TooLong)));
    }

    #[test]
    fn a_right_hand_side_that_branches_is_refused() {
        let doubt = tube_from(Interval::within(0.1), true, 0.1).err();
        assert_eq!(doubt, Some(Doubt::Branch));
    }
}

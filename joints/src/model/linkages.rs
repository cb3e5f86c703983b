//! The list of linkages.

use deltazero_solvers::Real;

use super::four_bar::FourBar;
use super::linkage::{Linkage, Outputs};
use super::slider_crank::SliderCrank;
use super::state::State;

/// The linkages of the list, as one type: what is compiled for a joint is compiled once for all of them.
macro_rules! linkages {
    ($($(#[$meta:meta])* $name:ident),+) => {
        /// A linkage, whichever it is.
        #[derive(Clone, Copy, Debug)]
        pub enum AnyLinkage {
            $($(#[$meta])* $name($name)),+
        }

        /// Where its bodies are.
        #[derive(Clone, Copy, Debug)]
        pub enum AnyAt<S: Real> {
            $($(#[$meta])* $name(<$name as Linkage>::At<S>)),+
        }

        /// Evaluates an expression on the linkage.
        macro_rules! of {
            ($own:expr, $linkage:ident => $value:expr) => {
                match $own { $(AnyLinkage::$name($linkage) => $value),+ }
            };
        }

        /// Evaluates an expression on the linkage and its bodies, which are of the same kind.
        macro_rules! at {
            ($own:expr, $at:expr, ($linkage:ident, $bodies:ident) => $value:expr) => {
                match ($own, $at) {
                    $((AnyLinkage::$name($linkage), AnyAt::$name($bodies)) => $value,)+
                    #[allow(unreachable_patterns, reason = "of a list of one")]
                    _ => unreachable!("the bodies of another linkage"),
                }
            };
        }

        impl AnyLinkage {
            #[inline(always)]
            fn bodies<S: Real>(&self, y: &State<S>) -> AnyAt<S> {
                match self { $(Self::$name(linkage) => AnyAt::$name(linkage.at(y))),+ }
            }
        }
    };
}

linkages! {
    /// Crank, rod and slider.
    SliderCrank,
    /// Crank, coupler and rocker.
    FourBar
}

impl Linkage for AnyLinkage {
    type At<S: Real> = AnyAt<S>;

    #[inline(always)]
    fn at<S: Real>(&self, y: &State<S>) -> AnyAt<S> {
        self.bodies(y)
    }

    #[inline(always)]
    fn spin<S: Real>(&self, at: &AnyAt<S>) -> S {
        at!(self, at, (linkage, bodies) => linkage.spin(bodies))
    }

    #[inline(always)]
    fn accelerations<S: Real>(&self, at: &AnyAt<S>, load: Option<[S; 3]>) -> [S; 3] {
        at!(self, at, (linkage, bodies) => linkage.accelerations(bodies, load))
    }

    #[inline(always)]
    fn response<S: Real>(&self, at: &AnyAt<S>, load: [S; 3]) -> [S; 3] {
        at!(self, at, (linkage, bodies) => linkage.response(bodies, load))
    }

    #[inline(always)]
    fn turned_along<S: Real>(&self, at: &AnyAt<S>, t: [S; 2], pin_radius: f64) -> S {
        at!(self, at, (linkage, bodies) => linkage.turned_along(bodies, t, pin_radius))
    }

    fn speed(&self) -> f64 {
        of!(self, linkage => linkage.speed())
    }

    fn start(&self) -> f64 {
        of!(self, linkage => linkage.start())
    }

    fn acceleration_scale(&self) -> f64 {
        of!(self, linkage => linkage.acceleration_scale())
    }

    fn force_scale(&self) -> f64 {
        of!(self, linkage => linkage.force_scale())
    }

    fn spin_bound(&self, y: &State<f64>) -> f64 {
        of!(self, linkage => linkage.spin_bound(y))
    }

    fn kinetic(&self, y: &State<f64>) -> f64 {
        of!(self, linkage => linkage.kinetic(y))
    }

    fn torque(&self, y: &State<f64>, load: [f64; 3]) -> f64 {
        of!(self, linkage => linkage.torque(y, load))
    }

    fn outputs(&self) -> Outputs {
        of!(self, linkage => linkage.outputs())
    }

    fn output(&self, y: &State<f64>, load: [f64; 3]) -> Vec<f64> {
        of!(self, linkage => linkage.output(y, load))
    }
}

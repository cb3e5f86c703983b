//! What hangs on a pin.

use deltazero_solvers::Real;

use super::inertia::{Arrow, BlockInertia};
use super::linkage::Linkage as _;
use super::linkages::{AnyAt, AnyLinkage};
use super::state::State;

/// What hangs on a joint.
#[derive(Clone, Debug)]
pub enum Body {
    /// Struts that turn with the pin, by θ.
    Struts(BlockInertia),
    /// A linkage, θ the angle of the crank that drives it.
    Linkage(AnyLinkage),
}

/// A borrowed body, matched once for each evaluation, so that what is inlined after the match is compiled for one kind of body.
#[derive(Clone, Copy, Debug)]
pub(super) enum Held<'a> {
    Struts(&'a BlockInertia),
    Linkage(&'a AnyLinkage),
}

/// A body at one state: what of its accelerations does not wait for forces.
#[derive(Clone, Copy, Debug)]
pub(super) enum Posture<'a, S: Real> {
    Struts(&'a BlockInertia, Arrow<S>),
    Linkage(&'a AnyLinkage, AnyAt<S>),
}

impl Body {
    #[inline(always)]
    pub(super) fn held(&self) -> Held<'_> {
        match self {
            Self::Struts(inertia) => Held::Struts(inertia),
            Self::Linkage(linkage) => Held::Linkage(linkage),
        }
    }
}

impl<'a> Held<'a> {
    /// The body at `y`.
    #[inline(always)]
    pub(super) fn at<S: Real>(self, y: &State<S>) -> Posture<'a, S> {
        match self {
            Self::Struts(inertia) => Posture::Struts(inertia, inertia.at(y[2])),
            Self::Linkage(linkage) => Posture::Linkage(linkage, linkage.at(y)),
        }
    }

    /// How fast the pin turns [rad/s].
    #[inline(always)]
    pub(super) fn spin<S: Real>(self, y: &State<S>) -> S {
        match self {
            Self::Struts(_) => y[5],
            Self::Linkage(linkage) => linkage.spin(&linkage.at(y)),
        }
    }
}

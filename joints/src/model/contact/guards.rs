//! How a contact lasts and ends by its normal law: the guards of its modes.

use deltazero_solvers::Real;
use deltazero_solvers::rounding::ROUNDING;

use super::{NormalLaw, Onset};

/// What rounds where a contact is: sizes, and what is nothing beside those of the motion.
#[derive(Clone, Copy, Debug)]
pub struct Rounding {
    /// Rounding error of δ [m].
    pub delta: f64,
    /// Sizes of the terms of δ̇, added [m/s].
    pub speed: f64,
    /// A force that is nothing beside those of the motion [N].
    pub least_force: f64,
}

/// Bounds of the rounding errors of the guards of a contact, and of its force.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// Of [`contact_guard`](NormalLaw::contact_guard).
    pub contact: f64,
    /// Of [`relaxing_guard`](NormalLaw::relaxing_guard).
    pub relaxing: f64,
    /// Of [`range_guard`](NormalLaw::range_guard).
    pub range: f64,
    /// Of F_N [N].
    pub force: f64,
}

impl NormalLaw {
    /// Whether a contact ends, short of δ = 0, where [`factor`](Self::factor) falls below zero: F_N is a product
    /// whose factors are then guarded one by one.
    #[inline(always)]
    pub fn releases_by_factor(&self) -> bool {
        self.hysteresis != 0.0 && !self.adhesion
    }

    /// Whether a contact ends at δ = 0, whatever else ends it: F_N is not what is guarded. Where F(δ) is flat at the
    /// surface the rounding of F_N would be a long way of δ.
    #[inline(always)]
    fn ends_at_surface(&self) -> bool {
        self.adhesion || self.hysteresis != 0.0 || self.damping == 0.0
    }

    /// Whether surfaces that are dented by `delta` > 0 [m] are in contact: without adhesion those that press.
    pub fn touches<S: Real>(&self, delta: S, delta_dot: S, onset: Onset) -> bool {
        self.adhesion || self.force(delta, delta_dot, onset).value() > 0.0
    }

    /// Whether a contact that ends at `delta` [m] leaves a dent that relaxes.
    pub fn leaves_dent<S: Real>(&self, delta: S) -> bool {
        !self.adhesion && delta.value() > 0.0
    }

    /// Positive while a contact lasts: δ, or F_N of a law with damping and without adhesion.
    #[inline(always)]
    pub fn contact_guard<S: Real>(&self, delta: S, delta_dot: S, onset: Onset) -> S {
        if self.ends_at_surface() { delta } else { self.force(delta, delta_dot, onset) }
    }

    /// Positive while a dent relaxes: it does not press.
    #[inline(always)]
    pub fn relaxing_guard<S: Real>(&self, delta: S, delta_dot: S, onset: Onset) -> S {
        if self.releases_by_factor() {
            -self.factor(delta_dot, onset)
        } else {
            -self.force(delta, delta_dot, onset)
        }
    }

    /// Positive in contact within the range of the law, where it has one: [`factor`](Self::factor), or how far δ is
    /// from the [deepest](super::Elastic::deepest); no law has both.
    #[inline(always)]
    pub fn range_guard<S: Real>(&self, delta: S, delta_dot: S, onset: Onset) -> Option<S> {
        if self.releases_by_factor() {
            Some(self.factor(delta_dot, onset))
        } else {
            self.elastic.before_deepest(delta)
        }
    }

    /// Bounds of the rounding errors of these at δ [m] and δ̇ [m/s].
    pub fn guard_bounds(
        &self,
        [delta, delta_dot]: [f64; 2],
        onset: Onset,
        rounding: Rounding,
    ) -> Bounds {
        let Rounding { delta: of_delta, speed, least_force } = rounding;
        // The slope of a law may be zero at the surface, not so beside it.
        let [slope, damping] = self.gradient(delta.abs() + of_delta, delta_dot, onset);
        let elastic = self.elastic.force(delta).abs();
        let size = (elastic + damping.abs() * speed).max(least_force);
        let force = slope.abs() * of_delta + ROUNDING * size;
        let factor = ROUNDING * (1.0 + self.hysteresis / onset.impact_speed * speed);
        let by_factor = self.releases_by_factor();
        let to_deepest = self.elastic.deepest().map_or(0.0, |deepest| of_delta / deepest);
        Bounds {
            contact: if self.ends_at_surface() { of_delta } else { force },
            relaxing: if by_factor { factor } else { force },
            range: if by_factor { factor } else { ROUNDING + to_deepest },
            force,
        }
    }
}

//! The problems with closed forms of [`deltazero_solvers::problems`], as a study sees them.

use deltazero_solvers::problems::{
    BallMode, BouncingBall, CompliantBall, FrictionOscillator, SpringStop, StopMode, Wall,
};
use deltazero_solvers::{ModeOfState as _, Real, Record};

use crate::problem::{Energy, Power, Problem, Quantity, Role, Touch};
use crate::run::{Begun, OwnRun, Setting, at_once, blind, extended};

// Functions that integrate are `inline`: they are compiled where they are called, and the program calls none of them.

/// A position and its velocity.
fn position_and_velocity(length: f64, speed: f64) -> Vec<Quantity> {
    vec![Quantity::new("x", "m", length), Quantity::new("v", "m/s", speed)]
}

impl Problem for BouncingBall {
    fn start(&self) -> [f64; 2] {
        Self::start(self)
    }

    fn states(&self) -> Vec<Quantity> {
        position_and_velocity(self.height, (2.0 * self.gravity * self.height).sqrt())
    }

    fn runs_at_once(&self) -> bool {
        true
    }

    #[inline]
    fn integrate_at_once(
        runs: &[Begun<'_, Self>],
        setting: &Setting,
        t_end: f64,
        records: &mut [&mut dyn Record<Self>],
    ) -> Vec<OwnRun<Self>> {
        at_once(runs, setting, t_end, records)
    }
}

/// A site is a wall.
impl Problem for CompliantBall {
    fn start(&self) -> [f64; 2] {
        self.start
    }

    fn states(&self) -> Vec<Quantity> {
        position_and_velocity(self.gap, self.start[1].abs())
    }

    fn n_sites(&self) -> usize {
        2
    }

    fn site_name(&self, site: usize) -> String {
        ["left wall", "right wall"][site].to_owned()
    }

    fn role(&self, mode: &BallMode, site: usize) -> Role {
        let wall = [Wall::Left, Wall::Right][site];
        if *mode == BallMode::Contact(wall) { Role::Contact } else { Role::Free }
    }

    fn site_of_guard(&self, mode: &BallMode, _guard: usize) -> usize {
        let (BallMode::Flight(wall) | BallMode::Contact(wall)) = mode;
        usize::from(*wall == Wall::Right)
    }

    fn touch<S: Real>(
        &self,
        mode: &BallMode,
        _t: S,
        &[x, v]: &[S; 2],
        site: usize,
    ) -> Option<Touch<S>> {
        let [depth, rate] = if site == 0 { [-x, -v] } else { [x - self.gap, v] };
        let force = if self.role(mode, site).is_contact() {
            depth * self.stiffness + rate * self.damping
        } else {
            S::cst(0.0)
        };
        Some(Touch { depth, rate, force })
    }

    fn energies(&self, mode: &BallMode, t: f64, y: &[f64; 2]) -> Option<Energy> {
        let depth = |site| self.touch(mode, t, y, site).map_or(0.0, |touch| touch.depth);
        let is_in_contact = |site: &usize| self.role(mode, *site).is_contact();
        let elastic = |site: usize| 0.5 * self.stiffness * depth(site) * depth(site);
        let elastic = (0..2).filter(is_in_contact).map(elastic).sum();
        Some(Energy { kinetic: 0.5 * self.mass * y[1] * y[1], elastic })
    }

    fn powers(&self, mode: &BallMode, _t: f64, y: &[f64; 2]) -> Option<Power> {
        let is_damped = matches!(mode, BallMode::Contact(_));
        let damping = if is_damped { self.damping * y[1] * y[1] } else { 0.0 };
        Some(Power { drive: 0.0, damping, friction: 0.0 })
    }

    fn has_blind_runs(&self) -> bool {
        true
    }

    fn mode_read(&self, _mode: &BallMode, t: f64, y: &[f64; 2]) -> BallMode {
        self.mode_of_state(t, y)
    }

    #[inline]
    fn integrate_blind(
        &self,
        setting: &Setting,
        y0: [f64; 2],
        t_end: f64,
        record: &mut dyn Record<Self>,
    ) -> OwnRun<Self> {
        blind(self, setting, y0, t_end, record)
    }

    #[inline]
    fn integrate_extended(
        &self,
        rtol: f64,
        y0: [f64; 2],
        t_end: f64,
        record: &mut dyn Record<Self>,
    ) -> OwnRun<Self> {
        extended(self, rtol, y0, t_end, record)
    }
}

impl Problem for SpringStop {
    fn start(&self) -> [f64; 2] {
        self.start
    }

    fn states(&self) -> Vec<Quantity> {
        position_and_velocity(self.gap, self.surface_speed())
    }

    fn role(&self, mode: &StopMode, _site: usize) -> Role {
        match mode {
            StopMode::Free => Role::Free,
            StopMode::Contact => Role::Contact,
        }
    }

    fn touch<S: Real>(
        &self,
        mode: &StopMode,
        _t: S,
        &[x, v]: &[S; 2],
        _site: usize,
    ) -> Option<Touch<S>> {
        let depth = x - self.gap;
        let force = match mode {
            StopMode::Free => S::cst(0.0),
            StopMode::Contact => depth * self.stop_stiffness,
        };
        Some(Touch { depth, rate: v, force })
    }
}

impl Problem for FrictionOscillator {
    fn start(&self) -> [f64; 2] {
        Self::start(self)
    }

    fn states(&self) -> Vec<Quantity> {
        position_and_velocity(self.release.abs(), self.omega() * self.release.abs())
    }
}

/// What the tests of several modules run.
#[cfg(test)]
pub(crate) mod balls {
    use deltazero_solvers::problems::{CompliantBall, Exit};

    /// A mass that flies slowly between two lightly damped walls.
    pub(crate) const HEAVY_BALL: CompliantBall = CompliantBall {
        mass: 6.0,
        stiffness: 1e7,
        damping: 20.0,
        exit: Exit::Penetration,
        gap: 2e-4,
        start: [1e-4, -1e-2],
    };

    /// One that flies fast between two soft walls.
    pub(crate) const LIGHT_BALL: CompliantBall = CompliantBall {
        mass: 0.1,
        stiffness: 1e4,
        damping: 1.0,
        exit: Exit::Penetration,
        gap: 0.05,
        start: [0.02, 1.0],
    };
}

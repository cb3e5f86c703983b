//! [`CompliantBall`] as a study knows it.

use deltazero_solvers::problems::{BallMode, CompliantBall, Wall};
use deltazero_solvers::{ModeOfState as _, Real, Record};

use super::position_and_velocity;
use crate::problem::{Energy, Power, Problem, Quantity, Role, Touch};
use crate::run::{OwnRun, Setting, blind, extended};

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

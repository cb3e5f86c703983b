//! [`TwoBalls`] as a study knows it.

use deltazero_solvers::problems::{BouncingMode, TwoBalls};

use crate::problem::{Group, GroupScale, Problem, Quantity, Role};

/// A site is a ball.
impl Problem for TwoBalls {
    fn start(&self) -> [f64; 4] {
        Self::start(self)
    }

    fn states(&self) -> Vec<Quantity> {
        let of_ball = |site: usize| {
            let own = self.balls[site].states().into_iter();
            own.map(move |own| Quantity { name: format!("{}{}", own.name, site + 1).into(), ..own })
        };
        (0..2).flat_map(of_ball).collect()
    }

    fn groups(&self) -> Vec<Group> {
        let group = |(i, state): (usize, Quantity)| Group {
            name: state.name,
            unit: state.unit,
            states: vec![i],
            scale: GroupScale::Largest,
            site: i / 2,
        };
        self.states().into_iter().enumerate().map(group).collect()
    }

    fn n_sites(&self) -> usize {
        2
    }

    fn site_name(&self, site: usize) -> String {
        ["first ball", "second ball"][site].to_owned()
    }

    fn site_of_guard(&self, _modes: &[BouncingMode; 2], guard: usize) -> usize {
        guard
    }

    fn role(&self, modes: &[BouncingMode; 2], site: usize) -> Role {
        self.balls[site].role(&modes[site], 0)
    }

    fn tells_forces(&self) -> bool {
        false
    }

    fn mode_name(&self, modes: &[BouncingMode; 2], site: usize) -> String {
        format!("{:?}", modes[site])
    }

    fn columns(&self, site: usize) -> Vec<Quantity> {
        self.states().split_off(2 * site).into_iter().take(2).collect()
    }

    fn rows(
        &self,
        _modes: &[BouncingMode; 2],
        _t: f64,
        y: &[f64; 4],
        row: &mut dyn FnMut(usize, &[f64]),
    ) {
        y.chunks(2).enumerate().for_each(|(site, own)| row(site, own));
    }
}

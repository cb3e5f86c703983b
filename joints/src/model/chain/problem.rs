//! The chain as a study sees it, each bay a site.

use deltazero_solvers::{Error, Outcome, Real, Record};
use deltazero_study::Problem;
use deltazero_study::problem::{EndName, Energy, Group, Laws, Power, Quantity, Role, Touch};
use deltazero_study::run::{OwnRun, Setting, integrate};

use super::{Chain, Modes};
use crate::model::block::Block;
use crate::model::jointed::{
    Jointed, REACHED_90, joint_groups, joint_quantities, laws, out_of_stiffness, part_name,
    relaxes, role, touch,
};
use crate::model::mode::Mode;

/// A chain runs in f64 with its events located: the other two would be a second and a third copy of every
/// method, for what one bay has shown.
impl Problem for Chain {
    fn name(&self) -> String {
        part_name(&self.bay)
    }

    fn check(&self) -> Result<(), Error> {
        self.bay.check_load()
    }

    fn start(&self) -> Vec<f64> {
        self.of_each(self.bay.initial_state(), 0.0)
    }

    fn states(&self) -> Vec<Quantity> {
        let bay: Vec<_> = joint_quantities(self.bay.scale()).collect();
        let bristles = Quantity::new("z", "m", self.bristle_scale());
        let own: Vec<_> = bay.into_iter().chain([bristles]).take(self.stride()).collect();
        std::iter::repeat_n(own, self.bays).flatten().collect()
    }

    fn groups(&self) -> Vec<Group> {
        (0..self.bays).flat_map(|k| joint_groups(&self.bay, self.offset(k), k)).collect()
    }

    fn n_sites(&self) -> usize {
        self.bays
    }

    fn site_name(&self, site: usize) -> String {
        match self.bays {
            1 => self.name(),
            _ => format!("bay {}, {}", site + 1, self.name()),
        }
    }

    fn site_of_guard(&self, _modes: &Modes, guard: usize) -> usize {
        Self::bay_of(guard)
    }

    fn role(&self, modes: &Modes, site: usize) -> Role {
        role(modes[site])
    }

    fn code(&self, modes: &Modes, site: usize) -> i8 {
        modes[site].code()
    }

    fn is_counted(&self, before: &Modes, after: &Modes, site: usize) -> bool {
        before[site].code() != after[site].code()
    }

    fn starts_on_surface(&self) -> bool {
        self.bay.starts_in_contact()
    }

    fn unit_of_time(&self) -> f64 {
        self.bay.body_time()
    }

    fn touch<S: Real>(&self, modes: &Modes, _t: S, y: &Vec<S>, site: usize) -> Option<Touch<S>> {
        touch(&self.bay, modes[site], &self.state_of(y, site))
    }

    fn energies(&self, modes: &Modes, _t: f64, y: &Vec<f64>) -> Option<Energy> {
        Some(self.energy(modes, y))
    }

    fn powers(&self, modes: &Modes, _t: f64, y: &Vec<f64>) -> Option<Power> {
        Some(self.power(modes, y))
    }

    fn drive_work(&self, y0: &Vec<f64>, y1: &Vec<f64>) -> Option<f64> {
        let of_bay = |k| self.bay.drive_work(&self.joint_state(y0, k), &self.joint_state(y1, k));
        (0..self.bays).map(of_bay).sum()
    }

    fn mode_name(&self, modes: &Modes, site: usize) -> String {
        modes[site].code().to_string()
    }

    fn labels(&self, site: usize) -> Vec<(&'static str, usize)> {
        vec![("bay", site + 1), ("joint", self.bay.joint)]
    }

    fn columns(&self, _site: usize) -> Vec<Quantity> {
        self.bay.motion_columns()
    }

    fn rows(&self, modes: &Modes, _t: f64, y: &Vec<f64>, row: &mut dyn FnMut(usize, &[f64])) {
        for (k, forces) in self.forces(modes, y).into_iter().enumerate() {
            row(k, &self.bay.motion_row(modes[k], &self.joint_state(y, k), forces));
        }
    }

    fn in_brief(&self, y: &Vec<f64>) -> String {
        let angle = |k: usize| format!("{:.6e}", self.joint_state(y, k)[2]);
        match self.bays {
            1 => format!("theta = {} rad", angle(0)),
            bays => format!("theta = {} to {} rad", angle(0), angle(bays - 1)),
        }
    }

    fn end_name(&self) -> EndName {
        REACHED_90
    }

    fn begins_at_speed_floor(&self, before: &Modes, after: &Modes) -> bool {
        (0..self.bays).any(|k| self.bay.begins_at_floor(before[k], after[k]))
    }

    fn out_of_stiffness(&self) -> &'static str {
        out_of_stiffness(&self.bay)
    }

    fn nearest_end(&self, modes: &Modes, y: &Vec<f64>) -> Option<usize> {
        Some(self.joint_nearest_end(modes, y))
    }

    fn takes_energy(&self, before: &Modes, after: &Modes) -> bool {
        before.iter().zip(after.iter()).any(|(a, b)| a != b && relaxes(*a, *b))
    }

    fn laws(&self) -> Laws {
        laws(&self.bay)
    }

    /// The same for every bay, in the paper's order; that of bristles stays.
    fn spread(&self, each: &[f64], all: &mut [f64]) {
        let Ok(each) = each.try_into() else { return };
        let each = self.bay.in_paper_order(each);
        for k in 0..self.bays {
            let offset = self.offset(k);
            all[offset..offset + each.len()].copy_from_slice(&each);
        }
    }

    fn judged(
        &self,
        outcome: Result<Outcome, Error>,
        t: f64,
        modes: &Modes,
        y: &Vec<f64>,
    ) -> Result<Outcome, Error> {
        let k = self.joint_nearest_end(modes, y);
        self.bay.range_judged(outcome, t, modes[k], &self.joint_state(y, k))
    }
}

impl Jointed for Chain {
    fn block(&self) -> &Block {
        &self.bay
    }

    fn joint_mode(modes: &Modes, k: usize) -> Mode {
        modes[k]
    }

    fn integrate(
        &self,
        setting: &Setting,
        y0: Vec<f64>,
        t_end: f64,
        record: &mut dyn Record<Self>,
    ) -> OwnRun<Self> {
        integrate(self, setting, y0, t_end, record)
    }
}

//! A plan of a sweep, with a configuration and a model beside it that it may name.

#![no_main]

use deltazero::sweep::{Over, Sweep};
use deltazero_fuzz::file;
use libfuzzer_sys::fuzz_target;

const BASE: &[u8] = b"run.t_end = 0.1\nsolver.rtol = 1e-6\n";
const MODEL: &[u8] = include_bytes!("../../text/models/mass_against_stop.toml");

fuzz_target!(init: {
    file("base.toml", BASE);
    file("stop.toml", MODEL);
}, |text: &[u8]| {
    match Sweep::read(&file("plan.toml", text), &Over::default()) {
        Ok(sweep) => {
            assert_eq!(sweep.columns().len(), sweep.units().len());
            assert!(sweep.header().ends_with('\n') && !sweep.identity().is_null());
            let (mut indices, mut values) = (Vec::new(), Vec::new());
            for run in [0, sweep.n_runs / 2, sweep.n_runs - 1] {
                sweep.plan.indices(run, &mut indices);
                sweep.plan.values(run, &indices, &mut values);
                assert_eq!(values.len(), sweep.plan.keys().len());
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});

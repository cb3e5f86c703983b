//! What a blind run shares with a located one.
#![allow(clippy::unwrap_used, reason = "a test panics to fail")]

mod common;

use common::{config, located, run, setting};
use deltazero::run::mode_changes;
use deltazero_study::run::Accuracy;
use deltazero_study::setting::Events;

#[test]
fn a_blind_run_ends_at_90_degrees_too() {
    let config = config(&["run.t_end=20"]);
    let blind = setting("rk45", Events::Blind, Accuracy::Rtol(1e-6, None));
    let reached = |setting| {
        let (_, run) = run(&config, setting);
        run.parts.iter().map(|part| part.stopped_at().unwrap()).collect::<Vec<_>>()
    };
    let (blind, located) = (reached(&blind), reached(&located("rk45", 1e-6)));
    for (blind, located) in blind.iter().zip(&located) {
        // Measured: 1.6e-5 s.
        assert!((blind - located).abs() < 1e-4, "{blind} against {located}");
    }
}

#[test]
fn a_blind_run_sees_the_mode_changes_of_a_located_one_at_the_ends_of_its_steps() {
    let config = config(&["run.t_end=0.2"]);
    let step = 1e-6;
    let blind = setting("rk4", Events::Blind, Accuracy::Step(step));
    let (_, blind) = run(&config, &blind);
    let (_, located) = run(&config, &located("rk45", 1e-10));
    for (blind, located) in blind.trajectories.iter().zip(&located.trajectories) {
        let (blind, located) = (mode_changes(blind), mode_changes(located));
        assert_eq!(blind.len(), located.len());
        for (blind, located) in blind.iter().zip(&located).skip(1) {
            assert_eq!((blind.before, blind.after), (located.before, located.after));
            let late = blind.t - located.t;
            assert!((-1e-7..=step + 1e-7).contains(&late), "{late:e}");
        }
    }
}

//! Table 1 is enclosed by intervals that are proven to hold its exact solution, and the golden run lies in them.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test panics to fail, and shows its table"
)]

mod common;

use common::{Golden, config};
use deltazero::model::contact::Onset;
use deltazero::model::{Block, Joints, Mode};
use deltazero_solvers::Tolerance;
use deltazero_solvers::enclosure::Enclosure;
use deltazero_study::Problem as _;

/// The end of what is enclosed here [s].
const T_END: f64 = 0.25;

/// Encloses one joint, and compares it with its golden run: `(number of events, widest time)`.
fn enclose(block: &Block, golden: &Golden) -> (usize, f64) {
    // It begins in contact: δ and its first three derivatives are zero at the start, and the fourth is above.
    let mode = Mode::SlipPlus(Onset::PLAIN);
    let atol = vec![1e-20, 1e-20, 1e-20, 1e-17, 1e-17, 1e-17];
    let tolerance = Tolerance { rtol: 1e-18, atol };
    let mut enclosure = Enclosure::new(block, mode, 0.0, &block.start(), tolerance).unwrap();
    let joint = block.joint - 1;
    let mut events = golden.events[joint].iter().skip(1);
    let (mut n_events, mut widest) = (0, 0.0_f64);
    for (t, mode, y) in golden.states[joint].iter().take_while(|(t, ..)| *t <= T_END) {
        while let Some(event) = enclosure.advance(*t).unwrap() {
            let known = events.next().unwrap();
            assert_eq!(event.before.code(), known.before);
            assert_eq!(event.after.map(Mode::code), Some(known.after));
            println!(
                "joint {} t = {:.15} s, width {:.1e} s",
                joint + 1,
                event.t.mid(),
                event.t.width()
            );
            assert!(event.t.contains(known.t), "{:?} for {}", event.t, known.t);
            widest = widest.max(event.t.width());
            n_events += 1;
        }
        assert_eq!(enclosure.mode().code(), *mode);
        let y = block.in_paper_order(y);
        for (i, (own, known)) in enclosure.state().iter().zip(y).enumerate() {
            assert!(own.contains(known), "state {i} at {t} s: {own:?} for {known}");
        }
    }
    (n_events, widest)
}

#[test]
fn the_golden_run_lies_in_the_enclosure_of_its_first_impacts() {
    let golden = Golden::read("pin_table1");
    let joints = Joints::from(&config(&[]));
    for block in joints.blocks() {
        let (n_events, widest) = enclose(block, &golden);
        // Measured: 1.2e-10 s and 2.6e-10 s.
        assert!(n_events == 4 && widest < 2e-9, "{n_events}, {widest:e}");
    }
}

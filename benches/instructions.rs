//! Cases whose instructions `benches/instructions` counts under callgrind: `CASE N` does one N times,
//! so that the difference of two runs is the case alone; without arguments it lists them.
#![allow(missing_docs, clippy::print_stdout, reason = "a program, not a library")]

use std::error::Error;
use std::hint::black_box;
use std::sync::atomic::AtomicBool;

use deltazero::config::Config;
use deltazero::model::contact::Onset;
use deltazero::model::{Block, Joints, Mode, State};
use deltazero::run::Run;
use deltazero_solvers::{Control, Grid, Integration, METHODS, Method, System, Tolerance};
use deltazero_study::run::{Accuracy, Limits, Setting};
use deltazero_study::setting::Events;

/// A contact that slips.
const SLIPS: State<f64> = [-9.1e-5, -4.4e-5, 0.01, 0.0, 0.0, 0.5];
/// Steps of a fixed size [s] in that contact, short of its end.
const STEP: f64 = 5e-6;
const STEPS: f64 = 50.0;
/// Relative tolerance of a run of Table 1.
const RTOL: f64 = 1e-6;

fn main() -> Result<(), Box<dyn Error>> {
    let config = Config::table1()?;
    let mechanism = Joints::from(&config);
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let [case, times] = &arguments[..] else {
        cases().iter().for_each(|case| println!("{case}"));
        return Ok(());
    };
    let times: u64 = times.parse()?;
    let block = &mechanism.blocks()[0];
    let (what, of) = case.split_once('/').ok_or("a case is WHAT/OF")?;
    for _ in 0..times {
        match what {
            "rhs" => right_hand_side(block, of)?,
            "steps" => steps(block, of)?,
            "table1" => table1(&mechanism, of)?,
            _ => return Err(format!("no case {case}").into()),
        }
    }
    Ok(())
}

fn cases() -> Vec<String> {
    let mut cases = vec!["rhs/free".to_owned(), "rhs/slip".to_owned()];
    cases.extend(METHODS.iter().map(|method| format!("steps/{}", method.name)));
    cases.extend(METHODS.iter().map(|method| format!("table1/{}", method.name)));
    cases
}

fn named(method: &str) -> Result<&'static Method, String> {
    Method::named(method).ok_or_else(|| format!("no method {method}"))
}

/// One evaluation.
fn right_hand_side(block: &Block, mode: &str) -> Result<(), Box<dyn Error>> {
    let mode = if mode == "free" { Mode::Apart } else { Mode::SlipPlus(Onset::PLAIN) };
    let mut dydt = [0.0; 6];
    block.rhs(black_box(mode), 0.0, black_box(&SLIPS), &mut dydt);
    black_box(dydt);
    Ok(())
}

/// Fifty steps in contact, or as many as the method makes of them.
fn steps(block: &Block, method: &str) -> Result<(), Box<dyn Error>> {
    let method = named(method)?;
    let tolerance = Tolerance { rtol: RTOL, atol: block.scale().map(|s| RTOL * s).to_vec() };
    let mut solver = method
        .solver(block, Control::Fixed(STEP))
        .or_else(|_| method.solver(block, Control::Adaptive(tolerance)))?;
    let mut run = Integration::new(block, 0.0, black_box(SLIPS));
    run.run(STEP * STEPS, &mut *solver, &mut ())?;
    black_box(run.point.y);
    Ok(())
}

/// The 0–2 s transient of both joints with 200 samples each, events located.
fn table1(mechanism: &Joints, method: &str) -> Result<(), Box<dyn Error>> {
    let method = named(method)?;
    let accuracy =
        if method.is_fixed_step() { Accuracy::Step(1e-4) } else { Accuracy::Rtol(RTOL, None) };
    let setting = Setting { method, events: Events::Located, accuracy };
    let limits =
        Limits { max_rhs: u64::MAX, max_seconds: f64::INFINITY, stop: &AtomicBool::new(false) };
    let run = Run::new(mechanism, &setting, 2.0, &Grid::uniform(0.01, 2.0), limits);
    run.error().map_or(Ok(()), |error| Err(error.clone().into()))
}

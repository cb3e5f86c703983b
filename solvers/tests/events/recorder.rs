//! What a recorder is shown, and when.

use std::ops::ControlFlow;

use deltazero_solvers::problems::{BouncingBall, BouncingMode, SpringStop};
use deltazero_solvers::taylor::ExtendedIntegration;
use deltazero_solvers::{
    Accepted, Blind, Error, Event, Grid, Integration, Needs, Outcome, Record, System, Tolerance,
    Trajectory, Unblind,
};

use crate::common::{at_most, iterates, steps_itself};
use crate::log::{Log, Setting, flow, settings};
use crate::script::chain;

#[test]
fn a_recorder_sees_each_step_and_event_once_and_in_order() {
    let ball = BouncingBall { restitution: 0.9, gravity: 9.8, height: 1.0 };
    for (method, control) in settings() {
        let name = method.name;
        let mut log = Log::default();
        let mut integration = Integration::new(&ball, 0.0, ball.start());
        let mut solver = method.solver(&ball, control).unwrap();
        integration.run(3.0, &mut *solver, &mut log).unwrap();
        assert_eq!(log.steps.len() as u64, integration.stats.n_accepted, "{name}");
        assert_eq!(log.steps[0].0, 0.0);
        assert!(log.steps.windows(2).all(|pair| pair[0].1 == pair[1].0), "{name}");
        assert_eq!(log.steps.last().unwrap().1, 3.0);
        let landings: Vec<_> = log.steps.iter().filter(|step| step.2.is_some()).collect();
        assert_eq!(landings.len(), log.events.len(), "{name}");
        for (landing, event) in landings.iter().zip(&log.events) {
            assert_eq!((landing.1, landing.2), (event.0, Some(event.1)), "{name}");
            assert_eq!(log.steps[event.4 - 1].1, event.0, "{name}");
        }
    }
}

#[test]
fn a_recorder_may_break_off_at_a_step_or_an_event_and_the_run_can_go_on() {
    let script = chain(&[&[0.7, -1.0], &[1.3, -1.0]]);
    for (method, control) in settings() {
        for break_at in [(1, usize::MAX), (3, usize::MAX), (usize::MAX, 1)] {
            let name = method.name;
            let mut log = Log { break_at, ..Log::default() };
            let mut integration = Integration::new(&script, 0.0, [0.0; 2]);
            let mut solver = method.solver(&script, control.clone()).unwrap();
            let outcome = integration.run(2.0, &mut *solver, &mut log);
            assert_eq!(outcome, Ok(Outcome::Interrupted), "{name}");
            assert_eq!(integration.point.t, log.steps.last().unwrap().1, "{name}");
            let outcome = integration.run(2.0, &mut *solver, &mut log);
            assert_eq!(outcome, Ok(Outcome::Finished), "{name}");
            let times = log.times();
            assert!(times.len() == 2 && (times[0] - 0.7).abs() < 1e-13, "{name}: {times:?}");
            assert!(log.steps.windows(2).all(|pair| pair[0].1 == pair[1].0), "{name}");
        }
    }
}

/// Breaks at each step that lands on an event, or at each event.
struct Each {
    landing: bool,
}

impl<P: System> Record<P> for Each {
    fn step(&mut self, accepted: &Accepted<'_, P>) -> ControlFlow<()> {
        flow(!self.landing || accepted.landed_on.is_none())
    }

    fn event(&mut self, _: &Event<'_, P>) -> ControlFlow<()> {
        flow(self.landing)
    }
}

/// How often `run` is interrupted until it is over.
fn interruptions(name: &str, mut run: impl FnMut() -> Result<Outcome, Error>) -> u64 {
    for n in 0..400 {
        match run() {
            Ok(Outcome::Interrupted) => {}
            end => {
                assert_eq!(end, Ok(Outcome::Finished), "{name}");
                return n;
            }
        }
    }
    panic!("{name}: it does not end")
}

#[test]
fn a_run_that_is_broken_off_at_each_landing_passes_its_events() {
    let ball = BouncingBall { restitution: 0.7, gravity: 9.8, height: 1.0 };
    for (method, control) in settings() {
        let mut integration = Integration::new(&ball, 0.0, ball.start());
        let mut solver = method.solver(&ball, control).unwrap();
        let n = interruptions(method.name, || {
            integration.run(2.0, &mut *solver, &mut Each { landing: true })
        });
        assert_eq!((n, integration.stats.n_events), (4, 4), "{}", method.name);
    }
    let tolerance = Tolerance { rtol: 1e-20, atol: vec![1e-20; 2] };
    let mut run = ExtendedIntegration::new(&ball, 0.0, &ball.start(), tolerance);
    let n = interruptions("extended", || run.run(2.0, &mut Each { landing: true }));
    assert_eq!((n, run.stats.n_events), (4, 4));
}

#[test]
fn a_run_that_is_broken_off_at_each_event_comes_to_rest() {
    let ball = BouncingBall { restitution: 0.7, gravity: 9.8, height: 1.0 };
    for (method, control) in settings() {
        let mut integration = Integration::new(&ball, 0.0, ball.start());
        let mut solver = method.solver(&ball, control).unwrap();
        // Measured: 158, and 133 for bdf.
        interruptions(method.name, || {
            integration.run(4.0, &mut *solver, &mut Each { landing: false })
        });
        let at_rest = (BouncingMode::Rest, [0.0, 0.0]);
        assert_eq!((integration.point.mode, integration.point.y), at_rest, "{}", method.name);
    }
}

#[test]
fn a_sample_on_an_event_shows_what_follows_it() {
    let ball = BouncingBall { restitution: 0.5, gravity: 9.8, height: 1.0 };
    for (method, control) in settings() {
        let mut first = Trajectory::on(Grid::Steps);
        let mut integration = Integration::new(&ball, 0.0, ball.start());
        let mut solver = method.solver(&ball, control.clone()).unwrap();
        integration.run(0.6, &mut *solver, &mut first).unwrap();
        let t = first.events[0].t;
        let on_step = first.samples.iter().find(|sample| sample.t == t).unwrap();
        // The same run again, with a sample exactly at the event.
        let mut second = Trajectory::on(Grid::Times(vec![0.0, 0.3, t, 0.6]));
        let mut integration = Integration::new(&ball, 0.0, ball.start());
        let mut solver = method.solver(&ball, control).unwrap();
        integration.run(0.6, &mut *solver, &mut second).unwrap();
        let times: Vec<_> = second.samples.iter().map(|sample| sample.t).collect();
        assert_eq!(times, [0.0, 0.3, t, 0.6], "{}", method.name);
        for sample in [on_step, &second.samples[2]] {
            let [y, v] = sample.y;
            assert!(y == 0.0 && v > 2.0, "{}: {sample:?}", method.name);
        }
        assert_eq!(second.samples[0].y, ball.start());
        assert_eq!(second.samples[3], *first.samples.last().unwrap());
    }
}

#[test]
fn what_a_recorder_needs_of_steps_changes_neither_the_run_nor_what_it_sees() {
    let ball = BouncingBall { restitution: 0.8, gravity: 9.8, height: 1.0 };
    // The last time is that of the end of a step.
    let grid = || Grid::Times(vec![0.1, 0.55, 0.56, 1.3, 2.0]);
    let run = |(method, control): &Setting, record: &mut dyn Record<BouncingBall>| {
        let mut integration = Integration::new(&ball, 0.0, ball.start());
        let mut solver = method.solver(&ball, control.clone()).unwrap();
        integration.run(2.0, &mut *solver, record).unwrap();
        format!("{:?} {:?}", integration.point, integration.stats)
    };
    for setting in settings() {
        let mut alone = Trajectory::on(grid());
        let end = run(&setting, &mut alone);
        let all: [fn(f64) -> Needs; 3] =
            [|_| Needs::Nothing, |_| Needs::Ends, |_| Needs::DenseOutput];
        for needs in all {
            let name = format!("{}, {:?}", setting.0.name, needs(0.0));
            let mut both = (Trajectory::on(grid()), Log { needs, ..Log::default() });
            assert_eq!(run(&setting, &mut both), end, "{name}");
            assert_eq!(
                (&both.0.samples, &both.0.events),
                (&alone.samples, &alone.events),
                "{name}"
            );
        }
    }
}

#[test]
fn a_step_that_nobody_needs_is_shown_to_nobody_and_told_of() {
    let ball = BouncingBall { restitution: 0.8, gravity: 9.8, height: 1.0 };
    for (method, control) in settings().iter().filter(|(method, _)| !steps_itself(method, &ball)) {
        let name = method.name;
        let mut log = Log { needs: |_| Needs::Nothing, ..Log::default() };
        let mut solver = method.solver(&ball, control.clone()).unwrap();
        let mut integration = Integration::new(&ball, 0.0, ball.start());
        integration.run(2.0, &mut *solver, &mut log).unwrap();
        let shown_all = name == "auto";
        assert_eq!(
            (log.steps.is_empty(), log.passed.is_empty()),
            (!shown_all, shown_all),
            "{name}"
        );
        let n = log.steps.len() + log.passed.len();
        assert_eq!(n as u64, integration.stats.n_accepted, "{name}");
        assert!(log.passed.is_sorted_by(|a, b| a.0 < b.0 && a.1 <= b.1), "{name}");
        assert!(log.passed.last().is_none_or(|(t, _)| *t == 2.0), "{name}");
        assert_eq!(log.events.len() as u64, integration.stats.n_events, "{name}");
    }
}

#[test]
fn a_recorder_may_break_off_at_a_step_that_it_is_only_told_of() {
    let ball = BouncingBall { restitution: 0.8, gravity: 9.8, height: 1.0 };
    for (method, control) in settings().iter().filter(|(method, _)| !steps_itself(method, &ball)) {
        let mut log =
            Log { needs: |_| Needs::Nothing, break_at: (3, usize::MAX), ..Log::default() };
        let mut solver = method.solver(&ball, control.clone()).unwrap();
        let mut integration = Integration::new(&ball, 0.0, ball.start());
        let outcome = integration.run(2.0, &mut *solver, &mut log);
        assert_eq!(outcome, Ok(Outcome::Interrupted), "{}", method.name);
        assert_eq!(integration.stats.n_accepted, 3, "{}", method.name);
        if let Some((t, _)) = log.passed.last() {
            assert_eq!(integration.point.t, *t, "{}", method.name);
        }
        let outcome = integration.run(2.0, &mut *solver, &mut log);
        assert_eq!(outcome, Ok(Outcome::Finished), "{}", method.name);
    }
}

#[test]
fn a_sample_needs_what_its_place_on_the_step_asks_for() {
    let needs = |t, [t0, t1]: [f64; 2]| Needs::to_sample(t, t0, t1);
    for (t, expected) in [(1.9, Needs::DenseOutput), (2.0, Needs::Ends), (2.1, Needs::Nothing)] {
        assert_eq!([needs(t, [1.0, 2.0]), needs(-t, [-1.0, -2.0])], [expected; 2], "{t}");
    }
    assert_eq!(needs(f64::INFINITY, [1.0, 2.0]), Needs::Nothing);
    assert_eq!(needs(f64::NEG_INFINITY, [1.0, 2.0]), Needs::DenseOutput);
    assert_eq!(needs(1.0, [1.0, 1.0]), Needs::Ends);
}

/// Greatest difference between a step's slope of the height and the velocity it landed with.
struct Landings(f64);

impl Record<BouncingBall> for Landings {
    fn step(&mut self, accepted: &Accepted<'_, BouncingBall>) -> ControlFlow<()> {
        let step = accepted.step;
        if accepted.landed_on.is_some() {
            self.0 = self.0.max((step.slope1()[0] - step.y1()[1]).abs());
        }
        ControlFlow::Continue(())
    }
}

#[test]
fn a_landing_has_the_slope_of_where_it_lands() {
    let ball = BouncingBall { restitution: 0.9, gravity: 9.8, height: 1.0 };
    for (method, control) in settings() {
        let mut landings = Landings(0.0);
        let mut solver = method.solver(&ball, control).unwrap();
        let mut integration = Integration::new(&ball, 0.0, ball.start());
        integration.run(3.0, &mut *solver, &mut landings).unwrap();
        // Measured: 0, for diffsol's at most 3.2e-13 m/s (tsit45).
        let bound = if steps_itself(method, &ball) { 3e-12 } else { 0.0 };
        at_most(method.name, landings.0, bound);
    }
}

#[test]
fn a_blind_run_that_is_broken_off_shows_the_change_of_mode_of_its_last_step() {
    let stop = SpringStop {
        mass: 1.0,
        stiffness: 4.0,
        stop_stiffness: 400.0,
        gap: 0.1,
        start: [-0.3, 0.4],
    };
    let blind = Blind(&stop);
    // A fixed step of an iteration may have no solution where the slope jumps.
    for (method, control) in settings().into_iter().filter(|setting| !iterates(setting.0)) {
        let run = |break_at| {
            let mut log = Log { break_at, ..Log::default() };
            let mut shown = Unblind::new(&stop, 0.0, &stop.start, &mut log);
            let mut integration = Integration::new(&blind, 0.0, stop.start);
            let mut solver = method.solver(&blind, control.clone()).unwrap();
            while integration.run(3.0, &mut *solver, &mut shown).unwrap() == Outcome::Interrupted {}
            log
        };
        let whole = run((usize::MAX, usize::MAX));
        assert!(!whole.events.is_empty(), "{}", method.name);
        // The step after which the mode is first another.
        let broken_off = run((whole.events[0].4, usize::MAX));
        assert_eq!(broken_off.events[0], whole.events[0], "{}", method.name);
    }
}

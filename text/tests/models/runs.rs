//! Runs of the models in the folder `models`.

use std::sync::atomic::AtomicBool;

use deltazero_solvers::{Grid, Method, Next, Trajectory};
use deltazero_study::Problem;
use deltazero_study::energy_balance::{Balance, EnergyBalance};
use deltazero_study::run::{Accuracy, Braked, Limits, OwnRun, Price, Setting, integrate};
use deltazero_study::setting::Events;
use deltazero_text::{ModelFile, TextModel};

/// Methods of each kind that hold a relative tolerance of 1e-10.
pub(crate) const METHODS: [&str; 6] = ["rk45", "dop853", "vern98", "taylor", "radau5", "rodas5p"];

/// Work of a run, at most.
const MOST_RHS: u64 = 10_000_000;

/// The file of this name.
pub(crate) fn file(name: &str) -> ModelFile {
    let path = format!("{}/models/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap();
    ModelFile::parse(&path, &text).unwrap_or_else(|report| panic!("{report}"))
}

/// All its parts, with these parameters.
pub(crate) fn parts(name: &str, values: &[(&str, f64)]) -> Vec<TextModel> {
    let values: Vec<_> = values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    file(name).models(&values).unwrap_or_else(|report| panic!("{report}"))
}

/// Its only part, with these parameters.
pub(crate) fn model(name: &str, values: &[(&str, f64)]) -> TextModel {
    parts(name, values).swap_remove(0)
}

/// Its parameter of this name.
pub(crate) fn parameter(name: &str, parameter: &str) -> f64 {
    file(name).parameters().iter().find(|own| own.name == parameter).unwrap().value
}

/// The end of the run that the file asks for [s].
pub(crate) fn t_end(name: &str) -> f64 {
    file(name).t_end().unwrap()
}

/// An event; several at one time are one, from the mode before the first to the mode after the last.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Change {
    pub(crate) t: f64,
    pub(crate) before: String,
    /// `end` where the run ends.
    pub(crate) after: String,
}

/// A run with its events located; one that fails is a panic.
pub(crate) struct Run {
    pub(crate) end: OwnRun<TextModel>,
    /// The state at the end.
    pub(crate) y: Vec<f64>,
    pub(crate) samples: Vec<(f64, Vec<f64>)>,
    pub(crate) changes: Vec<Change>,
}

/// The method of this name at this relative tolerance, its events located.
pub(crate) fn setting(method: &str, rtol: f64) -> Setting {
    let method = Method::named(method).unwrap();
    Setting { method, events: Events::Located, accuracy: Accuracy::Rtol(rtol, None) }
}

impl Run {
    /// With every step.
    pub(crate) fn by(model: &TextModel, method: &str, rtol: f64, t_end: f64) -> Self {
        Self::on(model, method, rtol, t_end, Grid::Steps)
    }

    /// With samples on `grid`.
    pub(crate) fn on(model: &TextModel, method: &str, rtol: f64, t_end: f64, grid: Grid) -> Self {
        let start = model.start();
        Self::from(model, start.as_ref(), &setting(method, rtol), t_end, grid)
    }

    /// From another start than that of the file.
    pub(crate) fn from(
        model: &TextModel,
        start: &[f64],
        setting: &Setting,
        t_end: f64,
        grid: Grid,
    ) -> Self {
        let method = setting.method.name;
        let (mut trajectory, mut y) = (Trajectory::on(grid), model.start());
        y.copy_from_slice(start);
        let stop = AtomicBool::new(false);
        let limits = Limits { max_rhs: MOST_RHS, ..Limits::none(&stop) };
        let mut watch = limits.watch(Price::of_setting(setting));
        let mut record = (trajectory, Braked(&mut watch));
        let end = integrate(model, setting, y, t_end, &mut record);
        trajectory = record.0;
        assert!(watch.cut.is_none(), "{method}: more than {MOST_RHS} right-hand sides");
        assert!(end.outcome.is_ok(), "{method}: {:?}", end.outcome);
        let name = |mode| model.mode_name(mode, 0);
        let mut changes: Vec<Change> = Vec::new();
        for event in &trajectory.events {
            let after = match &event.after {
                Next::Mode(mode) => name(mode),
                Next::Stop => "end".to_owned(),
            };
            match changes.last_mut() {
                Some(last) if last.t == event.t => last.after = after,
                _ => changes.push(Change { t: event.t, before: name(&event.before), after }),
            }
        }
        let samples = trajectory.samples.iter();
        let samples = samples.map(|sample| (sample.t, sample.y.clone())).collect();
        let y = end.y.clone();
        Self { end, y, samples, changes }
    }

    /// Times of the changes to `mode`.
    pub(crate) fn times_of(&self, mode: &str) -> Vec<f64> {
        self.changes.iter().filter(|change| change.after == mode).map(|change| change.t).collect()
    }
}

/// The largest distance of two states, each over its scale.
pub(crate) fn distance(model: &TextModel, a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let states = model.states().into_iter().map(|state| state.scale);
    states.zip(a.iter().zip(b)).map(|(scale, (a, b))| (a - b).abs() / scale).fold(0.0, f64::max)
}

/// The largest difference of two lists of times of one length [s].
pub(crate) fn latest(found: &[f64], exact: &[f64]) -> f64 {
    assert_eq!(found.len(), exact.len(), "{found:?} for {exact:?}");
    found.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The energy balance of a run by the method of this name at this relative tolerance.
pub(crate) fn balance(model: &TextModel, method: &str, rtol: f64, t_end: f64) -> Balance {
    let (record, run) = balanced(model, method, rtol, t_end);
    record.at(&run.mode, run.t, &run.y).unwrap()
}

/// The same run, with what was recorded of its energy.
pub(crate) fn balanced<'a>(
    model: &'a TextModel,
    method: &str,
    rtol: f64,
    t_end: f64,
) -> (EnergyBalance<'a, TextModel>, OwnRun<TextModel>) {
    let start = model.start();
    let mut record = EnergyBalance::new(model, Events::Located, &start);
    let run = integrate(model, &setting(method, rtol), start, t_end, &mut record);
    assert!(run.outcome.is_ok(), "{:?}", run.outcome);
    (record, run)
}

/// The bound of a method at a relative tolerance of 1e-10: of those of high order, of `rk45` and `radau5`, of `bdf`.
pub(crate) fn of(method: &str, [high, middle, low]: [f64; 3]) -> f64 {
    match method {
        "bdf" => low,
        "rk45" | "radau5" => middle,
        _ => high,
    }
}

/// Asserts that what was measured is below its bound, and prints it.
#[allow(clippy::print_stdout, reason = "a measured value stands beside its bound")]
pub(crate) fn below(what: &str, measured: f64, bound: f64) {
    println!("{what}: measured {measured:.1e}, bound {bound:.0e}");
    assert!(measured < bound, "{what}: measured {measured:e}, bound {bound:e}");
}

//! Some runs of a sweep together: their configurations, and the rows of what became of them.

use std::fmt::Write as _;
use std::ops::Range;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::Sweep;
use super::columns::{Cell, cells, estimated, heads_of_run};
use super::course::{Course, caught, make_at_once};
use super::layout::Places;
use crate::chunks::Maker;
use crate::config::Variants;
use crate::csv::{exact, field};

/// The status of a run that came to its end.
pub(super) const OK: &str = "ok";

/// Most runs that are made together: several for each lane, so that few lanes wait for the last ones.
const MOST_TOGETHER: u64 = 64;
/// Time that runs made together may take, so that a stop is soon obeyed and progress seen.
const TOGETHER: Duration = Duration::from_millis(200);
/// Time after which they are given up, because runs are slower than those before: the rest are made one after the other.
const PATIENCE: Duration = Duration::from_secs(2);

/// Makes runs of a sweep, on one thread.
pub struct Runner<'a> {
    sweep: &'a Sweep,
    variants: Variants,
    cells: Vec<Cell>,
    /// Where they go, of a run whose combination of values the layout has not.
    places: Option<Places>,
    /// Runs that are made together next.
    pub(super) n_together: u64,
    /// Time that they may take.
    pub(super) patience: Duration,
    /// Time that the integrations took so far.
    pub took: Duration,
}

/// A run that is begun: its number, its values, and its course or why there is none.
struct Begun {
    run: u64,
    indices: Vec<u64>,
    values: Vec<Value>,
    course: Result<Course, String>,
}

impl Maker for Runner<'_> {
    /// As many as take little time together. Once `is_over` says so, the first run has its row, and others only if nothing of
    /// them is left to be made or checked.
    fn some(
        &mut self,
        runs: Range<u64>,
        rows: &mut String,
        is_over: &dyn Fn() -> bool,
    ) -> Vec<bool> {
        let start = Instant::now();
        let n = self.n_together.min(runs.end - runs.start);
        let mut begun: Vec<_> = runs.clone().take(n as usize).map(|run| self.begin(run)).collect();
        if n > 1 {
            let courses = begun.iter_mut().filter_map(|own| own.course.as_mut().ok());
            let seconds = self.patience.as_secs_f64();
            make_at_once(&mut courses.collect::<Vec<_>>(), self.sweep.plan.audit, seconds);
        }
        let mut ends = Vec::with_capacity(begun.len());
        for mut own in begun {
            let is_late = || is_over() || start.elapsed() > self.patience;
            if !ends.is_empty() && self.has_work(&own) && is_late() {
                break;
            }
            self.finish(&mut own);
            ends.push(self.write(own, rows));
        }
        let each = start.elapsed().as_secs_f64() / ends.len() as f64;
        let most = MOST_TOGETHER.min(2 * self.n_together);
        self.n_together = ((TOGETHER.as_secs_f64() / each) as u64).clamp(1, most);
        ends
    }
}

impl<'a> Runner<'a> {
    pub(super) fn new(sweep: &'a Sweep) -> Self {
        let variants = sweep.variants.clone();
        let (cells, places, n_together, took) = (Vec::new(), None, 1, Duration::ZERO);
        Self { sweep, variants, cells, places, n_together, patience: PATIENCE, took }
    }

    fn begin(&mut self, run: u64) -> Begun {
        let (mut indices, mut values) = Default::default();
        self.sweep.plan.indices(run, &mut indices);
        self.sweep.plan.values(run, &indices, &mut values);
        let begin = || {
            let config = self.variants.set(&values).map_err(|error| error.to_string());
            config.and_then(Course::new)
        };
        let course = caught(begin).unwrap_or_else(|panic| {
            // Values may be entered in part.
            self.variants = self.sweep.variants.clone();
            Err(panic)
        });
        Begun { run, indices, values, course }
    }

    /// Whether something of a run is still to be made.
    fn has_work(&self, begun: &Begun) -> bool {
        let is_checked = self.sweep.plan.is_checked(begun.run);
        begun.course.as_ref().is_ok_and(|course| !course.is_made() || is_checked)
    }

    /// Makes what is still to be made of a run.
    fn finish(&self, begun: &mut Begun) {
        if let Ok(course) = &mut begun.course {
            course.make(self.sweep.plan.audit);
            if self.sweep.plan.is_checked(begun.run) {
                course.check();
            }
        }
    }

    /// Adds the row of a run that was made; whether it came to its end.
    fn write(&mut self, begun: Begun, rows: &mut String) -> bool {
        let Begun { run, indices, values, course } = begun;
        let _ = write!(rows, "{run}");
        for value in &values {
            rows.push(',');
            write_value(rows, value);
        }
        let status = caught(|| self.fill(&indices, course)).unwrap_or_else(|panic| {
            self.cells.clear();
            Err(panic)
        });
        rows.push(',');
        match &status {
            Ok(()) => rows.push_str(OK),
            Err(error) => rows.push_str(&field(&in_a_line(error))),
        }
        self.write_cells(&indices, rows);
        rows.push('\n');
        status.is_ok()
    }

    /// Fills the cells with what a run tells; why it did not come to its end.
    fn fill(&mut self, indices: &[u64], course: Result<Course, String>) -> Result<(), String> {
        self.cells.clear();
        self.places = None;
        let course = course?;
        if course.made.is_empty() {
            return course.status;
        }
        self.took += course.made.iter().map(|(_, brief)| brief.run.took.cpu).sum::<Duration>();
        cells(&course.made, &mut self.cells);
        if self.sweep.plan.check > 0.0 {
            estimated(course.estimate, course.reached(), &mut self.cells);
        }
        let Sweep { layout, plan, .. } = self.sweep;
        let mut places = layout.places(plan, indices);
        if places.is_none() {
            let heads = heads_of_run(course.made.iter().map(|(part, _)| part), plan);
            self.places = layout.places_of_run(&heads);
            places = self.places.as_ref();
        }
        if places.is_none_or(|places| places.n != self.cells.len()) {
            self.cells.clear();
            return Err(
                "it tells of other columns than the plan; make a plan of it alone".to_owned()
            );
        }
        course.status
    }

    fn write_cells(&self, indices: &[u64], rows: &mut String) {
        let Sweep { layout, plan, .. } = self.sweep;
        let places = layout.places(plan, indices).or(self.places.as_ref());
        for column in 0..layout.heads.len() {
            rows.push(',');
            let place = places.and_then(|places| places.of_column[column]);
            match place.and_then(|place| self.cells.get(place)) {
                None => {}
                Some(Cell::Number(x)) => write_number(rows, *x),
                Some(Cell::Count(n)) => drop(write!(rows, "{n}")),
                Some(Cell::Text(text)) => rows.push_str(&field(text)),
            }
        }
    }
}

/// What is wrong, in one line, as a run is: of a report on a model what it says and where, without the text there.
fn in_a_line(error: &str) -> String {
    let lines = error.lines().map(str::trim).take_while(|line| *line != "|");
    lines.collect::<Vec<_>>().join(" ").replace('\r', " ")
}

fn write_value(rows: &mut String, value: &Value) {
    match value {
        Value::String(word) => rows.push_str(&field(word)),
        Value::Number(number) if number.is_f64() => write_number(rows, number.as_f64()),
        other => rows.push_str(&field(&other.to_string())),
    }
}

fn write_number(rows: &mut String, x: Option<f64>) {
    // A run that diverges may end with what is no number.
    rows.push_str(&exact(x.filter(|x| x.is_finite())));
}

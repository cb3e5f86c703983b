//! Reading of a plan: its file, its configuration, and a check of every value that a key is to take.

use std::path::Path;

use serde_json::Value;

use super::draw::{Law, MOST_SOBOL, MOST_SOBOL_KEYS, Sampling};
use super::plan::{Axis, Draw, Plan, Random, Values};
use super::table::{Table, pair, refused, tables};
use super::{MOST_CHUNKS, SweepError, keys};
use crate::config::toml_source::{document, read};
use crate::config::{ConfigError, Datum, Given, Model, Variants, Varied};
use crate::keys::Kind;

/// Why ends are refused whose distance is no number.
const TOO_FAR_APART: &str = "the ends are farther apart than the largest number, 1.8e308";
/// Largest number of runs.
const MOST_RUNS: u64 = 1_000_000_000_000;
/// Largest number of points of an axis, of draws at a point, and of runs in a chunk.
const MOST_POINTS: u64 = 1_000_000_000;
const MOST_IN_CHUNK: u64 = 1_000_000;
/// Largest number of points of an axis of whole numbers, each of which is looked at.
const MOST_WHOLE: u64 = 1_000_000;
/// Runs of a chunk where the plan does not say how many: so many of a large plan, of a small one such a part.
const CHUNK: u64 = 1000;
const CHUNKS_OF_A_SMALL_PLAN: u64 = 64;

const ROOT: [&str; 7] = ["config", "model", "axis", "random", "chunk", "audit", "check"];
const AXIS: [&str; 5] = ["key", "values", "linear", "log", "points"];
const RANDOM: [&str; 4] = ["samples", "seed", "sampling", "key"];
const DRAW: [&str; 4] = ["key", "uniform", "log_uniform", "normal"];

/// What stands over a plan.
#[derive(Clone, Debug, Default)]
pub struct Over<'a> {
    /// A model from a file, in place of that of the plan.
    pub model: Option<&'a Path>,
    /// Settings over the configuration, each `key=value`.
    pub sets: &'a [String],
    /// Name and text of the model of a sweep that was begun; it takes the place of a file of this name that is gone.
    pub begun: Option<(String, String)>,
}

/// A plan with the configuration that it varies.
pub(super) struct Read {
    pub(super) plan: Plan,
    pub(super) variants: Variants,
    pub(super) n_runs: u64,
}

/// Reads the plan in `path`, with what stands over it.
///
/// # Errors
/// The first complaint: about the plan, its configuration, or a value that a key is to take.
pub(super) fn plan(path: &Path, over: &Over<'_>) -> Result<Read, SweepError> {
    let file = path.display().to_string();
    let given = document(&file, &read(path)?)?;
    let root = Table::new("a plan", &given, &ROOT)?;
    let beside = |key| match root.get(key) {
        None => Ok(None),
        Some(_) => root.word(key, "").map(|(name, _)| Some(path.with_file_name(name))),
    };
    let (base, model) = (beside("config")?, beside("model")?);
    let model = over.model.map(Path::to_owned).or(model);
    let model = model.map(|file| self::model(&file, over.begun.as_ref())).transpose()?;
    let axes = tables("axis", root.get("axis"))?;
    let axes: Vec<Table<'_>> = each("[[axis]]", axes, &AXIS)?;
    let random = root.get("random").map(|given| Table::new("[random]", given, &RANDOM));
    let random = random.transpose()?;
    let drawn = tables("random.key", random.as_ref().and_then(|table| table.get("key")))?;
    let drawn: Vec<Table<'_>> = each("[[random.key]]", drawn, &DRAW)?;
    if axes.is_empty() && random.is_none() {
        let what =
            "has neither [[axis]] nor [random]; give one of them, or use `deltazero simulate`";
        return Err(root.incomplete(what));
    }
    let paths = keys::named(axes.iter().chain(&drawn))?;
    let variants = Variants::new(model, base.as_deref(), over.sets, &paths)?;
    keys::check(&variants, &paths)?;
    let of_axis = |(i, table)| axis(&variants, i, table);
    let own = axes.iter().enumerate().map(of_axis).collect::<Result<_, _>>()?;
    let draws = (axes.len()..).zip(&drawn).map(|(i, table)| draw(&variants, i, table));
    let draws: Vec<Draw> = draws.collect::<Result<_, _>>()?;
    let random = random.as_ref().map(|table| self::random(table, draws)).transpose()?;
    let chunk = root.whole("chunk", 1, MOST_IN_CHUNK)?;
    let audit = root.truth("audit")?.unwrap_or(true);
    let check = root.part("check")?.unwrap_or(0.0);
    let mut plan = Plan { axes: own, random, chunk: 0, audit, check };
    let n_runs = plan.n_runs().filter(|n| *n <= MOST_RUNS);
    let n_runs = n_runs
        .ok_or_else(|| SweepError::TooManyRuns { file: file.clone(), most: MOST_RUNS as f64 })?;
    let usual = n_runs.div_ceil(CHUNKS_OF_A_SMALL_PLAN).clamp(1, CHUNK);
    plan.chunk = chunk.unwrap_or(usual.max(n_runs.div_ceil(MOST_CHUNKS)));
    let chunks = n_runs.div_ceil(plan.chunk);
    if chunks > MOST_CHUNKS {
        let (chunk, runs, most) = (plan.chunk, n_runs, MOST_CHUNKS);
        return Err(SweepError::TooManyChunks { file, chunk, chunks, runs, most });
    }
    Ok(Read { plan, variants, n_runs })
}

fn each<'a>(
    name: &'static str,
    all: &'a [Given],
    known: &[&str],
) -> Result<Vec<Table<'a>>, SweepError> {
    all.iter().map(|given| Table::new(name, given, known)).collect()
}

/// The model in a file, which goes by its name without its folders, so that rows do not tell where it was; or that of a sweep
/// that was begun with it.
fn model(file: &Path, begun: Option<&(String, String)>) -> Result<Model, ConfigError> {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    match begun {
        Some((own, text)) if *own == name && !file.exists() => Model::new(&name, text),
        _ => Ok(Model::read(file)?.renamed(&name)),
    }
}

/// The axis that a table describes, of the key number `i`.
fn axis(variants: &Variants, i: usize, table: &Table<'_>) -> Result<Axis, SweepError> {
    let Varied { path: key, kind, .. } = &variants.varied()[i];
    let forms = ["values", "linear", "log"].map(|form| table.get(form).map(|given| (form, given)));
    let given: Vec<_> = forms.into_iter().flatten().collect();
    let &[(form, given)] = &given[..] else {
        return Err(table.incomplete("takes one of values, linear, log"));
    };
    if form == "values" {
        if let Some(points) = table.get("points") {
            return Err(refused(
                "points",
                points,
                "values are given one by one; leave points away",
            ));
        }
        let values = listed(variants, i, key, given)?;
        return Ok(Axis { key: key.clone(), values });
    }
    let whole = matches!(kind, Kind::Integer(..));
    let most = if whole { MOST_WHOLE } else { MOST_POINTS };
    let Some(points) = table.whole("points", 2, most)? else {
        return Err(
            table.incomplete("has no \"points\"; give the number of values, both ends included")
        );
    };
    let (ends, entries) = pair(form, given, "the first and the last value")?;
    if form == "log" && ends.iter().any(|end| *end <= 0.0) {
        return Err(refused(form, given, "both ends must be greater than zero; use linear"));
    }
    if form == "linear" && !(ends[1] - ends[0]).is_finite() {
        return Err(refused(form, given, TOO_FAR_APART));
    }
    for entry in entries {
        variants.checked(i, entry)?;
    }
    let values = match form {
        "linear" => Values::Linear { ends, points, whole },
        _ => Values::Log { ends, points, whole },
    };
    if whole {
        check_each(variants, i, &values, given)?;
    }
    Ok(Axis { key: key.clone(), values })
}

/// Whether a key of whole numbers takes each of these; one that takes numbers of a range takes all between two that it takes.
fn check_each(
    variants: &Variants,
    i: usize,
    values: &Values,
    given: &Given,
) -> Result<(), ConfigError> {
    for x in (0..values.len()).filter_map(|k| values.number(k)) {
        let place = given.place.clone();
        variants.checked(i, &Given { place, text: x.to_string(), datum: Datum::Number(x) })?;
    }
    Ok(())
}

fn listed(variants: &Variants, i: usize, key: &str, given: &Given) -> Result<Values, SweepError> {
    let entries = match &given.datum {
        Datum::List(entries) if !entries.is_empty() => entries,
        _ => return Err(refused("values", given, format!("a list of values of {key} is wanted"))),
    };
    let values: Result<Vec<Value>, _> =
        entries.iter().map(|entry| variants.checked(i, entry)).collect();
    Ok(Values::List(values?))
}

/// What a table draws, of the key number `i`.
fn draw(variants: &Variants, i: usize, table: &Table<'_>) -> Result<Draw, SweepError> {
    let Varied { path: key, kind, is_of_shape, .. } = &variants.varied()[i];
    let forms = ["uniform", "log_uniform", "normal"];
    let given = forms.iter().filter_map(|form| table.get(form).map(|given| (*form, given)));
    let given: Vec<_> = given.collect();
    let &[(form, given)] = &given[..] else {
        return Err(table.incomplete("takes one of uniform, log_uniform, normal"));
    };
    let is_number = |kind: &Kind| matches!(kind, Kind::Number(_));
    let takes_numbers = match kind {
        Kind::OneOf(kinds) => kinds.iter().any(is_number),
        kind => is_number(kind),
    };
    if *is_of_shape {
        let reason = format!("{key} makes the length of a vector; give an axis of its values");
        return Err(refused(form, given, reason));
    }
    if !takes_numbers {
        let reason = format!("{key} takes no decimal numbers; give an axis of its values");
        return Err(refused(form, given, reason));
    }
    let what =
        if form == "normal" { "mean and standard deviation" } else { "the least and the largest" };
    let (pair, entries) = pair(form, given, what)?;
    let law = match form {
        "normal" if pair[1] <= 0.0 => {
            return Err(refused(form, given, "the standard deviation must be greater than zero"));
        }
        "normal" => Law::Normal(pair),
        _ if pair[0] >= pair[1] => {
            return Err(refused(form, given, "the first must be less than the second"));
        }
        "log_uniform" if pair[0] <= 0.0 => {
            return Err(refused(form, given, "both must be greater than zero; use uniform"));
        }
        "log_uniform" => Law::LogUniform(pair),
        _ if !(pair[1] - pair[0]).is_finite() => {
            return Err(refused(form, given, TOO_FAR_APART));
        }
        _ => Law::Uniform(pair),
    };
    // A normal draw that its key does not take is a run that fails: its tail ends nowhere.
    let ends = if form == "normal" { &entries[..1] } else { entries };
    for end in ends {
        variants.checked(i, end)?;
    }
    Ok(Draw { key: key.clone(), law })
}

fn random(table: &Table<'_>, keys: Vec<Draw>) -> Result<Random, SweepError> {
    if keys.is_empty() {
        return Err(table.incomplete("draws nothing; give [[random.key]]"));
    }
    let Some(samples) = table.whole("samples", 1, MOST_POINTS)? else {
        return Err(
            table.incomplete("has no \"samples\"; give the number of draws at each grid point")
        );
    };
    let seed = table.whole("seed", 0, i64::MAX as u64)?.unwrap_or(0);
    let sampling = match table.get("sampling") {
        None => Sampling::Random,
        Some(_) => {
            let (word, given) = table.word("sampling", "")?;
            let known = Sampling::WORDS.iter().find(|(own, _)| *own == word);
            let words = Sampling::WORDS.map(|(word, _)| word).join(", ");
            known.ok_or_else(|| refused("sampling", given, format!("one of {words} is wanted")))?.1
        }
    };
    // Each key of the design for Sobol indices has two dimensions of the sequence.
    let (most_keys, way_out) = match sampling {
        Sampling::Sobol => (MOST_SOBOL_KEYS, "; use latin_hypercube"),
        Sampling::Saltelli => (MOST_SOBOL_KEYS / 2, ""),
        _ => (usize::MAX, ""),
    };
    if most_keys < usize::MAX && (samples > MOST_SOBOL || keys.len() > most_keys) {
        let reason = format!(
            "a Sobol sequence has at most {MOST_SOBOL} samples of {most_keys} keys here{way_out}"
        );
        let given = table.get("samples").ok_or_else(|| table.incomplete("has no \"samples\""))?;
        return Err(refused("samples", given, reason));
    }
    Ok(Random { samples, seed, sampling, keys })
}

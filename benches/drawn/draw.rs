//! A configuration drawn at random: what a user may set, and how it is written.

use std::path::{Path, PathBuf};

use deltazero::config::{Config, ConfigError};
use deltazero::keys::{Curvature, DefaultValue, End, FrictionLaw, Key, Kind, Range, ReadingName};
use deltazero::laws::ContactLaw;
use deltazero::mechanisms::MECHANISMS;
use deltazero_text::ModelFile;
use deltazero_text::models::{MODELS, Model};

use super::random::Random;

/// Samples of a run.
const SAMPLES: f64 = 200.0;
/// A penetration that a stiffness is given for where the exponent is not one [m].
const DEPTH: f64 = 1e-5;

/// A number is drawn up to this many times its default, and down to as small a part of it.
const FARTHEST: f64 = 4.0;
/// Mechanisms that are drawn by hand, over all that joints may have.
const OF_JOINTS: [&str; 2] = ["strut", "slider-crank"];
/// Where the models are that come with the program.
const FOLDER: &str = "text/models";

/// Keys with their values as TOML, and the model that they are about, if it is one.
#[derive(Clone, Debug)]
pub(crate) struct Draw {
    model: Option<&'static Model>,
    keys: Vec<(String, String)>,
}

impl Draw {
    /// Draw `i` of a seed, of joints.
    pub(crate) fn new(seed: u64, i: u64) -> Self {
        let random = &mut Random::of_draw(seed, i);
        let mut draw = Self { model: None, keys: Vec::new() };
        let is_crank = random.chance(0.35);
        let mechanism = if is_crank { "slider-crank" } else { "strut" };
        draw.word("mechanism", mechanism);
        if is_crank {
            draw.slider_crank(random);
        } else {
            draw.struts(random);
        }
        draw
    }

    /// Draw `i` of a seed, of the other mechanisms and of the models that come with the program.
    pub(crate) fn of_another(seed: u64, i: u64) -> Self {
        let random = &mut Random::of_draw(seed, i);
        let mut draw = Self { model: None, keys: Vec::new() };
        let others = MECHANISMS.iter().filter(|entry| !OF_JOINTS.contains(&entry.name));
        let others: Vec<_> = others.collect();
        let n = others.len() + MODELS.len();
        let place = (random.uniform(0.0, n as f64) as usize).min(n - 1);
        if let Some(entry) = others.get(place) {
            draw.word("mechanism", entry.name);
            for key in entry.keys {
                draw.own_key(key, random);
            }
            if entry.uses.contains(&"contact") {
                draw.joint("", random, false);
                // Not all of them have friction.
                draw.keys.retain(|(key, _)| {
                    let table = key.split('.').next().unwrap_or(key);
                    table != "friction" || entry.uses.contains(&table)
                });
            }
        } else {
            let model = &MODELS[place - others.len()];
            draw.model = Some(model);
            draw.parameters(model, random);
        }
        // As long as it is by default, which is known once it is read.
        let t_end = draw.config().map_or(1.0, |config| config.run.t_end);
        draw.run(t_end * random.uniform(0.1, 1.0));
        draw
    }

    /// The same, of this part of its time.
    pub(crate) fn shortened(mut self, part: f64) -> Self {
        for (key, value) in &mut self.keys {
            if let ("run.t_end" | "run.sample", Ok(x)) = (key.as_str(), value.parse::<f64>()) {
                *value = format!("{:?}", part * x);
            }
        }
        self
    }

    /// The configuration.
    ///
    /// # Errors
    /// A draw that a user cannot write.
    pub(crate) fn config(&self) -> Result<Config, ConfigError> {
        let sets: Vec<_> = self.keys.iter().map(|(key, value)| format!("{key}={value}")).collect();
        Config::load_with(self.model_file().as_deref(), None, &sets)
    }

    /// The file of its model, if it is one.
    pub(crate) fn model_file(&self) -> Option<PathBuf> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(FOLDER);
        self.model.map(|model| folder.join(format!("{}.toml", model.name)))
    }

    /// The value of a key, as TOML; the model's name for `mechanism`, where it is one.
    pub(crate) fn get(&self, key: &str) -> Option<&str> {
        if let ("mechanism", Some(model)) = (key, self.model) {
            return Some(model.name);
        }
        self.keys.iter().find(|(own, _)| own == key).map(|(_, value)| value.as_str())
    }

    /// The file that `deltazero simulate` runs, under a comment.
    pub(crate) fn toml(&self, comment: &str) -> String {
        let mut text = String::new();
        for line in comment.lines() {
            text += &format!("# {line}\n");
        }
        if let Some(model) = self.model {
            text += &format!("# --model {FOLDER}/{}.toml\n", model.name);
        }
        let mut table = "";
        let (root, inside): (Vec<_>, Vec<_>) =
            self.keys.iter().partition(|(key, _)| !key.contains('.'));
        for (key, value) in root.into_iter().chain(inside) {
            let (own, name) = key.rsplit_once('.').unwrap_or(("", key));
            if own != table {
                text += &format!("[{own}]\n");
                table = own;
            }
            text += &format!("{name} = {value}\n");
        }
        text
    }

    fn set(&mut self, key: &str, value: impl ToString) {
        self.keys.push((key.to_owned(), value.to_string()));
    }

    fn number(&mut self, key: &str, value: f64) {
        self.set(key, format!("{value:?}"));
    }

    fn word(&mut self, key: &str, word: &str) {
        self.set(key, format!("{word:?}"));
    }

    fn struts(&mut self, random: &mut Random) {
        let bays = if random.chance(0.6) { 1 } else { random.of(&[2, 3, 4, 5]) };
        let reading = match bays {
            1 if random.chance(0.6) => random.of(&[ReadingName::Pin, ReadingName::Full]),
            1 => random.of(ReadingName::ALL),
            _ => ReadingName::Pin,
        };
        self.set("bays", bays);
        self.word("reading", reading.name());
        if random.chance(0.1) {
            self.number("strut.length", random.uniform(0.5, 4.0));
            self.number("strut.radius", random.log_uniform(2e-3, 2e-2));
            self.word("strut.inertia", random.of(&["axial", "transverse"]));
        }
        if random.chance(0.5) {
            self.number("drive.m1", random.uniform(-3.0, 3.0));
        }
        if random.chance(0.5) {
            self.number("drive.m4", random.uniform(-1.5, 1.5));
        }
        self.joint("", random, bays == 1);
        if random.chance(0.2) {
            self.joint("joint2.", random, bays == 1);
        }
        let long = random.chance(0.03);
        let t_end = if long { random.uniform(1.0, 4.0) } else { random.uniform(0.1, 0.5) };
        if random.chance(0.03) {
            self.set("run.stop_at_90", false);
        }
        self.run(t_end);
    }

    /// A key of a mechanism alone, where it is a number.
    fn own_key(&mut self, key: &Key, random: &mut Random) {
        if let (Kind::Number(range), DefaultValue::Toml(default)) = (key.kind, key.default)
            && let Ok(default) = default.parse()
            && let Some(x) = near(default, &range, random)
        {
            self.number(key.path, x);
        }
    }

    /// The parameters of a model.
    fn parameters(&mut self, model: &Model, random: &mut Random) {
        let Ok(file) = ModelFile::parse(model.name, model.text) else { return };
        for parameter in file.parameters() {
            let own = &parameter.range;
            let end = |closed: Option<f64>, open: Option<f64>| {
                closed.map(End::Closed).or(open.map(End::Open)).unwrap_or(End::Free)
            };
            let range = Range { low: end(own.min, own.above), high: end(own.max, own.below) };
            if let Some(x) = near(parameter.value, &range, random) {
                self.number(&parameter.name, x);
            }
        }
    }

    fn slider_crank(&mut self, random: &mut Random) {
        let mut t_end = random.uniform(0.02, 0.05);
        if random.chance(0.2) {
            let speed = random.log_uniform(50.0, 1000.0);
            self.number("slider_crank.crank_speed", speed);
            t_end *= 523.6 / speed;
        }
        if random.chance(0.2) {
            self.number("slider_crank.start_angle", random.uniform(0.0, 6.2));
        }
        if random.chance(0.1) {
            self.number("slider_crank.slider_mass", random.log_uniform(0.02, 2.0));
            self.number("slider_crank.rod_mass", random.log_uniform(0.02, 2.0));
        }
        self.joint("", random, true);
        self.run(t_end);
    }

    fn run(&mut self, t_end: f64) {
        self.number("run.t_end", t_end);
        self.number("run.sample", t_end / SAMPLES);
        self.word("solver.method", "vern98");
        self.number("solver.rtol", 1e-12);
    }

    /// The three tables of a joint; `prefix` is that of one joint, or empty.
    fn joint(&mut self, prefix: &str, random: &mut Random, may_be_ideal: bool) {
        let friction = random.of(FrictionLaw::ALL);
        let clearance = match random.uniform(0.0, 1.0) {
            x if x < 0.02 && may_be_ideal && friction != FrictionLaw::Lugre => 0.0,
            x if x < 0.12 => random.log_uniform(1e-5, 1e-3),
            _ => random.log_uniform(1e-5, 4e-4),
        };
        self.number(&format!("{prefix}joint.clearance"), clearance);
        if random.chance(0.1) {
            self.number(&format!("{prefix}joint.pin_radius"), random.log_uniform(2e-3, 2e-2));
        }
        self.contact(&format!("{prefix}contact"), random);
        self.friction(&format!("{prefix}friction"), random, friction);
    }

    fn contact(&mut self, table: &str, random: &mut Random) {
        let exponent = match random.of(&[0, 0, 1, 2, 3]) {
            0 => 1.0,
            1 => 1.5,
            2 => 2.0,
            _ => random.uniform(1.0, 2.5),
        };
        // As stiff at `DEPTH` as a linear one, or by the number alone.
        let as_linear = if random.chance(0.5) { DEPTH.powf(1.0 - exponent) } else { 1.0 };
        let restitution = match random.uniform(0.0, 1.0) {
            x if x < 0.25 => 0.9,
            x if x < 0.30 => 1.0,
            _ => random.uniform(0.05, 1.0),
        };
        let damping = if random.chance(0.4) { 0.0 } else { random.log_uniform(1.0, 1e4) };
        self.word(&format!("{table}.law"), random.of(ContactLaw::WORDS));
        self.number(&format!("{table}.stiffness"), as_linear * random.log_uniform(1e5, 1e10));
        self.number(&format!("{table}.damping"), damping);
        self.number(&format!("{table}.exponent"), exponent);
        self.set(&format!("{table}.adhesion"), random.chance(0.5));
        self.number(&format!("{table}.restitution"), restitution);
        self.number(&format!("{table}.young_modulus"), random.log_uniform(2e9, 3e11));
        self.number(&format!("{table}.length"), random.uniform(5e-3, 5e-2));
        self.word(&format!("{table}.curvature"), random.of(Curvature::ALL).name());
        if random.chance(0.1) {
            let floor = random.log_uniform(1e-8, 1e-3);
            self.number(&format!("{table}.impact_speed_floor"), floor);
            self.number(&format!("{table}.poisson_ratio"), random.uniform(-0.5, 0.5));
        }
    }

    fn friction(&mut self, table: &str, random: &mut Random, law: FrictionLaw) {
        let coefficient = match random.uniform(0.0, 1.0) {
            x if x < 0.05 && law != FrictionLaw::Lugre => 0.0,
            x if x < 0.30 => 0.1,
            _ => random.uniform(0.01, 0.9),
        };
        self.word(&format!("{table}.law"), law.name());
        self.number(&format!("{table}.coefficient"), coefficient);
        self.number(&format!("{table}.static_coefficient"), random.uniform(0.02, 1.0));
        self.number(&format!("{table}.stribeck_speed"), random.log_uniform(1e-4, 0.1));
        self.number(&format!("{table}.regularisation_speed"), random.log_uniform(1e-5, 1e-2));
        self.number(&format!("{table}.bristle_stiffness"), random.log_uniform(1e4, 1e6));
        if random.chance(0.3) {
            self.number(&format!("{table}.dead_ratio"), random.uniform(0.01, 0.99));
            let damping = if random.chance(0.3) { 0.0 } else { random.log_uniform(0.1, 100.0) };
            self.number(&format!("{table}.bristle_damping"), damping);
            self.number(&format!("{table}.viscosity"), random.log_uniform(1e-3, 1.0));
        }
    }
}

/// A number near its default, or at an end of its range; none where the default stays.
fn near(default: f64, range: &Range, random: &mut Random) -> Option<f64> {
    if random.chance(0.4) {
        return None;
    }
    let ends = [range.low, range.high].into_iter().filter_map(|end| match end {
        End::Closed(bound) => Some(bound),
        End::Open(_) | End::Free => None,
    });
    let ends: Vec<f64> = ends.collect();
    let x = if !ends.is_empty() && random.chance(0.1) {
        random.of(&ends)
    } else if default.fract() == 0.0 && default.abs() > 2.0 && random.chance(0.3) {
        // Where only whole numbers make sense.
        (default * random.log_uniform(1.0 / FARTHEST, FARTHEST)).round()
    } else {
        default * random.log_uniform(1.0 / FARTHEST, FARTHEST)
    };
    range.contains(x).then_some(x)
}

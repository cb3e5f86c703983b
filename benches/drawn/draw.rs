//! A configuration drawn at random: what a user may set, and how it is written.

use deltazero::config::{Config, ConfigError};
use deltazero::keys::{ContactLaw, Curvature, FrictionLaw, ReadingName};

use super::random::Random;

/// Samples of a run.
const SAMPLES: f64 = 200.0;
/// A penetration that a stiffness is given for where the exponent is not one [m].
const DEPTH: f64 = 1e-5;

/// Keys with their values as TOML.
#[derive(Clone, Debug)]
pub(crate) struct Draw {
    keys: Vec<(String, String)>,
}

impl Draw {
    /// Draw `i` of a seed.
    pub(crate) fn new(seed: u64, i: u64) -> Self {
        let random = &mut Random::of_draw(seed, i);
        let mut draw = Self { keys: Vec::new() };
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
        Config::load(None, &sets)
    }

    /// The value of a key, as TOML.
    pub(crate) fn get(&self, key: &str) -> Option<&str> {
        self.keys.iter().find(|(own, _)| own == key).map(|(_, value)| value.as_str())
    }

    /// The file that `deltazero simulate` runs, under a comment.
    pub(crate) fn toml(&self, comment: &str) -> String {
        let mut text = String::new();
        for line in comment.lines() {
            text += &format!("# {line}\n");
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
        self.word(&format!("{table}.law"), random.of(ContactLaw::ALL).name());
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

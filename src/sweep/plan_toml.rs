//! A plan as a file again, from which the same plan is read.

use std::fmt::Write as _;

use super::draw::{Law, Sampling};
use super::plan::{Axis, Plan, Random, Values};

impl Plan {
    /// It as the file of a plan that varies the configuration in the file `config` beside it.
    pub fn to_toml(&self, config: &str) -> String {
        let mut text = format!("config = \"{config}\"\nchunk = {}\n", self.chunk);
        if !self.audit {
            text += "audit = false\n";
        }
        if self.check > 0.0 {
            let _ = writeln!(text, "check = {}", shortest(self.check));
        }
        self.axes.iter().for_each(|axis| write_axis(&mut text, axis));
        if let Some(random) = &self.random {
            write_random(&mut text, random);
        }
        text
    }
}

fn write_axis(text: &mut String, Axis { key, values }: &Axis) {
    let _ = writeln!(text, "\n[[axis]]\nkey = {}", quoted(key));
    let _ = match values {
        // JSON's numbers, words and lists are TOML's too.
        Values::List(all) => writeln!(text, "values = {}", serde_json::Value::from(all.clone())),
        Values::Linear { ends, points, .. } => {
            writeln!(text, "linear = {}\npoints = {points}", pair(*ends))
        }
        Values::Log { ends, points, .. } => {
            writeln!(text, "log = {}\npoints = {points}", pair(*ends))
        }
    };
}

fn write_random(text: &mut String, Random { samples, seed, sampling, keys }: &Random) {
    let _ = writeln!(
        text,
        "\n[random]\nsamples = {samples}\nseed = {seed}\nsampling = \"{}\"",
        sampling.word()
    );
    for draw in keys {
        let (law, numbers) = match draw.law {
            Law::Uniform(ends) => ("uniform", ends),
            Law::LogUniform(ends) => ("log_uniform", ends),
            Law::Normal(numbers) => ("normal", numbers),
        };
        let key = quoted(&draw.key);
        let _ = writeln!(text, "\n[[random.key]]\nkey = {key}\n{law} = {}", pair(numbers));
    }
}

impl Sampling {
    /// The word for it.
    pub fn word(self) -> &'static str {
        let own = Self::WORDS.iter().find(|(_, sampling)| *sampling == self);
        own.map_or("", |(word, _)| word)
    }
}

/// A word as a string of TOML.
fn quoted(word: &str) -> String {
    serde_json::Value::from(word).to_string()
}

fn pair(numbers: [f64; 2]) -> String {
    format!("[{}]", numbers.map(shortest).join(", "))
}

/// The shorter of the two forms of a number that read back to the same bits.
pub fn shortest(x: f64) -> String {
    let (plain, scientific) = (x.to_string(), format!("{x:e}"));
    if plain.len() <= scientific.len() { plain } else { scientific }
}

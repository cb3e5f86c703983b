//! Machine code of a tape, for numbers `f64`.
//!
//! Its operations are those of the [tape](crate::tape) in the same order, so it gives the same bits. Where none can be made, as on
//! a processor that the code generator does not know, the tape runs.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use deltazero_machine::{Error, Function, Number, Routine, Shape};

use crate::functions::Elementary;
use crate::tape::{Input, Inputs, Instruction, Output, Tape};

/// Operations of a tape above which no code is made of it: a user would wait for it.
const MOST_OPERATIONS: usize = 20_000;
/// Runs of a tape before code is made of it. That takes 0.1 ms and some 15 µs for each operation, which then takes some 2 ns less; a
/// sweep may have fewer runs of each model than pay for it.
const RUNS: usize = 10_000;

/// The machine code of a tape, once it has run often.
#[derive(Debug, Default)]
pub(crate) struct Machine {
    runs: AtomicUsize,
    code: OnceLock<Option<Code>>,
}

/// A routine for the first part, and one for both parts where there are two.
#[derive(Debug)]
struct Code {
    first: Routine,
    both: Option<Routine>,
}

impl Machine {
    /// Runs the code of `tape`, if there is such; it is made when it is asked for often.
    #[inline]
    pub(crate) fn run(
        &self,
        tape: &Tape,
        inputs: &Inputs<'_, f64>,
        first: &mut [f64],
        second: Option<&mut [f64]>,
    ) -> bool {
        let code = match self.code.get() {
            Some(code) => code.as_ref(),
            None => self.count(tape),
        };
        code.is_some_and(|code| {
            code.run(inputs, first, second);
            true
        })
    }

    /// Counts a run; those of two threads at the same time may count as one.
    #[inline(never)]
    fn count(&self, tape: &Tape) -> Option<&Code> {
        let n = self.runs.load(Ordering::Relaxed) + 1;
        self.runs.store(n, Ordering::Relaxed);
        if n <= RUNS {
            return None;
        }
        self.code.get_or_init(|| Code::of(tape)).as_ref()
    }
}

impl Code {
    fn of(tape: &Tape) -> Option<Self> {
        let n = tape.first.len() + tape.second.len();
        if (1..=MOST_OPERATIONS).contains(&n) { Self::made_of(tape).ok() } else { None }
    }

    fn made_of(tape: &Tape) -> Result<Self, Error> {
        let routine = |with_second| {
            let write = |f: &mut Function<'_>| Writer::new(f, tape).write(tape, with_second);
            Routine::new(tape.shape(with_second), write)
        };
        let has_second = !tape.second_outputs.is_empty();
        let both = if has_second { Some(routine(true)?) } else { None };
        Ok(Self { first: routine(false)?, both })
    }

    #[inline]
    fn run(&self, inputs: &Inputs<'_, f64>, first: &mut [f64], second: Option<&mut [f64]>) {
        match (second, &self.both) {
            (Some(second), Some(both)) => {
                both.call(inputs.t, inputs.y, inputs.held, first, second);
            }
            _ => self.first.call(inputs.t, inputs.y, inputs.held, first, &mut []),
        }
    }
}

impl Tape {
    fn shape(&self, with_second: bool) -> Shape {
        let places = |of: fn(&Input) -> Option<usize>| {
            let most = self.inputs.iter().filter_map(|(_, input)| of(input)).max();
            most.map_or(0, |most| most + 1)
        };
        Shape {
            n_states: places(|input| match input {
                Input::State(i) => Some(*i as usize),
                _ => None,
            }),
            n_held: places(|input| match input {
                Input::Held(i) => Some(usize::from(*i)),
                _ => None,
            }),
            n_first: self.first_outputs.len(),
            n_second: if with_second { self.second_outputs.len() } else { 0 },
        }
    }
}

/// Describes to a function what a tape does.
struct Writer<'f, 'a> {
    function: &'f mut Function<'a>,
    registers: Vec<Number>,
}

impl<'f, 'a> Writer<'f, 'a> {
    fn new(function: &'f mut Function<'a>, tape: &Tape) -> Self {
        let time = function.time();
        Self { registers: vec![time; tape.n_registers], function }
    }

    fn write(mut self, tape: &Tape, with_second: bool) {
        for (register, input) in &tape.inputs {
            let number = match input {
                Input::Time => self.function.time(),
                Input::State(i) => self.function.state(*i as usize),
                Input::Held(i) => self.function.held(usize::from(*i)),
            };
            self.registers[*register as usize] = number;
        }
        tape.first.iter().for_each(|instruction| self.instruction(*instruction));
        for (i, output) in tape.first_outputs.iter().enumerate() {
            let result = self.output(output);
            self.function.write_first(i, result);
        }
        if with_second {
            tape.second.iter().for_each(|instruction| self.instruction(*instruction));
            for (i, output) in tape.second_outputs.iter().enumerate() {
                let result = self.output(output);
                self.function.write_second(i, result);
            }
        }
    }

    fn output(&mut self, output: &Output) -> Number {
        match output {
            Output::Register(register) => self.at(*register),
            Output::Constant(c) => self.function.constant(*c),
        }
    }

    fn at(&self, register: u32) -> Number {
        self.registers[register as usize]
    }

    fn instruction(&mut self, instruction: Instruction) {
        let (to, result) = match instruction {
            Instruction::Add { to, a, b } => (to, self.function.add(self.at(a), self.at(b))),
            Instruction::Subtract { to, a, b } => {
                (to, self.function.subtract(self.at(a), self.at(b)))
            }
            Instruction::Multiply { to, a, b } => {
                (to, self.function.multiply(self.at(a), self.at(b)))
            }
            Instruction::Divide { to, a, b } => (to, self.function.divide(self.at(a), self.at(b))),
            Instruction::AddConstant { to, a, c } => {
                let c = self.function.constant(c);
                (to, self.function.add(self.at(a), c))
            }
            Instruction::ConstantLess { to, a, c } => {
                let c = self.function.constant(c);
                (to, self.function.subtract(c, self.at(a)))
            }
            Instruction::MultiplyConstant { to, a, c } => {
                let c = self.function.constant(c);
                (to, self.function.multiply(self.at(a), c))
            }
            Instruction::DivideConstant { to, a, c } => {
                let c = self.function.constant(c);
                (to, self.function.divide(self.at(a), c))
            }
            Instruction::ConstantOver { to, a, c } => {
                let c = self.function.constant(c);
                (to, self.function.divide(c, self.at(a)))
            }
            Instruction::Constant { to, c } => (to, self.function.constant(c)),
            Instruction::Negative { to, a } => (to, self.function.negative(self.at(a))),
            Instruction::SinCos { sin, cos, a } => {
                let [sine, cosine] = self.function.call_for_two(outside::sin_cos, self.at(a));
                self.registers[sin as usize] = sine;
                (cos, cosine)
            }
            Instruction::Elementary { to, a, function } => {
                (to, self.elementary(function, self.at(a)))
            }
            Instruction::ArcTangent { to, y, x } => {
                (to, self.function.call_of_two(outside::arc_tangent, [self.at(y), self.at(x)]))
            }
            Instruction::Smaller { to, a, b } => {
                let (a, b) = (self.at(a), self.at(b));
                let smaller = self.function.if_less([b, a], b, a);
                (to, self.function.if_number(b, smaller, b))
            }
            Instruction::Larger { to, a, b } => {
                let (a, b) = (self.at(a), self.at(b));
                let larger = self.function.if_less([a, b], b, a);
                (to, self.function.if_number(b, larger, b))
            }
            Instruction::Power { to, a, p } => {
                let p = self.function.constant(p);
                (to, self.function.call_of_two(outside::power, [self.at(a), p]))
            }
        };
        self.registers[to as usize] = result;
    }

    fn elementary(&mut self, function: Elementary, a: Number) -> Number {
        match function {
            Elementary::Sqrt | Elementary::Norm => self.function.sqrt(a),
            Elementary::Abs => self.function.absolute(a),
            Elementary::Sign => {
                let [zero, one, less] = [0.0, 1.0, -1.0].map(|c| self.function.constant(c));
                let not_above = self.function.if_less([a, zero], less, a);
                self.function.if_less([zero, a], one, not_above)
            }
            Elementary::Sin => self.function.call(outside::sin, a),
            Elementary::Cos => self.function.call(outside::cos, a),
            Elementary::Exp => self.function.call(outside::exp, a),
            Elementary::Ln => self.function.call(outside::ln, a),
            Elementary::Log10 => self.function.call(outside::log10, a),
            Elementary::Sinh => self.function.call(outside::sinh, a),
            Elementary::Cosh => self.function.call(outside::cosh, a),
            Elementary::Tanh => self.function.call(outside::tanh, a),
        }
    }
}

/// The functions that the code calls.
mod outside {
    use deltazero_solvers::Real;

    use crate::functions::{self, Elementary};

    macro_rules! elementary {
        ($($name:ident = $function:ident),*) => {
            $(pub(super) extern "C" fn $name(x: f64) -> f64 {
                Elementary::$function.of(x)
            })*
        };
    }

    elementary!(
        sin = Sin,
        cos = Cos,
        exp = Exp,
        ln = Ln,
        log10 = Log10,
        sinh = Sinh,
        cosh = Cosh,
        tanh = Tanh
    );

    pub(super) extern "C" fn sin_cos(x: f64, both: &mut [f64; 2]) {
        *both = Real::sin_cos(x).into();
    }

    pub(super) extern "C" fn power(x: f64, p: f64) -> f64 {
        functions::power(x, p)
    }

    pub(super) extern "C" fn arc_tangent(y: f64, x: f64) -> f64 {
        Real::atan2(y, x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ModelFile;
    use crate::models::MODELS;

    /// Formulas of every operation, each alone.
    const EVERY: [&str; 27] = [
        "x + y",
        "x - y",
        "x*y",
        "x/y",
        "x + 3",
        "3 - x",
        "x*3",
        "x/3",
        "3/x",
        "-x",
        "sqrt(x)",
        "sin(x)",
        "cos(y)",
        "sin(y)*x + cos(y)",
        "exp(x)",
        "log(x)",
        "log10(x)",
        "sinh(x)",
        "cosh(x)",
        "tanh(x)",
        "abs(x)",
        "sign(x)",
        "atan2(x, y)",
        "min(x, y)",
        "max(x, y)",
        "x^1.5",
        "hypot(x, y)",
    ];
    const SPECIAL: [f64; 6] = [0.0, -0.0, 1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];

    /// Whether two numbers are the same, or both none.
    fn is_same(a: f64, b: f64) -> bool {
        a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
    }

    /// Compares what machine code and tape give, at states of all sizes.
    fn compare(name: &str, tape: &Tape, n_states: usize, random: &mut fastrand::Rng) {
        let code = Code::made_of(tape).unwrap();
        for _ in 0..200 {
            let mut number = || match random.usize(..8) {
                0 => *random.choice(&SPECIAL).unwrap_or(&0.0),
                _ => (random.f64() - 0.5) * 10.0_f64.powi(random.i32(-6..3)),
            };
            let y: Vec<f64> = (0..n_states).map(|_| number()).collect();
            let held: [f64; 8] = std::array::from_fn(|_| number());
            let inputs = Inputs { t: number().abs(), y: &y, held: &held };
            let [n_first, n_second] = [&tape.first_outputs, &tape.second_outputs].map(Vec::len);
            let [mut first, mut own_first, mut alone] = [(); 3].map(|()| vec![0.0; n_first]);
            let [mut second, mut own_second] = [(); 2].map(|()| vec![0.0; n_second]);
            tape.interpret(&inputs, &mut first, Some(&mut second));
            code.run(&inputs, &mut own_first, Some(&mut own_second));
            code.run(&inputs, &mut alone, None);
            let expected = first.iter().chain(&second).chain(&first);
            let own = own_first.iter().chain(&own_second).chain(&alone);
            for (i, (a, b)) in expected.zip(own).enumerate() {
                assert!(is_same(*a, *b), "{name}: result {i} is {a:e} and {b:e} at {inputs:?}");
            }
        }
    }

    #[test]
    fn code_has_the_bits_of_the_tape() {
        let mut random = fastrand::Rng::with_seed(7);
        let every = EVERY.iter().enumerate();
        let states: String = every.clone().map(|(i, _)| format!("s{i} = 1\n")).collect();
        let rates: String = every.map(|(i, formula)| format!("s{i} = \"{formula}\"\n")).collect();
        let every = format!(
            "[states]\nx = 1\ny = 2\n{states}[rates]\nx = 0\ny = 0\n{rates}[modes.only]\n\
             events = [{{ when = \"x + y > 3\", to = \"only\" }}, {{ when = \"hypot(x, y) < t\", to = \"only\" }}]"
        );
        let files = MODELS.iter().map(|model| (model.name, model.text));
        for (name, text) in files.chain([("every operation", &*every)]) {
            let file = ModelFile::parse(name, text).unwrap_or_else(|report| panic!("{report}"));
            for model in file.models(&[]).unwrap() {
                for mode in &model.0.modes {
                    let jacobian = mode.jacobian.iter().map(|jacobian| &jacobian.program);
                    for program in [&mode.program, &mode.guards].into_iter().chain(jacobian) {
                        compare(name, &program.tape, model.0.starts.len(), &mut random);
                    }
                }
            }
        }
    }

    #[test]
    fn code_is_made_after_many_runs() {
        let text = "[states]\nx = 1\n[modes.a]\nrates = { x = \"-x^3\" }\n";
        let model = ModelFile::parse("rate.toml", text).unwrap().models(&[]).unwrap().remove(0);
        let program = &model.0.modes[0].program;
        for i in 0..RUNS + 10 {
            let (y, mut rate) = ([1.0 + i as f64], [0.0]);
            program.run(&Inputs { t: 0.0, y: &y, held: &[] }, &mut rate);
            assert_eq!(rate, [-(y[0] * y[0] * y[0])]);
            assert_eq!(program.machine.code.get().is_some(), i >= RUNS, "{i}");
        }
    }
}

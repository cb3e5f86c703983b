//! Runs a tape with any kind of number.

use deltazero_solvers::Real;

use crate::functions::power;
use crate::tape::{Input, Inputs, Instruction, Output, Tape};

impl Tape {
    /// A small tape has its registers on the stack.
    // Not inlined where there is machine code: its stack would be made for that, too.
    #[cfg_attr(feature = "machine-code", inline(never))]
    #[cfg_attr(not(feature = "machine-code"), inline)]
    pub(crate) fn interpret<S: Real>(
        &self,
        inputs: &Inputs<'_, S>,
        first: &mut [S],
        second: Option<&mut [S]>,
    ) {
        let zero = S::cst(0.0);
        match self.n_registers {
            0..=4 => self.run_with(&mut Few([zero; 4]), inputs, first, second),
            5..=8 => self.run_with(&mut Few([zero; 8]), inputs, first, second),
            9..=16 => self.run_with(&mut Few([zero; 16]), inputs, first, second),
            17..=64 => self.run_with(&mut Few([zero; 64]), inputs, first, second),
            n => self.run_with(&mut Many(vec![zero; n]), inputs, first, second),
        }
    }

    fn run_with<S: Real, R: Registers<S>>(
        &self,
        registers: &mut R,
        inputs: &Inputs<'_, S>,
        first: &mut [S],
        second: Option<&mut [S]>,
    ) {
        for (register, input) in &self.inputs {
            let value = match input {
                Input::Time => inputs.t,
                Input::State(i) => inputs.y[*i as usize],
                Input::Held(i) => S::cst(inputs.held[usize::from(*i)]),
            };
            registers.set(*register, value);
        }
        execute(&self.first, registers);
        write(&self.first_outputs, registers, first);
        if let Some(second) = second {
            execute(&self.second, registers);
            write(&self.second_outputs, registers, second);
        }
    }
}

/// The registers of a run.
trait Registers<S> {
    fn at(&self, register: u32) -> S;
    fn set(&mut self, register: u32, value: S);
}

/// Registers whose number is a power of two: an index that is cut to it needs no check.
struct Few<S, const N: usize>([S; N]);

impl<S: Copy, const N: usize> Registers<S> for Few<S, N> {
    #[inline(always)]
    fn at(&self, register: u32) -> S {
        self.0[register as usize & (N - 1)]
    }

    #[inline(always)]
    fn set(&mut self, register: u32, value: S) {
        self.0[register as usize & (N - 1)] = value;
    }
}

struct Many<S>(Vec<S>);

impl<S: Copy> Registers<S> for Many<S> {
    #[inline(always)]
    fn at(&self, register: u32) -> S {
        self.0[register as usize]
    }

    #[inline(always)]
    fn set(&mut self, register: u32, value: S) {
        self.0[register as usize] = value;
    }
}

#[inline(always)]
fn execute<S: Real, R: Registers<S>>(instructions: &[Instruction], r: &mut R) {
    for instruction in instructions {
        match *instruction {
            Instruction::Add { to, a, b } => r.set(to, r.at(a) + r.at(b)),
            Instruction::Subtract { to, a, b } => r.set(to, r.at(a) - r.at(b)),
            Instruction::Multiply { to, a, b } => r.set(to, r.at(a) * r.at(b)),
            Instruction::Divide { to, a, b } => r.set(to, r.at(a) / r.at(b)),
            Instruction::AddConstant { to, a, c } => r.set(to, r.at(a) + c),
            Instruction::ConstantLess { to, a, c } => r.set(to, S::cst(c) - r.at(a)),
            Instruction::MultiplyConstant { to, a, c } => r.set(to, r.at(a) * c),
            Instruction::DivideConstant { to, a, c } => r.set(to, r.at(a) / c),
            Instruction::ConstantOver { to, a, c } => r.set(to, S::cst(c) / r.at(a)),
            Instruction::Constant { to, c } => r.set(to, S::cst(c)),
            Instruction::Negative { to, a } => r.set(to, -r.at(a)),
            Instruction::SinCos { sin, cos, a } => {
                let (s, c) = r.at(a).sin_cos();
                r.set(sin, s);
                r.set(cos, c);
            }
            Instruction::Elementary { to, a, function } => r.set(to, function.of(r.at(a))),
            Instruction::ArcTangent { to, y, x } => r.set(to, r.at(y).atan2(r.at(x))),
            Instruction::Smaller { to, a, b } => r.set(to, r.at(a).min(r.at(b))),
            Instruction::Larger { to, a, b } => r.set(to, r.at(a).max(r.at(b))),
            Instruction::Power { to, a, p } => r.set(to, power(r.at(a), p)),
        }
    }
}

#[inline(always)]
fn write<S: Real, R: Registers<S>>(outputs: &[Output], registers: &R, to: &mut [S]) {
    for (output, to) in outputs.iter().zip(to) {
        *to = match output {
            Output::Register(register) => registers.at(*register),
            Output::Constant(c) => S::cst(*c),
        };
    }
}

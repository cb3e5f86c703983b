//! A function, described operation by operation.

use cranelift_codegen::ir::condcodes::FloatCC;
use cranelift_codegen::ir::types::F64;
use cranelift_codegen::ir::{
    AbiParam, InstBuilder, MemFlags, SigRef, Signature, StackSlot, StackSlotData, StackSlotKind,
    Type, Value,
};
use cranelift_frontend::FunctionBuilder;

/// Lengths of what a function reads and writes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shape {
    /// Of the states.
    pub n_states: usize,
    /// Of the held values.
    pub n_held: usize,
    /// Of its first results.
    pub n_first: usize,
    /// Of its second results.
    pub n_second: usize,
}

/// A number of a function: one that it reads, or has computed. It has no meaning in another function, which refuses it or takes it
/// for a number of its own.
#[derive(Clone, Copy, Debug)]
pub struct Number(Value);

/// A function that is being described. It reads the time, states and held values, and writes two lists of results.
///
/// # Panics
/// Places beyond the [`Shape`] are a caller's mistake: each method that takes one panics there.
pub struct Function<'a> {
    builder: FunctionBuilder<'a>,
    shape: Shape,
    pointer: Type,
    /// Time, and where the four lists begin.
    parameters: [Value; 5],
    /// Of a call that returns a number, by how many numbers it takes, and of one that writes two.
    signatures: [Option<SigRef>; 3],
    /// Where calls write two numbers.
    pair: Option<StackSlot>,
}

impl<'a> Function<'a> {
    /// One that does nothing yet; its five parameters are those of a [`Routine`](crate::Routine).
    pub(crate) fn new(mut builder: FunctionBuilder<'a>, shape: Shape, pointer: Type) -> Self {
        let block = builder.create_block();
        builder.append_block_params_for_function_params(block);
        builder.switch_to_block(block);
        builder.seal_block(block);
        let parameters = std::array::from_fn(|i| builder.block_params(block)[i]);
        Self { builder, shape, pointer, parameters, signatures: [None; 3], pair: None }
    }

    pub(crate) fn end(mut self) {
        self.builder.ins().return_(&[]);
        self.builder.finalize();
    }

    /// The time.
    pub fn time(&mut self) -> Number {
        Number(self.parameters[0])
    }

    /// State `i`.
    pub fn state(&mut self, i: usize) -> Number {
        assert!(i < self.shape.n_states, "there are {} states", self.shape.n_states);
        self.load(self.parameters[1], i)
    }

    /// Held value `i`.
    pub fn held(&mut self, i: usize) -> Number {
        assert!(i < self.shape.n_held, "there are {} held values", self.shape.n_held);
        self.load(self.parameters[2], i)
    }

    /// Writes the first result `i`.
    pub fn write_first(&mut self, i: usize, result: Number) {
        assert!(i < self.shape.n_first, "there are {} first results", self.shape.n_first);
        self.store(self.parameters[3], i, result);
    }

    /// Writes the second result `i`.
    pub fn write_second(&mut self, i: usize, result: Number) {
        assert!(i < self.shape.n_second, "there are {} second results", self.shape.n_second);
        self.store(self.parameters[4], i, result);
    }

    fn load(&mut self, list: Value, i: usize) -> Number {
        Number(self.builder.ins().load(F64, MemFlags::trusted(), list, offset(i)))
    }

    fn store(&mut self, list: Value, i: usize, number: Number) {
        self.builder.ins().store(MemFlags::trusted(), number.0, list, offset(i));
    }

    /// The constant `c`.
    pub fn constant(&mut self, c: f64) -> Number {
        Number(self.builder.ins().f64const(c))
    }

    /// `a + b`
    pub fn add(&mut self, a: Number, b: Number) -> Number {
        Number(self.builder.ins().fadd(a.0, b.0))
    }

    /// `a − b`
    pub fn subtract(&mut self, a: Number, b: Number) -> Number {
        Number(self.builder.ins().fsub(a.0, b.0))
    }

    /// `a b`
    pub fn multiply(&mut self, a: Number, b: Number) -> Number {
        Number(self.builder.ins().fmul(a.0, b.0))
    }

    /// `a/b`
    pub fn divide(&mut self, a: Number, b: Number) -> Number {
        Number(self.builder.ins().fdiv(a.0, b.0))
    }

    /// `−a`
    pub fn negative(&mut self, a: Number) -> Number {
        Number(self.builder.ins().fneg(a.0))
    }

    /// `|a|`.
    pub fn absolute(&mut self, a: Number) -> Number {
        Number(self.builder.ins().fabs(a.0))
    }

    /// `√a`
    pub fn sqrt(&mut self, a: Number) -> Number {
        Number(self.builder.ins().sqrt(a.0))
    }

    /// `then` where `a < b`, else `otherwise`, as where one of them is no number.
    pub fn if_less(&mut self, [a, b]: [Number; 2], then: Number, otherwise: Number) -> Number {
        let is_less = self.builder.ins().fcmp(FloatCC::LessThan, a.0, b.0);
        Number(self.builder.ins().select(is_less, then.0, otherwise.0))
    }

    /// `then` where `a` is a number, else `otherwise`.
    pub fn if_number(&mut self, a: Number, then: Number, otherwise: Number) -> Number {
        let is_number = self.builder.ins().fcmp(FloatCC::Ordered, a.0, a.0);
        Number(self.builder.ins().select(is_number, then.0, otherwise.0))
    }

    /// `f(a)`
    pub fn call(&mut self, f: extern "C" fn(f64) -> f64, a: Number) -> Number {
        self.call_at(f as usize, &[a])
    }

    /// `f(a, b)`
    pub fn call_of_two(
        &mut self,
        f: extern "C" fn(f64, f64) -> f64,
        [a, b]: [Number; 2],
    ) -> Number {
        self.call_at(f as usize, &[a, b])
    }

    /// The two numbers that `f(a)` writes.
    pub fn call_for_two(&mut self, f: extern "C" fn(f64, &mut [f64; 2]), a: Number) -> [Number; 2] {
        let slot = *self.pair.get_or_insert_with(|| {
            let slot = StackSlotData::new(StackSlotKind::ExplicitSlot, 16, 3);
            self.builder.create_sized_stack_slot(slot)
        });
        // The called function is given numbers, not memory that was never written.
        let zero = self.builder.ins().f64const(0.0);
        for at in [0, 8] {
            self.builder.ins().stack_store(zero, slot, at);
        }
        let results = self.builder.ins().stack_addr(self.pointer, slot, 0);
        let signature = self.signature(2, vec![AbiParam::new(F64), AbiParam::new(self.pointer)], 0);
        self.call_indirect(signature, f as usize, &[a.0, results]);
        [0, 8].map(|at| Number(self.builder.ins().stack_load(F64, slot, at)))
    }

    fn call_at(&mut self, address: usize, arguments: &[Number]) -> Number {
        let n = arguments.len();
        let signature = self.signature(n - 1, vec![AbiParam::new(F64); n], 1);
        let arguments: Vec<Value> = arguments.iter().map(|number| number.0).collect();
        let call = self.call_indirect(signature, address, &arguments);
        Number(self.builder.inst_results(call)[0])
    }

    fn call_indirect(
        &mut self,
        signature: SigRef,
        address: usize,
        arguments: &[Value],
    ) -> cranelift_codegen::ir::Inst {
        let address = self.builder.ins().iconst(self.pointer, address as i64);
        self.builder.ins().call_indirect(signature, address, arguments)
    }

    fn signature(&mut self, which: usize, params: Vec<AbiParam>, n_results: usize) -> SigRef {
        let builder = &mut self.builder;
        *self.signatures[which].get_or_insert_with(|| {
            let call_conv = builder.func.signature.call_conv;
            let returns = vec![AbiParam::new(F64); n_results];
            builder.import_signature(Signature { params, returns, call_conv })
        })
    }
}

/// The longest list whose places an instruction can name.
pub(crate) const LONGEST: usize = i32::MAX as usize / size_of::<f64>();

/// Where number `i` of a list is, after its beginning; `i` is below [`LONGEST`].
fn offset(i: usize) -> i32 {
    (i * size_of::<f64>()) as i32
}

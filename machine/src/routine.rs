//! A routine and its memory.
#![allow(
    unsafe_code,
    reason = "the one place of it: memory that was just written is called as a function"
)]

use std::fmt;
use std::sync::Mutex;

use cranelift_codegen::ir::AbiParam;
use cranelift_codegen::ir::types::F64;
use cranelift_codegen::isa::OwnedTargetIsa;
use cranelift_codegen::settings::{self, Configurable};
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use cranelift_jit::{JITBuilder, JITModule};
use cranelift_module::{Module, default_libcall_names};

use crate::Error;
use crate::function::{Function, LONGEST, Shape};

/// A routine as the processor sees it: time, states, held values, first and second results.
type Entry = unsafe extern "C" fn(f64, *const f64, *const f64, *mut f64, *mut f64);

/// A function as machine code.
pub struct Routine {
    entry: Entry,
    shape: Shape,
    /// Owns the memory that `entry` points into; it is taken where that is released.
    module: Mutex<Option<JITModule>>,
}

impl Routine {
    /// The function that `describe` describes.
    ///
    /// # Errors
    /// A list that is too long, a processor that no code can be made for, a function that the code generator refuses, as one that
    /// is too long for it, or memory that may not be made executable.
    pub fn new(shape: Shape, describe: impl FnOnce(&mut Function<'_>)) -> Result<Self, Error> {
        let Shape { n_states, n_held, n_first, n_second } = shape;
        if [n_states, n_held, n_first, n_second].into_iter().any(|n| n > LONGEST) {
            return Err(Error::TooLong);
        }
        let mut module = JITModule::new(JITBuilder::with_isa(host()?, default_libcall_names()));
        let pointer = module.target_config().pointer_type();
        let (mut context, mut memory) = (module.make_context(), FunctionBuilderContext::new());
        let parameters = [F64, pointer, pointer, pointer, pointer];
        context.func.signature.params = parameters.map(AbiParam::new).to_vec();
        let builder = FunctionBuilder::new(&mut context.func, &mut memory);
        let mut function = Function::new(builder, shape, pointer);
        describe(&mut function);
        function.end();
        let id = module.declare_anonymous_function(&context.func.signature)?;
        module.define_function(id, &mut context)?;
        module.finalize_definitions()?;
        let address = module.get_finalized_function(id);
        // SAFETY: the function was given the parameters of an `Entry`, and the default convention of calls, which is that of
        // `extern "C"`.
        let entry = unsafe { std::mem::transmute::<*const u8, Entry>(address) };
        Ok(Self { entry, shape, module: Mutex::new(Some(module)) })
    }

    /// Calls it.
    ///
    /// # Panics
    /// Lists that are shorter than its [`Shape`] says.
    #[inline]
    pub fn call(
        &self,
        t: f64,
        states: &[f64],
        held: &[f64],
        first: &mut [f64],
        second: &mut [f64],
    ) {
        let shape = &self.shape;
        assert!(
            states.len() >= shape.n_states
                && held.len() >= shape.n_held
                && first.len() >= shape.n_first
                && second.len() >= shape.n_second,
            "a list is shorter than that of the routine"
        );
        // SAFETY: the code reads and writes within the lengths of the shape, to which `Function` holds each of its places,
        // and its memory lives as long as `self`.
        unsafe {
            (self.entry)(
                t,
                states.as_ptr(),
                held.as_ptr(),
                first.as_mut_ptr(),
                second.as_mut_ptr(),
            );
        }
    }
}

impl Drop for Routine {
    fn drop(&mut self) {
        if let Ok(module) = self.module.get_mut()
            && let Some(module) = module.take()
        {
            // SAFETY: the code can only be called through `self`, which is gone.
            unsafe { module.free_memory() };
        }
    }
}

impl fmt::Debug for Routine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Routine").field("shape", &self.shape).finish_non_exhaustive()
    }
}

/// Settings of the code generator.
const FLAGS: [(&str, &str); 6] = [
    ("opt_level", "speed"),
    // The code stays where it is, and calls what is far away.
    ("is_pic", "false"),
    ("use_colocated_libcalls", "false"),
    // A function whose numbers are of another one is refused.
    ("enable_verifier", "true"),
    // A large frame cannot step over the page that guards the end of the stack.
    ("enable_probestack", "true"),
    ("probestack_strategy", "inline"),
];

/// The processor that runs the program.
fn host() -> Result<OwnedTargetIsa, Error> {
    let refused = |error: &dyn fmt::Display| Error::Processor(error.to_string());
    let mut flags = settings::builder();
    for (flag, value) in FLAGS {
        flags.set(flag, value).map_err(|error| refused(&error))?;
    }
    let host = cranelift_native::builder().map_err(|error| refused(&error))?;
    host.finish(settings::Flags::new(flags)).map_err(|error| refused(&error))
}

//! Random numbers that are the same at every run.
#![allow(dead_code, reason = "each target uses its part")]

/// xorshift64*: S. Vigna, "An experimental exploration of Marsaglia's xorshift generators", ACM Trans.
/// Math. Softw. 42(4), 30 (2016).
pub(crate) struct Random(u64);

impl Random {
    /// From `seed`, which is not zero.
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Those of draw `i` of a seed, whatever draws are made beside it: the state is mixed by splitmix64.
    /// G. L. Steele, D. Lea, C. H. Flood, "Fast splittable pseudorandom number generators", OOPSLA (2014).
    pub(crate) fn of_draw(seed: u64, i: u64) -> Self {
        let mix = |z: u64| {
            let z = z.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            z ^ (z >> 31)
        };
        Self(mix(mix(seed) ^ i).max(1))
    }

    /// Evenly between `low` and `high`.
    pub(crate) fn uniform(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11;
        low + (high - low) * bits as f64 / (1_u64 << 53) as f64
    }

    /// Evenly in the logarithm.
    pub(crate) fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        self.uniform(low.ln(), high.ln()).exp()
    }

    /// True in this part of all cases.
    pub(crate) fn chance(&mut self, part: f64) -> bool {
        self.uniform(0.0, 1.0) < part
    }

    /// One of several.
    pub(crate) fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[(self.uniform(0.0, all.len() as f64) as usize).min(all.len() - 1)]
    }
}

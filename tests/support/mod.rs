//! Deterministic samples for the contract tests: a failure names a state that comes back in every run.

// not every test file uses all of it
#[allow(dead_code)]
pub mod motion;
#[allow(dead_code)]
pub mod time_functions;

/// Linear congruential generator of Knuth's MMIX; the high bits are good enough to scatter test states.
pub struct Random(u64);

impl Random {
    /// The sequence that belongs to `seed`.
    pub fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        // small seeds begin with small numbers: the first few are thrown away
        (0..4).for_each(|_| _ = random.uniform(0.0, 1.0));
        random
    }

    /// A number in [from, to).
    pub fn uniform(&mut self, from: f64, to: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        from + (to - from) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }

    /// `count` numbers in [-1, 1).
    pub fn vector(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.uniform(-1.0, 1.0)).collect()
    }
}

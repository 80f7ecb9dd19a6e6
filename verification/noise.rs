/// Numbers without a visible order, the same in every run: Knuth's linear congruential generator (MMIX).
pub struct Noise(u64);

impl Noise {
    /// The series that belongs to a seed.
    pub fn new(seed: u64) -> Self {
        Noise(seed)
    }
    /// The next number in [-1, 1).
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

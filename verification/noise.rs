use costate::prelude::*;

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

/// Lots, each with the odds that it is asked for.
pub struct Lots(Noise);

impl Lots {
    /// One of several series of a seed.
    pub fn new(seed: u64, series: u64) -> Self {
        let mut noise = Noise::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ series);
        // neighbouring seeds begin alike
        (0..8).for_each(|_| _ = noise.next());
        Lots(noise)
    }
    pub fn number(&mut self, from: f64, to: f64) -> f64 {
        from + 0.5 * (to - from) * (self.0.next() + 1.0)
    }
    /// A positive number, any order of magnitude between two with the same odds.
    pub fn size(&mut self, from: f64, to: f64) -> f64 {
        self.number(from.ln(), to.ln()).exp()
    }
    pub fn happens(&mut self, odds: f64) -> bool {
        self.number(0.0, 1.0) < odds
    }
    pub fn below(&mut self, count: usize) -> usize {
        (self.number(0.0, count as f64) as usize).min(count - 1)
    }
    pub fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }
    /// A place in a cube with sides of length 2.
    pub fn place(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.0.next())
    }
    /// A vector of length 1.
    pub fn direction(&mut self) -> [f64; 3] {
        loop {
            let own = self.place();
            let length = own.iter().map(|own| own * own).sum::<f64>().sqrt();
            if (0.1..=1.0).contains(&length) {
                return own.map(|own| own / length);
            }
        }
    }
    pub fn vector<S: Scalar>(&mut self) -> Vector3<S> {
        Vector3::from_f64(self.place())
    }
    pub fn rotation<S: Scalar>(&mut self) -> Quaternion<S> {
        let axis = self.vector::<S>();
        Quaternion::about(axis * (S::one() / axis.length()), S::from(self.number(-3.0, 3.0)))
    }
}

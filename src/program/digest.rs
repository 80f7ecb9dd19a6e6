use std::any::TypeId;
use std::hash::{Hash, Hasher};

/// 128 bits that follow from all that was added, in its order: unlike things have unlike ones but for a chance of 1e-38 or so. The same in
/// every process.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Digest([u64; 2]);

impl Default for Digest {
    fn default() -> Self {
        Digest([0x243f_6a88_85a3_08d3, 0x1319_8a2e_0370_7344])
    }
}

impl Digest {
    /// That of something.
    pub fn of(own: &(impl Hash + ?Sized)) -> Self {
        let mut digest = Self::default();
        own.hash(&mut digest);
        digest
    }

    /// That of something of a type, which tells it from all of other types; in this process alone.
    pub fn of_typed<T: Hash + 'static>(own: &T) -> Self {
        Self::of(&(TypeId::of::<T>(), own))
    }

    /// Both halves take a word in, by the steps of MurmurHash3 (x64, 128 bits; Appleby, in the public domain).
    fn mix(&mut self, word: u64) {
        let [first, second] = &mut self.0;
        let (c1, c2) = (0x87c3_7b91_1142_53d5, 0x4cf5_ad43_2745_937f);
        *first ^= word.wrapping_mul(c1).rotate_left(31).wrapping_mul(c2);
        *first = first.rotate_left(27).wrapping_add(*second).wrapping_mul(5).wrapping_add(0x52dc_e729);
        *second ^= word.wrapping_mul(c2).rotate_left(33).wrapping_mul(c1);
        *second = second.rotate_left(31).wrapping_add(*first).wrapping_mul(5).wrapping_add(0x3849_5ab5);
    }
}

impl Hasher for Digest {
    fn finish(&self) -> u64 {
        self.0[0] ^ self.0[1]
    }
    fn write(&mut self, bytes: &[u8]) {
        self.mix(bytes.len() as u64);
        for chunk in bytes.chunks(8) {
            self.mix(chunk.iter().rev().fold(0, |word, &byte| word << 8 | u64::from(byte)));
        }
    }
    fn write_u32(&mut self, x: u32) {
        self.mix(u64::from(x));
    }
    fn write_u64(&mut self, x: u64) {
        self.mix(x);
    }
    fn write_usize(&mut self, x: usize) {
        self.mix(x as u64);
    }
}

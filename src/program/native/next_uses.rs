//! When each number of a listing is read next: by this, registers are assigned.

use crate::program::listing::{Instruction, Listing, Source};

/// A number that is never read (again).
pub const NEVER: u32 = u32::MAX;

/// Next uses of the constants, inputs and values of a listing.
pub struct NextUses {
    constants: usize,
    inputs: usize,
    /// For each number, the instruction that reads it first.
    pub first: Vec<u32>,
    /// For each operand of each instruction, the instruction that reads the same number next.
    pub after: Vec<[u32; 3]>,
    /// For each instruction, if an output depends on it.
    pub needed: Vec<bool>,
}

impl NextUses {
    /// Goes over the listing once, backwards.
    ///
    /// # Panics
    /// Where an operand is not a number that exists when it is read.
    pub fn of(listing: &Listing) -> Self {
        let count = listing.instructions.len();
        let (constants, inputs) = (listing.constants.len(), listing.inputs);
        let mut uses = NextUses {
            constants,
            inputs,
            first: vec![NEVER; constants + inputs + count],
            after: vec![[NEVER; 3]; count],
            needed: vec![false; count],
        };
        for &output in &listing.outputs {
            uses.check(output, count);
            if let Source::Value(value) = output {
                uses.needed[value as usize] = true;
            }
        }
        for (number, instruction) in listing.instructions.iter().enumerate().rev() {
            if !uses.needed[number] {
                continue;
            }
            if let Instruction::Gather { first, count, .. } = *instruction {
                uses.check(Source::Input(first + count - 1), number);
            }
            let mut operand = 0;
            instruction.for_each_source(|source| {
                uses.check(source, number);
                uses.after[number][operand] = uses.first[uses.number(source)];
                operand += 1;
            });
            instruction.for_each_source(|source| {
                let read = uses.number(source);
                uses.first[read] = number as u32;
                if let Source::Value(value) = source {
                    uses.needed[value as usize] = true;
                }
            });
        }
        uses
    }

    /// Number of a constant, an input or a value among all of them.
    pub fn number(&self, source: Source) -> usize {
        match source {
            Source::Constant(constant) => constant as usize,
            Source::Input(input) => self.constants + input as usize,
            Source::Value(value) => self.constants + self.inputs + value as usize,
        }
    }

    fn check(&self, source: Source, before: usize) {
        let (number, limit) = match source {
            Source::Constant(constant) => (constant, self.constants),
            Source::Input(input) => (input, self.inputs),
            Source::Value(value) => (value, before),
        };
        assert!((number as usize) < limit, "{source:?}, read where only {limit} of its kind exist");
    }
}

//! Which instructions of NEON an operation becomes. Both operands are in registers.

use super::emitter::Emitter;
use super::encoder::{AND, AND_NOT, ASIDE, CHOOSE, GREATER, IS_ZERO, MUL, NEG, ONE, OR, Opcode};

impl Emitter {
    pub fn binary(&mut self, opcodes: [Opcode; 2], x: usize, y: usize) -> u8 {
        let sources = [x, y].map(|number| self.storage.in_register(number));
        let target = self.target();
        self.vector(opcodes, target, sources);
        target
    }

    pub fn negate(&mut self, x: usize) -> u8 {
        self.unary(NEG, x)
    }

    pub fn unary(&mut self, opcodes: [Opcode; 2], x: usize) -> u8 {
        let source = self.storage.in_register(x);
        let target = self.target();
        self.vector(opcodes, target, [source, 0]);
        target
    }

    pub fn less(&mut self, x: usize, y: usize) -> u8 {
        let [x, y] = [x, y].map(|number| self.storage.in_register(number));
        let target = self.target();
        self.vector(GREATER, target, [y, x]);
        self.vector(ONE, ASIDE, [0, 0]);
        self.vector(AND, target, [target, ASIDE]);
        target
    }

    pub fn vanishing(&mut self, x: usize, y: usize) -> u8 {
        let [x, y] = [x, y].map(|number| self.storage.in_register(number));
        self.vector(IS_ZERO, ASIDE, [x, 0]);
        let target = self.target();
        self.vector(MUL, target, [x, y]);
        self.vector(AND_NOT, target, [target, ASIDE]);
        target
    }

    pub fn select(&mut self, condition: usize, then: usize, otherwise: usize) -> u8 {
        let [condition, then, otherwise] = [condition, then, otherwise].map(|number| self.storage.in_register(number));
        self.vector(IS_ZERO, ASIDE, [condition, 0]);
        self.vector(CHOOSE, ASIDE, [otherwise, then]);
        let target = self.target();
        self.vector(OR, target, [ASIDE, ASIDE]);
        target
    }

    fn vector(&mut self, opcodes: [Opcode; 2], target: u8, sources: [u8; 2]) {
        self.storage.encoder.vector(self.storage.lanes, opcodes, target, sources);
    }
}

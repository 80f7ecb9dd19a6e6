//! Which instructions of x86-64 an operation becomes. The second operand is read from memory where it is there.

use super::emitter::Emitter;
use super::encoder::{AND, Base, DIFFERENT, LESS, LOAD, Level, MUL, Opcode, Operand, XOR};

/// Places of the sign bit and of 1 among the constants.
const SIGN: usize = 0;
const ONE: usize = 1;

impl Emitter {
    pub fn binary(&mut self, opcodes: [Opcode; 2], x: usize, y: usize) -> u8 {
        let first = self.storage.in_register(x);
        let second = self.storage.operand(y);
        let target = self.target();
        self.vector(opcodes, target, first, second);
        target
    }

    pub fn unary(&mut self, opcodes: [Opcode; 2], x: usize) -> u8 {
        // the form for one lane takes the unused lanes from its first operand: the same register as the second, so that
        // it waits for no other
        let (first, second) = if self.storage.lanes == 1 {
            let register = self.storage.in_register(x);
            (register, Operand::Register(register))
        } else {
            (0, self.storage.operand(x))
        };
        let target = self.target();
        self.vector(opcodes, target, first, second);
        target
    }

    pub fn negate(&mut self, x: usize) -> u8 {
        let first = self.storage.in_register(x);
        let target = self.target();
        let sign = Operand::Memory(self.storage.address(Base::Constants, SIGN));
        self.vector([XOR; 2], target, first, sign);
        target
    }

    pub fn less(&mut self, x: usize, y: usize) -> u8 {
        let first = self.storage.in_register(x);
        let second = self.storage.operand(y);
        let target = self.target();
        let one = self.storage.address(Base::Constants, ONE);
        if self.storage.level == Level::Avx512 {
            let [compare, load] = [LESS, LOAD].map(|opcodes| self.form(opcodes));
            self.storage.encoder.compare_to_mask(self.storage.lanes, compare, first, second);
            self.storage.encoder.masked(self.storage.lanes, load, target, 0, Operand::Memory(one));
        } else {
            self.vector(LESS, target, first, second);
            self.vector([AND; 2], target, target, Operand::Memory(one));
        }
        target
    }

    pub fn vanishing(&mut self, x: usize, y: usize) -> u8 {
        let first = self.storage.in_register(x);
        let second = self.storage.operand(y);
        let mask = self.nonzero_mask(first);
        let target = self.target();
        if self.storage.level == Level::Avx512 {
            let opcode = self.form(MUL);
            self.storage.encoder.masked(self.storage.lanes, opcode, target, first, second);
        } else {
            self.vector(MUL, target, first, second);
            self.vector([AND; 2], target, target, Operand::Register(mask));
        }
        target
    }

    pub fn select(&mut self, condition: usize, then: usize, otherwise: usize) -> u8 {
        let condition = self.storage.in_register(condition);
        let mask = self.nonzero_mask(condition);
        let first = self.storage.in_register(otherwise);
        // the form for one lane would read two numbers from memory
        let second = if self.storage.lanes == 1 {
            Operand::Register(self.storage.in_register(then))
        } else {
            self.storage.operand(then)
        };
        let target = self.target();
        if self.storage.level == Level::Avx512 {
            self.storage.encoder.blend_by_mask(self.storage.lanes, target, first, second);
        } else {
            self.storage.encoder.blend_by_sign(self.storage.lanes, target, first, second, mask);
        }
        target
    }

    /// Which lanes of a register are not 0: in mask register 1 (AVX-512) or in the vector register that is returned.
    fn nonzero_mask(&mut self, register: u8) -> u8 {
        let mask = self.storage.reserve_register();
        let zero = Operand::Register(mask);
        self.storage.encoder.vector(1, XOR, mask, mask, zero);
        if self.storage.level == Level::Avx512 {
            self.storage.encoder.compare_to_mask(self.storage.lanes, self.form(DIFFERENT), register, zero);
        } else {
            self.vector(DIFFERENT, mask, register, zero);
        }
        mask
    }

    fn vector(&mut self, opcodes: [Opcode; 2], target: u8, first: u8, second: Operand) {
        let opcode = self.form(opcodes);
        self.storage.encoder.vector(self.storage.lanes, opcode, target, first, second);
    }

    /// The form of an instruction for these lanes.
    fn form(&self, [single, packed]: [Opcode; 2]) -> Opcode {
        if self.storage.lanes == 1 { single } else { packed }
    }
}

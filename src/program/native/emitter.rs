//! From a listing to machine code, in one pass: what each operation becomes. Results that are outputs are stored as soon as they are made.

use super::Width;
use super::call::Call;
use super::encoder::{ADD, Base, DIV, Level, MUL, Opcode, SUB};
use super::next_uses::NextUses;
use super::storage::Storage;
use crate::program::listing::{Instruction, Listing, Source};
use crate::program::operation::{Binary, Unary};

/// Machine code, and what it needs to run.
pub struct Emitted {
    pub bytes: Vec<u8>,
    /// Where each section begins: a function of its own, to be called when those before it have been.
    pub sections: Vec<usize>,
    /// Constants for all lanes.
    pub constants: Vec<f64>,
    /// Calls, at the addresses that the code has.
    pub calls: Box<[Call]>,
    /// Numbers of scratch memory.
    pub scratch: usize,
    /// Bytes by which inputs, outputs, scratch and constants are to be passed behind their start.
    pub biases: [usize; 4],
}

/// Makes the code of a listing, in sections of so many bytes or some more; none where it is too long for the addresses of the instructions.
pub fn emit(listing: &Listing, width: Width, level: Level, section: usize) -> Option<Emitted> {
    let uses = NextUses::of(listing);
    let longest = listing.outputs.len().max(uses.first.len()) + 64;
    i32::try_from(longest.checked_mul(8 * width.lanes())?).ok()?;

    let calls: Box<[Call]> = (listing.instructions.iter().zip(&uses.needed))
        .filter_map(|(&instruction, &needed)| Call::of(instruction, width, &listing.curves).filter(|_| needed))
        .collect();
    let mut emitter = Emitter::new(listing, &uses, Storage::new(listing, width, level, &uses));
    if !calls.is_empty() {
        emitter.storage.encoder.save_bases();
    }
    let mut next_call = calls.iter();
    let mut sections = vec![0];
    for (number, &instruction) in listing.instructions.iter().enumerate() {
        if !uses.needed[number] {
            continue;
        }
        if emitter.storage.encoder.length() - sections[sections.len() - 1] >= section {
            emitter.storage.clear_registers();
            let encoder = &mut emitter.storage.encoder;
            encoder.finish_function(!calls.is_empty());
            sections.push(encoder.length());
            if !calls.is_empty() {
                encoder.save_bases();
            }
        }
        emitter.instruction(number, instruction, &mut next_call);
    }
    emitter.copy_outputs(&listing.outputs);
    let mut storage = emitter.storage;
    storage.encoder.finish_function(!calls.is_empty());
    let (scratch, biases) = (storage.scratch(), storage.biases());
    let constants = Storage::constants(width, &listing.constants);
    Some(Emitted { sections, bytes: storage.encoder.finish(), constants, calls, scratch, biases })
}

pub struct Emitter<'a> {
    pub storage: Storage<'a>,
    uses: &'a NextUses,
    /// For each value the first place where it is an output, and for each output the next place of the same value.
    first_output: Vec<Option<u32>>,
    next_output: Vec<Option<u32>>,
}

impl<'a> Emitter<'a> {
    fn new(listing: &Listing, uses: &'a NextUses, storage: Storage<'a>) -> Self {
        let mut first_output = vec![None; listing.instructions.len()];
        let mut next_output = vec![None; listing.outputs.len()];
        for (output, &source) in listing.outputs.iter().enumerate().rev() {
            if let Source::Value(value) = source {
                next_output[output] = first_output[value as usize].replace(output as u32);
            }
        }
        Emitter { storage, uses, first_output, next_output }
    }

    fn instruction<'c>(&mut self, number: usize, instruction: Instruction, calls: &mut impl Iterator<Item = &'c Call>) {
        let mut operands = [0; 3];
        let mut count = 0;
        instruction.for_each_source(|source| {
            operands[count] = self.uses.number(source);
            count += 1;
        });
        self.storage.start(number, &operands[..count]);
        let [x, y, z] = operands;
        let target = match instruction {
            Instruction::Binary(Binary::Add, ..) => self.commutative(ADD, x, y),
            Instruction::Binary(Binary::Mul, ..) => self.commutative(MUL, x, y),
            Instruction::Binary(Binary::Sub, ..) => self.binary(SUB, x, y),
            Instruction::Binary(Binary::Div, ..) => self.binary(DIV, x, y),
            Instruction::Unary(Unary::Neg, _) => self.negate(x),
            Instruction::Unary(Unary::Sqrt, _) => self.square_root(x),
            Instruction::Unary(Unary::Floor, _) => self.floor(x),
            Instruction::Binary(Binary::Less, ..) => self.less(x, y),
            Instruction::Binary(Binary::Vanishing, ..) => self.vanishing(x, y),
            Instruction::Select(..) => self.select(x, y, z),
            Instruction::Gather { first, .. } => {
                let first = self.uses.number(Source::Input(first));
                return self.call(number, calls.next().expect("a record for each call"), first, x);
            }
            Instruction::Unary(..) | Instruction::Power(..) | Instruction::Curve { .. } => {
                return self.call(number, calls.next().expect("a record for each call"), x, x);
            }
            Instruction::Binary(Binary::Atan2, ..) => {
                return self.call(number, calls.next().expect("a record for each call"), x, y);
            }
        };
        self.finish(number, target);
    }

    /// Stores the result of an instruction where it is an output, and keeps it if it is read later.
    fn finish(&mut self, instruction: usize, target: u8) {
        let number = self.uses.number(Source::Value(instruction as u32));
        let mut output = self.first_output[instruction];
        while let Some(place) = output {
            let address = self.storage.address(Base::Outputs, place as usize);
            self.storage.store(target, address);
            self.storage.stored(number, address);
            output = self.next_output[place as usize];
        }
        self.storage.hold(target, number);
    }

    /// Outputs that are inputs or constants.
    fn copy_outputs(&mut self, outputs: &[Source]) {
        let mut loaded = None;
        for (place, &source) in outputs.iter().enumerate() {
            if let Source::Value(_) = source {
                continue;
            }
            if loaded != Some(source) {
                self.storage.load(0, self.storage.memory(self.uses.number(source)));
                loaded = Some(source);
            }
            self.storage.store(0, self.storage.address(Base::Outputs, place));
        }
    }

    // Operations, here and in `operations`: each returns the register of the result.

    fn commutative(&mut self, opcodes: [Opcode; 2], x: usize, y: usize) -> u8 {
        let swap = match (self.storage.register(x), self.storage.register(y)) {
            // as last operand, the upper registers need a longer prefix
            (Some(first), Some(second)) => first < 8 && second >= 8,
            (Some(_), None) => false,
            (None, Some(_)) => true,
            // load the one that is needed sooner
            (None, None) => self.storage.use_after(1) < self.storage.use_after(0),
        };
        if swap { self.binary(opcodes, y, x) } else { self.binary(opcodes, x, y) }
    }

    fn call(&mut self, instruction: usize, call: &Call, x: usize, y: usize) {
        self.storage.in_memory(x);
        self.storage.in_memory(y);
        let (x, y) = (self.storage.memory(x), self.storage.memory(y));
        self.storage.retire_operands();
        // a call keeps no vector register
        self.storage.clear_registers();
        let output = self.first_output[instruction];
        let result = match output {
            Some(place) => self.storage.address(Base::Outputs, place as usize),
            None => self.storage.take_slot(),
        };
        self.storage.encoder.call(std::ptr::from_ref(call) as usize, x, y, result);
        self.storage.encoder.restore_bases();
        self.storage.stored(self.uses.number(Source::Value(instruction as u32)), result);
        if output.is_some_and(|place| self.next_output[place as usize].is_some()) {
            let register = self.storage.take_register();
            self.storage.load(register, result);
            self.finish(instruction, register);
        }
    }

    /// Register of the result, once all operands are where the instruction reads them.
    pub fn target(&mut self) -> u8 {
        self.storage.retire_operands();
        self.storage.take_register()
    }
}

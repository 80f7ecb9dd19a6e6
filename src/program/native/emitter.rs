//! From a listing to machine code, in one pass: what each operation becomes. Results that are outputs are stored as soon as they are made.

use super::call::Call;
use super::encoder::{ADD, Base, DIV, Level, MUL, Opcode, ROUND_DOWN, SQRT, SUB};
use super::storage::Storage;
use crate::listing::Listing;
use crate::operation::{Binary, Operation, Unary};
use smallvec::SmallVec;

/// Machine code, and what it needs to run.
#[derive(Debug)]
pub struct Emitted {
    pub bytes: Vec<u8>,
    /// Where each section begins: a function of its own, to be called when those before it have been.
    pub sections: Vec<usize>,
    /// Constants for all lanes.
    pub constants: Vec<f64>,
    /// Calls, at the addresses that the code has.
    pub _calls: Box<[Call]>,
    /// Numbers of scratch memory.
    pub scratch: usize,
    /// Bytes by which inputs, outputs, scratch and constants are to be passed behind their start.
    pub biases: [usize; 4],
}

/// Makes the code of a listing, in sections of so many bytes or some more; none where it is too long for the addresses of the instructions.
pub fn emit(listing: &Listing, lanes: usize, level: Level, section: usize) -> Option<Emitted> {
    let longest = listing.outputs.len().max(listing.operations.len()).max(listing.inputs) + 64;
    i32::try_from(longest.checked_mul(8 * lanes)?).ok()?;

    let calls: Box<[Call]> =
        listing.operations.iter().filter_map(|&operation| Call::of(operation, lanes, &listing.curves)).collect();
    let mut emitter = Emitter::new(listing, Storage::new(listing, lanes, level));
    if !calls.is_empty() {
        emitter.storage.encoder.save_bases();
    }
    let mut next_call = calls.iter();
    let mut sections = vec![0];
    for number in listing.executed() {
        if emitter.storage.encoder.length() - sections[sections.len() - 1] >= section {
            emitter.storage.clear_registers();
            let encoder = &mut emitter.storage.encoder;
            encoder.finish_function(!calls.is_empty());
            sections.push(encoder.length());
            if !calls.is_empty() {
                encoder.save_bases();
            }
        }
        emitter.operation(number, listing.operations[number], &mut next_call);
    }
    emitter.copy_outputs(listing);
    let mut storage = emitter.storage;
    storage.encoder.finish_function(!calls.is_empty());
    let (scratch, biases) = (storage.scratch(), storage.biases());
    let constants = Storage::constants(lanes, listing);
    Some(Emitted { sections, bytes: storage.encoder.finish(), constants, _calls: calls, scratch, biases })
}

pub struct Emitter {
    pub storage: Storage,
    /// The places where each number is an output.
    outputs: Vec<SmallVec<[usize; 1]>>,
}

impl Emitter {
    fn new(listing: &Listing, storage: Storage) -> Self {
        let mut outputs: Vec<SmallVec<_>> = listing.operations.iter().map(|_| SmallVec::new()).collect();
        for (place, output) in listing.outputs.iter().enumerate() {
            outputs[output.0 as usize].push(place);
        }
        Emitter { storage, outputs }
    }

    fn operation<'c>(&mut self, number: usize, operation: Operation, calls: &mut impl Iterator<Item = &'c Call>) {
        let operands = operation.operands();
        self.storage.start(number, &operands);
        let target = match (operation, &operands[..]) {
            (Operation::Binary(Binary::Add, ..), &[x, y]) => self.commutative(ADD, x, y),
            (Operation::Binary(Binary::Mul, ..), &[x, y]) => self.commutative(MUL, x, y),
            (Operation::Binary(Binary::Sub, ..), &[x, y]) => self.binary(SUB, x, y),
            (Operation::Binary(Binary::Div, ..), &[x, y]) => self.binary(DIV, x, y),
            (Operation::Unary(Unary::Neg, _), &[x]) => self.negate(x),
            (Operation::Unary(Unary::Sqrt, _), &[x]) => self.unary(SQRT, x),
            (Operation::Unary(Unary::Floor, _), &[x]) => self.unary(ROUND_DOWN, x),
            (Operation::Binary(Binary::Less, ..), &[x, y]) => self.less(x, y),
            (Operation::Binary(Binary::Vanishing, ..), &[x, y]) => self.vanishing(x, y),
            (Operation::Select(_), &[mask, then, otherwise]) => self.select(mask, then, otherwise),
            _ => {
                let (x, y) = (operands[0], operands[operands.len() - 1]);
                return self.call(number, calls.next().expect("a record for each call"), x, y);
            }
        };
        self.finish(number, target);
    }

    /// Stores the result of an operation where it is an output, and keeps it if it is read later.
    fn finish(&mut self, number: usize, target: u8) {
        for &place in &self.outputs[number] {
            let address = self.storage.address(Base::Outputs, place);
            self.storage.store(target, address);
            self.storage.stored(number, address);
        }
        self.storage.hold(target, number);
    }

    /// Outputs that are inputs or constants.
    fn copy_outputs(&mut self, listing: &Listing) {
        let mut loaded = None;
        for (place, &output) in listing.outputs.iter().enumerate() {
            let number = output.0 as usize;
            if !listing.operations[number].is_leaf() {
                continue;
            }
            if loaded != Some(output) {
                self.storage.load(0, self.storage.memory(number));
                loaded = Some(output);
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

    fn call(&mut self, number: usize, call: &Call, x: usize, y: usize) {
        self.storage.in_memory(x);
        self.storage.in_memory(y);
        let (x, y) = (self.storage.memory(x), self.storage.memory(y));
        self.storage.retire_operands();
        // a call keeps no vector register
        self.storage.clear_registers();
        let result = match self.outputs[number].first() {
            Some(&place) => self.storage.address(Base::Outputs, place),
            None => self.storage.take_slot(),
        };
        self.storage.encoder.call(std::ptr::from_ref(call) as usize, x, y, result);
        self.storage.encoder.restore_bases();
        self.storage.stored(number, result);
        if self.outputs[number].len() > 1 {
            let register = self.storage.take_register();
            self.storage.load(register, result);
            self.finish(number, register);
        }
    }

    /// Register of the result, once all operands are where the instruction reads them.
    pub fn target(&mut self) -> u8 {
        self.storage.retire_operands();
        self.storage.take_register()
    }
}

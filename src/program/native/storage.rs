//! Where each number of a listing is while its code is emitted: in a register, in memory, or both.
//!
//! Inputs and constants are in memory from the start; a value comes there where it is an output, is needed after a
//! call, or has to leave its register. If a register is needed and none is free, the number leaves that is read last
//! (Belady, IBM Systems Journal 5, 1966).

#[cfg(target_arch = "x86_64")]
use super::encoder::Operand;
use super::encoder::{Address, Base, Encoder, Level};
use crate::listing::Listing;
use crate::operation::Operation;
use smallvec::SmallVec;

/// A number that is never read (again).
const NEVER: u32 = u32::MAX;
/// Constants of the code itself, in front of the listing's: the sign bit, and 1. Logical instructions of one lane read the next number, too.
const OWN_CONSTANTS: [f64; 2] = [-0.0, 1.0];

#[derive(Clone, Copy)]
struct Number {
    register: Option<u8>,
    memory: Option<Address>,
    /// Instruction that reads it next.
    next_use: u32,
}

/// Registers, scratch memory and the encoder for the moves between them.
pub struct Storage {
    pub encoder: Encoder,
    pub lanes: usize,
    #[cfg(target_arch = "x86_64")]
    pub level: Level,
    /// For each operand of each operation, the one that reads the same number next.
    uses: Vec<[u32; 3]>,
    numbers: Vec<Number>,
    /// Number in each register.
    held: [Option<u32>; 32],
    /// Registers that hold no number, a bit each.
    free: u32,
    /// Instruction that is being emitted.
    now: u32,
    /// Its operands, as long as they may be read.
    operands: SmallVec<[usize; 3]>,
    /// Registers for its intermediate results, a bit each.
    reserved: u32,
    free_slots: Vec<u32>,
    slots: u32,
    /// Slots of numbers that the instruction reads for the last time.
    dying_slots: Vec<u32>,
    biases: [i32; 4],
}

impl Storage {
    pub fn new(listing: &Listing, lanes: usize, level: Level) -> Self {
        let (constants, inputs) = (listing.constants().count(), listing.inputs);
        // short displacements reach to both sides: the base points into the array, not to its start
        let reach = level.reach(lanes);
        let middle = |count: usize| (count * 8 * lanes / 2).min(reach).next_multiple_of(64);
        let biases = [middle(inputs), middle(listing.outputs.len()), reach, middle(constants + OWN_CONSTANTS.len())];
        let mut storage = Storage {
            encoder: Encoder::new(level, 12 * listing.instructions + 256),
            lanes,
            #[cfg(target_arch = "x86_64")]
            level,
            uses: vec![[NEVER; 3]; listing.operations.len()],
            numbers: Vec::with_capacity(listing.operations.len()),
            held: [None; 32],
            free: level.registers(),
            now: 0,
            operands: SmallVec::new(),
            reserved: 0,
            free_slots: Vec::new(),
            slots: 0,
            dying_slots: Vec::new(),
            biases: biases.map(|bias| bias as i32),
        };
        let mut next_constant = OWN_CONSTANTS.len()..;
        for operation in &listing.operations {
            let memory = match *operation {
                Operation::Constant(_) => next_constant.next().map(|place| storage.address(Base::Constants, place)),
                Operation::Input(input) => Some(storage.address(Base::Inputs, input as usize)),
                _ => None,
            };
            storage.numbers.push(Number { register: None, memory, next_use: NEVER });
        }
        for (number, operation) in listing.operations.iter().enumerate().rev() {
            let operands = operation.operands();
            storage.uses[number] = std::array::from_fn(|place| {
                operands.get(place).map_or(NEVER, |&operand| storage.numbers[operand].next_use)
            });
            operands.iter().for_each(|&operand| storage.numbers[operand].next_use = number as u32);
        }
        storage
    }

    /// All constants, for all lanes.
    pub fn constants(lanes: usize, listing: &Listing) -> Vec<f64> {
        let all = OWN_CONSTANTS.into_iter().chain(listing.constants());
        all.flat_map(|constant| std::iter::repeat_n(constant, lanes)).collect()
    }

    /// Bytes by which the bases of inputs, outputs, scratch and constants lie behind their start.
    pub fn biases(&self) -> [usize; 4] {
        self.biases.map(|bias| bias as usize)
    }

    /// Numbers of scratch memory in use.
    pub fn scratch(&self) -> usize {
        self.slots as usize * self.lanes
    }

    /// Starts an instruction: its operands keep their registers until [`retire_operands`](Self::retire_operands).
    pub fn start(&mut self, instruction: usize, operands: &[usize]) {
        self.free_slots.append(&mut self.dying_slots);
        self.now = instruction as u32;
        self.operands = SmallVec::from_slice(operands);
        self.reserved = 0;
    }

    /// Says that all operands have been brought to where the instruction reads them. Registers of numbers that are not
    /// read again become free at once, since an instruction reads before it writes; their slots after it.
    pub fn retire_operands(&mut self) {
        for operand in 0..self.operands.len() {
            let number = self.operands[operand];
            let Number { register, memory, next_use } = self.numbers[number];
            let after = self.uses[self.now as usize][operand];
            self.numbers[number].next_use = after;
            // an operand that stands twice is freed once
            if after == NEVER && next_use != NEVER {
                if let Some(register) = register {
                    self.leave(register);
                }
                if let Some(Address { base: Base::Scratch, displacement }) = memory {
                    self.dying_slots.push(((displacement + self.biases[2]) / self.bytes()) as u32);
                }
            }
        }
        self.operands.clear();
    }

    /// When the current instruction's operand is read again.
    pub fn use_after(&self, operand: usize) -> u32 {
        self.uses[self.now as usize][operand]
    }

    /// The number's register, if it is in one.
    pub fn register(&self, number: usize) -> Option<u8> {
        self.numbers[number].register
    }

    /// The number's place in memory.
    pub fn memory(&self, number: usize) -> Address {
        self.numbers[number].memory.expect("a number that was stored")
    }

    /// Where an instruction can read the number.
    #[cfg(target_arch = "x86_64")]
    pub fn operand(&self, number: usize) -> Operand {
        match self.numbers[number].register {
            Some(register) => Operand::Register(register),
            None => Operand::Memory(self.memory(number)),
        }
    }

    /// The number's register, to which it is loaded if necessary.
    pub fn in_register(&mut self, number: usize) -> u8 {
        if let Some(register) = self.numbers[number].register {
            return register;
        }
        let register = self.take_register();
        self.load(register, self.memory(number));
        self.hold(register, number);
        register
    }

    /// Stores a number, unless it is stored.
    pub fn in_memory(&mut self, number: usize) {
        let Number { register, memory, .. } = self.numbers[number];
        if memory.is_none() {
            let slot = self.take_slot();
            self.store(register.expect("a number is in a register or in memory"), slot);
            self.numbers[number].memory = Some(slot);
        }
    }

    /// Says that a number is in a register, unless it is never read.
    pub fn hold(&mut self, register: u8, number: usize) {
        if self.numbers[number].next_use != NEVER {
            self.held[usize::from(register)] = Some(number as u32);
            self.free &= !(1 << register);
            self.numbers[number].register = Some(register);
        }
    }

    /// Says that a number is in memory.
    pub fn stored(&mut self, number: usize, address: Address) {
        self.numbers[number].memory = Some(address);
    }

    /// Moves all numbers that are read later out of the registers.
    pub fn clear_registers(&mut self) {
        for register in 0..32 {
            if let Some(number) = self.held[usize::from(register)] {
                self.in_memory(number as usize);
                self.leave(register);
            }
        }
    }

    /// A register for an intermediate result, until the instruction ends.
    #[cfg(target_arch = "x86_64")]
    pub fn reserve_register(&mut self) -> u8 {
        let register = self.take_register();
        self.reserved |= 1 << register;
        register
    }

    /// A register that holds no number, made free if there is none; not one of an operand that may still be read.
    pub fn take_register(&mut self) -> u8 {
        let mut pinned = self.reserved;
        for &operand in &self.operands {
            pinned |= self.numbers[operand].register.map_or(0, |register| 1 << register);
        }
        let free = self.free & !pinned;
        if free != 0 {
            return free.trailing_zeros() as u8;
        }
        let held = (0..32_u8).filter(|register| pinned & 1 << register == 0);
        let held = held.filter_map(|register| Some((register, self.held[usize::from(register)]?)));
        let (register, number) = held
            .max_by_key(|(_, number)| self.numbers[*number as usize].next_use)
            .expect("more registers than an operation has operands");
        self.in_memory(number as usize);
        self.leave(register);
        register
    }

    fn leave(&mut self, register: u8) {
        if let Some(number) = self.held[usize::from(register)].take() {
            self.numbers[number as usize].register = None;
        }
        self.free |= 1 << register;
    }

    /// A place in scratch memory.
    pub fn take_slot(&mut self) -> Address {
        let slot = self.free_slots.pop().unwrap_or_else(|| {
            self.slots += 1;
            self.slots - 1
        });
        self.address(Base::Scratch, slot as usize)
    }

    pub fn load(&mut self, register: u8, address: Address) {
        self.encoder.load(self.lanes, register, address);
    }

    pub fn store(&mut self, register: u8, address: Address) {
        self.encoder.store(self.lanes, register, address);
    }

    /// Place of an input, an output or a slot.
    pub fn address(&self, base: Base, place: usize) -> Address {
        let bias = match base {
            Base::Inputs => self.biases[0],
            Base::Outputs => self.biases[1],
            Base::Scratch => self.biases[2],
            Base::Constants => self.biases[3],
        };
        Address { base, displacement: place as i32 * self.bytes() - bias }
    }

    /// Bytes of a number in all lanes.
    fn bytes(&self) -> i32 {
        8 * self.lanes as i32
    }
}

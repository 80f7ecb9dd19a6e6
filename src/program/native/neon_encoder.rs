//! Words of the few instructions of aarch64 that programs use.
//!
//! Operands are registers: what stands in memory is loaded first. Layout: Arm Architecture Reference Manual for A-profile architecture, DDI
//! 0487, part C4.

use super::call::Call;
use std::arch::asm;

/// Instructions available.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// NEON, which every processor has.
    Neon,
}

impl Level {
    /// All of them, the best first.
    pub const ALL: [Level; 1] = [Level::Neon];

    /// Whether this processor has it for so many lanes.
    pub fn is_available(self, lanes: usize) -> bool {
        lanes <= 2
    }

    /// Its vector registers, a bit each: without 8 to 15, which a function must keep, and [`ASIDE`].
    pub fn registers(self) -> u32 {
        0x7fff_00ff
    }

    /// Bytes to both sides of a base that the shortest addresses reach: none before it.
    pub fn reach(self, _lanes: usize) -> usize {
        0
    }
}

/// Code of a section, with the addresses of inputs, outputs, scratch and constants.
pub type Entry = unsafe extern "C" fn(*const f64, *mut f64, *mut f64, *const f64);

/// [`Call::evaluate`] by the convention of the code.
///
/// # Safety
/// The same.
unsafe extern "C" fn evaluate(call: *const Call, x: *const f64, y: *const f64, result: *mut f64) {
    // SAFETY: promised by the caller.
    unsafe { Call::evaluate(call, x, y, result) }
}

/// Writes new code back to where the caches for instructions read it, and lets these forget what was there.
pub fn make_visible(code: &[u8]) {
    let lines = |bytes: usize| {
        let (first, end) = (code.as_ptr() as usize, code.as_ptr() as usize + code.len());
        (first & !(bytes - 1)..end).step_by(bytes)
    };
    let sizes: u64;
    // SAFETY: reads the sizes of cache lines, which Linux lets every process do.
    unsafe { asm!("mrs {}, ctr_el0", out(reg) sizes, options(nomem, nostack, preserves_flags)) };
    let [of_data, of_code] = [sizes >> 16, sizes].map(|size| 4 << (size & 15));
    for line in lines(of_data) {
        // SAFETY: cleans a line of readable memory, whose content stays.
        unsafe { asm!("dc cvau, {}", in(reg) line, options(nostack, preserves_flags)) };
    }
    // SAFETY: waits.
    unsafe { asm!("dsb ish", options(nostack, preserves_flags)) };
    for line in lines(of_code) {
        // SAFETY: lets the cache read readable memory again.
        unsafe { asm!("ic ivau, {}", in(reg) line, options(nostack, preserves_flags)) };
    }
    // SAFETY: waits.
    unsafe { asm!("dsb ish", "isb", options(nostack, preserves_flags)) };
}

/// An address: a base register and a displacement in bytes, not negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Address {
    pub base: Base,
    pub displacement: i32,
}

/// Registers that hold addresses: the arguments of the code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    Inputs = 0,
    Outputs = 1,
    Scratch = 2,
    Constants = 3,
}

/// An instruction of one or two source registers, for one lane and for two.
pub type Opcode = u32;

pub const ADD: [Opcode; 2] = [0x1e60_2800, 0x4e60_d400];
pub const SUB: [Opcode; 2] = [0x1e60_3800, 0x4ee0_d400];
pub const MUL: [Opcode; 2] = [0x1e60_0800, 0x6e60_dc00];
pub const DIV: [Opcode; 2] = [0x1e60_1800, 0x6e60_fc00];
pub const SQRT: [Opcode; 2] = [0x1e61_c000, 0x6ee1_f800];
pub const NEG: [Opcode; 2] = [0x1e61_4000, 0x6ee0_f800];
/// frintm: to the integer below.
pub const ROUND_DOWN: [Opcode; 2] = [0x1e65_4000, 0x4e61_9800];
// a lane more than needed does no harm
/// fcmgt: all bits of a lane where the first is greater, false for NaN.
pub const GREATER: [Opcode; 2] = [0x6ee0_e400; 2];
/// fcmeq with 0, of one source.
pub const IS_ZERO: [Opcode; 2] = [0x4ee0_d800; 2];
pub const AND: [Opcode; 2] = [0x4e20_1c00; 2];
/// The first where the second has no bit.
pub const AND_NOT: [Opcode; 2] = [0x4e60_1c00; 2];
/// Where the target has a bit the first, elsewhere the second.
pub const CHOOSE: [Opcode; 2] = [0x6e60_1c00; 2];
/// orr; of a register with itself a copy.
pub const OR: [Opcode; 2] = [0x4ea0_1c00; 2];
/// fmov of 1 to all lanes, without a source.
pub const ONE: [Opcode; 2] = [0x6f03_f600; 2];

/// A register that holds no number: for intermediate results.
pub const ASIDE: u8 = 31;
/// Registers for addresses and displacements: the first, and one for each address of a call.
const SPARE: u32 = 16;
const OF_CALL: [u32; 3] = [10, 11, 12];

/// A load or store: with a displacement in units of the operand, and with one in register [`SPARE`].
struct Access {
    short: [u32; 2],
    long: [u32; 2],
}

const LOAD: Access = Access { short: [0xfd40_0000, 0x3dc0_0000], long: [0xfc60_6800, 0x3ce0_6800] };
const STORE: Access = Access { short: [0xfd00_0000, 0x3d80_0000], long: [0xfc20_6800, 0x3ca0_6800] };

/// Machine code as it grows.
pub struct Encoder {
    bytes: Vec<u8>,
}

impl Encoder {
    pub fn new(_level: Level, capacity: usize) -> Self {
        Encoder { bytes: Vec::with_capacity(capacity) }
    }

    pub fn finish(self) -> Vec<u8> {
        self.bytes
    }

    /// Bytes so far.
    pub fn length(&self) -> usize {
        self.bytes.len()
    }

    fn word(&mut self, word: u32) {
        self.bytes.extend(word.to_le_bytes());
    }

    /// `target = first op second`; instructions of fewer sources have 0 in place of the others.
    pub fn vector(&mut self, lanes: usize, opcodes: [Opcode; 2], target: u8, [first, second]: [u8; 2]) {
        let opcode = opcodes[usize::from(lanes > 1)];
        self.word(opcode | u32::from(second) << 16 | u32::from(first) << 5 | u32::from(target));
    }

    /// Loads a number.
    pub fn load(&mut self, lanes: usize, register: u8, address: Address) {
        self.access(lanes, &LOAD, register, address);
    }

    /// Stores a number.
    pub fn store(&mut self, lanes: usize, register: u8, address: Address) {
        self.access(lanes, &STORE, register, address);
    }

    fn access(&mut self, lanes: usize, access: &Access, register: u8, Address { base, displacement }: Address) {
        let (form, unit) = (usize::from(lanes > 1), 8 * lanes as u32);
        let (displacement, operands) = (displacement as u32, (base as u32) << 5 | u32::from(register));
        if displacement.is_multiple_of(unit) && displacement / unit < 1 << 12 {
            self.word(access.short[form] | (displacement / unit) << 10 | operands);
        } else {
            self.set(SPARE, displacement as usize);
            self.word(access.long[form] | SPARE << 16 | operands);
        }
    }

    /// `register = value`, 16 bits at a time.
    fn set(&mut self, register: u32, value: usize) {
        self.word(0xd280_0000 | (value as u32 & 0xffff) << 5 | register);
        for part in (1..4).filter(|part| value >> (16 * part) & 0xffff != 0) {
            self.word(0xf280_0000 | ((part as u32) << 21) | (((value >> (16 * part)) & 0xffff) as u32 * 32) | register);
        }
    }

    /// Makes room on the stack for the bases and saves them, with the place to return to.
    pub fn save_bases(&mut self) {
        // stp x29, x30, [sp, -48]!; stp x0, x1, [sp, 16]; stp x2, x3, [sp, 32]
        [0xa9bd_7bfd, 0xa901_07e0, 0xa902_0fe2].into_iter().for_each(|word| self.word(word));
    }

    /// Loads the bases from where [`save_bases`](Self::save_bases) put them.
    pub fn restore_bases(&mut self) {
        [0xa941_07e0, 0xa942_0fe2].into_iter().for_each(|word| self.word(word));
    }

    /// Calls [`evaluate`] with a record and addresses.
    pub fn call(&mut self, argument: usize, x: Address, y: Address, result: Address) {
        // x0 to x3 are bases themselves: the addresses are made in other registers
        for (register, Address { base, displacement }) in OF_CALL.into_iter().zip([x, y, result]) {
            self.set(SPARE, displacement as usize);
            // add register, base, spare
            self.word(0x8b00_0000 | SPARE << 16 | (base as u32) << 5 | register);
        }
        for (place, register) in (1..).zip(OF_CALL) {
            // mov x1, register and so on
            self.word(0xaa00_03e0 | register << 16 | place);
        }
        self.set(0, argument);
        self.set(SPARE, evaluate as *const () as usize);
        // blr spare
        self.word(0xd63f_0000 | SPARE << 5);
    }

    /// Ends the code; `calls` says if the bases were saved.
    pub fn finish_function(&mut self, calls: bool) {
        if calls {
            // ldp x29, x30, [sp], 48
            self.word(0xa8c3_7bfd);
        }
        // ret
        self.word(0xd65f_03c0);
    }
}

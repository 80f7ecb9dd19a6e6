//! Bytes of the few instructions that programs use.
//!
//! Every vector instruction exists in a VEX form (16 registers, displacements of one byte up to 127) and in an EVEX
//! form (32 registers, displacements of one byte counted in operands) with the same opcode; the shorter one that can
//! express the operands is taken. Layout: Intel 64 and IA-32 Architectures Software Developer's Manual, volume 2,
//! sections 2.3 and 2.7.

use super::call::Call;
use std::arch::is_x86_feature_detected;

/// Instructions available.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// AVX, and AVX2 for more than one lane.
    Avx2,
    /// AVX-512 with its foundation, DQ and VL.
    Avx512,
}

impl Level {
    /// All of them, the best first.
    pub const ALL: [Level; 2] = [Level::Avx512, Level::Avx2];

    /// Whether this processor has it for so many lanes.
    pub fn is_available(self, lanes: usize) -> bool {
        match (self, lanes) {
            (Level::Avx512, _) => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
            (Level::Avx2, 1) => is_x86_feature_detected!("avx"),
            (Level::Avx2, _) => lanes <= 4 && is_x86_feature_detected!("avx2"),
        }
    }

    /// Its vector registers, a bit each.
    pub fn registers(self) -> u32 {
        if self == Level::Avx512 { u32::MAX } else { 0xffff }
    }

    /// Bytes to both sides of a base that the shortest addresses reach.
    pub fn reach(self, lanes: usize) -> usize {
        128 * if self == Level::Avx512 { 8 * lanes } else { 1 }
    }
}

/// Code of a section, with the addresses of inputs, outputs, scratch and constants.
pub type Entry = unsafe extern "sysv64" fn(*const f64, *mut f64, *mut f64, *const f64);

/// [`Call::evaluate`] by the convention of the code.
///
/// # Safety
/// The same.
pub unsafe extern "sysv64" fn evaluate(call: *const Call, x: *const f64, y: *const f64, result: *mut f64) {
    // SAFETY: promised by the caller.
    unsafe { Call::evaluate(call, x, y, result) }
}

/// Nothing: the processor sees new code by itself.
pub fn make_visible(_code: &[u8]) {}

/// An address: a base register and a displacement in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Address {
    pub base: Base,
    pub displacement: i32,
}

/// Registers that hold addresses: the arguments of the code, in the order of the System V convention.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    Inputs = 7,
    Outputs = 6,
    Scratch = 2,
    Constants = 1,
}

/// Last operand of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operand {
    Register(u8),
    Memory(Address),
}

/// An instruction of vectors: opcode map, mandatory prefix and opcode, common to VEX and EVEX.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Opcode {
    map: u8,
    prefix: u8,
    opcode: u8,
    /// Bytes that the form for one lane reads from memory.
    single: i32,
    /// A byte behind the operands.
    last: Option<u8>,
}

const P66: u8 = 1;
const PF2: u8 = 3;

/// Instruction that has a form for one lane (prefix F2) and one for several (66).
const fn arithmetic(opcode: u8) -> [Opcode; 2] {
    [Opcode { map: 1, prefix: PF2, opcode, single: 8, last: None }, packed(1, opcode)]
}

/// Comparison by its predicate.
const fn comparison(predicate: u8) -> [Opcode; 2] {
    let [single, packed] = arithmetic(0xc2);
    [Opcode { last: Some(predicate), ..single }, Opcode { last: Some(predicate), ..packed }]
}

const fn packed(map: u8, opcode: u8) -> Opcode {
    Opcode { map, prefix: P66, opcode, single: 16, last: None }
}

pub const ADD: [Opcode; 2] = arithmetic(0x58);
pub const MUL: [Opcode; 2] = arithmetic(0x59);
pub const SUB: [Opcode; 2] = arithmetic(0x5c);
pub const DIV: [Opcode; 2] = arithmetic(0x5e);
pub const SQRT: [Opcode; 2] = arithmetic(0x51);
/// False for NaN.
pub const LESS: [Opcode; 2] = comparison(0x11);
/// True for NaN.
pub const DIFFERENT: [Opcode; 2] = comparison(0x04);
pub const LOAD: [Opcode; 2] = arithmetic(0x10);
const STORE: [Opcode; 2] = arithmetic(0x11);
/// Rounding to the integer below, without a flag for inexact results.
pub const ROUND_DOWN: [Opcode; 2] =
    [Opcode { single: 8, last: Some(9), ..packed(3, 0x0b) }, Opcode { last: Some(9), ..packed(3, 0x09) }];
pub const AND: Opcode = packed(1, 0x54);
pub const XOR: Opcode = packed(1, 0x57);
/// vblendvpd; VEX only.
const BLEND_BY_SIGN: Opcode = packed(3, 0x4b);
/// vblendmpd; EVEX only.
const BLEND_BY_MASK: Opcode = packed(2, 0x65);

/// Machine code as it grows.
pub struct Encoder {
    bytes: Vec<u8>,
    level: Level,
}

/// Fields of an EVEX prefix beyond the operands.
#[derive(Clone, Copy, Default)]
struct Masking {
    /// Number of the mask register; 0 for none.
    mask: u8,
    /// Lanes outside the mask become 0 instead of keeping their value.
    zeroing: bool,
}

impl Encoder {
    pub fn new(level: Level, capacity: usize) -> Self {
        Encoder { bytes: Vec::with_capacity(capacity), level }
    }

    pub fn finish(self) -> Vec<u8> {
        self.bytes
    }

    /// Bytes so far.
    pub fn length(&self) -> usize {
        self.bytes.len()
    }

    /// `target = first op second`; instructions of one source have `first = 0`.
    pub fn vector(&mut self, lanes: usize, opcode: Opcode, target: u8, first: u8, second: Operand) {
        let low = |register: u8| register < 16;
        let vex = lanes < 8
            && low(target)
            && low(first)
            && match second {
                Operand::Register(register) => low(register),
                // four bytes of displacement against one, for a prefix that is longer by one or two
                Operand::Memory(Address { displacement, .. }) => {
                    self.level == Level::Avx2
                        || i8::try_from(displacement).is_ok()
                        || compressed(lanes, opcode, displacement).is_none()
                }
            };
        if vex {
            self.vex(lanes, opcode, target, first, second);
        } else {
            self.evex(lanes, opcode, target, first, second, Masking::default());
        }
    }

    /// Loads a number.
    pub fn load(&mut self, lanes: usize, register: u8, address: Address) {
        self.vector(lanes, LOAD[usize::from(lanes > 1)], register, 0, Operand::Memory(address));
    }

    /// Stores a number.
    pub fn store(&mut self, lanes: usize, register: u8, address: Address) {
        self.vector(lanes, STORE[usize::from(lanes > 1)], register, 0, Operand::Memory(address));
    }

    /// Compares into mask register 1 (EVEX).
    pub fn compare_to_mask(&mut self, lanes: usize, opcode: Opcode, first: u8, second: Operand) {
        self.evex(lanes, opcode, 1, first, second, Masking::default());
    }

    /// `target = mask register 1 ? first op second : 0` (EVEX).
    pub fn masked(&mut self, lanes: usize, opcode: Opcode, target: u8, first: u8, second: Operand) {
        self.evex(lanes, opcode, target, first, second, Masking { mask: 1, zeroing: true });
    }

    /// `target = mask register 1 ? then : otherwise` (EVEX).
    pub fn blend_by_mask(&mut self, lanes: usize, target: u8, otherwise: u8, then: Operand) {
        self.evex(lanes, BLEND_BY_MASK, target, otherwise, then, Masking { mask: 1, zeroing: false });
    }

    /// `target = sign of mask ? then : otherwise` (VEX).
    pub fn blend_by_sign(&mut self, lanes: usize, target: u8, otherwise: u8, then: Operand, mask: u8) {
        self.vex(lanes, BLEND_BY_SIGN, target, otherwise, then);
        self.bytes.push(mask << 4);
    }

    fn vex(&mut self, lanes: usize, opcode: Opcode, target: u8, first: u8, second: Operand) {
        let extended = matches!(second, Operand::Register(register) if register >= 8);
        let length = if lanes <= 2 { 0 } else { 4 };
        let last = (!first & 15) << 3 | length | opcode.prefix;
        let high_target = u8::from(target < 8) << 7;
        if extended || opcode.map != 1 {
            self.bytes.extend([0xc4, high_target | 0x40 | u8::from(!extended) << 5 | opcode.map, last]);
        } else {
            self.bytes.extend([0xc5, high_target | last]);
        }
        self.bytes.push(opcode.opcode);
        match second {
            Operand::Register(register) => self.bytes.push(0xc0 | (target & 7) << 3 | register & 7),
            Operand::Memory(address) => self.address(target, address, i8::try_from(address.displacement).ok()),
        }
        self.bytes.extend(opcode.last);
    }

    fn evex(&mut self, lanes: usize, opcode: Opcode, target: u8, first: u8, second: Operand, masking: Masking) {
        let register = if let Operand::Register(register) = second { register } else { 0 };
        let unless = |set: u8, bit: u8| u8::from(set == 0) << bit;
        let length = match lanes {
            1 | 2 => 0,
            4 => 1,
            _ => 2,
        };
        self.bytes.extend([
            0x62,
            unless(target & 8, 7) | unless(register & 16, 6) | unless(register & 8, 5) | unless(target & 16, 4) | opcode.map,
            0x80 | (!first & 15) << 3 | 4 | opcode.prefix,
            u8::from(masking.zeroing) << 7 | length << 5 | unless(first & 16, 3) | masking.mask,
            opcode.opcode,
        ]);
        match second {
            Operand::Register(register) => self.bytes.push(0xc0 | (target & 7) << 3 | register & 7),
            Operand::Memory(address) => self.address(target, address, compressed(lanes, opcode, address.displacement)),
        }
        self.bytes.extend(opcode.last);
    }

    /// The bytes that name a register and an address; `short` is its displacement in one byte.
    fn address(&mut self, register: u8, address: Address, short: Option<i8>) {
        let fields = (register & 7) << 3 | address.base as u8;
        if address.displacement == 0 {
            self.bytes.push(fields);
        } else if let Some(short) = short {
            self.bytes.extend([0x40 | fields, short as u8]);
        } else {
            self.bytes.push(0x80 | fields);
            self.bytes.extend(address.displacement.to_le_bytes());
        }
    }

    /// Makes room on the stack for the bases and saves them; the stack is aligned for calls from then on.
    pub fn save_bases(&mut self) {
        // sub rsp, 40
        self.bytes.extend([0x48, 0x83, 0xec, 40]);
        for (place, base) in BASES.into_iter().enumerate() {
            // mov [rsp + 8 place], base
            self.bytes.extend([0x48, 0x89, 0x44 | (base as u8) << 3, 0x24, 8 * place as u8]);
        }
    }

    /// Loads the bases from where [`save_bases`](Self::save_bases) put them.
    pub fn restore_bases(&mut self) {
        for (place, base) in BASES.into_iter().enumerate() {
            self.bytes.extend([0x48, 0x8b, 0x44 | (base as u8) << 3, 0x24, 8 * place as u8]);
        }
    }

    /// Calls [`evaluate`] with a record and addresses.
    pub fn call(&mut self, argument: usize, x: Address, y: Address, result: Address) {
        self.zero_upper();
        // rsi, rdx and rcx are bases themselves: the new values are made in r8, r9 and r10
        for (register, address) in [(0, x), (1, y), (2, result)] {
            // lea r8 + register, [base + displacement]
            self.bytes.extend([0x4c, 0x8d, 0x80 | register << 3 | address.base as u8]);
            self.bytes.extend(address.displacement.to_le_bytes());
        }
        // mov rsi, r8; mov rdx, r9; mov rcx, r10
        self.bytes.extend([0x4c, 0x89, 0xc6, 0x4c, 0x89, 0xca, 0x4c, 0x89, 0xd1]);
        // mov rdi, argument; mov rax, function; call rax
        self.bytes.extend([0x48, 0xbf]);
        self.bytes.extend(argument.to_le_bytes());
        self.bytes.extend([0x48, 0xb8]);
        self.bytes.extend((evaluate as *const () as usize).to_le_bytes());
        self.bytes.extend([0xff, 0xd0]);
    }

    /// Ends the code; `calls` says if the bases were saved.
    pub fn finish_function(&mut self, calls: bool) {
        self.zero_upper();
        if calls {
            // add rsp, 40
            self.bytes.extend([0x48, 0x83, 0xc4, 40]);
        }
        self.bytes.push(0xc3);
    }

    fn zero_upper(&mut self) {
        self.bytes.extend([0xc5, 0xf8, 0x77]);
    }
}

const BASES: [Base; 4] = [Base::Inputs, Base::Outputs, Base::Scratch, Base::Constants];

/// A displacement in one byte, as EVEX counts it: in units of the operand.
fn compressed(lanes: usize, opcode: Opcode, displacement: i32) -> Option<i8> {
    let unit = if lanes == 1 { opcode.single } else { 8 * lanes as i32 };
    if displacement % unit == 0 { i8::try_from(displacement / unit).ok() } else { None }
}

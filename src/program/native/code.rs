//! Machine code in executable memory.

use super::REFUSED;
use super::emitter::{Emitted, emit};
use super::encoder::{Entry, Level, make_visible};
use crate::listing::Listing;
use memmap2::{Mmap, MmapMut};
use std::sync::atomic::Ordering;

/// Bytes of a section: the caches for instructions hold it, and moving numbers out of the registers at its end costs nothing.
const SECTION: usize = 1 << 15;

/// Machine code of a listing.
#[derive(Debug)]
pub struct NativeCode {
    lanes: usize,
    inputs: usize,
    outputs: usize,
    /// Executable, not writable.
    memory: Mmap,
    /// Constants for all lanes, aligned to a cache line.
    constants: Box<[CacheLine]>,
    /// What the code was emitted with, beside its bytes: the calls that it has the addresses of among it.
    emitted: Emitted,
}

/// Eight numbers that no other cache line holds.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct CacheLine([f64; 8]);

impl NativeCode {
    /// Makes code for this machine; none where its processor lacks the instructions or the system refuses.
    pub fn compile(listing: &Listing, lanes: usize) -> Option<Self> {
        Level::ALL.into_iter().find_map(|level| Self::compile_for(listing, lanes, level, SECTION))
    }

    /// As [`compile`](Self::compile), with the instructions of one level only and sections of a length in bytes.
    pub fn compile_for(listing: &Listing, lanes: usize, level: Level, section: usize) -> Option<Self> {
        if !level.is_available(lanes) {
            return None;
        }
        let mut emitted = emit(listing, lanes, level, section)?;
        let (bytes, constants) = (std::mem::take(&mut emitted.bytes), std::mem::take(&mut emitted.constants));
        let executable = || -> std::io::Result<Mmap> {
            let mut memory = MmapMut::map_anon(bytes.len())?;
            memory.copy_from_slice(&bytes);
            memory.make_exec()
        };
        let Ok(memory) = executable() else {
            REFUSED.store(true, Ordering::Relaxed);
            return None;
        };
        make_visible(&memory);
        let constants = constants
            .chunks(8)
            .map(|chunk| CacheLine(std::array::from_fn(|i| chunk.get(i).copied().unwrap_or(0.0))))
            .collect();
        let (inputs, outputs) = (listing.inputs, listing.outputs.len());
        Some(NativeCode { lanes, inputs, outputs, memory, constants, emitted })
    }

    /// Number of sections: code that is longer than the caches for instructions has several.
    pub fn sections(&self) -> usize {
        self.emitted.sections.len()
    }

    /// Executes one section, for the inputs, outputs and scratch with which those before it were executed.
    ///
    /// With n lanes, number i of element l stands at n i + l, for inputs and outputs.
    ///
    /// Eight lanes run faster where inputs and outputs start at a multiple of 64 bytes.
    ///
    /// * `scratch` grows to the length that is needed, and may be shared with other programs
    pub fn run_section(&self, section: usize, inputs: &[f64], outputs: &mut [f64], scratch: &mut Vec<f64>) {
        let (lanes, Emitted { sections, scratch: scratch_length, biases, .. }) = (self.lanes, &self.emitted);
        assert_eq!(inputs.len(), lanes * self.inputs, "inputs: their number times {lanes}");
        assert_eq!(outputs.len(), lanes * self.outputs, "outputs: their number times {lanes}");
        // seven more than needed, so that some place among them starts a cache line
        if scratch.len() < scratch_length + 7 {
            scratch.resize(scratch_length + 7, 0.0);
        }
        let start = scratch.as_ptr().align_offset(64).min(7);
        let scratch = &mut scratch[start..][..*scratch_length];
        let begin = &self.memory[sections[section]..];
        // SAFETY: at the start of each section `memory` holds a whole function of this type, which `emit` made for a listing with these
        // numbers of inputs and outputs: it reads `inputs` and `constants`, writes `outputs` and `scratch`, and reads of them what it or
        // those before it wrote, or other numbers if they were not called. It keeps the convention of the type. The processor has its instructions: `compile_for` asked.
        unsafe {
            let entry = std::mem::transmute::<*const u8, Entry>(begin.as_ptr());
            entry(
                inputs.as_ptr().wrapping_byte_add(biases[0]),
                outputs.as_mut_ptr().wrapping_byte_add(biases[1]),
                scratch.as_mut_ptr().wrapping_byte_add(biases[2]),
                self.constants.as_ptr().cast::<f64>().wrapping_byte_add(biases[3]),
            );
        }
    }
}

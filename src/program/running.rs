use super::listing::Listing;
use super::loop_code::{F64x8, LoopCode};
use super::native::NativeCode;
use super::operation::Operation;
use crate::scalar::Scalar;
use std::cell::Cell;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

static MAKING: AtomicU64 = AtomicU64::new(0);

thread_local! {
    static IS_MAKING: Cell<bool> = const { Cell::new(false) };
}

/// Whether programs are executed by a loop over their operations whatever the processor has, for who sets COSTATE_PROGRAMS=loop: for this process
/// once and for all. Results have the same bits either way.
fn is_looped() -> bool {
    static IS_LOOPED: OnceLock<bool> = OnceLock::new();
    *IS_LOOPED.get_or_init(|| std::env::var_os("COSTATE_PROGRAMS").is_some_and(|way| way == "loop"))
}

/// Time that this process has spent on programs \[s\]: recording formulas, deriving programs from them, and making machine code.
pub fn making_time() -> f64 {
    MAKING.load(Ordering::Relaxed) as f64 * 1e-9
}

/// Counts the time until it is dropped as [`making_time`]; one inside another counts nothing.
pub(super) struct Making(Option<Instant>);

impl Making {
    pub fn begin() -> Self {
        Making((!IS_MAKING.replace(true)).then(Instant::now))
    }
}

impl Drop for Making {
    fn drop(&mut self) {
        if let Some(begun) = self.0 {
            MAKING.fetch_add(begun.elapsed().as_nanos() as u64, Ordering::Relaxed);
            IS_MAKING.set(false);
        }
    }
}

/// Something that can be executed for one element, for several side by side, and in any scalar.
#[derive(Debug)]
pub struct Program {
    listing: Listing,
    labels: Vec<u32>,
    looped: OnceLock<LoopCode>,
    native: [OnceLock<Option<NativeCode>>; 2],
}

/// Numbers that programs need on the way.
#[derive(Clone, Debug)]
pub struct ProgramWork<S> {
    slots: Vec<S>,
    lanes: Vec<F64x8>,
    scratch: Vec<f64>,
}

impl<S> Default for ProgramWork<S> {
    fn default() -> Self {
        ProgramWork { slots: Vec::new(), lanes: Vec::new(), scratch: Vec::new() }
    }
}

impl Program {
    /// Of a listing, with a number for each of its results.
    pub(super) fn new(listing: Listing, labels: Vec<u32>) -> Self {
        Program { listing, labels, looped: OnceLock::new(), native: [OnceLock::new(), OnceLock::new()] }
    }

    /// How many operations are executed.
    pub fn instructions(&self) -> usize {
        self.listing.instructions
    }
    /// What each result is.
    pub fn labels(&self) -> &[u32] {
        &self.labels
    }
    /// Which arguments are read.
    pub fn reads(&self) -> Vec<bool> {
        let mut reads = vec![false; self.listing.inputs];
        for operation in &self.listing.operations {
            if let Operation::Input(input) = *operation {
                reads[input as usize] = true;
            }
        }
        reads
    }
    /// Number of arguments.
    pub fn inputs(&self) -> usize {
        self.listing.inputs
    }
    /// Number of results.
    pub fn outputs(&self) -> usize {
        self.listing.outputs.len()
    }

    fn looped(&self) -> &LoopCode {
        self.looped.get_or_init(|| LoopCode::new(&self.listing))
    }

    fn native(&self, place: usize, lanes: usize) -> Option<&NativeCode> {
        if is_looped() {
            return None;
        }
        let compile = || {
            let _making = Making::begin();
            NativeCode::compile(&self.listing, lanes)
        };
        self.native[place].get_or_init(compile).as_ref()
    }

    /// Executes it in any scalar.
    pub fn run_in<S: Scalar>(&self, inputs: &[S], outputs: &mut [S], work: &mut ProgramWork<S>) {
        self.looped().run(inputs, outputs, &mut work.slots);
    }

    /// Executes it for one element.
    pub fn run(&self, inputs: &[f64], outputs: &mut [f64], work: &mut ProgramWork<f64>) {
        match self.native(0, 1) {
            Some(code) => {
                (0..code.sections()).for_each(|section| code.run_section(section, inputs, outputs, &mut work.scratch));
            }
            None => self.looped().run(inputs, outputs, &mut work.slots),
        }
    }

    /// Executes one of its [`sections`](Self::sections) for [`lanes`] elements, whose numbers lie side by side: those before it were executed
    /// with the same arguments, results and workspace.
    pub fn run_section(&self, section: usize, inputs: &[f64], outputs: &mut [f64], work: &mut ProgramWork<f64>) {
        match self.native_of_lanes() {
            Some(code) => code.run_section(section, inputs, outputs, &mut work.scratch),
            None if lanes() == 2 => self.looped().run_lanes::<2>(inputs, outputs, &mut work.lanes),
            None if lanes() == 4 => self.looped().run_lanes::<4>(inputs, outputs, &mut work.lanes),
            None => self.looped().run_lanes::<8>(inputs, outputs, &mut work.lanes),
        }
    }

    /// Number of parts that are executed one after the other. Code that the caches for instructions do not hold comes from far for each
    /// call: several groups of elements go through one section, then through the next.
    pub fn sections(&self) -> usize {
        self.native_of_lanes().map_or(1, NativeCode::sections)
    }

    fn native_of_lanes(&self) -> Option<&NativeCode> {
        self.native(1, lanes())
    }
}

/// Elements that this processor handles side by side, however programs are executed: 2 on aarch64, 4 where it
/// has AVX2 but not AVX-512, otherwise 8.
pub fn lanes() -> usize {
    static LANES: OnceLock<usize> = OnceLock::new();
    *LANES.get_or_init(|| NativeCode::most_lanes().filter(|&lanes| lanes > 1).unwrap_or(8))
}

//! An order of a listing's instructions in which equal operations stand together, as far as their operands allow.
//!
//! It changes no bit of a result, since each instruction keeps its operands.

use super::listing::{Instruction, Listing, Source};
use super::operation::{Binary, Unary};

/// Instructions beyond the first unfinished one that may be moved in front of it; more makes the batches longer and
/// the number of values alive at a time larger.
const WINDOW: usize = 1024;

/// What all instructions of a batch do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Unary(Unary),
    Binary(Binary),
    Select,
    Power(f64),
    Curve { curve: u32, order: u32 },
    Gather { first: u32, count: u32 },
}

impl Kind {
    pub fn of(instruction: Instruction) -> Self {
        match instruction {
            Instruction::Unary(function, _) => Kind::Unary(function),
            Instruction::Binary(function, _, _) => Kind::Binary(function),
            Instruction::Power(_, exponent) => Kind::Power(exponent),
            Instruction::Select(..) => Kind::Select,
            Instruction::Curve { curve, order, .. } => Kind::Curve { curve, order },
            Instruction::Gather { first, count, .. } => Kind::Gather { first, count },
        }
    }

    /// Number of the queue in which instructions of this kind wait.
    fn queue(self) -> usize {
        match self {
            Kind::Unary(function) => function as usize,
            Kind::Binary(function) => 14 + function as usize,
            Kind::Select => 21,
            Kind::Power(_) => 22,
            Kind::Curve { .. } => 23,
            Kind::Gather { .. } => 24,
        }
    }
}

/// Which instructions an output depends on.
fn needed_instructions(listing: &Listing) -> Vec<bool> {
    let mut needed = vec![false; listing.instructions.len()];
    for output in &listing.outputs {
        if let Source::Value(value) = output {
            needed[*value as usize] = true;
        }
    }
    for number in (0..listing.instructions.len()).rev() {
        if needed[number] {
            listing.instructions[number].for_each_source(|source| {
                if let Source::Value(value) = source {
                    needed[value as usize] = true;
                }
            });
        }
    }
    needed
}

/// Who waits for whom.
struct Readers {
    /// Where the readers of each value begin, and the end.
    first: Vec<usize>,
    readers: Vec<usize>,
    /// For how many operands each instruction waits.
    missing: Vec<u8>,
}

impl Readers {
    fn of(listing: &Listing, needed: &[bool]) -> Self {
        let count = needed.len();
        let mut first = vec![0; count + 1];
        let mut missing = vec![0_u8; count];
        let for_each_edge = |visit: &mut dyn FnMut(usize, usize)| {
            for number in (0..count).filter(|&number| needed[number]) {
                listing.instructions[number].for_each_source(|source| {
                    if let Source::Value(value) = source {
                        visit(value as usize, number);
                    }
                });
            }
        };
        for_each_edge(&mut |value, reader| {
            first[value + 1] += 1;
            missing[reader] += 1;
        });
        for value in 0..count {
            first[value + 1] += first[value];
        }
        let mut readers = vec![0; first[count]];
        let mut filled = first.clone();
        for_each_edge(&mut |value, reader| {
            readers[filled[value]] = reader;
            filled[value] += 1;
        });
        Readers { first, readers, missing }
    }
}

/// The instructions that outputs depend on: operands before results, equal operations together.
///
/// # Panics
/// Where operands of the listing do not come before their results.
pub fn batched_order(listing: &Listing) -> Vec<usize> {
    let needed = needed_instructions(listing);
    let count = listing.instructions.len();
    let Readers { first: first_reader, readers, mut missing } = Readers::of(listing, &needed);
    let mut order = Vec::new();
    let mut done = vec![false; count];
    let mut queues: [Vec<usize>; 25] = Default::default();
    // instructions from `window_end` on wait until the first unfinished one comes near
    let (mut first_open, mut window_end) = (0, 0);
    loop {
        while first_open < count && (done[first_open] || !needed[first_open]) {
            first_open += 1;
        }
        while window_end < count.min(first_open + WINDOW) {
            if needed[window_end] && missing[window_end] == 0 {
                queues[Kind::of(listing.instructions[window_end]).queue()].push(window_end);
            }
            window_end += 1;
        }
        let longest = (0..queues.len()).max_by_key(|&queue| queues[queue].len()).unwrap_or(0);
        if queues[longest].is_empty() {
            let all = needed.iter().filter(|&&needed| needed).count();
            assert_eq!(order.len(), all, "each instruction once, and operands before results");
            return order;
        }
        // the queue grows by instructions of its kind for which these make the last operand
        let mut next = 0;
        while next < queues[longest].len() {
            let number = queues[longest][next];
            next += 1;
            order.push(number);
            done[number] = true;
            for &reader in &readers[first_reader[number]..first_reader[number + 1]] {
                missing[reader] -= 1;
                if missing[reader] == 0 && reader < window_end {
                    queues[Kind::of(listing.instructions[reader]).queue()].push(reader);
                }
            }
        }
        queues[longest].clear();
    }
}

//! An order of a listing's operations in which equal ones stand together, as far as their operands allow.
//!
//! It changes no bit of a result, since each operation keeps its operands.

use super::listing::Listing;
use super::operation::Operation;
use smallvec::SmallVec;

/// Operations beyond the first unfinished one that may be moved in front of it; more makes the batches longer and
/// the number of values alive at a time larger.
const WINDOW: usize = 1024;

/// Number of the queue in which operations of a kind wait.
fn queue(operation: Operation) -> usize {
    match operation {
        Operation::Unary(function, _) => function as usize,
        Operation::Binary(function, ..) => 14 + function as usize,
        Operation::Select(_) => 21,
        Operation::Power(..) => 22,
        Operation::Curve { .. } => 23,
        Operation::Gather { .. } => 24,
        Operation::Input(_) | Operation::Constant(_) => unreachable!("not executed"),
    }
}

/// The operations that are executed: operands before results, equal operations together.
pub fn batched_order(listing: &Listing) -> Vec<usize> {
    let (operations, count) = (&listing.operations, listing.operations.len());
    // who waits for each value, and for how many operands each operation waits
    let mut readers: Vec<SmallVec<[usize; 2]>> = vec![SmallVec::new(); count];
    let mut missing = vec![0; count];
    for number in listing.executed() {
        for operand in operations[number].operands() {
            if !operations[operand].is_leaf() {
                readers[operand].push(number);
                missing[number] += 1;
            }
        }
    }
    let mut order = Vec::new();
    let mut done: Vec<bool> = operations.iter().map(|own| own.is_leaf()).collect();
    let mut queues: [Vec<usize>; 25] = Default::default();
    // operations from `window_end` on wait until the first unfinished one comes near
    let (mut first_open, mut window_end) = (0, 0);
    loop {
        while first_open < count && done[first_open] {
            first_open += 1;
        }
        while window_end < count.min(first_open + WINDOW) {
            if !operations[window_end].is_leaf() && missing[window_end] == 0 {
                queues[queue(operations[window_end])].push(window_end);
            }
            window_end += 1;
        }
        let longest = (0..queues.len()).max_by_key(|&queue| queues[queue].len()).unwrap_or(0);
        if queues[longest].is_empty() {
            return order;
        }
        // the queue grows by operations of its kind for which these make the last operand
        let mut next = 0;
        while next < queues[longest].len() {
            let number = queues[longest][next];
            next += 1;
            order.push(number);
            done[number] = true;
            for &reader in &readers[number] {
                missing[reader] -= 1;
                if missing[reader] == 0 && reader < window_end {
                    queues[queue(operations[reader])].push(reader);
                }
            }
        }
        queues[longest].clear();
    }
}

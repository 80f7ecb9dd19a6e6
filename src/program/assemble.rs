//! From recordings to listings.

use super::graph::Graph;
use super::listing::{Instruction, Listing, Source};
use super::operation::{Node, Operation};
use std::collections::HashMap;

impl Listing {
    /// The operations that some nodes of a recording with `inputs` arguments are made of.
    pub fn of(graph: &Graph, outputs: &[Node], inputs: usize) -> Self {
        let needed = graph.needed(outputs);
        let mut listing = Listing { inputs, curves: graph.curves().to_vec(), ..Listing::default() };
        let mut constants: HashMap<u64, u32> = HashMap::new();
        let mut sources = vec![Source::Input(0); needed.len()];
        for (index, &operation) in graph.operations().iter().enumerate().take(needed.len()) {
            if !needed[index] {
                continue;
            }
            let source = |node: Node| sources[node.0 as usize];
            let instruction = match operation {
                Operation::Input(input) => {
                    sources[index] = Source::Input(input);
                    continue;
                }
                Operation::Constant(bits) => {
                    let place = *constants.entry(bits).or_insert_with(|| {
                        listing.constants.push(f64::from_bits(bits));
                        listing.constants.len() as u32 - 1
                    });
                    sources[index] = Source::Constant(place);
                    continue;
                }
                Operation::Unary(function, x) => Instruction::Unary(function, source(x)),
                Operation::Binary(function, x, y) => Instruction::Binary(function, source(x), source(y)),
                Operation::Power(x, bits) => Instruction::Power(source(x), f64::from_bits(bits)),
                Operation::Select([mask, then, otherwise]) => {
                    Instruction::Select(source(mask), source(then), source(otherwise))
                }
                Operation::Curve { curve, order, at } => Instruction::Curve { curve, order, at: source(at) },
                Operation::Gather { first, count, at } => match source(first) {
                    Source::Input(first) => Instruction::Gather { first, count, at: source(at) },
                    other => unreachable!("{other:?} is gathered and no argument"),
                },
            };
            sources[index] = Source::Value(listing.instructions.len() as u32);
            listing.instructions.push(instruction);
        }
        listing.outputs = outputs.iter().map(|output| sources[output.0 as usize]).collect();
        listing
    }
}

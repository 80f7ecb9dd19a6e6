//! A straight line of operations: what a recording is executed from.

use super::graph::Graph;
use super::operation::{Node, Operation};
use crate::scalar::Curve;
use std::sync::Arc;

/// Operations in the order of their execution, without jumps: those that some results of a recording are made of.
///
/// Nodes are places in this list.
#[derive(Clone, Debug, Default)]
pub struct Listing {
    /// Number of arguments.
    pub inputs: usize,
    /// Operations; operands come before them, what is gathered stands side by side.
    pub operations: Vec<Operation>,
    /// Curves.
    pub curves: Vec<Arc<Curve>>,
    /// Where each result is read.
    pub outputs: Vec<Node>,
    /// How many operations are neither arguments nor constants.
    pub instructions: usize,
}

impl Listing {
    /// The operations that some nodes of a recording with `inputs` arguments are made of.
    ///
    /// # Panics
    /// If the recording reads more arguments: a mistake of the library.
    pub fn of(graph: &Graph, outputs: &[Node], inputs: usize) -> Self {
        let needed = graph.needed(outputs);
        let mut places = vec![Node(0); needed.len()];
        let mut operations = Vec::new();
        for ((place, &operation), _) in places.iter_mut().zip(graph.operations()).zip(&needed).filter(|(_, needed)| **needed)
        {
            *place = Node(operations.len() as u32);
            operations.push(operation);
        }
        for operation in &mut operations {
            *operation = operation.map(|operand| places[operand.0 as usize]);
            assert!(!matches!(*operation, Operation::Input(input) if input as usize >= inputs), "of {inputs} arguments");
        }
        let outputs = outputs.iter().map(|output| places[output.0 as usize]).collect();
        let instructions = operations.iter().filter(|own| !own.is_leaf()).count();
        Listing { inputs, operations, curves: graph.curves().to_vec(), outputs, instructions }
    }

    /// Constants, in their order.
    pub fn constants(&self) -> impl Iterator<Item = f64> {
        self.operations.iter().filter_map(|own| match own {
            Operation::Constant(bits) => Some(f64::from_bits(*bits)),
            _ => None,
        })
    }

    /// Numbers of the operations that are executed.
    pub fn executed(&self) -> impl DoubleEndedIterator<Item = usize> {
        (0..self.operations.len()).filter(|&number| !self.operations[number].is_leaf())
    }
}

//! Interpolated numbers: sums of constant weights times arguments, of which formulas of flexible elements are made.

use super::graph::Graph;
use super::operation::{Binary, Node, Operation, Unary};
use std::collections::HashMap;

/// A sum of constant weights times arguments of some lists: the same sum may be taken of several lists (accelerations, velocities,
/// coordinates).
#[derive(Clone, Debug)]
pub struct LinearForm {
    /// Places in a list with their weights.
    pub weights: Vec<(usize, f64)>,
    /// The nodes that are this sum of each list.
    pub nodes: [Vec<Node>; 3],
}

/// A sum of arguments of one list.
#[derive(Clone, Debug)]
struct Sum {
    list: usize,
    weights: Vec<(usize, f64)>,
}

impl Sum {
    fn scaled(&self, factor: f64) -> Self {
        Sum { list: self.list, weights: self.weights.iter().map(|&(place, weight)| (place, weight * factor)).collect() }
    }
    fn plus(&self, other: &Self, sign: f64) -> Option<Self> {
        if self.list != other.list {
            return None;
        }
        let mut weights = self.weights.clone();
        for &(place, weight) in &other.weights {
            match weights.iter_mut().find(|(own, _)| *own == place) {
                Some((_, own)) => *own += sign * weight,
                None => weights.push((place, sign * weight)),
            }
        }
        weights.sort_unstable_by_key(|(place, _)| *place);
        weights.retain(|(_, weight)| *weight != 0.0);
        Some(Sum { list: self.list, weights })
    }
}

impl Graph {
    /// The sums of arguments through which results depend on them: where these are linear no longer. Each list has `length` arguments
    /// from its start on.
    pub fn linear_forms(&self, outputs: &[Node], starts: [usize; 3], length: usize) -> Vec<LinearForm> {
        let needed = self.needed(outputs);
        let mut sums: Vec<Option<Sum>> = vec![None; needed.len()];
        let mut ends = vec![false; needed.len()];
        for index in (0..needed.len()).filter(|&index| needed[index]) {
            let sum = |node: Node| sums[node.0 as usize].as_ref();
            let own = match self.operations()[index] {
                Operation::Input(input) => {
                    let list = starts.iter().position(|&start| (start..start + length).contains(&(input as usize)));
                    list.map(|list| Sum { list, weights: vec![(input as usize - starts[list], 1.0)] })
                }
                Operation::Unary(Unary::Neg, x) => sum(x).map(|x| x.scaled(-1.0)),
                Operation::Binary(Binary::Add, x, y) => sum(x).zip(sum(y)).and_then(|(x, y)| x.plus(y, 1.0)),
                Operation::Binary(Binary::Sub, x, y) => sum(x).zip(sum(y)).and_then(|(x, y)| x.plus(y, -1.0)),
                Operation::Binary(Binary::Mul, x, y) => match (self.constant_of(x), self.constant_of(y)) {
                    (Some(factor), None) => sum(y).map(|y| y.scaled(factor)),
                    (None, Some(factor)) => sum(x).map(|x| x.scaled(factor)),
                    _ => None,
                },
                _ => None,
            };
            if own.is_none() {
                self.operations()[index].for_each_operand(|operand| ends[operand.0 as usize] = true);
            }
            sums[index] = own;
        }
        outputs.iter().for_each(|output| ends[output.0 as usize] = true);
        let mut forms: Vec<LinearForm> = Vec::new();
        let mut places: HashMap<Vec<(usize, u64)>, usize> = HashMap::new();
        for (index, sum) in sums.into_iter().enumerate().filter(|(index, _)| ends[*index]) {
            let Some(Sum { list, weights }) = sum else { continue };
            let key = weights.iter().map(|(place, weight)| (*place, weight.to_bits())).collect();
            let place = *places.entry(key).or_insert_with(|| {
                forms.push(LinearForm { weights, nodes: Default::default() });
                forms.len() - 1
            });
            forms[place].nodes[list].push(Node(index as u32));
        }
        forms
    }
}

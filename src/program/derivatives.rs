//! Derivatives of recorded formulas: recordings again, which can be differentiated once more.

use super::graph::Graph;
use super::operation::{Binary, Node, Operation, Unary};
use super::recorded::continued;
use smallvec::{SmallVec, smallvec};

/// A partial derivative of an operation towards an operand.
#[derive(Clone, Copy, Debug)]
enum Partial {
    One,
    MinusOne,
    Factor(Node),
    /// May be infinite: what is multiplied by it stays 0 where it is 0.
    Steep(Node),
    /// Times what comes from the other side, where the first operand is not 0.
    Guarded(Node),
    /// Only where the mask is not 0 (or, with false, where it is).
    Where(Node, bool),
    /// Only where the node is this whole number.
    At(Node, u32),
}

impl Graph {
    /// Partial derivatives of an operation towards its operands.
    fn partials(&mut self, node: Node) -> SmallVec<[(Node, Partial); 2]> {
        use Partial::{Factor, Steep, Where};
        match self.operation(node) {
            Operation::Input(_) | Operation::Constant(_) => smallvec![],
            Operation::Binary(Binary::Less, ..) | Operation::Unary(Unary::Floor, _) => smallvec![],
            Operation::Unary(Unary::Neg, x) => smallvec![(x, Partial::MinusOne)],
            Operation::Unary(function, x) => {
                let slope = continued(self, &[x], |x| vec![function.with_slope(x[0])[1]])[0];
                let may_be_infinite = matches!(function, Unary::Sqrt | Unary::Ln | Unary::Asin | Unary::Acos);
                smallvec![(x, if may_be_infinite { Steep(slope) } else { Factor(slope) })]
            }
            Operation::Binary(function, x, y) => self.slopes(function, [x, y], node),
            Operation::Power(x, bits) => {
                let exponent = f64::from_bits(bits);
                if exponent == 0.0 {
                    return smallvec![];
                }
                let reduced = self.power(x, exponent - 1.0);
                smallvec![(x, Steep(self.scaled(reduced, exponent)))]
            }
            Operation::Select([mask, then, otherwise]) => {
                smallvec![(then, Where(mask, true)), (otherwise, Where(mask, false))]
            }
            Operation::Curve { curve, order, at } => {
                smallvec![(at, Factor(self.on_own_curve(curve, order + 1, at)))]
            }
            Operation::Gather { first, count, at } => {
                (0..count).map(|place| (Node(first.0 + place), Partial::At(at, place))).collect()
            }
        }
    }

    /// Of a function of two numbers whose value is a node.
    fn slopes(&mut self, function: Binary, [x, y]: [Node; 2], node: Node) -> SmallVec<[(Node, Partial); 2]> {
        use Partial::{Factor, Guarded, MinusOne, One, Steep};
        match function {
            Binary::Add => smallvec![(x, One), (y, One)],
            Binary::Sub if x == y => smallvec![],
            Binary::Sub => smallvec![(x, One), (y, MinusOne)],
            Binary::Mul => smallvec![(x, Factor(y)), (y, Factor(x))],
            Binary::Div => {
                let one = self.constant(1.0);
                let inverse = self.div(one, y);
                let product = self.mul(node, inverse);
                smallvec![(x, Factor(inverse)), (y, Factor(self.neg(product)))]
            }
            Binary::Atan2 => {
                let (xx, yy) = (self.mul(x, x), self.mul(y, y));
                let square = self.add(xx, yy);
                let (along, across) = (self.div(y, square), self.div(x, square));
                smallvec![(x, Steep(along)), (y, Steep(self.neg(across)))]
            }
            Binary::Vanishing => smallvec![(x, Steep(y)), (y, Guarded(x))],
            Binary::Less => smallvec![],
        }
    }

    /// A partial derivative times what comes along the chain.
    fn along(&mut self, partial: Partial, x: Node) -> Node {
        match partial {
            Partial::One => x,
            Partial::MinusOne => self.neg(x),
            Partial::Factor(factor) => self.mul(x, factor),
            Partial::Steep(factor) => self.binary(Binary::Vanishing, x, factor),
            Partial::Guarded(factor) => self.binary(Binary::Vanishing, factor, x),
            Partial::Where(mask, taken) => {
                let zero = self.zero();
                if taken { self.select(mask, x, zero) } else { self.select(mask, zero, x) }
            }
            Partial::At(at, place) => {
                let elsewhere = self.differs(at, place);
                self.along(Partial::Where(elsewhere, false), x)
            }
        }
    }

    /// Derivatives of some nodes along the motion of others: one sweep from the arguments on.
    ///
    /// `seeds` gives the derivative of some nodes, usually inputs; what is not on the list and depends on nothing there does not move.
    pub fn forward(&mut self, outputs: &[Node], seeds: &[(Node, Node)]) -> Vec<Node> {
        let needed = self.needed(outputs);
        let zero = self.zero();
        let mut tangents = vec![zero; needed.len()];
        let mut seeded = vec![false; needed.len()];
        for &(node, tangent) in seeds.iter().filter(|(node, _)| (node.0 as usize) < needed.len()) {
            tangents[node.0 as usize] = tangent;
            seeded[node.0 as usize] = true;
        }
        for index in (0..needed.len()).filter(|&index| needed[index] && !seeded[index]) {
            let mut moves = false;
            self.operations()[index].for_each_operand(|operand| moves |= tangents[operand.0 as usize] != zero);
            if !moves {
                continue;
            }
            let node = Node(index as u32);
            if let Operation::Select([mask, then, otherwise]) = self.operation(node) {
                let [then, otherwise] = [then, otherwise].map(|side| tangents[side.0 as usize]);
                tangents[index] = self.select(mask, then, otherwise);
                continue;
            }
            if let Operation::Gather { first, count, at } = self.operation(node) {
                let parts = tangents[first.0 as usize..][..count as usize].to_vec();
                tangents[index] = self.gather(&parts, at);
                continue;
            }
            let mut sum = zero;
            for (operand, partial) in self.partials(node) {
                let tangent = tangents[operand.0 as usize];
                if tangent != zero {
                    let term = self.along(partial, tangent);
                    sum = self.add(sum, term);
                }
            }
            tangents[index] = sum;
        }
        outputs.iter().map(|output| tangents[output.0 as usize]).collect()
    }

    /// The gradient of sum of weights times outputs towards some nodes: one sweep back from the outputs.
    ///
    /// # Panics
    /// If there are not as many weights as outputs: a mistake of the library.
    pub fn reverse(&mut self, outputs: &[Node], weights: &[Node], towards: &[Node]) -> Vec<Node> {
        assert_eq!(outputs.len(), weights.len(), "each output has a weight");
        let zero = self.zero();
        let needed = self.needed(outputs);
        // only what depends on the nodes that are asked for
        let mut asked = vec![false; needed.len()];
        towards.iter().filter(|node| (node.0 as usize) < needed.len()).for_each(|node| asked[node.0 as usize] = true);
        let depends = self.depending_on(asked.clone(), &needed);
        let (guarded, under_roots) = (self.perhaps_left_aside(&needed), self.under_roots(&needed));
        let mut seeds = vec![zero; needed.len()];
        for (output, &weight) in outputs.iter().zip(weights) {
            let bar = seeds[output.0 as usize];
            seeds[output.0 as usize] = self.add(bar, weight);
        }
        for index in (0..needed.len()).rev() {
            let bar = seeds[index];
            if !needed[index] || !depends[index] || bar == zero || asked[index] && self.operations()[index].is_leaf() {
                continue;
            }
            for (operand, partial) in self.partials(Node(index as u32)) {
                if depends[operand.0 as usize] {
                    let partial = match partial {
                        // the adjoint of what stands under a root of 0 is infinite, and has no part along what does not move
                        Partial::Factor(factor) if under_roots[index] => Partial::Guarded(factor),
                        // what a choice leaves aside may be no number, and has an adjoint of 0
                        Partial::Factor(factor) if guarded[index] => Partial::Steep(factor),
                        partial => partial,
                    };
                    let mut term = self.along(partial, bar);
                    if guarded[index] && under_roots[index] {
                        term = self.select(bar, term, zero);
                    }
                    let sum = seeds[operand.0 as usize];
                    seeds[operand.0 as usize] = self.add(sum, term);
                }
            }
        }
        towards.iter().map(|node| seeds.get(node.0 as usize).copied().unwrap_or(zero)).collect()
    }
    /// Numbers of which roots or powers are taken, and those that these are sums, products and quotients of.
    fn under_roots(&self, needed: &[bool]) -> Vec<bool> {
        use Binary::{Add, Div, Mul, Sub};
        let mut under = vec![false; needed.len()];
        for index in (0..needed.len()).rev().filter(|&index| needed[index]) {
            let operation = self.operations()[index];
            let passes = match operation {
                Operation::Unary(Unary::Sqrt, _) | Operation::Power(..) => true,
                Operation::Unary(Unary::Neg, _) | Operation::Binary(Add | Sub | Mul | Div, ..) => under[index],
                _ => false,
            };
            if passes {
                operation.for_each_operand(|operand| under[operand.0 as usize] = true);
            }
        }
        under
    }

    /// What may be left aside by a choice, and need not be a number where it is: the sides of a choice, factors of what vanishes, and what
    /// these are made of.
    pub(super) fn perhaps_left_aside(&self, needed: &[bool]) -> Vec<bool> {
        let mut guarded = vec![false; needed.len()];
        let mut mark = |node: Node| guarded[node.0 as usize] = true;
        for (operation, _) in self.operations().iter().zip(needed).filter(|(_, needed)| **needed) {
            match *operation {
                Operation::Select([_, then, otherwise]) => [then, otherwise].into_iter().for_each(&mut mark),
                Operation::Binary(Binary::Vanishing, _, factor) => mark(factor),
                _ => {}
            }
        }
        self.made_of(guarded)
    }
}

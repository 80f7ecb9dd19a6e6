use super::operation::{Binary, Node, Operation, Unary};
use crate::scalar::{Curve, Scalar, gathered_place};
use hashbrown::HashTable;
use rustc_hash::FxBuildHasher;
use std::hash::{BuildHasher, Hash, Hasher};
use std::sync::Arc;

/// Operations of a recorded formula and of what is derived from it: equal ones are shared, constants folded, zeros and ones removed.
///
/// Nothing is reassociated: evaluated in real numbers, a node has the bits of the formula as it is written (up to the sign of zeros).
#[derive(Clone, Debug, Default)]
pub struct Graph {
    operations: Vec<Operation>,
    /// Their numbers, found by their hashes: a tenth of the memory of a map from operations.
    numbers: HashTable<u32>,
    curves: Vec<Arc<Curve>>,
}

/// That of its operations, curves by what they are.
impl Hash for Graph {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.operations.len().hash(state);
        for operation in &self.operations {
            match *operation {
                Operation::Curve { curve, order, at } => (&self.curves[curve as usize], order, at).hash(state),
                operation => operation.hash(state),
            }
        }
    }
}

impl Graph {
    /// The operations so far; operands come first.
    pub fn operations(&self) -> &[Operation] {
        &self.operations
    }

    pub fn operation(&self, node: Node) -> Operation {
        self.operations[node.0 as usize]
    }

    /// The curves that operations take.
    pub fn curves(&self) -> &[Arc<Curve>] {
        &self.curves
    }

    fn push(&mut self, operation: Operation) -> Node {
        let operations = &mut self.operations;
        let hash = |operation: &Operation| FxBuildHasher.hash_one(operation);
        let is_same = |number: &u32| operations[*number as usize] == operation;
        let entry = self.numbers.entry(hash(&operation), is_same, |number| hash(&operations[*number as usize]));
        let number = *entry.or_insert(operations.len() as u32).get();
        if number as usize == operations.len() {
            operations.push(operation);
        }
        Node(number)
    }

    /// The value of a node that is a constant.
    pub fn constant_of(&self, node: Node) -> Option<f64> {
        match self.operation(node) {
            Operation::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// True for the constant 0.
    pub fn is_zero(&self, node: Node) -> bool {
        self.constant_of(node) == Some(0.0)
    }

    pub fn input(&mut self, index: usize) -> Node {
        self.push(Operation::Input(index as u32))
    }

    /// A constant; -0 counts as 0.
    pub fn constant(&mut self, value: f64) -> Node {
        self.push(Operation::Constant((value + 0.0).to_bits()))
    }

    pub fn zero(&mut self) -> Node {
        self.constant(0.0)
    }

    /// A function of one number.
    pub fn unary(&mut self, function: Unary, x: Node) -> Node {
        if let Some(value) = self.constant_of(x) {
            return self.constant(value.unary(function));
        }
        match (function, self.operation(x)) {
            (Unary::Neg, Operation::Unary(Unary::Neg, inner)) => inner,
            (Unary::Neg, Operation::Binary(Binary::Sub, a, b)) => self.binary(Binary::Sub, b, a),
            _ => self.push(Operation::Unary(function, x)),
        }
    }

    pub fn neg(&mut self, x: Node) -> Node {
        self.unary(Unary::Neg, x)
    }
    pub fn add(&mut self, x: Node, y: Node) -> Node {
        self.binary(Binary::Add, x, y)
    }
    pub fn sub(&mut self, x: Node, y: Node) -> Node {
        self.binary(Binary::Sub, x, y)
    }
    pub fn mul(&mut self, x: Node, y: Node) -> Node {
        self.binary(Binary::Mul, x, y)
    }
    pub fn div(&mut self, x: Node, y: Node) -> Node {
        self.binary(Binary::Div, x, y)
    }
    /// c x.
    pub fn scaled(&mut self, x: Node, factor: f64) -> Node {
        let factor = self.constant(factor);
        self.mul(x, factor)
    }

    /// x - x that is not folded: 0, or no number where x is infinite or none; it has no derivatives.
    #[allow(clippy::eq_op)] // not 0 where the value is infinite or none
    pub fn nought(&mut self, x: Node) -> Node {
        match self.constant_of(x) {
            Some(value) => self.constant(value - value),
            None => self.push(Operation::Binary(Binary::Sub, x, x)),
        }
    }

    /// The operand of a negation.
    fn negated(&self, node: Node) -> Option<Node> {
        match self.operation(node) {
            Operation::Unary(Unary::Neg, inner) => Some(inner),
            _ => None,
        }
    }

    /// A function of two numbers.
    pub fn binary(&mut self, function: Binary, x: Node, y: Node) -> Node {
        let known = [x, y].map(|node| self.constant_of(node));
        if let [Some(a), Some(b)] = known {
            return self.constant(function.apply(a, b));
        }
        let negated = [x, y].map(|node| self.negated(node));
        let folded = match (function, known, negated) {
            (Binary::Add, [Some(0.0), _], _) => Some(y),
            (Binary::Add, [_, Some(0.0)], _) => Some(x),
            (Binary::Add, _, [_, Some(inner)]) => Some(self.sub(x, inner)),
            (Binary::Add, _, [Some(inner), _]) => Some(self.sub(y, inner)),
            (Binary::Sub, [_, Some(0.0)], _) => Some(x),
            (Binary::Sub, [Some(0.0), _], _) => Some(self.neg(y)),
            (Binary::Sub | Binary::Less, ..) if x == y => Some(self.zero()),
            (Binary::Sub, _, [_, Some(inner)]) => Some(self.add(x, inner)),
            (Binary::Sub, _, [Some(inner), _]) => {
                let sum = self.add(inner, y);
                Some(self.neg(sum))
            }
            (Binary::Mul, ..) => self.folded_product([x, y], known),
            (Binary::Div, [Some(0.0), _] | [_, Some(1.0)], _) => Some(x),
            (Binary::Div, [_, Some(-1.0)], _) => Some(self.neg(x)),
            // exact
            (Binary::Div, [_, Some(c)], _) if c != 0.0 && c.is_finite() && c.to_bits() << 12 == 0 => {
                Some(self.scaled(x, 1.0 / c))
            }
            (Binary::Vanishing, [Some(0.0), _], _) => Some(x),
            (Binary::Vanishing, [_, Some(_)] | [Some(_), _], _) => Some(self.mul(x, y)),
            _ => None,
        };
        folded.unwrap_or_else(|| match function {
            Binary::Add | Binary::Mul => self.push(Operation::Binary(function, x.min(y), x.max(y))),
            _ => self.push(Operation::Binary(function, x, y)),
        })
    }

    /// x y where it is simpler than a product.
    fn folded_product(&mut self, [x, y]: [Node; 2], known: [Option<f64>; 2]) -> Option<Node> {
        for (known, other) in known.into_iter().zip([y, x]) {
            // powers of two are exact, and derivatives are full of halves of doubles
            if let (Some(c), Operation::Binary(Binary::Add, a, b)) = (known, self.operation(other))
                && a == b
            {
                return Some(self.scaled(a, 2.0 * c));
            }
            match known {
                Some(0.0) => return Some(self.zero()),
                Some(1.0) => return Some(other),
                Some(-1.0) => return Some(self.neg(other)),
                Some(2.0) => return Some(self.push(Operation::Binary(Binary::Add, other, other))),
                _ => {}
            }
        }
        let (inner, other, factor) = match (self.negated(x), self.negated(y)) {
            (Some(x), Some(y)) => return Some(self.mul(x, y)),
            (Some(inner), None) => (inner, y, known[1]),
            (None, Some(inner)) => (inner, x, known[0]),
            (None, None) => return None,
        };
        match factor {
            Some(factor) => Some(self.scaled(inner, -factor)),
            None => {
                let product = self.mul(inner, other);
                Some(self.neg(product))
            }
        }
    }

    /// x^r for a real exponent.
    pub fn power(&mut self, x: Node, exponent: f64) -> Node {
        match self.constant_of(x) {
            Some(value) => self.constant(Scalar::powf(value, exponent)),
            None => self.push(Operation::Power(x, exponent.to_bits())),
        }
    }

    /// `then` where `mask` is not 0, otherwise `otherwise`.
    pub fn select(&mut self, mask: Node, then: Node, otherwise: Node) -> Node {
        match self.constant_of(mask) {
            Some(0.0) => otherwise,
            Some(_) => then,
            None if then == otherwise => then,
            None => self.push(Operation::Select([mask, then, otherwise])),
        }
    }

    /// True if any value is a choice between two.
    pub fn has_choices(&self) -> bool {
        self.operations.iter().any(|own| matches!(own, Operation::Select(_)))
    }

    /// Derivative of some order of a curve.
    pub fn on_curve(&mut self, curve: &Arc<Curve>, order: usize, at: Node) -> Node {
        let same = |own: &Arc<Curve>| Arc::ptr_eq(own, curve) || own == curve;
        let place = self.curves.iter().position(same).unwrap_or_else(|| {
            self.curves.push(Arc::clone(curve));
            self.curves.len() - 1
        });
        self.on_own_curve(place as u32, order as u32, at)
    }

    /// The same of one that the recording has.
    pub fn on_own_curve(&mut self, curve: u32, order: u32, at: Node) -> Node {
        match self.constant_of(at) {
            Some(at) => self.constant(self.curves[curve as usize].value(order as usize, at)),
            None if order > self.curves[curve as usize].degree() => self.zero(),
            None => self.push(Operation::Curve { curve, order, at }),
        }
    }

    /// The node at place `at` of a list, counted from 0: one look-up of arguments that follow each other, otherwise a choice for each node
    /// that is not zero.
    pub fn gather(&mut self, nodes: &[Node], at: Node) -> Node {
        if let Some(at) = self.constant_of(at) {
            return nodes[gathered_place(at, nodes.len())];
        }
        let first = nodes[0];
        if nodes.iter().all(|&node| node == first) {
            return first;
        }
        if let Operation::Input(input) = self.operation(first) {
            let mut following = (0u32..).zip(nodes);
            if following.all(|(k, &node)| node.0 == first.0 + k && self.operation(node) == Operation::Input(input + k)) {
                return self.push(Operation::Gather { first, count: nodes.len() as u32, at });
            }
        }
        let zero = self.zero();
        let mut chosen = zero;
        for (place, &node) in (0..).zip(nodes).filter(|(_, node)| **node != zero) {
            let elsewhere = self.differs(at, place);
            chosen = self.select(elsewhere, chosen, node);
        }
        chosen
    }

    /// Not 0 where a node is another whole number.
    pub fn differs(&mut self, at: Node, place: u32) -> Node {
        let place = self.constant(f64::from(place));
        self.sub(at, place)
    }

    /// Results with other nodes in place of some of their arguments.
    pub fn substitute(&mut self, outputs: &[Node], replaced: &[(Node, Node)]) -> Vec<Node> {
        let needed = self.needed(outputs);
        let mut own: Vec<Node> = (0..needed.len()).map(|index| Node(index as u32)).collect();
        for index in (0..needed.len()).filter(|&index| needed[index]) {
            let node = Node(index as u32);
            own[index] = match replaced.iter().find(|(old, _)| *old == node) {
                Some(&(_, new)) => new,
                None => self.with_operands(node, |operand| own[operand.0 as usize]),
            };
        }
        outputs.iter().map(|output| own[output.0 as usize]).collect()
    }

    /// An operation again with other operands.
    fn with_operands(&mut self, node: Node, operand: impl Fn(Node) -> Node) -> Node {
        match self.operation(node) {
            Operation::Input(_) | Operation::Constant(_) => node,
            Operation::Unary(function, x) => self.unary(function, operand(x)),
            Operation::Binary(Binary::Sub, x, y) if x == y => self.nought(operand(x)),
            Operation::Binary(function, x, y) => self.binary(function, operand(x), operand(y)),
            Operation::Power(x, bits) => self.power(operand(x), f64::from_bits(bits)),
            Operation::Select([mask, then, otherwise]) => self.select(operand(mask), operand(then), operand(otherwise)),
            Operation::Curve { curve, order, at } => self.on_own_curve(curve, order, operand(at)),
            Operation::Gather { first, count, at } => {
                let nodes: Vec<Node> = (first.0..first.0 + count).map(|place| operand(Node(place))).collect();
                self.gather(&nodes, operand(at))
            }
        }
    }

    /// Which inputs of `count` some nodes depend on.
    pub fn reads(&self, nodes: &[Node], count: usize) -> Vec<bool> {
        let needed = self.needed(nodes);
        let mut reads = vec![false; count];
        for (operation, _) in self.operations.iter().zip(&needed).filter(|(_, needed)| **needed) {
            if let Operation::Input(index) = *operation
                && let Some(read) = reads.get_mut(index as usize)
            {
                *read = true;
            }
        }
        reads
    }

    /// Values of all nodes for those of the arguments, behind the values of the first nodes that are known already.
    pub fn evaluate<S: Scalar>(&self, inputs: &[S], values: &mut Vec<S>) {
        values.reserve(self.operations.len() - values.len());
        for &operation in &self.operations[values.len()..] {
            values.push(self.value_of(operation, inputs, values));
        }
    }

    /// Values of some nodes alone.
    pub fn values_of<S: Scalar>(&self, nodes: &[Node], inputs: &[S]) -> Vec<S> {
        let mut values = Vec::with_capacity(self.operations.len());
        for (needed, &operation) in self.needed(nodes).into_iter().zip(&self.operations) {
            values.push(if needed { self.value_of(operation, inputs, &values) } else { S::zero() });
        }
        nodes.iter().map(|node| values[node.0 as usize]).collect()
    }

    /// The value of an operation from those of the nodes before it.
    fn value_of<S: Scalar>(&self, operation: Operation, inputs: &[S], values: &[S]) -> S {
        let of = |node: Node| values[node.0 as usize];
        match operation {
            Operation::Input(index) => inputs[index as usize],
            Operation::Constant(bits) => S::from(f64::from_bits(bits)),
            Operation::Unary(function, x) => of(x).unary(function),
            Operation::Binary(function, x, y) => function.apply(of(x), of(y)),
            Operation::Power(x, bits) => of(x).powf(f64::from_bits(bits)),
            Operation::Select([mask, then, otherwise]) => of(mask).select(of(then), of(otherwise)),
            Operation::Curve { curve, order, at } => of(at).on_curve(&self.curves[curve as usize], order as usize),
            Operation::Gather { first, count, at } => of(at).gather(&values[first.0 as usize..][..count as usize]),
        }
    }

    /// Which operations some nodes are made of.
    pub fn needed(&self, nodes: &[Node]) -> Vec<bool> {
        let mut needed = vec![false; nodes.iter().map(|node| node.0 as usize + 1).max().unwrap_or(0)];
        nodes.iter().for_each(|node| needed[node.0 as usize] = true);
        self.made_of(needed)
    }

    /// Which operations some of the first are made of, these among them.
    pub fn made_of(&self, mut marked: Vec<bool>) -> Vec<bool> {
        for index in (0..marked.len()).rev() {
            if marked[index] {
                self.operations[index].for_each_operand(|operand| marked[operand.0 as usize] = true);
            }
        }
        marked
    }

    /// Which of those that are needed depend on some operations, these among them.
    pub fn depending_on(&self, mut marked: Vec<bool>, needed: &[bool]) -> Vec<bool> {
        for index in (0..marked.len()).filter(|&index| needed[index]) {
            let mut depends = marked[index];
            self.operations[index].for_each_operand(|operand| depends |= marked[operand.0 as usize]);
            marked[index] = depends;
        }
        marked
    }
}

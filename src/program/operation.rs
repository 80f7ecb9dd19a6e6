//! What a recorded formula is made of.

use crate::scalar::Scalar;
pub use crate::scalar::Unary;
use smallvec::SmallVec;

/// A value of a recording: the place of the operation that makes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Node(pub u32);

/// Functions of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    /// Angle of the point with the coordinates (y, x): `x.atan2(y)` of Rust's notation.
    Atan2,
    /// 1 where x < y, otherwise 0.
    Less,
    /// x y, but 0 where x = 0, whatever y is: derivatives of functions whose slope may be infinite.
    Vanishing,
}

/// One operation; operands come before it in the recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operation {
    /// An argument of the formula.
    Input(u32),
    /// A constant, by its bits.
    Constant(u64),
    /// A function of one number.
    Unary(Unary, Node),
    /// A function of two numbers.
    Binary(Binary, Node, Node),
    /// x^r for a real exponent, by its bits.
    Power(Node, u64),
    /// The second operand where the first is not 0, otherwise the third.
    Select([Node; 3]),
    /// A curve, or a derivative of it, at the operand.
    Curve {
        /// Its place among the curves of the recording.
        curve: u32,
        /// Order of the derivative.
        order: u32,
        /// Where it is taken.
        at: Node,
    },
    /// One of some arguments, whose nodes follow each other.
    Gather {
        /// The first of them.
        first: Node,
        /// How many there are.
        count: u32,
        /// Which one, counted from 0.
        at: Node,
    },
}

impl Operation {
    /// The same operation on other operands; of what is gathered the first counts.
    #[inline(always)]
    pub fn map(self, mut of: impl FnMut(Node) -> Node) -> Self {
        match self {
            Operation::Input(_) | Operation::Constant(_) => self,
            Operation::Unary(function, x) => Operation::Unary(function, of(x)),
            Operation::Binary(function, x, y) => Operation::Binary(function, of(x), of(y)),
            Operation::Power(x, bits) => Operation::Power(of(x), bits),
            Operation::Select(operands) => Operation::Select(operands.map(of)),
            Operation::Curve { curve, order, at } => Operation::Curve { curve, order, at: of(at) },
            Operation::Gather { first, count, at } => Operation::Gather { first: of(first), count, at: of(at) },
        }
    }

    /// Places of the operands; of what is gathered that of the first.
    pub fn operands(self) -> SmallVec<[usize; 3]> {
        let mut all = SmallVec::new();
        self.map(|operand| {
            all.push(operand.0 as usize);
            operand
        });
        all
    }

    /// Calls `f` for each operand, all that are gathered among them.
    // derivatives sweep whole recordings with this: as a call it takes four times as long
    #[inline(always)]
    pub fn for_each_operand(self, mut f: impl FnMut(Node)) {
        if let Operation::Gather { first, count, .. } = self {
            (first.0 + 1..first.0 + count).for_each(|place| f(Node(place)));
        }
        self.map(|operand| {
            f(operand);
            operand
        });
    }

    /// True for an argument of the formula and for a constant.
    pub fn is_leaf(self) -> bool {
        matches!(self, Operation::Input(_) | Operation::Constant(_))
    }
}

impl Binary {
    /// The function in any scalar.
    #[inline(always)]
    pub fn apply<S: Scalar>(self, x: S, y: S) -> S {
        match self {
            Binary::Add => x + y,
            Binary::Sub => x - y,
            Binary::Mul => x * y,
            Binary::Div => x / y,
            Binary::Atan2 => x.atan2(y),
            Binary::Less => x.less(y),
            Binary::Vanishing => x.vanishing_times(y),
        }
    }
}

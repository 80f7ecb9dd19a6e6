//! A straight line of instructions: what a recording is executed from.

use super::operation::{Binary, Unary};
use crate::scalar::Curve;
use std::sync::Arc;

/// Where an operand comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The result of an instruction before, by its number.
    Value(u32),
    /// An argument of the program, by its number.
    Input(u32),
    /// A constant, by its place in the list of constants.
    Constant(u32),
}

/// One instruction; its result is the value of its own number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Instruction {
    /// A function of one number.
    Unary(Unary, Source),
    /// A function of two numbers.
    Binary(Binary, Source, Source),
    /// x^r.
    Power(Source, f64),
    /// The second operand where the first is not 0, otherwise the third.
    Select(Source, Source, Source),
    /// Derivative of some order of a curve.
    Curve {
        /// Its place in the list of curves.
        curve: u32,
        /// Order of the derivative.
        order: u32,
        /// Where it is taken.
        at: Source,
    },
    /// One of some arguments.
    Gather {
        /// The first of them.
        first: u32,
        /// How many there are.
        count: u32,
        /// Which one, counted from 0.
        at: Source,
    },
}

/// Instructions in the order of their execution, without jumps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Listing {
    /// Number of arguments.
    pub inputs: usize,
    /// Constants.
    pub constants: Vec<f64>,
    /// Curves.
    pub curves: Vec<Arc<Curve>>,
    /// Instructions; operands come before them.
    pub instructions: Vec<Instruction>,
    /// Where each result is read.
    pub outputs: Vec<Source>,
}

impl Instruction {
    /// Calls `f` for each operand but those that are gathered.
    pub fn for_each_source(self, mut f: impl FnMut(Source)) {
        match self {
            Instruction::Unary(_, x) | Instruction::Power(x, _) => f(x),
            Instruction::Curve { at, .. } | Instruction::Gather { at, .. } => f(at),
            Instruction::Binary(_, x, y) => {
                f(x);
                f(y);
            }
            Instruction::Select(x, y, z) => {
                f(x);
                f(y);
                f(z);
            }
        }
    }
}

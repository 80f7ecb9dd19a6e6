//! A formula that Python has recorded, replayed in any scalar.

use costate::scalar::Scalar;
use serde::Deserialize;

/// What a number is made of; others are named by their places, arguments first.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "snake_case")]
enum Operation {
    Constant(f64),
    Unary(Unary, usize),
    Binary(Binary, usize, usize),
    /// A whole power.
    Powi(usize, i32),
    /// A power whose exponent is a constant.
    Powf(usize, f64),
    /// The second where the first is not 0, otherwise the third.
    Select(usize, usize, usize),
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "snake_case")]
enum Unary {
    Neg,
    Abs,
    Sign,
    Floor,
    Sqrt,
    Exp,
    Log,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "snake_case")]
enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    Atan2,
    Less,
    Min,
    Max,
}

/// The operations of a formula in their order, and which of its numbers are the results.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub struct Tape {
    /// Number of arguments.
    arguments: usize,
    operations: Vec<Operation>,
    results: Vec<usize>,
}

impl Tape {
    /// Whether it has so many arguments and results, and every operation takes numbers that stand before it.
    ///
    /// # Errors
    /// What is wrong.
    pub fn check(&self, arguments: usize, results: usize) -> Result<(), String> {
        let counts = [(self.arguments, arguments, "arguments"), (self.results.len(), results, "results")];
        if let Some((own, wanted, what)) = counts.into_iter().find(|(own, wanted, _)| own != wanted) {
            return Err(format!("a formula with {own} {what}, and {wanted} are wanted"));
        }
        let mut known = self.arguments;
        for operation in &self.operations {
            let used = match *operation {
                Operation::Constant(_) => [0; 3],
                Operation::Unary(_, x) | Operation::Powi(x, _) | Operation::Powf(x, _) => [x + 1, 0, 0],
                Operation::Binary(_, x, y) => [x + 1, y + 1, 0],
                Operation::Select(x, y, z) => [x + 1, y + 1, z + 1],
            };
            if used.into_iter().any(|used| used > known) {
                return Err(format!("operation {} of a formula takes a number behind it", known - self.arguments));
            }
            known += 1;
        }
        match self.results.iter().find(|&&place| place >= known) {
            Some(place) => Err(format!("a formula has {known} numbers and no number {place}")),
            None => Ok(()),
        }
    }

    /// Number of results.
    pub fn count(&self) -> usize {
        self.results.len()
    }

    /// The results for some arguments, one list behind the other.
    pub fn replay<S: Scalar>(&self, arguments: &[&[S]]) -> Vec<S> {
        let mut x = arguments.concat();
        for operation in &self.operations {
            x.push(match *operation {
                Operation::Constant(own) => S::from(own),
                Operation::Unary(function, of) => function.of(x[of]),
                Operation::Binary(function, a, b) => function.of(x[a], x[b]),
                Operation::Powi(base, exponent) => x[base].powi(exponent),
                Operation::Powf(base, exponent) => x[base].powf(exponent),
                Operation::Select(mask, then, otherwise) => x[mask].select(x[then], x[otherwise]),
            });
        }
        self.results.iter().map(|&place| x[place]).collect()
    }
}

impl Unary {
    fn of<S: Scalar>(self, x: S) -> S {
        match self {
            Unary::Neg => -x,
            Unary::Abs => x.abs(),
            Unary::Sign => x.sign(),
            Unary::Floor => x.floor(),
            Unary::Sqrt => x.sqrt(),
            Unary::Exp => x.exp(),
            Unary::Log => x.ln(),
            Unary::Sin => x.sin(),
            Unary::Cos => x.cos(),
            Unary::Tan => x.tan(),
            Unary::Asin => x.asin(),
            Unary::Acos => x.acos(),
            Unary::Atan => x.atan(),
            Unary::Sinh => x.sinh(),
            Unary::Cosh => x.cosh(),
            Unary::Tanh => x.tanh(),
        }
    }
}

impl Binary {
    fn of<S: Scalar>(self, a: S, b: S) -> S {
        match self {
            Binary::Add => a + b,
            Binary::Sub => a - b,
            Binary::Mul => a * b,
            Binary::Div => a / b,
            Binary::Atan2 => a.atan2(b),
            Binary::Less => a.less(b),
            Binary::Min => a.min(b),
            Binary::Max => a.max(b),
        }
    }
}

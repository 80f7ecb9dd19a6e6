//! A formula that Python has recorded, taken into a recording of the library.

use costate::internals::{Recorded, Replay};
use costate::scalar::Scalar;
use serde::Deserialize;

/// A function with what it is of: places of numbers, arguments first, and of a power or a constant the number itself.
#[derive(Clone, Debug, Deserialize)]
struct Operation {
    function: String,
    of: Vec<f64>,
}

/// The operations of a formula in their order, and which of its numbers are the results.
#[derive(Clone, Debug, Deserialize)]
pub struct Tape {
    arguments: usize,
    operations: Vec<Operation>,
    results: Vec<usize>,
}

impl Tape {
    pub fn count(&self) -> usize {
        self.results.len()
    }

    /// The recording of a formula of so many arguments and results.
    pub fn recorded(&self, arguments: usize, results: usize) -> Result<Replay, String> {
        let counts = [(self.arguments, arguments, "arguments"), (self.results.len(), results, "results")];
        if let Some((own, wanted, what)) = counts.into_iter().find(|(own, wanted, _)| own != wanted) {
            return Err(format!("a formula with {own} {what}, and {wanted} are wanted"));
        }
        let (made, replay) = Replay::of(|| match self.numbers() {
            Ok(numbers) => (Ok(()), numbers),
            Err(why) => (Err(why), Vec::new()),
        });
        made.map(|()| replay)
    }

    fn numbers(&self) -> Result<Vec<Recorded>, String> {
        let mut known: Vec<Recorded> = (0..self.arguments).map(Recorded::argument).collect();
        for (place, operation) in self.operations.iter().enumerate() {
            let wrong = || format!("operation {place} of a formula, {operation:?}, is none of numbers before it");
            known.push(operation.value(&known).ok_or_else(wrong)?);
        }
        let result = |&place: &usize| known.get(place).copied().ok_or_else(|| format!("a formula has no number {place}"));
        self.results.iter().map(result).collect()
    }
}

type Unary = fn(Recorded) -> Recorded;
type Binary = fn(Recorded, Recorded) -> Recorded;

const UNARY: [(&str, Unary); 16] = [
    ("neg", |x| -x),
    ("abs", Scalar::abs),
    ("sign", Scalar::sign),
    ("floor", Scalar::floor),
    ("sqrt", Scalar::sqrt),
    ("exp", Scalar::exp),
    ("log", Scalar::ln),
    ("sin", Scalar::sin),
    ("cos", Scalar::cos),
    ("tan", Scalar::tan),
    ("asin", Scalar::asin),
    ("acos", Scalar::acos),
    ("atan", Scalar::atan),
    ("sinh", Scalar::sinh),
    ("cosh", Scalar::cosh),
    ("tanh", Scalar::tanh),
];
const BINARY: [(&str, Binary); 8] = [
    ("add", |a, b| a + b),
    ("sub", |a, b| a - b),
    ("mul", |a, b| a * b),
    ("div", |a, b| a / b),
    ("atan2", Scalar::atan2),
    ("less", Scalar::less),
    ("min", Scalar::min),
    ("max", Scalar::max),
];

impl Operation {
    fn value(&self, known: &[Recorded]) -> Option<Recorded> {
        let of = |place: usize| known.get(self.of[place] as usize).copied();
        Some(match (self.function.as_str(), self.of.len()) {
            ("constant", 1) => self.of[0].into(),
            ("powi", 2) => of(0)?.powi(self.of[1] as i32),
            ("powf", 2) => of(0)?.powf(self.of[1]),
            ("select", 3) => of(0)?.select(of(1)?, of(2)?),
            (name, 1) => UNARY.iter().find(|own| own.0 == name)?.1(of(0)?),
            (name, 2) => BINARY.iter().find(|own| own.0 == name)?.1(of(0)?, of(1)?),
            _ => return None,
        })
    }
}

use super::{Scalar, assign_operators};
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value and its place on the thread's tape: reverse-mode differentiation of scene functions.
///
/// A scene maps a few design variables to many parameters; recorded once, one sweep back over the [`Tape`] gives
/// (dp/dx)^T p_bar for any number of variables. Values that no recorded variable touches carry no place and cost nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rev {
    value: f64,
    node: u32,
}

/// Marks a value without a place on the tape.
const CONSTANT: u32 = u32::MAX;

/// One recorded operation: up to two operands with the partial derivatives towards them.
#[derive(Clone, Copy)]
struct Record {
    operands: [u32; 2],
    partials: [f64; 2],
}

thread_local! {
    static RECORDS: RefCell<Vec<Record>> = const { RefCell::new(Vec::new()) };
}

/// The recording of one scene function on this thread, from its variables to its results.
pub struct Tape {
    records: Vec<Record>,
    variables: usize,
}

impl Tape {
    /// Runs `function` on recorded variables with the given values and keeps what it did.
    ///
    /// # Panics
    /// Inside another recording on the same thread: tapes do not nest.
    pub fn record<T>(values: &[f64], function: impl FnOnce(&[Rev]) -> T) -> (Tape, T) {
        RECORDS.with_borrow_mut(|records| {
            assert!(records.is_empty(), "a recording is already running on this thread");
            records.resize(values.len(), Record { operands: [CONSTANT; 2], partials: [0.0; 2] });
        });
        // emptied on unwinding too, so that a caught panic leaves a usable thread
        struct Emptied;
        impl Drop for Emptied {
            fn drop(&mut self) {
                RECORDS.with_borrow_mut(Vec::clear);
            }
        }
        let emptied = Emptied;
        let variables: Vec<Rev> = values.iter().zip(0..).map(|(&value, node)| Rev { value, node }).collect();
        let result = function(&variables);
        let records = RECORDS.with_borrow_mut(std::mem::take);
        drop(emptied);
        (Tape { records, variables: values.len() }, result)
    }

    /// Gradient with respect to the variables of sum_i weight_i result_i, in one sweep.
    pub fn gradient(&self, weighted_results: impl IntoIterator<Item = (Rev, f64)>) -> Vec<f64> {
        let mut adjoint = vec![0.0; self.records.len()];
        for (result, weight) in weighted_results {
            if result.node != CONSTANT {
                adjoint[result.node as usize] += weight;
            }
        }
        for (index, record) in self.records.iter().enumerate().rev() {
            let bar = adjoint[index];
            if bar != 0.0 {
                for (operand, partial) in record.operands.iter().zip(record.partials) {
                    // a partial of zero ends the chain even where the derivative above it is infinite, as in forward mode
                    if *operand != CONSTANT && partial != 0.0 {
                        adjoint[*operand as usize] += partial * bar;
                    }
                }
            }
        }
        adjoint.truncate(self.variables);
        adjoint
    }
}

impl Rev {
    /// True if the value depends on a recorded variable.
    pub fn depends_on_variables(self) -> bool {
        self.node != CONSTANT
    }

    fn record(value: f64, operands: [u32; 2], partials: [f64; 2]) -> Self {
        if operands == [CONSTANT; 2] {
            return Rev { value, node: CONSTANT };
        }
        RECORDS.with_borrow_mut(|records| {
            let node = u32::try_from(records.len()).expect("a scene function records fewer than 2^32 operations");
            records.push(Record { operands, partials });
            Rev { value, node }
        })
    }

    fn chain(self, [value, first, _]: [f64; 3]) -> Self {
        Rev::record(value, [self.node, CONSTANT], [first, 0.0])
    }

    fn binary(self, other: Self, value: f64, partials: [f64; 2]) -> Self {
        if self.node == other.node {
            // one operand, so that x - x does not move at all
            return self.chain([value, partials[0] + partials[1], 0.0]);
        }
        Rev::record(value, [self.node, other.node], partials)
    }
}

impl Default for Rev {
    fn default() -> Self {
        Rev::from(0.0)
    }
}
impl From<f64> for Rev {
    fn from(value: f64) -> Self {
        Rev { value, node: CONSTANT }
    }
}
impl Neg for Rev {
    type Output = Self;
    fn neg(self) -> Self {
        self.chain([-self.value, -1.0, 0.0])
    }
}
impl Add for Rev {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.binary(other, self.value + other.value, [1.0, 1.0])
    }
}
impl Sub for Rev {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.binary(other, self.value - other.value, [1.0, -1.0])
    }
}
impl Mul for Rev {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.binary(other, self.value * other.value, [other.value, self.value])
    }
}
impl Div for Rev {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        self.binary(other, quotient, [1.0 / other.value, -quotient / other.value])
    }
}
impl Add<f64> for Rev {
    type Output = Self;
    fn add(self, other: f64) -> Self {
        self.chain([self.value + other, 1.0, 0.0])
    }
}
impl Sub<f64> for Rev {
    type Output = Self;
    fn sub(self, other: f64) -> Self {
        self.chain([self.value - other, 1.0, 0.0])
    }
}
impl Mul<f64> for Rev {
    type Output = Self;
    fn mul(self, other: f64) -> Self {
        self.chain([self.value * other, other, 0.0])
    }
}
impl Div<f64> for Rev {
    type Output = Self;
    fn div(self, other: f64) -> Self {
        self.chain([self.value / other, 1.0 / other, 0.0])
    }
}
assign_operators!([] Rev);

impl Scalar for Rev {
    fn value(self) -> f64 {
        self.value
    }
    fn is_constant(self) -> bool {
        self.node == CONSTANT
    }
    super::jet::functions_by_chain!(value);
    fn atan2(self, other: Self) -> Self {
        let square = self.value * self.value + other.value * other.value;
        self.binary(other, self.value.atan2(other.value), [other.value / square, -self.value / square])
    }
}

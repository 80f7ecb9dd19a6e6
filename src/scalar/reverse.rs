use super::{Complex64, Lanes, Scalar};
use std::cell::{Cell, RefCell};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value and its place on the thread's tape: reverse-mode differentiation, over a scalar that may itself carry derivatives.
///
/// One sweep back gives the gradient of one number with respect to all others: reactions A^T mu as the gradient of mu . g, adjoint
/// products (dR/dp)^T lambda, and the chain from parameters to design variables. Values that no recorded variable touches
/// carry no place and cost nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reverse<S> {
    value: S,
    node: u32,
}

/// Reverse mode over real numbers.
pub type Rev = Reverse<f64>;

/// Marks a value without a place on the tape.
const CONSTANT: u32 = u32::MAX;

/// One recorded operation: up to two operands, and the partial derivatives towards them: real numbers for linear operations
/// (half of all), a place in a list of scalars for the others.
#[derive(Clone, Copy, Debug)]
struct Record {
    operands: [u32; 2],
    factors: [f64; 2],
    partials: u32,
}

/// Marks a record whose partial derivatives are its factors.
const LINEAR: u32 = u32::MAX;
/// A variable: nothing before it.
const VARIABLE: Record = Record { operands: [CONSTANT; 2], factors: [0.0; 2], partials: LINEAR };

/// The tape of one thread for one scalar, with the workspace of its sweeps.
#[derive(Debug)]
pub struct Records<S> {
    list: Vec<Record>,
    partials: Vec<[S; 2]>,
    adjoint: Vec<S>,
}

/// A scalar over which reverse mode records: a closed list, because each needs a tape on every thread.
pub trait Recordable: Scalar {
    /// Partial derivatives are real numbers: they fit into the record itself.
    const REAL: bool;
    /// Calls `f` with this thread's tape.
    fn with_records<T>(f: impl FnOnce(&mut Records<Self>) -> T) -> T;
}

macro_rules! recordable {
    ($($scalar:ty, $real:literal);*) => {$(
        impl Recordable for $scalar {
            const REAL: bool = $real;
            #[inline(always)]
            fn with_records<T>(f: impl FnOnce(&mut Records<Self>) -> T) -> T {
                // a place without a destructor is reached by one instruction; each thread that records leaves one tape behind
                thread_local! {
                    static RECORDS: Cell<Option<&'static RefCell<Records<$scalar>>>> = const { Cell::new(None) };
                }
                let records = match RECORDS.get() {
                    Some(records) => records,
                    None => {
                        let empty = Records { list: Vec::new(), partials: Vec::new(), adjoint: Vec::new() };
                        let records: &'static _ = Box::leak(Box::new(RefCell::new(empty)));
                        RECORDS.set(Some(records));
                        records
                    }
                };
                f(&mut records.borrow_mut())
            }
        }
    )*};
}
recordable!(f64, true; Complex64, false; Lanes, false);

impl<S: Recordable> Records<S> {
    #[inline(always)]
    fn push_linear(&mut self, operands: [u32; 2], factors: [f64; 2]) -> u32 {
        let node = self.list.len() as u32;
        self.list.push(Record { operands, factors, partials: LINEAR });
        node
    }

    #[inline(always)]
    fn push(&mut self, operands: [u32; 2], partials: &[S; 2]) -> u32 {
        if S::REAL {
            return self.push_linear(operands, [partials[0].value(), partials[1].value()]);
        }
        let node = self.list.len() as u32;
        self.list.push(Record { operands, factors: [0.0; 2], partials: self.partials.len() as u32 });
        self.partials.push(*partials);
        node
    }
}

/// Back through records that start at number `start`: `adjoint` holds one entry for each of them.
fn sweep<S: Scalar>(records: &[Record], partials: &[[S; 2]], start: usize, adjoint: &mut [S]) {
    for (index, record) in records.iter().enumerate().rev() {
        let bar = adjoint[index];
        if bar.value() == 0.0 && bar.is_constant() {
            continue;
        }
        let places = record.operands.into_iter().enumerate().filter(|(_, operand)| *operand != CONSTANT);
        for (side, operand) in places {
            let target = &mut adjoint[operand as usize - start];
            // a partial of zero ends the chain, whatever lies before it: 0 times infinity is not reached
            if record.partials == LINEAR {
                if record.factors[side] != 0.0 {
                    *target += bar * record.factors[side];
                }
            } else {
                let partial = partials[record.partials as usize][side];
                if !(partial.value() == 0.0 && partial.is_constant()) {
                    *target += partial * bar;
                }
            }
        }
    }
}

/// Adds the gradient of `function` at `values` to `gradient`. Works inside another recording.
pub fn add_gradient<S: Recordable>(
    values: impl Iterator<Item = S>,
    function: impl FnOnce(&[Reverse<S>]) -> Reverse<S>,
    gradient: &mut [S],
) {
    // filled in place: moving a long array costs as much as recording
    let mut variables = smallvec::SmallVec::<[Reverse<S>; 32]>::new();
    let (start, first_partial) = S::with_records(|records| {
        let (start, first_partial) = (records.list.len(), records.partials.len());
        for value in values {
            variables.push(Reverse { value, node: records.list.len() as u32 });
            records.list.push(VARIABLE);
        }
        (start, first_partial)
    });
    let result = function(&variables);
    S::with_records(|records| {
        if result.node != CONSTANT {
            let list = &records.list[start..=result.node as usize];
            records.adjoint.clear();
            records.adjoint.resize(list.len(), S::zero());
            records.adjoint[list.len() - 1] = S::one();
            sweep(list, &records.partials, start, &mut records.adjoint);
            for (target, &bar) in gradient.iter_mut().zip(&records.adjoint) {
                *target += bar;
            }
        }
        records.list.truncate(start);
        records.partials.truncate(first_partial);
    });
}

/// Records a function with several results once, and adds the gradient of weights . results to one row for each list of weights.
///
/// Works inside another recording.
pub fn add_gradients<'w>(
    values: impl Iterator<Item = f64>,
    function: impl FnOnce(&[Rev], &mut [Rev]),
    results: &mut [Rev],
    rows: impl Iterator<Item = (&'w [f64], &'w mut [f64])>,
) {
    let mut variables = smallvec::SmallVec::<[Rev; 32]>::new();
    let start = f64::with_records(|records| {
        let start = records.list.len();
        for value in values {
            variables.push(Reverse { value, node: records.list.len() as u32 });
            records.list.push(VARIABLE);
        }
        start
    });
    function(&variables, results);
    f64::with_records(|records| {
        let list = &records.list[start..];
        for (weights, gradient) in rows {
            records.adjoint.clear();
            records.adjoint.resize(list.len(), 0.0);
            for (result, weight) in results.iter().zip(weights) {
                if result.node != CONSTANT {
                    records.adjoint[result.node as usize - start] += weight;
                }
            }
            sweep(list, &records.partials, start, &mut records.adjoint);
            for (target, bar) in gradient.iter_mut().zip(&records.adjoint) {
                *target += bar;
            }
        }
        records.list.truncate(start);
    });
}

/// The recording of one scene function on this thread, from its variables to its results.
pub struct Tape {
    records: Vec<Record>,
    partials: Vec<[f64; 2]>,
    variables: usize,
}

impl Tape {
    /// Runs `function` on recorded variables with the given values and keeps what it did.
    ///
    /// # Panics
    /// Inside another recording on the same thread.
    pub fn record<T>(values: &[f64], function: impl FnOnce(&[Rev]) -> T) -> (Tape, T) {
        f64::with_records(|records| {
            assert!(records.list.is_empty(), "a recording is already running on this thread");
            records.list.resize(values.len(), VARIABLE);
        });
        // emptied on unwinding too, so that a caught panic leaves a usable thread
        struct Emptied;
        impl Drop for Emptied {
            fn drop(&mut self) {
                f64::with_records(|records| {
                    records.list.clear();
                    records.partials.clear();
                });
            }
        }
        let emptied = Emptied;
        let variables: Vec<Rev> = values.iter().zip(0..).map(|(&value, node)| Rev { value, node }).collect();
        let result = function(&variables);
        let (records, partials) =
            f64::with_records(|records| (std::mem::take(&mut records.list), std::mem::take(&mut records.partials)));
        drop(emptied);
        assert!(records.len() < CONSTANT as usize, "a scene function records fewer than 2^32 operations");
        (Tape { records, partials, variables: values.len() }, result)
    }

    /// Gradient with respect to the variables of sum_i weight_i result_i, in one sweep.
    pub fn gradient(&self, weighted_results: impl IntoIterator<Item = (Rev, f64)>) -> Vec<f64> {
        let mut adjoint = vec![0.0; self.records.len()];
        for (result, weight) in weighted_results {
            if result.node != CONSTANT {
                adjoint[result.node as usize] += weight;
            }
        }
        sweep(&self.records, &self.partials, 0, &mut adjoint);
        adjoint.truncate(self.variables);
        adjoint
    }
}

impl<S: Recordable> Reverse<S> {
    /// A value that no recorded variable touches.
    #[inline]
    pub fn constant(value: S) -> Self {
        Reverse { value, node: CONSTANT }
    }

    /// Zero for every value of the variables: sums and products with it are not recorded (Taylor numbers are full of them).
    #[inline(always)]
    fn is_constant_zero(self) -> bool {
        self.node == CONSTANT && self.value.value() == 0.0 && self.value.is_constant()
    }

    #[inline(always)]
    fn linear(self, value: S, factor: f64) -> Self {
        if self.node == CONSTANT {
            return Self::constant(value);
        }
        let node = S::with_records(|records| records.push_linear([self.node, CONSTANT], [factor, 0.0]));
        Reverse { value, node }
    }

    #[inline(always)]
    fn linear_pair(self, other: Self, value: S, factors: [f64; 2]) -> Self {
        if self.node == CONSTANT && other.node == CONSTANT {
            return Self::constant(value);
        }
        if self.node == other.node {
            // one operand: x - x does not move at all
            return self.linear(value, factors[0] + factors[1]);
        }
        let node = S::with_records(|records| records.push_linear([self.node, other.node], factors));
        Reverse { value, node }
    }

    #[inline(always)]
    fn unary(self, value: S, partial: S) -> Self {
        if self.node == CONSTANT {
            return Self::constant(value);
        }
        let node = S::with_records(|records| records.push([self.node, CONSTANT], &[partial, S::zero()]));
        Reverse { value, node }
    }

    #[inline]
    fn chain(self, [value, first, _]: [S; 3]) -> Self {
        self.unary(value, first)
    }

    #[inline(always)]
    fn binary(self, other: Self, value: S, partials: [S; 2]) -> Self {
        if self.node == CONSTANT && other.node == CONSTANT {
            return Self::constant(value);
        }
        if self.node == other.node {
            return self.unary(value, partials[0] + partials[1]);
        }
        let node = S::with_records(|records| records.push([self.node, other.node], &partials));
        Reverse { value, node }
    }
}

impl<S: Recordable> Default for Reverse<S> {
    fn default() -> Self {
        Self::constant(S::zero())
    }
}
impl<S: Recordable> From<f64> for Reverse<S> {
    fn from(value: f64) -> Self {
        Self::constant(S::from(value))
    }
}
impl<S: Recordable> Neg for Reverse<S> {
    type Output = Self;
    fn neg(self) -> Self {
        self.linear(-self.value, -1.0)
    }
}
impl<S: Recordable> Add for Reverse<S> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        if other.is_constant_zero() {
            return self;
        }
        if self.is_constant_zero() {
            return other;
        }
        self.linear_pair(other, self.value + other.value, [1.0, 1.0])
    }
}
impl<S: Recordable> Sub for Reverse<S> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        if other.is_constant_zero() {
            return self;
        }
        self.linear_pair(other, self.value - other.value, [1.0, -1.0])
    }
}
impl<S: Recordable> Mul for Reverse<S> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        if self.is_constant_zero() || other.is_constant_zero() {
            return Self::constant(self.value * other.value);
        }
        self.binary(other, self.value * other.value, [other.value, self.value])
    }
}
impl<S: Recordable> Div for Reverse<S> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        let inverse = other.value.recip();
        self.binary(other, quotient, [inverse, -(quotient * inverse)])
    }
}
impl<S: Recordable> Add<f64> for Reverse<S> {
    type Output = Self;
    fn add(self, other: f64) -> Self {
        // the same place: the derivative is that of self
        Reverse { value: self.value + other, node: self.node }
    }
}
impl<S: Recordable> Sub<f64> for Reverse<S> {
    type Output = Self;
    fn sub(self, other: f64) -> Self {
        Reverse { value: self.value - other, node: self.node }
    }
}
impl<S: Recordable> Mul<f64> for Reverse<S> {
    type Output = Self;
    fn mul(self, other: f64) -> Self {
        self.linear(self.value * other, other)
    }
}
impl<S: Recordable> Div<f64> for Reverse<S> {
    type Output = Self;
    fn div(self, other: f64) -> Self {
        self.linear(self.value / other, 1.0 / other)
    }
}
super::assign_operators!([S: Recordable] Reverse<S>);

impl<S: Recordable> Scalar for Reverse<S> {
    fn value(self) -> f64 {
        self.value.value()
    }
    fn is_constant(self) -> bool {
        self.node == CONSTANT && self.value.is_constant()
    }
    super::jet::functions_by_chain!(value);
    fn atan2(self, other: Self) -> Self {
        let square = self.value * self.value + other.value * other.value;
        let partials = [other.value / square, -(self.value / square)];
        self.binary(other, self.value.atan2(other.value), partials)
    }
}

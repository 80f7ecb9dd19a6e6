use super::jet::Jet;
use super::{LANES, Scalar, assign_operators};
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value on a tape that keeps first and second partial derivatives of every operation.
///
/// Recorded once in real numbers, a vector function g of n variables gives the products of the second derivative of a combination
/// mu . g with eight directions at a time, for a few operations per record: the part A^T mu of a Jacobian, several times faster than
/// reverse mode over eight dual lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curved {
    value: f64,
    node: u32,
}

/// Marks a value without a place on the tape.
const CONSTANT: u32 = u32::MAX;

/// One operation of up to two operands: first derivatives, and second ones in the order (aa, ab, bb).
#[derive(Clone, Copy, Debug)]
struct Record {
    operands: [u32; 2],
    first: [f64; 2],
    second: [f64; 3],
}

/// Derivatives in eight directions.
pub type Direction = [f64; LANES];

#[derive(Default)]
struct Workspace {
    records: Vec<Record>,
    adjoint: Vec<f64>,
    tangents: Vec<Direction>,
    adjoint_tangents: Vec<Direction>,
}

thread_local! {
    static WORKSPACE: RefCell<Workspace> = const {
        RefCell::new(Workspace {
            records: Vec::new(),
            adjoint: Vec::new(),
            tangents: Vec::new(),
            adjoint_tangents: Vec::new(),
        })
    };
}

impl Workspace {
    /// Adjoints of all records for the seeded results.
    fn sweep(&mut self, seeds: impl Iterator<Item = (u32, f64)>) {
        self.adjoint.clear();
        self.adjoint.resize(self.records.len(), 0.0);
        for (node, seed) in seeds.filter(|(node, _)| *node != CONSTANT) {
            self.adjoint[node as usize] += seed;
        }
        for index in (0..self.records.len()).rev() {
            let (bar, record) = (self.adjoint[index], self.records[index]);
            if bar != 0.0 {
                for (operand, first) in record.operands.into_iter().zip(record.first) {
                    if operand != CONSTANT && first != 0.0 {
                        self.adjoint[operand as usize] += first * bar;
                    }
                }
            }
        }
    }

    /// Derivative of the adjoints in eight directions, given as the tangents of the variables.
    fn sweep_tangents(&mut self, variables: &[Direction]) {
        let count = self.records.len();
        self.tangents.clear();
        self.tangents.extend_from_slice(variables);
        for record in &self.records[variables.len()..] {
            let mut tangent = [0.0; LANES];
            for (operand, first) in record.operands.into_iter().zip(record.first) {
                if operand != CONSTANT && first != 0.0 {
                    add_multiple(&mut tangent, first, &self.tangents[operand as usize]);
                }
            }
            self.tangents.push(tangent);
        }
        self.adjoint_tangents.clear();
        self.adjoint_tangents.resize(count, [0.0; LANES]);
        for index in (variables.len()..count).rev() {
            let (bar, record) = (self.adjoint[index], self.records[index]);
            let bar_tangent = self.adjoint_tangents[index];
            let [a, b] = record.operands;
            let [aa, ab, bb] = record.second.map(|second| second * bar);
            for (operand, first, own, other, cross) in [(a, record.first[0], aa, b, ab), (b, record.first[1], bb, a, ab)] {
                if operand == CONSTANT {
                    continue;
                }
                let mut sum = [0.0; LANES];
                if first != 0.0 {
                    add_multiple(&mut sum, first, &bar_tangent);
                }
                if own != 0.0 {
                    add_multiple(&mut sum, own, &self.tangents[operand as usize]);
                }
                if cross != 0.0 && other != CONSTANT {
                    add_multiple(&mut sum, cross, &self.tangents[other as usize]);
                }
                add_multiple(&mut self.adjoint_tangents[operand as usize], 1.0, &sum);
            }
        }
    }
}

#[inline(always)]
fn add_multiple(target: &mut Direction, factor: f64, values: &Direction) {
    for (target, value) in target.iter_mut().zip(values) {
        *target += factor * value;
    }
}

/// Differentiates a vector function at `variables`: writes, for each group of eight directions (variables by lanes, one group after the
/// other), the second derivative of multipliers . g along them.
///
/// # Panics
/// Inside itself on the same thread.
pub fn curvature(
    variables: &[f64],
    function: impl FnOnce(&[Curved], &mut [Curved]),
    multipliers: &[f64],
    directions: &[Direction],
    products: &mut [Direction],
) {
    let n = variables.len();
    let mut inputs = smallvec::SmallVec::<[Curved; 16]>::new();
    let mut results: smallvec::SmallVec<[Curved; 6]> = smallvec::SmallVec::from_elem(Curved::default(), multipliers.len());
    WORKSPACE.with_borrow_mut(|work| {
        work.records.clear();
        for (&value, node) in variables.iter().zip(0..) {
            work.records.push(Record { operands: [CONSTANT; 2], first: [0.0; 2], second: [0.0; 3] });
            inputs.push(Curved { value, node });
        }
    });
    function(&inputs, &mut results);
    WORKSPACE.with_borrow_mut(|work| {
        work.sweep(results.iter().map(|result| result.node).zip(multipliers.iter().copied()));
        for (group, products) in directions.chunks_exact(n).zip(products.chunks_exact_mut(n)) {
            work.sweep_tangents(group);
            products.copy_from_slice(&work.adjoint_tangents[..n]);
        }
    });
}

impl Curved {
    #[inline]
    fn record(value: f64, record: Record) -> Self {
        let node = WORKSPACE.with_borrow_mut(|work| {
            work.records.push(record);
            work.records.len() as u32 - 1
        });
        Curved { value, node }
    }

    #[inline]
    fn chain(self, [value, first, second]: Jet<f64>) -> Self {
        if self.node == CONSTANT {
            return Curved::from(value);
        }
        Curved::record(value, Record { operands: [self.node, CONSTANT], first: [first, 0.0], second: [second, 0.0, 0.0] })
    }

    #[inline]
    fn binary(self, other: Self, value: f64, first: [f64; 2], second: [f64; 3]) -> Self {
        if self.node == CONSTANT && other.node == CONSTANT {
            return Curved::from(value);
        }
        if self.node == other.node {
            return self.chain([value, first[0] + first[1], second[0] + 2.0 * second[1] + second[2]]);
        }
        Curved::record(value, Record { operands: [self.node, other.node], first, second })
    }
}

impl Default for Curved {
    fn default() -> Self {
        Curved::from(0.0)
    }
}
impl From<f64> for Curved {
    #[inline]
    fn from(value: f64) -> Self {
        Curved { value, node: CONSTANT }
    }
}
impl Neg for Curved {
    type Output = Self;
    fn neg(self) -> Self {
        self.chain([-self.value, -1.0, 0.0])
    }
}
impl Add for Curved {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.binary(other, self.value + other.value, [1.0, 1.0], [0.0; 3])
    }
}
impl Sub for Curved {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.binary(other, self.value - other.value, [1.0, -1.0], [0.0; 3])
    }
}
impl Mul for Curved {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.binary(other, self.value * other.value, [other.value, self.value], [0.0, 1.0, 0.0])
    }
}
impl Div for Curved {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        let inverse = 1.0 / other.value;
        let square = inverse * inverse;
        self.binary(other, quotient, [inverse, -quotient * inverse], [0.0, -square, 2.0 * quotient * square])
    }
}
impl Add<f64> for Curved {
    type Output = Self;
    fn add(self, other: f64) -> Self {
        Curved { value: self.value + other, node: self.node }
    }
}
impl Sub<f64> for Curved {
    type Output = Self;
    fn sub(self, other: f64) -> Self {
        Curved { value: self.value - other, node: self.node }
    }
}
impl Mul<f64> for Curved {
    type Output = Self;
    fn mul(self, other: f64) -> Self {
        self.chain([self.value * other, other, 0.0])
    }
}
impl Div<f64> for Curved {
    type Output = Self;
    fn div(self, other: f64) -> Self {
        self.chain([self.value / other, 1.0 / other, 0.0])
    }
}
assign_operators!([] Curved);

impl Scalar for Curved {
    fn value(self) -> f64 {
        self.value
    }
    fn is_constant(self) -> bool {
        self.node == CONSTANT
    }
    super::jet::functions_by_chain!(value);
    fn atan2(self, other: Self) -> Self {
        let (y, x) = (self.value, other.value);
        let square = x * x + y * y;
        let (along, across) = (x / square, y / square);
        let mixed = 2.0 * along * across;
        let second = [-mixed, across * across - along * along, mixed];
        self.binary(other, y.atan2(x), [along, -across], second)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::{Dual, Lanes};

    /// Uses every kind of operation with a curvature of its own.
    fn sample<S: Scalar>(x: &[S]) -> [S; 2] {
        let [a, b, c] = [x[0], x[1], x[2]];
        let first = a * b / (c * c + 1.0) + (a - b * 2.0).sin() * c.exp() - a.atan2(b * c) + a * a;
        let second = (a * a + b * b + 0.5).sqrt() * c - (-b).powi(3) / 4.0 + (c + a).tanh();
        [first, second]
    }

    #[test]
    fn curvature_agrees_with_nested_duals() {
        let at = [0.7, -0.4, 1.3];
        let multipliers = [1.7, -0.6];
        let mut directions = vec![[0.0; LANES]; 3];
        for (i, direction) in directions.iter_mut().enumerate() {
            for (lane, entry) in direction.iter_mut().enumerate() {
                *entry = ((3 * i + 2 * lane) as f64).sin();
            }
        }
        let mut products = vec![[0.0; LANES]; 3];
        let function = |x: &[Curved], g: &mut [Curved]| g.copy_from_slice(&sample(x));
        curvature(&at, function, &multipliers, &directions, &mut products);

        for i in 0..3 {
            let x: Vec<Dual<Lanes, 1>> = (0..3)
                .map(|j| {
                    let inner = Lanes { re: at[j], eps: directions[j] };
                    Dual { re: inner, eps: [Lanes::from(f64::from(u8::from(i == j)))] }
                })
                .collect();
            let g = sample(&x);
            for lane in 0..LANES {
                let expected: f64 = g.iter().zip(multipliers).map(|(g, m)| m * g.eps[0].eps[lane]).sum();
                assert!((products[i][lane] - expected).abs() < 1e-13, "curvature {i}, {lane}");
            }
        }
    }
}

//! Matrices like those of flexible structures, of any size.

use crate::Noise;
use costate::linalg::SparsePattern;
use std::sync::Arc;

/// A matrix by its pattern and its values.
pub struct Matrix {
    /// What it is like.
    pub name: String,
    /// Places of its entries.
    pub pattern: Arc<SparsePattern>,
    /// Its entries.
    pub values: Vec<f64>,
}

/// Unknowns of a node.
const UNKNOWNS: usize = 6;
/// Part of an element's matrix that is not symmetric, as that of follower loads and gyroscopic forces.
const UNSYMMETRIC: f64 = 0.02;
/// Every so many nodes a joint ties one to its neighbour.
const JOINT_EVERY: usize = 40;
/// Equations of a joint.
const EQUATIONS: usize = 3;

/// A square mesh of shells: elements of nine nodes with six unknowns each, about `unknowns` of them, and joints.
pub fn shell(unknowns: usize) -> Matrix {
    let side = ((unknowns as f64 / UNKNOWNS as f64).sqrt() as usize / 2) * 2 + 1;
    let mut elements = Vec::new();
    for i in (0..side - 1).step_by(2) {
        for j in (0..side - 1).step_by(2) {
            elements.push((0..9).map(|k| (i + k / 3) * side + j + k % 3).collect());
        }
    }
    assembled(format!("shell, {side} x {side} nodes"), side * side, &elements)
}

/// A chain of beams: elements of three nodes with six unknowns each, about `unknowns` of them, and joints.
pub fn chain(unknowns: usize) -> Matrix {
    let nodes = unknowns / UNKNOWNS / 2 * 2 + 1;
    let elements: Vec<Vec<usize>> = (0..nodes - 1).step_by(2).map(|first| vec![first, first + 1, first + 2]).collect();
    assembled(format!("chain, {nodes} nodes"), nodes, &elements)
}

/// A full matrix.
pub fn full(size: usize) -> Matrix {
    let mut noise = Noise::new(size as u64);
    let pattern = SparsePattern::from_entries(size, (0..size * size).map(|place| (place / size, place % size)).collect());
    let mut values: Vec<f64> = pattern.rows.iter().map(|_| noise.next()).collect();
    (0..size).for_each(|i| values[i * size + i] += 4.0);
    Matrix { name: format!("full, {size}"), pattern: Arc::new(pattern), values }
}

/// Sums of elements' matrices: of differences of their nodes, as stiffness is, with a diagonal of inertia and a part that is not
/// symmetric; and joints that tie nodes to the next ones.
fn assembled(name: String, nodes: usize, elements: &[Vec<usize>]) -> Matrix {
    let ties: Vec<usize> = (0..nodes.saturating_sub(1)).step_by(JOINT_EVERY).collect();
    let size = UNKNOWNS * nodes + EQUATIONS * ties.len();
    let place = |joint: usize, equation: usize| UNKNOWNS * nodes + EQUATIONS * joint + equation;
    let unknowns = |element: &[usize]| -> Vec<usize> {
        element.iter().flat_map(|node| UNKNOWNS * node..UNKNOWNS * (node + 1)).collect()
    };
    let mut entries = Vec::new();
    for element in elements {
        let own = unknowns(element);
        entries.extend(own.iter().flat_map(|&column| own.iter().map(move |&row| (column, row))));
    }
    for (joint, &node) in ties.iter().enumerate() {
        for equation in 0..EQUATIONS {
            for held in [UNKNOWNS * node + equation, UNKNOWNS * (node + 1) + equation] {
                entries.extend([(held, place(joint, equation)), (place(joint, equation), held)]);
            }
        }
    }
    let pattern = SparsePattern::from_entries(size, entries);
    let mut values = vec![0.0; pattern.rows.len()];
    let mut noise = Noise::new(nodes as u64);
    let mut add = |row: usize, column: usize, value: f64| {
        values[pattern.position(row, column).expect("an entry of the pattern")] += value;
    };
    for element in elements {
        let own = unknowns(element);
        let share = 1.0 / element.len() as f64;
        for (i, &row) in own.iter().enumerate() {
            for (j, &column) in own.iter().enumerate() {
                let like = f64::from(u8::from(i % UNKNOWNS == j % UNKNOWNS));
                let stiffness = if i == j { 1.0 + 0.1 * noise.next().abs() } else { -like * share };
                add(row, column, stiffness + UNSYMMETRIC * noise.next());
            }
        }
    }
    for (joint, &node) in ties.iter().enumerate() {
        for equation in 0..EQUATIONS {
            for (held, sign) in [(UNKNOWNS * node + equation, 1.0), (UNKNOWNS * (node + 1) + equation, -1.0)] {
                add(held, place(joint, equation), sign);
                add(place(joint, equation), held, sign);
            }
        }
    }
    Matrix { name, pattern: Arc::new(pattern), values }
}

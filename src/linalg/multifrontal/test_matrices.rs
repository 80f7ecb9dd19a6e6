//! Matrices for tests, and a dense elimination to compare with.

use crate::linalg::SparsePattern;
use nalgebra::{DMatrix, DVector, Dyn, FullPivLU};

/// Numbers between -1 and 1 without a visible order.
pub struct Noise(pub u64);
impl Noise {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    pub fn below(&mut self, end: usize) -> usize {
        ((self.next() + 1.0) / 2.0 * end as f64) as usize % end
    }
    pub fn vector(&mut self, length: usize) -> Vec<f64> {
        (0..length).map(|_| self.next()).collect()
    }
}

/// LU with complete pivoting, which also knows how far from singular a matrix is.
pub struct Reference(FullPivLU<f64, Dyn, Dyn>);

impl Reference {
    /// Of a matrix, and of its transpose.
    pub fn both(pattern: &SparsePattern, values: &[f64]) -> [Self; 2] {
        let mut matrix = DMatrix::zeros(pattern.size, pattern.size);
        pattern.spread(values, matrix.as_mut_slice());
        [matrix.clone(), matrix.transpose()].map(|matrix| Reference(matrix.full_piv_lu()))
    }

    /// The last pivot as a share of the first: about the inverse of the condition number.
    pub fn distance_from_singular(&self) -> f64 {
        let pivots = self.0.u().diagonal();
        pivots[pivots.len() - 1].abs() / pivots[0].abs().max(f64::MIN_POSITIVE)
    }

    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        self.0.solve(&DVector::from_column_slice(b)).expect("regular").as_slice().to_vec()
    }
}

pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    let scale = b.iter().fold(f64::MIN_POSITIVE, |s: f64, b| s.max(b.abs()));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / scale
}

/// Unknowns in nodes of several, some coupled, with multipliers, in several components; unsymmetric pattern.
pub fn random_pattern(noise: &mut Noise, nodes: usize, multipliers: usize) -> SparsePattern {
    let starts: Vec<usize> = (0..=nodes)
        .scan(0, |next, _| {
            let start = *next;
            *next += 1 + noise.below(6);
            Some(start)
        })
        .collect();
    let unknowns = starts[nodes];
    let mut entries = Vec::new();
    let mut couple = |a: usize, b: usize| {
        for i in starts[a]..starts[a + 1] {
            entries.extend((starts[b]..starts[b + 1]).map(|j| (i, j)));
        }
    };
    (0..nodes).for_each(|node| couple(node, node));
    for _ in 0..2 * nodes {
        let (a, b) = (noise.below(nodes), noise.below(nodes));
        // two components, as long as no multiplier connects them
        if a % 2 == b % 2 {
            couple(a, b);
            if noise.next() > -0.6 {
                couple(b, a);
            }
        }
    }
    for multiplier in unknowns..unknowns + multipliers {
        for _ in 0..1 + noise.below(4) {
            let other = noise.below(unknowns);
            entries.extend([(multiplier, other), (other, multiplier)]);
        }
    }
    SparsePattern::from_entries(unknowns + multipliers, entries)
}

/// A chain of rigid bodies with six unknowns, each tied to the one before by three multipliers behind all bodies, the first to the ground.
pub fn chain(bodies: usize) -> SparsePattern {
    let mut entries = Vec::new();
    for body in 0..bodies {
        entries.extend((0..36).map(|k| (6 * body + k / 6, 6 * body + k % 6)));
        for multiplier in 3 * body..(3 * body + 6).min(3 * bodies) {
            let own = (0..6).map(|k| (6 * bodies + multiplier, 6 * body + k));
            entries.extend(own.flat_map(|(a, b)| [(a, b), (b, a)]));
        }
    }
    SparsePattern::from_entries(9 * bodies, entries)
}

/// A square grid of elements with nine nodes of six unknowns; multipliers fix the first nodes.
pub fn shell(side: usize, fixed: usize) -> SparsePattern {
    let node = |row: usize, column: usize| 6 * (row * side + column);
    let size = 6 * side * side;
    let mut entries = Vec::new();
    for row in (0..side - 1).step_by(2) {
        for column in (0..side - 1).step_by(2) {
            let nodes: Vec<usize> = (0..9).map(|k| node(row + k / 3, column + k % 3)).collect();
            for &a in &nodes {
                for &b in &nodes {
                    entries.extend((0..36).map(|k| (a + k / 6, b + k % 6)));
                }
            }
        }
    }
    entries.extend((0..fixed).flat_map(|k| [(size + k, k), (k, size + k)]));
    SparsePattern::from_entries(size + fixed, entries)
}

/// Positive definite but for round-off and multipliers: each diagonal entry is larger than the sum of its column.
pub fn dominant(noise: &mut Noise, pattern: &SparsePattern) -> Vec<f64> {
    let mut values = Vec::with_capacity(pattern.rows.len());
    for column in 0..pattern.size {
        let rows = &pattern.rows[pattern.column_starts[column]..pattern.column_starts[column + 1]];
        values.extend(rows.iter().map(|&row| if row as usize == column { rows.len() as f64 } else { noise.next() }));
    }
    values
}

/// Numbers of which those near the diagonal are small, so that pivots have to be searched.
pub fn weak(noise: &mut Noise, pattern: &SparsePattern) -> Vec<f64> {
    let mut values = noise.vector(pattern.rows.len());
    for (column, ends) in pattern.column_starts.windows(2).enumerate() {
        let entries = values[ends[0]..ends[1]].iter_mut().zip(&pattern.rows[ends[0]..ends[1]]);
        entries.filter(|(_, row)| (**row as usize).abs_diff(column) < 4).for_each(|(value, _)| *value *= 1e-6);
    }
    values
}

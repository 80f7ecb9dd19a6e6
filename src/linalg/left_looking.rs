// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::{LinearSolver, Ordering, Singular};
use crate::linalg::SparsePattern;
use crate::linalg::simd::{Kernel, dispatch};
use std::collections::BinaryHeap;
use std::ops::Range;
use std::sync::Arc;

/// Sparse LU that finds its pivots once and afterwards repeats the same operations on new values, without searching or
/// allocating: for chains and small mechanisms, where the arithmetic is little and everything around it counts.
///
/// Columns are eliminated from left to right; the pivot of a column is its diagonal entry unless another is more than
/// `DIAGONAL_SHARE` times larger. When a repeated factorization meets a pivot below `PIVOT_SHARE` of its column, pivots
/// are searched anew.
///
/// Source: Gilbert & Peierls (1988); Davis & Natarajan (2010), KLU.
pub struct LeftLookingLu {
    pattern: Arc<SparsePattern>,
    ordering: Arc<Ordering>,
    /// Place of each column in the order of elimination.
    place_of_column: Vec<usize>,
    factors: Option<Factors>,
    /// Step in which each row is to become the pivot of the next search.
    prescribed: Option<Vec<usize>>,
    work: Vec<f64>,
    gathered: Vec<f64>,
}

/// How many times larger than the diagonal another entry must be to become the pivot.
const DIAGONAL_SHARE: f64 = 100.0;
/// Smallest pivot of a repeated factorization, as a share of the largest entry that could be one.
const PIVOT_SHARE: f64 = 1e-3;
/// Pivots smaller than this, in a matrix whose rows and columns have the size 1, are taken for zero.
const TINY_PIVOT: f64 = 1e-14;

/// Triangular factors; rows are numbered by the step in which they became pivots.
#[derive(Default)]
struct Factors {
    /// Step in which each row became the pivot.
    step_of_row: Vec<usize>,
    lower: Triangle,
    upper: Triangle,
    /// Steps in a row whose columns of L have the same rows below them, as the unknowns of a node do.
    supernodes: Vec<Supernode>,
    /// Of each step.
    supernode_of_step: Vec<u32>,
    /// Of the pivots.
    inverses: Vec<f64>,
    /// Step numbers of the rows of the pattern's entries, in the order of elimination of their columns.
    entry_steps: Vec<u32>,
}

/// Columns of a triangular matrix without its diagonal: runs of rows that follow each other, as the unknowns of a node do.
#[derive(Default)]
struct Triangle {
    /// First run of each column, and the end.
    starts: Vec<usize>,
    runs: Vec<Run>,
    values: Vec<f64>,
}

/// Steps `first..end`, below which their columns of L have `below` rows.
#[derive(Clone, Copy)]
struct Supernode {
    first: usize,
    end: usize,
    below: usize,
}

/// Some entries of a column.
#[derive(Clone, Copy)]
struct Run {
    /// First row.
    row: u32,
    /// Number of rows.
    length: u32,
    /// Place of the first value.
    place: usize,
}

impl Run {
    #[inline(always)]
    fn rows(self) -> Range<usize> {
        self.row as usize..(self.row + self.length) as usize
    }
    #[inline(always)]
    fn values(self) -> Range<usize> {
        self.place..self.place + self.length as usize
    }
}

impl Triangle {
    /// Of columns given by (row, value), each in the order of its rows.
    fn of(columns: &[Vec<(u32, f64)>]) -> Self {
        let mut triangle = Triangle { starts: vec![0], ..Triangle::default() };
        for column in columns {
            let first = triangle.runs.len();
            for &(row, value) in column {
                let place = triangle.values.len();
                match triangle.runs[first..].last_mut() {
                    Some(run) if run.row + run.length == row => run.length += 1,
                    _ => triangle.runs.push(Run { row, length: 1, place }),
                }
                triangle.values.push(value);
            }
            triangle.starts.push(triangle.runs.len());
        }
        triangle
    }

    /// Number of entries of column k.
    fn length(&self, k: usize) -> usize {
        self.column(k).iter().map(|run| run.length as usize).sum()
    }

    /// Steps in a row whose columns have the same rows but for their own.
    fn supernodes(&self) -> Vec<Supernode> {
        let steps = self.starts.len() - 1;
        let rows = |k: usize| self.column(k).iter().flat_map(|run| run.rows());
        let mut supernodes: Vec<Supernode> = Vec::new();
        for k in 0..steps {
            match supernodes.last_mut() {
                Some(last) if rows(k - 1).eq(std::iter::once(k).chain(rows(k))) => last.end = k + 1,
                _ => supernodes.push(Supernode { first: k, end: k + 1, below: 0 }),
            }
        }
        supernodes.iter_mut().for_each(|own| own.below = self.length(own.end - 1));
        supernodes
    }

    /// The last `count` values of column k.
    #[inline(always)]
    fn last_values(&self, k: usize, count: usize) -> &[f64] {
        let end = self.starts.get(k + 1).and_then(|&next| self.runs.get(next)).map_or(self.values.len(), |run| run.place);
        &self.values[end - count..end]
    }

    #[inline(always)]
    fn column(&self, k: usize) -> &[Run] {
        &self.runs[self.starts[k]..self.starts[k + 1]]
    }

    /// x -= factor times column k.
    #[inline(always)]
    fn subtract(&self, k: usize, factor: f64, x: &mut [f64]) {
        for run in self.column(k) {
            subtract_scaled(factor, &self.values[run.values()], &mut x[run.rows()]);
        }
    }

    /// Column k times x.
    #[inline(always)]
    fn product(&self, k: usize, x: &[f64]) -> f64 {
        let mut sum = 0.0;
        for run in self.column(k) {
            for (x, value) in x[run.rows()].iter().zip(&self.values[run.values()]) {
                sum += x * value;
            }
        }
        sum
    }
}

/// target -= factor source, without a loop for the few unknowns of a node.
#[inline(always)]
fn subtract_scaled(factor: f64, source: &[f64], target: &mut [f64]) {
    /// W numbers.
    #[inline(always)]
    fn of<const W: usize>(factor: f64, source: &[f64], target: &mut [f64]) {
        if let (Some(source), Some(target)) = (source.first_chunk::<W>(), target.first_chunk_mut::<W>()) {
            for i in 0..W {
                target[i] -= factor * source[i];
            }
        }
    }
    match source.len() {
        1 => of::<1>(factor, source, target),
        2 => of::<2>(factor, source, target),
        3 => of::<3>(factor, source, target),
        4 => of::<4>(factor, source, target),
        5 => of::<5>(factor, source, target),
        6 => of::<6>(factor, source, target),
        _ => target.iter_mut().zip(source).for_each(|(target, source)| *target -= factor * source),
    }
}

/// A row that is not yet a pivot.
const FREE: usize = usize::MAX;

impl LeftLookingLu {
    /// Prepares for matrices of a pattern, with an order of its columns.
    pub fn new(pattern: &SparsePattern, ordering: Ordering) -> Self {
        Self::of(Arc::new(pattern.clone()), Arc::new(ordering))
    }

    fn of(pattern: Arc<SparsePattern>, ordering: Arc<Ordering>) -> Self {
        let mut place_of_column = vec![0; pattern.size];
        ordering.columns.iter().enumerate().for_each(|(place, &column)| place_of_column[column] = place);
        LeftLookingLu {
            work: vec![0.0; pattern.size],
            pattern,
            ordering,
            place_of_column,
            factors: None,
            prescribed: None,
            gathered: Vec::new(),
        }
    }

    /// Factors with a search for pivots.
    fn search(&mut self, values: &[f64]) -> Result<Factors, Singular> {
        let n = self.pattern.size;
        let mut factors = Factors { step_of_row: vec![FREE; n], ..Factors::default() };
        // rows of L keep their own numbers until all steps are known
        let (mut lower, mut upper) = (Vec::<Vec<(u32, f64)>>::with_capacity(n), Vec::<Vec<(u32, f64)>>::with_capacity(n));
        let work = &mut self.work;
        work.fill(0.0);
        let mut seen = vec![usize::MAX; n];
        let (mut row_of_step, mut pivots) = (Vec::with_capacity(n), Vec::with_capacity(n));
        for k in 0..n {
            let column = self.ordering.columns[k];
            let mut pending = BinaryHeap::new();
            let (mut above, mut below) = (Vec::new(), Vec::new());
            let mut visit = |row: usize, pending: &mut BinaryHeap<std::cmp::Reverse<usize>>, step: usize| {
                if seen[row] != k {
                    seen[row] = k;
                    if step == FREE { below.push(row) } else { pending.push(std::cmp::Reverse(step)) }
                }
            };
            for place in self.pattern.column_starts[column]..self.pattern.column_starts[column + 1] {
                let row = self.pattern.rows[place];
                work[row] = values[place];
                visit(row, &mut pending, factors.step_of_row[row]);
            }
            while let Some(std::cmp::Reverse(step)) = pending.pop() {
                let row: usize = row_of_step[step];
                let factor = std::mem::take(&mut work[row]);
                above.push((step as u32, factor));
                for &(row, entry) in &lower[step] {
                    work[row as usize] -= factor * entry;
                    visit(row as usize, &mut pending, factors.step_of_row[row as usize]);
                }
            }
            upper.push(above);
            let size = |row: usize, work: &[f64]| work[row].abs();
            let largest = below.iter().copied().max_by(|&i, &j| size(i, work).total_cmp(&size(j, work)));
            let prescribed = self.prescribed.as_ref().and_then(|steps| below.iter().copied().find(|&row| steps[row] == k));
            let pivot_row = match largest {
                Some(_) if prescribed.is_some_and(|row| size(row, work) >= TINY_PIVOT) => prescribed.unwrap_or(0),
                Some(row) if size(row, work) >= TINY_PIVOT => {
                    let diagonal = factors.step_of_row[column] == FREE && seen[column] == k;
                    if diagonal && size(column, work) * DIAGONAL_SHARE >= size(row, work) { column } else { row }
                }
                _ => {
                    work.fill(0.0);
                    return Err(self.dependent(&pivots, &upper, k));
                }
            };
            let pivot = work[pivot_row];
            let inverse = 1.0 / pivot;
            let mut own = Vec::with_capacity(below.len());
            for row in below {
                let entry = std::mem::take(&mut work[row]);
                if row != pivot_row {
                    own.push((row as u32, entry * inverse));
                }
            }
            lower.push(own);
            factors.step_of_row[pivot_row] = k;
            row_of_step.push(pivot_row);
            pivots.push(pivot);
            factors.inverses.push(inverse);
        }
        for column in &mut lower {
            column.iter_mut().for_each(|(row, _)| *row = factors.step_of_row[*row as usize] as u32);
            column.sort_unstable_by_key(|&(row, _)| row);
        }
        (factors.lower, factors.upper) = (Triangle::of(&lower), Triangle::of(&upper));
        factors.supernodes = factors.lower.supernodes();
        let steps_of = |(index, own): (usize, &Supernode)| std::iter::repeat_n(index as u32, own.end - own.first);
        factors.supernode_of_step = factors.supernodes.iter().enumerate().flat_map(steps_of).collect();
        for &column in &self.ordering.columns {
            let own = self.pattern.column_starts[column]..self.pattern.column_starts[column + 1];
            factors.entry_steps.extend(self.pattern.rows[own].iter().map(|&row| factors.step_of_row[row] as u32));
        }
        Ok(factors)
    }

    /// The unknown that dominates the null vector of a column that depends on those before it: U x = 0 with x_k = 1.
    fn dependent(&self, pivots: &[f64], upper: &[Vec<(u32, f64)>], k: usize) -> Singular {
        let mut x = vec![0.0; k + 1];
        x[k] = 1.0;
        for column in (0..=k).rev() {
            if column < k {
                x[column] /= pivots[column];
            }
            let value = x[column];
            for &(row, entry) in &upper[column] {
                x[row as usize] -= entry * value;
            }
        }
        let largest = (0..=k).max_by(|&i, &j| x[i].abs().total_cmp(&x[j].abs())).unwrap_or(k);
        Singular { unknown: self.ordering.columns[largest] }
    }
}

/// The same operations as before on new values: `false` where a pivot became small.
struct Repetition<'j> {
    pattern: &'j SparsePattern,
    columns: &'j [usize],
    factors: &'j mut Factors,
    values: &'j [f64],
    work: &'j mut [f64],
    gathered: &'j mut Vec<f64>,
}

/// x -= L u for the values u of x at some steps of a supernode.
#[inline(always)]
fn eliminate(lower: &Triangle, supernode: Supernode, steps: Range<usize>, x: &mut [f64], gathered: &mut Vec<f64>) {
    let Supernode { end, below, .. } = supernode;
    if steps.len() == 1 {
        return lower.subtract(steps.start, x[steps.start], x);
    }
    for step in steps.clone() {
        let length = end - step - 1;
        let (factor, column) = (x[step], lower.last_values(step, below + length));
        subtract_scaled(factor, &column[..length], &mut x[step + 1..end]);
    }
    if below == 0 {
        return;
    }
    gathered.clear();
    let rows = lower.column(end - 1);
    rows.iter().for_each(|run| gathered.extend_from_slice(&x[run.rows()]));
    let mut steps = steps;
    while steps.len() >= 3 {
        let step = steps.start;
        let columns = [step, step + 1, step + 2].map(|step| &lower.last_values(step, below)[..below]);
        let factors = [x[step], x[step + 1], x[step + 2]];
        for (i, target) in gathered[..below].iter_mut().enumerate() {
            *target = ((*target - factors[0] * columns[0][i]) - factors[1] * columns[1][i]) - factors[2] * columns[2][i];
        }
        steps.start += 3;
    }
    for step in steps {
        let (factor, column) = (x[step], lower.last_values(step, below));
        gathered[..below].iter_mut().zip(column).for_each(|(target, entry)| *target -= factor * entry);
    }
    let mut place = 0;
    for run in rows {
        let length = run.length as usize;
        x[run.rows()].copy_from_slice(&gathered[place..place + length]);
        place += length;
    }
}

impl Kernel for Repetition<'_> {
    type Output = bool;
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> bool {
        let Repetition { pattern, columns, factors, values, work, gathered } = self;
        let mut entry = 0;
        for (k, &column) in columns.iter().enumerate() {
            for &value in &values[pattern.column_starts[column]..pattern.column_starts[column + 1]] {
                work[factors.entry_steps[entry] as usize] = value;
                entry += 1;
            }
            let Factors { lower, upper, supernodes, supernode_of_step, .. } = &mut *factors;
            for run in upper.starts[k]..upper.starts[k + 1] {
                let run = upper.runs[run];
                let mut steps = run.rows();
                while !steps.is_empty() {
                    let supernode = supernodes[supernode_of_step[steps.start] as usize];
                    let own = steps.start..steps.end.min(supernode.end);
                    eliminate(lower, supernode, own.clone(), work, gathered);
                    steps.start = own.end;
                }
                upper.values[run.values()].copy_from_slice(&work[run.rows()]);
                work[run.rows()].fill(0.0);
            }
            let pivot = std::mem::take(&mut work[k]);
            let inverse = 1.0 / pivot;
            let mut largest = pivot.abs();
            for run in factors.lower.starts[k]..factors.lower.starts[k + 1] {
                let run = factors.lower.runs[run];
                for (entry, stored) in work[run.rows()].iter_mut().zip(&mut factors.lower.values[run.values()]) {
                    let entry = std::mem::take(entry);
                    largest = largest.max(entry.abs());
                    *stored = entry * inverse;
                }
            }
            factors.inverses[k] = inverse;
            if !(pivot.abs() >= TINY_PIVOT && pivot.abs() >= PIVOT_SHARE * largest) {
                work.fill(0.0);
                return false;
            }
        }
        true
    }
}

/// L U x = b, or its transpose, in the order of elimination.
struct Substitution<'j> {
    factors: &'j Factors,
    transposed: bool,
    x: &'j mut [f64],
    gathered: &'j mut Vec<f64>,
}

impl Kernel for Substitution<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Substitution { factors: Factors { lower, upper, supernodes, inverses, .. }, transposed, x, gathered } = self;
        if transposed {
            for k in 0..x.len() {
                x[k] = (x[k] - upper.product(k, x)) * inverses[k];
            }
            for k in (0..x.len()).rev() {
                x[k] -= lower.product(k, x);
            }
            return;
        }
        for &supernode in supernodes {
            eliminate(lower, supernode, supernode.first..supernode.end, x, gathered);
        }
        for k in (0..x.len()).rev() {
            let value = x[k] * inverses[k];
            x[k] = value;
            upper.subtract(k, value, x);
        }
    }
}

impl LinearSolver for LeftLookingLu {
    fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        let LeftLookingLu { pattern, ordering, work, gathered, .. } = self;
        let columns = &ordering.columns;
        let repeated = self
            .factors
            .as_mut()
            .is_some_and(|factors| dispatch(Repetition { pattern, columns, factors, values, work, gathered }));
        if !repeated {
            self.factors = None;
            self.factors = Some(self.search(values)?);
            self.prescribed = None;
        }
        Ok(())
    }

    fn kept_pivots(&self) -> Option<&[usize]> {
        self.factors.as_ref().map(|factors| &factors.step_of_row[..]).or(self.prescribed.as_deref())
    }

    fn keep_pivots(&mut self, pivots: &[usize]) {
        self.factors = None;
        self.prescribed = (pivots.len() == self.pattern.size).then(|| pivots.to_vec());
    }

    fn another(&self) -> Option<Box<dyn LinearSolver>> {
        Some(Box::new(LeftLookingLu::of(self.pattern.clone(), self.ordering.clone())))
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        let Some(factors) = &self.factors else { return };
        let work = &mut self.work;
        for (&value, &step) in rhs.iter().zip(&factors.step_of_row) {
            work[step] = value;
        }
        dispatch(Substitution { factors, transposed: false, x: work, gathered: &mut self.gathered });
        for (value, &place) in rhs.iter_mut().zip(&self.place_of_column) {
            *value = work[place];
        }
        work.fill(0.0);
    }

    fn solve_transposed(&mut self, rhs: &mut [f64]) {
        let Some(factors) = &self.factors else { return };
        let work = &mut self.work;
        for (&value, &place) in rhs.iter().zip(&self.place_of_column) {
            work[place] = value;
        }
        dispatch(Substitution { factors, transposed: true, x: work, gathered: &mut self.gathered });
        for (value, &step) in rhs.iter_mut().zip(&factors.step_of_row) {
            *value = work[step];
        }
        work.fill(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{DenseLu, minimum_degree};

    /// Numbers between -1 and 1 without a visible order.
    struct Noise(u64);
    impl Noise {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    /// A pattern with blocks along the diagonal, some entries far from it, and multipliers without a diagonal.
    fn pattern(noise: &mut Noise, nodes: usize, multipliers: usize) -> SparsePattern {
        let n = nodes + multipliers;
        let mut entries: Vec<(usize, usize)> = (0..nodes).map(|i| (i, i)).collect();
        for i in 0..nodes {
            entries.extend([(i, (i + 1) % nodes), ((i + 1) % nodes, i)]);
            if noise.next() > 0.4 {
                let far = ((noise.next() + 1.0) / 2.0 * nodes as f64) as usize % nodes;
                entries.extend([(i, far), (far, i)]);
            }
        }
        for m in nodes..n {
            for place in 0..4 {
                let node = (7 * (m - nodes) + 3 * place) % nodes;
                entries.extend([(m, node), (node, m)]);
            }
        }
        SparsePattern::from_entries(n, entries)
    }

    fn difference(a: &[f64], b: &[f64]) -> f64 {
        let scale = b.iter().fold(0.0, |s: f64, b| s.max(b.abs()));
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / scale
    }

    #[test]
    fn solutions_equal_those_of_dense_lu_first_and_repeated() {
        let mut noise = Noise(7);
        for case in 0..200 {
            let (nodes, multipliers) = (8 + case % 30, case % 7);
            let pattern = pattern(&mut noise, nodes, multipliers);
            let ordering = minimum_degree(&pattern, f64::INFINITY).expect("no limit");
            let (mut sparse, mut dense) = (LeftLookingLu::new(&pattern, ordering), DenseLu::new(&pattern));
            let mut values: Vec<f64> = pattern.rows.iter().map(|_| noise.next()).collect();
            for repetition in 0..4 {
                let near: Vec<f64> = values.iter().map(|v| v * (1.0 + 0.05 * noise.next())).collect();
                // the last time everything changes: the old pivots are no good any more
                values = if repetition == 3 { pattern.rows.iter().map(|_| noise.next()).collect() } else { near };
                dense.factor(&values).expect("regular");
                sparse.factor(&values).expect("regular");
                let b: Vec<f64> = (0..pattern.size).map(|_| noise.next()).collect();
                let (mut x, mut expected) = (b.clone(), b.clone());
                sparse.solve(&mut x);
                dense.solve(&mut expected);
                assert!(difference(&x, &expected) < 1e-9, "case {case}, {repetition}: {:e}", difference(&x, &expected));
                let (mut x, mut expected) = (b.clone(), b);
                sparse.solve_transposed(&mut x);
                dense.solve_transposed(&mut expected);
                assert!(difference(&x, &expected) < 1e-9, "case {case}, {repetition}: {:e}", difference(&x, &expected));
            }
        }
    }

    #[test]
    fn a_small_pivot_is_searched_anew() {
        let pattern = SparsePattern::from_entries(2, vec![(0, 0), (0, 1), (1, 0), (1, 1)]);
        let mut lu = LeftLookingLu::new(&pattern, Ordering { columns: vec![0, 1], multiplications: 2.0, fill: 4 });
        lu.factor(&[1.0, 0.5, 0.5, 1.0]).expect("regular");
        assert_eq!(lu.factors.as_ref().map(|f| f.step_of_row.clone()), Some(vec![0, 1]));
        lu.factor(&[1e-9, 1.0, 1.0, 1e-9]).expect("regular");
        assert_eq!(lu.factors.as_ref().map(|f| f.step_of_row.clone()), Some(vec![1, 0]));
        let mut x = [2.0, 3.0];
        lu.solve(&mut x);
        assert!((x[0] - 3.0).abs() < 1e-8 && (x[1] - 2.0).abs() < 1e-8, "{x:?}");
    }

    #[test]
    fn kept_pivots_give_the_same_bits() {
        let mut noise = Noise(11);
        let pattern = pattern(&mut noise, 20, 3);
        let ordering = minimum_degree(&pattern, f64::INFINITY).expect("no limit");
        let mut first = LeftLookingLu::new(&pattern, ordering.clone());
        let values: Vec<f64> = pattern.rows.iter().map(|_| noise.next()).collect();
        // pivots of these values, then others for which a search would choose differently
        first.factor(&values).expect("regular");
        let near: Vec<f64> = values.iter().map(|v| v * (1.0 + 0.2 * noise.next())).collect();
        first.factor(&near).expect("regular");
        let mut second = LeftLookingLu::new(&pattern, ordering);
        second.keep_pivots(first.kept_pivots().expect("factored"));
        second.factor(&near).expect("regular");
        assert_eq!(first.kept_pivots(), second.kept_pivots());
        let (mut a, mut b) = (vec![1.0; pattern.size], vec![1.0; pattern.size]);
        first.solve(&mut a);
        second.solve(&mut b);
        assert_eq!(a, b);
    }

    #[test]
    fn a_singular_matrix_names_its_unknown_and_leaves_the_solver_usable() {
        // unknowns 1 and 2 move together: only their sum is determined
        let entries = (0..3).flat_map(|i| (0..3).map(move |j| (i, j))).collect();
        let pattern = SparsePattern::from_entries(3, entries);
        let mut lu = LeftLookingLu::new(&pattern, minimum_degree(&pattern, f64::INFINITY).expect("no limit"));
        let error = lu.factor(&[1.0, 0.2, 0.1, 0.3, 1.0, 0.6, 0.3, 1.0, 0.6]).expect_err("singular");
        assert!(error.unknown == 1 || error.unknown == 2, "{error:?}");
        lu.factor(&[2.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 8.0]).expect("regular");
        let mut x = [2.0, 4.0, 8.0];
        lu.solve(&mut x);
        assert_eq!(x, [1.0, 1.0, 1.0]);
    }
}

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::flexible_gmres::{FlexibleGmres, Progress};
use super::system_matrix::{Products, SystemMatrix};
use crate::linalg::LinearSolver;
use crate::linalg::SparsePattern;
use crate::linalg::multifrontal::Side;
use std::sync::Arc;

/// What it took to solve with factors of another matrix, or to see that they do not serve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// Whether all solutions are as good as those of a fresh factorization; otherwise the right-hand sides are unchanged.
    pub solved: bool,
    /// Solutions with the factors, of all right-hand sides.
    pub applications: usize,
    /// Most of one right-hand side.
    pub longest: usize,
    /// Largest componentwise backward error.
    pub backward_error: f64,
}

/// Solutions with a matrix near the one that was factored last, by GMRES with its factors as the preconditioner; several
/// right-hand sides go through the factors together.
pub struct LaggedSolver {
    pattern: Arc<SparsePattern>,
    products: Products,
    columns: Vec<FlexibleGmres>,
    block: Vec<f64>,
}

impl LaggedSolver {
    /// For matrices of a pattern, with rows and columns of the size 1.
    pub fn new(pattern: Arc<SparsePattern>) -> Self {
        LaggedSolver { pattern, products: Products::default(), columns: Vec::new(), block: Vec::new() }
    }

    /// Replaces right-hand sides, one after the other, by solutions, if no one of them takes more applications of the factors than
    /// `most`.
    ///
    /// * `solver` has factored a matrix near that of the `values`
    pub fn solve(&mut self, solver: &mut dyn LinearSolver, values: &[f64], side: Side, rhs: &mut [f64], most: usize) -> Lag {
        let size = self.pattern.size;
        if size == 0 {
            return Lag { solved: true, applications: 0, longest: 0, backward_error: 0.0 };
        }
        let matrix = SystemMatrix { pattern: &self.pattern, values, side };
        let count = rhs.len() / size;
        self.products.reserve(size, count);
        self.block.reserve(rhs.len().saturating_sub(self.block.len()));
        self.columns.resize_with(count.max(self.columns.len()), FlexibleGmres::default);
        let columns = &mut self.columns[..count];
        columns.iter_mut().zip(rhs.chunks_exact(size)).for_each(|(column, rhs)| column.start(rhs, most));
        for application in 0.. {
            let refused = columns.iter().any(|column| column.progress() == Progress::Refused);
            let open = columns.iter().filter(|column| column.progress() == Progress::Open).count();
            if refused || open == 0 {
                break;
            }
            self.block.resize(open * size, 0.0);
            let all = with(columns, Progress::Open).zip(self.block.chunks_exact_mut(size));
            all.for_each(|(column, direction)| column.write_direction(direction));
            solver.solve_columns(side, size, &mut self.block);
            let applied = self.block.chunks_exact(size);
            if application == 0 {
                with(columns, Progress::Open).zip(applied).for_each(|(column, applied)| column.take_first(applied));
            } else {
                self.products.set::<false>(matrix, &self.block);
                let applied = applied.zip(self.products.products.chunks_exact(size));
                let all = with(columns, Progress::Open).zip(applied);
                all.for_each(|(column, (applied, product))| column.take(applied, product));
            }
            let unchecked = with(columns, Progress::Unchecked).count();
            self.block.resize(unchecked * size, 0.0);
            let all = with(columns, Progress::Unchecked).zip(self.block.chunks_exact_mut(size));
            all.for_each(|(column, x)| x.copy_from_slice(column.solution().0));
            self.products.set::<true>(matrix, &self.block);
            let Products { products, magnitudes, row_sizes, .. } = &self.products;
            let results = products.chunks_exact(size).zip(magnitudes.chunks_exact(size));
            let all = with(columns, Progress::Unchecked).zip(results);
            all.for_each(|(column, (product, magnitude))| column.check(product, magnitude, row_sizes));
        }
        let solved = columns.iter().all(|column| column.progress() == Progress::Reached);
        if solved {
            let solutions = columns.iter().map(|column| column.solution().0);
            rhs.chunks_exact_mut(size).zip(solutions).for_each(|(x, solution)| x.copy_from_slice(solution));
        }
        Lag {
            solved,
            applications: columns.iter().map(FlexibleGmres::applications).sum(),
            longest: columns.iter().map(FlexibleGmres::applications).max().unwrap_or(0),
            backward_error: columns.iter().map(|column| column.solution().1).fold(0.0, f64::max),
        }
    }
}

/// Those that are as far.
fn with(columns: &mut [FlexibleGmres], progress: Progress) -> impl Iterator<Item = &mut FlexibleGmres> {
    columns.iter_mut().filter(move |column| column.progress() == progress)
}

#[cfg(test)]
mod tests {
    use super::super::flexible_gmres::BACKWARD_ERROR;
    use super::*;
    use crate::linalg::multifrontal::MultifrontalLu;
    use crate::linalg::multifrontal::test_matrices::*;

    const SIDES: [Side; 2] = [Side::Plain, Side::Transposed];

    /// Componentwise backward error without exceptions, by the definition.
    fn backward_error(pattern: &SparsePattern, values: &[f64], side: Side, x: &[f64], b: &[f64]) -> f64 {
        let (own, values) = match side {
            Side::Plain => (pattern.clone(), values.to_vec()),
            Side::Transposed => transposed(pattern, values),
        };
        let (mut residual, mut magnitude) = (b.to_vec(), b.iter().map(|b| b.abs()).collect::<Vec<_>>());
        for column in 0..own.size {
            for place in own.column_starts[column]..own.column_starts[column + 1] {
                let product = values[place] * x[column];
                residual[own.rows[place]] -= product;
                magnitude[own.rows[place]] += product.abs();
            }
        }
        residual.iter().zip(&magnitude).map(|(r, m)| if *r == 0.0 { 0.0 } else { r.abs() / m }).fold(0.0, f64::max)
    }

    fn reference(pattern: &SparsePattern, values: &[f64], side: Side) -> Reference {
        match side {
            Side::Plain => Reference::new(pattern, values),
            Side::Transposed => {
                let (other, values) = transposed(pattern, values);
                Reference::new(&other, &values)
            }
        }
    }

    #[test]
    fn solutions_are_those_of_dense_lu_or_refused() {
        const CHANGES: [f64; 6] = [1e-12, 1e-8, 1e-4, 1e-2, 1e-1, 1.0];
        let mut noise = Noise(11);
        let (mut solved, mut tried, mut confirmed) = ([0; 6], [0; 6], [0; 2]);
        for case in 0..240 {
            let nodes = 2 + noise.below(40);
            let pattern = random_pattern(&mut noise, nodes, case % 5);
            let size = pattern.size;
            let values = noise.vector(pattern.rows.len());
            let change = CHANGES[case % 6];
            let changed: Vec<f64> = values.iter().map(|value| value * (1.0 + change * noise.next())).collect();
            let mut lu = MultifrontalLu::new(&pattern, &[], 1);
            let condition = 1.0 / Reference::new(&pattern, &changed).distance_from_singular();
            if condition > 1e6 || lu.factor(&values).is_err() {
                continue;
            }
            let mut lagged = LaggedSolver::new(Arc::new(pattern.clone()));
            for side in SIDES {
                let b = noise.vector(size * (1 + case % 11));
                let mut x = b.clone();
                let lag = lagged.solve(&mut lu, &changed, side, &mut x, 12);
                assert!(lag.longest <= 12, "case {case}: {lag:?}");
                tried[case % 6] += 1;
                if !lag.solved {
                    assert_eq!(x, b, "case {case}: {lag:?}");
                    continue;
                }
                solved[case % 6] += 1;
                assert!(lag.backward_error <= BACKWARD_ERROR, "case {case}: {lag:?}");
                let reference = reference(&pattern, &changed, side);
                for (x, b) in x.chunks_exact(size).zip(b.chunks_exact(size)) {
                    let error = difference(x, &reference.solve(b));
                    // both solutions are exact for matrices that differ by round-off
                    assert!(error < 1e-13 * condition, "case {case}, {side:?}: {error:e}, condition {condition:e}");
                    confirmed[0] += 1;
                    // rounding a residual of so many terms anew gives another one
                    confirmed[1] += usize::from(backward_error(&pattern, &changed, side, x, b) <= 2.0 * BACKWARD_ERROR);
                }
            }
        }
        println!("{solved:?} of {tried:?} solved, {confirmed:?}");
        assert!(tried.iter().all(|&tried| tried > 30), "{tried:?}");
        assert_eq!(solved[0], tried[0], "nothing but round-off changed");
        assert!(solved[5] * 4 < tried[5], "{} of {} other matrices solved", solved[5], tried[5]);
        assert!(solved[2] * 2 > tried[2], "{} of {} near matrices solved", solved[2], tried[2]);
        // an equation of small numbers beside large ones in the solution is measured against the solution
        assert!(confirmed[1] * 100 > confirmed[0] * 95, "{confirmed:?}");
    }

    #[test]
    fn a_change_of_few_columns_takes_few_iterations_however_large() {
        let mut noise = Noise(12);
        for case in 0..20 {
            let pattern = random_pattern(&mut noise, 60, 0);
            let values = dominant(&mut noise, &pattern);
            let mut changed = values.clone();
            let count = 1 + case % 2;
            for column in [5, pattern.size / 2].into_iter().take(count) {
                changed[pattern.column_starts[column]..pattern.column_starts[column + 1]].iter_mut().for_each(|v| *v *= 5.0);
            }
            let mut lu = MultifrontalLu::new(&pattern, &[], 1);
            lu.factor(&values).expect("regular");
            for side in SIDES {
                let mut x = noise.vector(pattern.size);
                let lag = LaggedSolver::new(Arc::new(pattern.clone())).solve(&mut lu, &changed, side, &mut x, 12);
                // the first solution, one iteration for each column and one for the rest; two corrections of round-off
                assert!(lag.solved && lag.longest <= 4 + count, "case {case}: {lag:?}");
            }
        }
    }

    #[test]
    fn local_right_hand_sides_get_small_backward_errors_far_away_too() {
        let mut noise = Noise(13);
        // a chain, whose solution falls by powers of ten from unknown to unknown
        let size = 200;
        let near = |i: usize| i.saturating_sub(1)..(i + 2).min(size);
        let pattern = SparsePattern::from_entries(size, (0..size).flat_map(|i| near(i).map(move |j| (i, j))).collect());
        let mut values = dominant(&mut noise, &pattern);
        values.iter_mut().for_each(|value| *value *= if value.abs() < 1.0 { 0.5 } else { 1.0 });
        let changed: Vec<f64> = values.iter().map(|value| value * (1.0 + 1e-3 * noise.next())).collect();
        let mut lu = MultifrontalLu::new(&pattern, &[], 1);
        lu.factor(&values).expect("regular");
        for side in SIDES {
            let mut b = vec![0.0; size];
            b[3] = 1.0;
            let mut x = b.clone();
            let lag = LaggedSolver::new(Arc::new(pattern.clone())).solve(&mut lu, &changed, side, &mut x, 12);
            assert!(lag.solved, "{lag:?}");
            // unknowns as small as round-off of the largest are good to all digits
            let small = x.iter().position(|x| x.abs() < 1e-10).expect("falls");
            let (first, others) = (x[..small].to_vec(), vec![0.0; size - small]);
            let cut = backward_error(&pattern, &changed, side, &[first, others].concat(), &b);
            assert!(cut > 1e-3, "{cut:e}: the measure sees small unknowns");
            let exact = reference(&pattern, &changed, side).solve(&b);
            let error = (exact[small] - x[small]).abs() / exact[small].abs();
            assert!(error < 1e-13, "unknown {small} of {:e}: {error:e}", x[small]);
        }
    }

    #[test]
    fn what_can_not_be_solved_is_left_as_it_was() {
        let mut noise = Noise(14);
        let pattern = random_pattern(&mut noise, 20, 0);
        let values = dominant(&mut noise, &pattern);
        let mut lu = MultifrontalLu::new(&pattern, &[], 1);
        lu.factor(&values).expect("regular");
        let mut lagged = LaggedSolver::new(Arc::new(pattern.clone()));
        let b = noise.vector(3 * pattern.size);
        let mut x = b.clone();
        assert!(!lagged.solve(&mut lu, &values, Side::Plain, &mut x, 0).solved);
        let mut bad = values.clone();
        for number in [f64::NAN, f64::INFINITY] {
            bad[7] = number;
            let lag = lagged.solve(&mut lu, &bad, Side::Transposed, &mut x, 12);
            assert!(!lag.solved && lag.longest <= 2, "{lag:?}");
        }
        // one that is followed by rows without a fault
        let diagonal = SparsePattern::from_entries(3, (0..3).map(|i| (i, i)).collect());
        let mut simple = MultifrontalLu::new(&diagonal, &[], 1);
        simple.factor(&[1.0; 3]).expect("regular");
        for number in [f64::NAN, f64::INFINITY] {
            let lag = LaggedSolver::new(Arc::new(diagonal.clone())).solve(
                &mut simple,
                &[number, 1.0, 1.0],
                Side::Transposed,
                &mut [1.0; 3],
                12,
            );
            assert!(!lag.solved, "{lag:?}");
        }
        let zeros = vec![0.0; values.len()];
        let lag = lagged.solve(&mut lu, &zeros, Side::Plain, &mut x, 12);
        assert!(!lag.solved, "{lag:?}");
        assert_eq!(x, b);
        // one right-hand side that fails leaves all as they were; none of them and zeros are solved at once
        assert!(lagged.solve(&mut lu, &values, Side::Plain, &mut [], 12).solved);
        let mut x = vec![0.0; 2 * pattern.size];
        let lag = lagged.solve(&mut lu, &values, Side::Plain, &mut x, 12);
        assert_eq!((lag.solved, lag.applications, lag.backward_error), (true, 0, 0.0));
        assert_eq!(x, vec![0.0; 2 * pattern.size]);
        let empty = SparsePattern::from_entries(0, vec![]);
        assert!(LaggedSolver::new(Arc::new(empty.clone())).solve(&mut lu, &[], Side::Plain, &mut [], 12).solved);
    }

    #[test]
    fn right_hand_sides_together_are_solved_as_well_as_alone() {
        let mut noise = Noise(15);
        let pattern = random_pattern(&mut noise, 50, 3);
        let values = dominant(&mut noise, &pattern);
        let changed: Vec<f64> = values.iter().map(|value| value * (1.0 + 1e-2 * noise.next())).collect();
        let mut lu = MultifrontalLu::new(&pattern, &[], 1);
        lu.factor(&values).expect("regular");
        let mut lagged = LaggedSolver::new(Arc::new(pattern.clone()));
        for count in 1..=19 {
            let mut together = noise.vector(count * pattern.size);
            // some that are solved earlier than others
            together[..pattern.size].fill(0.0);
            let mut alone = together.clone();
            let lag = lagged.solve(&mut lu, &changed, Side::Transposed, &mut together, 20);
            let mut longest = 0;
            for column in alone.chunks_exact_mut(pattern.size) {
                longest = longest.max(lagged.solve(&mut lu, &changed, Side::Transposed, column, 20).longest);
            }
            assert!(lag.solved && lag.longest.abs_diff(longest) <= 1, "{count}: {lag:?}, alone {longest}");
            // the factors are applied in another order of sums
            assert!(difference(&together, &alone) < 1e-13, "{count}");
        }
    }
}

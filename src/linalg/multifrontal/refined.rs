use super::substitution::Side;
use crate::linalg::SparsePattern;
use crate::linalg::{LinearSolver, Singular};

/// Backward error at which a solution is as good as the numbers that it is made of.
pub const BACKWARD_ERROR: f64 = 1e-15;
/// Most corrections of a solution.
const LARGEST_CORRECTIONS: usize = 10;
/// A correction has to divide the backward error at least by this.
const SLOWEST: f64 = 2.0;
/// Sweeps over rows and columns that bring their largest entries to 1.
const SWEEPS: usize = 5;

/// Why no further correction was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The backward error is at most [`BACKWARD_ERROR`].
    Reached,
    /// The last correction did not halve the backward error.
    Stagnated,
    /// Too many corrections.
    Limit,
    /// The solution is not finite.
    NotFinite,
}

/// How good a solution is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refinement {
    /// Componentwise backward error: the largest relative change of an entry of A or b that makes the solution exact.
    pub backward_error: f64,
    /// Corrections of the solution.
    pub corrections: usize,
    /// Why there were not more.
    pub stop: Stop,
}

/// A solver with rows and columns scaled to the size 1 by powers of two, whose solutions are corrected until each of their equations
/// holds as well as its numbers allow:
///
/// ```text
/// omega = max_i |b - A x|_i / (|A| |x| + |b|)_i
/// ```
///
/// Source: Arioli, Demmel & Duff (1989), eqs. (2.4) and (2.6) for omega; Ruiz (2001) for the scaling.
pub struct Refined<S> {
    pattern: SparsePattern,
    solver: S,
    scaled: Vec<f64>,
    row_scale: Vec<f64>,
    column_scale: Vec<f64>,
    row_sizes: Vec<f64>,
    column_sizes: Vec<f64>,
    rhs: Vec<f64>,
    correction: Vec<f64>,
    magnitude: Vec<f64>,
}

impl<S: LinearSolver> Refined<S> {
    /// Around a solver of matrices of a pattern.
    pub fn new(pattern: &SparsePattern, solver: S) -> Self {
        let ones = || vec![1.0; pattern.size];
        Refined {
            pattern: pattern.clone(),
            solver,
            scaled: vec![0.0; pattern.rows.len()],
            row_scale: ones(),
            column_scale: ones(),
            row_sizes: ones(),
            column_sizes: ones(),
            rhs: ones(),
            correction: ones(),
            magnitude: ones(),
        }
    }

    /// The solver inside.
    pub fn solver(&self) -> &S {
        &self.solver
    }

    /// Scales and factors values given in the order of the pattern.
    ///
    /// # Errors
    /// [`Singular`] if a value is not finite, or from the solver.
    pub fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        if let Some(place) = values.iter().position(|value| !value.is_finite()) {
            return Err(Singular { unknown: self.pattern.column_starts.partition_point(|&start| start <= place) - 1 });
        }
        self.set_scales(values);
        for column in 0..self.pattern.size {
            let (own, scale) = (self.entries(column), self.column_scale[column]);
            let scaled = self.scaled[own.clone()].iter_mut().zip(&values[own.clone()]);
            for ((scaled, value), &row) in scaled.zip(&self.pattern.rows[own]) {
                *scaled = value * self.row_scale[row] * scale;
            }
        }
        self.measure(None);
        self.solver.factor(&self.scaled)
    }

    /// Replaces b by A^-1 b.
    pub fn solve(&mut self, rhs: &mut [f64]) -> Refinement {
        self.refine(Side::Plain, rhs)
    }

    /// Replaces b by A^-T b.
    pub fn solve_transposed(&mut self, rhs: &mut [f64]) -> Refinement {
        self.refine(Side::Transposed, rhs)
    }

    fn refine(&mut self, side: Side, x: &mut [f64]) -> Refinement {
        let (of_rhs, of_solution) = match side {
            Side::Plain => (&self.row_scale, &self.column_scale),
            Side::Transposed => (&self.column_scale, &self.row_scale),
        };
        self.rhs.iter_mut().zip(&*x).zip(of_rhs).for_each(|((own, b), scale)| *own = b * scale);
        x.copy_from_slice(&self.rhs);
        let of_solution = of_solution.clone();
        self.apply(side, x);
        let mut refinement = Refinement { backward_error: f64::INFINITY, corrections: 0, stop: Stop::Limit };
        loop {
            let error = self.backward_error(side, x);
            if !error.is_finite() {
                refinement.stop = Stop::NotFinite;
                refinement.backward_error = refinement.backward_error.min(f64::INFINITY);
                break;
            }
            let before = std::mem::replace(&mut refinement.backward_error, error);
            refinement.stop = if error <= BACKWARD_ERROR {
                Stop::Reached
            } else if error > before / SLOWEST {
                Stop::Stagnated
            } else if refinement.corrections == LARGEST_CORRECTIONS {
                Stop::Limit
            } else {
                let mut correction = std::mem::take(&mut self.correction);
                self.apply(side, &mut correction);
                x.iter_mut().zip(&correction).for_each(|(x, correction)| *x += correction);
                self.correction = correction;
                refinement.corrections += 1;
                continue;
            };
            break;
        }
        x.iter_mut().zip(&of_solution).for_each(|(x, scale)| *x *= scale);
        refinement
    }

    fn apply(&mut self, side: Side, x: &mut [f64]) {
        match side {
            Side::Plain => self.solver.solve(x),
            Side::Transposed => self.solver.solve_transposed(x),
        }
    }

    /// omega of a scaled solution, whose residual is left in `correction`.
    fn backward_error(&mut self, side: Side, x: &[f64]) -> f64 {
        self.correction.copy_from_slice(&self.rhs);
        self.magnitude.fill(0.0);
        for column in 0..self.pattern.size {
            let own = self.entries(column);
            let entries = self.scaled[own.clone()].iter().zip(&self.pattern.rows[own]);
            match side {
                Side::Plain => {
                    for (value, &row) in entries {
                        let product = value * x[column];
                        self.correction[row] -= product;
                        self.magnitude[row] += product.abs();
                    }
                }
                Side::Transposed => {
                    let (mut sum, mut magnitude) = (0.0, 0.0);
                    for (value, &row) in entries {
                        let product = value * x[row];
                        sum += product;
                        magnitude += product.abs();
                    }
                    self.correction[column] -= sum;
                    self.magnitude[column] = magnitude;
                }
            }
        }
        let sizes = if side == Side::Plain { &self.row_sizes } else { &self.column_sizes };
        let largest = x.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        // where an equation holds but for quantities much smaller than the solution, it is measured against the solution
        let small = 1000.0 * self.pattern.size as f64 * f64::EPSILON;
        let mut omega = [0.0; 2];
        for (row, residual) in self.correction.iter().enumerate() {
            let (magnitude, b, of_solution) = (self.magnitude[row], self.rhs[row].abs(), sizes[row] * largest);
            let ordinary = magnitude + b > small * (of_solution + b);
            let against = if ordinary { magnitude + b } else { magnitude + of_solution };
            let error = if *residual == 0.0 { 0.0 } else { residual.abs() / against };
            let most = &mut omega[usize::from(ordinary)];
            if !(error <= *most) {
                *most = error;
            }
        }
        omega[0] + omega[1]
    }

    fn entries(&self, column: usize) -> std::ops::Range<usize> {
        self.pattern.column_starts[column]..self.pattern.column_starts[column + 1]
    }

    /// Largest entries of the scaled rows and columns; those of given values with the scales of now.
    fn measure(&mut self, values: Option<&[f64]>) {
        self.row_sizes.fill(0.0);
        for column in 0..self.pattern.size {
            let mut most = 0.0;
            for place in self.entries(column) {
                let row = self.pattern.rows[place];
                let value = match values {
                    Some(values) => (values[place] * self.row_scale[row] * self.column_scale[column]).abs(),
                    None => self.scaled[place].abs(),
                };
                self.row_sizes[row] = value.max(self.row_sizes[row]);
                most = value.max(most);
            }
            self.column_sizes[column] = most;
        }
    }

    fn set_scales(&mut self, values: &[f64]) {
        self.row_scale.fill(1.0);
        self.column_scale.fill(1.0);
        for _ in 0..SWEEPS {
            self.measure(Some(values));
            let scales = [(&mut self.row_scale, &self.row_sizes), (&mut self.column_scale, &self.column_sizes)];
            for (scales, sizes) in scales {
                scales
                    .iter_mut()
                    .zip(sizes)
                    .filter(|(_, size)| **size > 0.0)
                    .for_each(|(scale, size)| *scale /= size.sqrt());
            }
        }
        for scales in [&mut self.row_scale, &mut self.column_scale] {
            scales.iter_mut().for_each(|scale| *scale = power_of_two(*scale));
        }
    }
}

/// The power of two at or below a positive normal number.
fn power_of_two(size: f64) -> f64 {
    f64::from_bits(size.to_bits() & (0x7ff << 52))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::multifrontal::MultifrontalLu;
    use crate::linalg::multifrontal::test_matrices::*;

    #[test]
    fn refinement_reaches_the_smallest_backward_error_or_says_why_not() {
        let mut noise = Noise(7);
        let (mut reached, mut confirmed) = (0, 0);
        for case in 0..200 {
            let nodes = 2 + noise.below(40);
            let pattern = random_pattern(&mut noise, nodes, case % 4);
            let mut values = noise.vector(pattern.rows.len());
            // rows and columns of sizes from 1e-12 to 1e12
            let scales: Vec<f64> = (0..pattern.size).map(|_| 10f64.powf(12.0 * noise.next())).collect();
            for column in 0..pattern.size {
                for place in pattern.column_starts[column]..pattern.column_starts[column + 1] {
                    values[place] *= scales[pattern.rows[place]] * if case % 2 == 0 { 1.0 } else { scales[column].sqrt() };
                }
            }
            let mut lu = Refined::new(&pattern, MultifrontalLu::new(&pattern, &[], 1));
            if lu.factor(&values).is_err() {
                continue;
            }
            for side in [Side::Plain, Side::Transposed] {
                let b = noise.vector(pattern.size);
                let mut x = b.clone();
                let refinement = if side == Side::Plain { lu.solve(&mut x) } else { lu.solve_transposed(&mut x) };
                let (own, own_values) =
                    if side == Side::Plain { (pattern.clone(), values.clone()) } else { transposed(&pattern, &values) };
                // the same measure in the unscaled system, where no equation is an exception
                let (mut residual, mut magnitude) = (b.clone(), b.iter().map(|b| b.abs()).collect::<Vec<_>>());
                for column in 0..own.size {
                    for place in own.column_starts[column]..own.column_starts[column + 1] {
                        let product = own_values[place] * x[column];
                        residual[own.rows[place]] -= product;
                        magnitude[own.rows[place]] += product.abs();
                    }
                }
                let omega = residual.iter().zip(&magnitude).map(|(r, m)| r.abs() / m).fold(0.0, f64::max);
                match refinement.stop {
                    Stop::Reached => {
                        reached += 1;
                        assert!(refinement.backward_error <= BACKWARD_ERROR);
                        confirmed += usize::from(omega <= 2.0 * BACKWARD_ERROR);
                    }
                    Stop::Stagnated | Stop::Limit => assert!(refinement.backward_error > BACKWARD_ERROR),
                    Stop::NotFinite => panic!("case {case}: {refinement:?}"),
                }
            }
        }
        assert!(reached > 300, "{reached} of 400 solutions");
        // the others have an equation of small numbers beside large ones in the solution, which is measured against the solution
        assert!(confirmed * 10 > reached * 8, "{confirmed} of {reached} confirmed");
    }

    /// Multiplies by wrong numbers.
    struct Poor(f64);
    impl LinearSolver for Poor {
        fn factor(&mut self, _values: &[f64]) -> Result<(), Singular> {
            Ok(())
        }
        fn solve(&mut self, rhs: &mut [f64]) {
            rhs.iter_mut().for_each(|value| *value *= self.0);
        }
        fn solve_transposed(&mut self, rhs: &mut [f64]) {
            self.solve(rhs);
        }
    }

    #[test]
    fn refinement_with_a_poor_solver_says_why_it_stops() {
        let pattern = SparsePattern::from_entries(2, vec![(0, 0), (1, 1)]);
        let stop = |factor: f64| {
            let mut lu = Refined::new(&pattern, Poor(factor));
            lu.factor(&[1.0, 1.0]).expect("regular");
            lu.solve(&mut [1.0, 3.0])
        };
        assert_eq!((stop(1.0).stop, stop(1.0).corrections), (Stop::Reached, 0));
        assert_eq!(stop(0.99).stop, Stop::Reached);
        // the error shrinks by 0.4 in each of ten corrections
        assert_eq!(stop(0.6).stop, Stop::Limit);
        assert!((stop(0.6).backward_error / 0.4f64.powi(11) - 0.5).abs() < 0.1, "{:?}", stop(0.6));
        assert_eq!(stop(-1.0).stop, Stop::Stagnated);
        assert_eq!(stop(f64::NAN).stop, Stop::NotFinite);
    }
}

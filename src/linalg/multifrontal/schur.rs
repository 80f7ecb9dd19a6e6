use super::factors::Factors;
use super::graph::Role;
use super::multifrontal_lu::roles;
use super::substitution::{Side, Substitution};
use super::symbolic::{Analysis, Symbolic};
use super::traversal::Traversal;
use crate::linalg::Singular;
use crate::linalg::SparsePattern;
use faer::linalg::solvers::{PartialPivLu, Solve};
use faer::{ColMut, Mat, MatRef};

/// Elimination of all unknowns but some chosen ones, c:
///
/// ```text
/// [A_ii A_ic; A_ci A_cc] [x_i; x_c] = [b_i; b_c],   S x_c = b_c - A_ci A_ii^-1 b_i,   S = A_cc - A_ci A_ii^-1 A_ic.
/// ```
///
/// Source: Duff & Reid (1983); Smith, Bjorstad & Gropp (1996), Domain Decomposition, section 4.1.
pub struct SchurComplement {
    symbolic: Symbolic,
    traversal: Traversal,
    factors: Factors,
    substitution: Substitution,
    chosen: Vec<usize>,
    /// Place of each chosen unknown in the order of elimination.
    places: Vec<usize>,
    complement: Mat<f64>,
    factored: Option<PartialPivLu<f64>>,
}

/// Pivots of the complement smaller than this share of its largest entry are taken for zero.
const TINY_PIVOT: f64 = 1e-14;

impl SchurComplement {
    /// Analyses a pattern; see [`super::MultifrontalLu::new`].
    ///
    /// * `chosen` the unknowns that are kept, each once, in the order of the complement's rows and columns
    pub fn new(pattern: &SparsePattern, multipliers: &[usize], chosen: &[usize], threads: usize) -> Self {
        let mut roles = roles(pattern, multipliers);
        for &unknown in chosen {
            assert_ne!(roles[unknown], Role::Kept, "unknown {unknown} is chosen twice");
            roles[unknown] = Role::Kept;
        }
        let symbolic = Symbolic::new(pattern, &roles);
        let traversal = Traversal::new(&symbolic, threads);
        let factors = Factors::new(&symbolic);
        let mut place_of = vec![0; symbolic.size];
        symbolic.order.iter().enumerate().for_each(|(place, &unknown)| place_of[unknown as usize] = place);
        SchurComplement {
            symbolic,
            traversal,
            factors,
            substitution: Substitution::default(),
            chosen: chosen.to_vec(),
            places: chosen.iter().map(|&unknown| place_of[unknown]).collect(),
            complement: Mat::zeros(chosen.len(), chosen.len()),
            factored: None,
        }
    }

    /// What the elimination takes without delayed pivots.
    pub fn analysis(&self) -> Analysis {
        self.symbolic.analysis(self.traversal.bytes())
    }

    /// Eliminates the other unknowns from a matrix whose values are given in the order of the pattern.
    ///
    /// # Errors
    /// [`Singular`] if A_ii is singular.
    pub fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        assert_eq!(values.len(), self.symbolic.pattern_entries, "values and entries of the pattern");
        self.factored = None;
        self.traversal.factor(&self.symbolic, values, &mut self.factors)?;
        let order = self.chosen.len();
        let values = self.traversal.last_contribution(&self.symbolic);
        let first = self.symbolic.size - order;
        for (column, &column_place) in self.places.iter().enumerate() {
            for (row, &row_place) in self.places.iter().enumerate() {
                self.complement[(row, column)] = values[row_place - first + (column_place - first) * order];
            }
        }
        Ok(())
    }

    /// S of the last elimination.
    pub fn complement(&self) -> MatRef<'_, f64> {
        self.complement.as_ref()
    }

    /// The right-hand side of the chosen unknowns: b_c - A_ci A_ii^-1 b_i, and with the transposed matrices for `Side::Transposed`.
    pub fn condense(&mut self, side: Side, rhs: &[f64], condensed: &mut [f64]) {
        let all = 0..self.symbolic.fronts.len();
        self.substitution.load(&self.symbolic, rhs);
        self.substitution.forward(&self.symbolic, &self.factors, side, all);
        let residual = self.substitution.residual();
        condensed.iter_mut().zip(&self.places).for_each(|(own, &place)| *own = residual[place]);
    }

    /// All unknowns from the chosen ones, for the right-hand side condensed last.
    pub fn expand(&mut self, side: Side, chosen: &[f64], solution: &mut [f64]) {
        let all = 0..self.symbolic.fronts.len();
        let places = self.places.iter();
        let inner = self.substitution.solution();
        places.zip(chosen).for_each(|(&place, value)| inner[place] = *value);
        self.substitution.backward(&self.symbolic, &self.factors, side, all);
        self.substitution.store(&self.symbolic, solution);
    }

    /// Replaces b by A^-1 b (or A^-T b), the complement factored where it is not yet.
    ///
    /// # Errors
    /// [`Singular`] if S is singular.
    pub fn solve(&mut self, side: Side, rhs: &mut [f64]) -> Result<(), Singular> {
        let lu = match self.factored.take() {
            Some(lu) => lu,
            None => self.factor_complement()?,
        };
        let mut condensed = vec![0.0; self.chosen.len()];
        self.condense(side, rhs, &mut condensed);
        let column = ColMut::from_slice_mut(&mut condensed).as_mat_mut();
        match side {
            Side::Plain => lu.solve_in_place(column),
            Side::Transposed => lu.solve_transpose_in_place(column),
        }
        self.expand(side, &condensed, rhs);
        self.factored = Some(lu);
        Ok(())
    }

    fn factor_complement(&self) -> Result<PartialPivLu<f64>, Singular> {
        let lu = PartialPivLu::new(self.complement.as_ref());
        let size = self.complement.norm_max();
        let usable = |&pivot: &usize| {
            let value = lu.U()[(pivot, pivot)];
            value.is_finite() && value.abs() > TINY_PIVOT * size
        };
        match (0..self.chosen.len()).find(|pivot| !usable(pivot)) {
            Some(pivot) => Err(Singular { unknown: self.chosen[pivot] }),
            None => Ok(lu),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::multifrontal::test_matrices::*;

    #[test]
    fn the_schur_complement_equals_the_dense_one() {
        let mut noise = Noise(8);
        let mut compared = 0;
        for case in 0..100 {
            let nodes = 2 + noise.below(25);
            let pattern = random_pattern(&mut noise, nodes, case % 3);
            let mut values = noise.vector(pattern.rows.len());
            if case % 3 == 1 {
                for unknown in 0..pattern.size {
                    if let Some(place) = pattern.position(unknown, unknown) {
                        values[place] *= 1e-7;
                    }
                }
            }
            let mut chosen: Vec<usize> = (0..pattern.size).filter(|_| noise.next() > 0.6).collect();
            chosen.reverse();
            let interior: Vec<usize> = (0..pattern.size).filter(|unknown| !chosen.contains(unknown)).collect();
            let value = |row: usize, column: usize| pattern.position(row, column).map_or(0.0, |place| values[place]);
            let mut entries = Vec::new();
            let mut inner_values = Vec::new();
            for (j, &column) in interior.iter().enumerate() {
                for (i, &row) in interior.iter().enumerate() {
                    entries.push((j, i));
                    inner_values.push(value(row, column));
                }
            }
            let inner = SparsePattern::from_entries(interior.len(), entries);
            let reference = Reference::new(&inner, &inner_values);
            let mut schur = SchurComplement::new(&pattern, &[], &chosen, 1 + case % 2);
            // the tolerance below is for entries of the size 1
            if reference.distance_from_singular() < 1e-2 / pattern.size as f64 {
                continue;
            }
            compared += 1;
            schur.factor(&values).unwrap_or_else(|error| panic!("case {case}: {error:?}"));
            let complement = schur.complement();
            let mut largest: f64 = 1.0;
            let mut error: f64 = 0.0;
            for (j, &column) in chosen.iter().enumerate() {
                let beside: Vec<f64> = interior.iter().map(|&row| value(row, column)).collect();
                let solution = reference.solve(&beside);
                for (i, &row) in chosen.iter().enumerate() {
                    let product: f64 = interior.iter().zip(&solution).map(|(&k, x)| value(row, k) * x).sum();
                    let expected = value(row, column) - product;
                    largest = largest.max(expected.abs());
                    error = error.max((complement[(i, j)] - expected).abs());
                }
            }
            assert!(error < 1e-12 * largest / reference.distance_from_singular(), "case {case}: {error:e} of {largest:e}");
            assert!(error < 1e-10 * largest, "case {case}: {error:e} of {largest:e}");

            let whole = Reference::new(&pattern, &values);
            if whole.distance_from_singular() < 1e-6 {
                continue;
            }
            let tolerance = 1e-10 / whole.distance_from_singular();
            let b = noise.vector(pattern.size);
            let mut x = b.clone();
            schur.solve(Side::Plain, &mut x).expect("regular");
            assert!(difference(&x, &whole.solve(&b)) < tolerance, "case {case}");
            let (other, other_values) = transposed(&pattern, &values);
            let mut x = b.clone();
            schur.solve(Side::Transposed, &mut x).expect("regular");
            assert!(difference(&x, &Reference::new(&other, &other_values).solve(&b)) < tolerance, "case {case}");
        }
        assert!(compared > 30, "{compared} of 100 compared");
    }

    #[test]
    fn the_schur_complement_of_a_shell_equals_the_dense_one_to_round_off() {
        let mut noise = Noise(9);
        let pattern = shell(9, 6);
        let values = dominant(&mut noise, &pattern);
        // the last row of nodes
        let chosen: Vec<usize> = (6 * 72..6 * 81).collect();
        let mut schur = SchurComplement::new(&pattern, &[], &chosen, 1);
        schur.factor(&values).expect("regular");
        let whole = Reference::new(&pattern, &values);
        // S^-1 is the block of A^-1
        for j in [0, 17, 53] {
            let mut b = vec![0.0; pattern.size];
            b[chosen[j]] = 1.0;
            let x = whole.solve(&b);
            for i in 0..chosen.len() {
                let product: f64 = (0..chosen.len()).map(|k| schur.complement()[(i, k)] * x[chosen[k]]).sum();
                assert!((product - if i == j { 1.0 } else { 0.0 }).abs() < 1e-12, "{i} {j}: {product}");
            }
        }
    }
}

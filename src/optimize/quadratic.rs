//! Convex quadratic programs of moderate size, by the dual active-set method.

use super::ConstraintKind;
use crate::tolerances::LONG_SUM;
use nalgebra::linalg::{Cholesky, givens::GivensRotation};
use nalgebra::{DMatrix, DVector};

/// min 1/2 d^T H d + g^T d with N^T d + c = 0 or <= 0 and `lower` <= d <= `upper`.
#[derive(Clone)]
pub(super) struct QuadraticProgram {
    /// H, symmetric and positive definite.
    pub hessian: DMatrix<f64>,
    /// g.
    pub gradient: DVector<f64>,
    /// N, a column for each linearized constraint: its gradient.
    pub normals: DMatrix<f64>,
    /// c, their values at d = 0.
    pub offsets: Vec<f64>,
    /// Which of them are equalities.
    pub kinds: Vec<ConstraintKind>,
    /// Least d.
    pub lower: Vec<f64>,
    /// Largest d.
    pub upper: Vec<f64>,
}

/// The minimizer, the multipliers of the constraints, with g + H d + N times multipliers = 0 but for bounds, and the largest violation that is left.
#[derive(Debug)]
pub(super) struct Step {
    pub step: DVector<f64>,
    pub multipliers: Vec<f64>,
    pub left: f64,
}

/// Why there is no minimizer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoStep {
    /// No d satisfies all constraints.
    Infeasible,
    /// H is not positive definite, or round-off keeps the method from its end.
    IllConditioned,
}

/// One condition sign n . d >= b of the program.
#[derive(Clone, Copy)]
struct Condition {
    place: Place,
    sign: f64,
}

#[derive(Clone, Copy)]
enum Place {
    /// Of this number.
    Constraint(usize),
    /// The lower bound of a variable if the sign is positive, else the upper one.
    Bound(usize),
}

/// Columns L^-T Q for H = L L^T, of which the first belong to the active conditions, and R of the QR factorization of these in its upper
/// left triangle.
struct Factors {
    inverse: DMatrix<f64>,
    r: DMatrix<f64>,
    active: usize,
}

impl Factors {
    /// `None` unless H is positive definite.
    fn new(hessian: &DMatrix<f64>) -> Option<Self> {
        let n = hessian.nrows();
        let lower = Cholesky::new(hessian.clone())?.unpack();
        let definite = (0..n).all(|i| lower[(i, i)].powi(2) > LONG_SUM * hessian[(i, i)]);
        let inverse = lower.tr_solve_lower_triangular(&DMatrix::identity(n, n)).filter(|_| definite)?;
        Some(Factors { inverse, r: DMatrix::zeros(n, n), active: 0 })
    }

    /// Makes a condition active, of which `turned` is its normal in the columns.
    fn add(&mut self, mut turned: DVector<f64>) {
        for k in (self.active + 1..turned.len()).rev() {
            let mut pair = turned.fixed_rows_mut::<2>(k - 1);
            if let Some((rotation, length)) = GivensRotation::cancel_y(&pair) {
                rotation.inverse().rotate_rows(&mut self.inverse.fixed_columns_mut::<2>(k - 1));
                (pair[0], pair[1]) = (length, 0.0);
            }
        }
        self.r.set_column(self.active, &turned);
        self.active += 1;
    }

    /// Makes the active condition at `place` inactive.
    fn remove(&mut self, place: usize) {
        self.active -= 1;
        for k in place..self.active {
            self.r.swap_columns(k, k + 1);
            if let Some((rotation, _)) = GivensRotation::cancel_y(&self.r.fixed_view::<2, 1>(k, k)) {
                rotation.inverse().rotate_rows(&mut self.inverse.fixed_columns_mut::<2>(k));
                rotation.rotate(&mut self.r.fixed_rows_mut::<2>(k));
            }
        }
    }

    /// R^-1 of the leading part.
    fn solve(&self, right: &DVector<f64>) -> Option<DVector<f64>> {
        let leading = (self.active, self.active);
        self.r.view((0, 0), leading).solve_upper_triangular(&right.rows(0, self.active))
    }
}

impl QuadraticProgram {
    /// The shortest step from `x` to a point within its bounds that keeps constraints of these values and gradients there.
    ///
    /// # Errors
    /// See [`NoStep`].
    pub fn shortest(
        x: &[f64],
        bounds: &[(f64, f64)],
        kinds: &[ConstraintKind],
        (offsets, rows): (Vec<f64>, &[Vec<f64>]),
    ) -> Result<DVector<f64>, NoStep> {
        let n = x.len();
        let (lower, upper) = bounds.iter().zip(x).map(|((lower, upper), x)| (lower - x, upper - x)).unzip();
        let (hessian, gradient, normals) = (DMatrix::identity(n, n), DVector::zeros(n), columns(n, rows));
        Ok(QuadraticProgram { hessian, gradient, normals, offsets, kinds: kinds.to_vec(), lower, upper }.solve()?.step)
    }

    fn is_equality(&self, condition: Condition) -> bool {
        matches!(condition.place, Place::Constraint(k) if self.kinds[k] == ConstraintKind::Equality)
    }

    fn bound(&self, i: usize, sign: f64) -> f64 {
        if sign > 0.0 { self.lower[i] } else { self.upper[i] }
    }

    /// sign n . d - b, and the size of its terms.
    fn excess(&self, Condition { place, sign }: Condition, d: &DVector<f64>) -> (f64, f64) {
        match place {
            Place::Constraint(k) => {
                let (normal, offset) = (self.normals.column(k), self.offsets[k]);
                (sign * (normal.dot(d) + offset), normal.abs().dot(&d.abs()) + offset.abs())
            }
            Place::Bound(i) => {
                let bound = self.bound(i, sign);
                (sign * (d[i] - bound), d[i].abs() + bound.abs())
            }
        }
    }

    /// The normal n in the columns of the factors.
    fn turned(&self, Condition { place, sign }: Condition, factors: &Factors) -> DVector<f64> {
        sign * match place {
            Place::Constraint(k) => factors.inverse.tr_mul(&self.normals.column(k)),
            Place::Bound(i) => factors.inverse.row(i).transpose(),
        }
    }

    /// The minimizer.
    ///
    /// Starts at the minimum without conditions and adds the most violated one until none is, dropping those whose multipliers
    /// change sign: each intermediate point is the minimum on its active conditions.
    ///
    /// Source: Goldfarb & Idnani (1983), Mathematical Programming 27, algorithm of section 3.
    ///
    /// # Errors
    /// See [`NoStep`].
    pub fn solve(&self) -> Result<Step, NoStep> {
        let n = self.gradient.len();
        let mut factors = Factors::new(&self.hessian).ok_or(NoStep::IllConditioned)?;
        let mut d = -(&factors.inverse * factors.inverse.tr_mul(&self.gradient));
        let mut active: Vec<(Condition, f64)> = Vec::new();
        let (equalities, inequalities): (Vec<usize>, Vec<usize>) =
            (0..self.kinds.len()).partition(|&k| self.kinds[k] == ConstraintKind::Equality);
        for k in equalities {
            let place = Place::Constraint(k);
            let (value, _) = self.excess(Condition { place, sign: 1.0 }, &d);
            // turned so that it is violated from below
            let sign = if value > 0.0 { -1.0 } else { 1.0 };
            self.satisfy(Condition { place, sign }, &mut d, &mut factors, &mut active)?;
        }
        let limits = inequalities.into_iter().map(|k| Condition { place: Place::Constraint(k), sign: -1.0 });
        let bounds = (0..n).flat_map(|i| [1.0, -1.0].map(|sign| Condition { place: Place::Bound(i), sign }));
        let all: Vec<Condition> = limits.chain(bounds).collect();
        for _ in 0..20 * (n + all.len()) + 100 {
            let violated = all.iter().filter_map(|&condition| {
                let (excess, size) = self.excess(condition, &d);
                (excess < -LONG_SUM * (1.0 + size)).then_some((excess / (1.0 + size), condition))
            });
            match violated.min_by(|a, b| a.0.total_cmp(&b.0)) {
                Some((_, worst)) => self.satisfy(worst, &mut d, &mut factors, &mut active)?,
                None => return self.minimizer(d, &active),
            }
        }
        Err(NoStep::IllConditioned)
    }

    /// The end: within the bounds and on the active ones to the last digit.
    fn minimizer(&self, mut d: DVector<f64>, active: &[(Condition, f64)]) -> Result<Step, NoStep> {
        let mut multipliers = vec![0.0; self.kinds.len()];
        for (i, d) in d.iter_mut().enumerate() {
            *d = d.clamp(self.lower[i], self.upper[i]);
        }
        for &(Condition { place, sign }, force) in active {
            match place {
                Place::Constraint(k) => multipliers[k] = -sign * force,
                Place::Bound(i) => d[i] = self.bound(i, sign),
            }
        }
        let finite = d.iter().all(|d| d.is_finite());
        if finite { Ok(Step { step: d, multipliers, left: 0.0 }) } else { Err(NoStep::IllConditioned) }
    }

    /// Moves to the minimum on the active conditions, each with its force, and one more.
    fn satisfy(
        &self,
        condition: Condition,
        d: &mut DVector<f64>,
        factors: &mut Factors,
        active: &mut Vec<(Condition, f64)>,
    ) -> Result<(), NoStep> {
        let mut own_force = 0.0;
        loop {
            let turned = self.turned(condition, factors);
            let (excess, size) = self.excess(condition, d);
            let change = factors.solve(&turned).ok_or(NoStep::IllConditioned)?;
            let free = turned.rows_range(factors.active..);
            let curvature = free.norm_squared();
            let dependent = curvature <= (LONG_SUM * LONG_SUM) * turned.norm_squared();
            let to_condition = if dependent { f64::INFINITY } else { -excess / curvature };
            let releases = (0..active.len()).filter(|&k| !self.is_equality(active[k].0) && change[k] > 0.0);
            let release = releases.map(|k| (active[k].1 / change[k], k)).min_by(|a, b| a.0.total_cmp(&b.0));
            let length = to_condition.min(release.map_or(f64::INFINITY, |(length, _)| length));
            if !length.is_finite() {
                // an equality that follows from the others
                let follows = self.is_equality(condition) && excess.abs() <= crate::tolerances::CONSISTENT * (1.0 + size);
                return if follows { Ok(()) } else { Err(NoStep::Infeasible) };
            }
            if !dependent {
                d.gemv(length, &factors.inverse.columns_range(factors.active..), &free, 1.0);
            }
            active.iter_mut().zip(&change).for_each(|((_, force), change)| *force -= length * change);
            own_force += length;
            match release {
                Some((_, place)) if length < to_condition => {
                    factors.remove(place);
                    active.remove(place);
                }
                _ => {
                    factors.add(turned);
                    active.push((condition, own_force));
                    return Ok(());
                }
            }
        }
    }
}

/// Gradients of constraints by `n` variables side by side.
pub(super) fn columns(n: usize, rows: &[Vec<f64>]) -> DMatrix<f64> {
    DMatrix::from_fn(n, rows.len(), |i, k| rows[k][i])
}

#[cfg(test)]
mod tests {
    use super::ConstraintKind::{AtMostZero, Equality};
    use super::*;

    /// Numbers between -1 and 1 that are the same in every run.
    struct Numbers(u64);
    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
        fn matrix(&mut self, rows: usize, columns: usize) -> DMatrix<f64> {
            DMatrix::from_fn(rows, columns, |_, _| self.next())
        }
    }

    #[test]
    fn minimizers_of_random_programs_satisfy_their_conditions_of_optimality() {
        let mut numbers = Numbers(7);
        for case in 0..200 {
            let (n, m) = (2 + case % 9, case % 6);
            let roots = numbers.matrix(n, n);
            let hessian = roots.tr_mul(&roots) + 0.1 * DMatrix::identity(n, n);
            let gradient = 10.0 * numbers.matrix(n, 1).column(0);
            let normals = numbers.matrix(n, m);
            // a point inside the bounds that satisfies all constraints
            let inside = 0.4 * numbers.matrix(n, 1).column(0);
            let kinds: Vec<ConstraintKind> = (0..m).map(|k| if k == 0 && n > 3 { Equality } else { AtMostZero }).collect();
            let slack = |k: usize| if kinds[k] == Equality { 0.0 } else { 0.05 };
            let offsets = (0..m).map(|k| -normals.column(k).dot(&inside) - slack(k)).collect();
            let (lower, upper) = (vec![-0.5; n], vec![0.5; n]);
            let program = QuadraticProgram { hessian, gradient, normals, offsets, kinds, lower, upper };
            let Step { step, multipliers, .. } = program.solve().unwrap();
            let QuadraticProgram { hessian, gradient, normals, offsets, kinds, .. } = program;
            // round-off of a few hundred operations on numbers of the order of 10
            let limit = 1e-10;
            for k in 0..m {
                let value = normals.column(k).dot(&step) + offsets[k];
                match kinds[k] {
                    Equality => assert!(value.abs() < limit, "case {case}: {value}"),
                    AtMostZero => {
                        assert!(value < limit && multipliers[k] >= 0.0, "case {case}: {value}");
                        assert!((value * multipliers[k]).abs() < limit, "case {case}: {value} {}", multipliers[k]);
                    }
                }
            }
            let multipliers = DVector::from(multipliers);
            let pulls = gradient + hessian * &step + normals * &multipliers;
            let size = 1.0 + multipliers.lp_norm(1);
            for (&step, &pull) in step.iter().zip(&pulls) {
                match step {
                    x if x <= -0.5 => assert!(pull > -limit * size, "case {case}: {pull}"),
                    x if x >= 0.5 => assert!(pull < limit * size, "case {case}: {pull}"),
                    _ => assert!(pull.abs() < limit * size, "case {case}: {pull}"),
                }
            }
        }
    }

    #[test]
    fn contradicting_rows_and_an_indefinite_hessian_are_said() {
        let unit = [1.0, 0.0, 0.0, 1.0];
        let program = |hessian: &[f64], offsets: &[f64]| {
            let (hessian, normals) =
                (DMatrix::from_row_slice(2, 2, hessian), DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 1.0, 2.0]));
            let (gradient, offsets, kinds) = (DVector::from(vec![1.0, 0.0]), offsets.to_vec(), vec![Equality; 2]);
            QuadraticProgram { hessian, gradient, normals, offsets, kinds, lower: vec![-10.0; 2], upper: vec![10.0; 2] }
                .solve()
        };
        assert_eq!(program(&unit, &[1.0, 1.0]).unwrap_err(), NoStep::Infeasible);
        // the second row says the same as the first
        let solution = program(&unit, &[1.0, 2.0]).unwrap();
        assert!((solution.step[0] + 1.0).abs() < 1e-15 && solution.step[1].abs() < 1e-15, "{:?}", solution.step);
        let indefinite = [1.0, 2.0, 2.0, 1.0];
        assert_eq!(program(&indefinite, &[1.0, 2.0]).unwrap_err(), NoStep::IllConditioned);
    }
}

//! Convex quadratic programs of moderate size, by the dual active-set method.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::ConstraintKind;

/// min 1/2 d^T H d + g^T d with `rows` d + `offsets` = 0 or <= 0 and `lower` <= d <= `upper`.
pub(super) struct QuadraticProgram<'a> {
    /// H, symmetric and positive definite, row by row.
    pub hessian: &'a [Vec<f64>],
    /// g.
    pub gradient: &'a [f64],
    /// Gradients of the linearized constraints.
    pub rows: &'a [Vec<f64>],
    /// Their values at d = 0.
    pub offsets: &'a [f64],
    /// Which of them are equalities.
    pub kinds: &'a [ConstraintKind],
    /// Least d.
    pub lower: &'a [f64],
    /// Largest d.
    pub upper: &'a [f64],
}

/// The minimizer and the multipliers of the rows, with g + H d + sum of multipliers times rows = 0 but for bounds.
#[derive(Debug)]
pub(super) struct Step {
    pub step: Vec<f64>,
    pub multipliers: Vec<f64>,
}

/// Why there is no minimizer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoStep {
    /// No d satisfies all constraints.
    Infeasible,
    /// H is not positive definite, or round-off keeps the method from its end.
    IllConditioned,
}

/// Share of the size of its terms below which a residual counts as zero.
pub(super) const ROUND_OFF: f64 = 1e-12;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// One condition n . d >= b of the program.
#[derive(Clone, Copy)]
enum Condition {
    /// Row `k`, times -1 unless it was turned to be violated from below.
    Row {
        index: usize,
        sign: f64,
    },
    Lower(usize),
    Upper(usize),
}

/// H = L L^T of the columns in `inverse` = L^-T Q, of which the first belong to the active conditions, and R of their QR
/// factorization, column by column.
struct Factors {
    inverse: Vec<Vec<f64>>,
    r: Vec<Vec<f64>>,
}

impl Factors {
    /// `None` unless H is positive definite.
    fn new(hessian: &[Vec<f64>]) -> Option<Self> {
        let n = hessian.len();
        let mut lower = vec![vec![0.0; n]; n];
        for i in 0..n {
            for j in 0..=i {
                let rest = hessian[i][j] - dot(&lower[i][..j], &lower[j][..j]);
                if i != j {
                    lower[i][j] = rest / lower[j][j];
                } else if rest > ROUND_OFF * hessian[i][i].abs() {
                    lower[i][i] = rest.sqrt();
                } else {
                    return None;
                }
            }
        }
        // columns of L^-T: L^T x = e_k
        let column = |k: usize| {
            let mut x = vec![0.0; n];
            x[k] = 1.0 / lower[k][k];
            for i in (0..k).rev() {
                let sum: f64 = (i + 1..=k).map(|j| lower[j][i] * x[j]).sum();
                x[i] = -sum / lower[i][i];
            }
            x
        };
        Some(Factors { inverse: (0..n).map(column).collect(), r: Vec::new() })
    }

    fn active(&self) -> usize {
        self.r.len()
    }

    /// Turns two neighbouring columns so that (a, b) becomes (length, 0), which it returns.
    fn rotate(&mut self, first: usize, a: f64, b: f64) -> [f64; 2] {
        let length = a.hypot(b);
        let [c, s] = if length == 0.0 { [1.0, 0.0] } else { [a / length, b / length] };
        let (left, right) = self.inverse.split_at_mut(first + 1);
        for (x, y) in left[first].iter_mut().zip(&mut right[0]) {
            (*x, *y) = (c * *x + s * *y, c * *y - s * *x);
        }
        [c, s]
    }

    /// Makes a condition active, of which `turned` is its normal in the columns.
    fn add(&mut self, mut turned: Vec<f64>) {
        let active = self.active();
        for k in (active + 1..turned.len()).rev() {
            let (a, b) = (turned[k - 1], turned[k]);
            self.rotate(k - 1, a, b);
            (turned[k - 1], turned[k]) = (a.hypot(b), 0.0);
        }
        turned.truncate(active + 1);
        self.r.push(turned);
    }

    /// Makes the active condition at `place` inactive.
    fn remove(&mut self, place: usize) {
        self.r.remove(place);
        for k in place..self.active() {
            let (a, b) = (self.r[k][k], self.r[k][k + 1]);
            let [c, s] = self.rotate(k, a, b);
            for column in &mut self.r[k..] {
                let (x, y) = (column[k], column[k + 1]);
                (column[k], column[k + 1]) = (c * x + s * y, c * y - s * x);
            }
            self.r[k].truncate(k + 1);
        }
    }

    /// R^-1 of the leading part.
    fn solve(&self, right: &[f64]) -> Vec<f64> {
        let mut x = right[..self.active()].to_vec();
        for k in (0..x.len()).rev() {
            x[k] /= self.r[k][k];
            let known = x[k];
            for i in 0..k {
                x[i] -= self.r[k][i] * known;
            }
        }
        x
    }
}

impl QuadraticProgram<'_> {
    fn is_equality(&self, condition: Condition) -> bool {
        matches!(condition, Condition::Row { index, .. } if self.kinds[index] == ConstraintKind::Equality)
    }

    /// n . d - b, and the size of its terms.
    fn excess(&self, condition: Condition, d: &[f64]) -> (f64, f64) {
        match condition {
            Condition::Row { index, sign } => {
                let terms: f64 = self.rows[index].iter().zip(d).map(|(a, d)| (a * d).abs()).sum();
                let value = dot(&self.rows[index], d) + self.offsets[index];
                (sign * value, terms + self.offsets[index].abs())
            }
            Condition::Lower(i) => (d[i] - self.lower[i], d[i].abs() + self.lower[i].abs()),
            Condition::Upper(i) => (self.upper[i] - d[i], d[i].abs() + self.upper[i].abs()),
        }
    }

    /// The normal n in the columns of the factors.
    fn turned(&self, condition: Condition, factors: &Factors) -> Vec<f64> {
        let columns = factors.inverse.iter();
        match condition {
            Condition::Row { index, sign } => columns.map(|column| sign * dot(column, &self.rows[index])).collect(),
            Condition::Lower(i) => columns.map(|column| column[i]).collect(),
            Condition::Upper(i) => columns.map(|column| -column[i]).collect(),
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
        let mut factors = Factors::new(self.hessian).ok_or(NoStep::IllConditioned)?;
        let mut d = vec![0.0; n];
        for column in &factors.inverse {
            let along = dot(column, self.gradient);
            d.iter_mut().zip(column).for_each(|(d, c)| *d -= along * c);
        }
        let mut active: Vec<Condition> = Vec::new();
        let mut forces: Vec<f64> = Vec::new();
        let equalities = (0..self.rows.len()).filter(|&k| self.kinds[k] == ConstraintKind::Equality);
        for index in equalities {
            let (value, _) = self.excess(Condition::Row { index, sign: 1.0 }, &d);
            // turned so that it is violated from below
            let sign = if value > 0.0 { -1.0 } else { 1.0 };
            self.satisfy(Condition::Row { index, sign }, &mut d, &mut factors, &mut active, &mut forces)?;
        }
        let rows = (0..self.rows.len()).filter(|&k| self.kinds[k] == ConstraintKind::AtMostZero);
        let bounds = (0..n).flat_map(|i| [Condition::Lower(i), Condition::Upper(i)]);
        let all: Vec<Condition> = rows.map(|index| Condition::Row { index, sign: -1.0 }).chain(bounds).collect();
        for _ in 0..20 * (n + all.len()) + 100 {
            let violated = all.iter().filter_map(|&condition| {
                let (excess, size) = self.excess(condition, &d);
                (excess < -ROUND_OFF * (1.0 + size)).then_some((excess / (1.0 + size), condition))
            });
            let Some((_, worst)) = violated.min_by(|a, b| a.0.total_cmp(&b.0)) else {
                let mut multipliers = vec![0.0; self.rows.len()];
                for (d, (lower, upper)) in d.iter_mut().zip(self.lower.iter().zip(self.upper)) {
                    *d = d.clamp(*lower, *upper);
                }
                for (condition, force) in active.iter().zip(&forces) {
                    match *condition {
                        Condition::Row { index, sign } => multipliers[index] = -sign * force,
                        // to the last digit
                        Condition::Lower(i) => d[i] = self.lower[i],
                        Condition::Upper(i) => d[i] = self.upper[i],
                    }
                }
                return if d.iter().all(|d| d.is_finite()) {
                    Ok(Step { step: d, multipliers })
                } else {
                    Err(NoStep::IllConditioned)
                };
            };
            self.satisfy(worst, &mut d, &mut factors, &mut active, &mut forces)?;
        }
        Err(NoStep::IllConditioned)
    }

    /// Moves to the minimum on the active conditions and one more.
    fn satisfy(
        &self,
        condition: Condition,
        d: &mut [f64],
        factors: &mut Factors,
        active: &mut Vec<Condition>,
        forces: &mut Vec<f64>,
    ) -> Result<(), NoStep> {
        let mut own_force = 0.0;
        loop {
            let turned = self.turned(condition, factors);
            let (excess, size) = self.excess(condition, d);
            let change = factors.solve(&turned);
            let free = &turned[factors.active()..];
            let curvature = dot(free, free);
            let dependent = curvature <= (ROUND_OFF * ROUND_OFF) * dot(&turned, &turned);
            let to_condition = if dependent { f64::INFINITY } else { -excess / curvature };
            let releases = (0..forces.len()).filter(|&k| !self.is_equality(active[k]) && change[k] > 0.0);
            let release = releases.map(|k| (forces[k] / change[k], k)).min_by(|a, b| a.0.total_cmp(&b.0));
            let length = to_condition.min(release.map_or(f64::INFINITY, |(length, _)| length));
            if !length.is_finite() {
                // an equality that follows from the others
                let follows = self.is_equality(condition) && excess.abs() <= 1e-9 * (1.0 + size);
                return if follows { Ok(()) } else { Err(NoStep::Infeasible) };
            }
            if !dependent {
                for (column, part) in factors.inverse[factors.active()..].iter().zip(free) {
                    d.iter_mut().zip(column).for_each(|(d, c)| *d += length * part * c);
                }
            }
            forces.iter_mut().zip(&change).for_each(|(force, change)| *force -= length * change);
            own_force += length;
            match release {
                Some((_, place)) if length < to_condition => {
                    factors.remove(place);
                    active.remove(place);
                    forces.remove(place);
                }
                _ => {
                    factors.add(turned);
                    active.push(condition);
                    forces.push(own_force);
                    return Ok(());
                }
            }
        }
    }
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
        fn list(&mut self, n: usize) -> Vec<f64> {
            (0..n).map(|_| self.next()).collect()
        }
    }

    #[test]
    fn minimizers_of_random_programs_satisfy_their_conditions_of_optimality() {
        let mut numbers = Numbers(7);
        for case in 0..200 {
            let (n, m) = (2 + case % 9, case % 6);
            let roots: Vec<Vec<f64>> = (0..n).map(|_| numbers.list(n)).collect();
            let entry = |i: usize, j: usize| dot(&roots[i], &roots[j]) + if i == j { 0.1 } else { 0.0 };
            let hessian: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
            let gradient = numbers.list(n).iter().map(|g| 10.0 * g).collect::<Vec<_>>();
            let rows: Vec<Vec<f64>> = (0..m).map(|_| numbers.list(n)).collect();
            // a point inside the bounds that satisfies all rows
            let inside: Vec<f64> = numbers.list(n).iter().map(|x| 0.4 * x).collect();
            let kinds: Vec<ConstraintKind> = (0..m).map(|k| if k == 0 && n > 3 { Equality } else { AtMostZero }).collect();
            let slack = |k: usize| if kinds[k] == Equality { 0.0 } else { 0.05 };
            let offsets: Vec<f64> = (0..m).map(|k| -dot(&rows[k], &inside) - slack(k)).collect();
            let (lower, upper) = (vec![-0.5; n], vec![0.5; n]);
            let program = QuadraticProgram {
                hessian: &hessian,
                gradient: &gradient,
                rows: &rows,
                offsets: &offsets,
                kinds: &kinds,
                lower: &lower,
                upper: &upper,
            };
            let Step { step, multipliers } = program.solve().unwrap();
            // round-off of a few hundred operations on numbers of the order of 10
            let limit = 1e-10;
            for k in 0..m {
                let value = dot(&rows[k], &step) + offsets[k];
                match kinds[k] {
                    Equality => assert!(value.abs() < limit, "case {case}: {value}"),
                    AtMostZero => {
                        assert!(value < limit && multipliers[k] >= 0.0, "case {case}: {value}");
                        assert!((value * multipliers[k]).abs() < limit, "case {case}: {value} {}", multipliers[k]);
                    }
                }
            }
            for i in 0..n {
                let pull = gradient[i] + dot(&hessian[i], &step) + (0..m).map(|k| multipliers[k] * rows[k][i]).sum::<f64>();
                let size = 1.0 + multipliers.iter().map(|m| m.abs()).sum::<f64>();
                match step[i] {
                    x if x <= -0.5 => assert!(pull > -limit * size, "case {case}: {pull}"),
                    x if x >= 0.5 => assert!(pull < limit * size, "case {case}: {pull}"),
                    _ => assert!(pull.abs() < limit * size, "case {case}: {pull}"),
                }
            }
        }
    }

    #[test]
    fn contradicting_rows_and_an_indefinite_hessian_are_said() {
        let unit = vec![vec![1.0, 0.0], vec![0.0, 1.0]];
        let program = |hessian, offsets| {
            let (lower, upper) = ([-10.0; 2], [10.0; 2]);
            let (rows, kinds) = ([vec![1.0, 1.0], vec![2.0, 2.0]], [Equality; 2]);
            let gradient = [1.0, 0.0];
            let (rows, kinds) = (&rows[..], &kinds[..]);
            QuadraticProgram { hessian, gradient: &gradient, rows, offsets, kinds, lower: &lower, upper: &upper }.solve()
        };
        assert_eq!(program(&unit, &[1.0, 1.0]).unwrap_err(), NoStep::Infeasible);
        // the second row says the same as the first
        let solution = program(&unit, &[1.0, 2.0]).unwrap();
        assert!((solution.step[0] + 1.0).abs() < 1e-15 && solution.step[1].abs() < 1e-15, "{:?}", solution.step);
        let indefinite = vec![vec![1.0, 2.0], vec![2.0, 1.0]];
        assert_eq!(program(&indefinite, &[1.0, 2.0]).unwrap_err(), NoStep::IllConditioned);
    }
}

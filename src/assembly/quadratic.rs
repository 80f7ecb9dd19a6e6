use super::Level;
use crate::elements::{AnyConstraint, State};
use crate::scalar::{LANES, Scalar, Taylor};

/// A constraint inside a node in closed form: g_k = c_k + b_k . q + q . H_k q / 2.
///
/// The unit length of Euler parameters is one; so are the right angles of natural coordinates. Their rows A = b + H q and all time
/// derivatives cost a few multiplications, in every scalar. The coefficients are derivatives of the constraint itself, taken once.
pub(super) struct Quadratic {
    constant: Vec<f64>,
    /// (equation, coordinate, b).
    linear: Vec<(usize, usize, f64)>,
    /// (equation, row, column, H).
    second: Vec<(usize, usize, usize, f64)>,
    unit_length: Option<UnitLength>,
    turning: Option<Turning>,
}

/// Coordinates at the end of a node that turn rigidly: the directions in which the constraints let them move are known, and change
/// smoothly with the pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turning {
    /// Four Euler parameters.
    Euler,
    /// Three axes.
    Axes,
}

impl Turning {
    /// Number of coordinates.
    pub fn coordinates(self) -> usize {
        match self {
            Turning::Euler => 4,
            Turning::Axes => 9,
        }
    }

    /// Writes the basis (row-major) of the vectors at right angles to the rows H x of a node: x is a pose or any other combination of
    /// coordinates and rates. Columns are the coordinates before the turning ones, then turns about three axes, of unit length where x
    /// is a pose.
    pub fn basis(self, x: &[f64], basis: &mut Vec<f64>) {
        let first = x.len() - self.coordinates();
        let columns = first + 3;
        basis.clear();
        basis.resize(x.len() * columns, 0.0);
        (0..first).for_each(|i| basis[i * columns + i] = 1.0);
        let turning = &x[first..];
        let square = turning.iter().fold(0.0, |sum, x| sum + x * x);
        let mut write = |i: usize, own: [f64; 3]| {
            let start = (first + i) * columns + first;
            basis[start..start + 3].copy_from_slice(&own);
        };
        match *turning {
            [e0, e1, e2, e3] => {
                let scale = 1.0 / square.sqrt();
                let rows = [[-e1, -e2, -e3], [e0, -e3, e2], [e3, e0, -e1], [-e2, e1, e0]];
                rows.into_iter().enumerate().for_each(|(i, row)| write(i, row.map(|e| scale * e)));
            }
            _ => {
                // of three axes of length 1 every turn moves two
                let scale = (1.5 / square).sqrt();
                for (axis, own) in turning.chunks_exact(3).enumerate() {
                    let [x, y, z] = [own[0], own[1], own[2]].map(|x| scale * x);
                    let rows = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]];
                    rows.into_iter().enumerate().for_each(|(i, row)| write(3 * axis + i, row));
                }
            }
        }
    }
}

/// The one equation (x . x) h / 2 + c = 0 of four coordinates in a row: Euler parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct UnitLength {
    /// The first of them.
    pub first: usize,
    /// h.
    pub second: f64,
    /// c.
    pub constant: f64,
}

impl Quadratic {
    /// Coefficients of a constraint without parameters.
    ///
    /// # Panics
    /// If it is not quadratic: a mistake in the list of node kinds.
    pub fn of(physics: &dyn AnyConstraint) -> Self {
        let (n, count) = (physics.dof_count(), physics.equation_count());
        let origin = vec![0.0; n];
        let value = |q: &[f64]| {
            let mut g = vec![0.0; count];
            crate::elements::ConstraintIn::<f64>::value(physics, q, &[], 0.0, &mut g);
            g
        };
        let (linear, second) = (Vec::new(), Vec::new());
        let mut quadratic = Quadratic { constant: value(&origin), linear, second, unit_length: None, turning: None };
        let mut directions = vec![[0.0; LANES]; n.div_ceil(LANES) * n];
        for dof in 0..n {
            directions[dof / LANES * n + dof][dof % LANES] = 1.0;
        }
        let mut gradients = vec![0.0; count * n];
        physics.gradients((&origin, &[], 0.0), &mut gradients);
        for equation in 0..count {
            let mut unit = vec![0.0; count];
            unit[equation] = 1.0;
            let mut products = vec![[0.0; LANES]; directions.len()];
            physics.curvature((&origin, &[], 0.0), &unit, &directions, &mut products);
            let linear = gradients[equation * n..].iter().take(n).enumerate();
            quadratic.linear.extend(linear.filter(|(_, b)| **b != 0.0).map(|(dof, &b)| (equation, dof, b)));
            for row in 0..n {
                let entry = |column: usize| products[column / LANES * n + row][column % LANES];
                let own = (0..n).map(|column| (equation, row, column, entry(column)));
                quadratic.second.extend(own.filter(|(.., h)| *h != 0.0));
            }
        }
        let probe: Vec<f64> = (0..n).map(|i| 0.3 + 0.7 * (i as f64 * 1.7).sin()).collect();
        let mut g = vec![Taylor::default(); count];
        let still = vec![0.0; n];
        quadratic.derivatives(State { a: &still, v: &still, q: &probe }, &mut g);
        let exact = value(&probe).iter().zip(&g).all(|(g, own)| (g - own.value).abs() < 1e-13);
        assert!(exact, "constraints inside nodes are quadratic");
        quadratic.unit_length = quadratic.as_unit_length();
        quadratic.turning =
            [Turning::Euler, Turning::Axes].into_iter().find(|turning| quadratic.is_free_in(*turning, &probe));
        quadratic
    }

    /// Whether all directions at right angles to the rows are turns.
    fn is_free_in(&self, turning: Turning, probe: &[f64]) -> bool {
        let (n, count) = (probe.len(), self.constant.len());
        if n < turning.coordinates() || n - count != n - turning.coordinates() + 3 || !self.linear.is_empty() {
            return false;
        }
        let (mut basis, mut rows) = (Vec::new(), vec![0.0; count * n]);
        turning.basis(probe, &mut basis);
        self.rows(probe, &mut rows);
        let columns = n - count;
        let product = |row: &[f64], column: usize| -> f64 { (0..n).map(|i| row[i] * basis[i * columns + column]).sum() };
        rows.chunks_exact(n).all(|row| (0..columns).all(|column| product(row, column).abs() < 1e-13))
    }

    /// The coordinates that turn, if its rows leave them nothing else.
    pub fn turning(&self) -> Option<Turning> {
        self.turning
    }

    fn as_unit_length(&self) -> Option<UnitLength> {
        let &[(_, first, _, h), ..] = &self.second[..] else { return None };
        let expected = (first..first + 4).map(|dof| (0, dof, dof, h));
        let own = self.constant.len() == 1 && self.linear.is_empty() && expected.eq(self.second.iter().copied());
        own.then_some(UnitLength { first, second: h, constant: self.constant[0] })
    }

    /// The equation in short, if it is one of unit length.
    pub fn unit_length(&self) -> Option<UnitLength> {
        self.unit_length
    }

    /// Writes rows A (equations by coordinates, row-major).
    pub fn rows<S: Scalar>(&self, q: &[S], rows: &mut [S]) {
        rows.fill(S::zero());
        for &(equation, dof, b) in &self.linear {
            rows[equation * q.len() + dof] += S::from(b);
        }
        for &(equation, row, column, h) in &self.second {
            rows[equation * q.len() + row] += q[column] * h;
        }
    }

    /// Writes rows A with their derivatives along the motion.
    pub fn moving_rows(&self, s: State<f64>, rows: &mut [Taylor<f64>]) {
        let n = s.q.len();
        rows.fill(Taylor::default());
        for &(equation, dof, b) in &self.linear {
            rows[equation * n + dof].value += b;
        }
        for &(equation, row, column, h) in &self.second {
            let entry = &mut rows[equation * n + row];
            entry.value += h * s.q[column];
            entry.first += h * s.v[column];
            entry.second += h * s.a[column];
        }
    }

    /// Adds a weighted sum of one row A and of its derivatives along the motion, each with the vector (q, v or a) that it is linear in.
    pub fn add_row<S: Scalar>(&self, equation: usize, weighted: [(f64, &[S]); 3], row: &mut [S]) {
        for &(_, dof, b) in self.linear.iter().filter(|(own, ..)| *own == equation) {
            row[dof] += S::from(b * weighted[0].0);
        }
        for &(_, i, j, h) in self.second.iter().filter(|(own, ..)| *own == equation) {
            for (weight, vector) in weighted {
                row[i] += vector[j] * (h * weight);
            }
        }
    }

    /// The entries of H that are not zero: (equation, row, column, H).
    pub fn second_derivatives(&self) -> impl Iterator<Item = (usize, usize, usize, f64)> + '_ {
        self.second.iter().copied()
    }

    /// target += factor (sum_k multiplier_k H_k) direction: the derivative of the reaction along a direction.
    pub fn add_curvature(&self, multipliers: &[f64], direction: &[f64], factor: f64, target: &mut [f64]) {
        for &(equation, row, column, h) in &self.second {
            target[row] += factor * multipliers[equation] * h * direction[column];
        }
    }

    /// Sum of the terms of all equations at a level, without their signs: round-off is a share of it. Zero at two levels at once.
    pub fn size_of_terms<S: Scalar>(&self, level: Level, s: State<S>) -> f64 {
        let size = |x: S| x.value().abs();
        let of = |x: &[S]| self.linear.iter().fold(0.0, |sum, &(_, dof, b)| sum + size(x[dof]) * b.abs());
        let product =
            |x: &[S], y: &[S]| self.second.iter().fold(0.0, |sum, &(_, i, j, h)| sum + size(x[i]) * size(y[j]) * h.abs());
        match level {
            Level::Position => {
                let constants = self.constant.iter().fold(0.0, |sum: f64, constant| sum + constant.abs());
                constants + of(s.q) + 0.5 * product(s.q, s.q)
            }
            Level::Velocity => of(s.v) + product(s.q, s.v),
            Level::Acceleration => of(s.a) + product(s.q, s.a) + product(s.v, s.v),
            Level::Stabilized => 0.0,
        }
    }

    /// Writes g with its first and second derivative along the motion.
    pub fn derivatives<S: Scalar>(&self, s: State<S>, g: &mut [Taylor<S>]) {
        for (g, &constant) in g.iter_mut().zip(&self.constant) {
            *g = Taylor::from(constant);
        }
        for &(equation, dof, b) in &self.linear {
            let g = &mut g[equation];
            g.value += s.q[dof] * b;
            g.first += s.v[dof] * b;
            g.second += s.a[dof] * b;
        }
        for &(equation, i, j, h) in &self.second {
            let g = &mut g[equation];
            g.value += s.q[i] * s.q[j] * (0.5 * h);
            g.first += s.q[i] * s.v[j] * h;
            g.second += (s.q[i] * s.a[j] + s.v[i] * s.v[j]) * h;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::bodies::EulerParameterNorm;
    use crate::elements::{ConstraintIn, State};

    #[test]
    fn closed_form_equals_the_constraint_with_its_rows_and_rates() {
        let physics = EulerParameterNorm;
        let own = Quadratic::of(&physics);
        let numbers = |phase: f64| (0..7).map(|i| (i as f64 + phase).sin()).collect::<Vec<f64>>();
        let (q, v, a) = (numbers(0.1), numbers(1.3), numbers(2.6));
        let state = State { a: &a, v: &v, q: &q };
        let (mut g, mut expected) = ([Taylor::default()], [Taylor::default()]);
        own.derivatives(state, &mut g);
        ConstraintIn::<f64>::derivatives(&physics, state, &[], 0.0, 1.0, &mut expected);
        let close = |a: Taylor<f64>, b: Taylor<f64>| {
            let d = a - b;
            d.value.abs().max(d.first.abs()).max(d.second.abs()) < 1e-14
        };
        assert!(close(g[0], expected[0]), "{g:?} {expected:?}");
        let unit = own.unit_length().expect("Euler parameters have unit length");
        let length: f64 = q[unit.first..unit.first + 4].iter().map(|q| q * q).sum();
        assert!((0.5 * unit.second * length + unit.constant - g[0].value).abs() < 1e-14);
        let (mut rows, mut expected) = ([Taylor::default(); 7], [Taylor::default(); 7]);
        own.moving_rows(state, &mut rows);
        physics.rows(state, &[], 0.0, true, &mut expected);
        assert!(rows.iter().zip(&expected).all(|(&a, &b)| close(a, b)), "{rows:?} {expected:?}");
        let mut values = [0.0; 7];
        own.rows(&q, &mut values);
        assert!(values.iter().zip(&rows).all(|(value, row)| *value == row.value));
    }

    #[test]
    #[should_panic(expected = "quadratic")]
    fn other_constraints_are_refused() {
        struct Cubic;
        impl crate::elements::Constraint for Cubic {
            const DOFS: usize = 1;
            const EQUATIONS: usize = 1;
            fn g<S: Scalar>(&self, q: &[S], _p: &[S], _t: S, g: &mut [S]) {
                g[0] = q[0] * q[0] * q[0];
            }
        }
        Quadratic::of(&Cubic);
    }
}
